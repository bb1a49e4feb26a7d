//! Newton on a film that buckles on a foundation, against the closed form.
//!
//! Föppl-von Kármán film in one dimension, periodic, on a Winkler foundation: nodes with a
//! tangential displacement `u` and a deflection `w`, edges with the strain
//! `e = -eps + u' + w'^2 / 2`. A single cosine is an exact solution of the discrete equations:
//! with `k` the discrete wave number `2 sin(pi m / n) / a` the film buckles at
//! `C eps_m = D k^2 + K0 / k^2` and then `A^2 = 4 (eps - eps_m) / k^2`.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use std::f64::consts::PI;

use ruga_solver::{
    AtSaddle, ConstraintRows, Iteration, Kkt, LoadSettings, LoadStepper, LowerPattern,
    NewtonSettings, Objective, Outcome, SolveReport, StopRule, Verdict, inertia_at, minimise,
    softest_mode,
};

const WAVES: usize = 8;
const POINTS_PER_WAVE: usize = 12;
const NODES: usize = WAVES * POINTS_PER_WAVE;
const MEMBRANE: f64 = 1.0;
const THICKNESS: f64 = 1.0;
const BENDING: f64 = MEMBRANE * THICKNESS * THICKNESS / 12.0;
const CRITICAL_WAVE_NUMBER: f64 = 0.25;

struct Film {
    strain: f64,
    edge: f64,
    foundation: f64,
    pattern: LowerPattern,
    damping: Vec<f64>,
}

impl Film {
    fn new(strain: f64) -> Self {
        let edge = 2.0 * PI / CRITICAL_WAVE_NUMBER / POINTS_PER_WAVE as f64;
        let foundation = BENDING * CRITICAL_WAVE_NUMBER.powi(4);
        let stencils: Vec<[usize; 6]> = (0..NODES)
            .map(|node| {
                let [left, middle, right] = around(node);
                let (a, b, c) = (2 * left, 2 * middle, 2 * right);
                [a, a + 1, b, b + 1, c, c + 1]
            })
            .collect();
        let lists = stencils.iter().map(|stencil| stencil.as_slice());
        Self {
            strain,
            edge,
            foundation,
            pattern: LowerPattern::from_stencils(2 * NODES, lists).unwrap(),
            damping: vec![1e-6 * foundation * edge; 2 * NODES],
        }
    }

    fn wave_number(&self, waves: usize) -> f64 {
        2.0 / self.edge * (PI * waves as f64 / NODES as f64).sin()
    }

    fn onset(&self, waves: usize) -> f64 {
        let square = self.wave_number(waves).powi(2);
        (BENDING * square + self.foundation / square) / MEMBRANE
    }

    fn critical_strain(&self) -> f64 {
        (1..NODES / 2)
            .map(|waves| self.onset(waves))
            .fold(f64::INFINITY, f64::min)
    }

    fn amplitude(&self, waves: usize) -> f64 {
        2.0 * (self.strain - self.onset(waves)).sqrt() / self.wave_number(waves)
    }

    /// (strain, slope) of the edge from `node` to the next.
    fn edge_strain(&self, x: &[f64], node: usize) -> (f64, f64) {
        let next = (node + 1) % NODES;
        let slope = (x[2 * next + 1] - x[2 * node + 1]) / self.edge;
        let stretch = (x[2 * next] - x[2 * node]) / self.edge;
        (stretch - self.strain + 0.5 * slope * slope, slope)
    }

    fn curvature(&self, x: &[f64], node: usize) -> f64 {
        let [left, middle, right] = around(node);
        (x[2 * left + 1] - 2.0 * x[2 * middle + 1] + x[2 * right + 1]) / self.edge.powi(2)
    }

    fn fill_hessian(&self, x: &[f64], relaxed: bool, values: &mut [f64]) {
        values.fill(0.0);
        let mut add = |row: usize, column: usize, value: f64| {
            if row >= column {
                values[self.pattern.position(row, column).unwrap()] += value;
            }
        };
        for node in 0..NODES {
            let next = (node + 1) % NODES;
            let (strain, slope) = self.edge_strain(x, node);
            let unknowns = [2 * node, 2 * node + 1, 2 * next, 2 * next + 1];
            let derivative = [-1.0, -slope, 1.0, slope];
            let stress = if relaxed { strain.max(0.0) } else { strain };
            for i in 0..4 {
                for j in 0..4 {
                    let mut value = derivative[i] * derivative[j];
                    if i % 2 == 1 && j % 2 == 1 {
                        value += if i == j { stress } else { -stress };
                    }
                    add(unknowns[i], unknowns[j], MEMBRANE / self.edge * value);
                }
            }
            let around = around(node);
            for (i, a) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                for (j, b) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                    let value = BENDING / self.edge.powi(3) * a * b;
                    add(2 * around[i] + 1, 2 * around[j] + 1, value);
                }
            }
            add(2 * node + 1, 2 * node + 1, self.foundation * self.edge);
        }
    }
}

fn around(node: usize) -> [usize; 3] {
    [(node + NODES - 1) % NODES, node, (node + 1) % NODES]
}

impl Objective for Film {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        (0..NODES)
            .map(|node| {
                let (strain, _) = self.edge_strain(x, node);
                let curvature = self.curvature(x, node);
                let deflection = x[2 * node + 1];
                0.5 * self.edge
                    * (MEMBRANE * strain * strain
                        + BENDING * curvature * curvature
                        + self.foundation * deflection * deflection)
            })
            .sum()
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        for node in 0..NODES {
            let next = (node + 1) % NODES;
            let (strain, slope) = self.edge_strain(x, node);
            gradient[2 * node] -= MEMBRANE * strain;
            gradient[2 * next] += MEMBRANE * strain;
            gradient[2 * node + 1] -= MEMBRANE * strain * slope;
            gradient[2 * next + 1] += MEMBRANE * strain * slope;
            let moment = BENDING * self.curvature(x, node) / self.edge;
            let [left, middle, right] = around(node);
            gradient[2 * left + 1] += moment;
            gradient[2 * middle + 1] -= 2.0 * moment;
            gradient[2 * right + 1] += moment;
            gradient[2 * node + 1] += self.foundation * self.edge * x[2 * node + 1];
        }
        self.value(x)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.fill_hessian(x, false, exact);
        self.fill_hessian(x, true, relaxed);
    }

    fn damping(&self) -> &[f64] {
        &self.damping
    }

    fn energy_scale(&self) -> f64 {
        0.5 * MEMBRANE * self.critical_strain().powi(2) * self.edge * NODES as f64
    }

    fn force_scale(&self) -> f64 {
        self.foundation * THICKNESS * self.edge
    }

    fn length_scale(&self) -> f64 {
        THICKNESS
    }
}

/// One row: the mean of `u` is given, so the film cannot slide.
fn mean_row() -> ConstraintRows {
    let columns = (0..NODES).map(|node| 2 * node).collect();
    let weights = vec![1.0 / NODES as f64; NODES];
    ConstraintRows::new(vec![0, NODES], columns, weights, 2 * NODES).unwrap()
}

fn system(film: &Film) -> Kkt {
    Kkt::new(&film.pattern, &mean_row(), 2).unwrap()
}

fn solve(film: &Film, x: &mut [f64], settings: &NewtonSettings) -> SolveReport {
    minimise(film, &[0.0], x, &mut system(film), settings, &mut |_| true).unwrap()
}

/// Number of waves with the largest Fourier coefficient, and the amplitude by its RMS.
fn spectrum(x: &[f64]) -> (usize, f64) {
    let power = |waves: usize| {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for node in 0..NODES {
            let angle = 2.0 * PI * (waves * node % NODES) as f64 / NODES as f64;
            cosine += x[2 * node + 1] * angle.cos();
            sine += x[2 * node + 1] * angle.sin();
        }
        cosine * cosine + sine * sine
    };
    let waves = (1..NODES / 2)
        .max_by(|&a, &b| power(a).total_cmp(&power(b)))
        .unwrap();
    let square: f64 = (0..NODES).map(|node| x[2 * node + 1].powi(2)).sum();
    (waves, (2.0 * square / NODES as f64).sqrt())
}

#[test]
fn derivatives_agree_with_differences() {
    let film = Film::new(0.03);
    let x: Vec<f64> = (0..2 * NODES)
        .map(|i| 0.2 * ((i * i) as f64).sin())
        .collect();
    let entries = film.pattern.entries();
    let (mut exact, mut relaxed) = (vec![0.0; entries], vec![0.0; entries]);
    film.hessian(&x, &mut exact, &mut relaxed);
    let (mut up, mut down) = (vec![0.0; 2 * NODES], vec![0.0; 2 * NODES]);
    let step = 1e-6;
    for unknown in [0, 1, 20, 21, 2 * NODES - 1] {
        let mut moved = x.clone();
        moved[unknown] += step;
        let energy_up = film.gradient(&moved, &mut up);
        moved[unknown] -= 2.0 * step;
        let energy_down = film.gradient(&moved, &mut down);
        let mut gradient = vec![0.0; 2 * NODES];
        film.gradient(&x, &mut gradient);
        let slope = (energy_up - energy_down) / (2.0 * step);
        assert!((slope - gradient[unknown]).abs() < 1e-8);
        for row in 0..2 * NODES {
            let expected = (up[row] - down[row]) / (2.0 * step);
            let found = film
                .pattern
                .position(row, unknown)
                .map_or(0.0, |at| exact[at]);
            assert!((expected - found).abs() < 1e-8, "{row} {unknown}");
        }
    }
}

#[test]
fn perfect_flat_start_ends_in_wrinkles_of_the_right_height() {
    for ratio in [1.05, 1.1, 1.33, 2.0, 3.0, 5.0] {
        let film = Film::new(ratio * Film::new(0.0).critical_strain());
        for seed in 0..4 {
            let mut x = vec![0.0; 2 * NODES];
            let settings = NewtonSettings {
                seed,
                energy_tolerance: 1e-12,
                ..Default::default()
            };
            let flat = film.value(&x);
            let report = solve(&film, &mut x, &settings);
            let (waves, amplitude) = spectrum(&x);
            let expected = film.amplitude(waves);
            assert!(report.converged && report.left_saddle);
            assert!(report.inertia.unwrap().is_minimum());
            assert!(report.energy < flat);
            assert!(report.iterations <= 25);
            assert_eq!(waves, WAVES);
            assert!((amplitude / expected - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn below_the_onset_the_film_stays_flat() {
    let film = Film::new(0.999 * Film::new(0.0).critical_strain());
    let mut x = vec![0.0; 2 * NODES];
    let report = solve(&film, &mut x, &NewtonSettings::default());
    assert_eq!(report.stop, StopRule::Residual);
    assert_eq!((report.iterations, report.left_saddle), (1, false));
    assert!(spectrum(&x).1 < 1e-12);
}

/// Solves at one load from the last kept state and says what happened.
fn attempt(film: &Film, x: &mut [f64], probe: bool) -> Outcome {
    let settings = NewtonSettings {
        at_saddle: if probe {
            AtSaddle::Stop
        } else {
            AtSaddle::Leave
        },
        ..Default::default()
    };
    let report = solve(film, x, &settings);
    match (report.left_saddle, report.converged) {
        (true, _) => Outcome::Buckled,
        (false, true) => Outcome::Stable,
        (false, false) => Outcome::Failed,
    }
}

#[test]
fn load_stepper_lands_just_past_the_onset_and_keeps_the_wavelength() {
    let critical = Film::new(0.0).critical_strain();
    let full = 4.0 * critical;
    let mut loads = LoadStepper::new(&[0.6, 1.0], LoadSettings::default()).unwrap();
    let mut kept = vec![0.0; 2 * NODES];
    let mut landing = None;
    while let Some(trial) = loads.next_trial() {
        let mut x = kept.clone();
        let outcome = attempt(&Film::new(trial.load * full), &mut x, trial.probe);
        if loads.report(outcome) == Verdict::Keep {
            kept = x;
            if outcome == Outcome::Buckled && landing.is_none() {
                landing = Some(trial.load * full / critical);
            }
        }
    }
    let landing = landing.unwrap();
    assert!((1.05..=1.1).contains(&landing), "landed at {landing}");
    assert_eq!(loads.kept_load(), 1.0);
    let (waves, amplitude) = spectrum(&kept);
    assert_eq!(waves, WAVES);
    let error = amplitude / Film::new(full).amplitude(waves) - 1.0;
    assert!(error.abs() < 1e-3, "amplitude off by {error}");
}

#[test]
fn inertia_brackets_the_onset_and_the_softest_mode_is_the_wrinkle() {
    let critical = Film::new(0.0).critical_strain();
    let flat = vec![0.0; 2 * NODES];
    let (below, above) = (Film::new(0.9999 * critical), Film::new(1.0001 * critical));
    let mut kkt = system(&below);
    assert!(inertia_at(&below, &flat, &mut kkt).unwrap().is_minimum());
    let inertia = inertia_at(&above, &flat, &mut kkt).unwrap();
    // A wrinkle may sit at any phase: two modes buckle together.
    assert_eq!(inertia.excess(), 2);
    let soft = softest_mode(&above, &flat, &mut kkt, 5, 20).unwrap();
    assert!(soft.rayleigh_quotient < 0.0);
    assert_eq!(spectrum(&soft.mode).0, WAVES);
}

#[test]
fn same_input_gives_the_same_bits_and_another_seed_the_same_energy() {
    let film = Film::new(2.0 * Film::new(0.0).critical_strain());
    let run = |seed| {
        let settings = NewtonSettings {
            seed,
            ..Default::default()
        };
        let mut x = vec![0.0; 2 * NODES];
        let report = solve(&film, &mut x, &settings);
        let bits: Vec<u64> = x.iter().map(|entry| entry.to_bits()).collect();
        (bits, report.energy)
    };
    let (first, second, other) = (run(7), run(7), run(8));
    assert!(first == second);
    assert_ne!(first.0, other.0);
    assert!((first.1 / other.1 - 1.0).abs() < 1e-6);
}

#[test]
fn the_caller_can_stop_between_iterations() {
    let film = Film::new(2.0 * Film::new(0.0).critical_strain());
    let mut x = vec![0.0; 2 * NODES];
    let mut seen = Vec::new();
    let mut stop_at_third = |iteration: &Iteration| {
        seen.push(iteration.index);
        iteration.index < 2
    };
    let report = minimise(
        &film,
        &[0.0],
        &mut x,
        &mut system(&film),
        &NewtonSettings::default(),
        &mut stop_at_third,
    )
    .unwrap();
    assert_eq!(
        (report.stop, report.converged),
        (StopRule::Interrupted, false)
    );
    assert_eq!(seen, [0, 1, 2]);
    assert!(x.iter().all(|entry| entry.is_finite()));
}

#[test]
fn infeasible_start_is_moved_onto_the_constraints() {
    let film = Film::new(2.0 * Film::new(0.0).critical_strain());
    let mut x = vec![0.3; 2 * NODES];
    let report = solve(&film, &mut x, &NewtonSettings::default());
    let mean: f64 = (0..NODES).map(|node| x[2 * node]).sum::<f64>() / NODES as f64;
    assert!(report.converged && report.infeasibility < 1e-9);
    assert!(mean.abs() < 1e-9);
}
