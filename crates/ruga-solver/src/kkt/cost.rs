//! What a factorisation costs.

use super::{Kkt, scratch};

/// Cost of one numeric factorisation, from the symbolic analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorCost {
    /// Stored entries of `L`, padding of the supernodes included.
    pub factor_entries: usize,
    /// Bytes that factor, matrix and work space take on one thread.
    pub bytes: usize,
    /// Multiplications and additions of one factorisation.
    pub flops: f64,
}

impl Kkt {
    /// Size and cost of the factor, whether it is there or not.
    pub fn cost(&self) -> FactorCost {
        let symbolic = self.fronts.symbolic();
        let factor_entries = symbolic.len_val();
        let entries = self.slots.len();
        FactorCost {
            factor_entries,
            bytes: size_of::<f64>() * (factor_entries + self.pattern.entries())
                + size_of::<u32>() * (entries + symbolic.row_idx().len())
                + self.fronts.bytes()
                + scratch(symbolic).size_bytes(),
            flops: self.fronts.work(),
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
            let vectors = [&kkt.values, &kkt.factor].map(Vec::capacity);
            (vectors.iter().sum::<usize>(), kkt.memory.is_some())
        };
        assert_eq!(taken(&kkt), (0, false));
        kkt.factorize(&[2.0, -1.0, 0.0, 2.0, -1.0, 2.0], &[])?;
        let (numbers, has_room) = taken(&kkt);
        assert!(numbers >= 6 + 8 && has_room, "{numbers} numbers");
        kkt.release();
        assert_eq!(taken(&kkt), (0, false));
        Ok(())
    }
}
