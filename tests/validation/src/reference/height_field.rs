//! What a pattern of wrinkles is measured by.

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rustfft::num_complex::Complex64;

use super::fourier::Grid;

/// Heights over a periodic rectangle.
#[derive(Clone)]
pub struct HeightField {
    /// Where they are.
    pub grid: Grid,
    /// Row after row of x, m.
    pub heights: Vec<f64>,
}

/// Directions of the slopes of a pattern, as shares of all its squared slope.
#[derive(Clone, Debug, PartialEq)]
pub struct Orientation {
    /// Shares of equal sectors of the half circle, the first one centred on x.
    pub shares: Vec<f64>,
    /// Means of `exp(2 i phi)` and `exp(4 i phi)` over the slopes, by their cosine and sine.
    moments: [[f64; 2]; 2],
    tilt: f64,
    left_share: f64,
}

impl HeightField {
    /// `sqrt(2)` RMS height about the mean, m: the amplitude of a sine.
    pub fn amplitude(&self) -> f64 {
        let count = self.heights.len() as f64;
        let mean = self.heights.iter().sum::<f64>() / count;
        let squares: f64 = self.heights.iter().map(|h| (h - mean).powi(2)).sum();
        (2.0 * squares / count).sqrt()
    }

    /// Means of the wave number and of the sizes of its components along x and y (1/m), over the
    /// spectrum's power between two wave numbers.
    ///
    /// The centre of the ring, which a coarse spectrum of a few waves per box tells far better than
    /// the place of its highest coefficient.
    pub fn mean_wave(&self, band: [f64; 2]) -> [f64; 3] {
        let (mut sums, mut total) = ([0.0; 3], 0.0);
        for (mode, c) in self.coefficients().iter().enumerate() {
            let wave = self.grid.wave_vector(mode);
            let k = wave.norm();
            if (band[0]..=band[1]).contains(&k) {
                for (sum, k) in sums.iter_mut().zip([k, wave.x.abs(), wave.y.abs()]) {
                    *sum += k * c.norm_sqr();
                }
                total += c.norm_sqr();
            }
        }
        sums.map(|sum| sum / total)
    }

    /// `sqrt(<|grad w|^2> / <w^2>)` (1/m), which can be told on any mesh as well.
    pub fn slope_wave_number(&self) -> f64 {
        let (mut slopes, mut squares) = (0.0, 0.0);
        for (mode, c) in self.coefficients().iter().enumerate().skip(1) {
            slopes += self.grid.slope_vector(mode).norm_squared() * c.norm_sqr();
            squares += c.norm_sqr();
        }
        (slopes / squares).sqrt()
    }

    /// Power of the spectrum by wave number, in bins of `width` (1/m) from zero, m^2.
    pub fn spectrum(&self, width: f64, bins: usize) -> Vec<f64> {
        let mut power = vec![0.0; bins];
        for (mode, c) in self.coefficients().iter().enumerate().skip(1) {
            let bin = (self.grid.wave_vector(mode).norm() / width) as usize;
            if let Some(power) = power.get_mut(bin) {
                *power += c.norm_sqr();
            }
        }
        power
    }

    /// Directions of the slopes, weighted with their squares, in a number of sectors.
    pub fn orientation(&self, sectors: usize) -> Orientation {
        let slopes = self.grid.slopes(&self.coefficients());
        let [along, across] = self.grid.fields([&slopes[0], &slopes[1]]);
        let mut shares = vec![0.0; sectors];
        let (mut moments, mut total) = ([[0.0; 2]; 2], 0.0);
        let (mut tilt, mut left) = (0.0, 0.0);
        for (x, y) in along.iter().zip(&across) {
            let weight = x * x + y * y;
            let angle = y.atan2(*x).rem_euclid(PI);
            shares[(angle / PI * sectors as f64).round() as usize % sectors] += weight;
            for (moment, order) in moments.iter_mut().zip([2.0, 4.0]) {
                let (sin, cos) = (order * angle).sin_cos();
                moment[0] += weight * cos;
                moment[1] += weight * sin;
            }
            tilt += weight * angle.min(PI - angle);
            left += if angle < 0.5 * PI { weight } else { 0.0 };
            total += weight;
        }
        Orientation {
            shares: shares.iter().map(|share| share / total).collect(),
            moments: moments.map(|moment| moment.map(|m| m / total)),
            tilt: tilt / total,
            left_share: left / total,
        }
    }

    fn coefficients(&self) -> Vec<Complex64> {
        let [coefficients, _] = self.grid.coefficients([&self.heights, &self.heights]);
        coefficients
    }
}

impl Orientation {
    /// How one-directional the slopes are: `|<exp(2 i phi)>|`, 0 for none and for two directions at
    /// right angles, 1 for one direction.
    pub fn alignment(&self) -> f64 {
        self.moments[0][0].hypot(self.moments[0][1])
    }

    /// How four-fold the slopes are: `|<exp(4 i phi)>|`, 0 where every direction is as frequent, 1
    /// for two directions at right angles.
    pub fn crossing(&self) -> f64 {
        self.moments[1][0].hypot(self.moments[1][1])
    }

    /// Mean of `cos(4 phi)`: positive where slopes lie along the axes, negative where along the
    /// diagonals.
    pub fn along_axes(&self) -> f64 {
        self.moments[1][0]
    }

    /// Share of the slopes that another histogram has elsewhere, 0 to 1; half of what is in the next
    /// bin counts as being in the same one, because straight crests may fall on either side of an edge.
    pub fn distance(&self, other: &Self) -> f64 {
        let count = self.shares.len();
        let more = |bin: usize| self.shares[bin % count] - other.shares[bin % count];
        let smooth = |bin: usize| 0.25 * (more(bin + count - 1) + 2.0 * more(bin) + more(bin + 1));
        0.5 * (0..count).map(|bin| smooth(bin).abs()).sum::<f64>()
    }

    /// Mean angle between the slopes and x, radians: 0 for crests along y, pi/4 for a herringbone
    /// with right angles and for a pattern without direction.
    pub fn tilt(&self) -> f64 {
        self.tilt
    }

    /// Share of the slopes on the left of x, up to a right angle.
    pub fn left_share(&self) -> f64 {
        self.left_share
    }

    /// The mean of several patterns with as many sectors.
    pub fn mean(patterns: &[Self]) -> Self {
        let count = patterns.len() as f64;
        let mean = |value: &dyn Fn(&Self) -> f64| patterns.iter().map(value).sum::<f64>() / count;
        let sectors = patterns.first().map_or(0, |p| p.shares.len());
        Self {
            shares: (0..sectors).map(|i| mean(&|p| p.shares[i])).collect(),
            moments: [0, 1].map(|i| [0, 1].map(|j| mean(&|p| p.moments[i][j]))),
            tilt: mean(&|p| p.tilt),
            left_share: mean(&|p| p.left_share),
        }
    }
}

/// White noise between plus and minus `size`, m.
pub fn noise(grid: &Grid, size: f64, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..grid.points())
        .map(|_| size * random.random_range(-1.0..1.0))
        .collect()
}

/// A wave of given amplitude (m) and orders on a grid.
pub fn wave(grid: &Grid, amplitude: f64, orders: [i64; 2]) -> Vec<f64> {
    let height = |point: usize| {
        let place = grid.place(point);
        let turns = (0..2)
            .map(|axis| orders[axis] as f64 * place[axis] / grid.extent[axis])
            .sum::<f64>();
        amplitude * (TAU * turns).cos()
    };
    (0..grid.points()).map(height).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(waves: &[[i64; 2]]) -> HeightField {
        let grid = Grid::new([32, 32], [TAU; 2]);
        let mut heights = vec![0.0; grid.points()];
        for orders in waves {
            let other = wave(&grid, 2.0, *orders);
            for (height, other) in heights.iter_mut().zip(other) {
                *height += other;
            }
        }
        HeightField { grid, heights }
    }

    #[test]
    fn a_wave_has_its_amplitude_number_and_direction() {
        let field = field(&[[3, 4]]);
        assert!((field.amplitude() - 2.0).abs() < 1e-12);
        let [k, x, y] = field.mean_wave([1.0, 10.0]);
        assert!((k - 5.0).abs() < 1e-9 && (x - 3.0).abs() < 1e-9 && (y - 4.0).abs() < 1e-9);
        assert!((field.slope_wave_number() - 5.0).abs() < 1e-9);
        let spectrum = field.spectrum(1.0, 8);
        assert!((spectrum[5] / spectrum.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        let orientation = field.orientation(12);
        assert!((orientation.alignment() - 1.0).abs() < 1e-9);
        assert!((orientation.tilt() - 4.0_f64.atan2(3.0)).abs() < 1e-9);
        assert!((orientation.shares[4] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn waves_at_right_angles_cross_and_have_no_direction() {
        let diagonal = field(&[[3, 3]]).orientation(12);
        let other = field(&[[3, -3]]).orientation(12);
        assert!((diagonal.distance(&other) - 1.0).abs() < 1e-9);
        let both = Orientation::mean(&[diagonal, other]);
        assert!(both.alignment() < 1e-9);
        assert!((both.crossing() - 1.0).abs() < 1e-9 && (both.along_axes() + 1.0).abs() < 1e-9);
        assert!((both.left_share() - 0.5).abs() < 1e-9);
    }
}
