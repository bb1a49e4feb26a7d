//! What burns, how hot and how fast.

use crate::BurnError;
use crate::error::check_positive;

/// Law of burning of a sheet: heat conduction, zeroth-order burning above ignition, loss of heat.
///
/// With temperature `T` (K) and fuel share `Y` (from 1, fresh, to 0, burnt out), at each point
/// ```text
/// dT/dt = a Lap T + dT_ad r - (T - T_a)/tau + sources - radiation
/// dY/dt = -r,     r = mu (T - T_i)  while T > T_i and Y > 0, else 0
/// ```
/// Source: Jeong, Kim, Kim 2011, *Shrinkage, wrinkling and ablation of burning cloth and paper*,
/// eq. (1), (2), (4). It differs: burning heats instead of cooling, and stops when there is no fuel
/// left; heat is lost; and the Laplacian is that of the surface, where their eq. (3) is half of it and
/// depends on the mesh.
///
/// [`FrontDesign`](crate::FrontDesign) makes a law from the speed and the width of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurnLaw {
    /// Diffusivity `a` of heat along the sheet (m²/s); above 0.
    pub diffusivity: f64,
    /// Burning rate `mu`: fuel share burnt per second and kelvin above ignition (1/(K s)); above 0.
    pub burn_rate: f64,
    /// Rise of temperature `dT_ad` when all fuel burns without losses (K); above 0.
    pub adiabatic_rise: f64,
    /// Temperature of ignition `T_i` (K); between those of the surroundings and of burning.
    pub ignition: f64,
    /// Temperature of the surroundings `T_a` (K); at least 0.
    pub surroundings: f64,
    /// Time `tau` in which the difference to the surroundings falls by a factor e (s); above 0. None
    /// for a sheet that loses no heat.
    pub loss_time: Option<f64>,
    /// Radiation from both faces; None where the loss time is enough. It matters above about 900 K.
    pub radiation: Option<Radiation>,
}

/// Radiation from both faces of the sheet to black surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiation {
    /// Emissivity of the faces; above 0, at most 1.
    pub emissivity: f64,
    /// Heat capacity per area of sheet (J/(m² K)): density times specific heat times thickness; above 0.
    pub areal_heat_capacity: f64,
}

/// Constant of Stefan and Boltzmann (W/(m² K⁴)).
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Whether a hot place is hot enough to start a front beside it; see [`BurnLaw::starter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarterCheck {
    /// Temperature at which the hot and the fresh sheet meet, `(T_hot + T_a)/2` (K).
    pub meeting: f64,
    /// The least temperature of the hot place for which they meet at ignition (K); it must be exceeded.
    pub least: f64,
    /// Whether they meet above ignition.
    pub is_hot_enough: bool,
}

impl BurnLaw {
    /// Temperature `T_a + dT_ad` of a sheet that has burnt without losses (K).
    pub fn burning(&self) -> f64 {
        self.surroundings + self.adiabatic_rise
    }

    /// Ratio `p = dT_ad/(T_i - T_a)` of the heat of burning to the heat up to ignition; above 1.
    pub fn heat_ratio(&self) -> f64 {
        self.adiabatic_rise / (self.ignition - self.surroundings)
    }

    /// The law of a sheet on which the front is `factor` times as fast and as wide as here.
    pub(crate) fn faster(&self, factor: f64) -> Self {
        Self {
            diffusivity: factor * self.diffusivity,
            burn_rate: factor * self.burn_rate,
            ..*self
        }
    }

    /// Tells whether a place of temperature `hot` (K) without heating and fuel of its own ignites the
    /// fresh sheet beside it.
    ///
    /// Two halves of a sheet meet at the mean of their temperatures. A place that is heated on, or that
    /// burns, may start a front from below that temperature.
    pub fn starter(&self, hot: f64) -> StarterCheck {
        let meeting = 0.5 * (hot + self.surroundings);
        StarterCheck {
            meeting,
            least: 2.0 * self.ignition - self.surroundings,
            is_hot_enough: meeting > self.ignition,
        }
    }

    /// Refuses a law that is not that of a burning sheet.
    ///
    /// # Errors
    /// [`BurnError::OutOfRange`], [`BurnError::IgnitionBelowSurroundings`] or
    /// [`BurnError::BurningBelowIgnition`]. Whether a front lives is asked of
    /// [`Front::of`](crate::Front::of).
    pub fn check(&self) -> Result<(), BurnError> {
        check_positive("diffusivity", self.diffusivity, "above 0 m²/s")?;
        check_positive("burning rate", self.burn_rate, "above 0 1/(K s)")?;
        check_positive("adiabatic rise", self.adiabatic_rise, "above 0 K")?;
        check_temperatures(self.surroundings, self.ignition, self.burning())?;
        check_loss_time(self.loss_time)?;
        self.radiation.map_or(Ok(()), |radiation| radiation.check())
    }
}

impl Radiation {
    fn check(&self) -> Result<(), BurnError> {
        let accepted = "above 0, at most 1";
        check_positive("emissivity", self.emissivity, accepted)?;
        if self.emissivity > 1.0 {
            return Err(BurnError::OutOfRange {
                name: "emissivity",
                value: self.emissivity,
                accepted,
            });
        }
        let capacity = self.areal_heat_capacity;
        check_positive("areal heat capacity", capacity, "above 0 J/(m² K)")
    }

    /// Coefficient (1/s) of the radiation as a loss in proportion to `temperature - surroundings` (K).
    ///
    /// `2 eps sigma (T⁴ - T_a⁴)/c_A`, divided by `T - T_a`.
    pub(crate) fn coefficient(&self, temperature: f64, surroundings: f64) -> f64 {
        let sum = temperature + surroundings;
        let squares = temperature * temperature + surroundings * surroundings;
        2.0 * self.emissivity * STEFAN_BOLTZMANN * sum * squares / self.areal_heat_capacity
    }
}

/// Refuses temperatures (K) that do not rise from surroundings to ignition to burning.
pub(crate) fn check_temperatures(
    surroundings: f64,
    ignition: f64,
    burning: f64,
) -> Result<(), BurnError> {
    if !(surroundings.is_finite() && surroundings >= 0.0) {
        return Err(BurnError::OutOfRange {
            name: "temperature of the surroundings",
            value: surroundings,
            accepted: crate::error::TEMPERATURES,
        });
    }
    check_positive("ignition temperature", ignition, "above 0 K")?;
    check_positive("temperature of burning", burning, "above 0 K")?;
    if ignition <= surroundings {
        return Err(BurnError::IgnitionBelowSurroundings {
            ignition,
            surroundings,
        });
    }
    if burning <= ignition {
        return Err(BurnError::BurningBelowIgnition { burning, ignition });
    }
    Ok(())
}

/// Refuses a loss time that is not positive.
pub(crate) fn check_loss_time(loss_time: Option<f64>) -> Result<(), BurnError> {
    loss_time.map_or(Ok(()), |time| {
        check_positive("loss time", time, "above 0 s, or none")
    })
}
