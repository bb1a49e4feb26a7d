//! What a user of the crate brings along: a metric as a function, texture coordinates, a mesh to be
//! made smooth.

mod shapes;

use nalgebra::{Matrix3, Vector2, Vector3};
use ruga_mesh::{MaterialPoint, PerFace, PerVertex};
use ruga_remesh::{
    RemeshError, RemeshSettings, SizeLimits, Sizing, SmoothSurface, Surface, SurfaceMesh, remesh,
    remesh_to_metric,
};
use shapes::{Shape, Sheet, grid, square_from_address};

/// 10 mm on the line x = 1/2 of a square of 1 m, growing by 0.3 per distance.
fn fine_in_the_middle(_: MaterialPoint, p: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() / wanted(p).powi(2)
}

fn wanted(p: Vector3<f64>) -> f64 {
    0.01 + 0.3 * (p.x - 0.5).abs()
}

/// Mean over edges of the difference between length and wish, relative to the wish.
fn misfit(mesh: &SurfaceMesh) -> f64 {
    let edges = mesh.mesh.edges().as_slice();
    let off = edges.iter().map(|edge| {
        let [a, b] = edge.vertices.map(|v| mesh.positions[v]);
        ((a - b).norm() / wanted((a + b) / 2.0) - 1.0).abs()
    });
    off.sum::<f64>() / edges.len() as f64
}

#[test]
fn a_metric_is_asked_where_the_old_mesh_has_no_vertex() {
    // The old vertices lie on the borders x = 0 and x = 1 and know nothing of the middle.
    let old = grid(Shape::Flat, 1, 0.0, 1);
    let surface = Sheet(Shape::Flat);
    let settings = RemeshSettings {
        limits: SizeLimits {
            max_edge: 0.2,
            ..SizeLimits::default()
        },
        ..RemeshSettings::default()
    };
    let asked = remesh_to_metric(&old, &fine_in_the_middle, &surface, &settings).expect("valid");
    assert!(asked.report.converged, "{:?}", asked.report);
    let told = Sizing::from_metric(&old, &fine_in_the_middle);
    let told = remesh(&old, &told, &surface, &settings).expect("valid");
    let (asked, told) = (misfit(&asked.mesh), misfit(&told.mesh));
    assert!(asked < 0.25 && told > 0.6, "{asked} {told}");
}

#[test]
fn a_metric_without_tensor_is_refused_at_an_old_vertex_and_bridged_at_a_new_one() {
    let old = grid(Shape::Flat, 4, 0.0, 1);
    let surface = Sheet(Shape::Flat);
    let settings = RemeshSettings::default();
    let nowhere = |_: MaterialPoint, _: Vector3<f64>| Matrix3::from_element(f64::NAN);
    let refused = remesh_to_metric(&old, &nowhere, &surface, &settings);
    assert!(matches!(refused, Err(RemeshError::Tensor { .. })));
    let is_old = |p: Vector3<f64>| (4.0 * p).map(|c| c - c.round()).amax() < 1e-9;
    let at_old = |_: MaterialPoint, p: Vector3<f64>| match is_old(p) {
        true => Matrix3::identity() / 0.05f64.powi(2),
        false => Matrix3::from_element(f64::NAN),
    };
    let bridged = remesh_to_metric(&old, &at_old, &surface, &settings).expect("valid");
    assert!(bridged.report.share_met() > 0.95, "{:?}", bridged.report);
}

/// Texture coordinates of a sheet: the square, and ten more to the right of a seam.
fn texture(mesh: &SurfaceMesh) -> PerFace<[Vector2<f64>; 3]> {
    let faces = mesh.mesh.faces().as_slice().iter();
    let corners = faces.map(|face| {
        let places = face.map(|v| Vector2::from(square_from_address(mesh.points[v])));
        let middle = places.iter().sum::<Vector2<f64>>() / 3.0;
        let island = Vector2::new(if middle.x > 0.5 { 10.0 } else { 0.0 }, 0.0);
        places.map(|place| place + island)
    });
    corners.collect()
}

#[test]
fn texture_coordinates_stay_on_their_side_of_a_seam() {
    for (shape, tolerance) in [(Shape::Flat, 1e-9), (Shape::Cylinder, 2e-3)] {
        let mut mesh = grid(shape, 16, 0.0, 1);
        for (edge, ends) in mesh.mesh.edges().iter() {
            let mut ends = ends
                .vertices
                .iter()
                .map(|&v| square_from_address(mesh.points[v]));
            mesh.features[edge] |= ends.all(|[u, _]| u == 0.5);
        }
        for edge in [0.02, 0.15] {
            let sizing = Sizing::uniform(mesh.mesh.vertex_count(), edge).expect("a length");
            let made = remesh(&mesh, &sizing, &Sheet(shape), &RemeshSettings::default());
            let made = made.expect("valid");
            let found = made
                .transfer
                .corner_values(&mesh, &made.mesh, &texture(&mesh));
            let exact = texture(&made.mesh);
            for (found, exact) in found.as_slice().iter().zip(exact.as_slice()) {
                for (found, exact) in found.iter().zip(exact) {
                    assert!((found - exact).norm() < tolerance, "{found} {exact}");
                }
            }
        }
    }
}

/// An icosahedron of radius one.
fn icosahedron() -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [
        (1.0, golden),
        (-1.0, golden),
        (1.0, -golden),
        (-1.0, -golden),
    ] {
        points.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]].map(Vector3::from));
    }
    let near = |i: usize, j: usize| (points[i] - points[j]).norm() < 2.1;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let volume = points[i].cross(&points[j]).dot(&points[k]);
                    let (j, k) = if volume > 0.0 { (j, k) } else { (k, j) };
                    faces.push([i, j, k].map(|v| v as u32));
                }
            }
        }
    }
    (points.iter().map(|p| p.normalize()).collect(), faces)
}

#[test]
fn a_mesh_made_smooth_can_be_remeshed_and_keeps_its_shape() {
    let (points, faces) = icosahedron();
    let ball = SmoothSurface::new(&points, &faces).expect("a closed mesh");
    let old = ball.vertex_mesh().expect("every vertex has faces");
    let sizing = Sizing::uniform(12, 0.1).expect("a length");
    let made = remesh(&old, &sizing, &ball, &RemeshSettings::default()).expect("valid");
    assert!(made.report.converged, "{:?}", made.report);
    let radii = made.mesh.positions.as_slice().iter().map(Vector3::norm);
    let (low, high) = radii.fold((f64::MAX, 0.0f64), |(l, h), r| (l.min(r), h.max(r)));
    // The limit surface of an icosahedron is round to 3 %.
    assert!(high / low < 1.05, "{low} {high}");
}

#[test]
fn the_closest_place_of_a_smooth_surface_has_its_normal_towards_the_target() {
    let (points, faces) = icosahedron();
    let ball = SmoothSurface::new(&points, &faces).expect("a closed mesh");
    let start = ball
        .vertex_mesh()
        .expect("every vertex has faces")
        .points
        .as_slice()[0];
    let mut seed = 1.0f64;
    for _ in 0..50 {
        let mut next = || {
            seed = (seed * 997.0).sin() * 43_758.5;
            seed.fract()
        };
        let direction = Vector3::new(next(), next(), next()).normalize();
        let place = ball.closest(start, 1.2 * direction);
        let off = 1.2 * direction - ball.position(place);
        let sine = off.normalize().cross(&ball.normal(place)).norm();
        assert!(sine < 1e-3, "{direction} {sine}");
    }
}

#[test]
fn the_border_of_a_smooth_surface_stays_the_border() {
    let old = grid(Shape::Cylinder, 4, 0.0, 1);
    let faces: Vec<[u32; 3]> = old
        .mesh
        .faces()
        .as_slice()
        .iter()
        .map(|f| f.map(|v| v.0))
        .collect();
    let surface = SmoothSurface::new(old.positions.as_slice(), &faces).expect("a mesh");
    let control = surface.vertex_mesh().expect("every vertex has faces");
    let sizing = Sizing::uniform(control.mesh.vertex_count(), 0.05).expect("a length");
    let made = remesh(&control, &sizing, &surface, &RemeshSettings::default()).expect("valid");
    assert!(made.report.converged, "{:?}", made.report);
    let border: PerVertex<bool> = made.mesh.mesh.border_vertices();
    for (vertex, _) in border.iter().filter(|(_, is_border)| **is_border) {
        let place = made.mesh.points[vertex];
        let corners = surface.mesh().faces()[place.face];
        let weights = corners
            .into_iter()
            .zip(place.barycentric)
            .filter(|(_, w)| *w > 1e-9);
        let outer = surface.mesh().border_vertices();
        assert!(weights.clone().all(|(v, _)| outer[v]), "{place:?}");
    }
}
