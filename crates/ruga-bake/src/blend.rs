//! How engines combine normal maps at run time, as a reference to compare them with.

use crate::BakeError;
use crate::error::same_length;

/// The normal map of one key of a pose.
#[derive(Debug, Clone, Copy)]
pub struct KeyNormals<'a> {
    /// Fraction of the pose, in (0, 1].
    pub key: f64,
    /// Unit normals, texel by texel: X along U, Y up, Z outwards.
    pub normals: &'a [[f32; 3]],
}

/// Normals of a pose on its way: linear between the maps of its keys and from neutral at 0 to the first, then of
/// length 1. Beyond the last key they are those of the last.
///
/// `keys` ascend; `weight` is the fraction of the pose. Without keys nothing comes out.
pub fn between_keys(keys: &[KeyNormals<'_>], weight: f64) -> Vec<[f32; 3]> {
    let Some(last) = keys.last() else {
        return Vec::new();
    };
    let at = keys.iter().position(|key| key.key >= weight);
    let above = at.map_or(last, |at| &keys[at]);
    let below = at.unwrap_or(keys.len() - 1).checked_sub(1);
    let below = below.map(|below| &keys[below]);
    let start = below.map_or(0.0, |below| below.key);
    let share = ((weight - start) / (above.key - start)).clamp(0.0, 1.0);
    let mix = |texel: usize| {
        let from = below.map_or([0.0, 0.0, 1.0], |below| below.normals[texel]);
        let to = above.normals[texel];
        unit([0, 1, 2].map(|c| f64::from(from[c]) * (1.0 - share) + f64::from(to[c]) * share))
    };
    (0..above.normals.len()).map(mix).collect()
}

/// Lays the normals `detail` over `base`, texel by texel, by reoriented normal mapping.
///
/// With `t = base + z` and `u = detail * (-1, -1, 1)` it is the direction of `t (t . u) - t_z u`: the rotation
/// that takes Z to `base`, applied to `detail`. Neutral on either side leaves the other as it is.
/// Source: Barré-Brisebois and Hill 2012, *Blending in detail*.
///
/// # Errors
/// [`BakeError::LengthMismatch`] when the maps differ in size.
pub fn lay_over(base: &mut [[f32; 3]], detail: &[[f32; 3]]) -> Result<(), BakeError> {
    same_length("detail", detail.len(), base.len())?;
    for (base, detail) in base.iter_mut().zip(detail) {
        *base = reoriented(*base, *detail);
    }
    Ok(())
}

fn reoriented(base: [f32; 3], detail: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = base.map(f64::from);
    let t = [x, y, z + 1.0];
    let [x, y, z] = detail.map(f64::from);
    let u = [-x, -y, z];
    let along = t[0] * u[0] + t[1] * u[1] + t[2] * u[2];
    unit([0, 1, 2].map(|c| t[c] * along - u[c] * t[2]))
}

fn unit(vector: [f64; 3]) -> [f32; 3] {
    let length = vector.iter().map(|c| c * c).sum::<f64>().sqrt();
    match length > 0.0 {
        true => vector.map(|c| (c / length) as f32),
        false => [0.0, 0.0, 1.0],
    }
}
