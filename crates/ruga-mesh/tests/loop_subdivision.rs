//! Loop subdivision and its limit: affine, consistent from level to level, oriented, convergent.

mod controls;

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{FaceId, Id, PerVertex, Subdivision, TriMesh, VertexId, limit_rows, subdivide};

use controls::{Control, Positions, sums};

fn smooth(mesh: &TriMesh) -> PerVertex<bool> {
    PerVertex::filled(mesh.vertex_count(), false)
}

fn refine(mesh: &TriMesh, levels: u32) -> Subdivision {
    subdivide(mesh, levels, &smooth(mesh))
}

/// A vertex surrounded by `count` faces over an angle; closed if the angle is a full turn.
///
/// Rim vertices get random heights and radii, so that nothing is symmetric.
fn fan(count: usize, angle: f64, seed: u64, height: f64) -> (TriMesh, Positions) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let closed = angle == TAU;
    let rim = if closed { count } else { count + 1 };
    let mut positions = vec![Vector3::zeros()];
    for i in 0..rim {
        let (sin, cos) = (angle * i as f64 / count as f64).sin_cos();
        let radius = rng.random_range(0.8..1.2);
        let z = height * rng.random_range(-1.0..1.0);
        positions.push(Vector3::new(radius * cos, radius * sin, z));
    }
    let faces = (0..count).map(|i| [0, i as u32 + 1, ((i + 1) % rim) as u32 + 1]);
    let mesh = TriMesh::new(positions.len(), faces.collect()).expect("a fan");
    (mesh, positions)
}

/// Every valence of inner and border vertices that a scene may hold, as fans.
fn all_fans(height: f64) -> Vec<(TriMesh, Positions)> {
    let inner = (3..=12).map(|n| fan(n, TAU, n as u64, height));
    let border = (1..=11).flat_map(|n| {
        [PI / 3.0, PI / 2.0, PI, 1.4 * PI]
            .into_iter()
            .filter(move |angle| angle / (n as f64) < 0.95 * PI)
            .map(move |angle| fan(n, angle, 100 + n as u64, height))
    });
    inner.chain(border).collect()
}

/// A closed mesh: the icosahedron.
fn icosahedron() -> (TriMesh, Positions) {
    let Control {
        mesh, positions, ..
    } = controls::icosahedron();
    (mesh, positions)
}

/// An irregular disc: a fan of five, subdivided once, with random positions.
fn disc(seed: u64) -> (TriMesh, Positions) {
    let (mesh, positions) = fan(5, TAU, seed, 0.4);
    let fine = refine(&mesh, 1);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut positions = fine.fine_from_coarse.apply(&positions);
    for p in &mut positions {
        *p += Vector3::from_fn(|_, _| rng.random_range(-0.05..0.05));
    }
    (fine.mesh, positions)
}

#[test]
fn rows_are_affine_and_tangents_blind_to_translation() {
    for (mesh, _) in all_fans(0.0).into_iter().chain([icosahedron(), disc(3)]) {
        let fine = refine(&mesh, 2);
        let limit = limit_rows(&fine.mesh, &fine.corners);
        for (rows, sum) in [
            (&fine.fine_from_coarse, 1.0),
            (&limit.position, 1.0),
            (&limit.first_tangent, 0.0),
            (&limit.second_tangent, 0.0),
        ] {
            let worst = sums(rows).into_iter().map(|s| (s - sum).abs());
            assert!(worst.fold(0.0, f64::max) < 1e-13);
        }
    }
}

#[test]
fn a_regular_flat_mesh_keeps_its_vertices_inside_and_on_straight_borders() {
    // Lattice vertices reproduce linear functions of the parameter, not only affine images.
    let n = 6_u32;
    let place = |i: u32, j: u32| Vector3::new(f64::from(i) + 0.5 * f64::from(j), f64::from(j), 0.0);
    let positions: Positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| place(i, j)))
        .collect();
    let faces = (0..n).flat_map(|j| {
        (0..n).flat_map(move |i| {
            let a = j * (n + 1) + i;
            [[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]
        })
    });
    let mesh = TriMesh::new(positions.len(), faces.collect()).expect("a lattice");
    let limit = limit_rows(&mesh, &smooth(&mesh)).position.apply(&positions);
    let fine = refine(&mesh, 1).fine_from_coarse.apply(&positions);
    for v in 0..positions.len() {
        let (i, j) = (v as u32 % (n + 1), v as u32 / (n + 1));
        let is_corner = (i == 0 || i == n) && (j == 0 || j == n);
        if !is_corner {
            assert!((limit[v] - positions[v]).norm() < 1e-14, "{v}");
            assert!((fine[v] - positions[v]).norm() < 1e-14, "{v}");
        }
    }
}

#[test]
fn sharp_corners_stay() {
    let (mesh, positions) = disc(4);
    let mut corners = smooth(&mesh);
    corners[VertexId(2)] = true;
    let fine = subdivide(&mesh, 3, &corners);
    let control = fine.fine_from_coarse.apply(&positions);
    let limit = limit_rows(&fine.mesh, &fine.corners);
    assert_eq!(control[2], positions[2]);
    assert_eq!(limit.position.apply(&control)[2], positions[2]);
    assert_eq!(limit.first_tangent.row(2).count(), 0);
    assert_eq!(fine.corners.as_slice().iter().filter(|&&c| c).count(), 1);
}

#[test]
fn the_limit_is_the_same_from_every_level() {
    for (mesh, positions) in all_fans(0.5).into_iter().chain([icosahedron(), disc(5)]) {
        let coarse = limit_rows(&mesh, &smooth(&mesh)).position.apply(&positions);
        let fine = refine(&mesh, 2);
        let control = fine.fine_from_coarse.apply(&positions);
        let later = limit_rows(&fine.mesh, &fine.corners)
            .position
            .apply(&control);
        for (early, late) in coarse.iter().zip(&later) {
            assert!((early - late).norm() < 1e-12, "{} faces", mesh.face_count());
        }
    }
}

fn limit_normals(mesh: &TriMesh, corners: &PerVertex<bool>, positions: &Positions) -> Positions {
    let limit = limit_rows(mesh, corners);
    let first = limit.first_tangent.apply(positions);
    let second = limit.second_tangent.apply(positions);
    let cross = |(a, b): (&Vector3<f64>, &Vector3<f64>)| a.cross(b).normalize();
    first.iter().zip(&second).map(cross).collect()
}

#[test]
fn the_tangent_plane_is_the_same_from_every_level() {
    for (mesh, positions) in all_fans(0.5).into_iter().chain([icosahedron(), disc(6)]) {
        let coarse = limit_normals(&mesh, &smooth(&mesh), &positions);
        let fine = refine(&mesh, 1);
        let control = fine.fine_from_coarse.apply(&positions);
        let later = limit_normals(&fine.mesh, &fine.corners, &control);
        for (v, (early, late)) in coarse.iter().zip(&later).enumerate() {
            let valence = mesh.vertex_faces(VertexId(v as u32)).len();
            let turn = (early - late).norm();
            assert!(turn < 1e-9, "vertex {v} of {valence} faces: {turn}");
        }
    }
}

#[test]
fn tangents_span_the_plane_and_point_outwards_at_every_valence() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, 1.1, -0.7);
    for (mesh, positions) in all_fans(0.0) {
        let positions: Positions = positions.iter().map(|p| turn * p).collect();
        let outwards = turn * Vector3::z();
        let limit = limit_rows(&mesh, &smooth(&mesh));
        let first = limit.first_tangent.apply(&positions);
        let second = limit.second_tangent.apply(&positions);
        for v in mesh.border_vertices().ids() {
            let valence = mesh.vertex_faces(v).len();
            let (a, b) = (first[v.index()], second[v.index()]);
            let sine = a.cross(&b).dot(&outwards) / (a.norm() * b.norm());
            assert!(sine > 0.05, "vertex {} of {valence} faces: {sine}", v.0);
            assert!(a.dot(&outwards).abs() + b.dot(&outwards).abs() < 1e-13);
        }
    }
}

#[test]
fn control_points_converge_to_the_limit_by_four_per_level() {
    let (mesh, positions) = icosahedron();
    let distances: Vec<f64> = (1..=4)
        .map(|level| {
            let fine = refine(&mesh, level);
            let control = fine.fine_from_coarse.apply(&positions);
            let limit = limit_rows(&fine.mesh, &fine.corners)
                .position
                .apply(&control);
            let distance = control.iter().zip(&limit).map(|(c, l)| (c - l).norm());
            distance.fold(0.0, f64::max)
        })
        .collect();
    for pair in distances.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.3..4.7).contains(&ratio), "{ratio}");
    }
}

#[test]
fn an_icosahedron_becomes_nearly_a_sphere() {
    let (mesh, positions) = icosahedron();
    let fine = refine(&mesh, 4);
    let control = fine.fine_from_coarse.apply(&positions);
    let limit = limit_rows(&fine.mesh, &fine.corners)
        .position
        .apply(&control);
    let radii = || limit.iter().map(|p| p.norm());
    let (low, high) = (
        radii().fold(f64::MAX, f64::min),
        radii().fold(0.0, f64::max),
    );
    assert!(high / low < 1.03, "{low} {high}");
    let normals = limit_normals(&fine.mesh, &fine.corners, &control);
    for (normal, p) in normals.iter().zip(&limit) {
        assert!(normal.dot(&p.normalize()) > 0.998);
    }
}

#[test]
fn faces_and_vertices_follow_the_documented_numbering() {
    let (mesh, _) = disc(7);
    let levels: Vec<Subdivision> = (0..=3).map(|level| refine(&mesh, level)).collect();
    for (level, fine) in levels.iter().enumerate() {
        assert_eq!(fine.mesh.face_count(), mesh.face_count() << (2 * level));
        for (face, origin) in fine.origins.iter() {
            assert_eq!(origin.face, FaceId(face.0 >> (2 * level)));
        }
    }
    // Between two levels: face f of level 3 lies in face f >> 4 of level 1.
    let further = refine(&levels[1].mesh, 2);
    assert_eq!(further.mesh.faces(), levels[3].mesh.faces());
    for (face, origin) in further.origins.iter() {
        assert_eq!(origin.face.0, face.0 >> 4);
        let through = levels[1].origins[origin.face].lift(origin.corners[2]);
        let direct = levels[3].origins[face].corners[2];
        let difference = (0..3).map(|i| (through[i] - direct[i]).abs());
        assert!(difference.fold(0.0, f64::max) < 1e-15);
    }
}

#[test]
fn every_face_gives_a_fine_vertex_the_same_place_in_the_coarse_mesh() {
    let (mesh, positions) = disc(8);
    let fine = refine(&mesh, 3);
    let mut places: Vec<Option<Vector3<f64>>> = vec![None; fine.mesh.vertex_count()];
    for (face, origin) in fine.origins.iter() {
        let coarse = mesh.faces()[origin.face].map(|v| positions[v.index()]);
        for (corner, vertex) in fine.mesh.faces()[face].into_iter().enumerate() {
            let b = origin.corners[corner];
            let place = coarse[0] * b[0] + coarse[1] * b[1] + coarse[2] * b[2];
            let known = places[vertex.index()].get_or_insert(place);
            assert!((*known - place).norm() < 1e-14);
        }
    }
    // The vertices of the coarse mesh come first.
    for (place, position) in places.iter().zip(&positions) {
        assert_eq!(*place, Some(*position));
    }
}
