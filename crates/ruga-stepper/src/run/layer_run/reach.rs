//! The load path of a layer to a key at which the surface below stands from the beginning.
//!
//! Wrinkles keep the wavelength with which they begin, so that every place has to begin near its own
//! critical strain. Where one place is compressed many times as much as another, a sequence of weights
//! passes both onsets only in many steps. Here the surface goes to its place at once, and the strain
//! ratio that is loaded on every face grows from solve to solve: all places begin
//! to wrinkle in the first solve, and none of them far above its onset.

use ruga_mesh::PerFace;
use ruga_solver::{AtSaddle, StopRule};

use super::{Accuracy, Ending, LayerRun, Loading};
use crate::{Observer, StepperError};

/// Largest strain ratio of a face that has been below 1: as far above the onset as the critical wave is
/// still the one that grows fastest.
const FIRST: f64 = 1.15;
/// Largest factor from one strain ratio of a wrinkled face to the next; up to 2 a pattern keeps its
/// wavelength.
const GROWTH: f64 = 1.43;
/// Strain ratio beyond which a pattern is fixed, and a face is loaded with all that the key asks for.
const LAST: f64 = 7.0;
/// Factor by which a face may exceed its limit where that saves a solve.
const EXCESS: f64 = 1.1;

impl LayerRun<'_> {
    /// Takes the layer to `load` from its present shape, which is in equilibrium, the last key at the
    /// fraction `from` of the pose.
    pub(super) fn reach(
        &mut self,
        loading: &mut dyn Loading,
        (from, load): (f64, f64),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let pose_fraction = loading.pose_fraction(load);
        let mut kept = self.layer.state();
        if self.layer.strain_ratio() < 1.0 {
            // The first pattern is chosen with care.
            self.relaxation = 0.0;
        }
        loop {
            let felt = self.layer.strain_ratios().all();
            if !self.place(loading, load, observer)? {
                return Ok(Ending::Interrupted);
            }
            let ratios = self.layer.strain_ratios();
            let onset = pose_fraction * ratios.onset();
            let limits: PerFace<f64> = felt.iter().map(|(_, felt)| limit(*felt)).collect();
            let wanted = ratios.all();
            let largest = ratios.largest();
            let is_last = wanted
                .iter()
                .all(|(face, wanted)| *wanted <= EXCESS * limits[face]);
            if !is_last {
                self.layer.limit_strains(&limits)?;
            }
            let accuracy = match is_last {
                true => Accuracy::Result,
                false => Accuracy::Passing,
            };
            let how = (AtSaddle::Leave, accuracy);
            let loaded = self.layer.strain_ratio();
            let share = match is_last {
                true => 1.0,
                false => (1.0 + loaded).ln() / (1.0 + largest).ln(),
            };
            let shown = from.min(pose_fraction) + (pose_fraction - from).max(0.0) * share;
            let solve = self.solve(None, how, shown, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            if !solve.converged {
                let what = format!(
                    "no equilibrium found beyond {:.1} times the strain at which the layer wrinkles, of {largest:.1} times that are asked for,",
                    felt.as_slice().iter().copied().fold(0.0, f64::max)
                );
                self.warn_of_failure(&what, pose_fraction, &solve);
                self.layer.restore(&kept)?;
                return Ok(Ending::GaveUp);
            }
            if solve.left_saddle && self.layer.strain_ratio() > 1.0 {
                self.report.onset_load = self.report.onset_load.or(Some(onset));
            }
            if is_last {
                self.warn_unverified(&solve);
                return Ok(match loading.kept(self, load, observer)? {
                    true => Ending::Reached,
                    false => Ending::Interrupted,
                });
            }
            kept = self.layer.state();
        }
    }
}

/// Largest strain ratio that may be loaded next on a face where it is `felt`.
fn limit(felt: f64) -> f64 {
    let next = match felt < 1.0 {
        true => FIRST,
        false => felt * GROWTH,
    };
    if next > LAST { f64::INFINITY } else { next }
}
