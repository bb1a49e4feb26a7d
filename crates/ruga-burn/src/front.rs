//! The front of a fire: how fast, how wide, and when it dies.

use crate::wave::{Wave, death, loss_of};
use crate::{BurnError, BurnLaw};

/// A straight front that moves into fresh sheet at constant speed.
///
/// Without loss, with `p = dT_ad/(T_i - T_a)` and `g` between 0 and 1,
/// ```text
/// c = 2 g sqrt(a dT_ad mu),     p - 1 = 2 g exp(g (pi - acos g)/sqrt(1 - g²))
/// w = a/c,     burning zone  2 g w (pi - acos g)/sqrt(1 - g²),     burnt  T_a + dT_ad
/// ```
/// Derived from the law of [`BurnLaw`], which is linear ahead of the front, in the burning zone and behind;
/// with loss each of the three stays linear and the speed is one root. Radiation is not counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Front {
    /// Speed (m/s).
    pub speed: f64,
    /// Length over which the temperature above the surroundings falls by a factor e ahead of the front (m).
    pub width: f64,
    /// Length of the burning zone, from ignition to the last fuel (m).
    pub burning_length: f64,
    /// Temperature at which the last fuel burns (K).
    pub burnt: f64,
}

/// The weakest front that lives in spite of loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontDeath {
    /// Least loss time with which a front lives (s).
    pub loss_time: f64,
    /// Its speed (m/s).
    pub speed: f64,
}

impl Front {
    /// The front of a law: the faster, stable one of the two that a law with loss has.
    ///
    /// # Errors
    /// Those of [`BurnLaw::check`], and [`BurnError::FrontDies`] with the least loss time that lives.
    pub fn of(law: &BurnLaw) -> Result<Self, BurnError> {
        law.check()?;
        let (heat_ratio, rate) = (law.heat_ratio(), law.adiabatic_rise * law.burn_rate);
        let loss = match law.loss_time {
            None => 0.0,
            Some(time) => loss_of(heat_ratio, time * rate).ok_or(BurnError::FrontDies {
                loss_time: time,
                least: least_loss_time(heat_ratio, rate),
            })?,
        };
        let wave = Wave::exact(heat_ratio, loss);
        Self::of_wave(law, &wave).ok_or(unresolved(heat_ratio))
    }

    fn of_wave(law: &BurnLaw, wave: &Wave) -> Option<Self> {
        let number = wave.burning_number()?;
        let zone = wave.burning_zone(number)?;
        let speed = (law.diffusivity * law.adiabatic_rise * law.burn_rate / number).sqrt();
        let unit = law.diffusivity / speed;
        Some(Self {
            speed,
            width: unit / wave.decay().0,
            burning_length: unit * zone.length,
            burnt: law.surroundings + zone.end * (law.ignition - law.surroundings),
        })
    }
}

impl FrontDeath {
    /// How much loss the front of a law survives; its own loss time does not matter.
    ///
    /// # Errors
    /// Those of [`BurnLaw::check`].
    pub fn of(law: &BurnLaw) -> Result<Self, BurnError> {
        law.check()?;
        let (heat_ratio, rate) = (law.heat_ratio(), law.adiabatic_rise * law.burn_rate);
        let (loss, number) = death(heat_ratio).ok_or(unresolved(heat_ratio))?;
        Ok(Self {
            loss_time: number / (loss * rate),
            speed: (law.diffusivity * rate / number).sqrt(),
        })
    }
}

fn least_loss_time(heat_ratio: f64, rate: f64) -> f64 {
    death(heat_ratio).map_or(f64::INFINITY, |(loss, number)| number / (loss * rate))
}

/// A heat ratio at which the front's equations have no root in floating point.
pub(crate) fn unresolved(heat_ratio: f64) -> BurnError {
    BurnError::OutOfRange {
        name: "heat ratio dT_ad/(T_i - T_a)",
        value: heat_ratio,
        accepted: "1.001 to 1e6",
    }
}
