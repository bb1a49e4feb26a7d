//! The way of a layer to a key at which the surface below stands from the beginning.
//!
//! Wrinkles keep the wavelength with which they begin, so that every place has to begin near its own
//! critical strain. Where one place is compressed many times as much as another, a sequence of weights
//! passes both onsets only in many steps. Here the surface goes to its place at once, and the strain that
//! every face feels grows from solve to solve, in numbers of its own critical strain: all places begin
//! to wrinkle in the first solve, and none of them far above its onset.

use ruga_mesh::PerFace;
use ruga_solver::{AtSaddle, StopRule};

use super::{Accuracy, Ending, LayerRun, Loading};
use crate::{Observer, StepperError};

/// Critical strains that a face without wrinkles feels at most: as far above the onset as the critical
/// wave is still the one that grows fastest.
const FIRST: f64 = 1.15;
/// Largest factor on the strain that a wrinkled face feels; up to 2 a pattern keeps its wavelength.
const GROWTH: f64 = 1.43;
/// Critical strains beyond which a pattern is fixed, and a face goes on to whatever it is asked for.
const LAST: f64 = 7.0;
/// Factor by which a limit is exceeded rather than solved at once more.
const EXCESS: f64 = 1.1;
/// Power of the two factors below which smaller steps will not help either.
const LEAST_POWER: f64 = 0.1;

impl LayerRun<'_> {
    /// Takes the layer to `load` from its present shape, which is in equilibrium.
    pub(super) fn reach(
        &mut self,
        loading: &mut dyn Loading,
        load: f64,
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let pose_fraction = loading.pose_fraction(load);
        let mut kept = self.layer.state();
        let mut power = 1.0;
        loop {
            let felt = self.layer.strain_ratios().all();
            // Also where it stands already, after a solve that failed.
            if !self.place(loading, load, observer)? {
                return Ok(Ending::Interrupted);
            }
            let ratios = self.layer.strain_ratios();
            let onset = pose_fraction * ratios.onset();
            let limits: PerFace<f64> = felt.iter().map(|(_, felt)| limit(*felt, power)).collect();
            let wanted = ratios.all();
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
            let solve = self.solve(None, how, pose_fraction, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            if !solve.converged {
                self.layer.restore(&kept)?;
                power *= 0.5;
                if power < LEAST_POWER {
                    self.warn_of_failure("no equilibrium found", pose_fraction, &solve);
                    return Ok(Ending::GaveUp);
                }
                continue;
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
            // What failed may lie behind: steps recover as fast as they shrank.
            power = (2.0 * power).min(1.0);
        }
    }
}

/// Critical strains that a face may feel next that has felt `felt` of them.
fn limit(felt: f64, power: f64) -> f64 {
    if felt < 1.0 {
        return FIRST.powf(power);
    }
    let next = felt * GROWTH.powf(power);
    if next > LAST { f64::INFINITY } else { next }
}
