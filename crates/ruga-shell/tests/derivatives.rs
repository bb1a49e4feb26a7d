//! Every gradient and Hessian against central differences, relative tolerance 1e-6.

mod differences;
mod meshes;

use differences::{MODELS, assembled, check_layer, check_stencil, dense, flat, full, rest_corners};
use meshes::{random_rotation, random_vector, rng, symmetric};
use nalgebra::{DMatrix, Matrix2, Vector3};
use ruga_shell::{
    Anchor, BendingModel, Hinge, HingeState, Membrane, NormalFoundation, RestTriangle, Stress,
    TangentialSpring,
};

#[test]
fn membrane() {
    for seed in 0..40 {
        let mut rng = rng(1000 + seed);
        let rest = RestTriangle::new(&rest_corners(seed), 0).unwrap();
        let shear = 1e-3 * seed as f64;
        let natural = Matrix2::new(0.1, shear, shear, -0.2);
        let membrane = Membrane::new(&rest, 2.5, 0.48).with_natural_strain(natural);
        let turn = random_rotation(&mut rng);
        let noise = if seed % 2 == 0 { 0.3 } else { 1e-3 };
        let height = rest.seen_from_edge(0).2;
        let x = rest_corners(seed).map(|p| turn * p + random_vector(&mut rng) * (noise * height));
        let hessian = membrane.hessian(&x, Stress::Full);
        let (value, gradient) = (|y: &_| membrane.value(y), |y: &_| membrane.gradient(y));
        check_stencil(&x, 2e-3 * height, value, gradient, &hessian, "membrane");
    }
}

#[test]
fn membrane_that_is_about_to_collapse() {
    for seed in 0..40 {
        let mut rng = rng(5000 + seed);
        let corners = [[0.0, 0.0], [1.1, 0.0], [0.4, 0.9]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let rest = RestTriangle::new(&corners, 0).unwrap();
        let natural = Matrix2::new(0.1, 0.02, 0.02, -0.2);
        let membrane = Membrane::new(&rest, 2.5, 0.48).with_natural_strain(natural);
        let turn = random_rotation(&mut rng);
        // From a third of the area down to a thousandth.
        let share = 0.25 * 0.87_f64.powi(seed as i32);
        let x = corners.map(|p| turn * Vector3::new(p.x + 0.1 * p.y, share * p.y, 0.0));
        let hessian = membrane.hessian(&x, Stress::Full);
        let (value, gradient) = (|y: &_| membrane.value(y), |y: &_| membrane.gradient(y));
        let step = 2e-3 * share;
        check_stencil(
            &x,
            step,
            value,
            gradient,
            &hessian,
            &format!("membrane {seed}"),
        );
        let relaxed = full::<3, 6>(&membrane.hessian(&x, Stress::Tensile));
        let values = relaxed.clone().symmetric_eigenvalues();
        assert!(values.min() > -1e-12 * values.max(), "{values}");
    }
}

#[test]
fn membrane_resists_more_and_more_until_it_has_no_area() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.8]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let rest = RestTriangle::new(&corners, 0).unwrap();
    let membrane = Membrane::new(&rest, 1.0, 0.3);
    let value = |share: f64| membrane.value(&corners.map(|p| Vector3::new(p.x, share * p.y, p.z)));
    let slopes = (0..4).map(|k| 0.1 * f64::from(k));
    let slopes: Vec<f64> = slopes
        .map(|s| (value(s + 0.01) - value(s)) / 0.01)
        .collect();
    assert!(
        slopes.windows(2).all(|pair| pair[0] < pair[1]),
        "{slopes:?}"
    );
    assert!(slopes[3] < 0.0, "{slopes:?}");
}

#[test]
fn relaxed_membrane_is_positive_and_equals_the_exact_one_in_tension() {
    for seed in 0..40 {
        let mut rng = rng(2000 + seed);
        let corners = rest_corners(seed);
        let rest = RestTriangle::new(&corners, 0).unwrap();
        let membrane = Membrane::new(&rest, 1.0, 0.3);
        let any = corners.map(|p| 0.8 * p + random_vector(&mut rng) * 0.2);
        let relaxed = full::<3, 6>(&membrane.hessian(&any, Stress::Tensile));
        let values = relaxed.clone().symmetric_eigenvalues();
        assert!(values.min() > -1e-12 * values.max(), "{values}");
        let stretched = corners.map(|p| p * 1.2);
        let exact = full::<3, 6>(&membrane.hessian(&stretched, Stress::Full));
        let same = full::<3, 6>(&membrane.hessian(&stretched, Stress::Tensile));
        assert!((exact.clone() - same).amax() <= 1e-14 * exact.amax());
    }
}

#[test]
fn relaxed_membrane_replaces_the_stress_by_its_positive_part() {
    // Stretched along x, compressed along y: the y stress must drop out of the geometric part.
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let rest = RestTriangle::new(&corners, 0).unwrap();
    let membrane = Membrane::new(&rest, 1.0, 0.0);
    let x = corners.map(|p| Vector3::new(1.2 * p.x, 0.8 * p.y, 0.0));
    let exact = membrane.hessian(&x, Stress::Full);
    let relaxed = membrane.hessian(&x, Stress::Tensile);
    // zz entries of the blocks of corners 1 and 2: A S_xx and A S_yy.
    assert!((exact[2].m33 - 0.5 * 0.22).abs() < 1e-15);
    assert!((exact[5].m33 + 0.5 * 0.18).abs() < 1e-15);
    assert!((relaxed[2].m33 - 0.5 * 0.22).abs() < 1e-15);
    assert!(relaxed[5].m33.abs() < 1e-15);
}

/// The blocks of a membrane's Hessian in the state at `x` whose stress is predicted at `from`, or that of its own.
fn predicted(
    membrane: &Membrane,
    from: Option<&[Vector3<f64>; 3]>,
    x: &[Vector3<f64>; 3],
) -> DMatrix<f64> {
    let state = match from {
        Some(from) => membrane.predicted_state(from, x),
        None => membrane.state(x),
    };
    full::<3, 6>(&membrane.with_stress(&membrane.material_blocks(&state), &state, Stress::Full))
}

#[test]
fn a_straight_step_that_turns_a_face_predicts_no_stress() {
    for seed in 0..40 {
        let mut rng = rng(6000 + seed);
        let corners = rest_corners(seed);
        let rest = RestTriangle::new(&corners, 0).unwrap();
        let membrane = Membrane::new(&rest, 2.5, 0.3);
        let turn = random_rotation(&mut rng);
        let from = corners.map(|p| turn * p);
        let axis = 0.3 * random_vector(&mut rng).normalize();
        let x = from.map(|p| p + axis.cross(&p));
        let [h11, h21, h22] = membrane.material_blocks(&membrane.state(&x));
        let (h10, h20) = (-(h11 + h21.transpose()), -(h21 + h22));
        let material = full::<3, 6>(&[-(h10 + h20), h10, h11, h20, h21, h22]);
        let size = material.amax();
        let found = predicted(&membrane, Some(&from), &x);
        assert!((found - &material).amax() < 1e-12 * size);
        // With its own stress the face is stiffer.
        let stretched = predicted(&membrane, None, &x);
        assert!((stretched - material).amax() > 1e-3 * size, "seed {seed}");
    }
}

/// From a stretched state, and along any step.
#[test]
fn predicted_stresses_are_off_by_the_square_of_the_step() {
    for seed in 0..40 {
        let mut rng = rng(7000 + seed);
        let corners = rest_corners(seed);
        let rest = RestTriangle::new(&corners, 0).unwrap();
        let natural = Matrix2::new(0.1, 0.02, 0.02, -0.1);
        let membrane = Membrane::new(&rest, 2.5, 0.3).with_natural_strain(natural);
        let height = rest.seen_from_edge(0).2;
        let mut away = |share: f64| corners.map(|_| random_vector(&mut rng) * (share * height));
        let (noise, step) = (away(0.1), away(0.1));
        let from = [0, 1, 2].map(|i| corners[i] + noise[i]);
        let error = |share: f64| {
            let x = [0, 1, 2].map(|i| from[i] + share * step[i]);
            let own = predicted(&membrane, None, &x);
            (predicted(&membrane, Some(&from), &x) - own).amax()
        };
        let ratio = error(1.0) / error(0.5);
        assert!((ratio - 4.0).abs() < 1e-6, "seed {seed}: {ratio}");
    }
}

/// A hinge with apex heights `heights`, folded by `angle`, somewhere in space.
fn folded(seed: u64, heights: [f64; 2], angle: f64) -> [Vector3<f64>; 4] {
    let mut rng = rng(seed);
    let turn = random_rotation(&mut rng);
    let feet = [symmetric(&mut rng), symmetric(&mut rng)];
    [
        Vector3::zeros(),
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(feet[0], heights[0], 0.0),
        Vector3::new(
            feet[1],
            -heights[1] * angle.cos(),
            -heights[1] * angle.sin(),
        ),
    ]
    .map(|p| turn * p + Vector3::new(3.0, -2.0, 1.0))
}

#[test]
fn hinge() {
    let heights = [[0.9, 0.8], [0.4, 1.0], [0.05, 0.7], [0.02, 0.02]];
    let angles = [0.0, 1e-7, 1e-3, 0.3, -0.9, 1.6, -2.4, 3.0];
    for (a, angle) in angles.into_iter().enumerate() {
        for (h, heights) in heights.into_iter().enumerate() {
            let x = folded((10 * a + h) as u64, heights, angle);
            assert!((HingeState::new(&x).angle() - angle).abs() < 1e-13);
            let hinge = Hinge {
                stiffness: 0.7,
                rest_angle: 0.2,
            };
            let hessian = hinge.hessian(&x);
            let step = 2e-3 * heights[0].min(heights[1]);
            let (value, gradient) = (|y: &_| hinge.value(y), |y: &_| hinge.gradient(y));
            check_stencil(
                &x,
                step,
                value,
                gradient,
                &hessian,
                &format!("hinge {angle}"),
            );

            let state = HingeState::new(&x);
            let g = flat(&state.angle_gradient());
            let relaxed = full::<4, 10>(&hinge.gauss_newton(&HingeState::new(&x)));
            let outer = &g * g.transpose() * 0.7;
            assert!((relaxed - &outer).amax() < 1e-14 * outer.amax());
        }
    }
}

#[test]
fn hinge_angle_is_continuous_through_flat_and_right_angles() {
    let mut last: Option<f64> = None;
    for k in -31..=31 {
        let angle = HingeState::new(&folded(7, [0.8, 0.6], 0.1 * f64::from(k))).angle();
        if let Some(last) = last {
            assert!((angle - last - 0.1_f64).abs() < 1e-12);
        }
        last = Some(angle);
    }
}

#[test]
fn collapsed_stencils_stay_finite() {
    let hinge = Hinge {
        stiffness: 1.0,
        rest_angle: 0.0,
    };
    let on_a_line = [0.0, 1.0, 0.5, 0.25].map(|x| Vector3::new(x, 0.0, 0.0));
    for x in [[Vector3::zeros(); 4], on_a_line] {
        assert!(hinge.value(&x).is_finite());
        assert!(
            hinge
                .gradient(&x)
                .iter()
                .all(|g| g.iter().all(|c| c.is_finite()))
        );
        let hessian = hinge.hessian(&x);
        assert!(hessian.iter().all(|b| b.iter().all(|c| c.is_finite())));
    }
    let membrane = Membrane::new(&RestTriangle::new(&rest_corners(0), 0).unwrap(), 1.0, 0.48);
    let no_area = membrane.with_natural_strain(Matrix2::new(0.1, 0.0, 0.0, -0.5));
    let line = [on_a_line[0], on_a_line[1], on_a_line[2]];
    for (membrane, x) in [membrane, no_area]
        .into_iter()
        .flat_map(|membrane| [[Vector3::zeros(); 3], line].map(|x| (membrane, x)))
    {
        assert!(membrane.value(&x).is_finite());
        let gradient = membrane.gradient(&x);
        assert!(gradient.iter().all(|g| g.iter().all(|c| c.is_finite())));
        for stress in [Stress::Full, Stress::Tensile] {
            let hessian = membrane.hessian(&x, stress);
            assert!(hessian.iter().all(|b| b.iter().all(|c| c.is_finite())));
        }
    }
}

#[test]
fn normal_foundation() {
    for seed in 0..12 {
        let mut rng = rng(3000 + seed);
        let rest = RestTriangle::new(&rest_corners(seed), 0).unwrap();
        let gradient = if seed % 2 == 0 { 0.3 } else { -0.3 };
        let stencil = NormalFoundation::new(&rest, 2.0, gradient);
        let w = random_vector(&mut rng);
        let by_matrix = stencil.matrix() * w;
        let force = Vector3::from(stencil.gradient([w.x, w.y, w.z]));
        assert!((by_matrix - force).amax() < 1e-13 * stencil.matrix().amax());
        let value: f64 = stencil.values([w.x, w.y, w.z]).iter().sum();
        let scale = stencil.matrix().amax();
        assert!((0.5 * w.dot(&by_matrix) - value).abs() < 1e-13 * scale);
    }
}

#[test]
fn tangential_spring() {
    let mut rng = rng(4000);
    let normal = random_vector(&mut rng).normalize();
    let anchor = Anchor {
        point: random_vector(&mut rng),
        normal,
    };
    let spring = TangentialSpring { stiffness: 3.0 };
    let x = [random_vector(&mut rng)];
    let (value, gradient) = (
        |y: &[Vector3<f64>; 1]| spring.value(&anchor, &y[0]),
        |y: &[Vector3<f64>; 1]| [spring.gradient(&anchor, &y[0])],
    );
    check_stencil(
        &x,
        1e-2,
        value,
        gradient,
        &[spring.hessian(&anchor)],
        "tangential spring",
    );
}

#[test]
fn assembled_layer() {
    for model in MODELS {
        let (layer, x) = assembled(model);
        assert_eq!(layer.bending_model(), model);
        assert!((30..3 * x.len()).contains(&layer.dof_count()));
        let mut exact = vec![7.0; layer.pattern().1.len()];
        let mut again = exact.clone();
        let mut relaxed = exact.clone();
        layer.hessian(&x, &mut exact, None);
        layer.hessian(&x, &mut again, Some(&mut relaxed));
        assert_eq!(
            exact, again,
            "the exact Hessian does not depend on what else is asked"
        );
        let mut predicted = [exact.clone(), relaxed.clone()];
        let [first, second] = &mut predicted;
        layer.predicted_hessian(&x, &x, first, second);
        assert_eq!(
            predicted,
            [exact, relaxed],
            "without a step there is nothing to predict"
        );
        check_layer(&layer, &x);
    }
}

#[test]
fn uneven_sliding() {
    let (mut layer, x) = assembled(BendingModel::VertexCurvature);
    let without = layer.energy_parts(&x);
    layer.set_drift_gradient_stiffness(0.7).unwrap();
    let with = layer.energy_parts(&x);
    assert!(with.tangential > 1.2 * without.tangential);
    assert_eq!(
        with.normal + with.gradient,
        without.normal + without.gradient
    );
    check_layer(&layer, &x);
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(layer.set_drift_gradient_stiffness(bad).is_err());
    }
    assert_eq!(layer.energy_parts(&x), with, "refused, and unchanged");
}

#[test]
fn relaxed_layer_is_positive_where_the_exact_one_is_not() {
    for model in MODELS {
        check_relaxed_layer(model);
    }
}

fn check_relaxed_layer(model: BendingModel) {
    let (layer, x) = assembled(model);
    let squeezed: Vec<_> = x.iter().map(|p| 0.7 * p).collect();
    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut relaxed = exact.clone();
    layer.hessian(&squeezed, &mut exact, Some(&mut relaxed));
    assert!(dense(layer.pattern(), &exact).symmetric_eigenvalues().min() < 0.0);
    // K1 < 0 here; K0 and the rest outweigh it.
    assert!(
        dense(layer.pattern(), &relaxed)
            .symmetric_eigenvalues()
            .min()
            > 0.0
    );
}
