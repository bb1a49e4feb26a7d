//! The closest place on a surface: against an exhaustive search, on the right sheet, never NaN.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{FaceId, Id, MaterialPoint, SurfaceLookup, TriMesh};

/// A grid of `n` by `n` cells over the unit square, placed by `place`.
fn sheet(n: u32, place: impl Fn(f64, f64) -> Vector3<f64>) -> (TriMesh, Vec<Vector3<f64>>) {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            positions.push(place(
                f64::from(i) / f64::from(n),
                f64::from(j) / f64::from(n),
            ));
            if i < n && j < n {
                let a = j * (n + 1) + i;
                let b = a + n + 1;
                faces.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
            }
        }
    }
    let mesh = TriMesh::new(positions.len(), faces).expect("a grid");
    (mesh, positions)
}

fn bumpy(s: f64, t: f64) -> Vector3<f64> {
    Vector3::new(s, t, 0.15 * (7.0 * s).sin() * (5.0 * t).cos())
}

fn random(rng: &mut Pcg64Mcg) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-0.3..1.3))
}

/// Distance from a triangle by projecting on finer and finer samples of it.
fn sampled_distance(corners: [Vector3<f64>; 3], target: &Vector3<f64>) -> f64 {
    let at = |u: f64, v: f64| {
        let point = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
        (point - target).norm()
    };
    let (mut best, mut centre, mut step) = (f64::INFINITY, [0.3, 0.3], 0.1);
    for _ in 0..40 {
        let from = centre;
        for i in -6..=6 {
            for j in -6..=6 {
                let u = (from[0] + step * f64::from(i)).clamp(0.0, 1.0);
                let v = (from[1] + step * f64::from(j)).clamp(0.0, 1.0 - u);
                if at(u, v) < best {
                    (best, centre) = (at(u, v), [u, v]);
                }
            }
        }
        step *= 0.6;
    }
    best
}

/// What is right by definition: the best of all faces, from a lookup that cannot leave one.
fn exhaustive(mesh: &TriMesh, positions: &[Vector3<f64>], target: &Vector3<f64>) -> (f64, FaceId) {
    let lookup = SurfaceLookup::new(mesh, positions);
    let single = |f| lookup.closest_near(f, target, -1.0).expect("finite");
    let distances = mesh.faces().ids().map(|f| (single(f).distance, f));
    distances.fold((f64::INFINITY, FaceId(0)), |a, b| if b < a { b } else { a })
}

#[test]
fn one_triangle_agrees_with_sampling() {
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).expect("a triangle");
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for i in 0..300 {
        let mut corners = [(); 3].map(|()| random(&mut rng));
        // Every third triangle is a sliver.
        if i % 3 == 0 {
            corners[2] = corners[0].lerp(&corners[1], 0.7) + corners[2] * 1e-9;
        }
        let target = random(&mut rng);
        let lookup = SurfaceLookup::new(&mesh, &corners);
        let found = lookup.closest(&target).expect("a place");
        let place = found.point.interpolate(&mesh, &corners);
        assert!(((place - target).norm() - found.distance).abs() < 1e-14);
        assert!(
            found
                .point
                .barycentric
                .iter()
                .all(|b| (0.0..=1.0).contains(b))
        );
        let sampled = sampled_distance(corners, &target);
        assert!(
            found.distance < sampled + 1e-14,
            "{} {sampled}",
            found.distance
        );
        assert!(
            found.distance > sampled - 1e-4,
            "{} {sampled}",
            found.distance
        );
    }
}

#[test]
fn both_searches_agree_with_a_search_over_all_faces() {
    let (mesh, positions) = sheet(14, bumpy);
    let lookup = SurfaceLookup::new(&mesh, &positions);
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for _ in 0..300 {
        let target = random(&mut rng);
        let (distance, face) = exhaustive(&mesh, &positions, &target);
        let found = lookup.closest(&target).expect("a place");
        assert_eq!((found.distance, found.point.face), (distance, face));
        assert_eq!(lookup.closest_of_all(&target), Some(found));
        let start = FaceId(rng.random_range(0..mesh.face_count() as u32));
        let near = lookup.closest_near(start, &target, 10.0).expect("a place");
        assert_eq!(near, found);
    }
}

#[test]
fn points_of_the_surface_are_found_where_they_are() {
    let (mesh, positions) = sheet(10, bumpy);
    let lookup = SurfaceLookup::new(&mesh, &positions);
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for face in mesh.faces().ids() {
        let (a, b) = (rng.random_range(0.1..0.4), rng.random_range(0.1..0.4));
        let barycentric = [1.0 - a - b, a, b];
        let target = MaterialPoint { face, barycentric }.interpolate(&mesh, &positions);
        let found = lookup.closest(&target).expect("a place");
        assert_eq!(found.point.face, face);
        let difference = (0..3).map(|i| (found.point.barycentric[i] - barycentric[i]).abs());
        assert!(difference.fold(0.0, f64::max) < 1e-12);
    }
}

#[test]
fn ties_go_to_the_lowest_face() {
    let (mesh, positions) = sheet(6, |s, t| Vector3::new(s, t, 0.0));
    let lookup = SurfaceLookup::new(&mesh, &positions);
    for (vertex, position) in mesh.border_vertices().ids().zip(&positions) {
        let lowest = mesh.vertex_faces(vertex)[0];
        let found = lookup.closest(position).expect("a place");
        assert_eq!((found.distance, found.point.face), (0.0, lowest));
        for &start in mesh.vertex_faces(vertex) {
            let near = lookup.closest_near(start, position, 0.2);
            assert_eq!(near, Some(found));
        }
    }
}

#[test]
fn touching_lips_are_not_confused() {
    // A sheet folded in two: its halves are a tenth of a cell apart, and meet far away.
    let (gap, n) = (2e-3, 24);
    let (mesh, positions) = sheet(n, |s, t| {
        let z = if s < 0.5 { gap } else { -gap };
        Vector3::new((2.0 * s - 1.0).abs(), t, if s == 0.5 { 0.0 } else { z })
    });
    let lookup = SurfaceLookup::new(&mesh, &positions);
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let mut crossed = 0;
    for _ in 0..200 {
        let (x, y) = (rng.random_range(0.4..0.95), rng.random_range(0.05..0.95));
        // Past the other sheet, as a wrinkle that pokes through.
        let target = Vector3::new(x, y, -1.5 * gap);
        let global = lookup.closest(&target).expect("a place");
        let upper = Vector3::new(x, y, gap);
        let start = mesh
            .faces()
            .iter()
            .map(|(f, corners)| (f, corners.map(|v| positions[v.index()])))
            .filter(|(_, c)| c.iter().all(|p| p.z > 0.0))
            .min_by(|(_, a), (_, b)| {
                let far = |c: &[Vector3<f64>; 3]| (c[0] + c[1] + c[2] - 3.0 * upper).norm();
                far(a).total_cmp(&far(b))
            });
        let start = start.expect("an upper face").0;
        let near = lookup.closest_near(start, &target, 0.1).expect("a place");
        let z = |p: &MaterialPoint| p.interpolate(&mesh, &positions).z;
        assert!((z(&near.point) - gap).abs() < 1e-15);
        assert!((near.distance - 2.5 * gap).abs() < 1e-12);
        crossed += u32::from(z(&global.point) < 0.0);
    }
    assert_eq!(crossed, 200);
}

#[test]
fn what_is_out_of_reach_is_not_crossed_and_the_start_always_counts() {
    let (mesh, positions) = sheet(8, |s, t| Vector3::new(s, t, 0.0));
    let lookup = SurfaceLookup::new(&mesh, &positions);
    let target = Vector3::new(0.9, 0.9, 0.01);
    let far = lookup
        .closest_near(FaceId(0), &target, 0.1)
        .expect("a place");
    assert_eq!(far.point.face, FaceId(0));
    let wide = lookup
        .closest_near(FaceId(0), &target, 2.0)
        .expect("a place");
    assert!((wide.distance - 0.01).abs() < 1e-15);
}

#[test]
fn triangles_without_area_and_without_numbers() {
    let (mesh, mut positions) = sheet(6, bumpy);
    positions[10] = positions[11];
    positions[17] = positions[18];
    positions[24] = positions[18];
    positions[30] = positions[29].lerp(&positions[31], 0.5);
    positions[40] = Vector3::repeat(f64::NAN);
    positions[44].y = f64::INFINITY;
    let lookup = SurfaceLookup::new(&mesh, &positions);
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..200 {
        let target = random(&mut rng);
        let near = lookup.closest_near(FaceId(2), &target, 9.0);
        for found in [lookup.closest(&target), near] {
            let found = found.expect("a place");
            let sum: f64 = found.point.barycentric.iter().sum();
            assert!((sum - 1.0).abs() < 1e-15 && found.distance.is_finite());
            let corners = mesh.faces()[found.point.face];
            assert!(!corners.iter().any(|v| [40, 44].contains(&v.0)));
        }
    }
    let nowhere = vec![Vector3::repeat(f64::NAN); positions.len()];
    let lookup = SurfaceLookup::new(&mesh, &nowhere);
    assert_eq!(lookup.closest(&Vector3::zeros()), None);
    assert_eq!(lookup.closest_near(FaceId(0), &Vector3::zeros(), 1.0), None);
    let lookup = SurfaceLookup::new(&mesh, &positions);
    assert_eq!(lookup.closest(&Vector3::repeat(f64::NAN)), None);
}
