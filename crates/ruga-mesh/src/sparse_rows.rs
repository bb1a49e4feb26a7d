//! A sparse linear map from per-vertex values to per-vertex values.

use std::iter::Sum;
use std::ops::{Mul, Range};

use crate::{Id, VertexId};

/// Rows of weights: row `i` of the result is a weighted sum of input values.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseRows {
    starts: Vec<usize>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl Default for SparseRows {
    fn default() -> Self {
        Self {
            starts: vec![0],
            columns: Vec::new(),
            weights: Vec::new(),
        }
    }
}

impl SparseRows {
    /// The map that copies its input.
    pub fn identity(size: usize) -> Self {
        Self {
            starts: (0..=size).collect(),
            columns: (0..size as u32).collect(),
            weights: vec![1.0; size],
        }
    }

    /// Appends a row; terms with the same column are added up, in ascending columns.
    pub fn push_row(&mut self, terms: &mut [(u32, f64)]) {
        // A stable sort keeps the order of summation, and with it the last bit, reproducible.
        terms.sort_by_key(|term| term.0);
        let first = self.columns.len();
        for &(column, weight) in terms.iter() {
            if self.columns.len() > first && self.columns.last() == Some(&column) {
                if let Some(last) = self.weights.last_mut() {
                    *last += weight;
                }
            } else {
                self.columns.push(column);
                self.weights.push(weight);
            }
        }
        self.starts.push(self.columns.len());
    }

    /// Appends a row with a weight for each of `columns`, which ascend.
    pub(crate) fn push_ascending(&mut self, columns: &[u32], weights: impl Iterator<Item = f64>) {
        self.columns.extend_from_slice(columns);
        self.weights.extend(weights);
        self.starts.push(self.columns.len());
    }

    /// Appends the rows of other maps, one after the other.
    pub(crate) fn append<'a>(&mut self, others: impl Iterator<Item = &'a Self> + Clone) {
        let rows = others.clone().map(Self::row_count).sum();
        self.reserve(rows, others.clone().map(|other| other.columns.len()).sum());
        for other in others {
            let before = self.columns.len();
            let starts = other.starts[1..].iter().map(|start| before + start);
            self.starts.extend(starts);
            self.columns.extend_from_slice(&other.columns);
            self.weights.extend_from_slice(&other.weights);
        }
    }

    /// Gives back the memory that was reserved for further rows.
    pub(crate) fn shrink_to_fit(&mut self) {
        self.starts.shrink_to_fit();
        self.columns.shrink_to_fit();
        self.weights.shrink_to_fit();
    }

    fn reserve(&mut self, rows: usize, terms: usize) {
        self.starts.reserve(rows);
        self.columns.reserve(terms);
        self.weights.reserve(terms);
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Columns and weights of one row.
    ///
    /// # Panics
    /// When there is no such row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let range = self.range(row);
        self.columns[range.clone()]
            .iter()
            .copied()
            .zip(self.weights[range].iter().copied())
    }

    fn range(&self, row: usize) -> Range<usize> {
        self.starts[row]..self.starts[row + 1]
    }

    /// The rows of the chosen vertices, in the order given.
    ///
    /// # Panics
    /// When one of them has no row.
    pub fn select(&self, chosen: &[VertexId]) -> Self {
        let mut selected = Self::default();
        let terms = chosen.iter().map(|v| self.range(v.index()).len()).sum();
        selected.reserve(chosen.len(), terms);
        for vertex in chosen {
            let range = self.range(vertex.index());
            selected
                .columns
                .extend_from_slice(&self.columns[range.clone()]);
            selected.weights.extend_from_slice(&self.weights[range]);
            selected.starts.push(selected.columns.len());
        }
        selected
    }

    /// Rows for an input in another order: what column `i` names is found at `places[i]`.
    ///
    /// # Panics
    /// When a row has a column beyond the end of `places`.
    pub fn with_columns_at(&self, places: &[VertexId]) -> Self {
        let mut renamed = Self::default();
        renamed.reserve(self.row_count(), self.columns.len());
        let mut terms = Vec::new();
        for row in 0..self.row_count() {
            terms.clear();
            // Other names sort differently, and two columns may become one: each row is built anew.
            terms.extend(
                self.row(row)
                    .map(|(column, w)| (places[column as usize].0, w)),
            );
            renamed.push_row(&mut terms);
        }
        renamed
    }

    /// The weighted sums of `values`, numbers or vectors, one per row.
    ///
    /// # Panics
    /// When a row has a column beyond the end of `values`.
    pub fn apply<T: Copy + Mul<f64, Output = T> + Sum>(&self, values: &[T]) -> Vec<T> {
        self.apply_some(0..self.row_count(), values)
    }

    /// The weighted sums of `values` for some of the rows.
    ///
    /// # Panics
    /// As [`apply`](Self::apply), and when there is no such row.
    pub fn apply_some<T: Copy + Mul<f64, Output = T> + Sum>(
        &self,
        rows: Range<usize>,
        values: &[T],
    ) -> Vec<T> {
        let term = |(column, weight): (u32, f64)| values[column as usize] * weight;
        rows.map(|i| self.row(i).map(term).sum()).collect()
    }

    /// This map after `inner`: `self * inner`.
    ///
    /// # Panics
    /// When a row has a column for which `inner` has no row.
    pub fn after(&self, inner: &Self) -> Self {
        let width = inner.columns.iter().max().map_or(0, |&c| c as usize + 1);
        // Terms are added into a dense row in the order in which they come, and only the columns
        // are sorted: each occurs several times.
        // A sum may be zero and its column present all the same, hence the marks.
        let (mut sums, mut is_open) = (vec![0.0; width], vec![false; width]);
        let mut columns: Vec<u32> = Vec::new();
        let mut product = Self::default();
        for i in 0..self.row_count() {
            for (middle, weight) in self.row(i) {
                for (column, w) in inner.row(middle as usize) {
                    let at = column as usize;
                    if !std::mem::replace(&mut is_open[at], true) {
                        columns.push(column);
                    }
                    sums[at] += weight * w;
                }
            }
            columns.sort_unstable();
            for &column in &columns {
                product.columns.push(column);
                product
                    .weights
                    .push(std::mem::take(&mut sums[column as usize]));
                is_open[column as usize] = false;
            }
            columns.clear();
            product.starts.push(product.columns.len());
        }
        product
    }
}
