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
