//! Lines of equal value over samples on a grid.

use ruga_validation::body::Isocontour;

/// Pieces of the line on which the wavelength at the end is `level` (m), each from and to a thickness
/// (m) and a ratio.
///
/// Between samples the logarithm of the wavelength is linear in those of thickness and ratio, as
/// theory has it.
pub(crate) fn contour(samples: &[&Isocontour], level: f64) -> Vec<[[f64; 2]; 2]> {
    let sorted = |of: &dyn Fn(&Isocontour) -> f64| {
        let mut values: Vec<f64> = samples.iter().map(|own| of(own)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let thicknesses = sorted(&|own| own.sample.thickness);
    let ratios = sorted(&|own| own.sample.ratio);
    let corner = |i: usize, j: usize| {
        let own = samples
            .iter()
            .find(|own| own.sample.thickness == thicknesses[i] && own.sample.ratio == ratios[j])?;
        Some((
            [own.sample.thickness, own.sample.ratio],
            (own.measured[1]? / level).ln(),
        ))
    };
    let mut pieces = Vec::new();
    for j in 1..ratios.len() {
        for i in 1..thicknesses.len() {
            let around = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)];
            let corners: Vec<_> = around.iter().filter_map(|(i, j)| corner(*i, *j)).collect();
            if let Ok(corners) = <[([f64; 2], f64); 4]>::try_from(corners) {
                pieces.extend(piece(corners));
            }
        }
    }
    pieces
}

/// The line through a cell, whose corners have the logarithms of their values over the level.
fn piece(corners: [([f64; 2], f64); 4]) -> Option<[[f64; 2]; 2]> {
    let mut ends = Vec::new();
    for i in 0..4 {
        let [(a, at_a), (b, at_b)] = [corners[i], corners[(i + 1) % 4]];
        if (at_a < 0.0) != (at_b < 0.0) {
            let share = at_a / (at_a - at_b);
            ends.push([0, 1].map(|c| a[c] * (b[c] / a[c]).powf(share)));
        }
    }
    <[[f64; 2]; 2]>::try_from(ends).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_equal_wavelength_is_where_it_is() {
        let sample = |thickness: f64, ratio: f64| {
            let wavelength = Some(thickness * ratio.cbrt());
            crate::findings::tests::sample(thickness, ratio, wavelength)
        };
        let samples = [
            sample(1.0, 1.0),
            sample(2.0, 1.0),
            sample(1.0, 8.0),
            sample(2.0, 8.0),
        ];
        let samples: Vec<&Isocontour> = samples.iter().collect();
        let pieces = contour(&samples, 1.7);
        assert_eq!(pieces.len(), 1);
        for [thickness, ratio] in pieces[0] {
            assert!((thickness * ratio.cbrt() - 1.7).abs() < 1e-9);
        }
        assert!(contour(&samples, 5.0).is_empty());
    }
}
