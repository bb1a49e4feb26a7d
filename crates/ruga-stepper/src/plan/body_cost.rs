//! What a body's simulation will cost.

use crate::InteriorPlan;

/// Factorisations of a load step, and seconds of one for a vertex count to the power 3/2 and 1, and for a
/// number of lattice elements to the power 5/4, assembly included, on a machine that does nothing else: the shipped
/// pillow and bar take what is told, the finger with muscles and the slab's isocontours half of it.
const PER_STEP: f64 = 10.0;
const FACTOR: [f64; 3] = [6e-8, 1.5e-5, 3.3e-4];

/// Bytes per vertex, and per lattice node.
const BYTES: [f64; 2] = [65e3, 30e3];

/// Expected time (s) of a load step on one core, and expected memory (bytes), of a layer with so many
/// vertices and of the interior that is solved together with it.
pub(crate) fn cost(vertices: usize, interior: Option<&InteriorPlan>) -> (f64, f64) {
    let vertices = vertices as f64;
    let layer = FACTOR[0] * vertices.powf(1.5) + FACTOR[1] * vertices;
    let [cells, nodes] = interior.map_or([0.0; 2], |i| [i.cells as f64, i.nodes as f64]);
    let lattice = FACTOR[2] * cells.powf(1.25);
    let memory = BYTES[0] * vertices + BYTES[1] * nodes;
    (PER_STEP * (layer + lattice), memory)
}
