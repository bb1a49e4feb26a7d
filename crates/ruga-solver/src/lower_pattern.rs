//! Sparsity of a symmetric matrix.

use std::sync::Arc;

use crate::SolverError;
use crate::error::{check_line, check_starts};

/// Lower triangle of a symmetric sparse matrix: compressed columns, diagonal included.
///
/// Values of such a matrix are a plain `&[f64]` in the order of [`rows`](Self::rows).
/// Rows are strictly increasing within a column and every column begins with its diagonal. Copies share
/// their memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LowerPattern {
    column_starts: Arc<[usize]>,
    rows: Arc<[u32]>,
}

impl LowerPattern {
    /// Validates and takes over a pattern of `column_starts.len() - 1` columns.
    ///
    /// # Errors
    /// [`SolverError::Empty`], [`MalformedStarts`](SolverError::MalformedStarts),
    /// [`Unsorted`](SolverError::Unsorted), [`IndexOutOfRange`](SolverError::IndexOutOfRange),
    /// [`MissingDiagonal`](SolverError::MissingDiagonal).
    pub fn new(
        column_starts: impl Into<Arc<[usize]>>,
        rows: impl Into<Arc<[u32]>>,
    ) -> Result<Self, SolverError> {
        let (column_starts, rows) = (column_starts.into(), rows.into());
        if column_starts.len() < 2 {
            return Err(SolverError::Empty);
        }
        check_starts(&column_starts, rows.len())?;
        let size = column_starts.len() - 1;
        for column in 0..size {
            let line = &rows[column_starts[column]..column_starts[column + 1]];
            check_line(column, line.iter().map(|&row| row as usize), size)?;
            if line.first().is_none_or(|&row| row as usize != column) {
                return Err(SolverError::MissingDiagonal { column });
            }
        }
        Ok(Self {
            column_starts,
            rows,
        })
    }

    /// The pattern that couples all unknowns within each stencil, and each unknown with itself.
    ///
    /// `stencils` lists, per stencil, the unknowns it touches, in any order.
    ///
    /// # Errors
    /// [`SolverError::IndexOutOfRange`] when a stencil names an unknown `>= size`
    /// (`line` is then the stencil), [`SolverError::Empty`] when `size` is 0,
    /// [`SolverError::TooLarge`] for more than 2³¹ - 1 unknowns.
    pub fn from_stencils<'a>(
        size: usize,
        stencils: impl IntoIterator<Item = &'a [usize]>,
    ) -> Result<Self, SolverError> {
        i32::try_from(size).map_err(|_| SolverError::TooLarge { size })?;
        let mut columns: Vec<Vec<usize>> = (0..size).map(|column| vec![column]).collect();
        for (line, stencil) in stencils.into_iter().enumerate() {
            if let Some(&index) = stencil.iter().find(|&&index| index >= size) {
                let limit = size;
                return Err(SolverError::IndexOutOfRange { line, index, limit });
            }
            for &column in stencil {
                columns[column].extend(stencil.iter().filter(|&&row| row > column));
            }
        }
        let mut column_starts = vec![0];
        let mut rows = Vec::new();
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            rows.extend(column.iter().map(|&row| row as u32));
            column_starts.push(rows.len());
        }
        Self::new(column_starts, rows)
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of stored entries, the length of a value array.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Start of each column in [`rows`](Self::rows); one more than there are columns.
    pub fn column_starts(&self) -> &[usize] {
        &self.column_starts
    }

    /// Row of each entry.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Position of the entry (`row`, `column`) of the symmetric matrix, if it is stored.
    ///
    /// Either triangle may be named: (`row`, `column`) and (`column`, `row`) share an entry.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let (row, column) = (row.max(column), row.min(column));
        let start = *self.column_starts.get(column)?;
        let end = *self.column_starts.get(column + 1)?;
        let row = u32::try_from(row).ok()?;
        let offset = self.rows[start..end].binary_search(&row).ok()?;
        Some(start + offset)
    }

    /// Position of the diagonal entry of `column`.
    pub(crate) fn diagonal(&self, column: usize) -> usize {
        self.column_starts[column]
    }

    /// `product += A x` for the symmetric matrix with these values.
    pub(crate) fn add_product(&self, values: &[f64], x: &[f64], product: &mut [f64]) {
        for column in 0..self.size() {
            let start = self.column_starts[column];
            let end = self.column_starts[column + 1];
            let x_column = x[column];
            let mut sum = values[start] * x_column;
            for (&row, &value) in self.rows[start + 1..end]
                .iter()
                .zip(&values[start + 1..end])
            {
                let row = row as usize;
                product[row] += value * x_column;
                sum += value * x[row];
            }
            product[column] += sum;
        }
    }
}
