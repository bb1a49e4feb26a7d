//! Fourier transforms of real fields on a periodic rectangle.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::Vector2;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// A periodic rectangle and its grid.
///
/// Fields hold row after row of x. Their coefficients hold column after column of the wave vector's
/// y, and are means: the coefficient of the zero mode is the mean of the field.
#[derive(Clone)]
pub struct Grid {
    /// Points along x and y.
    pub size: [usize; 2],
    /// Periods along x and y, m.
    pub extent: [f64; 2],
    forward: [Arc<dyn Fft<f64>>; 2],
    inverse: [Arc<dyn Fft<f64>>; 2],
}

impl Grid {
    /// Plans the transforms of a grid.
    pub fn new(size: [usize; 2], extent: [f64; 2]) -> Self {
        let mut planner = FftPlanner::new();
        Self {
            size,
            extent,
            forward: size.map(|n| planner.plan_fft_forward(n)),
            inverse: size.map(|n| planner.plan_fft_inverse(n)),
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Place of a point, m.
    pub fn place(&self, point: usize) -> Vector2<f64> {
        let [i, j] = [point % self.size[0], point / self.size[0]];
        Vector2::new(
            self.extent[0] * i as f64 / self.size[0] as f64,
            self.extent[1] * j as f64 / self.size[1] as f64,
        )
    }

    /// Wave vector of a coefficient, 1/m.
    pub fn wave_vector(&self, mode: usize) -> Vector2<f64> {
        let [m, n] = self.orders(mode);
        Vector2::new(
            TAU * m as f64 / self.extent[0],
            TAU * n as f64 / self.extent[1],
        )
    }

    /// Wave vector of the derivatives: without the highest wave, whose slope the grid cannot see.
    pub fn slope_vector(&self, mode: usize) -> Vector2<f64> {
        let orders = self.orders(mode);
        let mut k = self.wave_vector(mode);
        for axis in 0..2 {
            if 2 * orders[axis].abs() == self.size[axis] as i64 {
                k[axis] = 0.0;
            }
        }
        k
    }

    /// Coefficient of given orders, either sign.
    pub fn mode(&self, orders: [i64; 2]) -> usize {
        let [m, n] = [0, 1].map(|axis| orders[axis].rem_euclid(self.size[axis] as i64) as usize);
        m * self.size[1] + n
    }

    /// Number of periods along x and y of a coefficient.
    pub fn orders(&self, mode: usize) -> [i64; 2] {
        let signed = |order: usize, count: usize| {
            if 2 * order <= count {
                order as i64
            } else {
                order as i64 - count as i64
            }
        };
        [
            signed(mode / self.size[1], self.size[0]),
            signed(mode % self.size[1], self.size[1]),
        ]
    }

    /// The coefficient of the opposite wave vector.
    fn opposite(&self, mode: usize) -> usize {
        let [nx, ny] = self.size;
        (nx - mode / ny) % nx * ny + (ny - mode % ny) % ny
    }

    /// Coefficients of two fields, in one transform.
    pub fn coefficients(&self, fields: [&[f64]; 2]) -> [Vec<Complex64>; 2] {
        let scale = 1.0 / self.points() as f64;
        let mut rows: Vec<_> = fields[0]
            .iter()
            .zip(fields[1])
            .map(|(a, b)| Complex64::new(a * scale, b * scale))
            .collect();
        self.forward[0].process(&mut rows);
        let mut columns = transposed(&rows, self.size);
        self.forward[1].process(&mut columns);
        let pair = |mode: usize| (columns[mode], columns[self.opposite(mode)].conj());
        let half_turn = Complex64::new(0.0, -0.5);
        [
            (0..columns.len())
                .map(|mode| (pair(mode).0 + pair(mode).1) * 0.5)
                .collect(),
            (0..columns.len())
                .map(|mode| (pair(mode).0 - pair(mode).1) * half_turn)
                .collect(),
        ]
    }

    /// The fields of two sets of coefficients, in one transform.
    pub fn fields(&self, coefficients: [&[Complex64]; 2]) -> [Vec<f64>; 2] {
        let mut columns: Vec<_> = coefficients[0]
            .iter()
            .zip(coefficients[1])
            .map(|(a, b)| a + Complex64::i() * b)
            .collect();
        self.inverse[1].process(&mut columns);
        let mut rows = transposed(&columns, [self.size[1], self.size[0]]);
        self.inverse[0].process(&mut rows);
        [
            rows.iter().map(|c| c.re).collect(),
            rows.iter().map(|c| c.im).collect(),
        ]
    }

    /// Moves every row of a field by a number of spacings, which takes samples at `x + shift` to
    /// samples at `x`.
    pub fn shift_rows(&self, field: &mut [f64], shift: impl Fn(usize) -> f64) {
        let count = self.size[0];
        for (row, values) in field.chunks_exact_mut(count).enumerate() {
            let turn = TAU * shift(row) / count as f64;
            let mut waves: Vec<_> = values.iter().map(|&v| Complex64::from(v)).collect();
            self.forward[0].process(&mut waves);
            for (order, wave) in waves.iter_mut().enumerate() {
                let signed = if 2 * order <= count {
                    order as f64
                } else {
                    order as f64 - count as f64
                };
                *wave *= Complex64::from_polar(1.0 / count as f64, -turn * signed);
            }
            self.inverse[0].process(&mut waves);
            for (value, wave) in values.iter_mut().zip(&waves) {
                *value = wave.re;
            }
        }
    }

    /// Coefficients of the slopes along x and y.
    pub fn slopes(&self, coefficients: &[Complex64]) -> [Vec<Complex64>; 2] {
        [0, 1].map(|axis| {
            let slope = |(mode, c): (usize, &Complex64)| {
                c * Complex64::new(0.0, self.slope_vector(mode)[axis])
            };
            coefficients.iter().enumerate().map(slope).collect()
        })
    }
}

/// Columns after one another of a field with `size` points along its rows and columns.
fn transposed(rows: &[Complex64], size: [usize; 2]) -> Vec<Complex64> {
    let [nx, ny] = size;
    let entry = |index: usize| rows[index % ny * nx + index / ny];
    (0..rows.len()).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_sampled_further_on_come_back() {
        let grid = Grid::new([10, 2], [1.0, 1.0]);
        let at = |x: f64| (TAU * 3.0 * x).cos() + (TAU * x).sin();
        let place = |i: usize| (i % 10) as f64 + if i >= 10 { 0.5 } else { 0.0 };
        let mut field: Vec<f64> = (0..20).map(|i| at(0.1 * place(i))).collect();
        grid.shift_rows(&mut field, |row| 0.5 * row as f64);
        for (i, value) in field.iter().enumerate() {
            assert!((value - at(0.1 * (i % 10) as f64)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_wave_has_one_pair_of_coefficients_and_its_own_slope() {
        let grid = Grid::new([12, 8], [3.0, 2.0]);
        let k = Vector2::new(TAU * 2.0 / 3.0, -TAU / 2.0);
        let wave: Vec<f64> = (0..96).map(|i| k.dot(&grid.place(i)).cos()).collect();
        let ramp: Vec<f64> = (0..96).map(|i| i as f64).collect();
        let [found, other] = grid.coefficients([&wave, &ramp]);
        for (mode, c) in found.iter().enumerate() {
            let wanted = if (grid.wave_vector(mode) - k).norm() < 1e-9
                || (grid.wave_vector(mode) + k).norm() < 1e-9
            {
                0.5
            } else {
                0.0
            };
            assert!((c - wanted).norm() < 1e-14, "{mode}: {c}");
        }
        assert!((other[0].re - 47.5).abs() < 1e-12);
        let [back, slope] = grid.fields([&other, &grid.slopes(&found)[1]]);
        for i in 0..96 {
            assert!((back[i] - ramp[i]).abs() < 1e-12);
            assert!((slope[i] + k.y * k.dot(&grid.place(i)).sin()).abs() < 1e-12);
        }
    }
}
