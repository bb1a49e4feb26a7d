//! What holds after remeshing to any smooth metric, on flat and curved sheets.

mod shapes;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use ruga_mesh::{Id, TriMesh, VertexId};
use ruga_remesh::{RemeshSettings, Remeshed, SizeLimits, SurfaceMesh, remesh};
use shapes::{Shape, Sheet, Waves, grid, square_from_address};

fn area(mesh: &SurfaceMesh) -> f64 {
    let normals = ruga_mesh::face_normals(&mesh.mesh, mesh.positions.as_slice());
    normals.iter().map(|(_, n)| n.norm() / 2.0).sum()
}

fn perimeter(mesh: &SurfaceMesh) -> f64 {
    let border = mesh
        .mesh
        .edges()
        .as_slice()
        .iter()
        .filter(|e| e.is_border());
    border
        .map(|e| (mesh.positions[e.vertices[0]] - mesh.positions[e.vertices[1]]).norm())
        .sum()
}

/// One fan at every vertex and the topology of a disc.
fn is_disc(mesh: &TriMesh) -> bool {
    let vertices = (0..mesh.vertex_count()).map(VertexId::from_index);
    let euler = mesh.vertex_count() + mesh.face_count() - mesh.edges().len();
    euler == 1 && vertices.into_iter().all(|v| mesh.ring(v).is_some())
}

/// Smallest cosine between a face's normal and the surface's normal at its corners.
fn worst_uprightness(mesh: &SurfaceMesh, shape: Shape) -> f64 {
    let normals = ruga_mesh::face_normals(&mesh.mesh, mesh.positions.as_slice());
    let mut worst = 1.0f64;
    for (face, corners) in mesh.mesh.faces().iter() {
        for &v in corners {
            let smooth = shape.normal(square_from_address(mesh.points[v]));
            worst = worst.min(normals[face].normalize().dot(&smooth));
        }
    }
    worst
}

fn check(shape: Shape, after: &Remeshed) -> Result<(), TestCaseError> {
    let mesh = &after.mesh;
    prop_assert!(after.report.converged);
    prop_assert!(after.report.share_met() >= 0.95, "{:?}", after.report);
    prop_assert!(is_disc(&mesh.mesh));
    prop_assert!(worst_uprightness(mesh, shape) > 0.5);
    for (v, &p) in mesh.positions.iter() {
        let place = square_from_address(mesh.points[v]);
        prop_assert!((shape.point(place) - p).norm() < 1e-12, "on the surface");
    }
    // Chords of a surface of curvature one are short of it by about the square of an edge over
    // 8, and edges reach 0.35 here; the flat square has nothing to miss.
    let tolerance = if matches!(shape, Shape::Flat) {
        1e-12
    } else {
        0.025
    };
    prop_assert!((area(mesh) / shape.area() - 1.0).abs() < tolerance);
    prop_assert!((perimeter(mesh) / shape.perimeter() - 1.0).abs() < tolerance);
    Ok(())
}

/// Values are carried by convex combinations, and where a linear field on a flat sheet allows it,
/// exactly.
fn check_transfer(
    shape: Shape,
    before: &SurfaceMesh,
    after: &Remeshed,
) -> Result<(), TestCaseError> {
    let rows = &after.transfer.rows;
    for (v, survivor) in after.transfer.survivors.iter() {
        let row: Vec<(u32, f64)> = rows.row(v.index()).collect();
        let sum: f64 = row.iter().map(|term| term.1).sum();
        prop_assert!((sum - 1.0).abs() < 1e-12 && row.iter().all(|term| term.1 > 0.0));
        if let Some(old) = survivor {
            prop_assert!(row == [(old.0, 1.0)]);
            prop_assert!(after.mesh.positions[v] == before.positions[*old]);
        }
    }
    if matches!(shape, Shape::Flat) {
        let carried = after.transfer.rows.apply(before.positions.as_slice());
        for (p, q) in carried.iter().zip(after.mesh.positions.as_slice()) {
            prop_assert!((p - q).norm() < 1e-9, "linear fields are carried exactly");
        }
    }
    Ok(())
}

/// One remesh of a jittered grid to a random metric.
#[derive(Clone, Copy, Debug)]
struct Case {
    shape: Shape,
    cells: usize,
    edge: f64,
    range: f64,
    aspect: f64,
    seed: u64,
}

fn is_sound_and_follows_the_metric(case: Case) -> Result<(), TestCaseError> {
    let Case {
        shape,
        cells,
        edge,
        range,
        aspect,
        seed,
    } = case;
    let before = grid(shape, cells, 0.25, seed);
    let waves = Waves {
        edge,
        range,
        aspect,
        seed,
    };
    let sizing = waves.sizing(&before);
    let settings = RemeshSettings::default();
    let after = remesh(&before, &sizing, &Sheet(shape), &settings).expect("valid input");
    check(shape, &after)?;
    check_transfer(shape, &before, &after)?;

    let same = remesh(&before, &sizing, &Sheet(shape), &settings).expect("valid input");
    prop_assert!(same.mesh.positions == after.mesh.positions);
    prop_assert!(same.mesh.mesh.faces() == after.mesh.mesh.faces());

    // The sizing that comes back is graded on the coarse mesh; graded once more on the fine
    // one it would be another sizing.
    let limits = SizeLimits {
        grading: f64::INFINITY,
        ..settings.limits
    };
    let settings = RemeshSettings { limits, ..settings };
    let again = remesh(&after.mesh, &after.sizing, &Sheet(shape), &settings).expect("valid");
    prop_assert!(again.transfer.is_identity(after.mesh.mesh.vertex_count()));
    prop_assert!(again.mesh.mesh.faces() == after.mesh.mesh.faces());
    prop_assert!(again.report.converged);
    Ok(())
}

/// Every case that the property below has ever failed on.
///
/// On the flat sheet splits and flips went in circles between needles that shrank to nothing. On the
/// spheres, coarsened much, 6 to 11 % of the edges stayed under half the wanted length,
/// the shortest at 0.07 to 0.13 of it, in clusters in which no collapse left a good shape; on the last,
/// coarsened a little, 2.3 % did, between vertices of the old mesh.
#[test]
fn cases_that_once_failed_follow_the_metric() {
    let sphere = |cells, edge, range, aspect, seed| Case {
        shape: Shape::Sphere,
        cells,
        edge,
        range,
        aspect,
        seed,
    };
    let flat = Case {
        shape: Shape::Flat,
        cells: 3,
        edge: 0.03,
        range: 3.2812453164548154,
        aspect: 1.8142964819652656,
        seed: 608729,
    };
    for case in [
        flat,
        sphere(
            58,
            0.07797596589359206,
            3.402282927481509,
            1.342696027289554,
            716452,
        ),
        sphere(
            46,
            0.07713655721402246,
            3.734453306936679,
            1.7555517589881202,
            32773,
        ),
        sphere(
            59,
            0.07895328870695106,
            3.47417654593253,
            1.1215683378366725,
            566096,
        ),
        sphere(17, 0.07409213170053, 1.0, 1.9727667250021867, 234514),
    ] {
        is_sound_and_follows_the_metric(case).expect("the property holds");
    }
}

/// Cargo's settings fix the seed, so that a test that fails fails again; `cargo xtask fuzz
/// properties` sets others.
#[test]
fn the_test_command_draws_the_same_cases_in_every_run() {
    let seed = ProptestConfig::default().rng_seed;
    assert!(matches!(seed, RngSeed::Fixed(_)), "run the tests by cargo");
}

fn shapes() -> impl Strategy<Value = Shape> {
    prop_oneof![
        Just(Shape::Flat),
        Just(Shape::Cylinder),
        Just(Shape::Sphere)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_remesh_is_sound_and_follows_the_metric(
        shape in shapes(),
        cells in 3usize..60,
        edge in 0.03f64..0.08,
        range in 1.0f64..4.0,
        aspect in 1.0f64..2.0,
        seed in 0u64..1_000_000,
    ) {
        is_sound_and_follows_the_metric(Case { shape, cells, edge, range, aspect, seed })?;
    }

    #[test]
    fn many_remeshes_to_changing_metrics_stay_sound(shape in shapes(), seed in 0u64..1_000_000) {
        let mut mesh = grid(shape, 12, 0.25, seed);
        for round in 0..8u64 {
            let waves = Waves { edge: 0.05, range: 3.0, aspect: 2.0, seed: seed + round };
            let settings = RemeshSettings::default();
            let sizing = waves.sizing(&mesh);
            let after = remesh(&mesh, &sizing, &Sheet(shape), &settings).expect("valid input");
            check(shape, &after)?;
            mesh = after.mesh;
        }
    }
}
