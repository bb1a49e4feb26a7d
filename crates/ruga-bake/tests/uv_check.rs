//! The report on UVs: overlaps of area, not of borders; mirrored, outside, missing, empty.

mod patch;

use nalgebra::Vector2;
use patch::{SIDE, grid_faces, scatter, uv};
use ruga_bake::{MAX_OVERLAPS, UvReport, check_uvs};

fn triangle(corners: [[f64; 2]; 3]) -> [Vector2<f64>; 3] {
    corners.map(Vector2::from)
}

/// The UVs of a grid of `cells`² quads, V down: nothing to complain about.
fn grid(cells: usize) -> Vec<[Vector2<f64>; 3]> {
    let place = |v: u32| {
        let [column, row] = [v as usize % (cells + 1), v as usize / (cells + 1)];
        // Through f32, as files hold them.
        uv([column, row].map(|i| i as f64 * SIDE / cells as f64)).map(|c| f64::from(c as f32))
    };
    grid_faces(cells)
        .into_iter()
        .map(|f| f.map(place))
        .collect()
}

#[test]
fn common_edges_and_corners_are_no_overlap() {
    assert_eq!(check_uvs(&grid(64)), UvReport::default());
    // Vertices on the middle of a neighbour's edge, and needles.
    let joint = [
        triangle([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]),
        triangle([[0.0, 1.0], [0.5, 1.0], [0.5, 0.5]]),
        triangle([[0.5, 0.5], [0.5, 0.500001], [1.0, 0.0]]),
    ];
    assert_eq!(check_uvs(&joint).overlaps, []);
}

#[test]
fn a_fold_over_a_common_edge_overlaps() {
    let folded = [
        triangle([[0.1, 0.1], [0.1, 0.9], [0.9, 0.1]]),
        triangle([[0.9, 0.1], [0.1, 0.9], [0.2, 0.2]]),
    ];
    let report = check_uvs(&folded);
    assert_eq!(report.overlaps, [(1, 0)]);
    assert_eq!(report.mirrored, [1]);
}

#[test]
fn identical_and_mirrored_copies_overlap() {
    let [a, b, c] = [[0.1, 0.1], [0.1, 0.9], [0.9, 0.1]];
    let stack = [
        triangle([a, b, c]),
        triangle([b, c, a]),
        triangle([a, c, b]),
    ];
    let report = check_uvs(&stack);
    assert_eq!(report.overlaps, [(1, 0), (2, 0)]);
    assert_eq!(report.overlapping, 2);
    assert_eq!(report.mirrored, [2]);
}

#[test]
fn containment_without_crossing_edges_overlaps() {
    let nested = [
        triangle([[0.4, 0.4], [0.4, 0.5], [0.5, 0.4]]),
        triangle([[0.1, 0.1], [0.1, 0.9], [0.9, 0.1]]),
    ];
    assert_eq!(check_uvs(&nested).overlaps, [(1, 0)]);
}

#[test]
fn the_tolerance_is_a_millionth_of_the_smaller_face() {
    // Two right triangles side by side; the second reaches `depth` into the first, which makes
    // the shared area about 2 depth of its own.
    let pair = |depth: f64| {
        [
            triangle([[0.0, 0.0], [0.0, 1.0], [0.5, 0.0]]),
            triangle([[0.0, 0.0], [0.5, 0.0], [0.0, -1.0]].map(|[x, y]| [x, y + depth])),
        ]
    };
    assert_eq!(check_uvs(&pair(1e-7)).overlaps, []);
    assert_eq!(check_uvs(&pair(1e-5)).overlaps, [(1, 0)]);
}

#[test]
fn outside_missing_and_empty_faces_are_listed() {
    let report = check_uvs(&[
        triangle([[0.0, 0.0], [0.0, 1.0], [1.0 + 1e-7, 0.0]]),
        triangle([[0.9, 0.9], [0.9, 1.2], [1.2, 0.9]]),
        triangle([[f64::NAN, 0.0], [0.0, 1.0], [1.0, 0.0]]),
        triangle([[0.2, 0.2]; 3]),
        triangle([[0.0, -3.0], [0.0, -2.0], [1.0, -3.0]]),
    ]);
    assert_eq!(report.outside, [1, 4]);
    assert_eq!(report.missing, [2]);
    assert_eq!(report.zero_area, [3]);
    assert_eq!(report.overlaps, []);
}

/// Against every pair, by sampling: faces overlap when some point lies well inside both.
#[test]
fn overlaps_are_those_that_all_pairs_show() {
    let faces: Vec<_> = (0..60).map(small_triangle).collect();
    let report = check_uvs(&faces);
    let expected: Vec<_> = (0..faces.len())
        .filter_map(|face| Some((face as u32, first_shared(&faces, face)?)))
        .collect();
    // Sampling may miss the thinnest overlaps, but not most.
    let found = expected.len();
    assert!(found > 5 && report.overlapping <= found + 3, "{found}");
    assert_eq!(report.overlaps.first(), expected.first());
    for (face, earlier) in report.overlaps {
        let pair = [faces[earlier as usize], faces[face as usize]];
        assert_eq!(check_uvs(&pair).overlapping, 1);
    }
}

fn small_triangle(face: usize) -> [Vector2<f64>; 3] {
    let center = Vector2::new(scatter(9 * face), scatter(9 * face + 1));
    [0, 1, 2].map(|corner| {
        let at = 9 * face + 3 + 2 * corner;
        Vector2::repeat(0.5) + 0.4 * center + 0.06 * Vector2::new(scatter(at), scatter(at + 1))
    })
}

/// The first face before `face` that has one of its samples inside.
fn first_shared(faces: &[[Vector2<f64>; 3]], face: usize) -> Option<u32> {
    let inside = |face: &[Vector2<f64>; 3], p: &Vector2<f64>| {
        let side = |i: usize| (face[(i + 1) % 3] - face[i]).perp(&(p - face[i]));
        (0..3).all(|i| side(i) > 1e-9) || (0..3).all(|i| side(i) < -1e-9)
    };
    let samples: Vec<_> = (0..=120)
        .flat_map(|i| (0..=120 - i).map(move |j| [i, j].map(|c| f64::from(c) / 120.0)))
        .map(|[u, v]| faces[face][0] * u + faces[face][1] * v + faces[face][2] * (1.0 - u - v))
        .collect();
    let shares = |other: &usize| {
        let both = |p: &Vector2<f64>| inside(&faces[face], p) && inside(&faces[*other], p);
        samples.iter().any(both)
    };
    (0..face).find(shares).map(|other| other as u32)
}

/// A texture that repeats: every quad of the mesh covers the whole tile.
#[test]
fn a_report_on_tiled_faces_is_short_and_has_their_number() {
    let quad = [
        triangle([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
        triangle([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
    ];
    let tiled: Vec<_> = (0..20_000).map(|face| quad[face % 2]).collect();
    let report = check_uvs(&tiled);
    assert_eq!(report.overlapping, 19_998);
    assert_eq!(report.overlaps.len(), MAX_OVERLAPS);
    assert_eq!(report.overlaps[..3], [(2, 0), (3, 1), (4, 0)]);
}
