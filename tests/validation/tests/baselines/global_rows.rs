//! Eigenfunctions of a square against those known in closed form.

use std::f64::consts::PI;

use ruga_validation::Rectangle;
use ruga_validation::baselines::lowest_eigenfunctions;

#[test]
fn eigenvalues_and_orthonormality_on_a_rectangle() {
    let rectangle = Rectangle {
        length: 2.0,
        width: 1.7,
        radius: None,
    };
    let edge = rectangle.length / 32.0;
    let remeshed = rectangle.remeshed(&rectangle.meshed(edge), edge, 0.2, 3);
    let (mesh, positions) = (remeshed.mesh.mesh, remeshed.mesh.positions.as_slice());
    let found = lowest_eigenfunctions(&mesh, positions, 24);
    let mut exact: Vec<f64> = (0..20)
        .flat_map(|m| (0..20).map(move |n| [m, n]))
        .map(|[m, n]| {
            (PI * f64::from(m) / 2.0).powi(2) + (PI * f64::from(n) / rectangle.width).powi(2)
        })
        .collect();
    exact.sort_by(f64::total_cmp);
    // Linear elements with lumped mass are off by about (k h)^2 / 12, h the edge.
    for ((found, _), exact) in found.iter().zip(&exact).skip(1) {
        let bound = 1e-3 + 0.25 * exact * edge.powi(2);
        assert!((found / exact - 1.0).abs() < bound, "{found} {exact}");
    }
    let areas = ruga_mesh::vertex_areas(&mesh, positions);
    let area: f64 = areas.iter().sum();
    for (i, (_, a)) in found.iter().enumerate() {
        let sum: f64 = a.iter().sum();
        let expected = if i == 0 { 1.0 } else { 0.0 };
        assert!((sum - expected).abs() < 1e-9, "{i}: {sum}");
        for (j, (_, b)) in found.iter().enumerate() {
            let terms = a.iter().zip(b).zip(&areas);
            let product: f64 = terms.map(|((a, b), m)| a * b * area / m).sum();
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((product - expected).abs() < 1e-9, "{i} {j}: {product}");
        }
    }
}
