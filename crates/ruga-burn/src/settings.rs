//! How a burning sheet is stepped.

/// How a burning sheet is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurnSettings {
    /// Largest distance that the front advances in a substep, in mean edges of the mesh; above 0. Steps that are
    /// asked for are divided into equal substeps accordingly. None takes each step whole, for heat alone.
    /// The default is 0.2.
    pub advance: Option<f64>,
    /// Whether diffusivity and rate make up for the errors of mesh and substep.
    pub correction: FrontCorrection,
}

/// What is done about the known errors of the speed of a discrete front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrontCorrection {
    /// Diffusivity and burning rate are changed so that speed and width of the front are those of
    /// [`Front::of`](crate::Front::of): to 0.1 % at 4 edges per width and 1 % at 2, for heat ratios of 2 and
    /// more. Near 1 the burning zone is short, and two edges must lie in it. Away from the front, too, heat
    /// conducts by what diffusivity is lowered, 3 % at 4 edges per width.
    Corrected,
    /// The law is discretised as it stands. The front is slow: at 4 edges per width by 5, 2.6, 1.7 and 1 % for
    /// heat ratios of 2, 3.4, 5.7 and 14, at 8 by half of that.
    Uncorrected,
}

impl Default for BurnSettings {
    fn default() -> Self {
        Self {
            advance: Some(0.2),
            correction: FrontCorrection::Corrected,
        }
    }
}
