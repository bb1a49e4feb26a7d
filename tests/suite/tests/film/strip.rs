//! Film on a half-space against the finite-strain anchors (exact continuum, 48 points per
//! wavelength): onset `eps_c (1 + eps_c)`, wavelength `lam_c (1 + eps_c / 3)`, the amplitudes and
//! energy gaps below.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_validation::{Film, FilmSpec, Step, Strip, unstructured};

/// Waves in a strip.
const WAVES: usize = 8;
/// Rows of triangles: 1.5 wavelengths.
const ROWS: usize = 20;
/// Loads in critical strains.
const LOADS: [f64; 5] = [1.25, 1.5, 2.0, 3.0, 4.0];

/// Amplitudes at `LOADS` over `(2/k) sqrt(eps - eps_c)` for modulus ratios 150 and 1000.
const ANCHORS_150: [f64; 5] = [0.951, 0.972, 0.978, 0.975, 0.970];
const ANCHORS_1000: [f64; 5] = [0.986, 0.992, 0.994, 0.994, 0.992];

/// Energy gaps at 3 and 4 critical strains over `-C/2 (eps - eps_c)^2`: 0.90 and 0.89 at ratio
/// 150; the deviation follows the critical strain, so 0.97 at 1000.
const GAPS_150: [f64; 2] = [0.900, 0.890];
const GAPS_1000: [f64; 2] = [0.970, 0.970];

fn strip(spec: &FilmSpec, seed: Option<u64>) -> Strip {
    let even = spec.strip(WAVES as f64, ROWS);
    match seed {
        None => even,
        Some(seed) => unstructured(even.length, WAVES * FilmSpec::POINTS as usize, ROWS, seed),
    }
}

fn print(name: &str, steps: &[Step]) {
    for step in steps {
        println!(
            "{name}: load {:.3}  lam {:.3}  A {:.3}  gap {:.3}  iterations {}  factorizations {}  {:?}",
            step.load,
            step.relative_wavelength,
            step.relative_amplitude,
            step.relative_gap,
            step.solve.iterations,
            step.solve.factorizations,
            step.solve.stop,
        );
    }
}

/// Compares one film with the anchors and returns its number of waves.
fn check(ratio: f64, seed: Option<u64>, anchors: [f64; 5], gaps: [f64; 2]) -> f64 {
    let name = format!("ratio {ratio}, mesh {seed:?}");
    let spec = FilmSpec::flat(ratio);
    let mut film = Film::new(&spec, strip(&spec, seed));
    film.calibrate_bending();
    let onset = film.onset(0.9, 1.15);
    let expected = 1.0 + film.wrinkling.critical_strain;
    println!("{name}: onset {onset:.4}, anchor {expected:.4}");
    assert!((onset / expected - 1.0).abs() < 0.03, "onset {onset}");

    let steps = film.ramp(&LOADS, 1);
    print(&name, &steps);
    let first = steps
        .iter()
        .find(|step| step.solve.left_saddle)
        .expect("the film buckles");
    assert!(first.load < 1.15 * onset, "landed at {}", first.load);
    assert!(first.solve.iterations <= 12, "{}", first.solve.iterations);
    for step in steps.iter().filter(|step| step.load > first.load) {
        assert!(step.solve.converged);
        assert!(step.solve.iterations <= 6, "{}", step.solve.iterations);
        // Ends allow multiples of half a wave only; the next one costs 0.9 % of the energy gap.
        let waves = WAVES as f64 / step.relative_wavelength;
        assert!((waves - WAVES as f64).abs() < 0.6, "{waves} waves");
    }
    for (load, anchor) in LOADS.iter().zip(anchors).skip(1) {
        let error = at(&steps, *load).relative_amplitude / anchor - 1.0;
        assert!(error.abs() < 0.03, "amplitude at {load}: {error:+.3}");
    }
    for (load, anchor) in LOADS.iter().skip(3).zip(gaps) {
        let error = at(&steps, *load).relative_gap / anchor - 1.0;
        assert!(error.abs() < 0.03, "energy gap at {load}: {error:+.3}");
    }
    WAVES as f64 / steps.last().expect("a ramp").relative_wavelength
}

/// Checks a film on three meshes: seven and a half waves are chosen now and then, but not mostly.
fn check_unstructured(ratio: f64, seeds: [u64; 3], anchors: [f64; 5], gaps: [f64; 2]) {
    let mut waves = seeds.map(|seed| check(ratio, Some(seed), anchors, gaps));
    waves.sort_by(f64::total_cmp);
    println!("ratio {ratio}, meshes {seeds:?}: {waves:?} waves");
    assert!((waves[1] - WAVES as f64).abs() < 0.1, "{waves:?} waves");
}

fn at(steps: &[Step], load: f64) -> &Step {
    steps
        .iter()
        .find(|step| (step.load - load).abs() < 1e-9)
        .expect("every load is hit")
}

#[test]
fn hybrid_equilateral_150() {
    let waves = check(150.0, None, ANCHORS_150, GAPS_150);
    assert!((waves - WAVES as f64).abs() < 0.1, "{waves} waves");
}

#[test]
fn hybrid_equilateral_1000() {
    let waves = check(1000.0, None, ANCHORS_1000, GAPS_1000);
    assert!((waves - WAVES as f64).abs() < 0.1, "{waves} waves");
}

#[test]
fn hybrid_unstructured_150() {
    check_unstructured(150.0, [7, 8, 9], ANCHORS_150, GAPS_150);
}

#[test]
fn hybrid_unstructured_1000() {
    check_unstructured(1000.0, [7, 8, 9], ANCHORS_1000, GAPS_1000);
}
