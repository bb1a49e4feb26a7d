//! Conjugate gradients on a matrix of seven entries a row.

/// Springs that share a particle with one spring: three at either end, the first three at its first end.
pub(super) const NEIGHBOURS: usize = 6;

/// Residual over right-hand side at which a system counts as solved. The paper says nothing. A hundredth of this costs
/// 1.6 times the iterations and leaves the turn of a strip what it is, to a thousandth after 7 projections and to a
/// twentieth after 1000; a hundred times as much makes the strip twist.
const TOLERANCE: f64 = 1e-4;

/// Iterations per row after which a system is left as it is. In exact arithmetic one per row is enough.
const MOST_ITERATIONS: usize = 2;

/// Solver of the systems of fast projection, with the memory that it uses again and again.
///
/// The matrix is stored as the paper stores it, in the format ELLPACK: a fixed number of entries a row, and the
/// columns apart from the values.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    pub(super) diagonal: Vec<f64>,
    pub(super) values: Vec<[f64; NEIGHBOURS]>,
    /// Right-hand side; after solving, the residual.
    pub(super) right: Vec<f64>,
    /// What solves the system.
    pub(super) solution: Vec<f64>,
    /// Gradients of the constraints with respect to their first ends.
    pub(super) gradients: Vec<nalgebra::Vector3<f64>>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

impl Solver {
    /// Solves for the matrix and the right-hand side that are there, from zero; gives the iterations.
    ///
    /// Without a preconditioner, as printed. The diagonal is nearly constant, so that dividing by it gains nothing.
    pub(super) fn solve(&mut self, neighbours: &[[u32; NEIGHBOURS]]) -> usize {
        let rows = self.right.len();
        self.solution.clear();
        self.solution.resize(rows, 0.0);
        self.direction.clone_from(&self.right);
        self.product.resize(rows, 0.0);
        let mut square = squared(&self.right);
        let enough = TOLERANCE * TOLERANCE * square;
        for iteration in 0..MOST_ITERATIONS * rows {
            if square <= enough {
                return iteration;
            }
            let curvature = self.multiply(neighbours);
            // Of a spring without length nothing is known, and its row is zero.
            if curvature.is_nan() || curvature <= 0.0 {
                return iteration;
            }
            let step = square / curvature;
            let before = square;
            square = self.advance(step);
            let keep = square / before;
            for (d, r) in self.direction.iter_mut().zip(&self.right) {
                *d = r + keep * *d;
            }
        }
        MOST_ITERATIONS * rows
    }

    /// Multiplies the direction by the matrix; gives the scalar product of both.
    fn multiply(&mut self, neighbours: &[[u32; NEIGHBOURS]]) -> f64 {
        let direction = self.direction.as_slice();
        let rows = self.diagonal.iter().zip(&self.values).zip(neighbours);
        let products = self.product.iter_mut().zip(direction);
        let mut sum = 0.0;
        for ((product, own), ((diagonal, values), columns)) in products.zip(rows) {
            let entry = |k: usize| values[k] * direction[columns[k] as usize];
            // By pairs, so that additions need not wait for each other.
            let others = (entry(0) + entry(1)) + (entry(2) + entry(3)) + (entry(4) + entry(5));
            *product = diagonal * own + others;
            sum += own * *product;
        }
        sum
    }

    /// Moves solution and residual along the direction; gives the square of the residual.
    fn advance(&mut self, step: f64) -> f64 {
        let moved = self.solution.iter_mut().zip(&self.direction);
        for (x, d) in moved {
            *x += step * d;
        }
        for (r, q) in self.right.iter_mut().zip(&self.product) {
            *r -= step * q;
        }
        squared(&self.right)
    }
}

/// Sum of squares, in four sums so that additions need not wait for each other.
fn squared(values: &[f64]) -> f64 {
    let chunks = values.chunks_exact(4);
    let rest: f64 = chunks.remainder().iter().map(|v| v * v).sum();
    let mut sums = [0.0; 4];
    for chunk in chunks {
        for (sum, value) in sums.iter_mut().zip(chunk) {
            *sum += value * value;
        }
    }
    sums.iter().sum::<f64>() + rest
}
