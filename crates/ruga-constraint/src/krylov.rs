//! Block Lanczos on the inverse of the shifted Laplacian.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

use crate::laplacian::Laplacian;

/// Vectors that are added together. A single one finds one function of each eigenvalue only, and
/// symmetric bodies have up to five; blocks also make reorthogonalisation a matrix product.
const BLOCK: usize = 8;

/// Share of a vector outside the space so far below which it is nothing but rounding.
const EXHAUSTED: f64 = 1e-10;

/// Lowest eigenpairs of the Laplacian, so far as found.
pub(crate) struct Eigenpairs {
    /// Ascending, 1/m2.
    pub(crate) values: Vec<f64>,
    /// A unit vector per column.
    pub(crate) vectors: Mat<f64>,
    /// Largest relative residual.
    pub(crate) residual: f64,
}

/// An orthonormal basis `V` and the operator in it, `V^T A V` with `A = (S + shift)^-1`.
///
/// Full reorthogonalisation, twice. The projected operator comes from the same inner products, so
/// that the pairs found are right for whatever basis: fresh directions may be added at any time.
pub(crate) struct Krylov<'a> {
    laplacian: &'a Laplacian,
    /// Only the first `size` columns count.
    basis: Mat<f64>,
    size: usize,
    /// The first `applied` columns and rows count.
    projected: Mat<f64>,
    applied: usize,
    noise: Noise,
}

impl<'a> Krylov<'a> {
    /// A space that begins with the constant function and some noise.
    pub(crate) fn new(laplacian: &'a Laplacian) -> Self {
        let size = laplacian.size();
        let capacity = 4 * BLOCK;
        let mut space = Self {
            laplacian,
            basis: Mat::zeros(size, capacity),
            size: 0,
            projected: Mat::zeros(capacity, capacity),
            applied: 0,
            noise: Noise(1),
        };
        let constant = |i: usize, _| laplacian.root_mass[i] / laplacian.area.sqrt();
        space.add(Mat::from_fn(size, 1, constant));
        space.refresh();
        space
    }

    /// Vectors in the basis to which the operator has been applied.
    pub(crate) fn len(&self) -> usize {
        self.applied
    }

    /// Whether the basis spans everything.
    pub(crate) fn is_whole(&self) -> bool {
        self.applied == self.laplacian.size()
    }

    /// Adds a block of noise, in which functions show that the space so far has no part of.
    pub(crate) fn refresh(&mut self) {
        let noise = &mut self.noise;
        let block = Mat::from_fn(self.laplacian.size(), BLOCK, |_, _| noise.next());
        self.add(block);
    }

    /// Applies the operator to the newest vectors and adds what is new in the result.
    pub(crate) fn step(&mut self) {
        let (from, to) = (self.applied, self.size);
        let mut images = self.basis.get(.., from..to).to_owned();
        self.laplacian.apply_inverse(images.as_mut());
        let products = self.remove_overlap(images.as_mut());
        for j in from..to {
            for i in 0..to {
                self.projected[(i, j)] = products[(i, j - from)];
                self.projected[(j, i)] = products[(i, j - from)];
            }
        }
        self.applied = to;
        self.add(images);
    }

    /// Takes out of `vectors` what lies in the basis; gives how much that was.
    fn remove_overlap(&self, mut vectors: MatMut<'_, f64>) -> Mat<f64> {
        let basis = self.basis.get(.., ..self.size);
        let mut total = Mat::zeros(self.size, vectors.ncols());
        for _ in 0..2 {
            let mut overlap = Mat::zeros(self.size, vectors.ncols());
            let (transposed, given) = (basis.transpose(), vectors.as_ref());
            multiply(overlap.as_mut(), Accum::Replace, transposed, given, 1.0);
            multiply(vectors.as_mut(), Accum::Add, basis, overlap.as_ref(), -1.0);
            total += overlap;
        }
        total
    }

    /// Adds the directions of `vectors` that are new, until the basis spans everything.
    fn add(&mut self, mut vectors: Mat<f64>) {
        let before: Vec<f64> = (0..vectors.ncols())
            .map(|j| vectors.col(j).norm_l2())
            .collect();
        self.remove_overlap(vectors.as_mut());
        let first = self.size;
        self.reserve(first + vectors.ncols());
        for (j, before) in before.into_iter().enumerate() {
            let mut vector = vectors.col(j).to_owned();
            // The block's own earlier vectors, again twice.
            for _ in 0..2 {
                for earlier in first..self.size {
                    let earlier = self.basis.col(earlier);
                    let overlap = earlier.transpose() * &vector;
                    vector -= overlap * earlier;
                }
            }
            let norm = vector.norm_l2();
            if norm > EXHAUSTED * before && self.size < self.laplacian.size() {
                self.basis.col_mut(self.size).copy_from(vector / norm);
                self.size += 1;
            }
        }
    }

    fn reserve(&mut self, size: usize) {
        if size > self.basis.ncols() {
            let capacity = 2 * size;
            self.basis
                .resize_with(self.basis.nrows(), capacity, |_, _| 0.0);
            self.projected.resize_with(capacity, capacity, |_, _| 0.0);
        }
    }

    /// Whether there is nothing to apply the operator to.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.applied == self.size
    }

    /// The constant function and the `count - 1` lowest pairs beside it; `None` when the space has
    /// fewer, or numbers overflow.
    ///
    /// All else is orthogonal to the constant, so it is kept out: where a surface has several
    /// pieces, it would come mixed with other functions of the eigenvalue 0.
    pub(crate) fn lowest(&self, count: usize) -> Option<Eigenpairs> {
        let others = count.checked_sub(1)?;
        let from = self.applied.checked_sub(count)?;
        let projected = self.projected.get(1..self.applied, 1..self.applied);
        let eigen = projected.self_adjoint_eigen(Side::Lower).ok()?;
        let basis = self.basis.get(.., 1..self.applied);
        // Ascending in the inverse, so the lowest of the Laplacian come last.
        let chosen = eigen.U().get(.., from..);
        let mut reversed = Mat::zeros(basis.nrows(), others);
        multiply(reversed.as_mut(), Accum::Replace, basis, chosen, 1.0);
        let vectors = Mat::from_fn(basis.nrows(), count, |i, j| match j {
            0 => self.basis[(i, 0)],
            _ => reversed[(i, others - j)],
        });
        let inverse = eigen.S().column_vector();
        let shift = self.laplacian.shift;
        let value = |j: usize| (1.0 / inverse[self.applied - 1 - j] - shift).max(0.0);
        let values: Vec<f64> = std::iter::once(0.0).chain((1..count).map(value)).collect();
        let residual = (values.iter().enumerate())
            .map(|(j, &value)| self.laplacian.residual(&vectors, j, value))
            .fold(0.0, f64::max);
        residual.is_finite().then_some(Eigenpairs {
            values,
            vectors,
            residual,
        })
    }
}

/// `target = (0 or target) + factor left right`, on one thread so that the bits are always the same.
fn multiply(
    target: MatMut<'_, f64>,
    sum: Accum,
    left: MatRef<'_, f64>,
    right: MatRef<'_, f64>,
    factor: f64,
) {
    matmul(target, sum, left, right, factor, Par::Seq);
}

/// Reproducible numbers in [-0.5, 0.5) without symmetry, so that every function has a part in them:
/// SplitMix64.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}
