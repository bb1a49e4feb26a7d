//! T1 and T2: what a solve starts from.

use nalgebra::Vector3;
use ruga_validation::baselines::LinearSolver;
use ruga_validation::{Film, FilmSpec, Finding, Step, table_line};

use crate::{compressed, exact};

const ROWS: usize = 6;
const LOAD: f64 = 2.0;
#[test]
fn t1_perfect_flat_start() {
    let test = "T1 perfectly flat at 2 eps_c";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(6.0, ROWS);
    let mut film = Film::new(&spec, strip.clone());
    film.lay_down(LOAD, 0.0, 1);
    film.linear = LinearSolver::minres();
    let solve = film.solve(LOAD, &exact());
    film.linear = LinearSolver::Ldlt;
    assert!(solve.converged && solve.inertia.is_none());
    assert!(film.measure(LOAD, solve).amplitude < 1e-9 * spec.film.thickness);
    let numbers = "converged, flat, says nothing (the stepper warns of minres)";
    table_line(test, "papers: MINRES", Finding::Fails, numbers);

    let mut sheet = compressed(&spec, &strip, LOAD, 0.0, 1);
    let solve = sheet.solve_by_residual();
    let inertia = solve.inertia.expect("a factor");
    let unstable = inertia.negative - inertia.rows;
    assert!(solve.converged && unstable > 0);
    assert!(sheet.amplitude(&Vector3::z(), |_| true) < 1e-9 * spec.film.thickness);
    let numbers = format!("converged, flat, {unstable} unstable modes");
    table_line(test, "papers: residual merit", Finding::Fails, &numbers);

    let ramped = landed(&mut film, 1e-3, 1).relative_gap;
    film.lay_down(LOAD, 0.0, 1);
    let solve = film.solve(LOAD, &exact());
    assert!(solve.converged && solve.left_saddle);
    assert!(solve.inertia.is_some_and(|inertia| inertia.is_minimum()));
    let step = film.measure(LOAD, solve);
    assert!(
        (step.relative_gap / ramped - 1.0).abs() < 5e-3,
        "{step:?} {ramped}"
    );
    let numbers = format!(
        "leaves the saddle in {} steps; energy gap {:.3} of theory's, after a ramp {ramped:.3}",
        step.solve.iterations, step.relative_gap
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}

/// The film at 2 critical strains, entered just past the onset from noise of so many thicknesses.
fn landed(film: &mut Film, noise: f64, seed: u64) -> Step {
    film.lay_down(1.08, noise, seed);
    for load in [1.08, 1.5] {
        assert!(film.solve(load, &exact()).converged);
    }
    let solve = film.solve(LOAD, &exact());
    assert!(solve.converged && solve.inertia.is_some_and(|i| i.is_minimum()));
    film.measure(LOAD, solve)
}

#[test]
fn t2_noise_sizes() {
    let test = "T2 noise 1e-6, 1e-3, 1e-1 h, 5 seeds";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(6.0, ROWS);
    let starts: Vec<(f64, u64)> = [1e-6, 1e-3, 1e-1]
        .into_iter()
        .flat_map(|noise| (1..=5).map(move |seed| (noise, seed)))
        .collect();
    let (mut saddles, mut nowhere) = (0, 0);
    for &(noise, seed) in &starts {
        let solve = compressed(&spec, &strip, LOAD, noise, seed).solve_by_residual();
        let is_minimum = solve.inertia.is_some_and(|inertia| inertia.is_minimum());
        assert!(
            !(solve.converged && is_minimum),
            "{noise} {seed}: {solve:?}"
        );
        saddles += usize::from(solve.converged);
        nowhere += usize::from(!solve.converged);
    }
    assert!(saddles >= 10, "all of the small noise ends there");
    let numbers =
        format!("of 15 starts {saddles} end on a saddle, {nowhere} nowhere, none wrinkles");
    table_line(test, "papers: residual merit", Finding::Fails, &numbers);

    let mut film = Film::new(&spec, strip);
    let steps: Vec<Step> = starts
        .iter()
        .map(|&(noise, seed)| landed(&mut film, noise, seed))
        .collect();
    let spread = |steps: &[Step]| {
        let gaps = steps.iter().map(|step| step.relative_gap);
        let (least, most) = (
            gaps.clone().fold(f64::MAX, f64::min),
            gaps.fold(0.0, f64::max),
        );
        let waves = steps.iter().map(|step| 6.0 / step.relative_wavelength);
        let (few, many) = (
            waves.clone().fold(f64::MAX, f64::min),
            waves.fold(0.0, f64::max),
        );
        [most / least - 1.0, many - few]
    };
    // A tenth of a thickness is a hundred times what the stepper starts from.
    let ([gap, waves], [large_gap, large_waves]) = (spread(&steps[..10]), spread(&steps));
    assert!(gap < 1e-6 && waves < 1e-9, "{gap} {waves}");
    assert!(
        large_gap < 0.03 && large_waves < 0.5 + 1e-9,
        "{large_gap} {large_waves}"
    );
    let numbers = format!(
        "up to 1e-3 h (the default): E gap within {gap:.0e}, same lam; with 0.1 h {:.1} %, {large_waves:.1} wave in 6",
        100.0 * large_gap
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}
