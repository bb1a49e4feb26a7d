//! The bending stiffness of an actual mesh when it wrinkles.

mod lanczos;

use faer::Side;
use faer::sparse::{SparseColMat, Triplet};
use nalgebra::{Matrix3, Vector2, Vector3};
use ruga_mesh::{EdgeId, FaceId, Id, PerEdge, TriMesh, VertexId};

use crate::crease::soften;
use crate::hinge::HingeState;
use crate::layer_bending::{InnerEdge, inner_edges};
use crate::layer_creases::{SizedCrease, sized_creases, star_branches};
use crate::stars::stars;
use crate::{
    BendingModel, Crease, HingeShape, NormalFoundation, ResponseQuery, RestTriangle, ShellError,
};
use lanczos::{dot, largest_eigenvalue};

/// The first buckling mode of the sheet, as a plate modulus.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseModulus {
    /// Least compressive force per width that buckles the sheet (N/m).
    pub critical_force: f64,
    /// `D_eff` (N m), from `N_min = 2 sqrt(D_eff K0) + K1`.
    pub bending_modulus: f64,
    /// Stiffness of the half-consistent foundation in this mode, `w^T M w`, over that of the
    /// lumped mass. `bending_modulus` over this is what the bending alone responds with.
    pub mass_share: f64,
    /// Normal deviation of each vertex in the mode; the largest is 1.
    pub mode: Vec<f64>,
    /// Lanczos steps taken.
    pub iterations: usize,
    /// Whether `critical_force` settled to a millionth.
    pub converged: bool,
}

/// Corner positions of each face, for a mesh whose vertices have one position each.
///
/// # Panics
/// When there are fewer `positions` than vertices.
pub fn face_corners(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<[Vector3<f64>; 3]> {
    let faces = mesh.faces().as_slice().iter();
    faces
        .map(|face| face.map(|v| positions[v.index()]))
        .collect()
}

/// Smallest `N` with `w^T (B + K0 M + K1 G) w = N w^T G_d w` over deviations `w` along the vertex
/// normals, and the plate modulus it corresponds to.
///
/// `B` is the bending energy linearised at rest, `M` and `G` the foundation's mass and gradient, `G_d`
/// the gradient along the compression. This is the modulus with which a mesh *responds*: energies
/// of interpolated cylinders overrate an unstructured mesh, whose vertices relax.
///
/// # Validity
/// With uniform stiffness. A patch of ten wavelengths square between fixed borders reads 0.5 % high.
/// The half-consistent mass takes off `(k a)^2/16` on edges `a`: 1.7 % at 12 points per wavelength,
/// so that the perfect mesh of hinges reads 0.98 across its rows and 1.00 along them, and more where
/// triangles are stretched and the direction slanted; `mass_share` says how much.
///
/// # Errors
/// [`ShellError::UnstableSheet`], [`ShellError::NoDirection`], and those of bad meshes.
pub fn response_modulus(query: &ResponseQuery) -> Result<ResponseModulus, ShellError> {
    creased_response(query, &[])
}

/// The first buckling mode of a sheet with creases, from their state without moment.
///
/// [`response_modulus`] with creases in series with the bending, free to fold to either side: the least
/// force at which a film gives way at a line, long before it wrinkles. `bending_modulus` is then that of
/// a uniform film with this force.
///
/// # Errors
/// Those of [`response_modulus`] and of [`LayerEnergy::set_creases`](crate::LayerEnergy::set_creases).
pub fn creased_response(
    query: &ResponseQuery,
    creases: &[(EdgeId, Crease)],
) -> Result<ResponseModulus, ShellError> {
    query.check()?;
    let rest = query
        .corners
        .iter()
        .enumerate()
        .map(|(face, corners)| RestTriangle::new(corners, face))
        .collect::<Result<Vec<_>, _>>()?;
    let free = FreeIndex::new(query.fixed);

    let mut stiffness = Entries::of(Stored::Lower);
    let sized = sized_creases(query, &rest, creases)?;
    add_bending((query, &sized), &rest, &free, &mut stiffness);
    add_foundation(query, &rest, &free, &mut stiffness);
    let mut load = Entries::of(Stored::Whole);
    add_load(query, &rest, &free, &mut load)?;

    let unstable = ShellError::UnstableSheet {
        gradient_stiffness: query.gradient_stiffness,
    };
    let assemble = |entries: Entries| {
        SparseColMat::try_new_from_triplets(free.count, free.count, &entries.triplets)
            .map_err(|_| unstable.clone())
    };
    let load = assemble(load)?;
    // The load is only semidefinite, the stiffness is definite: so the stiffness is factorised, from its lower
    // triangle, and the least force is sought as the largest of the inverse forces, which Lanczos finds first; it
    // multiplies by the whole load.
    let factor = assemble(stiffness)?
        .sp_cholesky(Side::Lower)
        .map_err(|_| unstable.clone())?;
    let lanczos = largest_eigenvalue(&factor, &load).ok_or(unstable)?;

    let critical_force = 1.0 / lanczos.eigenvalue;
    // Over all wavenumbers D k^2 + K0/k^2 + K1 is at least 2 sqrt(D K0) + K1.
    let bending_force = 0.5 * (critical_force - query.gradient_stiffness);
    let mode = free.spread(&lanczos.vector);
    Ok(ResponseModulus {
        critical_force,
        bending_modulus: bending_force * bending_force / query.normal_stiffness,
        mass_share: mass_share(query, &rest, &mode),
        mode,
        iterations: lanczos.steps,
        converged: lanczos.converged,
    })
}

/// Numbers the vertices that may deviate.
struct FreeIndex {
    of: Vec<Option<usize>>,
    count: usize,
}

/// What is stored of a symmetric matrix.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stored {
    Lower,
    Whole,
}

/// Triplets of a symmetric matrix before those for one place are added up: several times as many as it has entries.
struct Entries {
    triplets: Vec<Triplet<usize, usize, f64>>,
    stored: Stored,
}

impl Entries {
    fn of(stored: Stored) -> Self {
        let triplets = Vec::new();
        Self { triplets, stored }
    }
}

impl FreeIndex {
    fn new(fixed: &[bool]) -> Self {
        let mut count = 0;
        let of = fixed
            .iter()
            .map(|fixed| {
                (!fixed).then(|| {
                    count += 1;
                    count - 1
                })
            })
            .collect();
        Self { of, count }
    }

    fn add(&self, entries: &mut Entries, row: VertexId, column: VertexId, value: f64) {
        if let (Some(row), Some(column)) = (self.of[row.index()], self.of[column.index()])
            && (row >= column || entries.stored == Stored::Whole)
        {
            entries.triplets.push(Triplet::new(row, column, value));
        }
    }

    fn add_face(&self, entries: &mut Entries, face: [VertexId; 3], matrix: &Matrix3<f64>) {
        for i in 0..3 {
            for j in 0..3 {
                self.add(entries, face[i], face[j], matrix[(i, j)]);
            }
        }
    }

    /// Adds the square of a sum of deviations.
    fn add_square(&self, entries: &mut Entries, stiffness: f64, row: &[(VertexId, f64)]) {
        for &(i, a) in row {
            for &(j, b) in row {
                self.add(entries, i, j, stiffness * a * b);
            }
        }
    }

    fn spread(&self, free: &[f64]) -> Vec<f64> {
        // The sign of an eigenvector is arbitrary; dividing by the largest entry fixes it.
        let signed = free.iter().fold(
            0.0,
            |top: f64, &v| if v.abs() > top.abs() { v } else { top },
        );
        self.of
            .iter()
            .map(|index| index.map_or(0.0, |i| free[i] / signed))
            .collect()
    }
}

fn add_bending(
    (query, creases): (&ResponseQuery, &PerEdge<Option<SizedCrease>>),
    rest: &[RestTriangle],
    free: &FreeIndex,
    entries: &mut Entries,
) {
    let inner = inner_edges(query.mesh, &[]);
    let folds = folds(query, &inner);
    match query.bending_model {
        BendingModel::Hinge => {
            for edge in inner {
                let shape = HingeShape::between(edge.sides, rest);
                let plain = shape.stiffness(query.bending_modulus, query.hinge_exponent);
                let stiffness = match &creases[edge.edge] {
                    None => plain,
                    Some(crease) => crease.of_hinge(plain).series_stiffness(),
                };
                free.add_square(entries, stiffness, &folds[edge.edge]);
            }
        }
        BendingModel::VertexCurvature => add_stars((query, creases), rest, &folds, free, entries),
    }
}

/// Derivative of an edge's angle by the deviations of its four vertices.
type FoldRow = [(VertexId, f64); 4];

fn add_stars(
    (query, creases): (&ResponseQuery, &PerEdge<Option<SizedCrease>>),
    rest: &[RestTriangle],
    folds: &PerEdge<FoldRow>,
    free: &FreeIndex,
    entries: &mut Entries,
) {
    for star in stars(query.mesh, &[]) {
        let shape = star.shape(rest);
        let mut weights = shape.rows(query.bending_modulus * shape.area(), query.poisson);
        let edges = (0..).zip(&star.folds);
        let creased = edges.filter_map(|(fold, of)| Some((fold, creases[of.edge]?)));
        let creased: Vec<_> = creased.collect();
        if !creased.is_empty() {
            let branches = star_branches(&creased, (&star, rest), &weights);
            soften(&branches, &mut weights);
        }
        for component in 0..3 {
            let vertices = star.vertices.iter();
            let mut row: Vec<_> = vertices.map(|&vertex| (VertexId(vertex), 0.0)).collect();
            for (fold, weight) in star.folds.iter().zip(&weights) {
                for (corner, (_, by)) in fold.corners.iter().zip(folds[fold.edge]) {
                    row[*corner as usize].1 += weight[component] * by;
                }
            }
            free.add_square(entries, 1.0, &row);
        }
    }
}

/// Fold row of every edge; zero at borders.
fn folds(query: &ResponseQuery, inner: &[InnerEdge]) -> PerEdge<FoldRow> {
    let normals = corner_normals(query);
    let corner = |face: FaceId, k: usize| query.corners[face.index()][k % 3];
    let mut folds = PerEdge::filled(query.mesh.edges().len(), [(VertexId(0), 0.0); 4]);
    for edge in inner {
        let [(left, tail), (right, head)] = edge.sides;
        // The right apex is placed from its own face's copy of the edge's head.
        let end = corner(left, tail + 1);
        let apex = end + corner(right, head + 2) - corner(right, head);
        let points = [corner(left, tail), end, corner(left, tail + 2), apex];
        // In a plane angles do not depend on in-plane motion to first order, so that a deviation
        // along the normals is all that bends.
        let gradient = HingeState::new(&points).angle_gradient();
        folds[edge.edge] = std::array::from_fn(|i| {
            let vertex = VertexId(edge.vertices[i]);
            (vertex, gradient[i].dot(&normals[vertex.index()]))
        });
    }
    folds
}

/// `w^T M w` with the foundation's mass over that with a lumped one.
fn mass_share(query: &ResponseQuery, rest: &[RestTriangle], mode: &[f64]) -> f64 {
    let (mut mixed, mut lumped) = (0.0, 0.0);
    for (face, rest) in query.mesh.faces().as_slice().iter().zip(rest) {
        let w = face.map(|v| mode[v.index()]);
        let [normal, _] = NormalFoundation::new(rest, 1.0, 0.0).values(w);
        // An energy with unit stiffness is half of the square asked for.
        mixed += 2.0 * normal;
        lumped += rest.area() / 3.0 * dot(&w, &w);
    }
    mixed / lumped
}

fn corner_normals(query: &ResponseQuery) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); query.fixed.len()];
    for (face, [a, b, c]) in query.mesh.faces().as_slice().iter().zip(query.corners) {
        let normal = (b - a).cross(&(c - a));
        for vertex in face {
            normals[vertex.index()] += normal;
        }
    }
    normals
        .into_iter()
        // A vertex without faces is in no stencil: its direction does not matter.
        .map(|n| n.try_normalize(0.0).unwrap_or_else(Vector3::z))
        .collect()
}

fn add_foundation(
    query: &ResponseQuery,
    rest: &[RestTriangle],
    free: &FreeIndex,
    entries: &mut Entries,
) {
    for (&face, rest) in query.mesh.faces().as_slice().iter().zip(rest) {
        let stencil = NormalFoundation::new(rest, query.normal_stiffness, query.gradient_stiffness);
        free.add_face(entries, face, &stencil.matrix());
    }
}

/// `int (d.grad w)^2`: what the compressive force works on.
fn add_load(
    query: &ResponseQuery,
    rest: &[RestTriangle],
    free: &FreeIndex,
    entries: &mut Entries,
) -> Result<(), ShellError> {
    for (face, triangle) in rest.iter().enumerate() {
        let [a, b, c] = query.corners[face];
        // The axes of the rest triangle's local frame, in which its shape gradients are given.
        let first = (b - a).normalize();
        let second = (b - a).cross(&(c - a)).cross(&first).normalize();
        let along = [first, second].map(|axis| axis.dot(&query.directions[face]));
        let direction = Vector2::from(along)
            .try_normalize(f64::MIN_POSITIVE)
            .ok_or(ShellError::NoDirection { face })?;
        let slopes = Vector3::from(triangle.shape_gradients().map(|g| g.dot(&direction)));
        let matrix = slopes * slopes.transpose() * triangle.area();
        free.add_face(entries, query.mesh.faces().as_slice()[face], &matrix);
    }
    Ok(())
}
