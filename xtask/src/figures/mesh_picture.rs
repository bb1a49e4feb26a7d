//! A layer's mesh in material space, coloured as in Li 2014, figure 6-4: blue is stretched, red is
//! compressed, white is neither.

use std::error::Error;

use nalgebra::Vector2;
use ruga_blend::FaceStrain;
use ruga_mesh::PerFace;

use super::canvas::Canvas;
use super::surface::Surface;
use crate::light::Light;

/// Pixels across.
const WIDTH: usize = 1200;

/// Half the width of an edge, pixels, and the share of its face's light that it keeps.
const EDGE: f64 = 0.35;
const LINE: f64 = 0.2;

const RED: Light = Light::new(0.75, 0.02, 0.02);
const BLUE: Light = Light::new(0.02, 0.08, 0.75);

/// Draws a mesh; a principal strain of `full_colour` or more is drawn in full red or blue.
pub(super) fn draw(
    layer: &Surface,
    strains: &PerFace<FaceStrain>,
    full_colour: f64,
) -> Result<Canvas, Box<dyn Error>> {
    // V points down.
    let places: Vec<Vector2<f64>> = layer
        .uvs
        .iter()
        .map(|uv| Vector2::new(uv.x, -uv.y))
        .collect();
    if places.is_empty() {
        return Err("an empty layer has no mesh to draw".into());
    }
    let mut canvas = Canvas::around(places.iter(), WIDTH);
    let pixels = canvas.pixels_per_length();
    for (corners, strain) in layer.corners(&places).into_iter().zip(strains.as_slice()) {
        let face = colour(strain, full_colour);
        let heights = heights(corners).map(|height| height * pixels);
        canvas.triangle(corners.map(|p| p.push(0.0)), |inside| {
            let on_edge = (0..3).any(|i| inside[i] * heights[i] < EDGE);
            if on_edge { face * LINE } else { face }
        });
    }
    Ok(canvas)
}

/// The colour of the larger principal strain.
fn colour(strain: &FaceStrain, full_colour: f64) -> Light {
    let compressed = strain.first >= -strain.second;
    let (value, full) = if compressed {
        (strain.first, RED)
    } else {
        (-strain.second, BLUE)
    };
    Light::repeat(1.0).lerp(&full, (value / full_colour).clamp(0.0, 1.0))
}

/// Distance of every corner of a triangle from the edge opposite to it.
fn heights(corners: [Vector2<f64>; 3]) -> [f64; 3] {
    let [a, b, c] = corners;
    let twice_area = (b - a).perp(&(c - a)).abs();
    [c - b, a - c, b - a].map(|edge| twice_area / edge.norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;

    #[test]
    fn compression_is_red_and_stretch_is_blue() {
        let strain = |x: f64, y: f64| {
            let stretches = Matrix2::new((1.0 - x).powi(2), 0.0, 0.0, (1.0 - y).powi(2));
            colour(&FaceStrain::from_cauchy_green(stretches), 0.05)
        };
        let close = |a: Light, b: Light| (a - b).norm() < 1e-9;
        assert!(close(strain(0.05, 0.0), RED));
        assert!(close(strain(0.01, -0.05), BLUE));
        assert!(close(strain(-0.5, -0.2), BLUE));
        assert!(close(strain(0.0, 0.0), Light::repeat(1.0)));
        let half = strain(0.025, -0.01);
        assert!(half.x > half.z && half.z > RED.z);
    }

    #[test]
    fn heights_of_a_right_triangle() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]].map(Vector2::from);
        let found = heights(corners);
        for (found, expected) in found.into_iter().zip([2.4, 3.0, 4.0]) {
            assert!((found - expected).abs() < 1e-12);
        }
    }
}
