//! Watches one pose: a clock, a progress bar, the frames on their way out, the wish to stop.

use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use ruga_io::Seconds;
use ruga_stepper::{Frame, Observer, Phase, Progress};

use crate::error::CliError;
use crate::interrupt;

/// What to do with every load step.
pub(crate) type FrameSink<'a> = dyn FnMut(&Frame<'_>) -> Result<(), CliError> + 'a;

/// An observer with a clock.
pub(crate) struct Watch<'a> {
    started: Instant,
    phase: Option<(Phase, Instant)>,
    constraints: Duration,
    remeshing: Duration,
    sampling: Duration,
    integration: Duration,
    bar: &'a ProgressBar,
    /// Whether another pose has failed, so that this one is not worth finishing.
    given_up: &'a (dyn Fn() -> bool + Sync),
    /// Whether the sink has a use for every layer in every frame.
    wants_frames: bool,
    sink: &'a mut FrameSink<'a>,
    failure: Option<CliError>,
}

impl<'a> Watch<'a> {
    /// Starts the clock. The bar's length is 1000 for the whole pose.
    pub(crate) fn new(
        bar: &'a ProgressBar,
        given_up: &'a (dyn Fn() -> bool + Sync),
        wants_frames: bool,
        sink: &'a mut FrameSink<'a>,
    ) -> Self {
        Self {
            started: Instant::now(),
            phase: None,
            constraints: Duration::ZERO,
            remeshing: Duration::ZERO,
            sampling: Duration::ZERO,
            integration: Duration::ZERO,
            bar,
            given_up,
            wants_frames,
            sink,
            failure: None,
        }
    }

    /// Stops the clock: seconds per frame, or what went wrong with a frame.
    ///
    /// # Errors
    /// The first error of the frame sink.
    pub(crate) fn finish(mut self, frames: usize) -> Result<Seconds, CliError> {
        self.close_phase();
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let mean = |spent: Duration| Some(spent.as_secs_f64() / frames.max(1) as f64);
        Ok(Seconds {
            constraints: mean(self.constraints),
            integration: mean(self.integration),
            remeshing: mean(self.remeshing),
            sampling: mean(self.sampling),
            total: mean(self.started.elapsed()),
        })
    }

    fn close_phase(&mut self) {
        let Some((phase, since)) = self.phase.take() else {
            return;
        };
        let spent = match phase {
            Phase::Constraints => &mut self.constraints,
            Phase::Remeshing => &mut self.remeshing,
            Phase::Sampling => &mut self.sampling,
            Phase::Integration => &mut self.integration,
        };
        *spent += since.elapsed();
    }
}

impl Observer for Watch<'_> {
    fn phase(&mut self, phase: Phase) {
        self.close_phase();
        self.phase = Some((phase, Instant::now()));
    }

    fn progress(&mut self, progress: Progress) -> bool {
        self.bar.set_position((1000.0 * progress.load) as u64);
        self.bar.set_message(format!(
            "{} vertices, iteration {}",
            progress.vertices, progress.iteration
        ));
        self.failure.is_none() && !interrupt::asked() && !(self.given_up)()
    }

    fn wants_frames(&self) -> bool {
        self.wants_frames
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        if self.failure.is_none() {
            self.failure = (self.sink)(frame).err();
        }
    }
}
