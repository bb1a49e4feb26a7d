//! Rows are low-pass filters: what they make of a wrinkle.

mod meshes;

use std::f64::consts::{PI, TAU};

use meshes::{Patch, equilateral_rectangle};
use nalgebra::Vector3;
use ruga_constraint::{ConstraintRow, Kernel, Sampling};
use ruga_mesh::{Id, VertexId};

/// Lengths in wavelengths; 12 edges to each.
fn patch() -> (Patch, VertexId) {
    let patch = equilateral_rectangle(5.0, 5.0, 1.0 / 12.0);
    let centre = patch.vertex_near(Vector3::new(2.5, 2.5, 0.0));
    (patch, centre)
}

/// What a row makes of a wave of the given wavenumber and direction with its crest at the centre:
/// 1 keeps it, 0 removes it.
fn measured(
    patch: &Patch,
    centre: VertexId,
    row: &ConstraintRow,
    wavenumber: f64,
    direction: f64,
) -> f64 {
    let origin = patch.positions[centre.index()];
    let along = Vector3::new(direction.cos(), direction.sin(), 0.0);
    let phase = |v: VertexId| wavenumber * along.dot(&(patch.positions[v.index()] - origin));
    row.average(|v| phase(v).cos())
}

fn row(patch: &Patch, centre: VertexId, kernel: Kernel, sampling: Sampling) -> ConstraintRow {
    patch.rows(&[centre], kernel, sampling).rows.remove(0)
}

/// The plane-wave transform of the kernel.
fn exact(kernel: Kernel, wavenumber: f64) -> f64 {
    let steps = 400;
    let (mut mass, mut sum) = (0.0, 0.0);
    for i in 0..steps {
        let r = (i as f64 + 0.5) / steps as f64 * kernel.radius();
        let ring: f64 = (0..64)
            .map(|j| (wavenumber * r * (TAU * j as f64 / 64.0).cos()).cos())
            .sum();
        mass += 64.0 * r * kernel.weight(r);
        sum += ring * r * kernel.weight(r);
    }
    sum / mass
}

const SAMPLINGS: [Sampling; 3] = [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature];

#[test]
fn every_sampling_responds_as_the_continuous_kernel() {
    let (patch, centre) = patch();
    for kernel in [Kernel::beside_foundation(1.5), Kernel::alone(1.0)] {
        let rows = SAMPLINGS.map(|sampling| row(&patch, centre, kernel, sampling));
        for step in 0..=12 {
            let wavenumber = TAU * f64::from(step) / 12.0;
            let expected = exact(kernel, wavenumber);
            for (row, sampling) in rows.iter().zip(SAMPLINGS) {
                for direction in [0.0, 0.4, PI / 6.0, PI / 2.0] {
                    let error = measured(&patch, centre, row, wavenumber, direction) - expected;
                    assert!(error.abs() < 0.01, "{sampling:?} {wavenumber}: {error}");
                }
            }
        }
    }
}

#[test]
fn the_cut_changes_the_gaussian_response_by_what_the_kernel_says() {
    // (cut, largest excess over exp(-σ²k²/2)): lowering and cutting narrows the kernel.
    for (cut, bound) in [(3.0, 0.035), (2.5, 0.09)] {
        let kernel = Kernel { sigma: 0.5, cut };
        for step in 0..=60 {
            let sigma_k = 0.1 * f64::from(step);
            let gaussian = (-0.5 * sigma_k * sigma_k).exp();
            let excess = exact(kernel, sigma_k / kernel.sigma) - gaussian;
            assert!(
                excess > -0.008 && excess < bound,
                "{cut} {sigma_k}: {excess}"
            );
        }
    }
}

#[test]
fn rows_beside_a_foundation_do_not_see_the_wrinkle() {
    let kernel = Kernel::beside_foundation(1.5);
    let (patch, centre) = patch();
    for sampling in SAMPLINGS {
        let row = row(&patch, centre, kernel, sampling);
        for direction in [0.0, PI / 6.0, PI / 2.0] {
            let response = measured(&patch, centre, &row, TAU, direction);
            assert!(response.abs() < 4e-3, "{sampling:?}: {response}");
        }
    }
    // Nor do their reactions imprint at the spacing.
    assert!(exact(kernel, TAU / 1.5).abs() < 2e-3);
}

#[test]
fn rows_alone_see_part_of_the_wrinkle() {
    // sigma = wavelength/π: e⁻² = .135 uncut, .19 with the papers' plain cut at 2 sigma.
    let kernel = Kernel::alone(1.0);
    let (patch, centre) = patch();
    for sampling in SAMPLINGS {
        let row = row(&patch, centre, kernel, sampling);
        let response = measured(&patch, centre, &row, TAU, 0.0);
        assert!(
            response > 0.135 && response < 0.19,
            "{sampling:?}: {response}"
        );
    }
}

#[test]
fn the_weight_falls_to_zero_without_a_step() {
    let kernel = Kernel::beside_foundation(1.0);
    let rim = kernel.radius();
    assert_eq!(kernel.weight(rim), 0.0);
    assert_eq!(kernel.weight(2.0 * rim), 0.0);
    assert!(kernel.weight(0.999 * rim) < 1e-3 * kernel.weight(0.0));
    assert!(kernel.weight(0.999 * rim) > 0.0);
}
