//! Rows depend on the shape around the centre and on nothing else.

mod meshes;

use meshes::{Patch, irregular_hills};
use nalgebra::{Rotation3, Vector3};
use ruga_constraint::{ConstraintSet, Kernel, Sampling};
use ruga_mesh::MaterialPoint;

const KERNEL: Kernel = Kernel {
    sigma: 0.15,
    cut: 2.5,
};
const SAMPLINGS: [Sampling; 3] = [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature];

/// Centres at vertices, on edges and in faces, inside, on and near the border of a surface of
/// `irregular_hills`.
fn centres(patch: &Patch) -> Vec<MaterialPoint> {
    let addresses = [[1.0, 0.0, 0.0], [0.3, 0.7, 0.0], [0.2, 0.5, 0.3]];
    let faces = patch.mesh.faces().ids().step_by(47);
    let addressed = faces.zip(addresses.iter().cycle());
    addressed
        .map(|(face, &barycentric)| MaterialPoint { face, barycentric })
        .collect()
}

fn rows(patch: &Patch, sampling: Sampling) -> ConstraintSet {
    patch.rows_at(&centres(patch), KERNEL, sampling)
}

/// Largest difference of a weight, over the largest weight.
fn difference(a: &ConstraintSet, b: &ConstraintSet) -> f64 {
    let mut worst = 0.0_f64;
    assert_eq!(a.rows.len(), b.rows.len());
    for (left, right) in a.rows.iter().zip(&b.rows) {
        let mut dense = vec![0.0; 2000];
        let largest = left
            .weights
            .iter()
            .fold(0.0_f64, |m, pair| m.max(pair.1.abs()));
        left.weights
            .iter()
            .for_each(|(v, w)| dense[v.0 as usize] += w);
        right
            .weights
            .iter()
            .for_each(|(v, w)| dense[v.0 as usize] -= w);
        worst = dense.iter().fold(worst, |m, d| m.max(d.abs() / largest));
    }
    worst
}

#[test]
fn translation_by_a_thousand_wavelengths() {
    let patch = irregular_hills(40, 1);
    // σ is half the spacing and the spacing 1.5 wavelengths: one wavelength is 0.2.
    let far = patch.mapped(|p| p + Vector3::new(120.0, -130.0, 90.0));
    for sampling in SAMPLINGS {
        let d = difference(&rows(&patch, sampling), &rows(&far, sampling));
        assert!(d < 1e-9, "{sampling:?}: {d}");
    }
}

#[test]
fn rotation() {
    let patch = irregular_hills(40, 2);
    let turn = Rotation3::from_euler_angles(2.0, -0.8, 0.3);
    let turned = patch.mapped(|p| turn * p);
    for sampling in SAMPLINGS {
        let d = difference(&rows(&patch, sampling), &rows(&turned, sampling));
        assert!(d < 1e-9, "{sampling:?}: {d}");
    }
}

#[test]
fn reflection() {
    let patch = irregular_hills(40, 3);
    let mirrored = patch.mirrored();
    for sampling in SAMPLINGS {
        // The mirrored faces list their corners in another order.
        let centres: Vec<_> = centres(&patch)
            .into_iter()
            .map(|place| {
                let [a, b, c] = place.barycentric;
                MaterialPoint {
                    barycentric: [a, c, b],
                    ..place
                }
            })
            .collect();
        let reflected = mirrored.rows_at(&centres, KERNEL, sampling);
        let d = difference(&rows(&patch, sampling), &reflected);
        assert!(d < 1e-9, "{sampling:?}: {d}");
    }
}

#[test]
fn repetition_and_company() {
    let patch = irregular_hills(40, 4);
    for sampling in SAMPLINGS {
        let together = rows(&patch, sampling);
        assert_eq!(together, rows(&patch, sampling));
        let alone = patch.rows_at(&centres(&patch)[7..8], KERNEL, sampling);
        assert_eq!(together.rows[7].centre, 7);
        assert_eq!(alone.rows[0].weights, together.rows[7].weights);
    }
}
