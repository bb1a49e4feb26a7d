//! Watches one pose: a clock, a progress bar, the frames on their way out, the wish to stop.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use ruga_io::Seconds;
use ruga_stepper::{Frame, Observer, Phase, Preparation, Progress};

use crate::error::CliError;
use crate::interrupt;

/// Function that takes every load step.
pub(crate) type FrameSink<'a> = dyn FnMut(&Frame<'_>) -> Result<(), CliError> + Send + 'a;

/// Parts of a load step that a sink uses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Every layer in every load step.
    pub(crate) frames: bool,
    /// The state of every triangle of it.
    pub(crate) face_states: bool,
}

/// Time spent on a layer, by kind of work.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    constraints: Duration,
    remeshing: Duration,
    sampling: Duration,
    integration: Duration,
}

/// An observer with a clock.
pub(crate) struct Watch<'a> {
    phase: Option<(usize, Phase, Instant)>,
    spent: BTreeMap<usize, Spent>,
    bar: &'a ProgressBar,
    /// Whether another pose has failed, so that this one is not worth finishing.
    given_up: &'a (dyn Fn() -> bool + Sync),
    wanted: Wanted,
    sink: &'a mut FrameSink<'a>,
    failure: Option<CliError>,
    /// Whether iterations have been told of.
    is_solving: bool,
}

impl<'a> Watch<'a> {
    /// Starts the clock. The bar's length is 1000 for the whole pose.
    pub(crate) fn new(
        bar: &'a ProgressBar,
        given_up: &'a (dyn Fn() -> bool + Sync),
        wanted: Wanted,
        sink: &'a mut FrameSink<'a>,
    ) -> Self {
        Self {
            phase: None,
            spent: BTreeMap::new(),
            bar,
            given_up,
            wanted,
            sink,
            failure: None,
            is_solving: false,
        }
    }

    /// Stops the clock: every layer's seconds per frame, or what went wrong with a frame.
    ///
    /// # Errors
    /// The first error of the frame sink.
    pub(crate) fn finish(mut self, layers: usize, frames: usize) -> Result<Vec<Seconds>, CliError> {
        self.close_phase();
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let mean = |spent: Duration| Some(spent.as_secs_f64() / frames.max(1) as f64);
        let of_layer = |layer| {
            let spent: Spent = self.spent.get(&layer).copied().unwrap_or_default();
            Seconds {
                constraints: mean(spent.constraints),
                integration: mean(spent.integration),
                remeshing: mean(spent.remeshing),
                sampling: mean(spent.sampling),
                total: mean(
                    spent.constraints + spent.integration + spent.remeshing + spent.sampling,
                ),
            }
        };
        Ok((0..layers).map(of_layer).collect())
    }

    fn goes_on(&self) -> bool {
        self.failure.is_none() && !interrupt::asked() && !(self.given_up)()
    }

    fn close_phase(&mut self) {
        let Some((layer, phase, since)) = self.phase.take() else {
            return;
        };
        let spent = self.spent.entry(layer).or_default();
        let spent = match phase {
            Phase::Constraints => &mut spent.constraints,
            Phase::Remeshing => &mut spent.remeshing,
            Phase::Sampling => &mut spent.sampling,
            Phase::Integration => &mut spent.integration,
        };
        *spent += since.elapsed();
    }
}

impl Observer for Watch<'_> {
    fn phase(&mut self, layer: usize, phase: Phase) {
        self.close_phase();
        self.phase = Some((layer, phase, Instant::now()));
    }

    fn preparing(&mut self, preparation: Preparation) -> bool {
        let work = match preparation.phase {
            Phase::Sampling => "the surface is sampled",
            Phase::Remeshing => "a mesh is fitted",
            Phase::Constraints => "constraints are made",
            Phase::Integration => "the first step is solved",
        };
        // A load step is prepared in one step: the line goes on saying where the solve stands.
        if preparation.step > 1 || !self.is_solving {
            let layer = preparation.layer + 1;
            self.bar.set_message(format!("layer {layer}: {work}"));
        }
        self.goes_on()
    }

    fn progress(&mut self, progress: Progress) -> bool {
        self.is_solving = true;
        self.bar.set_position((1000.0 * progress.load) as u64);
        self.bar.set_message(format!(
            "{} vertices, iteration {}",
            progress.vertices, progress.iteration
        ));
        self.goes_on()
    }

    fn wants_frames(&self) -> bool {
        self.wanted.frames
    }

    fn wants_face_states(&self) -> bool {
        self.wanted.face_states
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        self.close_phase();
        if self.failure.is_none() {
            self.failure = (self.sink)(frame).err();
        }
    }
}
