//! How far a skin that does not wrinkle shows the cells below it (RK, figure 4).

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{DMatrix, DVector, Vector3};
use ruga_constraint::constraint_rows;
use ruga_stepper::{CellShape, Coupling, Keyframe, Motion};
use serde::{Deserialize, Serialize};

use super::Slab;

/// Compression of the top by bending, in critical strains: nothing wrinkles.
const STRAIN: f64 = 0.5;

/// Cells along, across and down; a wavelength and a half each.
const CELLS: [u32; 3] = [8, 2, 2];
const CELL: f64 = 1.5;

/// Cells at either end that are left out: the handle, and where it still holds.
const UNEVEN: f64 = 2.0;

/// Degree of the polynomial that the angle of a smoothly bent skin follows.
const DEGREE: usize = 3;

/// What the cells do to the skin.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Artefact {
    /// The lattice's elements: `linear` or `quadratic`.
    pub shape: String,
    /// Mean square of the curvature beside a smooth one over that of the smooth one: what the cells
    /// cost in bending energy.
    pub energy: f64,
    /// RMS angle beside a smooth one, degrees.
    pub angle_deg: f64,
    /// Largest compression along the middle of the skin, in critical strains.
    pub demand: f64,
    /// Place of every piece of the middle line in cells, and its angle beside a smooth one, degrees.
    pub profile: Vec<[f64; 2]>,
}

/// Bends the same slab on elements of both shapes.
///
/// # Errors
/// What the simulator refuses.
pub fn artefact() -> Result<Vec<Artefact>, Box<dyn Error>> {
    let shapes = [
        (CellShape::Linear, "linear"),
        (CellShape::Quadratic, "quadratic"),
    ];
    shapes.into_iter().map(measure).collect()
}

fn measure((shape, name): (CellShape, &str)) -> Result<Artefact, Box<dyn Error>> {
    let mut slab = Slab {
        size: Vector3::repeat(1.0),
        cells: CELLS[0],
        shape,
        young: 5e4,
        ratio: 100.0,
        thickness: 5e-4,
        coupling: Coupling::Hybrid,
        sample: constraint_rows,
        points: 12.0,
        is_fitted: false,
        slices: Vec::new(),
    };
    let theory = slab.theory()?;
    let cell = CELL * theory.wavelength;
    slab.size = Vector3::from(CELLS.map(|cells| f64::from(cells) * cell));
    let end = slab.size.x;
    slab.slices = vec![("left", [-1.0, cell]), ("right", [end - cell, 2.0 * end])];
    let free = end - 2.0 * cell;
    let strain = STRAIN * theory.critical_strain;
    let angle = strain * free / slab.size.z;
    let motions = vec![
        turn("left", angle, [cell, 0.5 * slab.size.z]),
        turn("right", -angle, [end - cell, 0.5 * slab.size.z]),
    ];
    let run = slab.simulate(motions, &[1.0])?;
    let middle = [UNEVEN * cell, end - UNEVEN * cell];
    let sheet = &run.sheets[0];
    let angles = sheet.angles(middle);
    let (smooth, rest) = split(&angles);
    let places = angles.iter().map(|pair| pair[0] / cell);
    Ok(Artefact {
        shape: name.to_owned(),
        energy: roughness(&rest) / roughness(&smooth),
        angle_deg: (rest.norm_squared() / rest.len() as f64)
            .sqrt()
            .to_degrees(),
        profile: places
            .zip(&rest)
            .map(|(x, angle)| [x, angle.to_degrees()])
            .collect(),
        demand: sheet.compression(middle)[0] / theory.critical_strain,
    })
}

/// A turn about y (rad) through a place x, z.
pub(super) fn turn(of: &str, angle: f64, [x, z]: [f64; 2]) -> Motion {
    let frame = Keyframe {
        at: 1.0,
        translation: Vector3::zeros(),
        turn: Vector3::y() * angle,
        about: Vector3::new(x, 0.0, z),
    };
    Motion {
        of: of.into(),
        keyframes: vec![frame],
    }
}

/// Angles (each after its place) as a polynomial, and what is left of them.
fn split(angles: &[[f64; 2]]) -> (DVector<f64>, DVector<f64>) {
    let (first, last) = (angles[0][0], angles[angles.len() - 1][0]);
    let scaled = |x: f64| (2.0 * x - first - last) / (last - first);
    // Chebyshev polynomials, which are well conditioned.
    let term = |i: usize, n: usize| {
        let x = scaled(angles[i][0]).clamp(-1.0, 1.0);
        (n as f64 * (FRAC_PI_2 - x.asin())).cos()
    };
    let matrix = DMatrix::from_fn(angles.len(), DEGREE + 1, term);
    let values = DVector::from_iterator(angles.len(), angles.iter().map(|pair| pair[1]));
    // With more places than terms there is a solution.
    let weights = matrix.clone().svd(true, true).solve(&values, 1e-12);
    let smooth = matrix * weights.expect("singular vectors were asked for");
    let rest = values - &smooth;
    (smooth, rest)
}

/// Sum of the squared steps of an angle: its curvature's energy in units of its own.
fn roughness(angles: &DVector<f64>) -> f64 {
    let steps = angles.as_slice().windows(2);
    steps.map(|ends| (ends[1] - ends[0]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_not_smooth_is_left() {
        let angles = |kink: f64| -> Vec<[f64; 2]> {
            (0..60)
                .map(|i| {
                    let x = 0.1 * f64::from(i);
                    [x, 0.3 * x - 0.02 * x * x * x + kink * x.fract()]
                })
                .collect()
        };
        let (smooth, rest) = split(&angles(0.0));
        assert!(roughness(&rest) < 1e-20 * roughness(&smooth));
        let (_, rest) = split(&angles(0.1));
        // Each of five jumps is of nearly a tenth.
        let jumps = roughness(&rest) / (5.0 * 0.01);
        assert!((0.7..1.3).contains(&jumps), "{jumps}");
    }
}
