//! The load path of a layer to a key at which the surface below stands from the beginning.
//!
//! Wrinkles keep the wavelength with which they begin, so that every place has to begin near its own
//! critical strain. Where one place is compressed many times as much as another, a sequence of weights
//! passes both onsets only in many steps. Here the surface goes to its place at once, and the strain
//! ratio that is loaded on every face grows from solve to solve: nearly all places
//! begin to wrinkle in the first solve, the last ones in the second, and none of them far above its onset.

use ruga_mesh::PerFace;
use ruga_solver::{AtSaddle, StopRule};

use super::{Accuracy, Ending, LayerRun, Loading};
use crate::preparing::Preparing;
use crate::run::patches::Width;
use crate::run::strain_ratio::largest;
use crate::{Observer, Phase, StepperError};

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

impl<'a> LayerRun<'a> {
    /// Takes the layer to every one of `loads`, which are results, with nothing on the way but what it
    /// takes to let every place begin to wrinkle at its own onset; where that fails, from load to load.
    ///
    /// With a run of the same layer on a `coarse` mesh, the pattern is found on that, and carried over at
    /// every load. This holds in motion, too: layers on others are thin and light, and follow at once.
    pub(crate) fn reach_all(
        &mut self,
        coarse: Option<LayerRun<'a>>,
        loading: &mut dyn Loading,
        loads: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let (start, was_flat) = (self.layer.state(), self.layer.strain_ratio() < 1.0);
        let warned = self.warnings.len();
        if let Some(mut coarse) = coarse {
            let ending = self.reach_each(Some(&mut coarse), loading, loads, observer)?;
            // What is wrong with the coarse mesh is not wrong with the result.
            coarse.warnings.clear();
            if ending == Ending::GaveUp {
                coarse.report.onset_load = None;
                coarse.relaxation = 0.0;
            }
            self.take_history(coarse);
            if ending != Ending::GaveUp {
                return Ok(ending);
            }
            self.layer.restore(&start)?;
            self.warnings.truncate(warned);
        }
        let ending = self.reach_each(None, loading, loads, observer)?;
        if ending == Ending::GaveUp && was_flat {
            // Another way may lead past the triangles that collapse on this one.
            self.layer.restore(&start)?;
            self.warnings.truncate(warned);
            return self.climb(loading, loads, observer);
        }
        Ok(ending)
    }

    fn reach_each(
        &mut self,
        mut coarse: Option<&mut LayerRun<'a>>,
        loading: &mut dyn Loading,
        loads: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let mut from = 0.0;
        for load in loads {
            if let Some(coarse) = &mut coarse {
                match coarse.reach(loading, (from, *load), observer) {
                    Ok(Ending::Reached) => {}
                    Ok(ending) => return Ok(ending),
                    // The fine mesh can do without.
                    Err(_) => return Ok(Ending::GaveUp),
                }
                coarse.release();
                if !self.take_pattern(coarse, (loading, *load), observer)? {
                    return Ok(Ending::Interrupted);
                }
            }
            let ending = self.reach(loading, (from, *load), observer)?;
            if ending != Ending::Reached {
                return Ok(ending);
            }
            // Surfaces on the output mesh, and the layers above, take as much memory as what this layer was
            // solved with.
            self.release();
            if !loading.kept(self, *load, observer)? {
                return Ok(Ending::Interrupted);
            }
            from = loading.pose_fraction(*load);
        }
        Ok(Ending::Reached)
    }

    /// Takes over what `coarse` has become at `load`; false when the observer ends the work.
    fn take_pattern(
        &mut self,
        coarse: &LayerRun<'_>,
        (loading, load): (&dyn Loading, f64),
        observer: &mut dyn Observer,
    ) -> Result<bool, StepperError> {
        if !self.place(loading, load, observer)? {
            return Ok(false);
        }
        let ratios = coarse.layer.strain_ratios().all();
        let mut preparing = Preparing::new(observer, self.index, Phase::Sampling);
        self.relaxation = coarse.relaxation;
        self.layer
            .take_shape(&coarse.layer, &ratios, &mut || preparing.goes_on())
    }

    /// Takes the layer to `load` from its present shape, which is in equilibrium, the last key at the
    /// fraction `from` of the pose.
    fn reach(
        &mut self,
        loading: &mut dyn Loading,
        (from, load): (f64, f64),
        observer: &mut dyn Observer,
    ) -> Result<Ending, StepperError> {
        let pose_fraction = loading.pose_fraction(load);
        let mut kept = self.layer.state();
        let drawn = self.layer.crease_strengths().clone();
        if self.layer.strain_ratio() < 1.0 {
            // The first pattern is chosen with care, and not in patches that are left from another key.
            self.relaxation = 0.0;
            (self.patches, self.wide) = (None, None);
        }
        loop {
            let felt = self.layer.strain_ratios().all();
            // Nearly all first wrinkles are found on the whole, or in wide patches: narrow ones would fit them
            // between their borders, and a film came out with waves 9 % too short in patches of two.
            if self.patches.is_none() && self.layer.strain_ratio() > 1.0 {
                self.patches = self.patches_of(Width::Narrow);
                if self.patches.is_some() {
                    self.kkt = None;
                    self.layer.release_pattern();
                }
            }
            if !self.place(loading, load, observer)? {
                return Ok(Ending::Interrupted);
            }
            let ratios = self.layer.strain_ratios();
            let onset = pose_fraction * ratios.onset();
            let limits: PerFace<f64> = felt.iter().map(|(_, felt)| limit(*felt)).collect();
            let wanted = ratios.all();
            let (largest, most_felt) = (largest(&wanted), largest(&felt));
            let is_last = wanted
                .iter()
                .all(|(face, wanted)| *wanted <= EXCESS * limits[face]);
            if !is_last {
                self.layer.limit_strains(&limits)?;
            }
            let accuracy = match is_last && !self.is_coarse {
                true => Accuracy::Result,
                false => Accuracy::Passing,
            };
            // The next solve goes on from a saddle as well as from a minimum. Not where wrinkles begin: there their
            // energy is still to be gained, though not by the first steps, and far above its onset a film that was
            // left flat would wrinkle with another wavelength. The last few places of the first solve may wait for
            // the second, which leaves none. On a coarse mesh they cost little, and normals of a film that took such a
            // pattern over were .3 degrees further off.
            let begins = |(face, wanted): (_, &f64)| begins(felt[face], *wanted);
            let at_saddle = if is_last {
                AtSaddle::Leave
            } else if most_felt < 1.0 && !self.is_coarse {
                AtSaddle::PassFew
            } else if wanted.iter().any(begins) {
                AtSaddle::Leave
            } else {
                AtSaddle::Pass
            };
            // These are not needed while the layer is solved, when memory is most.
            drop((felt, limits, wanted));
            let how = (at_saddle, accuracy);
            let loaded = self.layer.strain_ratio();
            let share = match is_last {
                true => 1.0,
                false => (1.0 + loaded).ln() / (1.0 + largest).ln(),
            };
            let shown = from.min(pose_fraction) + (pose_fraction - from).max(0.0) * share;
            // Folds deepen with the strain: drawn at once, in skin that is hardly compressed yet, those of a
            // smile took twice as many factorisations.
            self.layer.draw_part_of_creases(&drawn, share)?;
            let solve = self.solve(None, how, shown, observer)?;
            if solve.stop == StopRule::Interrupted {
                return Ok(Ending::Interrupted);
            }
            if !solve.converged {
                let what = format!(
                    "no equilibrium found beyond {most_felt:.1} times the strain at which the layer wrinkles, of \
                     {largest:.1} times that are asked for,"
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
                return Ok(Ending::Reached);
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

/// Whether a face that has `felt` one strain ratio is so near its onset in the solve that brings it nearer to the one
/// that is `wanted` that its pattern is not there yet.
fn begins(felt: f64, wanted: f64) -> bool {
    felt < GROWTH && wanted > felt.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrinkles_begin_in_the_first_two_solves_beyond_the_onset() {
        assert!(!begins(0.0, 0.9), "never");
        assert!(begins(0.9, 1.02) && begins(0.0, 8.0));
        assert!(begins(limit(0.0), 8.0));
        assert!(!begins(limit(limit(0.0)), 8.0));
        assert!(!begins(1.02, 1.02), "as it was in the solve before");
        assert!(begins(1.02, 1.46), "another key goes on from there");
    }
}
