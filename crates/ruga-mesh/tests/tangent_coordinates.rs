//! Unrolled neighbourhoods: exact on a plane, second order on a cylinder, never through the air.

use nalgebra::{Rotation3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{
    Id, TangentCentre, TangentCoordinates, TriMesh, VertexId, tangent_coordinates, tangent_frame,
    vertex_normals,
};

/// Irregular points of [-1, 1]², the middle one at the origin, and faces with random diagonals.
fn irregular_square(cells: usize, seed: u64) -> (Vec<Vector2<f64>>, Vec<[u32; 3]>) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step = 2.0 / cells as f64;
    let mut places = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let place = Vector2::new(i as f64, j as f64) * step - Vector2::repeat(1.0);
            let is_middle = 2 * i == cells && 2 * j == cells;
            let shift = Vector2::from_fn(|_, _| rng.random_range(-0.2..0.2) * step);
            places.push(if is_middle {
                Vector2::zeros()
            } else {
                place + shift
            });
        }
    }
    let mut faces = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let a = (j * (cells + 1) + i) as u32;
            let [b, c, d] = [a + 1, a + cells as u32 + 2, a + cells as u32 + 1];
            if rng.random_bool(0.5) {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    (places, faces)
}

fn middle(cells: usize) -> VertexId {
    VertexId(((cells + 1) * (cells + 1) / 2) as u32)
}

/// Unrolled around a vertex.
fn around(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    centre: VertexId,
    axis: Vector3<f64>,
    radius: f64,
) -> Vec<TangentCoordinates> {
    let centre = TangentCentre {
        origin: positions[centre.index()],
        normal: normals[centre.index()],
        axis,
        around: vec![centre],
    };
    tangent_coordinates(mesh, positions, normals, &centre, radius)
}

#[test]
fn exact_on_a_tilted_plane() {
    let cells = 30;
    for seed in 0..5 {
        let (places, faces) = irregular_square(cells, seed);
        let turn = Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let offset = Vector3::new(3.0, -2.0, 1.0);
        let positions: Vec<_> = places
            .iter()
            .map(|p| turn * Vector3::new(p.x, p.y, 0.0) + offset)
            .collect();
        let mesh = TriMesh::new(positions.len(), faces).expect("a square");
        let normals = vertex_normals(&mesh, &positions);
        let axis = turn * Vector3::x() + 5.0 * (turn * Vector3::z());
        let radius = 0.6;
        let found = around(&mesh, &positions, &normals, middle(cells), axis, radius);
        let error = |t: &TangentCoordinates| (t.place - places[t.vertex.index()]).norm();
        let worst = found.iter().map(error).fold(0.0, f64::max);
        assert!(worst < 1e-13 * radius, "{worst}");
        assert!(found.iter().all(|t| t.place.norm() <= radius));
        assert!(found.is_sorted_by(|a, b| a.vertex < b.vertex));
        // Nobody within the radius is forgotten, but for stragglers at the rim.
        let inner = places.iter().filter(|p| p.norm() < 0.9 * radius).count();
        let found_inner = found.iter().filter(|t| t.place.norm() < 0.9 * radius);
        assert_eq!(found_inner.count(), inner);
    }
}

/// Largest error over the radius, of a patch with the given radius on a cylinder of radius one.
fn cylinder_error(radius: f64) -> f64 {
    let cells = 40;
    let mut worst = 0.0_f64;
    for seed in 0..3 {
        let (places, faces) = irregular_square(cells, seed);
        // Along the axis nothing bends: turn the cylinder against the grid.
        let unrolled: Vec<Vector2<f64>> = places.iter().map(|p| p * 1.3 * radius).collect();
        let positions: Vec<_> = unrolled
            .iter()
            .map(|p| Vector3::new(p.x.sin(), p.y, p.x.cos()))
            .collect();
        let mesh = TriMesh::new(positions.len(), faces).expect("a square");
        let normals: Vec<_> = unrolled
            .iter()
            .map(|p| Vector3::new(p.x.sin(), 0.0, p.x.cos()))
            .collect();
        let centre = middle(cells);
        for t in around(&mesh, &positions, &normals, centre, Vector3::x(), radius) {
            worst = worst.max((t.place - unrolled[t.vertex.index()]).norm() / radius);
        }
    }
    worst
}

#[test]
fn on_a_cylinder_the_error_falls_with_the_square_of_the_radius() {
    let errors = [0.8, 0.4, 0.2].map(cylinder_error);
    println!("relative errors at radius .8, .4, .2: {errors:.5?}");
    assert!(errors[0] < 0.02, "{}", errors[0]);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..5.5).contains(&ratio), "{ratio}");
    }
}

#[test]
fn the_other_side_of_a_thin_fold_is_out_of_reach() {
    // A strip folded back on itself, a hundredth apart.
    let cells = 40;
    let (places, faces) = irregular_square(cells, 1);
    let positions: Vec<_> = places
        .iter()
        .map(|p| {
            let x = p.x + 0.5;
            Vector3::new(x.abs(), p.y, if x < 0.0 { -0.01 } else { 0.0 })
        })
        .collect();
    let mesh = TriMesh::new(positions.len(), faces).expect("a square");
    let normals = vertex_normals(&mesh, &positions);
    let centre = middle(cells);
    let found = around(&mesh, &positions, &normals, centre, Vector3::x(), 0.4);
    assert!(found.len() > 100);
    for t in found {
        assert!(places[t.vertex.index()].x > -0.5);
    }
}

#[test]
fn a_radius_below_every_edge_leaves_the_centre() {
    let (places, faces) = irregular_square(4, 2);
    let positions: Vec<_> = places.iter().map(|p| Vector3::new(p.x, p.y, 0.0)).collect();
    let mesh = TriMesh::new(positions.len(), faces).expect("a square");
    let normals = vertex_normals(&mesh, &positions);
    let found = around(&mesh, &positions, &normals, middle(4), Vector3::x(), 1e-3);
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].vertex, found[0].place),
        (middle(4), Vector2::zeros())
    );
}

#[test]
fn frames_are_right_handed_for_every_normal_and_axis() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for i in 0..200 {
        let normal = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
        let axis = match i % 3 {
            0 => Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)),
            1 => normal * 2.0,
            _ => Vector3::zeros(),
        };
        let [first, second] = tangent_frame(normal, axis);
        let frame = nalgebra::Matrix3::from_columns(&[first, second, normal]);
        assert!((frame.transpose() * frame - nalgebra::Matrix3::identity()).norm() < 1e-12);
        assert!((frame.determinant() - 1.0).abs() < 1e-12);
        if i % 3 == 0 {
            assert!(first.dot(&axis) > 0.0);
        }
    }
}
