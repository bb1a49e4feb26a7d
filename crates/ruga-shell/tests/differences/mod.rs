//! Central differences, and the states at which derivatives are compared with them.
#![allow(dead_code, reason = "each test file uses its own part")]

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector3};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};

use crate::meshes::{jittered, outline, random_rotation, random_vector, rng, symmetric};

pub(crate) const TOLERANCE: f64 = 1e-6;
pub(crate) const MODELS: [BendingModel; 2] = [BendingModel::Hinge, BendingModel::VertexCurvature];

/// Full matrix of a stencil whose lower blocks are listed row by row.
pub(crate) fn full<const N: usize, const B: usize>(blocks: &[Matrix3<f64>; B]) -> DMatrix<f64> {
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

pub(crate) fn flat<const N: usize>(vectors: &[Vector3<f64>; N]) -> DVector<f64> {
    DVector::from_iterator(3 * N, vectors.iter().flat_map(|v| v.iter().copied()))
}

/// Fourth-order central difference of `f` along each coordinate.
pub(crate) fn difference<const N: usize>(
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

pub(crate) fn assert_close(found: &DMatrix<f64>, expected: &DMatrix<f64>, what: &str) {
    let scale = expected.amax().max(found.amax());
    let error = (found - expected).amax() / scale.max(f64::MIN_POSITIVE);
    assert!(
        error < TOLERANCE,
        "{what}: relative error {error:e}, scale {scale:e}"
    );
}

pub(crate) fn check_stencil<const N: usize, const B: usize>(
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

/// Full matrix of values in the order of a pattern.
pub(crate) fn dense((starts, rows): (&[usize], &[u32]), values: &[f64]) -> DMatrix<f64> {
    let size = starts.len() - 1;
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        let range = starts[column]..starts[column + 1];
        assert_eq!(
            rows[range.start] as usize, column,
            "the diagonal comes first"
        );
        assert!(rows[range.clone()].is_sorted_by(|a, b| a < b));
        for k in range {
            let row = rows[k] as usize;
            matrix[(row, column)] = values[k];
            matrix[(column, row)] = values[k];
        }
    }
    matrix
}

/// Gradient and Hessian of a whole layer against differences of value and gradient.
pub(crate) fn check_layer(layer: &LayerEnergy, x: &[Vector3<f64>]) {
    let (free, size) = (layer.free_vertices(), layer.dof_count());
    let mut hessian = vec![7.0; layer.pattern().1.len()];
    layer.hessian(x, &mut hessian, None);
    let moved = |dof: usize, by: f64| {
        let mut y = x.to_vec();
        y[free[dof / 3] as usize][dof % 3] += by;
        y
    };
    let gradient_at = |y: &[Vector3<f64>]| {
        // Not zero, so that whoever only adds is found out.
        let mut target = vec![7.0; size];
        layer.gradient(y, &mut target);
        DVector::from_vec(target)
    };
    let step = 1e-3;
    let stencil = |f: &dyn Fn(f64) -> DVector<f64>| {
        (8.0 * (f(step) - f(-step)) - (f(2.0 * step) - f(-2.0 * step))) / (12.0 * step)
    };
    let (mut by_value, mut by_gradient) = (Vec::new(), Vec::new());
    for dof in 0..size {
        by_value.push(stencil(&|s| DVector::from_element(1, layer.value(&moved(dof, s))))[0]);
        by_gradient.push(stencil(&|s| gradient_at(&moved(dof, s))));
    }
    let by_value = DMatrix::from_column_slice(size, 1, &by_value);
    let gradient = DMatrix::from_column_slice(size, 1, gradient_at(x).as_slice());
    assert_close(&gradient, &by_value, "assembled gradient");
    assert_close(
        &dense(layer.pattern(), &hessian),
        &DMatrix::from_columns(&by_gradient),
        "assembled Hessian",
    );
}

/// Rest triangles from equilateral to a sliver of height 0.02.
pub(crate) fn rest_corners(seed: u64) -> [Vector3<f64>; 3] {
    let mut rng = rng(seed);
    let height = [0.9, 0.4, 0.1, 0.02][seed as usize % 4];
    let turn = random_rotation(&mut rng);
    let foot = symmetric(&mut rng);
    [[0.0, 0.0], [1.0, 0.0], [foot, height]].map(|[x, y]| turn * Vector3::new(x, y, 0.0))
}

/// A crumpled layer on a bumpy base, stretched rest metric, pinned outline, units of order one.
pub(crate) fn assembled(model: BendingModel) -> (LayerEnergy, Vec<Vector3<f64>>) {
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
    let mut layer = LayerEnergy::with_bending(&mesh.topology(), &rest, parameters, &pinned, model)
        .expect("valid input");
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
