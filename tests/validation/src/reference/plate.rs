//! A periodic Foeppl-von Karman plate on an elastic foundation, in Fourier space.
//!
//! ```text
//! E/area = 1/2 sum_k (D k^4 + K(k)) |w_k|^2 + 1/2 <N : e>
//! e_ij   = -strain_ij + (u_i,j + u_j,i)/2 + w_,i w_,j / 2
//! N      = C ((1 - nu) e + nu tr(e) I)
//! ```
//!
//! For given heights `w` the slides `u` follow wave by wave from a quadratic, so that heights alone
//! are unknown. Along the wave vector (`l`) and across it (`t`), with `q = w_,i w_,j / 2` and
//! `T = Kt/(C k^2)` of the tangential springs:
//!
//! ```text
//! N_ll = C (q_ll + nu q_tt) T/(1 + T)
//! N_lt = C (1 - nu) q_lt T/(T + (1 - nu)/2)
//! N_tt = C (q_tt + nu q_ll - nu (q_ll + nu q_tt)/(1 + T))
//! ```
//!
//! Without them only `N_tt = E h q_tt` is left. The mean strain is imposed.

use nalgebra::{Matrix2, Vector2};
use ruga_material::{Substrate, Wrinkling, substrate_stiffness};
use rustfft::num_complex::Complex64;

use super::fourier::Grid;

/// Normal stiffness of what carries a plate, per wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// `K0 + K1 k^2` of the film itself: what the shell stands on.
    Pasternak,
    /// `2 D k_c^3 k`, the half-space of the same critical wave.
    HalfSpace,
    /// A bonded layer on a rigid base.
    Layer(Substrate),
}

impl Carrier {
    /// `K(k)`, Pa/m.
    pub fn stiffness(&self, film: &Wrinkling, wave_number: f64) -> f64 {
        match self {
            Self::Pasternak => {
                film.normal_stiffness + film.gradient_stiffness * wave_number * wave_number
            }
            Self::HalfSpace => {
                2.0 * film.bending_stiffness * film.wave_number.powi(3) * wave_number
            }
            Self::Layer(substrate) => substrate_stiffness(wave_number, substrate),
        }
    }
}

/// A film on a foundation, on a periodic grid.
pub struct Plate {
    /// Where it lies.
    pub grid: Grid,
    /// Stiffnesses, and the scales of linear theory.
    pub film: Wrinkling,
    /// Poisson ratio of the film.
    pub poisson: f64,
    /// `D k^4 + K(k)` per coefficient, Pa/m.
    pub(super) resistance: Vec<f64>,
}

impl Plate {
    /// Lays a film on a carrier, held along it by tangential springs as stiff as `film` says.
    pub fn new(grid: Grid, film: Wrinkling, poisson: f64, carrier: Carrier) -> Self {
        let resistance = (0..grid.points())
            .map(|mode| {
                let k = grid.wave_vector(mode).norm();
                film.bending_stiffness * k.powi(4) + carrier.stiffness(&film, k)
            })
            .collect();
        Self {
            grid,
            film,
            poisson,
            resistance,
        }
    }

    /// Energy per area of the flat plate under mean compressive strains along x and y, J/m^2.
    pub fn flat_energy(&self, strain: [f64; 2]) -> f64 {
        let e = Matrix2::from_diagonal(&Vector2::new(strain[0], strain[1]));
        0.5 * e.dot(&self.stress(&e))
    }

    /// Energy per area (J/m^2) and the coefficients of its derivative by the heights (Pa), of
    /// heights given by their coefficients, m.
    pub fn energy(&self, heights: &[Complex64], strain: [f64; 2]) -> (f64, Vec<Complex64>) {
        let grid = &self.grid;
        let (slopes, mut forces) = self.strains(heights);
        let membrane = self.to_forces(&mut forces, strain);
        let [xx, yy] = grid.fields([&forces[0], &forces[1]]);
        let [xy, _] = grid.fields([&forces[2], &vec![Complex64::ZERO; grid.points()]]);
        let flux = |along: &[f64], across: &[f64], axis: usize| -> Vec<f64> {
            let terms = along.iter().zip(&slopes[axis]);
            let other = across.iter().zip(&slopes[1 - axis]);
            terms
                .zip(other)
                .map(|((n, s), (m, t))| n * s + m * t)
                .collect()
        };
        let flux = grid.coefficients([&flux(&xx, &xy, 0), &flux(&yy, &xy, 1)]);

        let mut carried = 0.0;
        let gradient = (0..heights.len()).map(|mode| {
            let k = grid.slope_vector(mode);
            let force = heights[mode] * self.resistance[mode];
            carried += 0.5 * (force * heights[mode].conj()).re;
            force - Complex64::i() * (flux[0][mode] * k.x + flux[1][mode] * k.y)
        });
        let gradient = gradient.collect();
        (carried + membrane, gradient)
    }

    /// How far the film slides along x and y (m) beyond its mean strain when it has the given heights,
    /// m.
    pub fn slides(&self, heights: &[f64]) -> [Vec<f64>; 2] {
        let [heights, _] = self.grid.coefficients([heights, heights]);
        let (_, [xx, yy, xy]) = self.strains(&heights);
        let nu = self.poisson;
        let mut slides = [0, 1].map(|_| vec![Complex64::ZERO; xx.len()]);
        for mode in 0..xx.len() {
            let k = self.grid.slope_vector(mode);
            let size = k.norm();
            if size == 0.0 {
                continue;
            }
            let (along, across) = (k / size, Vector2::new(-k.y, k.x) / size);
            let part = |a: &Vector2<f64>, b: &Vector2<f64>| {
                xx[mode] * (a.x * b.x) + yy[mode] * (a.y * b.y) + xy[mode] * (a.x * b.y + a.y * b.x)
            };
            let ratio = self.tangential_ratio(size * size);
            let stretch = -(part(&along, &along) + part(&across, &across) * nu) / (1.0 + ratio);
            let shear = part(&along, &across) * (nu - 1.0) / (0.5 * (1.0 - nu) + ratio);
            for axis in 0..2 {
                let slope = stretch * along[axis] + shear * across[axis];
                slides[axis][mode] = slope / Complex64::new(0.0, size);
            }
        }
        self.grid.fields([&slides[0], &slides[1]])
    }

    /// Slopes along x and y, and the coefficients of `q_xx, q_yy, q_xy`.
    fn strains(&self, heights: &[Complex64]) -> ([Vec<f64>; 2], [Vec<Complex64>; 3]) {
        let grid = &self.grid;
        let slopes = grid.slopes(heights);
        let slopes = grid.fields([&slopes[0], &slopes[1]]);
        let product = |a: usize, b: usize| -> Vec<f64> {
            let terms = slopes[a].iter().zip(&slopes[b]);
            terms.map(|(x, y)| 0.5 * x * y).collect()
        };
        let [xx, yy] = grid.coefficients([&product(0, 0), &product(1, 1)]);
        let [xy, _] = grid.coefficients([&product(0, 1), &vec![0.0; grid.points()]]);
        (slopes, [xx, yy, xy])
    }

    /// `T = Kt/(C k^2)` at a squared wave number.
    fn tangential_ratio(&self, square: f64) -> f64 {
        self.film.tangential_stiffness / (self.film.membrane_stiffness * square)
    }

    /// Turns the coefficients of `q_xx, q_yy, q_xy` into those of the membrane forces, N/m; the
    /// membrane's energy per area, J/m^2.
    fn to_forces(&self, strains: &mut [Vec<Complex64>; 3], strain: [f64; 2]) -> f64 {
        let mut energy = 0.0;
        let [xx, yy, xy] = strains;
        for (mode, ((xx, yy), xy)) in xx.iter_mut().zip(yy).zip(xy).enumerate() {
            let mut q = Matrix2::new(*xx, *xy, *xy, *yy);
            if mode == 0 {
                q.m11 -= strain[0];
                q.m22 -= strain[1];
            }
            let k = self.grid.slope_vector(mode);
            let parts = [q.map(|c| c.re), q.map(|c| c.im)];
            let force = parts.map(|part| self.relaxed(&part, &k));
            energy += 0.5 * (force[0].dot(&parts[0]) + force[1].dot(&parts[1]));
            let part = |i: (usize, usize)| Complex64::new(force[0][i], force[1][i]);
            (*xx, *yy, *xy) = (part((0, 0)), part((1, 1)), part((0, 1)));
        }
        energy
    }

    /// Membrane forces that a wave of strain leaves when the film has slid.
    fn relaxed(&self, q: &Matrix2<f64>, k: &Vector2<f64>) -> Matrix2<f64> {
        let square = k.norm_squared();
        if square == 0.0 {
            return self.stress(q);
        }
        let (stiffness, nu) = (self.film.membrane_stiffness, self.poisson);
        let ratio = self.tangential_ratio(square);
        let along = k / square.sqrt();
        let frame = Matrix2::new(along.x, -along.y, along.y, along.x);
        let q = frame.transpose() * q * frame;
        let (ll, tt, lt) = (q.m11, q.m22, q.m12);
        let shear = (1.0 - nu) * lt * ratio / (ratio + 0.5 * (1.0 - nu));
        let local = Matrix2::new(
            (ll + nu * tt) * ratio / (1.0 + ratio),
            shear,
            shear,
            tt + nu * ll - nu * (ll + nu * tt) / (1.0 + ratio),
        );
        frame * (local * stiffness) * frame.transpose()
    }

    /// Plane stress, N/m.
    fn stress(&self, strain: &Matrix2<f64>) -> Matrix2<f64> {
        let nu = self.poisson;
        let isotropic = Matrix2::from_diagonal_element(nu * strain.trace());
        (strain * (1.0 - nu) + isotropic) * self.film.membrane_stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FlatFilm;

    #[test]
    fn gradient_is_the_derivative_of_the_energy() {
        let spec = FlatFilm::new(1000.0);
        let film = spec.theory();
        let side = 2.0 * film.wavelength;
        let grid = Grid::new([12, 10], [side, 0.9 * side]);
        let plate = Plate::new(grid, film, 0.3, Carrier::HalfSpace);
        let strain = [0.02, 0.01];
        let field = |seed: f64| -> Vec<Complex64> {
            let value =
                |i: usize| spec.layer.material.thickness * (seed * (i * i + 1) as f64).sin();
            let values: Vec<f64> = (0..120).map(value).collect();
            let [coefficients, _] = plate.grid.coefficients([&values, &values]);
            coefficients
        };
        let (heights, direction) = (field(0.7), field(1.3));
        let at = |step: f64| -> Vec<Complex64> {
            let moved = heights.iter().zip(&direction);
            moved.map(|(h, d)| h + d * step).collect()
        };
        let (_, gradient) = plate.energy(&heights, strain);
        let exact: f64 = gradient
            .iter()
            .zip(&direction)
            .map(|(g, d)| (g * d.conj()).re)
            .sum();
        let step = 1e-4;
        let numeric =
            (plate.energy(&at(step), strain).0 - plate.energy(&at(-step), strain).0) / (2.0 * step);
        assert!((numeric / exact - 1.0).abs() < 1e-6, "{numeric} {exact}");
    }
}
