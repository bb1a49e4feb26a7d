//! Edges split at any places: no area is lost, every part knows where it lies.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{
    Edge, FaceOrigin, Id, MaterialPoint, TriMesh, face_areas, split_edges, split_faces,
};

#[test]
fn parts_lie_where_they_say_and_cover_the_mesh() {
    let mut random = Pcg64::seed_from_u64(1);
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [2, 1, 5], [3, 2, 5]];
    let mesh = TriMesh::new(6, faces).expect("a valid mesh");
    let points = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.8, 0.9],
        [0.0, 1.0],
        [-1.0, 0.3],
        [1.4, 1.5],
    ];
    let rest: Vec<_> = points.map(|[x, y]| Vector3::new(x, y, x * y)).to_vec();
    for _ in 0..200 {
        let place = |_| {
            random
                .random_bool(0.5)
                .then(|| random.random_range(0.05..0.95))
        };
        let places: Vec<Option<f64>> = (0..mesh.edges().len()).map(place).collect();
        let mut positions = rest.clone();
        let split = split_edges(&mesh, &places, &mut positions);
        assert_eq!(positions.len(), 6 + places.iter().flatten().count());
        assert_eq!(split.born.len(), positions.len() - 6);
        for (born, position) in split.born.iter().zip(&positions[6..]) {
            let [a, b] = born.ends.map(|v| rest[v.index()]);
            assert!((a.lerp(&b, born.fraction) - position).norm() < 1e-15);
        }
        for (face, corners) in split.mesh.faces().iter() {
            let origin = &split.origins[face];
            for (corner, v) in corners.iter().enumerate() {
                let place = origin.place(MaterialPoint::at_corner(face, corner).barycentric);
                let there = place.interpolate(&mesh, &rest);
                assert!((there - positions[v.index()]).norm() < 1e-14);
            }
        }
        let area = |mesh: &TriMesh, at: &[Vector3<f64>]| -> f64 {
            face_areas(mesh, at).as_slice().iter().sum()
        };
        let (before, after) = (area(&mesh, &rest), area(&split.mesh, &positions));
        assert!((after / before - 1.0).abs() < 1e-12);
    }
}

/// More faces and vertices than a thread takes at a time.
#[test]
fn many_faces_are_numbered_in_their_order() {
    const SIDE: u32 = 80;
    let squares = (0..SIDE * SIDE).map(|i| i / SIDE * (SIDE + 1) + i % SIDE);
    let faces = squares.flat_map(|a| {
        let [b, c, d] = [a + 1, a + SIDE + 2, a + SIDE + 1];
        [[a, b, c], [a, c, d]]
    });
    let count = (SIDE + 1) * (SIDE + 1);
    let mesh = TriMesh::new(count as usize, faces.collect()).expect("a grid");
    // In the order of first appearance.
    let mut edges = 0;
    for face in mesh.faces().ids() {
        for edge in mesh.face_edges(face) {
            assert!(edge.index() <= edges);
            edges += usize::from(edge.index() == edges);
        }
    }
    assert_eq!(edges, mesh.edges().len());

    let place = |(i, edge): (usize, &Edge)| (i % 3 > 0 && !edge.is_border()).then_some(0.4);
    let places = mesh.edges().as_slice().iter().enumerate().map(place);
    let places: Vec<Option<f64>> = places.collect();
    let row = |v: u32| Vector3::new(f64::from(v % (SIDE + 1)), f64::from(v / (SIDE + 1)), 0.0);
    let rest: Vec<_> = (0..count).map(row).collect();
    let [mut once, mut again] = [rest.clone(), rest];
    let split = split_edges(&mesh, &places, &mut once);
    let other = |part: &FaceOrigin| FaceOrigin {
        corners: part.corners.map(|[u, v, w]| [v, w, u]),
        ..*part
    };
    let faces = split_faces(&mesh, &places, &mut again, other);
    assert!(once == again && faces.born == split.born);
    assert!(faces.parents.is_sorted() && faces.parents.len() > 3 * mesh.face_count() / 2);
    let parts = split.origins.as_slice().iter().zip(&faces.origins);
    for ((part, placed), parent) in parts.zip(&faces.parents) {
        assert!(part.face == *parent && other(part) == *placed);
    }
    let corners = split.mesh.faces().as_slice().iter();
    assert!(corners.map(|face| face.map(|v| v.0)).eq(faces.faces));
}
