//! Times and counts of a run, step by step.

use std::time::Instant;

use ruga_stepper::{Frame, Observer, Phase, Progress};

/// What the steps of a run took.
#[derive(Clone, Debug, Default)]
pub struct Times {
    /// From the beginning of planning to that of the first step, s.
    pub set_up_s: f64,
    /// Of every step, s.
    pub frame_s: Vec<f64>,
    /// Newton iterations of every step.
    pub iterations: Vec<usize>,
}

/// Takes the times of a run that it observes.
pub(super) struct Stopwatch {
    pub(super) times: Times,
    is_set_up: bool,
    /// Iterations of the step under way.
    current: usize,
    /// When it began.
    clock: Instant,
}

impl Stopwatch {
    pub(super) fn new() -> Self {
        Self {
            times: Times::default(),
            is_set_up: false,
            current: 0,
            clock: Instant::now(),
        }
    }

    /// Seconds since the last time.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        now.duration_since(std::mem::replace(&mut self.clock, now))
            .as_secs_f64()
    }
}

impl Observer for Stopwatch {
    fn phase(&mut self, _: usize, phase: Phase) {
        if phase == Phase::Sampling && !self.is_set_up {
            self.is_set_up = true;
            self.times.set_up_s = self.lap();
        }
    }

    fn progress(&mut self, _: Progress) -> bool {
        self.current += 1;
        true
    }

    fn frame(&mut self, _: &Frame<'_>) {
        let seconds = self.lap();
        self.times.frame_s.push(seconds);
        self.times
            .iterations
            .push(std::mem::take(&mut self.current));
    }
}
