//! What a body's simulation will cost.

use ruga_material::Wrinkling;

use super::plan::BodyPlan;

/// Factorisations of a load step, and seconds of one for a vertex count to the power 3/2 and 1, and for a
/// number of lattice elements to the power 5/4, assembly included: of the shipped pillow with 6 and 12
/// cells along; with 20 its three steps were not done after 250 seconds, for which 350 are told.
const PER_STEP: f64 = 10.0;
const FACTOR: [f64; 3] = [1.2e-7, 3e-5, 6.5e-4];

/// Bytes per vertex, and per lattice node.
const BYTES: [f64; 2] = [65e3, 30e3];

impl BodyPlan {
    /// The layer's critical wave on its substrate.
    pub fn wrinkling(&self) -> Wrinkling {
        self.wrinkling
    }

    /// Expected time of a load step on one core, s.
    pub fn seconds_per_step(&self) -> f64 {
        let (vertices, elements) = (self.vertices as f64, self.cells as f64);
        let layer = FACTOR[0] * vertices.powf(1.5) + FACTOR[1] * vertices;
        PER_STEP * (layer + FACTOR[2] * elements.powf(1.25))
    }

    /// Expected memory, bytes.
    pub fn memory(&self) -> f64 {
        BYTES[0] * self.vertices as f64 + BYTES[1] * self.nodes as f64
    }
}
