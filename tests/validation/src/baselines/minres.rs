//! MINRES on the KKT system, as Rémillard and Kry 2013 use it.
//!
//! It knows no inertia, and its iterations grow with resolution.

use ruga_solver::{ConstraintRows, Kkt, LowerPattern, SolverError};

use super::{MinresLimits, add_transposed_product, check_finite, dot};

/// Work of one linear solve, and whether it met the tolerance.
#[derive(Clone, Copy, Debug)]
pub(super) struct MinresOutcome {
    pub(super) iterations: usize,
    pub(super) converged: bool,
}

/// The KKT system of one Newton step with its block-diagonal preconditioner
/// `blkdiag(G, H G^-1 H')`, `G` the diagonal blocks of `K`.
pub(super) struct MinresStep {
    limits: MinresLimits,
    values: Vec<f64>,
    inverse_blocks: Vec<f64>,
    schur: Option<Schur>,
}

/// `S = H G^-1 H'`: pattern, values and factor.
struct Schur {
    factor: Kkt,
    values: Vec<f64>,
    /// For each vertex block, the rows that touch it and their weights there.
    touching: Vec<Vec<(usize, Vec<f64>)>>,
}

impl MinresStep {
    pub(super) fn new(kkt: &Kkt, limits: MinresLimits) -> Result<Self, SolverError> {
        let schur = if kkt.rows().count() == 0 {
            None
        } else {
            Some(Schur::new(kkt)?)
        };
        Ok(Self {
            limits,
            values: vec![0.0; kkt.pattern().entries()],
            inverse_blocks: vec![0.0; kkt.pattern().size() * kkt.block()],
            schur,
        })
    }

    /// Takes over the matrix `K + diag(damping)` and builds its preconditioner.
    pub(super) fn prepare(
        &mut self,
        kkt: &Kkt,
        values: &[f64],
        damping: &[f64],
    ) -> Result<(), SolverError> {
        check_finite("matrix values", values)?;
        self.values.copy_from_slice(values);
        for (column, damping) in damping.iter().enumerate() {
            self.values[kkt.pattern().column_starts()[column]] += damping;
        }
        let block = kkt.block();
        for (vertex, inverse) in self.inverse_blocks.chunks_mut(block * block).enumerate() {
            invert_block(kkt.pattern(), &self.values, vertex * block, inverse);
        }
        match &mut self.schur {
            Some(schur) => schur.factorize(&self.inverse_blocks, block),
            None => Ok(()),
        }
    }

    /// Preconditioned MINRES (Elman, Silvester & Wathen 2014, algorithm 4.1) from zero.
    pub(super) fn solve(
        &mut self,
        kkt: &Kkt,
        (force, offset): (&[f64], &[f64]),
        (step, multipliers): (&mut [f64], &mut [f64]),
    ) -> Result<MinresOutcome, SolverError> {
        let (size, rows) = (force.len(), offset.len());
        let mut solution = vec![0.0; size + rows];
        let mut lanczos = [force, offset].concat();
        let mut previous_lanczos = vec![0.0; size + rows];
        let mut direction = vec![0.0; size + rows];
        let mut previous_direction = vec![0.0; size + rows];
        let mut preconditioned = self.precondition(kkt, &lanczos)?;
        let mut product = vec![0.0; size + rows];
        let mut gamma = dot(&preconditioned, &lanczos).max(0.0).sqrt();
        let start = gamma;
        let mut previous_gamma = 1.0;
        let mut remaining = gamma;
        let (mut cosine, mut previous_cosine) = (1.0, 1.0);
        let (mut sine, mut previous_sine) = (0.0, 0.0);
        let mut iterations = 0;
        let goal = self.limits.tolerance * start;
        while iterations < self.limits.max_iterations && remaining.abs() > goal && gamma > 0.0 {
            iterations += 1;
            scale(&mut preconditioned, 1.0 / gamma);
            multiply(kkt, &self.values, &preconditioned, &mut product)?;
            let delta = dot(&product, &preconditioned);
            for ((product, current), previous) in
                product.iter_mut().zip(&lanczos).zip(&previous_lanczos)
            {
                *product -= delta / gamma * current + gamma / previous_gamma * previous;
            }
            std::mem::swap(&mut previous_lanczos, &mut lanczos);
            std::mem::swap(&mut lanczos, &mut product);
            let next = self.precondition(kkt, &lanczos)?;
            let next_gamma = dot(&next, &lanczos).max(0.0).sqrt();
            let diagonal = cosine * delta - previous_cosine * sine * gamma;
            let pivot = diagonal.hypot(next_gamma);
            if pivot == 0.0 {
                break;
            }
            let above = sine * delta + previous_cosine * cosine * gamma;
            let far_above = previous_sine * gamma;
            (previous_cosine, cosine) = (cosine, diagonal / pivot);
            (previous_sine, sine) = (sine, next_gamma / pivot);
            for ((older, newer), vector) in previous_direction
                .iter_mut()
                .zip(&direction)
                .zip(&preconditioned)
            {
                *older = (vector - far_above * *older - above * newer) / pivot;
            }
            std::mem::swap(&mut previous_direction, &mut direction);
            for (solution, direction) in solution.iter_mut().zip(&direction) {
                *solution += cosine * remaining * direction;
            }
            remaining *= -sine;
            preconditioned = next;
            (previous_gamma, gamma) = (gamma, next_gamma);
        }
        check_finite("MINRES solution", &solution)?;
        step.copy_from_slice(&solution[..size]);
        multipliers.copy_from_slice(&solution[size..]);
        Ok(MinresOutcome {
            iterations,
            converged: remaining.abs() <= goal,
        })
    }

    fn precondition(&mut self, kkt: &Kkt, vector: &[f64]) -> Result<Vec<f64>, SolverError> {
        let size = kkt.pattern().size();
        let block = kkt.block();
        let mut result = vec![0.0; vector.len()];
        let (result_first, result_second) = result.split_at_mut(size);
        for ((result, vector), inverse) in result_first
            .chunks_mut(block)
            .zip(vector.chunks(block))
            .zip(self.inverse_blocks.chunks(block * block))
        {
            for (entry, line) in result.iter_mut().zip(inverse.chunks(block)) {
                *entry = dot(line, vector);
            }
        }
        if let Some(schur) = &mut self.schur {
            schur.factor.solve_once(&vector[size..], result_second)?;
        }
        Ok(result)
    }
}

fn scale(vector: &mut [f64], factor: f64) {
    for entry in vector {
        *entry *= factor;
    }
}

/// `product = [K, H'; H, 0] vector`.
fn multiply(
    kkt: &Kkt,
    values: &[f64],
    vector: &[f64],
    product: &mut [f64],
) -> Result<(), SolverError> {
    let (step, multipliers) = vector.split_at(kkt.pattern().size());
    let (first, second) = product.split_at_mut(kkt.pattern().size());
    multiply_symmetric(kkt.pattern(), values, step, first);
    add_transposed_product(kkt.rows(), multipliers, first);
    kkt.rows().mul(step, second)
}

/// `product = K x`, of whose values the lower triangle is stored.
fn multiply_symmetric(pattern: &LowerPattern, values: &[f64], x: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for (column, ends) in pattern.column_starts().windows(2).enumerate() {
        let entries = ends[0] + 1..ends[1];
        let mut sum = values[ends[0]] * x[column];
        for (&row, value) in pattern.rows()[entries.clone()].iter().zip(&values[entries]) {
            let row = row as usize;
            product[row] += value * x[column];
            sum += value * x[row];
        }
        product[column] += sum;
    }
}

/// Inverse of the diagonal block that starts at unknown `first`; of its absolute diagonal where
/// the block is not positive definite, as the preconditioner has to be.
fn invert_block(pattern: &LowerPattern, values: &[f64], first: usize, inverse: &mut [f64]) {
    let block = inverse.len().isqrt();
    let entry = |row: usize, column: usize| {
        pattern
            .position(first + row, first + column)
            .map_or(0.0, |position| values[position])
    };
    let mut matrix = vec![0.0; block * block];
    for row in 0..block {
        for column in 0..block {
            matrix[row * block + column] = entry(row, column);
        }
    }
    if gauss_jordan(&mut matrix, inverse, block) {
        return;
    }
    inverse.fill(0.0);
    for row in 0..block {
        let diagonal = entry(row, row).abs();
        inverse[row * block + row] = if diagonal > 0.0 { 1.0 / diagonal } else { 1.0 };
    }
}

/// Inverts a small symmetric matrix without pivoting; false when it is not positive definite.
fn gauss_jordan(matrix: &mut [f64], inverse: &mut [f64], block: usize) -> bool {
    inverse.fill(0.0);
    for row in 0..block {
        inverse[row * block + row] = 1.0;
    }
    for pivot in 0..block {
        let value = matrix[pivot * block + pivot];
        if value.is_nan() || value <= 0.0 {
            return false;
        }
        for column in 0..block {
            matrix[pivot * block + column] /= value;
            inverse[pivot * block + column] /= value;
        }
        for row in (0..block).filter(|&row| row != pivot) {
            let factor = matrix[row * block + pivot];
            for column in 0..block {
                matrix[row * block + column] -= factor * matrix[pivot * block + column];
                inverse[row * block + column] -= factor * inverse[pivot * block + column];
            }
        }
    }
    true
}

impl Schur {
    fn new(kkt: &Kkt) -> Result<Self, SolverError> {
        let touching = rows_of_blocks(kkt.rows(), kkt.block());
        let stencils: Vec<Vec<usize>> = touching
            .iter()
            .map(|rows| rows.iter().map(|(row, _)| *row).collect())
            .collect();
        let count = kkt.rows().count();
        let pattern = LowerPattern::from_stencils(count, stencils.iter().map(Vec::as_slice))?;
        Ok(Self {
            values: vec![0.0; pattern.entries()],
            factor: Kkt::new(&pattern, &ConstraintRows::none(count), 1)?,
            touching,
        })
    }

    fn factorize(&mut self, inverse_blocks: &[f64], block: usize) -> Result<(), SolverError> {
        self.values.fill(0.0);
        for (rows, inverse) in self
            .touching
            .iter()
            .zip(inverse_blocks.chunks(block * block))
        {
            for (row, weights) in rows {
                let weighted: Vec<f64> = inverse
                    .chunks(block)
                    .map(|line| dot(line, weights))
                    .collect();
                for (other, other_weights) in rows.iter().filter(|(other, _)| other <= row) {
                    if let Some(position) = self.factor.pattern().position(*row, *other) {
                        self.values[position] += dot(&weighted, other_weights);
                    }
                }
            }
        }
        let damping = vec![0.0; self.factor.pattern().size()];
        self.factor.factorize(&self.values, &damping).map(|_| ())
    }
}

/// For each vertex block, the constraint rows that touch it with their weights there.
fn rows_of_blocks(rows: &ConstraintRows, block: usize) -> Vec<Vec<(usize, Vec<f64>)>> {
    let mut touching: Vec<Vec<(usize, Vec<f64>)>> = vec![Vec::new(); rows.unknowns() / block];
    for row in 0..rows.count() {
        let (columns, weights) = rows.row(row);
        for (&column, &weight) in columns.iter().zip(weights) {
            let list = &mut touching[column / block];
            if list.last().is_none_or(|(last, _)| *last != row) {
                list.push((row, vec![0.0; block]));
            }
            if let Some((_, block_weights)) = list.last_mut() {
                block_weights[column % block] = weight;
            }
        }
    }
    touching
}
