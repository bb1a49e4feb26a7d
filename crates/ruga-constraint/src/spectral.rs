//! Constraint functions of the whole surface: its lowest eigenfunctions.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId};

use crate::krylov::{Eigenpairs, Krylov};
use crate::laplacian::Laplacian;
use crate::{ConstraintError, ConstraintRow, Order};

/// Rows from the lowest eigenfunctions of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralRows {
    /// One row per function, in ascending order of eigenvalues. `weights` hold every vertex where
    /// the function is not zero; the first row is the average, the others have [`Order::Global`].
    pub rows: Vec<ConstraintRow>,
    /// Eigenvalue of each function, 1/m2: the square of the wave number that it lets through.
    pub eigenvalues: Vec<f64>,
    /// Largest residual `|S y - eigenvalue y| / (eigenvalue + 4 pi / area)` of the unit vectors `y`,
    /// with `S = M^-1/2 L M^-1/2`.
    pub residual: f64,
    /// Whether that is below 1e-9, for functions that fresh directions did not change.
    pub converged: bool,
}

/// Residual at which functions count as found.
const TOLERANCE: f64 = 1e-9;

/// Size of the space, in functions asked for, at which the search begins to look at what it has,
/// and at which it gives up. 300 functions of 5 thousand vertices take about 2.
const FIRST_LOOK: f64 = 1.5;
const MAX_GROWTH: usize = 6;

/// Steps from fresh noise after which a function that was missed would show.
const PROBE_STEPS: usize = 3;

/// The `count` lowest eigenfunctions of the surface's cotangent Laplacian with lumped mass, as rows:
/// Rémillard and Kry 2013, section 3.2.
///
/// For comparison only (their figure 3): the functions are global and the rows dense, so a wrinkle
/// anywhere is answered by ripples everywhere. [`constraint_rows`](crate::constraint_rows) gives
/// the local functions to use.
///
/// `L f = eigenvalue M f`, with functions orthonormal in the mean over the surface,
/// `sum_v m_v f_v g_v / A = 1 or 0`, and weights `w_v = m_v f_v / A`, numbers without unit. The first
/// function is constant, so its weights sum to one; those of all others sum to zero. Signs are such
/// that the largest value of a function is positive. Functions of equal eigenvalues are any basis
/// of their space, the same on every run.
///
/// Below the wave number `k` of a wave lie about `A k^2 / (4 pi)` functions (Weyl).
///
/// Shift-and-invert block Lanczos with full reorthogonalisation. Spaces in which a function of an
/// eigenvalue is missing are found out by fresh noise; more than eight components of the same shape
/// may hide one from that.
///
/// # Shapes and units
/// `positions` per vertex, at rest, m.
///
/// # Errors
/// [`ConstraintError::FunctionCount`] unless `count` is from 1 to the number of vertices,
/// [`ConstraintError::DegenerateFace`], [`ConstraintError::LooseVertex`], and those of arrays that
/// do not fit or hold no numbers.
pub fn spectral_rows(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    count: usize,
) -> Result<SpectralRows, ConstraintError> {
    let laplacian = Laplacian::new(mesh, positions)?;
    let vertices = laplacian.size();
    if count == 0 || count > vertices {
        return Err(ConstraintError::FunctionCount { count, vertices });
    }
    let (pairs, converged) = lowest_pairs(&laplacian, count)?;
    Ok(SpectralRows {
        rows: (0..count).map(|j| row(&laplacian, &pairs, j)).collect(),
        eigenvalues: pairs.values,
        residual: pairs.residual,
        converged,
    })
}

/// Grows a space until it holds the functions, then tries whether fresh noise finds others.
fn lowest_pairs(
    laplacian: &Laplacian,
    count: usize,
) -> Result<(Eigenpairs, bool), ConstraintError> {
    let mut space = Krylov::new(laplacian);
    let mut wanted = (FIRST_LOOK * count as f64) as usize + 16;
    let mut found: Option<Eigenpairs> = None;
    loop {
        while space.len() < wanted && !space.is_whole() {
            grow(&mut space);
        }
        let pairs = space.lowest(count).ok_or(ConstraintError::NoSpectrum)?;
        let is_settled = pairs.residual <= TOLERANCE;
        if space.is_whole() {
            return Ok((pairs, is_settled));
        }
        let is_confirmed = is_settled && found.is_some_and(|before| are_same(&before, &pairs));
        if is_confirmed || space.len() > MAX_GROWTH * count + 100 {
            return Ok((pairs, is_confirmed));
        }
        if is_settled {
            space.refresh();
            for _ in 0..PROBE_STEPS {
                grow(&mut space);
            }
        } else {
            wanted = space.len() + count / 8 + 8;
        }
        found = is_settled.then_some(pairs);
    }
}

fn grow(space: &mut Krylov) {
    if space.is_exhausted() {
        space.refresh();
    }
    space.step();
}

fn are_same(before: &Eigenpairs, after: &Eigenpairs) -> bool {
    let pairs = before.values.iter().zip(&after.values);
    let scale = after.values.last().copied().unwrap_or_default();
    pairs
        .into_iter()
        .all(|(a, b)| (a - b).abs() <= 1e-6 * scale)
}

fn row(laplacian: &Laplacian, pairs: &Eigenpairs, function: usize) -> ConstraintRow {
    let column = pairs.vectors.col(function);
    let scaled = |i: usize| laplacian.root_mass[i] * column[i] / laplacian.area.sqrt();
    let value = |i: usize| column[i] / laplacian.root_mass[i];
    let largest = (0..laplacian.size()).map(value).fold(0.0, |top: f64, v| {
        if v.abs() > (1.0 + 1e-6) * top.abs() {
            v
        } else {
            top
        }
    });
    let weights = (0..laplacian.size())
        .map(|i| (VertexId::from_index(i), largest.signum() * scaled(i)))
        .filter(|pair| pair.1 != 0.0);
    ConstraintRow {
        centre: function,
        weights: weights.collect(),
        order: match function {
            0 => Order::Constant,
            _ => Order::Global,
        },
    }
}
