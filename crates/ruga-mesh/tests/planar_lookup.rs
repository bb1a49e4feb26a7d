//! Texture coordinates find their face.

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{FaceId, PlanarLookup, barycentric};

type Triangle = [Vector2<f64>; 3];

/// A wavy quad grid over the unit square, graded so that faces differ in size a hundredfold.
fn chart(cells: usize) -> Vec<Triangle> {
    let place = |i: usize, j: usize| {
        let [s, t] = [i, j].map(|k| (k as f64 / cells as f64).powi(2));
        Vector2::new(s + 0.1 * s * (1.0 - s) * (6.0 * t).sin(), t)
    };
    let mut triangles = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [
                place(i, j),
                place(i + 1, j),
                place(i + 1, j + 1),
                place(i, j + 1),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

fn brute_force(triangles: &[Triangle], point: Vector2<f64>) -> Option<usize> {
    triangles.iter().position(|&t| {
        barycentric(t, point).is_some_and(|weights| weights.iter().all(|&b| b >= -1e-12))
    })
}

#[test]
fn random_points_are_found_where_a_search_over_all_faces_finds_them() {
    let triangles = chart(17);
    let lookup = PlanarLookup::new(triangles.clone().into());
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut found = 0;
    for _ in 0..4000 {
        let point = Vector2::from_fn(|_, _| rng.random_range(-0.2..1.2));
        let hit = lookup.locate(point);
        assert_eq!(
            hit.map(|m| m.face.0 as usize),
            brute_force(&triangles, point),
            "{point}"
        );
        if let Some(m) = hit {
            found += 1;
            let [a, b, c] = triangles[m.face.0 as usize];
            let [u, v, w] = m.barycentric;
            assert!((a * u + b * v + c * w - point).norm() < 1e-13);
            assert!((u + v + w - 1.0).abs() < 1e-13);
        }
    }
    assert!(found > 1500 && found < 2600, "{found}");
}

#[test]
fn vertices_and_edges_belong_to_the_lowest_face() {
    let triangles = chart(9);
    let lookup = PlanarLookup::new(triangles.clone().into());
    for t in &triangles {
        for point in [
            t[0],
            t[1],
            t[2],
            0.5 * (t[0] + t[1]),
            0.25 * t[1] + 0.75 * t[2],
        ] {
            let hit = lookup.locate(point).map(|m| m.face.0 as usize);
            assert_eq!(hit, brute_force(&triangles, point));
            assert!(hit.is_some());
        }
    }
}

#[test]
fn bad_triangles_are_passed_over() {
    let mut triangles = chart(4);
    let good = triangles.len() as u32;
    triangles[3][1].x = f64::NAN;
    triangles[5][2] = triangles[5][0];
    triangles.push([Vector2::new(f64::INFINITY, 0.0); 3]);
    let lookup = PlanarLookup::new(triangles.clone().into());
    let middle = |t: Triangle| (t[0] + t[1] + t[2]) / 3.0;
    let intact = chart(4);
    assert_eq!(lookup.locate(middle(intact[3])), None);
    assert_eq!(lookup.locate(middle(intact[5])), None);
    for face in (0..good).filter(|f| ![3, 5].contains(f)) {
        let hit = lookup.locate(middle(intact[face as usize]));
        assert_eq!(hit.map(|m| m.face), Some(FaceId(face)));
    }
    assert_eq!(lookup.locate(Vector2::new(f64::NAN, 0.5)), None);
}

#[test]
fn a_chart_far_from_the_origin_or_very_thin() {
    for (shift, scale) in [
        (Vector2::new(1e4, -1e4), Vector2::new(1.0, 1.0)),
        (Vector2::zeros(), Vector2::new(1.0, 1e-6)),
        (Vector2::zeros(), Vector2::new(1e-7, 1e-7)),
    ] {
        let map = |p: Vector2<f64>| p.component_mul(&scale) + shift;
        let triangles: Vec<Triangle> = chart(8).into_iter().map(|t| t.map(map)).collect();
        let lookup = PlanarLookup::new(triangles.clone().into());
        for (face, t) in triangles.iter().enumerate() {
            let middle = (t[0] + t[1] + t[2]) / 3.0;
            let hit = lookup.locate(middle).map(|m| m.face.0 as usize);
            assert_eq!(hit, Some(face), "{shift} {scale}");
        }
    }
}

#[test]
fn all_faces_over_a_point_are_found_where_charts_overlap() {
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
    let moved = triangle.map(|p| p + Vector2::new(0.1, 0.1));
    let lookup = PlanarLookup::new(vec![triangle, moved].into());
    let faces = |x, y| -> Vec<u32> {
        lookup
            .locate_all(Vector2::new(x, y))
            .map(|place| place.face.0)
            .collect()
    };
    assert_eq!(faces(0.3, 0.3), [0, 1]);
    assert_eq!(faces(0.05, 0.3), [0]);
    assert_eq!(faces(0.55, 0.55), [1]);
    assert!(faces(f64::NAN, 0.0).is_empty());
}
