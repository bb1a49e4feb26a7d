//! A step along what the last sweeps did, to where the next ones would lead.
//!
//! Where something slides across many patches, every sweep leaves about the same share of it to go. A step is cheap
//! beside a sweep: it asks for some gradients of the whole. It looks for the lowest energy among the last two
//! directions, as the method of conjugate gradients does in its locally optimal form (Knyazev 2001); what there is a
//! preconditioner is here a sweep.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::Whole;

/// Directions at most: that of the last sweep, and that of the sweep before it with the step after it.
const DIRECTIONS: usize = 2;

/// Share of the largest curvature up to which a direction counts as flat or bent down, where a step has no
/// natural length.
const FLAT: f64 = 1e-6;

/// Length of a step at most, in lengths of its directions. Where a sweep leaves four fifths of a way the rest is four
/// times as long as what it did.
const LONGEST: f64 = 20.0;

/// Lengths that are tried: the one that curvatures promise, and the lowest of the parabola through what that finds.
const TRIALS: usize = 2;

/// Share of a length from which on the parabola's is not worth a trial.
const NEARLY: f64 = 0.8;

/// The directions of the last sweeps and steps.
#[derive(Default)]
pub(super) struct Extrapolation {
    directions: Vec<Vec<f64>>,
}

impl Extrapolation {
    /// Moves the coordinates `x`, where a sweep from `start` has led (both m), along the last directions to an energy
    /// of the `whole` that is lower by more than `least` (J); false where there is none.
    ///
    /// A direction changes a row by what its sweep restored of it, so that `x` may violate rows by some thousandths of
    /// a displacement; the next sweep restores that.
    pub(super) fn step(
        &mut self,
        whole: &Whole<'_>,
        (start, x): (&[f64], &mut [f64]),
        least: f64,
    ) -> bool {
        let from_start = |x: &[f64]| -> Vec<f64> {
            let pairs = x.iter().zip(start);
            pairs.map(|(x, start)| x - start).collect()
        };
        self.directions.insert(0, from_start(x));
        self.directions.truncate(DIRECTIONS);
        let lower = self.lengths(whole, x).and_then(|(lengths, slope)| {
            let energy = whole.value(x);
            let (mut lower, mut gained, mut factor) = (None, least, 1.0);
            for _ in 0..TRIALS {
                let there = self.along(x, &(&lengths * factor));
                let gain = energy - whole.value(&there);
                if gain > gained {
                    (lower, gained) = (Some(there), gain);
                }
                factor *= 0.5 * slope * factor / (slope * factor + gain);
                if !(factor > 0.0 && factor < NEARLY) {
                    break;
                }
            }
            lower
        });
        let Some(lower) = lower else { return false };
        x.copy_from_slice(&lower);
        self.directions[0] = from_start(x);
        true
    }

    /// Lengths along the directions to the lowest energy, by slopes at `x` and at their ends, and the slope there;
    /// `None` where a derivative is not finite.
    fn lengths(&self, whole: &Whole<'_>, x: &[f64]) -> Option<(DVector<f64>, f64)> {
        let count = self.directions.len();
        let slopes = |x: &[f64]| {
            let gradient = whole.gradient(x);
            let along =
                |direction: &Vec<f64>| direction.iter().zip(&gradient).map(|(a, b)| a * b).sum();
            DVector::<f64>::from_iterator(count, self.directions.iter().map(along))
        };
        let here = slopes(x);
        let units = DMatrix::<f64>::identity(count, count);
        let changes: Vec<_> = units
            .column_iter()
            .map(|unit| slopes(&self.along(x, &unit.into_owned())) - &here)
            .collect();
        let changes = DMatrix::from_columns(&changes);
        let curvatures = 0.5 * (&changes + changes.transpose());
        if !curvatures.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let modes = SymmetricEigen::new(curvatures);
        let least = FLAT * modes.eigenvalues.amax();
        let mut lengths = DVector::zeros(count);
        for (value, mode) in modes
            .eigenvalues
            .iter()
            .zip(modes.eigenvectors.column_iter())
        {
            if *value > least {
                lengths -= mode * (mode.dot(&here) / value);
            }
        }
        lengths *= (LONGEST / lengths.amax()).min(1.0);
        let slope = lengths.dot(&here);
        Some((lengths, slope))
    }

    fn along(&self, x: &[f64], lengths: &DVector<f64>) -> Vec<f64> {
        let mut there = x.to_vec();
        for (length, direction) in lengths.iter().zip(&self.directions) {
            for (there, direction) in there.iter_mut().zip(direction) {
                *there += length * direction;
            }
        }
        there
    }
}

#[cfg(test)]
mod tests {
    use ruga_material::{LayerMaterial, Substrate, WavelengthModel, wrinkling};
    use ruga_shell::{BendingModel, LayerEnergy};
    use ruga_solver::ConstraintRows;

    use super::super::Scales;
    use super::super::tests::strip;
    use super::*;

    /// Nine tenths of a shape are left by a sweep: the step goes on to where the energy is lowest, and gains nothing
    /// from there.
    #[test]
    fn a_step_ends_where_the_energy_along_the_last_sweep_is_lowest() {
        let (mesh, rest, parameters) = strip();
        let (held, model) = ([false; 82], BendingModel::VertexCurvature);
        let energy = LayerEnergy::with_bending(&mesh, &rest, parameters, &held, model);
        let energy = energy.expect("a layer");
        let rows = ConstraintRows::none(energy.dof_count());
        let material = LayerMaterial {
            young: 1.0,
            poisson: 0.4,
            thickness: 0.1,
            density: 1.0,
        };
        let below = Substrate {
            young: 0.01,
            poisson: 0.4,
            thickness: 10.0,
        };
        let wrinkling = wrinkling(&material, &below, WavelengthModel::HalfSpace).expect("a film");
        let none = vec![0.0; energy.dof_count()];
        let whole = Whole {
            energy: &energy,
            positions: &rest,
            load: [&none, &none],
            damping: &none,
            rows: &rows,
            targets: &[],
            scales: Scales {
                energy: 1.0,
                vertex_area: 1.0,
                wrinkling: &wrinkling,
                thickness: 0.1,
            },
        };
        let flat: Vec<f64> = rest.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        let lifted = |height: f64| -> Vec<f64> {
            let lift = |i: usize| match i % 3 {
                2 => height * (0.3 * i as f64).sin(),
                _ => 0.0,
            };
            (0..).zip(&flat).map(|(i, x)| x + lift(i)).collect()
        };
        let (start, mut x) = (lifted(0.01), lifted(0.009));
        assert!(Extrapolation::default().step(&whole, (&start, &mut x), 0.0));
        let left = whole.value(&x) / whole.value(&start);
        assert!(left < 1e-4, "{left}");
        // Two directions that share one shape.
        let mut steps = Extrapolation::default();
        let (mut first, mut second) = (lifted(0.009), lifted(0.0085));
        assert!(steps.step(&whole, (&start, &mut first), 0.0));
        let start_of_second = lifted(0.0088);
        assert!(steps.step(&whole, (&start_of_second, &mut second), 0.0));
        let left = whole.value(&second) / whole.value(&start);
        assert!(left < 1e-4, "{left}");
        // What is to be gained is too little.
        let mut near = lifted(0.009);
        let energy = whole.value(&near);
        assert!(!Extrapolation::default().step(&whole, (&start, &mut near), energy));
        let mut lowest = flat.clone();
        assert!(!Extrapolation::default().step(&whole, (&start, &mut lowest), 0.0));
        assert_eq!(lowest, flat);
        let mut unknown = vec![f64::NAN; flat.len()];
        assert!(!Extrapolation::default().step(&whole, (&start, &mut unknown), 0.0));
    }
}
