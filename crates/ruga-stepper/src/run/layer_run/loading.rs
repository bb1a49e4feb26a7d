//! The loading of a layer: what its load fractions mean.

use super::LayerRun;
use crate::run::layer::Layer;
use crate::support::motion::Inertia;
use crate::{Observer, StepperError};

/// The meaning of a load fraction to a layer, and what is done when it is reached.
pub(crate) trait Loading {
    /// Moves the support surface of `layer` to where it is at `load`; with `inertia`, at the end of that
    /// step in time.
    fn place(
        &self,
        layer: &mut Layer,
        load: f64,
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError>;

    /// Converts `load` to the fraction of the pose that progress and warnings name.
    fn pose_fraction(&self, load: f64) -> f64;

    /// Whether the state at `load` is a result, not only passed on the way to one.
    fn is_result(&self, load: f64) -> bool;

    /// Whether motion in time stands still at `load` until the layer rests.
    fn rests_at(&self, load: f64) -> bool;

    /// Takes note that the layer is in equilibrium at `load`; false when the observer ends the work.
    fn kept(
        &mut self,
        run: &mut LayerRun<'_>,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError>;
}

/// How following a loading ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// The last load was reached.
    Reached,
    /// No equilibrium was found for the next load.
    GaveUp,
    /// The observer ended it.
    Interrupted,
}

/// `steps` equal steps to 1, as far as `last`, and the `keys`; ascending.
pub(crate) fn loads_up_to(last: f64, steps: u32, keys: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut loads: Vec<f64> = (1..=steps)
        .map(|i| f64::from(i) / f64::from(steps))
        .filter(|&load| load < last)
        .chain(keys)
        .collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    loads
}
