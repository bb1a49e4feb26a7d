//! Sheets that nothing holds, brought to rest, and the curvature that they have there.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::f64::consts::TAU;

use nalgebra::{Matrix2, SMatrix, SVector, SymmetricEigen, Vector2, Vector3};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy};
use ruga_solver::{
    ConstraintRows, Iteration, Kkt, LowerPattern, NewtonSettings, Objective, minimise, softest_mode,
};

use crate::meshes::{Mesh, rng, symmetric};

/// A material without foundation.
pub(crate) fn bare(young: f64, poisson: f64, thickness: f64) -> FaceParameters {
    FaceParameters {
        young,
        poisson,
        thickness,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    }
}

/// Irregular triangles on a disc of radius 1 around the origin, `edges` of them from centre to rim, in
/// rings whose inner vertices move by up to `jitter` edges. `outer` more rings follow outside.
pub(crate) fn disc(edges: usize, outer: usize, jitter: f64, seed: u64) -> Mesh {
    ring_mesh(0..=edges + outer, edges, jitter, seed)
}

/// Irregular triangles between the radii `first/edges` and 1.
pub(crate) fn annulus(first: usize, edges: usize, jitter: f64, seed: u64) -> Mesh {
    let mut mesh = ring_mesh(first..=edges, edges, jitter, seed);
    // Delaunay triangles fill the hole as well, between vertices of the inner rim, which come first.
    let rim = 6 * first as u32;
    mesh.faces.retain(|face| face.iter().any(|&v| v >= rim));
    mesh
}

fn ring_mesh(rings: std::ops::RangeInclusive<usize>, edges: usize, jitter: f64, seed: u64) -> Mesh {
    let mut rng = rng(seed);
    let edge = 1.0 / edges as f64;
    let borders = [*rings.start(), edges, *rings.end()];
    let mut points = Vec::new();
    for ring in rings {
        let count = (6 * ring).max(1);
        let by = match borders.contains(&ring) {
            true => 0.0,
            false => jitter,
        };
        for k in 0..count {
            // Every other ring is turned by half of a step, or triangles pile up along six rays.
            let turn = TAU * (k as f64 + 0.5 * (ring % 2) as f64) / count as f64;
            let (sin, cos) = turn.sin_cos();
            let radius = ring as f64 * edge;
            let shift = [symmetric(&mut rng), symmetric(&mut rng)].map(|s| by * edge * s);
            points.push(delaunator::Point {
                x: radius * cos + shift[0],
                y: radius * sin + shift[1],
            });
        }
    }
    let triangles = delaunator::triangulate(&points).triangles;
    let faces = triangles.chunks_exact(3);
    Mesh {
        // Delaunator winds clockwise in a y-up plane.
        faces: faces
            .map(|t| [t[0], t[2], t[1]].map(|v| v as u32))
            .collect(),
        positions: points.iter().map(|p| Vector3::new(p.x, p.y, 0.0)).collect(),
    }
}

/// One tensor in space, lying in the plane z = 0, in the frames of all faces of a plane mesh.
pub(crate) fn in_frames(
    mesh: &Mesh,
    tensor: impl Fn(&Vector3<f64>) -> Matrix2<f64>,
) -> Vec<Matrix2<f64>> {
    let faces = mesh.faces.iter();
    faces
        .map(|face| {
            let [a, b, c] = face.map(|v| mesh.positions[v as usize]);
            let along = (b - a).xy().normalize();
            // Seen from below, a face that is wound the other way has its second axis turned over.
            let side = (b - a).cross(&(c - a)).z.signum();
            let frame = Matrix2::from_columns(&[along, Vector2::new(-along.y, along.x) * side]);
            frame.transpose() * tensor(&((a + b + c) / 3.0)) * frame
        })
        .collect()
}

/// A free sheet of one material with star bending.
pub(crate) fn free_layer(mesh: &Mesh, face: FaceParameters) -> LayerEnergy {
    mesh.layer(face, BendingModel::VertexCurvature)
}

struct FreeSheet<'a> {
    layer: &'a LayerEnergy,
    pattern: LowerPattern,
    energy: f64,
    edge: f64,
}

impl FreeSheet<'_> {
    fn positions(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        x.chunks_exact(3).map(Vector3::from_column_slice).collect()
    }
}

impl Objective for FreeSheet<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.layer.value(&self.positions(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.positions(x);
        self.layer.gradient(&positions, gradient);
        self.layer.value(&positions)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        let positions = self.positions(x);
        self.layer.hessian(&positions, exact, Some(relaxed));
    }

    fn energy_scale(&self) -> f64 {
        self.energy
    }

    fn force_scale(&self) -> f64 {
        self.energy / self.edge
    }

    fn length_scale(&self) -> f64 {
        self.edge
    }
}

/// A sheet that is free in space: its mesh and its energy, with no vertex pinned.
pub(crate) struct Free<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) layer: &'a LayerEnergy,
    /// Energy (J) that its shape is about.
    pub(crate) energy: f64,
}

impl Free<'_> {
    /// Three coordinates of one corner of the first face, two of the next and one of the last: as many as a
    /// rigid body has, of a sheet that lies in the plane z = 0.
    fn held(&self) -> [usize; 6] {
        let [a, b, c] = self.mesh.faces[0].map(|v| v as usize);
        let along = self.mesh.positions[b] - self.mesh.positions[a];
        // A turn about z moves the second corner across the edge to it.
        let across = usize::from(along.x.abs() > along.y.abs());
        [
            3 * a,
            3 * a + 1,
            3 * a + 2,
            3 * b + across,
            3 * b + 2,
            3 * c + 2,
        ]
    }

    /// The objective, and the factorisation in which the first face stays in its place.
    fn system(&self) -> (FreeSheet<'_>, Kkt) {
        let (starts, rows) = self.layer.pattern();
        let positions = &self.mesh.positions;
        let [a, b, _] = self.mesh.faces[0].map(|v| positions[v as usize]);
        let sheet = FreeSheet {
            layer: self.layer,
            pattern: LowerPattern::new(starts, rows).expect("a pattern of the layer"),
            energy: self.energy,
            edge: (a - b).norm(),
        };
        let unknowns = self.layer.dof_count();
        let columns = self.held().to_vec();
        let rows = ConstraintRows::new((0..=6).collect(), columns, vec![1.0; 6], unknowns);
        let rows = rows.expect("valid rows");
        let kkt = Kkt::new(&sheet.pattern, &rows, 3).expect("a valid system");
        (sheet, kkt)
    }

    /// Brings the sheet to rest from `x`. The first face stays in its place, held without force.
    ///
    /// It stops at a millionth of the energy: a disc that has rolled up turns its axis for a long time, for
    /// nothing that can be seen.
    pub(crate) fn settle(&self, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let (sheet, mut kkt) = self.system();
        let mut unknowns = unknowns(x);
        let targets = self.held().map(|column| unknowns[column]);
        let settings = NewtonSettings {
            residual_tolerance: 1e-9,
            max_iterations: 200,
            ..NewtonSettings::default()
        };
        let go_on = &mut |_: &Iteration| true;
        let report = minimise(&sheet, &targets, &mut unknowns, &mut kkt, &settings, go_on);
        let report = report.expect("a valid system");
        assert!(report.converged, "{report:?}");
        sheet.positions(&unknowns)
    }

    /// The motion from the equilibrium `x` that the sheet resists least, with its stiffness (N/m): negative
    /// just past the onset of buckling.
    ///
    /// The stiffness, and not the signs of the factor's pivots: those are of a matrix with a hundred-millionth of
    /// the median diagonal more on its own, which moves the onset of a thin plate by several per cent.
    pub(crate) fn softest_mode(&self, x: &[Vector3<f64>]) -> (f64, Vec<Vector3<f64>>) {
        let (sheet, mut kkt) = self.system();
        let mode = softest_mode(&sheet, &unknowns(x), &mut kkt, 1, 20).expect("a valid system");
        (mode.rayleigh_quotient, sheet.positions(&mode.mode))
    }
}

fn unknowns(x: &[Vector3<f64>]) -> Vec<f64> {
    x.iter().flatten().copied().collect()
}

/// Principal curvatures (crest-positive, the larger first) of the quadratic surface through the vertices whose
/// material point `chosen` accepts, least squares.
pub(crate) fn principal_curvatures(
    material: &[Vector3<f64>],
    x: &[Vector3<f64>],
    chosen: impl Fn(&Vector3<f64>) -> bool,
) -> [f64; 2] {
    let mut normal = SMatrix::<f64, 6, 6>::zeros();
    let mut right = SMatrix::<f64, 6, 3>::zeros();
    for (p, x) in material.iter().zip(x).filter(|(p, _)| chosen(p)) {
        let (u, v) = (p.x, p.y);
        let row = SVector::<f64, 6>::from([1.0, u, v, 0.5 * u * u, u * v, 0.5 * v * v]);
        normal += row * row.transpose();
        right += row * x.transpose();
    }
    let fit = normal.cholesky().expect("enough vertices").solve(&right);
    let of = |row: usize| fit.row(row).transpose();
    let (first, second) = (of(1), of(2));
    let up = first.cross(&second).normalize();
    let metric = Matrix2::new(
        first.dot(&first),
        first.dot(&second),
        first.dot(&second),
        second.dot(&second),
    );
    let form = Matrix2::new(
        of(3).dot(&up),
        of(4).dot(&up),
        of(4).dot(&up),
        of(5).dot(&up),
    );
    let root = metric.cholesky().expect("a surface").l();
    let inverse = root.try_inverse().expect("a surface");
    let values = SymmetricEigen::new(-(inverse * form * inverse.transpose())).eigenvalues;
    [values.max(), values.min()]
}

/// Radius of the sphere through these points, least squares.
pub(crate) fn sphere_radius(points: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let mut normal = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    for p in points {
        let row = SVector::<f64, 4>::from([p.x, p.y, p.z, 1.0]);
        normal += row * row.transpose();
        right += row * p.norm_squared();
    }
    let fit = normal.cholesky().expect("enough points").solve(&right);
    let centre = fit.xyz() * 0.5;
    (fit[3] + centre.norm_squared()).sqrt()
}
