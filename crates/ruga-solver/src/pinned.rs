//! Unknowns that are held, by leaving them out of the system.

use crate::error::{check_finite, check_length};
use crate::kkt::check_damping;
use crate::{LowerPattern, Objective, SolverError};

/// An objective of which some unknowns stay where they are.
///
/// Pinned unknowns are eliminated, instead of held by constraint rows: the system has the free
/// ones only, in their order. [`free`](Self::free) and [`merge`](Self::merge) go from all unknowns
/// to these and back.
pub struct Pinned<'a> {
    objective: &'a dyn Objective,
    /// All unknowns; the pinned ones at their values.
    all: Vec<f64>,
    free: Vec<usize>,
    pattern: LowerPattern,
    /// Entries of the whole pattern that the free unknowns have.
    entries: Vec<usize>,
    damping: Vec<f64>,
}

impl<'a> Pinned<'a> {
    /// Holds the unknowns of `objective` that are `pinned` at their values in `x`.
    ///
    /// # Errors
    /// [`SolverError::SizeMismatch`] when there is not one flag and one value per unknown or the
    /// objective's damping does not fit, [`SolverError::NotFinite`] for `x`,
    /// [`SolverError::Empty`] when all are pinned.
    pub fn new(
        objective: &'a dyn Objective,
        pinned: &[bool],
        x: &[f64],
    ) -> Result<Self, SolverError> {
        let whole = objective.pattern();
        check_length("pinned", whole.size(), pinned.len())?;
        check_length("x", whole.size(), x.len())?;
        check_finite("x", x)?;
        check_damping(whole, objective.damping())?;
        let free: Vec<usize> = (0..whole.size()).filter(|&i| !pinned[i]).collect();
        let mut number = vec![0_u32; whole.size()];
        for (new, &old) in (0..).zip(&free) {
            number[old] = new;
        }
        let (mut starts, mut rows, mut entries) = (vec![0], Vec::new(), Vec::new());
        for &column in &free {
            // The lower triangle of what is left is lower still: numbers keep their order.
            for entry in whole.column_starts()[column]..whole.column_starts()[column + 1] {
                let row = whole.rows()[entry] as usize;
                if !pinned[row] {
                    rows.push(number[row]);
                    entries.push(entry);
                }
            }
            starts.push(rows.len());
        }
        let damping = objective.damping();
        Ok(Self {
            objective,
            all: x.to_vec(),
            pattern: LowerPattern::new(starts, rows)?,
            damping: match damping {
                [] => Vec::new(),
                _ => free.iter().map(|&i| damping[i]).collect(),
            },
            free,
            entries,
        })
    }

    /// Values of the free unknowns, out of those of all.
    ///
    /// # Panics
    /// When `all` has fewer values than there are unknowns.
    pub fn free(&self, all: &[f64]) -> Vec<f64> {
        self.free.iter().map(|&i| all[i]).collect()
    }

    /// All unknowns, with the free ones at `x`.
    pub fn merge(&self, x: &[f64]) -> Vec<f64> {
        let mut all = self.all.clone();
        for (&i, value) in self.free.iter().zip(x) {
            all[i] = *value;
        }
        all
    }
}

impl Objective for Pinned<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.objective.value(&self.merge(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut whole = vec![0.0; self.all.len()];
        let energy = self.objective.gradient(&self.merge(x), &mut whole);
        gradient.copy_from_slice(&self.free(&whole));
        energy
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let entries = self.objective.pattern().entries();
        let [mut first, mut second] = [vec![0.0; entries], vec![0.0; entries]];
        let all = self.merge(x);
        self.objective.hessian(&all, &mut first, &mut second);
        for (k, &entry) in self.entries.iter().enumerate() {
            exact[k] = first[entry];
            relaxed[k] = second[entry];
        }
    }

    fn damping(&self) -> &[f64] {
        &self.damping
    }

    fn energy_scale(&self) -> f64 {
        self.objective.energy_scale()
    }

    fn force_scale(&self) -> f64 {
        self.objective.force_scale()
    }

    fn length_scale(&self) -> f64 {
        self.objective.length_scale()
    }
}
