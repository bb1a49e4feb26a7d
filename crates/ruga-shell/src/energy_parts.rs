//! Parts of a layer's energy.

/// Where the energy of a layer sits (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyParts {
    /// Energy of in-plane stretch.
    pub membrane: f64,
    /// Energy of bending out of the plane.
    pub bending: f64,
    /// Energy of the foundation, `K0` term.
    pub normal: f64,
    /// Energy of the foundation, `K1` term; negative where `K1` is.
    pub gradient: f64,
    /// Energy of the tangential springs, and of the stiffness on the gradient of the drift.
    pub tangential: f64,
    /// Energy of the line anchors.
    pub anchored: f64,
}

impl EnergyParts {
    /// Sum of the parts (J).
    pub fn total(&self) -> f64 {
        // Last, so that without anchors the sum is what it was.
        self.membrane + self.bending + self.normal + self.gradient + self.tangential + self.anchored
    }
}
