//! A film on a half-space 150 times as soft, compressed evenly to two and to four critical
//! strains, against the exact model with finite strains.
//!
//! The anchors are a continuum computed with 48 points per wavelength. The product lays the film on a
//! patch, of which eight by six wavelengths are compressed evenly, and holds it at the border; what is
//! compared lies a wavelength inside the even part and two from the sides. The border still raises the
//! onset by one per cent; over patches 4.5 to 8 wavelengths wide and 6 to 8 long wavelengths differ by
//! up to 0.8 %.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::Vector3;
use ruga_stepper::{LayerSurface, PoseResult};
use ruga_validation::{FlatFilm, baked_lines, cpu_seconds};

use crate::product::{Watch, modelling};
use crate::results::Measure;
use crate::setting::{Coupling, Mesh, Outcome, Run, Solver};

/// Modulus of the film over that of its base.
pub(crate) const RATIO: f64 = 150.0;
/// Loads at which amplitudes are compared, in critical strains, and those of the exact film over
/// `(2/k) sqrt(eps - eps_c)`.
const LOADS: [f64; 2] = [2.0, 4.0];
const AMPLITUDES: [f64; 2] = [0.978, 0.970];

/// Wavelength and onset of the exact film over those of linear theory.
const WAVELENGTH: f64 = 1.006;
const ONSET: f64 = 1.018;

/// Strides, in texels, at which normals are compared along the film and across it.
const STRIDES: [usize; 2] = [2, 14];

/// Runs it and measures.
pub(crate) fn measure(request: &Run) -> Outcome {
    let method = request.setting.method;
    let mut film = FlatFilm::new(RATIO);
    film.layer.coupling = method.coupling.held();
    film.layer.sampling = method.sampling.kind();
    match method.mesh {
        // Squares that two halvings make just fine enough: the planner halves the artist's mesh as it is.
        Mesh::Uniform => film.squares = 0.25 * SQRT_2 * f64::from(request.setting.points),
        Mesh::Adaptive | Mesh::AdaptiveTwo => film.mesh_seed = Some(request.seed),
    }
    let modelling = modelling(request);
    let start = cpu_seconds();
    let result = film.simulate(&modelling, (&LOADS, 1), &mut Watch::new(request));
    let cpu_s = cpu_seconds() - start;
    let result = match result {
        Ok(result) => result,
        Err(error) => return Outcome::failed(error.to_string()),
    };
    let report = &result.layers[0];
    let mut outcome = Outcome {
        failure: failure(&film, &result),
        cpu_s,
        frames: result.frames,
        vertices: report.vertices,
        rows: report.constraints,
        newton_iterations: report.newton_iterations,
        ..Outcome::default()
    };
    if outcome.failure.is_none() {
        compare(&film, &result, &mut outcome);
    }
    // The onset belongs to the discretisation, whatever solves the linear systems. Averages alone buckle
    // where the product does not look for an onset yet.
    let is_sought = method.solver == Solver::Ldlt && method.coupling != Coupling::Constraint;
    if is_sought && let Ok(Some(onset)) = film.onset(&modelling) {
        outcome.errors.insert(Measure::Onset, onset / ONSET - 1.0);
    }
    outcome
}

fn failure(film: &FlatFilm, result: &PoseResult) -> Option<String> {
    let report = &result.layers[0];
    let theory = film.theory();
    // More than noise that the compression has magnified.
    let least = 0.1 / theory.wave_number * ((film.load - 1.0) * theory.critical_strain).sqrt();
    let is_unstable = |warning: &String| warning.contains("unstable one");
    match () {
        () if result.interrupted => Some("time limit".to_owned()),
        () if !result.converged => Some("did not converge".to_owned()),
        () if report.amplitude < least => Some("stayed flat".to_owned()),
        () if result.warnings.iter().any(is_unstable) => Some("ended on a saddle".to_owned()),
        () => None,
    }
}

/// Amplitudes and normals against the anchors.
fn compare(film: &FlatFilm, result: &PoseResult, outcome: &mut Outcome) {
    let surfaces: Vec<&LayerSurface> = result.keys.iter().map(|key| &key.layers[0]).collect();
    let states = [0, 1].map(|i| film.state(surfaces[i], LOADS[i]));
    // Over its own wavelength, whose error is told beside: the same slopes are higher on longer waves.
    let errors = [0, 1].map(|i| states[i].relative_amplitude / AMPLITUDES[i] - 1.0);
    let worse = match errors {
        [early, late] if early.abs() > late.abs() => early,
        [_, late] => late,
    };
    outcome.errors.insert(Measure::Amplitude, worse);
    let wavelength = states[0].relative_wavelength / WAVELENGTH - 1.0;
    outcome.errors.insert(Measure::Wavelength, wavelength);
    let angle = normal_angle(film, surfaces[1]);
    outcome.errors.insert(Measure::Normals, angle);
}

/// The exact film's amplitude at a number of [`LOADS`], m.
fn amplitude(film: &FlatFilm, load: usize) -> f64 {
    let theory = film.theory();
    let excess = (LOADS[load] - 1.0) * theory.critical_strain;
    AMPLITUDES[load] * 2.0 / theory.wave_number * excess.sqrt()
}

/// RMS angle in degrees between the normals of the film's map at four critical strains and those of
/// the exact wave, along lines that are each shifted as suits them best: phase is arbitrary.
///
/// A film under the critical force keeps its arc length: `sin(tilt) = w' / (1 - eps_c)`.
fn normal_angle(film: &FlatFilm, surface: &LayerSurface) -> f64 {
    let theory = film.theory();
    let wavelength = WAVELENGTH * theory.wavelength;
    let steepest = amplitude(film, 1) * TAU / wavelength / (1.0 - theory.critical_strain);
    let per_wave = film.extent()[0] / wavelength;
    let squared = |line: &[(f64, Vector3<f64>)], shift: f64| -> f64 {
        let angle = |(place, normal): &(f64, Vector3<f64>)| {
            let sine = steepest * (TAU * (place * per_wave + shift)).cos();
            let expected = Vector3::new(-sine, 0.0, (1.0 - sine * sine).sqrt());
            normal.angle(&expected).to_degrees().powi(2)
        };
        line.iter().map(angle).sum::<f64>() / line.len() as f64
    };
    let best = |line: &Vec<(f64, Vector3<f64>)>| {
        // Half a thousandth of a wave off is a twentieth of a degree.
        let coarse = (0..50).map(|i| 0.02 * f64::from(i));
        let near = coarse.min_by(|a, b| squared(line, *a).total_cmp(&squared(line, *b)));
        let near = near.unwrap_or(0.0);
        let fine = (-20..=20).map(|i| squared(line, near + 0.001 * f64::from(i)));
        fine.fold(f64::INFINITY, f64::min)
    };
    let (middle, extent) = (film.middle(), film.extent());
    let lines = baked_lines(surface, [0, 1].map(|i| middle[i] / extent[i]), STRIDES);
    let mean = lines.iter().map(best).sum::<f64>() / lines.len() as f64;
    mean.sqrt()
}
