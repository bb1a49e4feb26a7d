//! Every gradient and Hessian against central differences, relative tolerance 1e-6.

mod meshes;

use meshes::{jittered, outline, random_rotation, random_vector, rng, symmetric};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use ruga_shell::{
    Anchor, FaceParameters, Hinge, HingeCurvature, HingeState, LayerEnergy, LayerParameters,
    Membrane, NormalFoundation, RestTriangle, Stress, TangentialTie,
};

const TOLERANCE: f64 = 1e-6;

/// Full matrix of a stencil whose lower blocks are listed row by row.
fn full<const N: usize, const B: usize>(blocks: &[Matrix3<f64>; B]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(3 * N, 3 * N);
    let mut next = 0;
    for i in 0..N {
        for j in 0..=i {
            matrix
                .fixed_view_mut::<3, 3>(3 * i, 3 * j)
                .copy_from(&blocks[next]);
            matrix
                .fixed_view_mut::<3, 3>(3 * j, 3 * i)
                .copy_from(&blocks[next].transpose());
            next += 1;
        }
    }
    matrix
}

fn flat<const N: usize>(vectors: &[Vector3<f64>; N]) -> DVector<f64> {
    DVector::from_iterator(3 * N, vectors.iter().flat_map(|v| v.iter().copied()))
}

/// Fourth-order central difference of `f` along each coordinate.
fn difference<const N: usize>(
    x: &[Vector3<f64>; N],
    step: f64,
    f: impl Fn(&[Vector3<f64>; N]) -> DVector<f64>,
) -> DMatrix<f64> {
    let columns: Vec<_> = (0..3 * N)
        .map(|k| {
            let at = |s: f64| {
                let mut y = *x;
                y[k / 3][k % 3] += s * step;
                f(&y)
            };
            (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

fn assert_close(found: &DMatrix<f64>, expected: &DMatrix<f64>, what: &str) {
    let scale = expected.amax().max(found.amax());
    let error = (found - expected).amax() / scale.max(f64::MIN_POSITIVE);
    assert!(
        error < TOLERANCE,
        "{what}: relative error {error:e}, scale {scale:e}"
    );
}

fn check_stencil<const N: usize, const B: usize>(
    x: &[Vector3<f64>; N],
    step: f64,
    value: impl Fn(&[Vector3<f64>; N]) -> f64,
    gradient: impl Fn(&[Vector3<f64>; N]) -> [Vector3<f64>; N],
    hessian: &[Matrix3<f64>; B],
    what: &str,
) {
    let by_value = difference(x, step, |y| DVector::from_element(1, value(y)));
    let by_gradient = difference(x, step, |y| flat(&gradient(y)));
    let exact = DMatrix::from_row_slice(1, 3 * N, flat(&gradient(x)).as_slice());
    assert_close(&exact, &by_value, &format!("{what} gradient"));
    assert_close(
        &full::<N, B>(hessian),
        &by_gradient,
        &format!("{what} Hessian"),
    );
}

/// Rest triangles from equilateral to a sliver of height 0.02.
fn rest_corners(seed: u64) -> [Vector3<f64>; 3] {
    let mut rng = rng(seed);
    let height = [0.9, 0.4, 0.1, 0.02][seed as usize % 4];
    let turn = random_rotation(&mut rng);
    let foot = symmetric(&mut rng);
    [[0.0, 0.0], [1.0, 0.0], [foot, height]].map(|[x, y]| turn * Vector3::new(x, y, 0.0))
}

#[test]
fn membrane() {
    for seed in 0..40 {
        let mut rng = rng(1000 + seed);
        let rest = RestTriangle::new(&rest_corners(seed), 0).unwrap();
        let membrane = Membrane::new(&rest, 2.5, 0.48);
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
            let hessian = hinge.hessian(&x, HingeCurvature::Full);
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
            let relaxed = full::<4, 10>(&hinge.hessian(&x, HingeCurvature::GaussNewton));
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
        let hessian = hinge.hessian(&x, HingeCurvature::Full);
        assert!(hessian.iter().all(|b| b.iter().all(|c| c.is_finite())));
    }
    let membrane = Membrane::new(&RestTriangle::new(&rest_corners(0), 0).unwrap(), 1.0, 0.48);
    let hessian = membrane.hessian(&[Vector3::zeros(); 3], Stress::Tensile);
    assert!(hessian.iter().all(|b| b.iter().all(|c| c.is_finite())));
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
fn tangential_tie() {
    let mut rng = rng(4000);
    let normal = random_vector(&mut rng).normalize();
    let anchor = Anchor {
        point: random_vector(&mut rng),
        normal,
    };
    let tie = TangentialTie { stiffness: 3.0 };
    let x = [random_vector(&mut rng)];
    let (value, gradient) = (
        |y: &[Vector3<f64>; 1]| tie.value(&anchor, &y[0]),
        |y: &[Vector3<f64>; 1]| [tie.gradient(&anchor, &y[0])],
    );
    check_stencil(&x, 1e-2, value, gradient, &[tie.hessian(&anchor)], "tie");
}

/// A crumpled layer on a bumpy base, stretched rest metric, pinned outline, units of order one.
fn assembled() -> (LayerEnergy, Vec<Vector3<f64>>) {
    let (columns, rows) = (7, 6);
    let mesh = jittered(columns, rows, 1.0, 0.25, 11);
    let mut rng = rng(12);
    let mut face = FaceParameters {
        young: 8.0,
        poisson: 0.4,
        thickness: 0.4,
        normal_stiffness: 1.5,
        gradient_stiffness: -0.4,
    };
    let mut parameters =
        LayerParameters::uniform(face, mesh.faces.len(), 0.8, mesh.positions.len());
    for target in &mut parameters.faces {
        face.thickness = 0.4 + 0.1 * symmetric(&mut rng);
        *target = face;
    }
    let mut pinned = outline(columns, rows);
    pinned[0] = false;
    pinned[3 * columns + 3] = true;
    let rest: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| p + Vector3::z() * (0.3 * (p.x * p.y).sin()))
        .collect();
    let mut layer = LayerEnergy::new(&rest, &mesh.faces, parameters, &pinned).expect("valid input");
    let stretch: Vec<_> = mesh
        .faces
        .iter()
        .map(|_| {
            let shear = 0.1 * symmetric(&mut rng);
            Matrix2::new(0.8 + 0.1 * symmetric(&mut rng), shear, shear, 1.0)
        })
        .collect();
    layer.set_rest_metric(&stretch).expect("valid input");
    let normals: Vec<_> = rest
        .iter()
        .map(|_| (Vector3::z() + 0.4 * random_vector(&mut rng)).normalize())
        .collect();
    let offsets = vec![0.1; rest.len()];
    layer
        .set_base(&rest, &normals, &offsets)
        .expect("valid input");
    let x = rest
        .iter()
        .map(|p| 0.9 * p + 0.2 * random_vector(&mut rng))
        .collect();
    (layer, x)
}

fn dense(layer: &LayerEnergy, values: &[f64]) -> DMatrix<f64> {
    let (starts, rows) = layer.pattern();
    let mut matrix = DMatrix::zeros(layer.dof_count(), layer.dof_count());
    for column in 0..layer.dof_count() {
        let range = starts[column]..starts[column + 1];
        assert_eq!(rows[range.start], column, "the diagonal comes first");
        assert!(rows[range.clone()].is_sorted_by(|a, b| a < b));
        for k in range {
            matrix[(rows[k], column)] = values[k];
            matrix[(column, rows[k])] = values[k];
        }
    }
    matrix
}

#[test]
fn assembled_layer() {
    let (layer, x) = assembled();
    let size = layer.dof_count();
    assert!(size < 3 * x.len() && size > 30);
    let moved = |dof: usize, by: f64| {
        let mut y = x.clone();
        y[layer.free_vertices()[dof / 3] as usize][dof % 3] += by;
        y
    };
    let gradient_at = |y: &[Vector3<f64>]| {
        let mut gradient = vec![0.0; size];
        layer.gradient(y, &mut gradient);
        DVector::from_vec(gradient)
    };
    let step = 1e-3;
    let stencil = |f: &dyn Fn(f64) -> DVector<f64>| {
        (8.0 * (f(step) - f(-step)) - (f(2.0 * step) - f(-2.0 * step))) / (12.0 * step)
    };
    let (mut by_value, mut by_gradient) = (Vec::new(), Vec::new());
    for dof in 0..size {
        let value = |s: f64| DVector::from_element(1, layer.value(&moved(dof, s)));
        by_value.push(stencil(&value)[0]);
        by_gradient.push(stencil(&|s| gradient_at(&moved(dof, s))));
    }
    let by_value = DMatrix::from_column_slice(size, 1, &by_value);
    let gradient = DMatrix::from_column_slice(size, 1, gradient_at(&x).as_slice());
    assert_close(&gradient, &by_value, "layer gradient");

    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut again = exact.clone();
    let mut relaxed = exact.clone();
    layer.hessian(&x, &mut exact, None);
    layer.hessian(&x, &mut again, Some(&mut relaxed));
    assert_eq!(
        exact, again,
        "the exact Hessian does not depend on what else is asked"
    );
    assert_close(
        &dense(&layer, &exact),
        &DMatrix::from_columns(&by_gradient),
        "layer Hessian",
    );
}

#[test]
fn relaxed_layer_is_positive_where_the_exact_one_is_not() {
    let (layer, x) = assembled();
    let squeezed: Vec<_> = x.iter().map(|p| 0.7 * p).collect();
    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut relaxed = exact.clone();
    layer.hessian(&squeezed, &mut exact, Some(&mut relaxed));
    assert!(dense(&layer, &exact).symmetric_eigenvalues().min() < 0.0);
    // K1 < 0 here; K0 and the rest outweigh it.
    assert!(dense(&layer, &relaxed).symmetric_eigenvalues().min() > 0.0);
}
