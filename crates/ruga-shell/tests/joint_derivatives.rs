//! The springs between two layers, and both layers with them, against central differences.

mod differences;
mod meshes;

use differences::{MODELS, assembled, check_layer, check_stencil, dense, full, rest_corners};
use meshes::{jittered, random_rotation, random_vector, rng, symmetric};
use nalgebra::{Matrix2, Vector3};
use ruga_shell::{
    BendingModel, FaceParameters, LayerEnergy, LayerParameters, LayerSpringParameters,
    LayerSpringState, LayerSprings, RestTriangle, UpperSheet,
};

/// Springs on a face from equilateral to a sliver, and six points that strain them: the lower
/// face strained and turned, the upper corners off by up to 1.5 offsets in any direction.
fn strained_springs(seed: u64, gradient: f64) -> (LayerSprings, [Vector3<f64>; 6]) {
    let mut rng = rng(5000 + seed);
    let corners = rest_corners(seed);
    let rest = RestTriangle::new(&corners, 0).expect("thin but not degenerate");
    let parameters = LayerSpringParameters {
        normal_stiffness: 2.0,
        gradient_stiffness: gradient,
        tangential_stiffness: 1.5,
    };
    let offsets = [0.4, 0.5, 0.45];
    let springs = LayerSprings::new(&rest, &parameters, offsets);
    let turn = random_rotation(&mut rng);
    let height = rest.seen_from_edge(0).2;
    let noise = 0.2 * height;
    let lower = corners.map(|p| turn * (p + random_vector(&mut rng) * noise));
    let normal = (lower[1] - lower[0])
        .cross(&(lower[2] - lower[0]))
        .normalize();
    let deviation = [0.7, 0.1, 1e-3][seed as usize % 3];
    let upper =
        |i: usize, rng: &mut _| lower[i] + normal * offsets[i] + random_vector(rng) * deviation;
    let upper: [_; 3] = std::array::from_fn(|i| upper(i, &mut rng));
    let x = std::array::from_fn(|i| if i < 3 { lower[i] } else { upper[i - 3] });
    (springs, x)
}

#[test]
fn layer_springs() {
    for seed in 0..60 {
        let (springs, x) = strained_springs(seed, if seed % 2 == 0 { 0.3 } else { -0.3 });
        let height = (x[1] - x[0]).cross(&(x[2] - x[0])).norm() / (x[1] - x[0]).norm();
        let (value, gradient) = (
            |y: &_| springs.values(y).iter().sum::<f64>(),
            |y: &_| springs.gradient(y),
        );
        check_stencil(
            &x,
            1e-3 * height,
            value,
            gradient,
            &springs.hessian(&x),
            &format!("springs {seed}"),
        );
    }
}

#[test]
fn relaxed_springs_are_positive_and_equal_the_exact_ones_unstrained() {
    let mut indefinite = 0;
    for seed in 0..60 {
        let (springs, x) = strained_springs(seed, 0.3);
        let relaxed = full::<6, 21>(&springs.gauss_newton(&LayerSpringState::new(&x)));
        let values = relaxed.symmetric_eigenvalues();
        assert!(values.min() > -1e-12 * values.max(), "{values}");
        let exact = full::<6, 21>(&springs.hessian(&x)).symmetric_eigenvalues();
        indefinite += usize::from(exact.min() < -1e-6 * exact.max());

        let lower = [x[0], x[1], x[2]];
        let normal = (x[1] - x[0]).cross(&(x[2] - x[0])).normalize();
        let upper: [_; 3] = std::array::from_fn(|i| lower[i] + normal * [0.4, 0.5, 0.45][i]);
        let unstrained = std::array::from_fn(|i| if i < 3 { lower[i] } else { upper[i - 3] });
        let relaxed = full::<6, 21>(&springs.gauss_newton(&LayerSpringState::new(&unstrained)));
        let exact = full::<6, 21>(&springs.hessian(&unstrained));
        assert!((exact - &relaxed).amax() < 1e-11 * relaxed.amax());
    }
    assert!(indefinite > 30, "{indefinite} of 60 states were telling");
}

#[test]
fn springs_on_a_collapsed_face_stay_finite() {
    let (springs, x) = strained_springs(0, 0.3);
    let on_a_line = [x[0], x[1], 0.5 * (x[0] + x[1]), x[3], x[4], x[5]];
    let in_a_point = [x[0], x[0], x[0], x[0], x[0], x[0]];
    for x in [on_a_line, in_a_point] {
        assert!(springs.values(&x).iter().all(|c| c.is_finite()));
        assert!(springs.gradient(&x).iter().flatten().all(|c| c.is_finite()));
        assert!(springs.hessian(&x).iter().flatten().all(|c| c.is_finite()));
    }
}

/// The crumpled layer with another sheet on it, as crumpled, the rest metric stretched.
fn assembled_joint(model: BendingModel) -> (LayerEnergy, Vec<Vector3<f64>>) {
    let (crumpled, below) = assembled(model);
    let mesh = jittered(7, 6, 1.0, 0.25, 11);
    let mut rng = rng(13);
    let (faces, count) = (mesh.faces.len(), below.len());
    let face = FaceParameters {
        young: 20.0,
        poisson: 0.3,
        thickness: 0.2,
        normal_stiffness: 0.0,
        gradient_stiffness: -0.2,
    };
    let mut upper = LayerParameters::uniform(face, faces, 0.0, count);
    for face in &mut upper.faces {
        face.normal_stiffness = 6.0 + symmetric(&mut rng);
    }
    for stiffness in &mut upper.tangential_stiffness {
        *stiffness = 4.0 + symmetric(&mut rng);
    }
    let mut pinned = vec![true; count];
    for &vertex in crumpled.free_vertices() {
        pinned[vertex as usize] = false;
    }
    let offsets = below.iter().map(|_| 0.3 + 0.1 * symmetric(&mut rng));
    let upper = UpperSheet {
        rest_positions: mesh.positions.clone(),
        parameters: upper,
        offsets: offsets.collect(),
    };
    let lower = LayerParameters::uniform(
        FaceParameters {
            normal_stiffness: 3.0,
            ..face
        },
        faces,
        2.0,
        count,
    );
    let on = (&mesh.topology(), &mesh.positions[..], &pinned[..]);
    let mut joint = LayerEnergy::pair(on, lower, upper, model).expect("valid input");
    let mut stretch =
        |_: &_| Matrix2::identity() * 0.9 + Matrix2::from_fn(|_, _| 0.1 * symmetric(&mut rng));
    let stretches: Vec<_> = mesh.faces.iter().map(&mut stretch).collect();
    joint.set_rest_metric(&stretches).expect("valid input");
    let above: Vec<_> = below
        .iter()
        .map(|p| p + Vector3::z() * 0.3 + 0.2 * random_vector(&mut rng))
        .collect();
    (joint, [below, above].concat())
}

#[test]
fn assembled_pair() {
    for model in MODELS {
        check_pair(model);
    }
}

fn check_pair(model: BendingModel) {
    let (joint, x) = assembled_joint(model);
    let mut exact = vec![7.0; joint.pattern().1.len()];
    let mut again = exact.clone();
    let mut relaxed = exact.clone();
    joint.hessian(&x, &mut exact, None);
    joint.hessian(&x, &mut again, Some(&mut relaxed));
    assert_eq!(exact, again);
    check_layer(&joint, &x);
}

#[test]
fn relaxed_pair_is_positive_where_the_exact_one_is_not() {
    for model in MODELS {
        check_relaxed_pair(model);
    }
}

fn check_relaxed_pair(model: BendingModel) {
    let (joint, x) = assembled_joint(model);
    let squeezed: Vec<_> = x.iter().map(|p| 0.7 * p).collect();
    let mut exact = vec![0.0; joint.pattern().1.len()];
    let mut relaxed = exact.clone();
    joint.hessian(&squeezed, &mut exact, Some(&mut relaxed));
    let least = |values: &[f64]| dense(joint.pattern(), values).symmetric_eigenvalues().min();
    assert!(least(&exact) < 0.0);
    // Both K1 are negative here; both K0 and the rest outweigh them.
    assert!(least(&relaxed) > 0.0);
}
