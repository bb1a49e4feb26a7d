//! Buckling of a free annular plate whose parts have shrunk unequally: a reference in one dimension.

use nalgebra::{DMatrix, SymmetricEigen};

/// Polynomials in the radius that deflections are made of. Six give four digits of the onset, nine seven.
const TERMS: usize = 9;
/// Midpoints of the integrals over the radius.
const POINTS: usize = 2000;

/// Plane stress `E = 1`, with a natural strain `-s shrink(r)`, the same in both directions.
pub(crate) struct AnnularPlate {
    radii: [f64; 2],
    thickness: f64,
    poisson: f64,
    /// Radius, and stresses along and around it for `s = 1`.
    stresses: Vec<[f64; 3]>,
}

impl AnnularPlate {
    /// The plate between two radii, of this thickness and Poisson ratio, `E = 1`.
    pub(crate) fn new(
        radii: [f64; 2],
        [thickness, poisson]: [f64; 2],
        shrink: impl Fn(f64) -> f64,
    ) -> Self {
        let [inner, outer] = radii;
        let step = (outer - inner) / POINTS as f64;
        let strain = |r: f64| -shrink(r);
        let points: Vec<_> = (0..POINTS)
            .map(|i| inner + (i as f64 + 0.5) * step)
            .collect();
        // Timoshenko and Goodier, art. 150, with the natural strain for the thermal one.
        let whole: f64 = points.iter().map(|&r| strain(r) * r * step).sum();
        let whole = whole / (outer * outer - inner * inner);
        let mut below = 0.0;
        let stresses = points.iter().map(|&r| {
            let half = 0.5 * strain(r) * r * step;
            let so_far = below + half;
            below += 2.0 * half;
            let square = r * r;
            let hole = inner * inner;
            let along = (square - hole) * whole - so_far;
            let around = (square + hole) * whole + so_far - strain(r) * square;
            [r, along / square, around / square]
        });
        Self {
            radii,
            thickness,
            poisson,
            stresses: stresses.collect(),
        }
    }

    /// Number of waves around, and the least `s` at which the plate leaves its plane.
    pub(crate) fn onset(&self) -> (usize, f64) {
        let all = (0..12)
            .filter(|waves| *waves != 1)
            .map(|waves| (waves, self.critical(waves)));
        all.min_by(|(_, a), (_, b)| a.total_cmp(b))
            .expect("a dozen of numbers")
    }

    /// `s` at which `W(r) cos(m t)` is in equilibrium, by Ritz.
    fn critical(&self, waves: usize) -> f64 {
        let [inner, outer] = self.radii;
        let step = (outer - inner) / POINTS as f64;
        let (m, nu) = (waves as f64, self.poisson);
        let modulus = self.thickness.powi(3) / (12.0 * (1.0 - nu * nu));
        // A constant costs nothing, and is no deflection.
        let first = usize::from(waves == 0);
        let mut bending = DMatrix::<f64>::zeros(TERMS, TERMS);
        let mut load = bending.clone();
        for &[r, along, around] in &self.stresses {
            let at = (2.0 * r - inner - outer) / (outer - inner);
            let scale = 2.0 / (outer - inner);
            let terms: Vec<_> = (first..first + TERMS)
                .map(|k| {
                    let k = k as i32;
                    let n = f64::from(k);
                    let w = at.powi(k);
                    let slope = if k > 0 {
                        n * at.powi(k - 1) * scale
                    } else {
                        0.0
                    };
                    let second = if k > 1 {
                        n * (n - 1.0) * at.powi(k - 2) * scale * scale
                    } else {
                        0.0
                    };
                    let around = slope / r - m * m * w / (r * r);
                    let twist = m * (slope / r - w / (r * r));
                    [second, around, twist, slope, m * w / r]
                })
                .collect();
            for (i, a) in terms.iter().enumerate() {
                for (j, b) in terms.iter().enumerate() {
                    let bend = (a[0] + a[1]) * (b[0] + b[1])
                        - (1.0 - nu) * (a[0] * b[1] + a[1] * b[0] - 2.0 * a[2] * b[2]);
                    bending[(i, j)] += modulus * bend * r * step;
                    let pull = along * a[3] * b[3] + around * a[4] * b[4];
                    load[(i, j)] += self.thickness * pull * r * step;
                }
            }
        }
        // -load w = (1/s) bending w
        let root = bending.cholesky().expect("no rigid motion is left").l();
        let inverse = root.try_inverse().expect("a Cholesky factor");
        let scaled = -(&inverse * load * inverse.transpose());
        match SymmetricEigen::new(scaled).eigenvalues.max() {
            softened if softened > 0.0 => 1.0 / softened,
            _ => f64::INFINITY,
        }
    }
}
