//! Where a surface passes through itself.

use std::f64::consts::PI;

use nalgebra::Vector3;
use ruga_mesh::{FaceId, TriMesh, intersecting_pairs};

/// Pairs of the triangles over corners in the order of `positions`.
fn pairs(faces: &[[u32; 3]], positions: &[[f64; 3]]) -> Vec<[u32; 2]> {
    let mesh = TriMesh::new(positions.len(), faces.to_vec()).expect("a mesh");
    let positions: Vec<Vector3<f64>> = positions.iter().map(|p| Vector3::from(*p)).collect();
    let found = intersecting_pairs(&mesh, &positions);
    found.into_iter().map(|pair| pair.map(|f| f.0)).collect()
}

const APART: [[u32; 3]; 2] = [[0, 1, 2], [3, 4, 5]];
const LYING: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn with(second: [[f64; 3]; 3]) -> Vec<[u32; 2]> {
    pairs(&APART, &[LYING, second].concat())
}

#[test]
fn two_triangles_that_cross_are_a_pair_in_any_order() {
    let standing = [[0.2, 0.2, -0.5], [0.3, 0.2, 0.5], [0.2, 0.4, 0.5]];
    assert_eq!(with(standing), [[0, 1]]);
    assert_eq!(
        pairs(&[[3, 4, 5], [0, 1, 2]], &[LYING, standing].concat()),
        [[0, 1]]
    );
    // One whose edges all pass beside the first, through which its own edge goes.
    let large = [[0.3, -9.0, -9.0], [0.3, 9.0, -9.0], [0.3, 0.2, 9.0]];
    assert_eq!(with(large), [[0, 1]]);
}

#[test]
fn triangles_that_end_before_each_other_or_touch_are_none() {
    let above = [[0.2, 0.2, 1e-9], [0.3, 0.2, 0.5], [0.2, 0.4, 0.5]];
    assert!(with(above).is_empty());
    let touching = [[0.2, 0.2, 0.0], [0.3, 0.2, 0.5], [0.2, 0.4, 0.5]];
    assert!(with(touching).is_empty());
    // Its plane is crossed, beside it.
    let beside = [[0.6, 0.6, -0.5], [0.7, 0.6, 0.5], [0.6, 0.8, 0.5]];
    assert!(with(beside).is_empty());
}

#[test]
fn triangles_of_one_plane_are_a_pair_where_they_overlap() {
    let moved = |x: f64| LYING.map(|[a, b, c]| [a + x, b, c]);
    assert_eq!(with(moved(0.3)), [[0, 1]]);
    assert!(with(moved(1.5)).is_empty());
    // They have a corner at the same place.
    assert!(with(moved(1.0)).is_empty());
}

#[test]
fn neighbours_are_none_however_they_are_folded_until_they_lie_on_each_other() {
    let folded = |angle: f64| {
        let apex = [0.3, angle.cos(), angle.sin()];
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.4, 1.0, 0.0], apex];
        pairs(&[[0, 1, 2], [1, 0, 3]], &corners)
    };
    for degrees in [180.0, 90.0, 1.0, 1e-6] {
        assert!(folded(f64::to_radians(degrees)).is_empty(), "{degrees}");
    }
    assert_eq!(folded(0.0), [[0, 1]]);
}

#[test]
fn faces_with_a_common_vertex_are_a_pair_only_where_they_cross_beside_it() {
    let with = |third: [f64; 3]| {
        let corners = [LYING[0], LYING[1], LYING[2], [0.5, 0.4, -0.5], third];
        pairs(&[[0, 1, 2], [0, 3, 4]], &corners)
    };
    assert_eq!(with([0.4, 0.5, 0.5]), [[0, 1]]);
    assert!(with([-0.4, -0.5, 0.5]).is_empty());
}

/// A strip of unit width, `radius` from its axis over the angle along it from 0 to `end`.
fn roll(end: f64, radius: impl Fn(f64) -> f64) -> (TriMesh, Vec<Vector3<f64>>, Vec<f64>) {
    let (columns, rows) = (240, 4);
    let angle = |i: u32| end * f64::from(i) / f64::from(columns);
    let corner = |i, j| i * (rows + 1) + j;
    let places = (0..=columns).flat_map(|i| (0..=rows).map(move |j| (i, j)));
    let position = |(i, j)| {
        let (sin, cos) = angle(i).sin_cos();
        let radius = radius(angle(i));
        Vector3::new(radius * cos, radius * sin, f64::from(j) / f64::from(rows))
    };
    let positions: Vec<Vector3<f64>> = places.map(position).collect();
    let cells = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let cells: Vec<(u32, u32)> = cells.collect();
    let halves = |(i, j): &(u32, u32)| {
        let [a, b] = [corner(*i, *j), corner(i + 1, *j)];
        [[a, b, b + 1], [a, b + 1, a + 1]]
    };
    let faces: Vec<[u32; 3]> = cells.iter().flat_map(halves).collect();
    let angles = cells.iter().flat_map(|(i, _)| [angle(*i); 2]);
    let mesh = TriMesh::new(positions.len(), faces).expect("a strip");
    (mesh, positions, angles.collect())
}

#[test]
fn a_roll_is_clean_until_its_turns_pass_through_each_other() {
    let (mesh, spiral, _) = roll(6.0 * PI, |angle| 1.0 + 0.02 * angle);
    assert!(intersecting_pairs(&mesh, &spiral).is_empty());
    // Half way round, the second turn goes from outside to inside.
    let (mesh, crossing, angles) = roll(4.0 * PI, |angle| 1.0 + 0.1 * (0.5 * angle).cos());
    let found = intersecting_pairs(&mesh, &crossing);
    // Every cell across the strip crosses one of the other turn.
    assert!((8..=32).contains(&found.len()), "{}", found.len());
    for [a, b] in found {
        let [first, second] = [a, b].map(|f: FaceId| angles[f.0 as usize]);
        assert!((first - PI).abs() < 0.2, "{first}");
        assert!((second - 3.0 * PI).abs() < 0.2, "{second}");
    }
}
