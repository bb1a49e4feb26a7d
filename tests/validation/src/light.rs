//! Light on skin, for every task that draws some.

use nalgebra::Vector3;

/// Red, green and blue of light in linear units.
pub type Light = Vector3<f64>;

/// Colour of bare skin.
pub const SKIN: Light = Light::new(0.62, 0.33, 0.23);

/// Skin under a lamp at the upper left and a weak sky; `normal` with x right, y up and z towards
/// the eye.
pub fn skin(normal: Vector3<f64>) -> Light {
    lit(SKIN, normal, Vector3::new(-0.62, 0.58, 0.46), 1.0)
}

/// Light from skin of a colour under a lamp in the direction `lamp` and a sky of some brightness.
pub fn lit(albedo: Light, normal: Vector3<f64>, lamp: Vector3<f64>, sky: f64) -> Light {
    let lamp = lamp.normalize();
    let half = (lamp + Vector3::z()).normalize();
    let sky = Light::new(0.13, 0.14, 0.17) * (sky * (0.5 + 0.5 * normal.z));
    // Light that enters skin comes out a little way off, red farther than blue: each colour
    // reaches so far beyond the terminator.
    let spread = Light::new(0.22, 0.09, 0.05);
    let facing = normal.dot(&lamp);
    let diffuse = spread.map(|s| ((facing + s) / (1.0 + s)).max(0.0));
    let gloss = 0.20 * normal.dot(&half).max(0.0).powi(28);
    albedo.component_mul(&(1.5 * diffuse + sky)) + Light::repeat(gloss)
}

/// The texel that shows this light: stored with the sRGB curve.
pub fn texel(light: Light) -> [u8; 3] {
    light.map(|c| (255.0 * srgb(c)).round() as u8).into()
}

/// IEC 61966-2-1.
fn srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_comes_from_the_upper_left() {
        let brightness = |x, y| skin(Vector3::new(x, y, 1.0).normalize()).sum();
        let flat = brightness(0.0, 0.0);
        assert!(brightness(-0.3, 0.0) > flat && brightness(0.0, 0.3) > flat);
        assert!(brightness(0.3, 0.0) < flat && brightness(0.0, -0.3) < flat);
    }

    #[test]
    fn the_ends_of_the_scale_are_black_and_white() {
        assert_eq!(texel(Light::zeros()), [0; 3]);
        assert_eq!(texel(Light::repeat(1.0)), [255; 3]);
    }
}
