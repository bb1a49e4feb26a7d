//! Dominant wavelength and amplitude of a wrinkled layer.

use nalgebra::Vector3;
use ruga_mesh::triangle_frame;

/// Wavelength and amplitude over some faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Waviness {
    /// `2 pi sqrt(int w² / int |grad w|²)`: exact for one sinusoid, m.
    pub(crate) wavelength: f64,
    /// `sqrt(2)` times the RMS of `w`, m.
    pub(crate) amplitude: f64,
}

/// Measures `heights` over `faces` in the rest metric; `None` when they have no area.
pub(crate) fn waviness(
    heights: &[f64],
    rest: &[Vector3<f64>],
    faces: impl Iterator<Item = [u32; 3]>,
) -> Option<Waviness> {
    let (mut area, mut squares, mut slopes) = (0.0, 0.0, 0.0);
    for face in faces {
        let corners = face.map(|v| rest[v as usize]);
        let [a, b, c] = face.map(|v| heights[v as usize]);
        // Slopes are in the rest metric: lengths of posed skin are shorter by the compression.
        let frame = triangle_frame(&corners);
        let edges = [corners[1] - corners[0], corners[2] - corners[0]];
        let [p, q] = edges.map(|e| [e.dot(&frame[0]), e.dot(&frame[1])]);
        let twice_area = p[0] * q[1] - p[1] * q[0];
        let gradient = [
            ((b - a) * q[1] - (c - a) * p[1]) / twice_area,
            ((c - a) * p[0] - (b - a) * q[0]) / twice_area,
        ];
        let piece = 0.5 * twice_area;
        area += piece;
        // The consistent mass integrates the square of a linear function exactly.
        squares += piece / 12.0 * ((a + b + c).powi(2) + a * a + b * b + c * c);
        slopes += piece * (gradient[0].powi(2) + gradient[1].powi(2));
    }
    (area > 0.0).then(|| Waviness {
        wavelength: std::f64::consts::TAU * (squares / slopes).sqrt(),
        amplitude: (2.0 * squares / area).sqrt(),
    })
}
