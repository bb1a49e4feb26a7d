//! Encoding of unit vectors and metres as the integers of an image file.

use crate::{BakeError, WrinkleMap};

/// Sign of the green channel: `+` for OpenGL, Blender, glTF, Unity; `-` for Unreal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)
)]
pub enum NormalY {
    /// Green grows towards the top of the image.
    ///
    /// That is towards decreasing V: glTF, Blender, Unity, Godot.
    #[default]
    #[cfg_attr(feature = "serde", serde(rename = "+"))]
    Up,
    /// Green grows towards the bottom of the image.
    ///
    /// So do Unreal and Source.
    #[cfg_attr(feature = "serde", serde(rename = "-"))]
    Down,
}

impl NormalY {
    fn apply(self, [x, y, z]: [f32; 3]) -> [f64; 3] {
        // Maps hold Y up, against V, so only the other convention turns the sign.
        let y = match self {
            NormalY::Up => y,
            NormalY::Down => -y,
        };
        [x, y, z].map(f64::from)
    }
}

/// The value of a 16-bit height of zero, as a fraction of 65535.
///
/// The code is 32768, so that a height of zero is stored exactly.
pub const HEIGHT_MID: f64 = HEIGHT_MID_CODE / 65535.0;

const HEIGHT_MID_CODE: f64 = 32768.0;

/// RGB, 16 bits per channel, row by row from the top: `round(65535 (n + 1) / 2)`.
///
/// Neutral is `(32768, 32768, 65535)`; the rounding error is below 0.003 degrees.
pub fn normal_to_png16(map: &WrinkleMap, normal_y: NormalY) -> Vec<u16> {
    // Zero falls halfway between two codes and is rounded up, to 32768 as in a height map.
    let code = |c: f64| (65535.0 * (0.5 * c + 0.5)).round() as u16;
    map.normals
        .iter()
        .flat_map(|&n| normal_y.apply(n).map(code))
        .collect()
}

/// RGB, 8 bits per channel, row by row from the top, dithered.
///
/// X and Y are dithered with two low-discrepancy patterns (Roberts 2018, the R2 sequence: like
/// blue noise, without low frequencies), so that their mean over a few texels is right far below
/// one code. Z follows from the *quantised* X and Y, so that the decoded vector is of unit length
/// to half a code instead of three independent roundings. A vector that is exactly neutral stays
/// `(128, 128, 255)`, the neutral of every engine.
pub fn normal_to_png8(map: &WrinkleMap, normal_y: NormalY) -> Vec<u8> {
    let size = map.size as usize;
    let mut bytes = Vec::with_capacity(3 * map.normals.len());
    for (texel, &normal) in map.normals.iter().enumerate() {
        if normal == [0.0, 0.0, 1.0] {
            bytes.extend([128, 128, 255]);
            continue;
        }
        let [x, y, _] = normal_y.apply(normal);
        let [row, column] = [texel / size, texel % size].map(|i| i as f64);
        let red = quantise(x, dither(column, row));
        // The pattern is transposed and shifted for green. With one pattern for both, X and Y would
        // be rounded up in the same texels, which tilts them all along one diagonal.
        let green = quantise(y, dither(row + 0.5, column + 0.5));
        let [x, y] = [red, green].map(|code| f64::from(code) / 127.5 - 1.0);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        // One half rounds to the nearest code: dither in Z would change little but the length.
        bytes.extend([red, green, quantise(z, 0.5)]);
    }
    bytes
}

/// The code below or above `c`, above when its fraction exceeds `1 - threshold`.
fn quantise(c: f64, threshold: f64) -> u8 {
    (127.5 * (c + 1.0) + threshold).floor().clamp(0.0, 255.0) as u8
}

/// Threshold in `[0, 1)` of the dither pattern: the R2 sequence on the integer lattice.
fn dither(column: f64, row: f64) -> f64 {
    // 1/p and 1/p^2 with p the plastic number, the real root of p^3 = p + 1.
    const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    (STEP[0] * column + STEP[1] * row).fract()
}

/// The smallest 16-bit range that holds every height of the map, m; at least a micrometre.
pub fn height_range(map: &WrinkleMap) -> f64 {
    let largest = map
        .heights
        .iter()
        .fold(0.0_f64, |a, &h| a.max(f64::from(h).abs()));
    // The codes reach 32767 above the middle one, not 32767.5.
    // A map without relief needs a range, too: heights are divided by it.
    (2.0 * largest * 65535.0 / 65534.0).max(1e-6)
}

/// Heights as 16-bit grey: `height = range * (code / 65535 - HEIGHT_MID)`, clamped at the ends.
///
/// `range` is the height difference between black and white, m.
///
/// # Errors
/// [`BakeError::HeightRange`] unless `range` is positive and finite.
pub fn height_to_u16(map: &WrinkleMap, range: f64) -> Result<Vec<u16>, BakeError> {
    if !(range > 0.0 && range.is_finite()) {
        return Err(BakeError::HeightRange(range));
    }
    let code = |h: &f32| {
        (HEIGHT_MID_CODE + 65535.0 * f64::from(*h) / range)
            .round()
            .clamp(0.0, 65535.0) as u16
    };
    Ok(map.heights.iter().map(code).collect())
}
