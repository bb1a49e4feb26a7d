//! The linear constraints `H x = b`.

use std::sync::Arc;

use crate::SolverError;
use crate::error::{check_finite, check_line, check_starts};

/// The matrix `H` of the linear constraints, compressed rows (`count` x `unknowns`).
///
/// Columns are strictly increasing within a row. Rows may repeat or depend on each other; the
/// factorisation copes, and they hold as long as their right-hand sides agree. Copies share their
/// memory.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintRows {
    row_starts: Arc<[usize]>,
    columns: Arc<[usize]>,
    values: Arc<[f64]>,
    unknowns: usize,
}

impl ConstraintRows {
    /// Validates and takes over `row_starts.len() - 1` rows on `unknowns` unknowns.
    ///
    /// # Errors
    /// [`MalformedStarts`](SolverError::MalformedStarts), [`Unsorted`](SolverError::Unsorted),
    /// [`IndexOutOfRange`](SolverError::IndexOutOfRange),
    /// [`SizeMismatch`](SolverError::SizeMismatch), [`NotFinite`](SolverError::NotFinite).
    pub fn new(
        row_starts: Vec<usize>,
        columns: Vec<usize>,
        values: Vec<f64>,
        unknowns: usize,
    ) -> Result<Self, SolverError> {
        check_starts(&row_starts, columns.len())?;
        crate::error::check_length("constraint values", columns.len(), values.len())?;
        for row in 0..row_starts.len() - 1 {
            let line = &columns[row_starts[row]..row_starts[row + 1]];
            check_line(row, line.iter().copied(), unknowns)?;
        }
        check_finite("constraint values", &values)?;
        Ok(Self {
            row_starts: row_starts.into(),
            columns: columns.into(),
            values: values.into(),
            unknowns,
        })
    }

    /// No constraints on `unknowns` unknowns.
    pub fn none(unknowns: usize) -> Self {
        Self {
            row_starts: Arc::new([0]),
            columns: Arc::default(),
            values: Arc::default(),
            unknowns,
        }
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Number of unknowns, the columns of `H`.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.columns.len()
    }

    /// Columns and values of one row, counted from 0.
    ///
    /// # Panics
    /// When `row` is not below [`count`](Self::count).
    pub fn row(&self, row: usize) -> (&[usize], &[f64]) {
        let range = self.row_starts[row]..self.row_starts[row + 1];
        (&self.columns[range.clone()], &self.values[range])
    }

    /// `product = H x`; lengths `unknowns` and `count`.
    ///
    /// # Errors
    /// [`SolverError::SizeMismatch`].
    pub fn mul(&self, x: &[f64], product: &mut [f64]) -> Result<(), SolverError> {
        crate::error::check_length("x", self.unknowns, x.len())?;
        crate::error::check_length("product", self.count(), product.len())?;
        product.fill(0.0);
        self.add_product(x, product);
        Ok(())
    }

    pub(crate) fn add_product(&self, x: &[f64], product: &mut [f64]) {
        for (row, sum) in product.iter_mut().enumerate() {
            let (columns, values) = self.row(row);
            *sum += columns
                .iter()
                .zip(values)
                .map(|(&column, value)| value * x[column])
                .sum::<f64>();
        }
    }

    pub(crate) fn add_transposed_product(&self, multipliers: &[f64], product: &mut [f64]) {
        for (row, multiplier) in multipliers.iter().enumerate() {
            let (columns, values) = self.row(row);
            for (&column, value) in columns.iter().zip(values) {
                product[column] += value * multiplier;
            }
        }
    }
}
