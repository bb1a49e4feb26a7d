//! Numeric factorisation `L D L'` by fronts, on the threads of the rayon pool that it is called in.
//!
//! A front is a supernode with the rows below it: the dense matrix in which its columns are eliminated. What that
//! changes in the rows below, its update matrix, is added to the front of its parent in the elimination tree
//! (multifrontal method: Duff and Reid, *ACM Trans. Math. Software* 9, 1983). Fronts of different branches do not
//! know of each other and may be eliminated side by side, and the products of large ones are cut into pieces that
//! may, too. What is cut, and in which order update matrices are added up, depends on the pattern alone, so that the
//! factor has the same bits on any number of threads. Outside of a pool all of it is done by the caller's thread.

mod dense;
mod tree;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use faer::MatMut;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use rayon::Scope;

use dense::eliminate;
use tree::Tree;

/// Supernodes of a factor, and the branches of their tree that may be worked on side by side.
pub(crate) struct Fronts {
    symbolic: SymbolicSupernodalCholesky<u32>,
    tree: Tree,
}

/// Change of the rows below a supernode by its elimination: lower triangle of a square matrix, by columns.
type Update = Vec<f64>;

/// A pivot that is zero or not finite, by its place in the elimination order.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct BadPivot(pub(crate) usize);

/// Why a front was not eliminated.
enum Failure {
    Pivot(BadPivot),
    /// One of its children was not.
    Child,
}

impl Fronts {
    pub(crate) fn new(symbolic: SymbolicSupernodalCholesky<u32>) -> Self {
        let tree = Tree::new(&symbolic);
        Self { symbolic, tree }
    }

    pub(crate) fn symbolic(&self) -> &SymbolicSupernodalCholesky<u32> {
        &self.symbolic
    }

    /// Multiplications and additions of one factorisation.
    pub(crate) fn work(&self) -> f64 {
        self.tree.work()
    }

    /// Bytes that are taken beside the factor by one thread. Others add the update matrices of the branches that
    /// they work on.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<f64>() * self.tree.most_numbers(&self.symbolic)
    }

    /// Position in the factor of every entry of the matrix, of whose lower triangle this is the pattern.
    pub(crate) fn places(&self, lower: SymbolicSparseColMatRef<'_, u32>) -> Vec<u32> {
        let mut places = Vec::with_capacity(lower.compute_nnz());
        for supernode in 0..self.symbolic.n_supernodes() {
            let columns = columns(&self.symbolic, supernode);
            let below = self.symbolic.supernode(supernode).pattern();
            let rows = columns.len() + below.len();
            let start = self.symbolic.col_ptr_for_val()[supernode] as usize;
            for column in columns.clone() {
                let start = start + (column - columns.start) * rows;
                let mut finder = RowFinder::new(&columns, below);
                let entries = lower.row_idx_of_col_raw(column).iter();
                // The analysis has refused factors with more entries than 31 bits can number.
                places.extend(entries.map(|&row| (start + finder.find(row)) as u32));
            }
        }
        places
    }

    /// Factorises in place: `values` is the lower triangle of the matrix at its [places](Self::places), zero
    /// elsewhere, and becomes `L` with `D` on its diagonal. Of several bad pivots the first is told.
    pub(crate) fn factorize(&self, values: &mut [f64]) -> Result<(), BadPivot> {
        let branches = self.tree.branches();
        let mut columns: Vec<_> = branches.iter().map(|_| Vec::new()).collect();
        let mut rest = values;
        for supernode in 0..self.symbolic.n_supernodes() {
            let [start, end] = [supernode, supernode + 1]
                .map(|place| self.symbolic.col_ptr_for_val()[place] as usize);
            let (own, others) = rest.split_at_mut(end - start);
            columns[self.tree.branch_of(supernode)].push(own);
            rest = others;
        }
        let no_update = || Mutex::new(None);
        let run = Run {
            fronts: self,
            columns: columns.into_iter().map(Mutex::new).collect(),
            updates: (0..self.symbolic.n_supernodes())
                .map(|_| no_update())
                .collect(),
            waits: branches
                .iter()
                .map(|branch| AtomicUsize::new(branch.waits))
                .collect(),
            bad_pivot: Mutex::new(None),
        };
        let is_leaf = |number: &usize| branches[*number].waits == 0;
        let leaves = (0..branches.len()).filter(is_leaf);
        if branches.len() > 1 && is_in_a_pool() {
            rayon::scope(|scope| leaves.for_each(|number| run.spawn(scope, number)));
        } else {
            leaves.for_each(|number| run.eliminate_from(number));
        }
        match run
            .bad_pivot
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
        {
            None => Ok(()),
            Some(pivot) => Err(BadPivot(pivot)),
        }
    }
}

/// Whether the present thread belongs to a pool. Elsewhere rayon would hand work over to a pool of its own, and let
/// the caller wait.
fn is_in_a_pool() -> bool {
    rayon::current_thread_index().is_some()
}

/// A factorisation under way.
struct Run<'a> {
    fronts: &'a Fronts,
    /// Columns of the supernodes of every branch.
    columns: Vec<Mutex<Vec<&'a mut [f64]>>>,
    /// Update matrix of every supernode that waits for its parent.
    updates: Vec<Mutex<Option<Update>>>,
    /// Branches that every branch still waits for.
    waits: Vec<AtomicUsize>,
    /// The first bad pivot so far.
    bad_pivot: Mutex<Option<usize>>,
}

impl Run<'_> {
    fn spawn<'s>(&'s self, scope: &Scope<'s>, first: usize) {
        scope.spawn(move |_| self.eliminate_from(first));
    }

    /// Eliminates a branch, and those above it that wait for it alone.
    fn eliminate_from(&self, first: usize) {
        let mut branch = Some(first);
        while let Some(number) = branch {
            self.eliminate_branch(number);
            let parent = self.fronts.tree.branches()[number].parent;
            branch = parent.filter(|&above| self.waits[above].fetch_sub(1, Ordering::AcqRel) == 1);
        }
    }

    fn eliminate_branch(&self, number: usize) {
        let columns = std::mem::take(&mut *lock(&self.columns[number]));
        let supernodes = &self.fronts.tree.branches()[number].supernodes;
        for (&supernode, columns) in supernodes.iter().zip(columns) {
            match self.front(supernode as usize, columns) {
                Ok(update) => *lock(&self.updates[supernode as usize]) = Some(update),
                Err(Failure::Child) => {}
                Err(Failure::Pivot(BadPivot(pivot))) => {
                    // All others that can go on do, so that which pivot is told does not depend on who was first.
                    let mut first = lock(&self.bad_pivot);
                    *first = Some(first.map_or(pivot, |first| first.min(pivot)));
                }
            }
        }
    }

    /// Eliminates one supernode from its front.
    fn front(&self, supernode: usize, columns: &mut [f64]) -> Result<Update, Failure> {
        let symbolic = &self.fronts.symbolic;
        let range = self::columns(symbolic, supernode);
        let below = symbolic.supernode(supernode).pattern();
        let mut update = vec![0.0; below.len() * below.len()];
        for &child in self.fronts.tree.children(supernode) {
            let own = lock(&self.updates[child as usize]).take();
            let own = own.ok_or(Failure::Child)?;
            let rows = symbolic.supernode(child as usize).pattern();
            extend_add((&own, rows), (columns, &mut update), (&range, below));
        }
        let rows = range.len() + below.len();
        let front = MatMut::from_column_major_slice_mut(columns, rows, range.len());
        let square = MatMut::from_column_major_slice_mut(&mut update, below.len(), below.len());
        eliminate(front, square).map_err(|pivot| Failure::Pivot(BadPivot(range.start + pivot)))?;
        Ok(update)
    }
}

/// Adds a child's `own` update matrix of these rows to the front of its parent, which has `columns` and rows `below`,
/// and to that one's update matrix.
fn extend_add(
    (own, rows): (&[f64], &[u32]),
    (front, update): (&mut [f64], &mut [f64]),
    (columns, below): (&Range<usize>, &[u32]),
) {
    let (width, height) = (columns.len(), columns.len() + below.len());
    let runs = runs(rows, RowFinder::new(columns, below));
    for (number, run) in runs.iter().enumerate() {
        for j in 0..run.length {
            let values = &own[(run.from + j) * rows.len()..][..rows.len()];
            // Columns of the update matrix begin with the first row below.
            let (target, shift) = match run.to + j {
                place if place < width => (&mut front[place * height..][..height], 0),
                place => {
                    let start = (place - width) * below.len();
                    (&mut update[start..][..below.len()], width)
                }
            };
            let first = Rows {
                from: run.from + j,
                to: run.to + j,
                length: run.length - j,
            };
            for rows in std::iter::once(&first).chain(&runs[number + 1..]) {
                let target = &mut target[rows.to - shift..][..rows.length];
                for (entry, value) in target.iter_mut().zip(&values[rows.from..]) {
                    *entry += value;
                }
            }
        }
    }
}

/// Rows that follow one another in a child and in its parent.
struct Rows {
    from: usize,
    to: usize,
    length: usize,
}

fn runs(rows: &[u32], mut finder: RowFinder<'_>) -> Vec<Rows> {
    let mut runs: Vec<Rows> = Vec::new();
    let width = finder.columns.len();
    for (from, &row) in rows.iter().enumerate() {
        let to = finder.find(row);
        match runs.last_mut() {
            // A run does not go on from the columns of the parent to the rows below.
            Some(run) if run.to + run.length == to && to != width => run.length += 1,
            _ => runs.push(Rows {
                from,
                to,
                length: 1,
            }),
        }
    }
    runs
}

/// Finds the places of rows in a front, of rows that ascend.
struct RowFinder<'a> {
    columns: &'a Range<usize>,
    below: &'a [u32],
    passed: usize,
}

impl<'a> RowFinder<'a> {
    fn new(columns: &'a Range<usize>, below: &'a [u32]) -> Self {
        Self {
            columns,
            below,
            passed: 0,
        }
    }

    /// Place of a row that the front has.
    fn find(&mut self, row: u32) -> usize {
        if (row as usize) < self.columns.end {
            return row as usize - self.columns.start;
        }
        while self.below[self.passed] != row {
            self.passed += 1;
        }
        self.columns.len() + self.passed
    }
}

/// Columns of a supernode.
fn columns(symbolic: &SymbolicSupernodalCholesky<u32>, supernode: usize) -> Range<usize> {
    let [start, end] = [symbolic.supernode_begin(), symbolic.supernode_end()]
        .map(|places| places[supernode] as usize);
    start..end
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic of another thread is passed on by the scope.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
