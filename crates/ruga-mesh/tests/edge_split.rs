//! Edges split at any places: no area is lost, every part knows where it lies.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{Id, MaterialPoint, TriMesh, face_areas, split_edges};

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
