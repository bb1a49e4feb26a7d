//! The permuted lower triangle of the KKT matrix, and its symbolic factorisation.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::supernodal::{
    SymbolicSupernodalCholesky, factorize_supernodal_symbolic_cholesky,
    factorize_supernodal_symbolic_cholesky_scratch,
};

use crate::{ConstraintRows, LowerPattern, SolverError};

/// Pattern of the lower triangle of `[K, H'; H, I]` in elimination order.
pub(crate) struct PermutedSystem {
    pub(crate) lower: SymbolicSparseColMat<u32>,
    /// Position among its values of each entry: first those of `K` in pattern order, then row by row those of `H`, each
    /// row followed by its diagonal.
    pub(crate) slots: Vec<u32>,
}

impl PermutedSystem {
    pub(crate) fn assemble(
        pattern: &LowerPattern,
        rows: &ConstraintRows,
        placement: &[u32],
    ) -> Self {
        let places = Self::entry_places(pattern, rows, placement);
        let (lower, slots) = compress(&places, placement.len());
        Self { lower, slots }
    }

    /// (row, column) in elimination order of every entry, row >= column, in the order of `slots`.
    fn entry_places(
        pattern: &LowerPattern,
        rows: &ConstraintRows,
        placement: &[u32],
    ) -> Vec<(u32, u32)> {
        let ordered = |a: u32, b: u32| (a.max(b), a.min(b));
        let mut places = Vec::with_capacity(pattern.entries() + rows.entries() + rows.count());
        for (column, range) in pattern.column_starts().windows(2).enumerate() {
            for &row in &pattern.rows()[range[0]..range[1]] {
                places.push(ordered(placement[row as usize], placement[column]));
            }
        }
        for row in 0..rows.count() {
            let place = placement[pattern.size() + row];
            let columns = rows.row(row).0.iter();
            places.extend(columns.map(|&column| ordered(place, placement[column])));
            places.push((place, place));
        }
        places
    }
}

/// Compressed columns of distinct entries, and the position of each entry in them.
fn compress(places: &[(u32, u32)], size: usize) -> (SymbolicSparseColMat<u32>, Vec<u32>) {
    // Two stable counting sorts, by row and then by column, order everything in linear time.
    let entries: Vec<u32> = (0..).take(places.len()).collect();
    let (by_row, _) = counting_sort(&entries, size, |entry| places[entry as usize].0);
    let (sorted, starts) = counting_sort(&by_row, size, |entry| places[entry as usize].1);
    let mut position = vec![0; places.len()];
    for (slot, &entry) in (0..).zip(&sorted) {
        position[entry as usize] = slot;
    }
    let rows = sorted
        .iter()
        .map(|&entry| places[entry as usize].0)
        .collect();
    let lower = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
    (lower, position)
}

/// Stable sort of `entries` by a key below `keys`; also where each key starts.
fn counting_sort(entries: &[u32], keys: usize, key: impl Fn(u32) -> u32) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; keys + 1];
    for &entry in entries {
        starts[key(entry) as usize + 1] += 1;
    }
    for bucket in 0..keys {
        starts[bucket + 1] += starts[bucket];
    }
    let mut next = starts.clone();
    let mut sorted = vec![0; entries.len()];
    for &entry in entries {
        let slot = &mut next[key(entry) as usize];
        sorted[*slot as usize] = entry;
        *slot += 1;
    }
    (sorted, starts)
}

/// Supernodal analysis of a lower triangle that is already in elimination order.
pub(crate) fn analyse(
    lower: &SymbolicSparseColMat<u32>,
) -> Result<SymbolicSupernodalCholesky<u32>, SolverError> {
    let size = lower.ncols();
    let too_large = |_| SolverError::TooLarge { size };
    // The analysis reads the upper triangle only.
    let upper = lower.transpose().to_col_major().map_err(too_large)?;
    let mut memory = MemBuffer::new(StackReq::or(
        prefactorize_symbolic_cholesky_scratch::<u32>(size, upper.compute_nnz()),
        factorize_supernodal_symbolic_cholesky_scratch::<u32>(size),
    ));
    let mut tree = vec![0; size];
    let mut column_counts = vec![0; size];
    let tree = prefactorize_symbolic_cholesky(
        &mut tree,
        &mut column_counts,
        upper.as_ref(),
        MemStack::new(&mut memory),
    );
    // Supernodal without asking faer to choose: it chose so on every mesh tried, and the simplicial
    // method took eleven times as long.
    factorize_supernodal_symbolic_cholesky(
        upper.as_ref(),
        tree,
        &column_counts,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(too_large)
}
