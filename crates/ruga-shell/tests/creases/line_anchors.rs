//! Line anchors: their derivatives, and their energy at the depth that they ask for.

use nalgebra::Vector3;
use ruga_shell::{BendingModel, LineAnchor};

use super::differences::check_layer;
use super::{THROUGH, anchors, bowl, edges, layer, mesh};

#[test]
fn line_anchors_pull_towards_their_depth() {
    let (mesh, rest) = mesh();
    let mut layer = layer(BendingModel::Hinge);
    layer.set_line_anchors(&anchors()).unwrap();
    check_layer(&layer, &bowl(0.1, 9));
    // At depth d of a line as long as it is: k_a d^2/2 per length, for a layer that is not bent.
    let on = edges(&mesh, THROUGH);
    let length: f64 = on
        .iter()
        .map(|&e| {
            let [a, b] = mesh.edges()[e].vertices.map(|v| rest[v.0 as usize]);
            (a - b).norm()
        })
        .sum();
    let even = |depth| {
        on.iter().map(move |&edge| LineAnchor {
            edge,
            stiffness: 0.5,
            depths: [depth; 2],
        })
    };
    layer
        .set_line_anchors(&even(0.3).collect::<Vec<_>>())
        .unwrap();
    let energy = layer.energy_parts(&rest).anchored;
    assert!((energy / (0.25 * 0.09 * length) - 1.0).abs() < 1e-12);
    let sunk: Vec<_> = rest.iter().map(|p| p - 0.3 * Vector3::z()).collect();
    assert!(layer.energy_parts(&sunk).anchored < 1e-30);
}
