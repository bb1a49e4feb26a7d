//! T1 and T2: what a solve starts from.

use nalgebra::Vector3;
use ruga_validation::baselines::by_minres;
use ruga_validation::{FilmSpec, Finding, table_line};

use crate::{compressed, exact, landed, relative_gap};

const ROWS: usize = 6;
const LOAD: f64 = 2.0;

#[test]
fn t1_perfect_flat_start() {
    let test = "T1 perfectly flat at 2 eps_c";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(6.0, ROWS);
    let mut sheet = compressed(&spec, &strip, LOAD, 0.0, 1);
    let solve = sheet.solve_by(by_minres, &exact());
    assert!(solve.converged && solve.inertia.is_none());
    assert!(sheet.amplitude(&Vector3::z(), |_| true) < 1e-9 * spec.film.thickness);
    let numbers = "converged, flat, says nothing (the stepper warns of minres)";
    table_line(test, "papers: MINRES", Finding::Fails, numbers);

    let mut sheet = compressed(&spec, &strip, LOAD, 0.0, 1);
    let solve = sheet.solve_by_residual();
    let inertia = solve.inertia.expect("a factor");
    let unstable = inertia.excess();
    assert!(solve.converged && unstable > 0);
    assert!(sheet.amplitude(&Vector3::z(), |_| true) < 1e-9 * spec.film.thickness);
    let numbers = format!("converged, flat, {unstable} unstable modes");
    table_line(test, "papers: residual merit", Finding::Fails, &numbers);

    let (_, ramped) = landed(&spec, &strip, (1e-3, 1));
    let mut sheet = compressed(&spec, &strip, LOAD, 0.0, 1);
    let solve = sheet.solve(&exact());
    assert!(solve.converged && solve.left_saddle);
    assert!(solve.inertia.is_some_and(|inertia| inertia.is_minimum()));
    let gap = relative_gap(&sheet, &spec);
    assert!((gap / ramped - 1.0).abs() < 5e-3, "{gap} {ramped}");
    let numbers = format!(
        "leaves the saddle in {} steps; energy gap {gap:.3} of theory's, after a ramp {ramped:.3}",
        solve.iterations
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
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

    let gaps: Vec<f64> = starts
        .iter()
        .map(|&start| landed(&spec, &strip, start).1)
        .collect();
    let spread = |gaps: &[f64]| {
        let least = gaps.iter().copied().fold(f64::MAX, f64::min);
        gaps.iter().copied().fold(0.0, f64::max) / least - 1.0
    };
    // A tenth of a thickness is a hundred times what the stepper starts from; half a wave more or less
    // in six is 3 % of the energy.
    let [gap, large] = [&gaps[..10], &gaps].map(spread);
    assert!(gap < 1e-6 && large < 0.03, "{gap} {large}");
    let numbers = format!(
        "up to 1e-3 h (the default): E gap within {gap:.0e}; with 0.1 h {:.1} %",
        100.0 * large
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}
