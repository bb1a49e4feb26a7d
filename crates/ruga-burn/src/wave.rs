//! The travelling front in numbers without units: lengths in `a/c`, temperatures in `T_i - T_a`.

use crate::root::{minimum, root};

/// Steps in which the end of the burning zone is looked for, over a whole turn of its oscillation.
const SCAN_STEPS: usize = 64;

/// A straight front in the frame that moves with it.
///
/// With `x` ahead, `v` the temperature above the surroundings in `T_i - T_a`, ignition at `x = 0`:
/// ```text
/// ahead    v'' + v' - l v = 0,                    v(0) = 1
/// burning  v'' + q v' + m (v - 1) - l v = 0       from x = -L to 0
/// behind   v'' + v' - l v = 0                     bounded
/// fuel     m (integral of v - 1 over the zone - s/2 (v - 1)(-L)) = p
/// ```
/// `l = a/(c² tau)` is the loss, `m = a dT_ad mu/c²` the burning number. `s = c² dt/a` is a time step of
/// the scheme in [`BurnSolver`](crate::BurnSolver), whose leading error (burning taken from the old
/// temperature, conduction from the new) makes `q = 1 + s m` and, as burning lasts half a step
/// too long, a kink `v'(-L + 0) - v'(-L - 0) = -s m (v - 1)/2`. The exact front has `s = 0`; without loss
/// it is the closed form `m = 1/(4 g²)`, `p - 1 = 2 g exp(g (pi - acos g)/sqrt(1 - g²))`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    /// Heat ratio `p`, above 1.
    pub(crate) heat_ratio: f64,
    /// Loss `l`.
    pub(crate) loss: f64,
    /// Time step `s`.
    pub(crate) step: f64,
}

/// The burning zone of a wave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BurningZone {
    /// Length `L`.
    pub(crate) length: f64,
    /// Temperature `v` where the fuel runs out.
    pub(crate) end: f64,
    /// Fuel burnt, in heat ratios.
    fuel: f64,
}

impl Wave {
    /// The burning number `m` with which the front moves at the speed of the frame; none if no
    /// burning is fast enough.
    pub(crate) fn burning_number(&self) -> Option<f64> {
        // Below, the temperature rises without end in the burning zone, and no amount of fuel is enough.
        let (low, high) = self.oscillating()?;
        let excess = |m: f64| match self.burning_zone(m) {
            Some(zone) if zone.fuel > 0.0 => 1.0 / zone.fuel - 1.0 / self.heat_ratio,
            _ => -1.0 / self.heat_ratio,
        };
        let mut above = low;
        while excess(above) <= 0.0 {
            above *= 1.25;
            if above >= high {
                return None;
            }
        }
        Some(root(excess, (above / 1.25).max(low), above))
    }

    /// The zone of a burning number; none where it has no end.
    pub(crate) fn burning_zone(&self, m: f64) -> Option<BurningZone> {
        let (loss, q) = (self.loss, 1.0 + self.step * m);
        let (ahead, behind) = self.decay();
        let omega = (m - loss - 0.25 * q * q).sqrt();
        if omega.is_nan() || omega == 0.0 {
            return None;
        }
        // v = rest + y; y starts from y0 with slope -ahead and oscillates as it grows towards -x.
        let rest = m / (m - loss);
        let y0 = 1.0 - rest;
        let sine_part = (-ahead + 0.5 * q * y0) / omega;
        let y = |length: f64| {
            let (sin, cos) = (omega * length).sin_cos();
            let value = y0 * cos - sine_part * sin;
            [
                value,
                -0.5 * q * value + omega * (y0 * sin + sine_part * cos),
            ]
        };
        // Divided by exp(q L/2), so that long zones do not overflow.
        let kink = |length: f64| {
            let [value, slope] = y(length);
            let shrink = (-0.5 * q * length).exp();
            let late = 0.5 * self.step * m;
            slope - behind * (value + rest * shrink) + late * (value + (rest - 1.0) * shrink)
        };
        let stride = std::f64::consts::TAU / omega / SCAN_STEPS as f64;
        let after = (1..=SCAN_STEPS).find(|&k| kink(k as f64 * stride) >= 0.0)? as f64;
        let length = root(kink, (after - 1.0) * stride, after * stride);
        let [value, slope] = y(length).map(|part| part * (0.5 * q * length).exp());
        // Integral of the differential equation over the zone.
        let area = (slope + q * value + ahead - q * y0) / (m - loss) + length * (rest - 1.0);
        let end = value + rest;
        Some(BurningZone {
            length,
            end,
            fuel: m * (area - 0.5 * self.step * (end - 1.0)),
        })
    }

    /// Decay of the temperature ahead of the front and behind it, per `a/c`.
    pub(crate) fn decay(&self) -> (f64, f64) {
        let root = (1.0 + 4.0 * self.loss).sqrt();
        (0.5 * (root + 1.0), 2.0 * self.loss / (root + 1.0))
    }

    /// Least and largest burning number for which the burning zone oscillates: `m - l > q²/4`.
    fn oscillating(&self) -> Option<(f64, f64)> {
        let (constant, linear) = (1.0 + 4.0 * self.loss, 2.0 - self.step);
        let under_root = linear * linear - self.step * self.step * constant;
        if under_root <= 0.0 {
            return None;
        }
        let low = constant / (linear + under_root.sqrt());
        let high = constant / (low * self.step * self.step);
        // A step of zero has no upper bound; a burning zone of a thousandth of the width is enough.
        Some((low.max(self.loss) * (1.0 + 1e-9), high.min(1e8)))
    }
}

/// The loss `l` at which a front of heat ratio `p` dies, with its burning number.
///
/// Along the fronts of one material `m/l = tau dT_ad mu` is its loss time; two fronts, a fast and a slow
/// one, belong to each, and meet where it is least.
pub(crate) fn death(heat_ratio: f64) -> Option<(f64, f64)> {
    let number = |loss: f64| {
        let wave = Wave {
            heat_ratio,
            loss,
            step: 0.0,
        };
        wave.burning_number()
    };
    // Even all fuel burning at once heats its place to `p/sqrt(1 + 4 l)` only, which must be above 1.
    let most = (0.25 * (heat_ratio * heat_ratio - 1.0)).ln();
    let loss_time = |log: f64| number(log.exp()).map_or(f64::INFINITY, |m| m.ln() - log);
    let loss = minimum(loss_time, most - 12.0, most).exp();
    Some((loss, number(loss)?))
}

/// The loss of the fast front for a loss time in `1/(dT_ad mu)`; none if that is less than at death.
pub(crate) fn loss_of(heat_ratio: f64, loss_time: f64) -> Option<f64> {
    let (most, number) = death(heat_ratio)?;
    if loss_time < number / most {
        return None;
    }
    let excess = |loss: f64| {
        let wave = Wave {
            heat_ratio,
            loss,
            step: 0.0,
        };
        wave.burning_number().map_or(-1.0, |m| m - loss * loss_time)
    };
    // Towards no loss, `m` tends to that of the closed form, and the excess is positive.
    Some(root(excess, 0.0, most))
}
