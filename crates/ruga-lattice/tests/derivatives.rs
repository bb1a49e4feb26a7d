//! Gradient and Hessian of the assembled energy against central differences.

mod shapes;

use nalgebra::{DMatrix, DVector, Vector3};
use ruga_lattice::{Lattice, LatticeEnergy, LatticeSpec, Shape, SolidMaterial};
use shapes::{block, random_vector, rng, spec, sphere};

/// Relative to the largest entry.
const TOLERANCE: f64 = 1e-7;

const SOFT: SolidMaterial = SolidMaterial {
    young: 2.0,
    poisson: 0.35,
};

fn dense((starts, rows): (&[usize], &[u32]), values: &[f64]) -> DMatrix<f64> {
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

/// Some nodes pinned, the others moved by `noise`, everything scaled by `scale` along each axis.
fn state(lattice: &Lattice, scale: [f64; 3], noise: f64, seed: u64) -> Vec<Vector3<f64>> {
    let mut rng = rng(seed);
    let scale = Vector3::from(scale);
    let rest = lattice.rest_positions().iter();
    rest.map(|x| x.component_mul(&scale) + random_vector(&mut rng) * noise)
        .collect()
}

fn check(lattice: &Lattice, q: &[Vector3<f64>], what: &str) {
    let pinned: Vec<bool> = (0..lattice.node_count()).map(|n| n % 7 == 3).collect();
    let energy = LatticeEnergy::new(lattice, &SOFT, &pinned).expect("valid input");
    let size = energy.dof_count();
    let gradient_at = |x: &[f64]| {
        let mut moved = q.to_vec();
        energy.set_unknowns(x, &mut moved);
        // Not zero, so that whoever only adds is found out.
        let mut gradient = vec![7.0; size];
        energy.gradient(&moved, &mut gradient);
        (energy.value(&moved), DVector::from_vec(gradient))
    };
    let x = energy.unknowns(q);
    let step = 2e-4;
    let (mut by_value, mut by_gradient) = (DVector::zeros(size), DMatrix::zeros(size, size));
    for dof in 0..size {
        for (steps, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
            let mut moved = x.clone();
            moved[dof] += steps * step;
            let (value, gradient) = gradient_at(&moved);
            by_value[dof] += value * weight / (12.0 * step);
            let column = by_gradient.column(dof) + gradient * (weight / (12.0 * step));
            by_gradient.set_column(dof, &column);
        }
    }
    let (_, gradient) = gradient_at(&x);
    let error = (&gradient - by_value).amax() / gradient.amax();
    assert!(error < TOLERANCE, "{what}: gradient {error:e}");
    let mut exact = vec![7.0; energy.pattern().1.len()];
    let mut relaxed = exact.clone();
    energy.hessian(q, &mut exact, Some(&mut relaxed));
    let hessian = dense(energy.pattern(), &exact);
    let error = (&hessian - by_gradient).amax() / hessian.amax();
    assert!(error < TOLERANCE, "{what}: Hessian {error:e}");
    let least = dense(energy.pattern(), &relaxed)
        .symmetric_eigenvalues()
        .min();
    assert!(least > -1e-12 * hessian.amax(), "{what}: {least:e}");
    let mut alone = vec![7.0; exact.len()];
    energy.hessian(q, &mut alone, None);
    assert_eq!(alone, exact, "with and without the relaxed one");
}

#[test]
fn energy_gradient_and_hessian_agree() {
    let bar = block([2.0, 1.0, 1.0], [2, 1, 1]);
    let ball = sphere(1.0, 10, 6);
    for shape in [Shape::Quadratic, Shape::Linear] {
        let spec = LatticeSpec { shape, ..spec(2) };
        let lattice = bar.lattice(spec);
        for (scale, noise, what) in [
            ([1.0, 1.0, 1.0], 0.1, "near rest"),
            ([0.6, 1.3, 0.8], 0.15, "compressed and stretched"),
            ([1.0, 1.0, 1e-3], 0.02, "nearly flat"),
            ([1.0, 0.8, -0.3], 0.05, "inverted"),
            ([1.2, 1.1, -0.9], 0.01, "nearly mirrored"),
        ] {
            check(&lattice, &state(&lattice, scale, noise, 5), what);
        }
        // Elements that are filled in part.
        let lattice = ball.lattice(spec);
        check(
            &lattice,
            &state(&lattice, [0.6, 1.3, -0.8], 0.1, 6),
            "a ball",
        );
    }
}

#[test]
fn nothing_is_not_a_number_on_ridges_and_in_collapse() {
    let lattice = block([1.0, 1.0, 1.0], [1, 1, 1]).lattice(spec(1));
    let pinned = vec![false; lattice.node_count()];
    let energy = LatticeEnergy::new(&lattice, &SOFT, &pinned).expect("valid input");
    for scale in [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, -1.0],
        [-1.0; 3],
        [1e6, 1e-6, -1e-6],
    ] {
        let q = state(&lattice, scale, 0.0, 1);
        let mut gradient = vec![0.0; energy.dof_count()];
        energy.gradient(&q, &mut gradient);
        let mut exact = vec![0.0; energy.pattern().1.len()];
        let mut relaxed = exact.clone();
        energy.hessian(&q, &mut exact, Some(&mut relaxed));
        let all = gradient.iter().chain(&exact).chain(&relaxed);
        assert!(all.clone().all(|v| v.is_finite()) && energy.value(&q).is_finite());
    }
}
