//! Edges that are folded almost shut.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod differences;
mod meshes;

use std::f64::consts::PI;

use differences::check_layer;
use meshes::{random_vector, rng};
use nalgebra::{Rotation3, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};

/// Two squares that share an edge along y, and where their vertices are when the right one is turned up by
/// `angle` (rad).
fn folded(angle: f64) -> Vec<Vector3<f64>> {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), -angle);
    let flat = [-1.0, 0.0, 1.0]
        .into_iter()
        .flat_map(|x| [[x, 0.0], [x, 1.0]]);
    flat.map(|[x, y]| match x > 0.0 {
        true => turn * Vector3::new(x, y, 0.0),
        false => Vector3::new(x, y, 0.0),
    })
    .collect()
}

/// The squares as a layer that is at rest where it is folded by `rest` (rad).
fn pair(rest: f64) -> LayerEnergy {
    let faces = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]];
    let mesh = TriMesh::new(6, faces).unwrap();
    let face = FaceParameters {
        young: 1.0,
        poisson: 0.3,
        thickness: 0.01,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let parameters = LayerParameters {
        faces: vec![face; 4],
        tangential_stiffness: vec![0.0; 6],
    };
    let (flat, model) = (folded(0.0), BendingModel::VertexCurvature);
    let mut layer =
        LayerEnergy::with_bending(&mesh, &flat, parameters, &[false; 6], model).unwrap();
    layer.set_rest_angles(&folded(rest)).unwrap();
    layer
}

fn bending(layer: &LayerEnergy, angle: f64) -> f64 {
    layer.energy_parts(&folded(angle)).bending
}

#[test]
fn derivatives_match_differences() {
    let layer = pair(0.3);
    for (seed, angle) in (0..).zip([2.2, -2.5, 2.8, 3.0]) {
        let mut rng = rng(6000 + seed);
        let shaken = folded(angle).into_iter();
        let x: Vec<_> = shaken.map(|p| p + random_vector(&mut rng) * 0.02).collect();
        check_layer(&layer, &x);
    }
}

#[test]
fn energy_grows_until_a_fold_is_shut() {
    let layer = pair(0.0);
    let energies: Vec<f64> = (0..=31)
        .map(|i| bending(&layer, 0.1 * f64::from(i)))
        .collect();
    assert!(
        energies.windows(2).all(|pair| pair[0] < pair[1]),
        "{energies:?}"
    );
    // Up to two radians it is the plate's own; then it resists many times as much.
    let plain = |angle: f64| energies[10] * angle * angle;
    assert!((energies[20] / plain(2.0) - 1.0).abs() < 1e-9);
    assert!(energies[31] > 4.0 * plain(3.1), "{energies:?}");
    // Both senses alike.
    assert!((bending(&layer, -2.9) / energies[29] - 1.0).abs() < 1e-9);
}

#[test]
fn a_fold_that_is_drawn_almost_shut_may_close() {
    let layer = pair(PI - 0.05);
    // Just past shut its angle is almost a whole turn away from rest, but not its bend.
    let [before, after] = [-1e-6, 1e-6].map(|past| bending(&layer, PI + past));
    assert!((after / before - 1.0).abs() < 1e-3, "{before} {after}");
    let plain = bending(&layer, PI - 0.1);
    assert!((before / plain - 1.0).abs() < 1e-3, "{before} {plain}");
}
