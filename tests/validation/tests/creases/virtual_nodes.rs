//! What is left to move of a mesh that is cut and sewn as Patkar, Jin and Fedkiw 2014 do: one vector.
//!
//! Every node of a cut edge has a copy, and an equation per cut edge attaches both sides: `h = h'`, with
//! `h = w_A A + w_B B'` and `h' = w_A A' + w_B B`. In the differences `a = A - A'`, `b = B - B'` that is
//! `w_A a = w_B b`, per coordinate. Edges on a crease with an internal angle per star have no such limit.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::{DMatrix, Vector3};
use ruga_crease::{Corners, LineInput, LineTracer};
use ruga_mesh::{Id, TriMesh};

/// Squares along a side.
const SIDE: usize = 32;

/// A unit square whose inner vertices and diagonals are as they come.
fn square() -> (TriMesh, Vec<Vector3<f64>>) {
    let place = |i: usize, j: usize| {
        let is_inner = i > 0 && j > 0 && i < SIDE && j < SIDE;
        let wave = |phase: f64| (12.9 * i as f64 + 78.2 * j as f64 + phase).sin();
        let shift = if is_inner {
            [0.0, 1.0].map(|phase| 0.2 * wave(phase))
        } else {
            [0.0; 2]
        };
        Vector3::new(i as f64 + shift[0], j as f64 + shift[1], 0.0) / SIDE as f64
    };
    let all = |k: usize| (k % (SIDE + 1), k / (SIDE + 1));
    let positions = (0..(SIDE + 1) * (SIDE + 1)).map(|k| place(all(k).0, all(k).1));
    let at = |i: usize, j: usize| (j * (SIDE + 1) + i) as u32;
    let faces = (0..SIDE * SIDE).flat_map(|k| {
        let (i, j) = (k % SIDE, k / SIDE);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if (i * 7 + j * 3) % 5 < 2 {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        }
    });
    let positions: Vec<_> = positions.collect();
    let mesh = TriMesh::new(positions.len(), faces.collect()).expect("a valid grid");
    (mesh, positions)
}

/// Vectors left free by cuts through edges, each given by its ends and their weights.
fn free_vectors(cuts: &[([usize; 2], [f64; 2])]) -> usize {
    let mut number = BTreeMap::new();
    for node in cuts.iter().flat_map(|cut| cut.0) {
        let next = number.len();
        number.entry(node).or_insert(next);
    }
    let mut rows = DMatrix::zeros(cuts.len(), number.len());
    for (row, (ends, weights)) in cuts.iter().enumerate() {
        rows[(row, number[&ends[0]])] = weights[0];
        rows[(row, number[&ends[1]])] = -weights[1];
    }
    number.len() - rows.rank(1e-9)
}

/// The edges that a line crosses.
fn cuts(points: Vec<Vector3<f64>>, is_closed: bool) -> Vec<([usize; 2], [f64; 2])> {
    let (mesh, positions) = square();
    let input = LineInput::Positions {
        points,
        is_closed,
        reach: 1e-3,
        corners: Corners::Keep,
    };
    let line = LineTracer::new(&mesh, &positions)
        .trace(&input)
        .expect("a line");
    let crossed = line.segments().iter().filter_map(|segment| {
        let off = segment.to.iter().position(|&weight| weight.abs() < 1e-12)?;
        let ends = [(off + 1) % 3, (off + 2) % 3];
        let nodes = ends.map(|corner| mesh.faces()[segment.face][corner].index());
        Some((nodes, ends.map(|corner| segment.to[corner])))
    });
    let mut cuts: Vec<_> = crossed.collect();
    if !is_closed {
        // The line begins on a border edge, where no segment ends.
        let first = line.segments()[0];
        let off = first
            .from
            .iter()
            .position(|&w| w.abs() < 1e-12)
            .expect("a border edge");
        let ends = [(off + 1) % 3, (off + 2) % 3];
        let nodes = ends.map(|corner| mesh.faces()[first.face][corner].index());
        cuts.push((nodes, ends.map(|corner| first.from[corner])));
    }
    cuts
}

#[test]
fn a_line_from_border_to_border_folds_by_one_vector() {
    let line = [[0.0, 0.413], [1.0, 0.577]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let cuts = cuts(line.to_vec(), false);
    assert!(cuts.len() > 60);
    assert_eq!(free_vectors(&cuts), 1);
}

#[test]
fn a_ring_folds_by_none_unless_it_lies_on_a_level_line_of_the_mesh() {
    let point = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / 97.0).sin_cos();
        Vector3::new(0.5 + 0.31 * cos, 0.5 + 0.31 * sin, 0.0)
    };
    assert_eq!(free_vectors(&cuts((0..97).map(point).collect(), true)), 0);

    let (mesh, positions) = square();
    let level: Vec<f64> = positions
        .iter()
        .map(|p| (p - Vector3::new(0.5, 0.5, 0.0)).norm() - 0.31)
        .collect();
    let edges = mesh.edges().as_slice().iter().filter_map(|edge| {
        let ends = edge.vertices.map(Id::index);
        let [a, b] = ends.map(|v| level[v]);
        (a * b < 0.0).then(|| (ends, [b / (b - a), a / (a - b)]))
    });
    assert_eq!(free_vectors(&edges.collect::<Vec<_>>()), 1);
}
