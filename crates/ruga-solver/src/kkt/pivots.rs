//! The signs of the factor's pivots.

use super::Kkt;
use crate::SolverError;

/// Least pivot that a negative one is turned into, in median diagonal entries: a step along a mode that hardly has a
/// curvature would have no end.
const LEAST_PIVOT: f64 = 3e-3;

impl Kkt {
    fn supernode_shape(&self, supernode: usize) -> (usize, usize) {
        let symbolic = self.fronts.symbolic();
        let columns = symbolic.supernode_end()[supernode] - symbolic.supernode_begin()[supernode];
        let rows = columns + symbolic.nnz_per_super()[supernode];
        (columns as usize, rows as usize)
    }

    /// Position in the factor of every entry of `D`, which faer stores on the diagonal of each supernode, in the order
    /// of elimination.
    fn pivot_places(&self) -> impl Iterator<Item = usize> {
        let symbolic = self.fronts.symbolic();
        (0..symbolic.n_supernodes()).flat_map(|supernode| {
            let (columns, rows) = self.supernode_shape(supernode);
            let start = symbolic.col_ptr_for_val()[supernode] as usize;
            (0..columns).map(move |column| start + column * (rows + 1))
        })
    }

    /// Counts negative entries of `D`.
    pub(super) fn negative_pivots(&self) -> Result<usize, SolverError> {
        let mut negative = 0;
        for (index, place) in self.pivot_places().enumerate() {
            let pivot = self.factor[place];
            if !pivot.is_finite() || pivot == 0.0 {
                return Err(SolverError::Breakdown { pivot: index });
            }
            negative += usize::from(pivot < 0.0);
        }
        Ok(negative)
    }

    /// Turns negative pivots of a system without rows positive, until the next factorisation: that of `L |D| L'`
    /// instead of `L D L'`.
    ///
    /// A step with this factor goes as far down along a mode of negative curvature as it would up along one of the
    /// same positive curvature. Only [`solve_once`](Self::solve_once) makes such a step: refinement measures by the
    /// matrix itself. False, and nothing done, where there is no factor because a pivot broke down.
    pub(crate) fn turn_negative_pivots(&mut self) -> bool {
        if !self.factorized {
            return false;
        }
        let negative = self
            .pivot_places()
            .filter(|place| self.factor[*place] < 0.0);
        for place in negative.collect::<Vec<_>>() {
            self.factor[place] = self.factor[place].abs().max(LEAST_PIVOT);
        }
        self.is_turned = true;
        true
    }

    /// Whether negative pivots of the factor have been turned positive.
    pub(crate) fn is_turned(&self) -> bool {
        self.is_turned
    }
}

#[cfg(test)]
mod tests {
    use crate::{ConstraintRows, Kkt, LowerPattern};

    #[test]
    fn turned_pivots_step_down_from_a_saddle() -> Result<(), Box<dyn std::error::Error>> {
        let stencils: [&[usize]; 2] = [&[0, 1], &[2]];
        let pattern = LowerPattern::from_stencils(3, stencils)?;
        let mut kkt = Kkt::new(&pattern, &ConstraintRows::none(3), 1)?;
        // [[4, 2], [2, -1]] has one pivot of each sign in either order; the third entry all but vanishes.
        let (force, mut step) = ([1.0, 2.0, 1.0], [0.0; 3]);
        let values = [4.0, 2.0, -1.0, -1e-9];
        assert!(!kkt.turn_negative_pivots(), "there is no factor yet");
        assert_eq!(kkt.factorize(&values, &[])?.negative, 2);
        assert!(kkt.turn_negative_pivots());
        kkt.solve_once(&force, &mut step)?;
        let down: f64 = force.iter().zip(&step).map(|(f, p)| f * p).sum();
        assert!(down > 0.0, "a step against the force: {step:?}");
        // The median diagonal entry is 1, and the pivot no less than 0.003 of it.
        assert!((step[2] - 1.0 / 3e-3).abs() < 1e-6, "{step:?}");
        // The next factor is that of the matrix again: 4 x + 2 y = 1, 2 x - y = 2.
        kkt.factorize(&values, &[])?;
        assert!(!kkt.is_turned());
        kkt.solve_step(&force, &[], &mut step, &mut [])?;
        let exact = [0.625, -0.75];
        for (found, exact) in step.iter().zip(exact) {
            assert!((found - exact).abs() < 1e-9, "{step:?}");
        }
        Ok(())
    }
}
