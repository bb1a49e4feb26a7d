//! A law of burning from the front that is asked for.

use crate::error::check_positive;
use crate::front::unresolved;
use crate::law::{check_loss_time, check_temperatures};
use crate::wave::{Wave, death};
use crate::{BurnError, BurnLaw};

/// The front that a sheet is to have: *how fast* and *how wide*, instead of diffusivity and rate.
///
/// Flames preheat a sheet through the gas before them, so that its own diffusivity would make the front
/// far too narrow and slow. The width is therefore asked for, and the diffusivity follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontDesign {
    /// Speed `c` of the front (m/s); above 0. Nominal: paper burns downwards at 1e-3 to 3e-3 and
    /// smoulders at 1e-4.
    pub speed: f64,
    /// Width `w` of the preheated zone, over which the temperature above the surroundings falls by a
    /// factor e (m); above 0. Nominal for paper: 2e-3 to 5e-3.
    pub width: f64,
    /// Temperature of ignition (K); above that of the surroundings.
    pub ignition: f64,
    /// Temperature of a sheet that has burnt without losses (K); above ignition.
    pub burning: f64,
    /// Temperature of the surroundings (K); at least 0.
    pub surroundings: f64,
    /// Time in which the difference to the surroundings falls by a factor e (s); above 0. None for a
    /// sheet that loses no heat.
    pub loss_time: Option<f64>,
}

impl FrontDesign {
    /// The law whose front has this speed and width; [`Front::of`](crate::Front::of) is the inverse.
    ///
    /// `a = c w + w²/tau`, and with the front's equations for `l = a/(c² tau)`, `dT_ad mu = m c²/a`;
    /// without loss `m = 1/(4 g²)`. See [`Front`](crate::Front).
    ///
    /// # Errors
    /// [`BurnError::OutOfRange`], [`BurnError::IgnitionBelowSurroundings`],
    /// [`BurnError::BurningBelowIgnition`], or [`BurnError::FrontDies`] when a front of this speed and width
    /// is not stable with such a loss.
    pub fn law(&self) -> Result<BurnLaw, BurnError> {
        check_positive("front speed", self.speed, "above 0 m/s")?;
        check_positive("front width", self.width, "above 0 m")?;
        check_temperatures(self.surroundings, self.ignition, self.burning)?;
        check_loss_time(self.loss_time)?;
        let adiabatic_rise = self.burning - self.surroundings;
        let heat_ratio = adiabatic_rise / (self.ignition - self.surroundings);
        let wave = Wave::exact(heat_ratio, self.loss(heat_ratio)?);
        let number = wave.burning_number().ok_or(unresolved(heat_ratio))?;
        // The unit of length is `a/c = w (1 + w/(c tau))`.
        let diffusivity = self.speed * self.width * wave.decay().0;
        let law = BurnLaw {
            diffusivity,
            burn_rate: number * self.speed * self.speed / (diffusivity * adiabatic_rise),
            adiabatic_rise,
            ignition: self.ignition,
            surroundings: self.surroundings,
            loss_time: self.loss_time,
            radiation: None,
        };
        law.check().map(|()| law)
    }

    /// Loss `a/(c² tau) = z + z²` with `z = w/(c tau)`, refused beyond the death of the front.
    fn loss(&self, heat_ratio: f64) -> Result<f64, BurnError> {
        let Some(loss_time) = self.loss_time else {
            return Ok(0.0);
        };
        let share = self.width / (self.speed * loss_time);
        let loss = share + share * share;
        let (most, _) = death(heat_ratio).ok_or(unresolved(heat_ratio))?;
        if loss <= most {
            return Ok(loss);
        }
        let least_share = 0.5 * ((1.0 + 4.0 * most).sqrt() - 1.0);
        Err(BurnError::FrontDies {
            loss_time,
            least: self.width / (self.speed * least_share),
        })
    }
}
