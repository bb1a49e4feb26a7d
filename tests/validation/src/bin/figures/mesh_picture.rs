//! A layer's mesh in material space, coloured as in Li 2014, figure 6-4: blue is stretched, red is
//! compressed, white is neither.

use std::error::Error;

use nalgebra::Vector2;
use ruga_blend::FaceStrain;
use ruga_mesh::PerFace;

use super::surface::Surface;
use ruga_validation::canvas::Canvas;
use ruga_validation::light::Light;

/// Pixels across.
const WIDTH: usize = 1200;

/// Half the width of an edge, pixels, and the share of its face's light that it keeps.
const EDGE: f64 = 0.35;
const LINE: f64 = 0.2;

const RED: Light = Light::new(0.75, 0.02, 0.02);
const BLUE: Light = Light::new(0.02, 0.08, 0.75);

/// Share of the area that [`full_colour`] leaves in shades, and its room above them.
const SHADED: f64 = 0.75;
const ROOM: f64 = 1.25;

/// The strain to draw in full red or blue: at least `least`, and so much that three quarters of the
/// layer are drawn in shades. A layer on a wrinkled one is compressed in the troughs and stretched
/// on the crests by far more than makes it wrinkle.
pub(super) fn full_colour(layer: &Surface, strains: &PerFace<FaceStrain>, least: f64) -> f64 {
    let corners = layer.corners(&layer.uvs);
    let area = |[a, b, c]: [Vector2<f64>; 3]| (b - a).perp(&(c - a)).abs();
    let mut faces: Vec<(f64, f64)> = strains
        .as_slice()
        .iter()
        .map(|strain| strain.first.max(-strain.second))
        .zip(corners.into_iter().map(area))
        .collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = SHADED * faces.iter().map(|(_, area)| area).sum::<f64>();
    let above = faces.iter().find(|(_, area)| {
        left -= area;
        left <= 0.0
    });
    above.map_or(least, |(strain, _)| least.max(ROOM * strain))
}

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
    use ruga_mesh::TriMesh;

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
    fn three_quarters_of_the_area_are_drawn_in_shades() {
        // A strip of three unit squares and one of two; only the last triangle is compressed more.
        let uvs: Vec<Vector2<f64>> = [0.0, 1.0, 2.0, 3.0, 5.0]
            .into_iter()
            .flat_map(|x| [[x, 0.0], [x, 1.0]].map(Vector2::from))
            .collect();
        let triangles = (0..8).map(|i| [i + i % 2, i + 1 - i % 2, i + 2]).collect();
        let layer = Surface {
            mesh: TriMesh::new(uvs.len(), triangles).unwrap(),
            positions: uvs.iter().map(|uv| uv.push(0.0)).collect(),
            uvs,
        };
        let strain =
            |x: f64| FaceStrain::from_cauchy_green(Matrix2::new((1.0 - x).powi(2), 0.0, 0.0, 1.0));
        let [little, much] = [0.02, 0.2].map(strain);
        let strains = [vec![little; 7], vec![much]].concat();
        let strains = PerFace::from(strains);
        let found = |least| full_colour(&layer, &strains, least);
        assert!((found(0.01) - ROOM * 0.02).abs() < 1e-12);
        assert_eq!(found(0.05), 0.05);
        // The two large triangles are two fifths of the area.
        let strains = PerFace::from([vec![little; 6], vec![much; 2]].concat());
        assert!((full_colour(&layer, &strains, 0.01) - ROOM * 0.2).abs() < 1e-12);
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
