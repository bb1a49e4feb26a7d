//! What leads a layer from load to load.

use super::LayerRun;
use crate::run::layer::Layer;
use crate::support::motion::Inertia;
use crate::{Observer, StepperError};

/// What a load means to a layer, and what follows from reaching one.
pub(crate) trait Course {
    /// Puts what lies below `layer` where it is at `load`: at the end of a step in time where `inertia`
    /// is that of one.
    fn place(
        &self,
        layer: &mut Layer,
        load: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError>;

    /// `load` as a fraction of the pose.
    fn shown(&self, load: f64) -> f64;

    /// Whether the state at `load` is wanted for itself, not only on the way to others.
    fn is_result(&self, load: f64) -> bool;

    /// Whether motion in time stands still at `load` until the layer rests.
    fn rests_at(&self, load: f64) -> bool;

    /// The layer is in equilibrium at `load`; false when the observer ends the work.
    fn kept(
        &mut self,
        run: &LayerRun<'_>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError>;
}

/// How following a course ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// At the last load.
    Reached,
    /// Without an equilibrium for the next load.
    GaveUp,
    /// By the observer.
    Interrupted,
}
