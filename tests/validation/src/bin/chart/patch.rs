//! A flat patch of skin that a blend shape compresses to three critical strains in its middle and
//! not at all at its ends, through the product's own planner and stepper: what a user waits for.
//!
//! Nobody knows its wrinkles exactly; they are compared with those of a finer mesh.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use ruga_stepper::{LayerSpec, LayerSurface, plan};
use ruga_validation::{FlatFilm, baked_lines, cpu_seconds, patch_driver, patch_pose};

use crate::film::RATIO;
use crate::product::{Watch, modelling};
use crate::results::Measure;
use crate::setting::{Outcome, PatchShape, Run};

/// Extent in wavelengths.
const WAVES: [f64; 2] = [8.0, 3.0];
/// Compression in the middle, in critical strains.
const PEAK: f64 = 3.0;
/// Squares of the artist's mesh.
const SQUARES: [usize; 2] = [32, 12];
/// Texels of the map that the plan is for.
const TEXELS: u32 = 1024;

/// Extent in wavelengths, about the middle, of what is compared, and strides in texels along it and
/// across.
const COMPARED: [f64; 2] = [4.0, 1.0];
const STRIDES: [usize; 2] = [2, 21];

/// Runs it and measures; without a reference it becomes one.
pub(crate) fn measure(request: &Run, reference: Option<&PatchShape>) -> Outcome {
    let film = FlatFilm::new(RATIO);
    let theory = film.theory();
    let extent = WAVES.map(|waves| waves * theory.wavelength);
    // The integral of -peak (1 + cos(2 pi x / length)) / 2.
    let shape = |p: Vector2<f64>| {
        let wave = extent[0] / TAU * (TAU * p.x / extent[0]).sin();
        let moved = -0.5 * PEAK * theory.critical_strain * (p.x + wave);
        [p.push(0.0), Vector3::new(p.x + moved, p.y, 0.0)]
    };
    let driver = patch_driver(extent, SQUARES, None, shape);
    let pose = patch_pose(&driver, vec![1.0], 1);
    let method = request.setting.method;
    let layers = [LayerSpec {
        coupling: method.coupling.held(),
        sampling: method.sampling.kind(),
        ..film.layer
    }];
    let modelling = modelling(request);
    let start = cpu_seconds();
    let mut watch = Watch::new(request);
    let poses = std::slice::from_ref(&pose);
    let result = plan(&driver, &layers, poses, &modelling, TEXELS)
        .and_then(|plan| plan.simulate(0, &mut watch));
    let cpu_s = cpu_seconds() - start;
    let result = match result {
        Ok(result) => result,
        Err(error) => return Outcome::failed(error.to_string()),
    };
    let report = &result.layers[0];
    let mut outcome = Outcome {
        failure: match (result.interrupted, result.converged) {
            (true, _) => Some("time limit".to_owned()),
            (_, false) => Some("did not converge".to_owned()),
            _ => None,
        },
        cpu_s,
        frames: result.frames,
        vertices: report.vertices,
        rows: report.constraints,
        newton_iterations: report.newton_iterations,
        ..Outcome::default()
    };
    let surface = result.keys.last().and_then(|key| key.layers.last());
    let (Some(surface), Some(found)) = (surface, report.wavelength) else {
        outcome.failure = outcome.failure.or(Some("stayed flat".to_owned()));
        return outcome;
    };
    let shape = PatchShape {
        wavelength: found,
        amplitude: report.amplitude,
        lines: lines(surface),
    };
    match reference {
        Some(reference) => compare(&shape, reference, &mut outcome),
        None => outcome.shape = Some(shape),
    }
    outcome
}

/// Normals of the map along lines across the wrinkles.
fn lines(surface: &LayerSurface) -> Vec<Vec<f64>> {
    let shares = [0, 1].map(|i| COMPARED[i] / WAVES[i]);
    // Four digits are a hundredth of a degree.
    let round = |value: f64| (1e4 * value).round() * 1e-4;
    let line = |line: &Vec<(f64, Vector3<f64>)>| {
        let normals = line.iter();
        normals
            .flat_map(|(_, n)| [round(n.x), round(n.y)])
            .collect()
    };
    baked_lines(surface, shares, STRIDES)
        .iter()
        .map(line)
        .collect()
}

fn compare(shape: &PatchShape, reference: &PatchShape, outcome: &mut Outcome) {
    let errors = &mut outcome.errors;
    errors.insert(
        Measure::PatchWavelength,
        shape.wavelength / reference.wavelength - 1.0,
    );
    errors.insert(
        Measure::PatchAmplitude,
        shape.amplitude / reference.amplitude - 1.0,
    );
    let pairs = shape.lines.iter().zip(&reference.lines);
    let squares: Vec<f64> = pairs
        .map(|(line, wanted)| best_shift(line, wanted))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    errors.insert(Measure::PatchNormals, mean.sqrt());
}

/// Mean squared angle (degrees) between two lines of normals, one of them shifted as suits it best,
/// by half a wave either way: phase is arbitrary.
fn best_shift(line: &[f64], wanted: &[f64]) -> f64 {
    let count = line.len() / 2;
    let normal = |line: &[f64], i: usize| {
        let [x, y] = [line[2 * i], line[2 * i + 1]];
        Vector3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
    };
    let reach = 0.5 * count as f64 / COMPARED[0];
    let squared = |shift: f64| {
        let (mut sum, mut terms) = (0.0, 0.0);
        for i in 0..count {
            let place = i as f64 + shift;
            if place < 0.0 || place >= (count - 1) as f64 {
                continue;
            }
            let (low, share) = (place as usize, place.fract());
            let shifted = normal(line, low) * (1.0 - share) + normal(line, low + 1) * share;
            sum += shifted.angle(&normal(wanted, i)).to_degrees().powi(2);
            terms += 1.0;
        }
        sum / terms
    };
    let steps = (10.0 * reach) as i32;
    let shifts = (-steps..=steps).map(|step| 0.1 * f64::from(step));
    shifts.map(squared).fold(f64::INFINITY, f64::min)
}
