//! What a natural curvature makes of a layer's energy, and what it must leave alone.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod differences;
mod free_sheets;
mod meshes;
mod sheets;

use differences::{assembled, check_layer};
use free_sheets::{bare, disc, free_layer, in_frames};
use meshes::{Mesh, random_rotation, random_vector, rng, symmetric};
use nalgebra::{Matrix2, Rotation2, Vector3};
use ruga_shell::{
    BendingModel, Crease, FoldSense, LayerEnergy, LayerParameters, MAX_NATURAL_ANGLE, ShellError,
    UpperSheet,
};

/// A point of the plane z = 0 laid on a cylinder of curvature `k`, its axis turned by `angle`.
fn rolled(p: &Vector3<f64>, k: f64, angle: f64) -> Vector3<f64> {
    let turn = Rotation2::new(angle);
    let along = turn.inverse() * p.xy();
    let plan = turn * nalgebra::Vector2::new((k * along.x).sin() / k, along.y);
    Vector3::new(plan.x, plan.y, ((k * along.x).cos() - 1.0) / k)
}

/// Curvature `k` in the direction that [`rolled`] bends.
fn across_axis(k: f64, angle: f64) -> Matrix2<f64> {
    let turn = Rotation2::new(angle).into_inner();
    turn * Matrix2::new(k, 0.0, 0.0, 0.0) * turn.transpose()
}

fn random_tensors(count: usize, scale: f64, seed: u64) -> Vec<Matrix2<f64>> {
    let mut rng = rng(seed);
    let tensor = |_| {
        let mixed = symmetric(&mut rng);
        scale * Matrix2::new(symmetric(&mut rng), mixed, mixed, symmetric(&mut rng))
    };
    (0..count).map(tensor).collect()
}

#[test]
fn derivatives_with_curvature_and_changed_material() {
    let (mut layer, x) = assembled(BendingModel::VertexCurvature);
    let faces = layer.face_energies(&x, &x)[0].len();
    layer
        .set_natural_curvatures(&random_tensors(faces, 0.4, 31))
        .unwrap();
    check_layer(&layer, &x);
    let mut rng = rng(32);
    let mut changed = vec![bare(8.0, 0.4, 0.4); faces];
    for face in &mut changed {
        face.young += 4.0 * symmetric(&mut rng);
        face.thickness += 0.2 * symmetric(&mut rng);
        face.poisson += 0.1 * symmetric(&mut rng);
        face.normal_stiffness = 1.0 + symmetric(&mut rng);
        face.gradient_stiffness = 0.4 * symmetric(&mut rng);
    }
    layer.set_face_parameters(&changed).unwrap();
    let left = (0..faces).map(|_| 0.52 + 0.48 * symmetric(&mut rng));
    layer.set_area_left(&left.collect::<Vec<_>>()).unwrap();
    check_layer(&layer, &x);
}

#[test]
fn a_cylinder_of_the_natural_curvature_is_not_bent() {
    let mesh = disc(20, 0, 0.25, 4);
    for poisson in [0.0, 0.3, 0.48] {
        // A bending stiffness of 1 N m: energies are shares of it.
        let face = bare(12.0 * (1.0 - poisson * poisson), poisson, 1.0);
        let mut layer = free_layer(&mesh, face);
        for angle in [0.0, 0.4, 1.1] {
            let mut energy = |k: f64| {
                let natural = in_frames(&mesh, |_| across_axis(k, angle));
                assert_eq!(layer.set_natural_curvatures(&natural).unwrap(), 0);
                let x: Vec<_> = mesh.positions.iter().map(|p| rolled(p, k, angle)).collect();
                layer.energy_parts(&x).bending
            };
            let found = energy(0.1);
            assert!(found < 1e-10, "{poisson} {angle}: {found:e}");
            // Of third order in curvature times edge, so that it counts for nothing on a fine mesh.
            let twice = energy(0.2) / found;
            assert!((twice / 64.0 - 1.0).abs() < 0.05, "{twice}");
        }
    }
}

#[test]
fn rigid_motions_cost_nothing() {
    let mesh = disc(6, 0, 0.25, 5);
    let mut layer = free_layer(&mesh, bare(2.0, 0.3, 0.3));
    layer
        .set_natural_curvatures(&random_tensors(mesh.faces.len(), 1.0, 33))
        .unwrap();
    let mut rng = rng(34);
    let x: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| p + 0.1 * random_vector(&mut rng))
        .collect();
    let value = layer.value(&x);
    let turn = random_rotation(&mut rng);
    let shift = random_vector(&mut rng);
    let moved: Vec<_> = x.iter().map(|p| turn * p + shift).collect();
    assert!((layer.value(&moved) / value - 1.0).abs() < 1e-12);
    let mut gradient = vec![0.0; layer.dof_count()];
    layer.gradient(&x, &mut gradient);
    let forces: Vec<_> = gradient
        .chunks_exact(3)
        .map(Vector3::from_column_slice)
        .collect();
    let size: f64 = forces.iter().map(Vector3::norm).sum();
    let sum: Vector3<f64> = forces.iter().sum();
    let moment: Vector3<f64> = x.iter().zip(&forces).map(|(x, f)| x.cross(f)).sum();
    assert!(sum.norm() < 1e-12 * size && moment.norm() < 1e-12 * size);
}

/// A cylinder as the surface that a layer is built on, and as its natural shape.
#[test]
fn curvature_adds_to_rest_angles() {
    let mesh = disc(12, 0, 0.25, 6);
    let k = 0.05;
    let natural = in_frames(&mesh, |_| across_axis(k, 0.3));
    let bent = |k: f64| -> Vec<_> { mesh.positions.iter().map(|p| rolled(p, k, 0.3)).collect() };
    let mut layer = free_layer(&mesh, bare(12.0, 0.0, 1.0));
    let flat = layer.energy_parts(&bent(2.0 * k)).bending;
    layer.set_rest_angles(&bent(k)).unwrap();
    layer.set_natural_curvatures(&natural).unwrap();
    let both = layer.energy_parts(&bent(2.0 * k)).bending;
    assert!(both < 1e-6 * flat, "{both:e} of {flat:e}");
    // In the other order as well.
    layer.set_rest_angles(&mesh.positions).unwrap();
    let found = layer.energy_parts(&bent(k)).bending;
    assert!(found < 1e-6 * flat, "{found:e} of {flat:e}");
}

#[test]
fn no_curvature_leaves_the_energy_to_the_bit() {
    let (mut layer, x) = assembled(BendingModel::VertexCurvature);
    let faces = layer.face_energies(&x, &x)[0].len();
    let before = layer.value(&x);
    let natural = random_tensors(faces, 0.3, 35);
    layer.set_natural_curvatures(&natural).unwrap();
    assert_ne!(layer.value(&x), before);
    let zero = vec![Matrix2::zeros(); faces];
    assert_eq!(layer.set_natural_curvatures(&zero), Ok(0));
    assert_eq!(layer.value(&x), before);
}

/// On a mesh that shrank a curvature is one per new metre.
#[test]
fn the_tensors_outlive_a_rest_metric() {
    let mesh = disc(12, 0, 0.25, 7);
    let stretch = Matrix2::new(0.7, 0.1, 0.1, 0.8);
    let face = bare(12.0, 0.3, 1.0);
    let k = 0.1;
    let mut layer = free_layer(&mesh, face);
    // In the frames of the faces as built, which the stretch does not turn.
    let tensor = |_: &Vector3<f64>| across_axis(k, 0.5);
    layer
        .set_natural_curvatures(&in_frames(&mesh, tensor))
        .unwrap();
    layer
        .set_rest_metric(&in_frames(&mesh, |_| stretch))
        .unwrap();
    let x: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| {
            let shrunk = stretch * p.xy();
            rolled(&Vector3::new(shrunk.x, shrunk.y, 0.0), k, 0.5)
        })
        .collect();
    let found = layer.energy_parts(&x).bending;
    assert!(found < 1e-8, "{found:e}");
    layer
        .set_rest_metric(&in_frames(&mesh, |_| Matrix2::identity()))
        .unwrap();
    let x: Vec<_> = mesh.positions.iter().map(|p| rolled(p, k, 0.5)).collect();
    let found = layer.energy_parts(&x).bending;
    assert!(found < 1e-8, "{found:e}");
}

fn mirrored(mesh: &Mesh) -> Mesh {
    let positions = mesh.positions.iter();
    Mesh {
        positions: positions.map(|p| Vector3::new(p.x, -p.y, p.z)).collect(),
        faces: mesh.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// A sheet that twists to the left and its mirror image, which twists to the right.
#[test]
fn a_mirrored_sheet_has_mirrored_forces() {
    let mesh = disc(6, 0, 0.25, 8);
    let other = mirrored(&mesh);
    let tensor = |p: &Vector3<f64>| Matrix2::new(0.3, 0.2 * p.x, 0.2 * p.x, -0.1);
    let opposite = |p: &Vector3<f64>| {
        let k = tensor(&Vector3::new(p.x, -p.y, p.z));
        Matrix2::new(k.m11, -k.m12, -k.m21, k.m22)
    };
    let face = bare(3.0, 0.3, 0.3);
    let [mut layer, mut image] = [&mesh, &other].map(|mesh| free_layer(mesh, face));
    layer
        .set_natural_curvatures(&in_frames(&mesh, tensor))
        .unwrap();
    image
        .set_natural_curvatures(&in_frames(&other, opposite))
        .unwrap();
    let mut rng = rng(36);
    let moved = mesh
        .positions
        .iter()
        .map(|p| p + 0.1 * random_vector(&mut rng));
    let x: Vec<_> = moved.collect();
    let y: Vec<_> = x.iter().map(|p| Vector3::new(p.x, -p.y, p.z)).collect();
    let gradient = |layer: &LayerEnergy, x: &[Vector3<f64>]| {
        let mut gradient = vec![0.0; layer.dof_count()];
        layer.gradient(x, &mut gradient);
        gradient
    };
    let (found, expected) = (gradient(&image, &y), gradient(&layer, &x));
    let largest = expected.iter().fold(0.0, |top: f64, g| top.max(g.abs()));
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let sign = if i % 3 == 1 { -1.0 } else { 1.0 };
        assert!((sign * found - expected).abs() < 1e-12 * largest);
    }
}

/// Wound the other way round, a sheet has its crests where it had valleys.
#[test]
fn a_sheet_turned_over_has_the_opposite_curvature() {
    let mesh = disc(6, 0, 0.25, 9);
    let over = Mesh {
        positions: mesh.positions.clone(),
        faces: mesh.faces.iter().map(|&[a, b, c]| [b, a, c]).collect(),
    };
    let tensor = |p: &Vector3<f64>| Matrix2::new(0.3, 0.2 * p.x, 0.2 * p.x, -0.1);
    let face = bare(3.0, 0.3, 0.3);
    let [mut layer, mut turned] = [&mesh, &over].map(|mesh| free_layer(mesh, face));
    layer
        .set_natural_curvatures(&in_frames(&mesh, tensor))
        .unwrap();
    turned
        .set_natural_curvatures(&in_frames(&over, |p| -tensor(p)))
        .unwrap();
    let mut rng = rng(37);
    let moved = mesh
        .positions
        .iter()
        .map(|p| p + 0.1 * random_vector(&mut rng));
    let x: Vec<_> = moved.collect();
    assert!((turned.value(&x) / layer.value(&x) - 1.0).abs() < 1e-12);
}

#[test]
fn faces_that_ask_for_too_much_are_capped() {
    let mesh = disc(10, 0, 0.25, 10);
    let faces = mesh.faces.len();
    let mut layer = free_layer(&mesh, bare(12.0, 0.3, 1.0));
    let natural = |k: f64| in_frames(&mesh, |_| Matrix2::from_diagonal_element(k));
    // Edges of a tenth bend by 0.06 rad, the longest by twice that.
    assert_eq!(layer.set_natural_curvatures(&natural(1.0)), Ok(0));
    assert_eq!(layer.set_natural_curvatures(&natural(100.0)), Ok(faces));
    let capped = layer.value(&mesh.positions);
    assert_eq!(layer.set_natural_curvatures(&natural(1000.0)), Ok(faces));
    assert!((layer.value(&mesh.positions) / capped - 1.0).abs() < 1e-12);
    // Some edges are twice as long as others. On a mesh that shrinks, all are within the cap again.
    let few = layer.set_natural_curvatures(&natural(5.0)).unwrap();
    assert!(few > 0 && few < faces, "{few}");
    let halved = vec![Matrix2::from_diagonal_element(0.2); faces];
    layer.set_rest_metric(&halved).unwrap();
    assert_eq!(layer.capped_faces(), 0);
    assert_eq!(MAX_NATURAL_ANGLE, 0.35);
}

/// With a crease that nothing bends, the layer is as without it; with a soft one the curvature folds it.
#[test]
fn creases_count_from_the_natural_angles() {
    let mesh = disc(8, 0, 0.1, 11);
    let topology = mesh.topology();
    let mut layer = free_layer(&mesh, bare(12.0, 0.3, 1.0));
    let k = 0.05;
    let natural = in_frames(&mesh, |_| across_axis(k, 0.0));
    layer.set_natural_curvatures(&natural).unwrap();
    let x: Vec<_> = mesh.positions.iter().map(|p| rolled(p, k, 0.0)).collect();
    let plain = layer.value(&x);
    let bent = layer.value(&mesh.positions);
    let near = |v: ruga_mesh::VertexId| mesh.positions[v.0 as usize].norm() < 0.3;
    let edges = topology.edges();
    let creases: Vec<_> = edges
        .iter()
        .filter(|(_, edge)| edge.vertices.iter().all(|&v| near(v)))
        .map(|(id, _)| {
            let crease = Crease {
                compliance: 1.0,
                rest_angle: 0.0,
                sense: FoldSense::Both,
            };
            (id, crease)
        })
        .collect();
    layer.set_creases(&creases).unwrap();
    assert!((layer.value(&x) - plain).abs() < 1e-8 * bent);
    // Held flat, the folds give way to the moment that the curvature makes.
    assert!(layer.value(&mesh.positions) < 0.99 * bent);
    let mut rng = rng(38);
    let moved: Vec<_> = x
        .iter()
        .map(|p| p + 0.02 * random_vector(&mut rng))
        .collect();
    check_layer(&layer, &moved);
}

#[test]
fn what_cannot_curl_says_so() {
    let mesh = disc(2, 0, 0.0, 12);
    let faces = mesh.faces.len();
    let zero = vec![Matrix2::zeros(); faces];
    let face = bare(1.0, 0.3, 0.1);
    let mut hinges = mesh.layer(face, BendingModel::Hinge);
    let error = hinges.set_natural_curvatures(&zero).unwrap_err();
    assert_eq!(error, ShellError::CurvatureOnHinges);
    assert!(error.to_string().contains("VertexCurvature"), "{error}");

    let count = mesh.positions.len();
    let parameters = LayerParameters::uniform(face, faces, 0.0, count);
    let upper = UpperSheet {
        rest_positions: mesh
            .positions
            .iter()
            .map(|p| p + 0.1 * Vector3::z())
            .collect(),
        parameters: parameters.clone(),
        offsets: vec![0.1; count],
    };
    let (topology, pinned) = (mesh.topology(), vec![false; count]);
    let at_rest = (&topology, mesh.positions.as_slice(), pinned.as_slice());
    let model = BendingModel::VertexCurvature;
    let mut pair = LayerEnergy::pair(at_rest, parameters, upper, model).unwrap();
    let what = "a natural curvature";
    let error = pair.set_natural_curvatures(&zero).unwrap_err();
    assert_eq!(error, ShellError::PairOfSheets { what });

    let mut layer = free_layer(&mesh, face);
    let before = layer.value(&mesh.positions);
    assert!(matches!(
        layer.set_natural_curvatures(&zero[1..]),
        Err(ShellError::LengthMismatch { expected, found, .. }) if found + 1 == expected
    ));
    for value in [f64::NAN, f64::INFINITY] {
        let mut bad = zero.clone();
        bad[3].m22 = value;
        let error = layer.set_natural_curvatures(&bad).unwrap_err();
        assert!(error.to_string().contains("face 3"), "{error}");
    }
    let mut bad = zero.clone();
    bad[2] = Matrix2::new(1.0, 0.5, 0.4, 1.0);
    assert_eq!(
        layer.set_natural_curvatures(&bad),
        Err(ShellError::AsymmetricCurvature {
            face: 2,
            xy: 0.5,
            yx: 0.4
        })
    );
    assert_eq!(layer.value(&mesh.positions), before);
}
