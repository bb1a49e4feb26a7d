//! A film on a half-space 150 times as soft, compressed evenly to four critical strains in eight
//! frames, against the exact model with finite strains.
//!
//! The anchors are those that the tests of the film have: a continuum computed with 48 points per
//! wavelength. The box is six of *its* wavelengths long, so that the right waves fit; how long
//! waves are by themselves is measured apart, on boxes of several lengths.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use ruga_solver::NewtonSettings;
use ruga_validation::{Film, FilmSpec, Noise, Rectangle, Step, Strip};

use crate::cpu_time::cpu_seconds;
use crate::results::Measure;
use crate::setting::{Coupling, Outcome, Run, Solver};

const RATIO: f64 = 150.0;
/// Extent in wavelengths: two rows of averages fit across.
const WAVES: [f64; 2] = [6.0, 2.0];
/// Frames, in critical strains.
const LOADS: [f64; 8] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0];
/// Share by which every vertex wants its edges longer or shorter.
const JITTER: f64 = 0.1;
/// Longest edge along the wrinkles, in wavelengths, as the product's meshes have it.
const LONGEST: f64 = 0.5;

/// Lengths of the boxes in which the first mode is looked for, over that of the box: half a wave
/// apart.
const BOXES: [f64; 9] = [0.96, 0.97, 0.98, 0.99, 1.0, 1.01, 1.02, 1.03, 1.04];
/// The same where every box has to be bisected.
const FEW_BOXES: [f64; 3] = [0.97, 1.0, 1.03];

/// Wavelength and onset over those of linear theory.
const WAVELENGTH: f64 = 1.006;
const ONSET: f64 = 1.018;
/// Amplitudes at two and four critical strains over `(2/k) sqrt(eps - eps_c)`.
const AMPLITUDES: [(f64, f64); 2] = [(2.0, 0.978), (4.0, 0.970)];
/// Energy gap at four critical strains over `C/2 (eps - eps_c)^2`.
const GAP: f64 = 0.890;

/// Runs it and measures.
pub(crate) fn measure(request: &Run) -> Outcome {
    let method = request.setting.method;
    let mut spec = FilmSpec::flat(RATIO);
    spec.coupling = method.coupling.of_film();
    spec.bending = method.bending.model();
    let start = cpu_seconds();
    let strip = meshed(&spec, request);
    let mut film = laid(&spec, strip.clone(), request);
    let settings = NewtonSettings {
        seed: request.seed,
        ..NewtonSettings::default()
    };
    film.linear = method.solver.kind();
    let mut in_time = |_: &_| cpu_seconds() - start < request.limit_s;
    let steps = film.ramp_with(&LOADS, noise(method.solver), &settings, &mut in_time);
    let cpu_s = cpu_seconds() - start;

    let mut outcome = Outcome {
        failure: failure(&mut film, &steps, cpu_s, request),
        cpu_s,
        frames: LOADS.len(),
        vertices: film.vertex_count(),
        rows: film.average_count() / 3,
        newton_iterations: steps.iter().map(|s| s.solve.iterations).sum(),
        ..Outcome::default()
    };
    compare(&film, &steps, &mut outcome);
    // The first mode belongs to the discretisation, whatever solves the linear systems.
    if method.solver == Solver::Ldlt
        && let Some([wavelength, onset]) = first_mode(&spec, &strip, request)
    {
        let errors = &mut outcome.errors;
        errors.insert(Measure::Wavelength, wavelength / WAVELENGTH - 1.0);
        errors.insert(Measure::Onset, onset / ONSET - 1.0);
    }
    outcome
}

/// MINRES knows no inertia: it has to be pushed off the flat saddle, at rest by a thickness, with
/// which averages alone begin to wrinkle in the first frame, and a little before every frame.
fn noise(solver: Solver) -> Noise {
    let [first, every] = match solver {
        Solver::Ldlt => [1e-3, 0.0],
        Solver::Minres => [1.0, 1e-2],
    };
    Noise { first, every }
}

fn meshed(spec: &FilmSpec, request: &Run) -> Strip {
    let wavelength = WAVELENGTH * spec.theory().wavelength;
    let [length, width] = WAVES.map(|waves| waves * wavelength);
    let rectangle = Rectangle {
        length,
        width,
        radius: None,
    };
    let across = wavelength / f64::from(request.setting.points);
    let aspect = request.setting.method.aspect().unwrap_or(1.0);
    let along = (aspect * across).min(LONGEST * wavelength);
    let mesh = rectangle.fitted([across, along], JITTER, request.seed);
    Strip::of(&mesh, &rectangle)
}

fn laid(spec: &FilmSpec, strip: Strip, request: &Run) -> Film {
    let mut film = Film::sampled(spec, strip, request.setting.method.sampling.kind());
    film.calibrate_bending();
    film
}

fn failure(film: &mut Film, steps: &[Step], cpu_s: f64, request: &Run) -> Option<String> {
    let reached = steps.last().map_or(0.0, |step| step.load);
    if reached < LOADS[LOADS.len() - 1] - 1e-9 {
        let reason = if cpu_s >= request.limit_s {
            "time limit"
        } else {
            "gave up"
        };
        return Some(format!("{reason} at {reached:.2} critical strains"));
    }
    if steps.last().is_some_and(|step| !has_wrinkled(film, step)) {
        return Some("stayed flat".to_owned());
    }
    match film.is_minimum() {
        Ok(true) => None,
        Ok(false) => Some("ended on a saddle".to_owned()),
        Err(error) => Some(error.to_string()),
    }
}

/// Whether a step is more than noise that the compression has magnified.
fn has_wrinkled(film: &Film, step: &Step) -> bool {
    let theory = &film.wrinkling;
    step.amplitude > 0.1 * amplitude(theory.wavelength, theory.critical_strain, step.load)
}

/// Amplitudes, energy gap and normals against the anchors, as far as the run got.
fn compare(film: &Film, steps: &[Step], outcome: &mut Outcome) {
    let theory = &film.wrinkling;
    let at = |load: f64| steps.iter().find(|step| (step.load - load).abs() < 1e-9);
    let errors = AMPLITUDES.map(|(load, anchor)| {
        let expected = anchor * amplitude(theory.wavelength, theory.critical_strain, load);
        Some(at(load)?.amplitude / expected - 1.0)
    });
    if let [Some(early), Some(late)] = errors {
        let worse = if early.abs() > late.abs() {
            early
        } else {
            late
        };
        outcome.errors.insert(Measure::Amplitude, worse);
    }
    if let Some(step) = at(4.0) {
        let errors = &mut outcome.errors;
        errors.insert(Measure::Gap, step.relative_gap / GAP - 1.0);
        errors.insert(Measure::Normals, normal_angle(film));
        outcome.wavelength = Some(step.relative_wavelength / WAVELENGTH);
    }
}

/// Amplitude of theory, m, before the anchor's factor.
fn amplitude(wavelength: f64, critical_strain: f64, load: f64) -> f64 {
    wavelength / TAU * 2.0 * ((load - 1.0) * critical_strain).sqrt()
}

/// RMS angle in degrees between the film's normals at four critical strains and those of the
/// anchor's wave, along lines that are each shifted as suits them best: phase is arbitrary.
///
/// A film under the critical force keeps its arc length: `sin(tilt) = w' / (1 - eps_c)`.
fn normal_angle(film: &Film) -> f64 {
    let theory = &film.wrinkling;
    let wavelength = WAVELENGTH * theory.wavelength;
    let anchor = AMPLITUDES[1].1;
    let height = anchor * amplitude(theory.wavelength, theory.critical_strain, 4.0);
    let steepest = height * TAU / wavelength / (1.0 - theory.critical_strain);
    let squared = |line: &[(Vector2<f64>, Vector3<f64>)], shift: f64| -> f64 {
        let angle = |(place, normal): &(Vector2<f64>, Vector3<f64>)| {
            let sine = steepest * (TAU * (place.x / wavelength + shift)).cos();
            let expected = Vector3::new(-sine, 0.0, (1.0 - sine * sine).sqrt());
            normal.angle(&expected).to_degrees().powi(2)
        };
        line.iter().map(angle).sum::<f64>() / line.len() as f64
    };
    let lines = lines(wavelength);
    let best = |line: &[Vector2<f64>]| {
        let line = film.smooth_normals(line);
        // Half a thousandth of a wave off is a twentieth of a degree.
        let coarse = (0..50).map(|i| 0.02 * f64::from(i));
        let near = coarse.min_by(|a, b| squared(&line, *a).total_cmp(&squared(&line, *b)));
        let near = near.unwrap_or(0.0);
        let fine = (-20..=20).map(|i| squared(&line, near + 0.001 * f64::from(i)));
        fine.fold(f64::INFINITY, f64::min)
    };
    let mean = lines.iter().map(|line| best(line)).sum::<f64>() / lines.len() as f64;
    mean.sqrt()
}

/// Lines across the wrinkles, from the film's middle: all but a wave at the ends and a quarter along
/// the sides.
fn lines(wavelength: f64) -> Vec<Vec<Vector2<f64>>> {
    let (columns, rows) = (32 * (WAVES[0] as usize - 2), 12);
    let place = |column: usize, row: usize| {
        let [x, y] = [column, row].map(|i| i as f64 + 0.5);
        let x = (x / columns as f64 - 0.5) * (WAVES[0] - 2.0);
        let y = 0.25 + y / rows as f64 * (WAVES[1] - 0.5);
        Vector2::new(x, y) * wavelength
    };
    (0..rows)
        .map(|row| (0..columns).map(|column| place(column, row)).collect())
        .collect()
}

/// Wavelength and onset of the mode that buckles first, over those of linear theory, free of the
/// box: boxes of several lengths give as many waves and the loads at which they appear, and the least
/// point of the curve through them is looked for.
///
/// Averages alone have no such curve, as every box places them anew: the mean deviation of the waves
/// and the median of the loads then.
fn first_mode(spec: &FilmSpec, strip: &Strip, request: &Run) -> Option<[f64; 2]> {
    let (guess, boxes) = match request.setting.method.coupling {
        Coupling::Constraint => (None, FEW_BOXES.as_slice()),
        Coupling::Elastic | Coupling::Hybrid => (Some(0.985), BOXES.as_slice()),
    };
    let mut waves = Vec::new();
    for &factor in boxes {
        let mut film = laid(spec, strip.stretched(factor), request);
        let start = match guess {
            Some(guess) => guess,
            None => bracketed(&mut film)?,
        };
        waves.push(onset(&mut film, start)?);
    }
    match request.setting.method.coupling {
        Coupling::Constraint => {
            let onset = median(waves.iter().map(|wave| wave[1]).collect())?;
            let off = waves.iter().map(|wave| (wave[0] / WAVELENGTH - 1.0).abs());
            let mean = off.sum::<f64>() / waves.len() as f64;
            Some([WAVELENGTH * (1.0 + mean), onset])
        }
        Coupling::Elastic | Coupling::Hybrid => least(&waves),
    }
}

/// Wavelength and load of the first mode, by secants on its stiffness.
fn onset(film: &mut Film, start: f64) -> Option<[f64; 2]> {
    let mut stiffness = |load: f64| film.flat_mode(load, 1).ok();
    let (mut before, mut load) = (start, 1.01 * start);
    let mut stiffness_before = stiffness(before)?.stiffness;
    for _ in 0..8 {
        let mode = stiffness(load)?;
        let slope = (mode.stiffness - stiffness_before) / (load - before);
        let next = load - mode.stiffness / slope;
        // What a secant is off by after a step this short is far below a millionth.
        if (next - load).abs() < 2e-4 * load {
            return Some([mode.relative_wavelength, next]);
        }
        if !(next.is_finite() && next > 0.0) {
            return None;
        }
        (before, stiffness_before, load) = (load, mode.stiffness, next);
    }
    None
}

/// A load near the onset, by bisection on the inertia.
fn bracketed(film: &mut Film) -> Option<f64> {
    let (mut low, mut high) = (0.02_f64, 1.5_f64);
    while high / low > 1.02 {
        let middle = (low * high).sqrt();
        film.lay_down(middle, 0.0, 0);
        match film.is_minimum().ok()? {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(high)
}

/// Least point of the curve through most of them: with a foundation of half-space stiffness at a wave
/// longer or shorter by the share `x`, the load is greater by `4/3 x^2` of itself.
///
/// On coarse meshes waves of nearly equal loads mix, and one box in ten gives one that is none of
/// them: medians of the slopes between two boxes, and of the loads, pass that over.
fn least(waves: &[[f64; 2]]) -> Option<[f64; 2]> {
    let curvature = 4.0 / 3.0 * median(waves.iter().map(|wave| wave[1]).collect())?;
    let lowered = |wave: &[f64; 2]| {
        let x = wave[0].ln();
        [x, wave[1] - curvature * x * x]
    };
    let places: Vec<[f64; 2]> = waves.iter().map(lowered).collect();
    let pairs = (0..places.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let slopes = pairs.filter_map(|(i, j)| {
        let [dx, dy] = [0, 1].map(|k| places[i][k] - places[j][k]);
        (dx.abs() > SAME_WAVE).then(|| dy / dx)
    });
    let slope = median(slopes.collect())?;
    let y = median(places.iter().map(|[x, y]| y - slope * x).collect())?;
    let least = -0.5 * slope / curvature;
    (least.abs() < 0.2).then(|| [least.exp(), y - curvature * least * least])
}

/// Wavelengths closer than this share are no two places of a curve.
const SAME_WAVE: f64 = 0.005;

/// `None` of nothing.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
