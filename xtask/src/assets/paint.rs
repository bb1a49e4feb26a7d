//! Painted properties for the forearm patch and the paper, grey and packed 8-bit images, and a mask for the slab.
//!
//! Paint changes along the arm and not across it, so that every line across the patch, the
//! direction in which `compress` presses it, meets skin of one kind and has one wavelength.

use super::forearm;

/// Texels along a side: 0.8 mm each, so a jump in the paint is that wide.
pub(super) const TEXELS: usize = 128;

/// Neutral paint in a channel that has no range.
const UNUSED: u8 = 128;

/// Stiffness in the green channel of a packed image: from black at the lower end of the patch to
/// white at the upper one, such that the cube root of what the range `[r, 8 r]` makes of it, which
/// the wavelength goes with, rises by a smooth step from 1 to 2.
pub(super) fn stiffness() -> Vec<u8> {
    /// Where the rise begins and ends, m from the middle of the patch.
    const RISE: [f64; 2] = [-0.035, 0.035];
    let relative = |y: f64| ((1.0 + smooth_step(y, RISE)).powi(3) - 1.0) / 7.0;
    let texel = |y: f64| [UNUSED, byte(relative(y)), UNUSED];
    rows(|y| [texel(y); TEXELS].concat())
}

/// Thickness in grey: black up to a jump to white, a plateau, and a smooth fall back to black.
pub(super) fn thickness() -> Vec<u8> {
    /// Where the jump is, and where the fall begins and ends, m from the middle of the patch.
    const JUMP: f64 = -0.012;
    const FALL: [f64; 2] = [0.008, 0.043];
    let relative = |y: f64| {
        if y < JUMP {
            0.0
        } else {
            1.0 - smooth_step(y, FALL)
        }
    };
    rows(|y| vec![byte(relative(y)); TEXELS])
}

/// White where the slab's upper side lies in the texture, the lower left quarter, and black elsewhere.
pub(super) fn slab_top() -> Vec<u8> {
    let half = TEXELS / 2;
    let texel = |index: usize| index / TEXELS >= half && index % TEXELS < half;
    (0..TEXELS * TEXELS)
        .map(|index| if texel(index) { 255 } else { 0 })
        .collect()
}

/// White where the paper's far end is hot at the beginning, 6 mm of its length, black elsewhere.
pub(super) fn lit_end() -> Vec<u8> {
    square(|u, _| vec![byte(f64::from(u > 0.92))])
}

/// White along the middle of the paper, the part that falls off as it burns, and black beside it.
pub(super) fn ash() -> Vec<u8> {
    square(|_, v| vec![byte(f64::from((v - 0.5).abs() < 0.22))])
}

/// Speed of a fire in red, highest along the middle of the paper, and asymmetry in green, two waves across it; what is
/// painted is the same all along the paper.
pub(super) fn burn() -> Vec<u8> {
    let wave = |v: f64| 1.0 - (2.0 * (2.0 * v).fract() - 1.0).abs();
    square(|_, v| vec![byte(1.0 - (2.0 * v - 1.0).abs()), byte(wave(v)), UNUSED])
}

/// Texels of a square image, each made for its texture coordinates.
fn square(texel: impl Fn(f64, f64) -> Vec<u8>) -> Vec<u8> {
    let middle = |index: usize| (index as f64 + 0.5) / TEXELS as f64;
    let indices = 0..TEXELS * TEXELS;
    indices
        .flat_map(|index| texel(middle(index % TEXELS), middle(index / TEXELS)))
        .collect()
}

/// Rows of texels, the top one first, each made for its place along the arm (m from the middle).
fn rows(row: impl Fn(f64) -> Vec<u8>) -> Vec<u8> {
    let v = |index: usize| (index as f64 + 0.5) / TEXELS as f64;
    (0..TEXELS)
        .flat_map(|index| row(forearm::place_along(v(index))))
        .collect()
}

fn byte(relative: f64) -> u8 {
    (255.0 * relative).round() as u8
}

/// From 0 to 1 between two places, with slope zero at both.
pub(super) fn smooth_step(at: f64, [from, to]: [f64; 2]) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
