//! The tree of the supernodes, and the branches into which it is cut.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::columns;

/// Multiplications and additions of a branch that is not worth being cut: a tenth of a millisecond, hundreds of times
/// what it takes to hand it to another thread.
const LIGHT_BRANCH: f64 = 3e6;

/// Elimination tree of supernodes, cut into branches.
pub(super) struct Tree {
    /// Where the children of every supernode begin among all `children`, and where the last one's end.
    starts: Vec<u32>,
    children: Vec<u32>,
    branches: Vec<Branch>,
    branch_of: Vec<u32>,
    work: f64,
}

/// Supernodes that are eliminated one after the other: a heavy one alone, or some light ones with the same parent and
/// all that is below them.
pub(super) struct Branch {
    /// Ascending, so that children come before their parents.
    pub(super) supernodes: Vec<u32>,
    /// The branch that takes what this one leaves.
    pub(super) parent: Option<usize>,
    /// Number of branches whose parent it is.
    pub(super) waits: usize,
}

impl Tree {
    pub(super) fn new(symbolic: &SymbolicSupernodalCholesky<u32>) -> Self {
        let count = symbolic.n_supernodes();
        let parents = parents(symbolic);
        let (starts, children) = children(&parents);
        let mut below: Vec<f64> = (0..count).map(|s| work(symbolic, s)).collect();
        for supernode in 0..count {
            if let Some(parent) = parents[supernode] {
                below[parent] += below[supernode];
            }
        }
        let roots = parents.iter().zip(&below).filter(|(p, _)| p.is_none());
        let total = roots.map(|(_, work)| work).sum();
        let mut branches: Vec<Branch> = Vec::new();
        let mut branch_of = vec![0; count];
        // The branch of light siblings that is being filled, and how much it has, for every heavy parent and for
        // none.
        let mut filling = vec![None; count + 1];
        // From parents to children: a supernode goes to the branch of its parent if that is light.
        for supernode in (0..count).rev() {
            let parent = parents[supernode];
            let is_light = |s: usize| below[s] <= LIGHT_BRANCH;
            let number = match parent {
                Some(parent) if is_light(parent) => branch_of[parent] as usize,
                _ => {
                    let above = parent.map(|parent| branch_of[parent] as usize);
                    let open: &mut Option<(usize, f64)> = &mut filling[parent.unwrap_or(count)];
                    match open {
                        Some((number, has)) if is_light(supernode) && *has <= LIGHT_BRANCH => {
                            *has += below[supernode];
                            *number
                        }
                        _ => {
                            branches.push(Branch {
                                supernodes: Vec::new(),
                                parent: above,
                                waits: 0,
                            });
                            if let Some(above) = above {
                                branches[above].waits += 1;
                            }
                            let number = branches.len() - 1;
                            if is_light(supernode) {
                                *open = Some((number, below[supernode]));
                            }
                            number
                        }
                    }
                }
            };
            branch_of[supernode] = number as u32;
            branches[number].supernodes.push(supernode as u32);
        }
        for branch in &mut branches {
            branch.supernodes.reverse();
        }
        Self {
            starts,
            children,
            branches,
            branch_of,
            work: total,
        }
    }

    pub(super) fn branches(&self) -> &[Branch] {
        &self.branches
    }

    pub(super) fn branch_of(&self, supernode: usize) -> usize {
        self.branch_of[supernode] as usize
    }

    /// Children of a supernode, ascending.
    pub(super) fn children(&self, supernode: usize) -> &[u32] {
        &self.children[self.starts[supernode] as usize..self.starts[supernode + 1] as usize]
    }

    /// Multiplications and additions of all supernodes.
    pub(super) fn work(&self) -> f64 {
        self.work
    }

    /// Most numbers that update matrices have at a time where supernodes are eliminated one after the other, and what
    /// the largest front needs beside.
    pub(super) fn most_numbers(&self, symbolic: &SymbolicSupernodalCholesky<u32>) -> usize {
        let below = |supernode: usize| symbolic.nnz_per_super()[supernode] as usize;
        let (mut now, mut most, mut beside) = (0, 0, 0);
        for supernode in 0..symbolic.n_supernodes() {
            now += below(supernode).pow(2);
            most = most.max(now);
            let children = self.children(supernode).iter();
            now -= children
                .map(|&child| below(child as usize).pow(2))
                .sum::<usize>();
            beside = beside.max(below(supernode) * columns(symbolic, supernode).len());
        }
        most + beside
    }
}

/// Parent of every supernode: the one with the first row below it.
fn parents(symbolic: &SymbolicSupernodalCholesky<u32>) -> Vec<Option<usize>> {
    let mut supernode_of = vec![0; symbolic.nrows()];
    for supernode in 0..symbolic.n_supernodes() {
        supernode_of[columns(symbolic, supernode)].fill(supernode);
    }
    let first = |s| symbolic.supernode(s).pattern().first();
    (0..symbolic.n_supernodes())
        .map(|s| first(s).map(|&row| supernode_of[row as usize]))
        .collect()
}

fn children(parents: &[Option<usize>]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; parents.len() + 1];
    for &parent in parents.iter().flatten() {
        starts[parent + 1] += 1;
    }
    for supernode in 0..parents.len() {
        starts[supernode + 1] += starts[supernode];
    }
    let mut next = starts.clone();
    let mut children = vec![0; starts[parents.len()] as usize];
    for (child, parent) in (0..).zip(parents) {
        if let Some(parent) = *parent {
            children[next[parent] as usize] = child;
            next[parent] += 1;
        }
    }
    (starts, children)
}

/// Multiplications and additions that the columns of a supernode take.
fn work(symbolic: &SymbolicSupernodalCholesky<u32>, supernode: usize) -> f64 {
    let columns = columns(symbolic, supernode).len();
    let rows = columns + symbolic.nnz_per_super()[supernode] as usize;
    (0..columns)
        .map(|column| ((rows - column) as f64).powi(2))
        .sum()
}
