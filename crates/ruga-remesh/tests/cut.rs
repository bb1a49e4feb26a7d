//! Marching triangles: areas, cases, borders, touching parts, and what snapping leaves.

mod cut_sheet;
mod shapes;

use cut_sheet::Sheet;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{FaceId, Id, PerVertex, TriMesh, VertexId, face_areas};
use ruga_remesh::{CutPoint, LevelCut, RemeshError, shares_left};

/// Levels of every size, some exactly zero, of which many have neighbours of the other sign.
fn random_level(mesh: &TriMesh, random: &mut Pcg64) -> PerVertex<f64> {
    let mut value = || match random.random_range(0..4) {
        0 => f64::from(random.random_range(-1..=1)),
        _ => {
            let size = 10f64.powf(random.random_range(-2.5..0.0));
            if random.random_bool(0.6) { size } else { -size }
        }
    };
    (0..mesh.vertex_count()).map(|_| value()).collect()
}

fn per_vertex(levels: &[f64]) -> PerVertex<f64> {
    levels.to_vec().into()
}

/// Faces and area that are left of a single triangle, the area relative to its own.
fn left_of_triangle(levels: [f64; 3], snap: f64) -> (usize, f64) {
    let sheet = Sheet::triangle();
    let cut = sheet.cut(&per_vertex(&levels), snap);
    (cut.mesh.face_count(), cut.area() / sheet.area())
}

#[test]
fn a_straight_line_leaves_its_side_of_the_square() {
    for seed in 0..5 {
        let sheet = Sheet::square(9, seed);
        // Left of the line from (d, 0) to (d - 0.3, 1).
        for d in [0.31, 0.5, 0.77, 1.0] {
            let level = sheet.level(|p| d - p.x - 0.3 * p.y);
            let cut = sheet.cut(&level, 0.0);
            let area = d - 0.15;
            assert!(
                (cut.area() / area - 1.0).abs() < 1e-12,
                "{} {area}",
                cut.area()
            );
            assert!((sheet.area_by_shares(&level) / area - 1.0).abs() < 1e-12);
            assert_eq!((cut.parts(), cut.loops(), cut.euler_number()), (1, 1, 1));
        }
    }
}

#[test]
fn every_case_of_a_triangle() {
    let cases = [
        // Dropped.
        ([-1.0, -1.0, -2.0], 0, 0.0),
        ([0.0, -1.0, -2.0], 0, 0.0),
        ([0.0, -1.0, 0.0], 0, 0.0),
        ([0.0, 0.0, 0.0], 0, 0.0),
        ([-0.0, 0.0, -0.0], 0, 0.0),
        // A small triangle.
        ([1.0, -1.0, -3.0], 1, 0.125),
        ([1.0, -3.0, 0.0], 1, 0.25),
        ([1.0, 0.0, -3.0], 1, 0.25),
        // A quadrilateral.
        ([1.0, 1.0, -1.0], 2, 0.75),
        ([3.0, 1.0, -1.0], 2, 0.875),
        // Whole.
        ([1.0, 2.0, 3.0], 1, 1.0),
        ([1.0, 2.0, 0.0], 1, 1.0),
        ([0.0, 5e-324, 0.0], 1, 1.0),
        // Products of these levels underflow, and their differences overflow.
        ([5e-324, -5e-324, -5e-324], 1, 0.25),
        ([f64::MAX, -f64::MAX, f64::MAX], 2, 0.75),
    ];
    for (levels, faces, area) in cases {
        for turn in 0..3 {
            let mut levels = levels;
            levels.rotate_left(turn);
            let (got_faces, got_area) = left_of_triangle(levels, 0.0);
            assert_eq!(got_faces, faces, "{levels:?}");
            assert!((got_area - area).abs() < 1e-14, "{levels:?}: {got_area}");
            let shares = shares_left(&Sheet::triangle().mesh, &per_vertex(&levels)).unwrap();
            assert!(
                (shares[FaceId(0)] - area).abs() < 1e-15,
                "{levels:?}: {shares:?}"
            );
        }
    }
}

#[test]
fn a_small_rest_has_an_exact_share() {
    let sheet = Sheet::triangle();
    let share =
        |levels: [f64; 3]| shares_left(&sheet.mesh, &per_vertex(&levels)).unwrap()[FaceId(0)];
    assert!((share([1e-20, 1e-20, -1.0]) / 2e-20 - 1.0).abs() < 1e-15);
    assert!((share([1e-20, -1.0, -1.0]) / 1e-40 - 1.0).abs() < 1e-15);
}

#[test]
fn quadrilaterals_have_the_diagonal_with_the_larger_least_area() {
    let sheet = Sheet::triangle();
    for (p, q) in [
        (0.03, 50.0),
        (50.0, 0.03),
        (0.4, 0.6),
        (1.0, 1.0),
        (9.0, 4.0),
    ] {
        for levels in [[p, q, -1.0], [q, -1.0, p], [-1.0, p, q]] {
            let cut = sheet.cut(&per_vertex(&levels), 0.0);
            let areas = face_areas(&cut.mesh, &cut.positions).into_vec();
            let least = areas[0].min(areas[1]) / sheet.area();
            // Fractions of both edges, and the smaller part with either diagonal.
            let [s, t]: [f64; 2] = [p / (p + 1.0), q / (q + 1.0)];
            let best = s.min(t * (1.0 - s)).max(t.min(s * (1.0 - t)));
            assert!((least - best).abs() < 1e-14, "{levels:?}: {least} {best}");
        }
    }
}

#[test]
fn all_or_nothing_is_left() {
    let sheet = Sheet::square(4, 1);
    let all = LevelCut::new(&sheet.mesh, &sheet.level(|_| 1e-300), 0.02).unwrap();
    assert_eq!(all.mesh.face_count(), sheet.mesh.face_count());
    assert_eq!(all.mesh.vertex_count(), sheet.mesh.vertex_count());
    for (face, corners) in all.mesh.faces().iter() {
        assert_eq!(all.parents[face], face);
        let old = corners.map(|v| all.vertices[v].ends);
        assert_eq!(old, sheet.mesh.faces()[face].map(|v| [v; 2]));
    }
    for level in [-1.0, 0.0] {
        let level = sheet.level(|_| level);
        let none = sheet.cut(&level, 0.02);
        assert_eq!((none.mesh.face_count(), none.mesh.vertex_count()), (0, 0));
        assert_eq!(sheet.area_by_shares(&level), 0.0);
    }
    let empty = TriMesh::new(0, Vec::new()).unwrap();
    let none = LevelCut::new(&empty, &per_vertex(&[]), 0.0).unwrap();
    assert_eq!(none.mesh.face_count(), 0);
}

#[test]
fn rings_and_holes_have_two_borders() {
    let sheet = Sheet::square(24, 3);
    let radius = |p: &Vector3<f64>| (p - Vector3::new(0.5, 0.5, 0.0)).norm();
    for snap in [0.0, 0.02, 0.3] {
        let ring = sheet.cut(&sheet.level(|p| 0.1 - (radius(p) - 0.3).abs()), snap);
        assert_eq!((ring.parts(), ring.loops(), ring.euler_number()), (1, 2, 0));
        let hole = sheet.cut(&sheet.level(|p| radius(p) - 0.2), snap);
        assert_eq!((hole.parts(), hole.loops(), hole.euler_number()), (1, 2, 0));
    }
}

#[test]
fn parts_that_touch_in_a_point_are_separate() {
    let fan = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    let sheet = Sheet::new(fan.to_vec(), faces);
    // Two lobes to the sides. They hang together by the centre, touch there, or stay off each other.
    for (centre, snap, parts, vertices) in [
        (0.5, 0.0, 1, 9),
        (0.01, 0.0, 1, 9),
        (0.01, 0.02, 2, 8),
        (0.0, 0.0, 2, 8),
        (-0.01, 0.02, 2, 8),
        (-0.5, 0.0, 2, 8),
    ] {
        let level = per_vertex(&[centre, 1.0, -1.0, 1.0, -1.0]);
        let cut = sheet.cut(&level, snap);
        assert_eq!((cut.parts(), cut.loops()), (parts, parts), "{centre}");
        assert_eq!(cut.mesh.vertex_count(), vertices, "{centre}");
        assert_eq!(cut.euler_number(), parts as i64);
    }
}

#[test]
fn parts_of_a_ball() {
    let ball = Sheet::ball();
    assert_eq!((ball.loops(), ball.euler_number()), (0, 2));
    for snap in [0.0, 0.02] {
        let cap = ball.cut(&ball.level(|p| p.z - 0.3), snap);
        assert_eq!((cap.parts(), cap.loops(), cap.euler_number()), (1, 1, 1));
        let belt = ball.cut(&ball.level(|p| 0.3 - p.z.abs()), snap);
        assert_eq!((belt.parts(), belt.loops(), belt.euler_number()), (1, 2, 0));
        let caps = ball.cut(&ball.level(|p| p.z.abs() - 0.3), snap);
        assert_eq!((caps.parts(), caps.loops(), caps.euler_number()), (2, 2, 2));
        // Snapping moves the border of both alike.
        let total = (belt.area() + caps.area()) / ball.area();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
    }
}

#[test]
fn random_levels_leave_manifolds() {
    let mut random = Pcg64::seed_from_u64(7);
    let mut sheets: Vec<Sheet> = (0..30).map(|seed| Sheet::square(7, seed)).collect();
    sheets.push(Sheet::ball());
    for sheet in &sheets {
        let level = random_level(&sheet.mesh, &mut random);
        for snap in [0.0, 0.02, 0.2, 0.5] {
            let cut = sheet.cut(&level, snap);
            // Every part lies in a plane or on a sphere, and is a sphere less one disc per border.
            let expected = 2 * cut.parts() as i64 - cut.loops() as i64;
            assert_eq!(cut.euler_number(), expected);
            if snap == 0.0 {
                let ratio = cut.area() / sheet.area_by_shares(&level);
                assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
            }
        }
    }
}

#[test]
fn snapping_leaves_no_slivers() {
    let mut random = Pcg64::seed_from_u64(11);
    let least = |sheet: &Sheet| {
        sheet
            .slenderness()
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    };
    let mut found = [f64::INFINITY; 2];
    for seed in 0..40 {
        let sheet = Sheet::triangular(8, seed);
        assert!(least(&sheet) > 0.52, "{}", least(&sheet));
        let level = random_level(&sheet.mesh, &mut random);
        for (found, snap) in found.iter_mut().zip([0.0, 0.02]) {
            *found = found.min(least(&sheet.cut(&level, snap)));
        }
    }
    // The exact line leaves slivers; the limit is not far below what is there.
    assert!(found[0] < 5e-3, "{found:?}");
    assert!((0.01..0.02).contains(&found[1]), "{found:?}");
}

#[test]
fn parts_are_as_slender_as_their_parents_allow() {
    let mut random = Pcg64::seed_from_u64(13);
    for seed in 0..20 {
        let sheet = Sheet::square(7, seed);
        let level = random_level(&sheet.mesh, &mut random);
        let old = sheet.slenderness();
        for snap in [0.02, 0.1, 0.3, 0.5] {
            let cut = LevelCut::new(&sheet.mesh, &level, snap).unwrap();
            let new = sheet.cut(&level, snap).slenderness();
            for ((_, parent), ratio) in cut.parents.iter().zip(new) {
                let allowed = snap * (1.0 - snap) * old[parent.index()];
                assert!(ratio > allowed * (1.0 - 1e-9), "{ratio} {allowed}");
            }
        }
    }
}

#[test]
fn snapping_moves_the_line_to_vertices() {
    // Crossings at 1 % from the only positive corner, from a negative one, and from both positive ones.
    assert_eq!(left_of_triangle([1.0, -99.0, -1.0], 0.02), (0, 0.0));
    assert_eq!(left_of_triangle([99.0, 99.0, -1.0], 0.02), (1, 1.0));
    assert_eq!(left_of_triangle([1.0, 1.0, -99.0], 0.02), (0, 0.0));
    // A crossing at exactly `snap` stays.
    assert_eq!(left_of_triangle([1.0, -3.0, 0.0], 0.25).0, 1);
    assert_eq!(left_of_triangle([1.0, -3.0, 0.0], 0.26).0, 0);
}

#[test]
fn snapping_does_not_depend_on_the_order_of_faces() {
    let mut random = Pcg64::seed_from_u64(17);
    for seed in 0..10 {
        let sheet = Sheet::square(7, seed);
        let level = random_level(&sheet.mesh, &mut random);
        let faces = sheet.mesh.faces().as_slice().iter().rev();
        let faces = faces.map(|&[a, b, c]| [c.0, a.0, b.0]).collect();
        let reversed = Sheet {
            mesh: TriMesh::new(sheet.mesh.vertex_count(), faces).unwrap(),
            positions: sheet.positions.clone(),
        };
        let [one, other] = [&sheet, &reversed].map(|sheet| sheet.cut(&level, 0.1).area());
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }
}

#[test]
fn a_face_that_is_left_stays_although_all_its_corners_are_on_the_line() {
    let sheet = Sheet::triangular(5, 2);
    let middle = FaceId::from_index(sheet.mesh.face_count() / 2);
    let mut level = sheet.level(|_| -1.0);
    for v in sheet.mesh.faces()[middle] {
        level[v] = 0.01;
    }
    let cut = LevelCut::new(&sheet.mesh, &level, 0.02).unwrap();
    assert_eq!(cut.parents.as_slice(), [middle]);
}

#[test]
fn vectors_and_numbers_are_interpolated() {
    let point = CutPoint {
        ends: [VertexId(1), VertexId(0)],
        fraction: 0.25,
    };
    assert_eq!(point.value(&[4.0, 8.0]), 7.0);
    let [a, b] = [Vector3::new(0.0, 4.0, 0.0), Vector3::new(4.0, 0.0, 8.0)];
    assert_eq!(point.value(&[a, b]), Vector3::new(3.0, 1.0, 6.0));
}

#[test]
fn bad_input_is_named() {
    let mesh = Sheet::triangle().mesh;
    let error = |level: &[f64], snap| LevelCut::new(&mesh, &per_vertex(level), snap).unwrap_err();
    let short = RemeshError::Length {
        what: "level",
        got: 2,
        expected: 3,
    };
    assert_eq!(error(&[1.0, 2.0], 0.0), short);
    assert_eq!(
        shares_left(&mesh, &per_vertex(&[1.0, 2.0])).unwrap_err(),
        short
    );
    for (value, word) in [(f64::NAN, "NaN"), (f64::NEG_INFINITY, "-inf")] {
        let text = format!("vertex 1: level = {word}; accepted: a finite number");
        let levels = [1.0, value, 0.0];
        assert_eq!(error(&levels, 0.0).to_string(), text);
        assert_eq!(
            shares_left(&mesh, &per_vertex(&levels))
                .unwrap_err()
                .to_string(),
            text
        );
    }
    for snap in [-0.01, 0.51, f64::NAN] {
        let text = format!("snap = {snap}; accepted: 0 to 0.5");
        assert_eq!(error(&[1.0; 3], snap).to_string(), text);
    }
}
