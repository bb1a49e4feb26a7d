//! What a factorisation costs.

use super::{Kkt, scratch};

/// Cost of one numeric factorisation, from the symbolic analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorCost {
    /// Stored entries of `L`, padding of the supernodes included.
    pub factor_entries: usize,
    /// Bytes that factor, system and work space take.
    pub bytes: usize,
    /// Multiplications and additions of one factorisation.
    pub flops: f64,
}

impl Kkt {
    /// Size and cost of the factor, whether it is there or not.
    pub fn cost(&self) -> FactorCost {
        let symbolic = &self.symbolic;
        let mut flops = 0.0;
        for supernode in 0..symbolic.n_supernodes() {
            let (columns, rows) = self.supernode_shape(supernode);
            flops += (0..columns)
                .map(|column| ((rows - column) as f64).powi(2))
                .sum::<f64>();
        }
        let factor_entries = symbolic.len_val();
        let entries = self.slots.len();
        let numbers = factor_entries + entries + self.pattern.entries();
        let indices = 2 * entries + symbolic.row_idx().len();
        FactorCost {
            factor_entries,
            bytes: size_of::<f64>() * numbers
                + size_of::<u32>() * indices
                + scratch(symbolic)
                    .map(|memory| memory.size_bytes())
                    .iter()
                    .sum::<usize>(),
            flops,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{ConstraintRows, Kkt, LowerPattern, SolverError};

    /// Patches of a layer are kept by the dozen, without what a factorisation brings.
    #[test]
    fn what_is_released_takes_no_memory() -> Result<(), SolverError> {
        let pattern = LowerPattern::from_stencils(3, [[0, 1, 2].as_slice()])?;
        let rows = ConstraintRows::new(vec![0, 1], vec![2], vec![1.0], 3)?;
        let mut kkt = Kkt::new(&pattern, &rows, 1)?;
        let taken = |kkt: &Kkt| {
            let vectors = [&kkt.system, &kkt.values, &kkt.factor].map(Vec::capacity);
            (vectors.iter().sum::<usize>(), kkt.memory.is_some())
        };
        assert_eq!(taken(&kkt), (0, false));
        kkt.factorize(&[2.0, -1.0, 0.0, 2.0, -1.0, 2.0], &[])?;
        let (numbers, has_room) = taken(&kkt);
        assert!(numbers >= 6 + 8 + 8 && has_room, "{numbers} numbers");
        kkt.release();
        assert_eq!(taken(&kkt), (0, false));
        Ok(())
    }
}
