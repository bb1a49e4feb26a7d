//! Film on a half-space against the finite-strain anchors (exact continuum, 48 points per
//! wavelength): onset `eps_c (1 + eps_c)`, wavelength `lam_c (1 + eps_c / 3)` and the amplitudes
//! below.

use ruga_tests::{Base, Film, FilmCoupling, Step, Strip, equilateral, unstructured};

/// Waves in a strip and points per wavelength.
const WAVES: usize = 8;
const POINTS: usize = 12;
/// Rows of triangles: 1.5 wavelengths.
const ROWS: usize = 20;
/// Loads in critical strains.
const LOADS: [f64; 5] = [1.25, 1.5, 2.0, 3.0, 4.0];

/// Amplitudes at `LOADS` over `(2/k) sqrt(eps - eps_c)` for modulus ratios 150 and 1000.
const ANCHORS_150: [f64; 5] = [0.951, 0.972, 0.978, 0.975, 0.970];
const ANCHORS_1000: [f64; 5] = [0.986, 0.992, 0.994, 0.994, 0.992];

fn strip(ratio: f64, seed: Option<u64>) -> Strip {
    let length = WAVES as f64 * Film::theory(ratio).wavelength;
    match seed {
        None => equilateral(length, WAVES * POINTS, ROWS),
        Some(seed) => unstructured(length, WAVES * POINTS, ROWS, seed),
    }
}

fn print(name: &str, steps: &[Step]) {
    for step in steps {
        println!(
            "{name}: load {:.3}  lam {:.3}  A {:.3}  iterations {}  factorizations {}  {:?}",
            step.load,
            step.relative_wavelength,
            step.relative_amplitude,
            step.solve.iterations,
            step.solve.factorizations,
            step.solve.stop,
        );
    }
}

fn check(ratio: f64, seed: Option<u64>, anchors: [f64; 5]) {
    let name = format!("ratio {ratio}, mesh {seed:?}");
    let mut film = Film::new(ratio, strip(ratio, seed), Base::Flat, FilmCoupling::Hybrid);
    let onset = film.onset(0.9, 1.15);
    let expected = 1.0 + film.wrinkling.critical_strain;
    println!("{name}: onset {onset:.4}, anchor {expected:.4}");
    assert!((onset / expected - 1.0).abs() < 0.03, "onset {onset}");

    let steps = film.ramp(&LOADS, 1);
    print(&name, &steps);
    // Half a wave more or less in the box is quantisation, not error.
    let quantum = 1.0 / (2 * WAVES) as f64;
    let first = steps
        .iter()
        .find(|step| step.solve.left_saddle)
        .expect("the film buckles");
    assert!(first.load < 1.15 * onset, "landed at {}", first.load);
    assert!(first.solve.iterations <= 12, "{}", first.solve.iterations);
    for step in steps.iter().filter(|step| step.load > first.load) {
        assert!(step.solve.converged);
        assert!(step.solve.iterations <= 6, "{}", step.solve.iterations);
        assert!((step.relative_wavelength - 1.0).abs() <= 0.03_f64.max(quantum));
    }
    for (load, anchor) in LOADS.iter().zip(anchors).skip(1) {
        let step = steps
            .iter()
            .find(|step| (step.load - load).abs() < 1e-9)
            .expect("every load is hit");
        let error = step.relative_amplitude / anchor - 1.0;
        assert!(error.abs() < 0.03, "amplitude at {load}: {error:+.3}");
    }
}

#[test]
fn hybrid_equilateral_150() {
    check(150.0, None, ANCHORS_150);
}

#[test]
fn hybrid_equilateral_1000() {
    check(1000.0, None, ANCHORS_1000);
}

#[test]
fn hybrid_unstructured_150() {
    check(150.0, Some(7), ANCHORS_150);
}

#[test]
fn hybrid_unstructured_1000() {
    check(1000.0, Some(8), ANCHORS_1000);
}
