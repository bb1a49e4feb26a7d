//! A straight crease in a film on a foundation: when it folds, how deep, and its shape.

use crate::Wrinkling;

/// Reduced load at which a film folds along a crease of reduced stiffness `kappa`:
/// `η* = 1 - (√(κ² + 1) - κ)²/2`.
///
/// `κ = l/(c D)` with `l = 1/k_c`, [`Wrinkling::crease_stiffness`]. The film itself wrinkles at 1
/// ([`Wrinkling::reduced_load`]); a hinge without friction folds at 1/2. Closed form for a linear plate
/// on a Pasternak foundation that is elastic and compressed evenly.
///
/// # Validity
/// `kappa` ≥ 0, infinite for no crease.
pub fn crease_onset(kappa: f64) -> f64 {
    // √(κ² + 1) - κ, without the difference of two nearly equal numbers.
    let gap = 1.0 / (kappa.hypot(1.0) + kappa);
    1.0 - 0.5 * gap * gap
}

/// A straight crease in a film under load, in units of the film's bending length `l = 1/k_c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseLoad {
    /// Reduced load `η`, see [`Wrinkling::reduced_load`]; negative in tension.
    pub load: f64,
    /// Reduced stiffness `κ` ≥ 0, see [`Wrinkling::crease_stiffness`].
    pub stiffness: f64,
    /// Angle at which the crease has no moment (rad), positive in a valley.
    pub rest_angle: f64,
    /// Stiffness `a = k_a/(K0 l)` ≥ 0 of the springs that draw the line down; 0 without an anchor.
    pub anchor: f64,
    /// Depth `d/l` to which they draw it.
    pub anchor_depth: f64,
}

/// Depth of a crease below the undisturbed film, over the bending length `l = 1/k_c`.
///
/// ```text
/// δ/l = (κ θ0 + a (α + κ) d/l) / (1 - 2 η + 4 κ α + a (α + κ))        α = √((1 - η)/2)
/// ```
/// `None` from the load on at which the line gives way by itself, see [`crease_onset`]: from there on only
/// large deflections limit the depth.
///
/// # Validity
/// Linear in the depth: good while it is below 0.3.
pub fn crease_depth(crease: &CreaseLoad) -> Option<f64> {
    let CreaseLoad {
        load,
        stiffness,
        rest_angle,
        anchor,
        anchor_depth,
    } = *crease;
    let decay = decay(load)?;
    let held = anchor * (decay + stiffness);
    let resistance = 1.0 - 2.0 * load + 4.0 * stiffness * decay + held;
    let depth = (stiffness * rest_angle + held * anchor_depth) / resistance;
    (resistance > 0.0).then_some(depth)
}

/// Reduced stiffness from which on a line counts as this stiff: an infinite one would be infinity over infinity.
const RIGID: f64 = 1e6;

/// Force per length with which an anchor pulls its line, over `K0 l²`: `a (d - δ)/l`, with `δ` from [`crease_depth`] and,
/// at loads above [`crease_onset`], as it is at the onset. Positive downwards.
///
/// The foundation carries it, so that the mean height of the film beside the line is as much below zero.
/// Zero where the line lies deeper by itself than the anchor wants it: there large deflections limit the depth, of
/// which the linear theory knows nothing.
///
/// # Validity
/// As [`crease_depth`].
pub fn anchor_pull(crease: &CreaseLoad) -> f64 {
    if crease.anchor <= 0.0 {
        return 0.0;
    }
    // At the onset itself rounding may leave no resistance; the depth is then what the anchor wants.
    let depth = crease_depth(&below_onset(crease)).unwrap_or(crease.anchor_depth);
    let lack = crease.anchor_depth - depth;
    if lack * crease.anchor_depth > 0.0 {
        crease.anchor * lack
    } else {
        0.0
    }
}

/// Depth over the bending length up to which the linear theory holds.
const LINEAR: f64 = 0.3;

/// Angle (rad) by which a crease is folded, positive in a valley: `4 α δ/l - a (d - δ)/l`, with `δ` from
/// [`crease_depth`] and, at loads above [`crease_onset`], as it is at the onset.
///
/// Folds that alone would sink by more than 0.3 bending lengths count as doing that: there large deflections limit
/// them.
pub fn crease_fold(crease: &CreaseLoad) -> f64 {
    let crease = below_onset(crease);
    let Some(decay) = decay(crease.load) else {
        return 0.0;
    };
    let most = 4.0 * decay * LINEAR;
    match crease_depth(&crease) {
        Some(depth) => {
            let pull = match crease.anchor > 0.0 {
                true => crease.anchor * (crease.anchor_depth - depth),
                false => 0.0,
            };
            (4.0 * decay * depth - pull).clamp(-most, most)
        }
        // At the onset itself rounding may leave no resistance: a line without a rest angle stays as it is.
        None if crease.rest_angle == 0.0 => 0.0,
        None => most.copysign(crease.rest_angle),
    }
}

/// The same crease under no more than the load at which it folds by itself.
fn below_onset(crease: &CreaseLoad) -> CreaseLoad {
    let stiffness = crease.stiffness.min(RIGID);
    CreaseLoad {
        load: crease.load.min(crease_onset(stiffness)),
        stiffness,
        ..*crease
    }
}

/// Height at a `distance` from a crease of unit depth that is not anchored, both over the bending length
/// `l = 1/k_c`, under the reduced load `load`.
///
/// ```text
/// w/δ = -exp(-α x) (cos(β x) - (α/β) sin(β x))        α = √((1 - η)/2), β = √((1 + η)/2)
/// ```
/// Its mean is zero: what sinks at the line rises beside it. The line is folded by `4 α δ/l`.
/// `None` for a load of 1 and more, where the film itself wrinkles.
pub fn crease_profile(load: f64, distance: f64) -> Option<f64> {
    let (decay, x) = (decay(load)?, distance.abs());
    let square = 0.5 * (1.0 + load);
    // Under strong tension β is imaginary and the profile no longer swings. Every exponential is taken with
    // the decay, so that none overflows.
    let rate = square.abs().sqrt();
    let (even, odd) = if square >= 0.0 {
        let scale = (-decay * x).exp();
        let (sin, cos) = (rate * x).sin_cos();
        // As β goes to 0, sin(βx)/β goes to x.
        let odd = if rate * x < 1e-6 { x } else { sin / rate };
        (scale * cos, scale * odd)
    } else {
        let [slow, fast] = [rate - decay, -rate - decay].map(|rate| (rate * x).exp());
        let odd = if rate * x < 1e-6 {
            x * slow
        } else {
            (slow - fast) / (2.0 * rate)
        };
        (0.5 * (slow + fast), odd)
    };
    Some(decay * odd - even)
}

/// `α = √((1 - η)/2)`, with which the profile of a crease falls off; `None` where the film wrinkles.
fn decay(load: f64) -> Option<f64> {
    (load < 1.0).then(|| (0.5 * (1.0 - load)).sqrt())
}

impl Wrinkling {
    /// Reduced load `η = (N - K1)/(2 D k_c²)` of a compressive strain, `N = C ε`: 1 where the film wrinkles.
    pub fn reduced_load(&self, strain: f64) -> f64 {
        let unit = 2.0 * self.bending_stiffness * self.wave_number * self.wave_number;
        (self.membrane_stiffness * strain - self.gradient_stiffness) / unit
    }

    /// Reduced stiffness `κ = l/(c D)` of a crease of this `softness` `c D` (m): of one that stands for a strip of
    /// a width `w` keeping the share `f` of the bending stiffness, `w (1/f - 1)`.
    ///
    /// Infinite without softness.
    pub fn crease_stiffness(&self, softness: f64) -> f64 {
        1.0 / (self.wave_number * softness)
    }

    /// Compressive strain at which the film folds along a crease of reduced stiffness `kappa`, see
    /// [`crease_onset`].
    pub fn crease_strain(&self, kappa: f64) -> f64 {
        let unit = 2.0 * self.bending_stiffness * self.wave_number * self.wave_number;
        (self.gradient_stiffness + unit * crease_onset(kappa)) / self.membrane_stiffness
    }
}
