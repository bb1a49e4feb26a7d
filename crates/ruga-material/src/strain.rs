//! Part of a driver's compression that a layer feels.
//!
//! Compressive principal strains, `first ≥ second`: `1 - stretch`, so that tension is negative.

/// Strain up to which a driver is followed as it is: beyond, slopes leave film theory.
pub const CAP_START: f64 = 0.15;

/// Most that the cap adds to [`CAP_START`]: 0.25 in all.
const CAP_RANGE: f64 = 0.10;

/// Compression that a layer is asked to take where the driver asks for `strain`.
///
/// The identity up to 0.15, then `0.15 + 0.10 (1 - exp(-(strain - 0.15)/0.10))`: continuous with its
/// slope, rising, never above 0.25. Blend shapes ask for much more in lids, lips and fists, where the
/// artist has drawn a fold that no wrinkle can represent. Not a number is passed on.
pub fn capped_strain(strain: f64) -> f64 {
    if strain <= CAP_START {
        return strain;
    }
    // `exp_m1` keeps the digits just above the start, where the two pieces have to meet.
    CAP_START - CAP_RANGE * (-(strain - CAP_START) / CAP_RANGE).exp_m1()
}

/// Compression to compare with a critical strain, `first + poisson * second`.
///
/// The membrane force along the first principal direction is `C` times this (plane stress); faces
/// under compression are mostly stretched by 2-5 % across, which takes much of it away.
pub fn effective_strain(first: f64, second: f64, poisson: f64) -> f64 {
    first + poisson * second
}
