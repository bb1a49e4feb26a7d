//! Work on a layer before its first iteration, between keys and before it is shown, which the observer may end.

use crate::error::Halt;
use crate::{Observer, Phase, Preparation};

/// Tells the observer how far the preparation of one layer is, and asks it whether to go on.
pub(crate) struct Preparing<'o> {
    observer: &'o mut dyn Observer,
    layer: usize,
    phase: Phase,
    steps: usize,
}

impl<'o> Preparing<'o> {
    /// Begins with a phase of work on layer number `layer`.
    pub(crate) fn new(observer: &'o mut dyn Observer, layer: usize, phase: Phase) -> Self {
        observer.phase(layer, phase);
        Self {
            observer,
            layer,
            phase,
            steps: 0,
        }
    }

    /// Ends the phase under way and begins another.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] when the observer asks for it.
    pub(crate) fn enter(&mut self, phase: Phase) -> Result<(), Halt> {
        self.step()?;
        self.phase = phase;
        self.observer.phase(self.layer, phase);
        Ok(())
    }

    /// A step of the phase is done.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] when the observer asks for it.
    pub(crate) fn step(&mut self) -> Result<(), Halt> {
        match self.goes_on() {
            true => Ok(()),
            false => Err(Halt::Interrupted),
        }
    }

    /// Result of `work`, which asks between its steps whether to go on and makes nothing once the
    /// answer was no.
    ///
    /// # Errors
    /// [`Halt::Interrupted`] when the observer asks for it.
    pub(crate) fn while_wanted<T>(
        &mut self,
        work: impl FnOnce(&mut dyn FnMut() -> bool) -> Option<T>,
    ) -> Result<T, Halt> {
        work(&mut || self.goes_on()).ok_or(Halt::Interrupted)
    }

    /// A step of the phase is done; false when the observer asks to stop.
    pub(crate) fn goes_on(&mut self) -> bool {
        self.steps += 1;
        self.observer.preparing(Preparation {
            layer: self.layer,
            phase: self.phase,
            step: self.steps,
        })
    }
}
