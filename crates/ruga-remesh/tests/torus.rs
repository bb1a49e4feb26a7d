//! A torus of 160 faces, in any unit and refined much: what it was asked for comes out.

mod shapes;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_mesh::{Id, PerEdge, PerVertex, TriMesh, vertex_normals};
use ruga_remesh::{
    PolyhedralSurface, RemeshSettings, Remeshed, SizeLimits, Sizing, SurfaceMesh, remesh,
    size_tensor,
};

/// Cells around the torus and around its tube.
const CELLS: [u32; 2] = [16, 5];

/// A torus of radii `size` and a quarter of it.
fn torus(size: f64) -> (TriMesh, Vec<Vector3<f64>>) {
    let [around, across] = CELLS;
    let corner = |i: u32, j: u32| (i % around) * across + j % across;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            let (s, c) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
            let (t, r) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
            let radius = 1.0 + 0.25 * r;
            positions.push(Vector3::new(radius * c, radius * s, 0.25 * t) * size);
            let [a, b] = [corner(i, j), corner(i + 1, j)];
            let [d, e] = [corner(i + 1, j + 1), corner(i, j + 1)];
            faces.extend([[a, b, d], [a, d, e]]);
        }
    }
    let mesh = TriMesh::new(positions.len(), faces).expect("a torus is a mesh");
    (mesh, positions)
}

fn follow(size: f64, edge: f64, aspect: f64) -> [Remeshed; 2] {
    let (base, positions) = torus(size);
    let seams = PerEdge::filled(base.edges().len(), false);
    let surface = PolyhedralSurface::new(&base, &positions, &seams).expect("arrays fit");
    let points = surface.vertex_points().expect("no loose vertex");
    let mesh = SurfaceMesh::on_surface(base.clone(), points, &surface).expect("arrays fit");
    let normals = vertex_normals(&base, &positions);
    // The direction turns from face to face, and is any where the axis is normal to the torus.
    let tensors: PerVertex<_> = mesh
        .positions
        .iter()
        .map(|(v, p)| {
            let normal = normals[v.index()];
            let around = Vector3::new(-p.y, p.x, 0.0).normalize();
            let is_tangent = normal.cross(&Vector3::x()).norm() > 1e-6;
            let direction = if is_tangent { Vector3::x() } else { around };
            size_tensor(normal, direction, edge, aspect * edge).expect("a tangent direction")
        })
        .collect();
    let limits = SizeLimits {
        aspect,
        ..SizeLimits::default()
    };
    let settings = RemeshSettings {
        limits,
        ..RemeshSettings::default()
    };
    let first = remesh(&mesh, &Sizing { tensors }, &surface, &settings).expect("valid input");
    let again = remesh(&first.mesh, &first.sizing, &surface, &settings).expect("valid input");
    [first, again]
}

/// Edges that the surface had no place for when they were to be split used to stay too long until
/// the next call, and edges between faces at an angle were flipped to and fro.
#[test]
fn a_torus_refined_much_three_to_one_converges_in_both_calls() {
    let made = follow(1.0, 0.012668, 3.0);
    let faces = made[0].mesh.mesh.face_count();
    assert!((38_000..48_000).contains(&faces), "{faces} faces");
    for report in made.map(|made| made.report) {
        assert!(report.converged, "{report:?}");
        assert!(report.metric_lengths[0] > 0.3, "{report:?}");
        assert!(report.share_met() > 0.999, "{report:?}");
    }
}

/// A default bound of one metre used to make thirteen times as many faces of coordinates in
/// millimetres as the sizing asks for.
#[test]
fn coordinates_in_another_unit_give_the_same_mesh() {
    let counts = [1e-3, 1.0, 1e3, 1e6].map(|size| {
        let [made, _] = follow(size, 0.1 * size, 1.0);
        assert!(made.report.converged, "{:?}", made.report);
        made.mesh.mesh.face_count() as f64
    });
    // Rounding decides about a few edges.
    let is_close = |count: &f64| (count / counts[1] - 1.0).abs() < 0.02;
    assert!(counts.iter().all(is_close), "{counts:?}");
}
