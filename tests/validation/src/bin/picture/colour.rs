//! Colours of the face: skin, lips, brows, eyes, by where things are at rest.

use nalgebra::{Vector2, Vector3};
use ruga_validation::light::{Light, SKIN};

/// Colour and gloss at a place at rest (m) with its texture coordinate.
pub(super) fn colour(rest: Vector3<f64>, uv: Vector2<f64>) -> Light {
    if let Some(share) = eye_ring(uv) {
        return eye(share);
    }
    let x = rest.x.abs();
    let lips = Light::new(0.50, 0.17, 0.13);
    let brows = Light::new(0.16, 0.085, 0.05);
    let front = step(rest.z, [0.03, 0.04]);
    let skin = SKIN.lerp(&lips, 0.75 * front * lip_share(x, rest.y));
    skin.lerp(&brows, 0.65 * front * brow_share(x, rest.y))
}

/// Distance from the pupil's middle, the visible part of the eyeball being 1; of eyeballs alone, which
/// lie in the lower corners of the texture.
fn eye_ring(uv: Vector2<f64>) -> Option<f64> {
    const CENTRE: f64 = 0.9;
    const RADIUS: f64 = 0.06;
    let from_left = uv.x.max(1.0 - uv.x);
    let ring = Vector2::new(from_left - CENTRE, uv.y - CENTRE).norm() / RADIUS;
    (ring < 1.05).then_some(ring)
}

fn eye(ring: f64) -> Light {
    let white = Light::new(0.72, 0.68, 0.63);
    let iris = Light::new(0.10, 0.17, 0.20);
    let pupil = Light::repeat(0.01);
    let coloured = iris.lerp(&white, step(ring, [0.37, 0.41]));
    pupil.lerp(&coloured, step(ring, [0.13, 0.16]))
}

/// How much of the lips' red there is.
fn lip_share(x: f64, y: f64) -> f64 {
    let t = x / 0.0245;
    let arch = (1.0 - t * t).max(0.0);
    let (upper, lower) = (0.0078 * arch, 0.0098 * arch);
    let height = y + 0.0702;
    step(height, [upper + 0.0010, upper - 0.0010])
        * step(height, [-lower - 0.0010, -lower + 0.0010])
        * step(t, [1.02, 0.96])
}

/// How much of the brows' brown there is.
fn brow_share(x: f64, y: f64) -> f64 {
    let t = (x - 0.030) / 0.019;
    let middle = 0.0215 + 0.0028 * t - 0.0026 * t * t;
    let half = 0.0030 - 0.0010 * t;
    let off = (y - middle).abs();
    step(off, [half + 0.0008, half - 0.0016]) * step(t.abs(), [1.05, 0.85])
}

/// From 0 to 1 between two numbers in either order, with slope zero at both.
fn step(at: f64, [from, to]: [f64; 2]) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lips_are_red_and_pupils_black() {
        let outside = Vector2::repeat(0.5);
        let red = |y: f64| {
            let c = colour(Vector3::new(0.0, y, 0.08), outside);
            c.x / c.y
        };
        assert!(red(-0.068) > red(0.0) && red(-0.074) > red(-0.1));
        assert!(colour(Vector3::zeros(), Vector2::new(0.1, 0.9)).sum() < 0.1);
    }
}
