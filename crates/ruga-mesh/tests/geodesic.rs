//! Distances along edges.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh, VertexId, edge_distances, edge_distances_with_starts};

/// `width` by `height` unit squares cut along one diagonal, and a triangle apart.
fn grid(width: u32, height: u32) -> (TriMesh, Vec<Vector3<f64>>) {
    let stride = width + 1;
    let mut positions = Vec::new();
    for j in 0..=height {
        positions.extend((0..=width).map(|i| Vector3::new(f64::from(i), f64::from(j), 0.0)));
    }
    let island = positions.len() as u32;
    positions.extend([[9.0, 0.0], [9.5, 0.0], [9.0, 0.5]].map(|[x, y]| Vector3::new(x, y, 0.0)));
    let mut faces = vec![[island, island + 1, island + 2]];
    for j in 0..height {
        for i in 0..width {
            let a = j * stride + i;
            faces.extend([[a, a + 1, a + stride + 1], [a, a + stride + 1, a + stride]]);
        }
    }
    let mesh = TriMesh::new(positions.len(), faces).expect("a grid and a triangle");
    (mesh, positions)
}

/// Shortest way on the grid: diagonals only towards (1, 1).
fn expected(from: Vector3<f64>, to: Vector3<f64>) -> f64 {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let diagonal = if x * y > 0.0 {
        x.abs().min(y.abs())
    } else {
        0.0
    };
    diagonal * 2.0_f64.sqrt() + x.abs() + y.abs() - 2.0 * diagonal
}

#[test]
fn the_nearest_of_several_sources_counts() {
    let (mesh, positions) = grid(7, 5);
    let sources = [VertexId(9), VertexId(37)];
    let distances = edge_distances(&mesh, &positions, sources, f64::INFINITY);
    for (vertex, &distance) in distances.iter() {
        let place = positions[vertex.index()];
        let wanted = sources.map(|s| expected(positions[s.index()], place));
        if vertex.index() < 48 {
            assert!((distance - wanted[0].min(wanted[1])).abs() < 1e-12);
        } else {
            assert_eq!(distance, f64::INFINITY);
        }
    }
}

#[test]
fn beyond_the_limit_everything_is_infinite() {
    let (mesh, positions) = grid(7, 5);
    let distances = edge_distances(&mesh, &positions, [VertexId(0)], 3.0);
    for (vertex, &distance) in distances.iter() {
        let wanted = expected(positions[0], positions[vertex.index()]);
        assert_eq!(distance.is_finite(), wanted <= 3.0 && vertex.index() < 48);
    }
    let none = edge_distances(&mesh, &positions, [], 3.0);
    assert!(none.as_slice().iter().all(|d| d.is_infinite()));
}

/// Of a block of sources only the rim leads anywhere; one inside it that is dearer than those around is lowered.
#[test]
fn sources_that_cover_a_part_count_from_its_rim() {
    let (mesh, positions) = grid(7, 5);
    let block = (0..6).flat_map(|j| (0..5).map(move |i| VertexId(8 * j + i)));
    let dear = VertexId(8 * 2 + 2);
    let start = |v: VertexId| (v, if v == dear { 3.0 } else { 0.5 });
    let starts: Vec<_> = block.map(start).chain([(VertexId(12), 0.25)]).collect();
    let distances = edge_distances_with_starts(&mesh, &positions, starts.clone(), 4.0);
    for (vertex, &distance) in distances.iter().filter(|(v, _)| v.index() < 48) {
        let place = positions[vertex.index()];
        let from =
            |(source, start): &(VertexId, f64)| start + expected(positions[source.index()], place);
        let wanted = starts.iter().map(from).fold(f64::INFINITY, f64::min);
        assert!(
            (distance - wanted).abs() < 1e-12,
            "{vertex:?}: {distance} for {wanted}"
        );
    }
}

#[test]
fn sources_may_be_some_way_off() {
    let (mesh, positions) = grid(7, 5);
    let starts = [
        (VertexId(9), 0.5),
        (VertexId(37), 1.75),
        (VertexId(9), 0.25),
    ];
    let distances = edge_distances_with_starts(&mesh, &positions, starts, 4.0);
    for (vertex, &distance) in distances.iter().filter(|(v, _)| v.index() < 48) {
        let place = positions[vertex.index()];
        let wanted = starts.map(|(s, start)| start + expected(positions[s.index()], place));
        let wanted = wanted.into_iter().fold(f64::INFINITY, f64::min);
        match wanted <= 4.0 {
            true => assert!((distance - wanted).abs() < 1e-12),
            false => assert_eq!(distance, f64::INFINITY),
        }
    }
}
