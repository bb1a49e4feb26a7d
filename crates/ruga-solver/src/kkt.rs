//! The quasi-definite KKT matrix and its factor.

mod cost;
mod pivots;

pub use cost::FactorCost;

use faer::Conj;
use faer::MatMut;
use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLdltRef, SymbolicSupernodalCholesky};

use crate::error::{check_finite, check_length};
use crate::fronts::{BadPivot, Fronts};
use crate::ordering::check_system;
use crate::permuted_system::{PermutedSystem, analyse};
use crate::{ConstraintRows, EliminationOrder, LowerPattern, SolverError};

/// Regularisation of both diagonal blocks, relative to the median diagonal entry of `K`.
///
/// At 1e-8 three refinements return the unregularised solution to rounding, repeated rows keep
/// the right inertia, and the pivots stay far above rounding; 1e-5 needs a dozen refinements.
const REGULARIZATION: f64 = 1e-8;
/// The same without rows, where it only keeps pivots off zero. The free fall of a sheet in a long time step is as
/// soft as 1e-12 of its median diagonal entry, and refinement makes up for little more than that.
const REGULARIZATION_WITHOUT_ROWS: f64 = 1e-13;

/// Refinements after which a solve gives up on reaching [`REFINED`].
const MAX_REFINEMENTS: usize = 8;

/// Relative residual below which refinement stops; ten thousand vertices cannot go below 5e-14,
/// and every round reads the factor twice.
const REFINED: f64 = 1e-13;

/// Relative residual that will do for a Newton step, which is only as good as its linearisation.
const REFINED_STEP: f64 = 1e-10;

/// Signs of the pivots of a KKT factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inertia {
    /// Number of negative pivots.
    pub negative: usize,
    /// Number of constraint rows, each of which makes one pivot negative.
    pub rows: usize,
}

impl Inertia {
    /// Whether `K` is positive definite on the null space of `H`: the stationary point is a
    /// minimum, not a saddle.
    pub fn is_minimum(&self) -> bool {
        self.negative == self.rows
    }

    /// Number of modes of negative curvature on the null space of `H`.
    pub fn excess(&self) -> usize {
        self.negative.saturating_sub(self.rows)
    }
}

/// The matrix `[K, H'; H, 0]` of one pattern and one set of rows, analysed once and factorised
/// in place as often as needed.
///
/// What is factorised is the quasi-definite
///
/// ```text
/// [ K/k + e I    N H' ]      k = median |diagonal of K|,  N = diag(1 / |row of H|),  e = 1e-8
/// [ N H         - e I ]
/// ```
///
/// as `L D L'` in a nested-dissection order, on all threads of the rayon pool that it is called in, with
/// the same bits on any number of them, and on the caller's thread outside of a pool; iterative
/// refinement removes `e` from solutions. Without rows this is the factorisation of `K` alone, with
/// `e` = 1e-13.
pub struct Kkt {
    pattern: LowerPattern,
    rows: ConstraintRows,
    block: usize,
    /// `1 / |row|`, 1 for a row of zeros.
    row_scales: Vec<f64>,
    order: EliminationOrder,
    fronts: Fronts,
    /// Position in `factor` of each entry of `K`, then row by row of those of `H`, each row followed by its corner.
    slots: Vec<u32>,
    factor: Vec<f64>,
    /// `K` plus damping, in pattern order, for refinement.
    values: Vec<f64>,
    typical_diagonal: f64,
    /// Scratch for the median of the diagonal.
    diagonal: Vec<f64>,
    factorized: bool,
    /// Whether the factor is that of another matrix, with negative pivots turned positive.
    is_turned: bool,
    /// Work space of a solve; there as long as the factor is.
    memory: Option<MemBuffer>,
    /// Work space of a solve: unknowns then rows, the last one in elimination order.
    trial: Vec<f64>,
    residual: Vec<f64>,
    permuted: Vec<f64>,
}

/// Refuses a damping that is neither empty nor one value per unknown.
pub(crate) fn check_damping(pattern: &LowerPattern, damping: &[f64]) -> Result<(), SolverError> {
    match damping {
        [] => Ok(()),
        _ => check_length("damping", pattern.size(), damping.len()),
    }
}

impl Kkt {
    /// Orders and analyses the system.
    ///
    /// `block` is the number of unknowns per vertex and of rows per cluster (3 for shells); rows
    /// that share a cluster must follow one another.
    ///
    /// # Errors
    /// [`SolverError::BlockSize`], [`SizeMismatch`](SolverError::SizeMismatch) when `rows` has
    /// another number of unknowns, [`Ordering`](SolverError::Ordering),
    /// [`TooLarge`](SolverError::TooLarge).
    pub fn new(
        pattern: &LowerPattern,
        rows: &ConstraintRows,
        block: usize,
    ) -> Result<Self, SolverError> {
        // Rows are ordered among the unknowns. Eliminating `K` first needs it positive definite and
        // leaves a dense matrix of the rows: forty times the cost at 67,500 unknowns.
        let order = EliminationOrder::new(pattern, rows, block)?;
        Self::with_order(pattern, rows, block, order)
    }

    /// Analyses the system for an order that was found before, of this system or of another with as many unknowns and
    /// rows, for which it is as right, but slower.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`SizeMismatch`](SolverError::SizeMismatch) for an order of another length, too.
    pub fn with_order(
        pattern: &LowerPattern,
        rows: &ConstraintRows,
        block: usize,
        order: EliminationOrder,
    ) -> Result<Self, SolverError> {
        check_system(pattern, rows, block)?;
        let size = pattern.size() + rows.count();
        check_length("elimination order", size, order.placement().len())?;
        let entries = pattern.entries() + rows.entries() + rows.count();
        i32::try_from(entries).map_err(|_| SolverError::TooLarge { size })?;
        let row_scales = row_scales(rows);
        let assembled = PermutedSystem::assemble(pattern, rows, order.placement());
        let fronts = Fronts::new(analyse(&assembled.lower)?);
        let places = fronts.places(assembled.lower.as_ref());
        let slots = assembled.slots.iter().map(|&entry| places[entry as usize]);
        Ok(Self {
            row_scales,
            order,
            slots: slots.collect(),
            factor: Vec::new(),
            values: Vec::new(),
            typical_diagonal: 1.0,
            diagonal: Vec::new(),
            factorized: false,
            is_turned: false,
            memory: None,
            trial: vec![0.0; size],
            residual: vec![0.0; size],
            permuted: vec![0.0; size],
            fronts,
            pattern: pattern.clone(),
            rows: rows.clone(),
            block,
        })
    }

    /// The pattern of `K`.
    pub fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    /// Unknowns per vertex and rows per cluster.
    pub fn block(&self) -> usize {
        self.block
    }

    /// The order of elimination, to [analyse](Self::with_order) the system again with.
    pub fn into_order(self) -> EliminationOrder {
        self.order
    }

    /// The constraint rows `H`.
    pub fn rows(&self) -> &ConstraintRows {
        &self.rows
    }

    /// Gives back the memory of matrix, factor and work space, which the next factorisation takes anew.
    pub fn release(&mut self) {
        (self.values, self.factor) = (Vec::new(), Vec::new());
        self.memory = None;
        (self.factorized, self.is_turned) = (false, false);
    }

    /// Factorises `K + diag(damping)` with the rows. The factor stays in memory until it is
    /// [released](Self::release).
    ///
    /// `values` in pattern order (N/m), `damping` one value per unknown (N/m), or none.
    ///
    /// # Errors
    /// [`SolverError::SizeMismatch`], [`NotFinite`](SolverError::NotFinite),
    /// [`Breakdown`](SolverError::Breakdown) when a pivot vanishes exactly or overflows.
    pub fn factorize(&mut self, values: &[f64], damping: &[f64]) -> Result<Inertia, SolverError> {
        check_length("matrix values", self.pattern.entries(), values.len())?;
        check_damping(&self.pattern, damping)?;
        check_finite("matrix values", values)?;
        check_finite("damping", damping)?;
        (self.factorized, self.is_turned) = (false, false);
        self.scatter(values, damping);
        let symbolic = self.fronts.symbolic();
        self.memory
            .get_or_insert_with(|| MemBuffer::new(scratch(symbolic)));
        let factorized = self.fronts.factorize(&mut self.factor);
        factorized.map_err(|BadPivot(pivot)| SolverError::Breakdown { pivot })?;
        let negative = self.negative_pivots()?;
        self.factorized = true;
        Ok(Inertia {
            negative,
            rows: self.rows.count(),
        })
    }

    /// Solves `K step + H' multipliers = force`, `H step = offset` with refinement on the
    /// unregularised system, and returns its relative residual.
    ///
    /// Lengths: unknowns for `force` and `step`, rows for `offset` and `multipliers`. The
    /// residual is that of the scaled system, Euclidean norm over that of the right-hand side;
    /// it stays large when repeated rows ask for different offsets.
    ///
    /// # Errors
    /// [`SolverError::NotFactorized`], [`SizeMismatch`](SolverError::SizeMismatch),
    /// [`NotFinite`](SolverError::NotFinite) for the right-hand side or an overflow.
    pub fn solve(
        &mut self,
        force: &[f64],
        offset: &[f64],
        step: &mut [f64],
        multipliers: &mut [f64],
    ) -> Result<f64, SolverError> {
        self.refine(force, offset, step, multipliers, REFINED)
    }

    /// Solves as [`solve`](Self::solve) to a residual of 1e-10, all that a Newton step can use.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_step(
        &mut self,
        force: &[f64],
        offset: &[f64],
        step: &mut [f64],
        multipliers: &mut [f64],
    ) -> Result<f64, SolverError> {
        self.refine(force, offset, step, multipliers, REFINED_STEP)
    }

    /// Solves the regularised `K step + H' multipliers = force`, `H step = 0` once, without
    /// refinement: a symmetric operator, as a preconditioner has to be, and all that an inverse
    /// iteration needs.
    ///
    /// # Errors
    /// [`SolverError::NotFactorized`], [`SizeMismatch`](SolverError::SizeMismatch),
    /// [`NotFinite`](SolverError::NotFinite) for the right-hand side or an overflow.
    pub fn solve_once(&mut self, force: &[f64], step: &mut [f64]) -> Result<(), SolverError> {
        check_length("force", self.pattern.size(), force.len())?;
        check_length("step", self.pattern.size(), step.len())?;
        check_finite("force", force)?;
        if !self.factorized {
            return Err(SolverError::NotFactorized);
        }
        let (first, second) = self.residual.split_at_mut(force.len());
        for (entry, force) in first.iter_mut().zip(force) {
            *entry = force / self.typical_diagonal;
        }
        second.fill(0.0);
        self.trial.fill(0.0);
        self.add_correction();
        step.copy_from_slice(&self.trial[..step.len()]);
        check_finite("solution", step)
    }

    fn refine(
        &mut self,
        force: &[f64],
        offset: &[f64],
        step: &mut [f64],
        multipliers: &mut [f64],
        tolerance: f64,
    ) -> Result<f64, SolverError> {
        self.check_solve(force, offset, step, multipliers)?;
        step.fill(0.0);
        multipliers.fill(0.0);
        self.trial.fill(0.0);
        self.update_residual(force, offset);
        let size = norm(&self.residual);
        if size == 0.0 {
            return Ok(0.0);
        }
        let mut best = f64::INFINITY;
        for _ in 0..=MAX_REFINEMENTS {
            self.add_correction();
            self.update_residual(force, offset);
            let relative = norm(&self.residual) / size;
            // Where rows disagree or a mode is singular a round can make things worse.
            if relative.is_nan() || relative >= best {
                break;
            }
            let (trial_step, trial_multipliers) = self.trial.split_at(step.len());
            step.copy_from_slice(trial_step);
            multipliers.copy_from_slice(trial_multipliers);
            // A mode as soft as the regularisation converges by a few per cent per round, not
            // worth the triangular solves.
            let slow = relative > 0.5 * best;
            best = relative;
            if slow || best <= tolerance {
                break;
            }
        }
        check_finite("solution", &[best])?;
        Ok(best)
    }

    /// Median absolute diagonal entry of the last matrix (N/m).
    pub(crate) fn typical_diagonal(&self) -> f64 {
        self.typical_diagonal
    }

    fn check_solve(
        &self,
        force: &[f64],
        offset: &[f64],
        step: &[f64],
        multipliers: &[f64],
    ) -> Result<(), SolverError> {
        let (unknowns, rows) = (self.pattern.size(), self.rows.count());
        check_length("force", unknowns, force.len())?;
        check_length("offset", rows, offset.len())?;
        check_length("step", unknowns, step.len())?;
        check_length("multipliers", rows, multipliers.len())?;
        check_finite("force", force)?;
        check_finite("offset", offset)?;
        if self.factorized {
            Ok(())
        } else {
            Err(SolverError::NotFactorized)
        }
    }

    /// Writes the permuted system, scaled and regularised.
    fn scatter(&mut self, values: &[f64], damping: &[f64]) {
        let size = self.pattern.size();
        self.values.clear();
        self.values.extend_from_slice(values);
        self.factor.clear();
        self.factor.resize(self.fronts.symbolic().len_val(), 0.0);
        for (column, damping) in damping.iter().enumerate() {
            self.values[self.pattern.diagonal(column)] += damping;
        }
        self.typical_diagonal = self.median_diagonal();
        let scale = 1.0 / self.typical_diagonal;
        for (&slot, value) in self.slots.iter().zip(&self.values) {
            self.factor[slot as usize] = value * scale;
        }
        // Only the copy that is factorised: refinement measures by `values`, which stay exact.
        let regularization = match self.rows.count() {
            0 => REGULARIZATION_WITHOUT_ROWS,
            _ => REGULARIZATION,
        };
        for column in 0..size {
            self.factor[self.slots[self.pattern.diagonal(column)] as usize] += regularization;
        }
        // With this corner there is an `L D L'` in every order (Vanderbei 1995), without pivoting.
        let rows = self.row_scales.iter().enumerate().flat_map(|(row, scale)| {
            let (_, weights) = self.rows.row(row);
            let scaled = weights.iter().map(move |weight| weight * scale);
            scaled.chain([-REGULARIZATION])
        });
        for (&slot, value) in self.slots[self.values.len()..].iter().zip(rows) {
            self.factor[slot as usize] = value;
        }
    }

    /// Median size of the diagonal entries of `K` that are not zero; 1 where all are, which is
    /// legal: it is then all regularisation.
    ///
    /// The mean would belong to the few stiffest entries, such as those of a sliver's vertices, and
    /// a regularisation by it could hide negative pivots.
    fn median_diagonal(&mut self) -> f64 {
        let (values, pattern) = (&self.values, &self.pattern);
        let sizes = (0..pattern.size()).map(|column| values[pattern.diagonal(column)].abs());
        self.diagonal.clear();
        self.diagonal.extend(sizes.filter(|size| *size > 0.0));
        let middle = self.diagonal.len() / 2;
        if self.diagonal.is_empty() {
            return 1.0;
        }
        *self
            .diagonal
            .select_nth_unstable_by(middle, f64::total_cmp)
            .1
    }

    /// Residual of `trial` in the scaled, unregularised system: `[r_1 / k; N r_2]`.
    fn update_residual(&mut self, force: &[f64], offset: &[f64]) {
        let (first, second) = self.residual.split_at_mut(force.len());
        let (step, multipliers) = self.trial.split_at(force.len());
        first.fill(0.0);
        second.fill(0.0);
        self.pattern.add_product(&self.values, step, first);
        self.rows.add_transposed_product(multipliers, first);
        self.rows.add_product(step, second);
        for (entry, force) in first.iter_mut().zip(force) {
            // In the scales of the factorised system forces and offsets are comparable in one norm.
            *entry = (force - *entry) / self.typical_diagonal;
        }
        for ((entry, offset), scale) in second.iter_mut().zip(offset).zip(&self.row_scales) {
            *entry = (offset - *entry) * scale;
        }
    }

    /// Adds the regularised solution for `residual` to `trial`.
    fn add_correction(&mut self) {
        for (&place, &entry) in self.order.placement().iter().zip(&self.residual) {
            self.permuted[place as usize] = entry;
        }
        let size = self.permuted.len();
        let memory = self.memory.as_mut();
        let memory = memory.expect("work space is there as long as the factor");
        SupernodalLdltRef::new(self.fronts.symbolic(), &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.permuted, size, 1),
            Par::Seq,
            MemStack::new(memory),
        );
        let (step, multipliers) = self.trial.split_at_mut(self.pattern.size());
        let (step_places, row_places) = self.order.placement().split_at(step.len());
        for (entry, &place) in step.iter_mut().zip(step_places) {
            *entry += self.permuted[place as usize];
        }
        // The factor has `K / k` and `N H`: the multipliers of `K` and `H` are `k N` times its own.
        for ((entry, &place), scale) in multipliers.iter_mut().zip(row_places).zip(&self.row_scales)
        {
            *entry += self.permuted[place as usize] * scale * self.typical_diagonal;
        }
    }
}

impl std::fmt::Debug for Kkt {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Kkt")
            .field("unknowns", &self.pattern.size())
            .field("rows", &self.rows.count())
            .field("cost", &self.cost())
            .finish_non_exhaustive()
    }
}

/// Work space that a solve takes.
fn scratch(symbolic: &SymbolicSupernodalCholesky<u32>) -> StackReq {
    symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

fn row_scales(rows: &ConstraintRows) -> Vec<f64> {
    let scale = |row| {
        let length = norm(rows.row(row).1);
        // A row of zeros keeps its corner, so that it makes one pivot negative like every other.
        if length > 0.0 { 1.0 / length } else { 1.0 }
    };
    (0..rows.count()).map(scale).collect()
}
