//! Every refusal, with the value that caused it.

mod shapes;

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{FaceId, MaterialPoint, PerEdge, PerFace, PerVertex, TriMesh, VertexId};
use ruga_remesh::{
    FaceDriver, PolyhedralSurface, Refinement, RemeshError, RemeshSettings, SizeLimits, Sizing,
    SizingInput, Surface, SurfaceMesh, remesh, size_tensor, sizing_field,
};
use shapes::{Shape, Sheet, grid};

fn uniform(vertices: usize, edge: f64) -> Sizing {
    Sizing::uniform(vertices, edge).expect("a positive length")
}

fn refused(change: impl Fn(&mut SurfaceMesh, &mut Sizing, &mut RemeshSettings)) -> RemeshError {
    let mut mesh = grid(Shape::Flat, 3, 0.0, 1);
    let mut sizing = uniform(mesh.mesh.vertex_count(), 0.2);
    let mut settings = RemeshSettings::default();
    change(&mut mesh, &mut sizing, &mut settings);
    remesh(&mesh, &sizing, &Sheet(Shape::Flat), &settings).expect_err("must be refused")
}

fn with_limits(limits: SizeLimits) -> RemeshError {
    refused(|_, _, settings| settings.limits = limits)
}

#[test]
fn settings_out_of_range_are_named() {
    let good = SizeLimits::default();
    let named = |error: RemeshError| match error {
        RemeshError::Setting { name, .. } => name,
        other => panic!("{other}"),
    };
    assert_eq!(
        named(with_limits(SizeLimits {
            min_edge: -1.0,
            ..good
        })),
        "min_edge"
    );
    assert_eq!(
        named(with_limits(SizeLimits {
            min_edge: f64::NAN,
            ..good
        })),
        "min_edge"
    );
    assert_eq!(
        named(with_limits(SizeLimits {
            max_edge: 0.0,
            ..good
        })),
        "max_edge"
    );
    assert_eq!(
        named(with_limits(SizeLimits {
            max_edge: f64::NAN,
            ..good
        })),
        "max_edge"
    );
    assert_eq!(
        named(with_limits(SizeLimits {
            aspect: 0.9,
            ..good
        })),
        "aspect"
    );
    assert_eq!(
        named(with_limits(SizeLimits {
            grading: 0.0,
            ..good
        })),
        "grading"
    );
    assert_eq!(
        named(refused(|_, _, s| s.corner_angle = 2.0)),
        "corner_angle"
    );
}

#[test]
fn an_empty_edge_range_is_contradictory() {
    let error = with_limits(SizeLimits {
        min_edge: 0.3,
        max_edge: 0.2,
        ..SizeLimits::default()
    });
    assert_eq!(
        error.to_string(),
        "min_edge = 0.3 m is longer than max_edge = 0.2 m"
    );
}

#[test]
fn arrays_that_do_not_fit_are_named() {
    let short = refused(|_, sizing, _| *sizing = uniform(3, 0.2));
    assert_eq!(
        short,
        RemeshError::Length {
            what: "sizing",
            got: 3,
            expected: 16
        }
    );
    let short = refused(|mesh, _, _| mesh.fixed = PerVertex::filled(1, false));
    assert_eq!(
        short,
        RemeshError::Length {
            what: "fixed",
            got: 1,
            expected: 16
        }
    );
}

#[test]
fn bad_numbers_name_their_vertex() {
    let error = refused(|mesh, _, _| mesh.positions[VertexId(5)].y = f64::NAN);
    assert_eq!(
        error,
        RemeshError::Position {
            vertex: VertexId(5)
        }
    );
    for bad in [
        Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 0.0)),
        Matrix3::new(1.0, 2.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0),
        Matrix3::from_element(f64::INFINITY),
    ] {
        let error = refused(|_, sizing, _| sizing.tensors[VertexId(7)] = bad);
        assert_eq!(
            error,
            RemeshError::Tensor {
                vertex: VertexId(7)
            }
        );
    }
}

#[test]
fn lengths_that_are_not_positive_are_refused() {
    for bad in [-0.3, 0.0, f64::NAN, f64::INFINITY, 1e-200] {
        let error = Sizing::uniform(3, bad).expect_err("must be refused");
        assert!(error.to_string().starts_with("edge = "), "{error}");
        for (lengths, name) in [([bad, 1.0], "across = "), ([1.0, bad], "along = ")] {
            let error = size_tensor(Vector3::z(), Vector3::x(), lengths[0], lengths[1]);
            let error = error.expect_err("must be refused").to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}

#[test]
fn a_direction_without_a_tangent_part_is_refused() {
    let normal = Vector3::new(0.0, 0.6, 0.8);
    let nan = Vector3::repeat(f64::NAN);
    for direction in [normal, -normal * 1e-3, normal * 1e9, Vector3::zeros(), nan] {
        let error = size_tensor(normal, direction, 0.1, 0.2).expect_err("must be refused");
        assert!(matches!(error, RemeshError::Direction { .. }), "{error}");
    }
    assert!(size_tensor(nan, Vector3::x(), 0.1, 0.2).is_err());
    let leaning = normal * 5.0 + Vector3::x();
    let tensor = size_tensor(normal * 7.0, leaning, 0.1, 0.2).expect("it has a tangent part");
    assert!((tensor.m11 - 100.0).abs() < 1e-9, "{tensor}");
}

/// A place is interpolated from three corners, so that the bad one used to be blamed on the first.
#[test]
fn a_surface_names_the_vertex_that_is_not_finite() {
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).expect("one face");
    let seams = PerEdge::filled(3, false);
    let positions = [Vector3::zeros(), Vector3::x(), Vector3::repeat(f64::NAN)];
    let error = PolyhedralSurface::new(&mesh, &positions, &seams).err();
    let vertex = VertexId(2);
    assert_eq!(error, Some(RemeshError::Position { vertex }));
}

#[test]
fn places_that_a_surface_does_not_have_are_refused() {
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).expect("one face");
    let seams = PerEdge::filled(3, false);
    let positions = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let surface = PolyhedralSurface::new(&mesh, &positions, &seams).expect("it fits");
    let points = surface.vertex_points().expect("every vertex has a face");
    let good = SurfaceMesh::on_surface(mesh.clone(), points.clone(), &surface).expect("it fits");
    for (face, barycentric) in [
        (1, [1.0, 0.0, 0.0]),
        (0, [1.0, 1.0, 0.0]),
        (0, [f64::NAN; 3]),
    ] {
        let face = FaceId(face);
        let point = MaterialPoint { face, barycentric };
        assert!(!surface.contains(point));
        let mut points = points.clone();
        points[VertexId(1)] = point;
        let made = SurfaceMesh::on_surface(mesh.clone(), points.clone(), &surface);
        let is_named = |error: Option<RemeshError>| {
            matches!(
                error,
                Some(RemeshError::Point {
                    vertex: VertexId(1),
                    ..
                })
            )
        };
        assert!(is_named(made.err()));
        let bad = SurfaceMesh {
            points,
            ..good.clone()
        };
        let made = remesh(&bad, &uniform(3, 0.1), &surface, &RemeshSettings::default());
        assert!(is_named(made.err()));
    }
}

#[test]
fn an_absurd_sizing_is_refused_before_it_fills_memory() {
    let error = refused(|mesh, sizing, _| *sizing = uniform(mesh.mesh.vertex_count(), 1e-6));
    assert!(
        matches!(
            error,
            RemeshError::TooManyVertices {
                limit: 2_000_000,
                ..
            }
        ),
        "{error}"
    );
}

/// Vertex normals of a crumpled sheet lie across its faces, so that these seem to have no area in
/// the metric, until splits turn the normals.
#[test]
fn a_crumpled_surface_does_not_fill_memory() {
    const MOST: usize = 100;
    let mut random = Pcg64::seed_from_u64(3);
    let flat = grid(Shape::Flat, 3, 0.0, 1);
    let seams = PerEdge::filled(flat.mesh.edges().len(), false);
    let settings = RemeshSettings {
        limits: SizeLimits {
            max_edge: 10.0,
            ..SizeLimits::default()
        },
        max_vertices: MOST,
        ..RemeshSettings::default()
    };
    let mut stopped = 0;
    for _ in 0..40 {
        let mut crumpled = || Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
        let positions: Vec<Vector3<f64>> =
            (0..flat.mesh.vertex_count()).map(|_| crumpled()).collect();
        let surface = PolyhedralSurface::new(&flat.mesh, &positions, &seams).expect("it fits");
        let points = surface.vertex_points().expect("every vertex has a face");
        let mesh = SurfaceMesh::on_surface(flat.mesh.clone(), points, &surface).expect("it fits");
        let sizing = uniform(mesh.mesh.vertex_count(), 0.3);
        let Ok(made) = remesh(&mesh, &sizing, &surface, &settings) else {
            continue;
        };
        let vertices = made.mesh.mesh.vertex_count();
        assert!(
            vertices <= 2 * MOST + mesh.mesh.vertex_count(),
            "{vertices}"
        );
        stopped += usize::from(made.report.splits == 2 * MOST && !made.report.converged);
    }
    assert!(stopped > 0);
}

#[test]
fn two_fans_at_a_vertex_and_loose_vertices_are_refused() {
    for (count, faces) in [(5, vec![[0, 1, 2], [0, 3, 4]]), (4, vec![[0, 1, 2]])] {
        let mesh = TriMesh::new(count, faces).expect("a mesh");
        let point = MaterialPoint::at_corner(FaceId(0), 0);
        let points = PerVertex::filled(count, point);
        let mesh = SurfaceMesh::on_surface(mesh, points, &Sheet(Shape::Flat)).expect("fits");
        let sizing = uniform(count, 0.1);
        let error = remesh(
            &mesh,
            &sizing,
            &Sheet(Shape::Flat),
            &RemeshSettings::default(),
        );
        let vertex = VertexId(if count == 5 { 0 } else { 3 });
        assert_eq!(error.err(), Some(RemeshError::NonManifoldVertex { vertex }));
    }
}

#[test]
fn a_mesh_without_faces_is_left_alone() {
    let mesh = TriMesh::new(0, Vec::new()).expect("an empty mesh");
    let mesh = SurfaceMesh::on_surface(
        mesh,
        PerVertex::filled(0, MaterialPoint::at_corner(FaceId(0), 0)),
        &Sheet(Shape::Flat),
    )
    .expect("fits");
    let result = remesh(
        &mesh,
        &uniform(0, 0.1),
        &Sheet(Shape::Flat),
        &RemeshSettings::default(),
    );
    assert_eq!(result.expect("nothing to do").mesh.mesh.face_count(), 0);
}

#[test]
fn bad_drivers_and_refinements_are_named() {
    let mesh = grid(Shape::Flat, 2, 0.0, 1);
    let good = FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: 0.1,
        critical_strain: 0.1,
        poisson: 0.48,
    };
    let refused = |bad: FaceDriver, refinement: Refinement| {
        let mut driver = PerFace::filled(mesh.mesh.face_count(), good);
        driver[FaceId(3)] = bad;
        let input = SizingInput {
            mesh: &mesh,
            shape: mesh.positions.as_slice(),
            driver: Some(&driver),
            refinement,
        };
        sizing_field(&input)
            .expect_err("must be refused")
            .to_string()
    };
    let fine = Refinement::default();
    let error = refused(
        FaceDriver {
            wavelength: 0.0,
            ..good
        },
        fine,
    );
    assert_eq!(error, "face 3: wavelength = 0; accepted: positive, finite");
    let error = refused(
        FaceDriver {
            critical_strain: f64::NAN,
            ..good
        },
        fine,
    );
    assert!(error.starts_with("face 3: critical_strain"), "{error}");
    let error = refused(
        FaceDriver {
            poisson: 0.6,
            ..good
        },
        fine,
    );
    assert!(error.starts_with("face 3: poisson"), "{error}");
    let error = refused(
        good,
        Refinement {
            onset: [0.8, 0.6],
            ..fine
        },
    );
    assert!(error.starts_with("onset[1]"), "{error}");
    let error = refused(good, Refinement { angle: 0.0, ..fine });
    assert!(error.starts_with("angle"), "{error}");
}
