//! What a step did.

/// What a step did and what it cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Equal parts into which the step was divided.
    pub substeps: u32,
    /// Length of each (s).
    pub substep: f64,
    /// Back-substitutions: about one per substep while nothing is removed.
    pub iterations: u32,
    /// Factorisations: one for each new length of the substep, and when much has been removed.
    pub factorisations: u32,
    /// Fuel burnt (m²): the area of fresh sheet that held as much.
    pub burnt: f64,
    /// Where the heat came from and went.
    pub heat: HeatBalance,
}

/// Heat gained and lost in a step (K m²); times the areal heat capacity it is in joules.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeatBalance {
    /// Gained from burning.
    pub fire: f64,
    /// Gained from sources.
    pub sources: f64,
    /// Lost to the surroundings by the loss time.
    pub loss: f64,
    /// Lost to the surroundings by radiation.
    pub radiation: f64,
}

impl HeatBalance {
    /// Change of the heat content (K m²).
    pub fn gain(&self) -> f64 {
        self.fire + self.sources - self.loss - self.radiation
    }
}
