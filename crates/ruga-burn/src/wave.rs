//! The travelling front in numbers without units: lengths in `a/c`, temperatures in `T_i - T_a`.

use crate::root::{minimum, root};

/// Steps in which the end of the burning zone is looked for, over a whole turn of its oscillation.
const SCAN_STEPS: usize = 64;

/// A straight front in the frame that moves with it, of the exact law or of the scheme in
/// [`BurnSolver`](crate::BurnSolver) to leading order in time step and mesh.
///
/// With `x` ahead, `v` the temperature above the surroundings in `T_i - T_a`, ignition at `x = 0`,
/// the exact front is
/// ```text
/// ahead    v'' + v' - l v = 0                 v(0) = 1
/// burning  v'' + v' - l v + m (v - 1) = 0     from x = -L to 0, v and v' continuous at both ends
/// behind   v'' + v' - l v = 0                 bounded
/// fuel     m (integral of v - 1 over the burning zone) = p
/// ```
/// with the loss `l = a/(c² tau)` and the burning number `m = a dT_ad mu/c²`. Without loss this is the closed
/// form `m = 1/(4 g²)`, `p - 1 = 2 g exp(g (pi - acos g)/sqrt(1 - g²))`.
///
/// The scheme burns by the old temperature and conducts by the new one, with a step `s = c² dt/a`; for
/// `v''` it sees `v''` and `d` times the fourth derivative, on rows that are `sqrt(12 d) a/c` apart. Its
/// diffusivity is such that the zone ahead is exact, with decay `k`. Then, with fourth derivatives and the
/// next order in `dt` replaced by the equation itself,
/// ```text
/// burning  A v'' + C v' - l v + m (v - 1) = 0,     A = 1 + d (1 + l - m - k²),  C = 1 + s m + d (m - l)
/// at 0     v'(0) = -k (1 + d m)
/// at -L    v jumps by d m (v - 1), v' by d m v' - (s/2 + 2 d) m (v - 1), upwards in x
/// fuel     m (integral of v - 1, less s/2 (v - 1)(-L)) = p
/// ```
/// The jumps come from those of the burning rate: burning goes on half a step longer, and a difference
/// quotient across a jump of `v''` is off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    /// Heat ratio `p`, above 1.
    pub(crate) heat_ratio: f64,
    /// Loss `l`.
    pub(crate) loss: f64,
    /// Time step `s`, 0 for the exact front.
    pub(crate) step: f64,
    /// Spread `d` of the mesh, 0 for the exact front.
    pub(crate) spread: f64,
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
    /// The exact front.
    pub(crate) fn exact(heat_ratio: f64, loss: f64) -> Self {
        Self {
            heat_ratio,
            loss,
            step: 0.0,
            spread: 0.0,
        }
    }

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
        let (s, d, net) = (self.step, self.spread, m - self.loss);
        let (ahead, behind) = self.decay();
        let (a, c) = (1.0 + d * (1.0 - net - ahead * ahead), 1.0 + s * m + d * net);
        let decay = 0.5 * c / a;
        let omega = (net / a - decay * decay).sqrt();
        if omega.is_nan() || omega == 0.0 {
            return None;
        }
        // v = rest + y; y starts from y0 with `slope` and oscillates as it grows towards -x.
        let (rest, slope) = (m / net, -ahead * (1.0 + d * m));
        let y0 = 1.0 - rest;
        let sine_part = (slope + decay * y0) / omega;
        let y = |length: f64| {
            let (sin, cos) = (omega * length).sin_cos();
            let value = y0 * cos - sine_part * sin;
            [value, omega * (y0 * sin + sine_part * cos) - decay * value]
        };
        let kink = |length: f64| {
            // Divided by exp(decay L), so that long zones do not overflow.
            let shrink = (-decay * length).exp();
            let [value, slope] = y(length);
            let (v, above) = (value + rest * shrink, value + (rest - 1.0) * shrink);
            let slope_behind = slope + m * ((0.5 * s + 2.0 * d) * above - d * slope);
            slope_behind - behind * (v - d * m * above)
        };
        let stride = std::f64::consts::TAU / omega / SCAN_STEPS as f64;
        let after = (1..=SCAN_STEPS).find(|&k| kink(k as f64 * stride) >= 0.0)? as f64;
        let length = root(kink, (after - 1.0) * stride, after * stride);
        let [value, end_slope] = y(length).map(|part| part * (decay * length).exp());
        // Integral of the differential equation over the zone.
        let integral = (a * (end_slope - slope) + c * (value - y0)) / net;
        let end = value + rest;
        Some(BurningZone {
            length,
            end,
            fuel: m * (integral + length * (rest - 1.0) - 0.5 * s * (end - 1.0)),
        })
    }

    /// Decay of the temperature ahead of the front and behind it, per `a/c`.
    pub(crate) fn decay(&self) -> (f64, f64) {
        let root = (1.0 + 4.0 * self.loss).sqrt();
        let behind = 2.0 * self.loss / (root + 1.0);
        let spread = self.spread * behind * (behind * behind + self.loss) / root;
        (0.5 * (root + 1.0), behind + spread)
    }

    /// Least and largest burning number for which the burning zone oscillates, `4 A (m - l) > C²`.
    fn oscillating(&self) -> Option<(f64, f64)> {
        let (s, d, k) = (self.step, self.spread, self.decay().0);
        let (constant, slope) = (1.0 + s * self.loss, s + d);
        let square = 4.0 * d + slope * slope;
        let linear = 4.0 * (1.0 + d * (1.0 - k * k)) - 2.0 * constant * slope;
        let under_root = linear * linear - 4.0 * square * constant * constant;
        if linear <= 0.0 || under_root <= 0.0 {
            return None;
        }
        let low = 2.0 * constant * constant / (linear + under_root.sqrt());
        let high = constant * constant / (square * low);
        // Without step and spread there is no upper bound; such a zone is shorter than 1e-3.
        let shift = |net: f64| (self.loss + net).min(1e8);
        Some((shift(low) * (1.0 + 1e-9), shift(high)))
    }
}

/// The loss `l` at which a front of heat ratio `p` dies, with its burning number.
///
/// Along the fronts of one material `m/l = tau dT_ad mu` is its loss time; two fronts, a fast and a slow
/// one, belong to each, and meet where it is least.
pub(crate) fn death(heat_ratio: f64) -> Option<(f64, f64)> {
    let number = |loss: f64| Wave::exact(heat_ratio, loss).burning_number();
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
        let number = Wave::exact(heat_ratio, loss).burning_number();
        number.map_or(-1.0, |m| m - loss * loss_time)
    };
    // Towards no loss, `m` tends to that of the closed form, and the excess is positive.
    Some(root(excess, 0.0, most))
}
