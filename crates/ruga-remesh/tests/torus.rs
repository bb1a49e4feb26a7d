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

/// A torus of radii `size` and three tenths of it.
fn torus(size: f64) -> (TriMesh, Vec<Vector3<f64>>) {
    let [around, across] = CELLS;
    let corner = |i: u32, j: u32| (i % around) * across + j % across;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            let (s, c) = (TAU * f64::from(i) / f64::from(around)).sin_cos();
            let (t, r) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
            let radius = 1.0 + 0.3 * r;
            positions.push(Vector3::new(radius * c, radius * s, 0.3 * t) * size);
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
    // Winding about the tube, so that it turns from face to face.
    let tensors: PerVertex<_> = mesh
        .positions
        .iter()
        .map(|(v, p)| {
            let normal = normals[v.index()];
            let around = Vector3::new(-p.y, p.x, 0.0).normalize();
            let direction = around + around.cross(&normal);
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

/// Some edges between faces at an angle used to be flipped to and fro until the rounds were over.
#[test]
fn a_torus_refined_much_three_to_one_converges_in_both_calls() {
    let made = follow(1.0, 0.0131, 3.0);
    let faces = made[0].mesh.mesh.face_count();
    assert!((38_000..48_000).contains(&faces), "{faces} faces");
    for report in made.map(|made| made.report) {
        assert!(report.converged, "{report:?}");
        assert!(report.metric_lengths[0] > 0.4, "{report:?}");
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
