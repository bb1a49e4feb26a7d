//! Elimination in a dense front.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{
    LdltError, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use super::is_in_a_pool;

/// Columns that are eliminated at a time.
const PANEL: usize = 96;

/// Multiplications of a product that is not worth being cut.
const LIGHT_PRODUCT: usize = 1 << 22;

/// Eliminates all columns of `front`, whose lower trapezoid becomes `L` with `D` on its diagonal, and subtracts from
/// the lower triangle of `below`, which belongs to the rows under its square, what that changes there. Fails with the
/// column of a pivot that is zero or not finite.
pub(super) fn eliminate(mut front: MatMut<'_, f64>, below: MatMut<'_, f64>) -> Result<(), usize> {
    let (rows, columns) = (front.nrows(), front.ncols());
    let mut done = 0;
    while done < columns {
        let end = columns.min(done + PANEL);
        let (mut panel, others) = front
            .rb_mut()
            .submatrix_mut(done, done, rows - done, columns - done)
            .split_at_col_mut(end - done);
        panel_in_place(panel.rb_mut()).map_err(|pivot| done + pivot)?;
        let width = end - done;
        if columns > end {
            let panel = panel.rb();
            let scaled = scaled(panel, width, columns - end);
            subtract_lower(
                others.split_at_row_mut(width).1,
                panel.split_at_row(width).1,
                scaled.as_ref(),
            );
        }
        done = end;
    }
    if rows > columns {
        let front = front.rb();
        let scaled = scaled(front, columns, rows - columns);
        subtract_lower(below, front.split_at_row(columns).1, scaled.as_ref());
    }
    Ok(())
}

/// Rows of `L` below the square of a panel with so many columns, each column times its pivot.
fn scaled(panel: MatRef<'_, f64>, columns: usize, rows: usize) -> Mat<f64> {
    let under = panel.submatrix(columns, 0, rows, columns);
    let mut scaled = Mat::zeros(rows, columns);
    for j in 0..columns {
        let pivot = panel[(j, j)];
        let column = scaled.col_mut(j).iter_mut();
        column
            .zip(under.col(j).iter())
            .for_each(|(scaled, entry)| *scaled = entry * pivot);
    }
    scaled
}

/// Eliminates the columns of one panel.
fn panel_in_place(panel: MatMut<'_, f64>) -> Result<(), usize> {
    let columns = panel.ncols();
    let (mut square, under) = panel.split_at_row_mut(columns);
    let scratch = cholesky_in_place_scratch::<f64>(columns, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    // No dynamic regularisation: it failed on indefinite matrices that factorise well without,
    // and a pivot that it corrects tells no inertia.
    cholesky_in_place(
        square.rb_mut(),
        Default::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    )
    .map_err(|LdltError::ZeroPivot { index }| index)?;
    solve_rows(square.rb(), under);
    Ok(())
}

/// Turns these `rows` of the matrix into rows of `L`, next to a square of `L` and `D`.
fn solve_rows(square: MatRef<'_, f64>, mut rows: MatMut<'_, f64>) {
    let columns = square.ncols();
    if rows.nrows() * columns * columns > LIGHT_PRODUCT {
        let half = rows.nrows() / 2;
        let (upper, lower) = rows.split_at_row_mut(half);
        join(|| solve_rows(square, upper), || solve_rows(square, lower));
        return;
    }
    solve_unit_lower_triangular_in_place(square, rows.rb_mut().transpose_mut(), Par::Seq);
    for j in 0..columns {
        let inverse = square[(j, j)].recip();
        for i in 0..rows.nrows() {
            rows[(i, j)] *= inverse;
        }
    }
}

/// Subtracts `left * right'` from the lower trapezoid of `target`.
fn subtract_lower(target: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    let (rows, columns) = (target.nrows(), target.ncols());
    if columns > 1 && rows * columns * left.ncols() > LIGHT_PRODUCT {
        let half = columns / 2;
        let (first, second) = target.split_at_col_mut(half);
        let (tip, square) = first.split_at_row_mut(half);
        let (upper, lower) = left.split_at_row(half);
        let (above, under) = right.split_at_row(half);
        join(
            || subtract(square, lower, above),
            || {
                join(
                    || subtract_lower(tip, upper, above),
                    || subtract_lower(second.split_at_row_mut(half).1, lower, under),
                )
            },
        );
        return;
    }
    let (square, rest) = target.split_at_row_mut(columns);
    let (upper, lower) = left.split_at_row(columns);
    triangular::matmul(
        square,
        BlockStructure::TriangularLower,
        Accum::Add,
        upper,
        BlockStructure::Rectangular,
        right.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    subtract(rest, lower, right);
}

/// Subtracts `left * right'` from `target`.
fn subtract(target: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    let (rows, columns) = (target.nrows(), target.ncols());
    if rows * columns * left.ncols() <= LIGHT_PRODUCT || rows.max(columns) == 1 {
        matmul(target, Accum::Add, left, right.transpose(), -1.0, Par::Seq);
    } else if rows > columns {
        let (first, second) = target.split_at_row_mut(rows / 2);
        let (upper, lower) = left.split_at_row(rows / 2);
        join(
            || subtract(first, upper, right),
            || subtract(second, lower, right),
        );
    } else {
        let (first, second) = target.split_at_col_mut(columns / 2);
        let (above, under) = right.split_at_row(columns / 2);
        join(
            || subtract(first, left, above),
            || subtract(second, left, under),
        );
    }
}

/// Does both, side by side if another thread of the pool is free.
fn join(first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
    if is_in_a_pool() {
        rayon::join(first, second);
    } else {
        first();
        second();
    }
}
