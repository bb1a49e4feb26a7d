//! Which runs the chart is made of.

use serde_json::{Value, json};

/// Points per wavelength.
const POINTS: [u32; 6] = [4, 6, 8, 12, 16, 24];

/// Seeds of a full chart; a quick one has the first three.
const SEEDS: u64 = 5;
const QUICK_SEEDS: u64 = 3;

/// Seconds of the processor after which a run counts as failed.
const LIMIT_S: f64 = 150.0;
const QUICK_LIMIT_S: f64 = 60.0;

/// How a film is discretised and solved, but for its resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Method {
    pub(super) coupling: &'static str,
    pub(super) sampling: &'static str,
    pub(super) bending: &'static str,
    pub(super) mesh: &'static str,
    pub(super) solver: &'static str,
}

/// What is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Problem {
    /// A film compressed evenly, against theory.
    Film,
    /// A patch of skin compressed in its middle, through the product, against a finer mesh.
    Patch,
}

impl Problem {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Film => "film",
            Self::Patch => "patch",
        }
    }
}

/// A method at a resolution, on a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Setting {
    pub(super) problem: Problem,
    pub(super) method: Method,
    /// Edges per wavelength.
    pub(super) points: u32,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) setting: Setting,
    pub(super) seed: u64,
    pub(super) limit_s: f64,
}

const fn method(
    coupling: &'static str,
    sampling: &'static str,
    mesh: &'static str,
    solver: &'static str,
) -> Method {
    Method {
        coupling,
        sampling,
        bending: "vertex-curvature",
        mesh,
        solver,
    }
}

/// The same with hinges instead of curvature at vertices.
const fn hinged(method: Method) -> Method {
    Method {
        bending: "hinge",
        ..method
    }
}

/// What `ruga` does unless told otherwise.
pub(super) const DEFAULT: Method = method("hybrid", "quadrature", "adaptive", "ldlt");

/// What the papers do: Rémillard & Kry 2013 and Li 2014.
pub(super) const PAPERS: Method = hinged(method("constraint", "area", "uniform", "minres"));

/// What `ruga` does, but for its bending.
pub(super) const HINGED: Method = hinged(DEFAULT);

/// The qualities of the command line, by their points per wavelength.
pub(super) const QUALITIES: [(&str, u32); 3] = [("draft", 6), ("standard", 12), ("fine", 24)];

/// Methods that are factorised, the most interesting ones first. Nothing is sampled where the
/// coupling has no averages.
const FACTORISED: [Method; 16] = [
    DEFAULT,
    method("elastic", "quadrature", "adaptive", "ldlt"),
    hinged(method("constraint", "area", "uniform", "ldlt")),
    HINGED,
    method("hybrid", "quadrature", "uniform", "ldlt"),
    method("elastic", "quadrature", "uniform", "ldlt"),
    hinged(method("constraint", "quadrature", "adaptive", "ldlt")),
    hinged(method("constraint", "quadrature", "uniform", "ldlt")),
    hinged(method("constraint", "area", "adaptive", "ldlt")),
    method("hybrid", "area", "adaptive", "ldlt"),
    method("hybrid", "adjusted", "adaptive", "ldlt"),
    hinged(method("constraint", "adjusted", "uniform", "ldlt")),
    hinged(method("constraint", "adjusted", "adaptive", "ldlt")),
    method("hybrid", "area", "uniform", "ldlt"),
    method("hybrid", "adjusted", "uniform", "ldlt"),
    hinged(method("hybrid", "quadrature", "uniform", "ldlt")),
];

/// How many of them a quick chart has.
const QUICK_METHODS: usize = 5;

/// How many of them are tried on the patch.
const PATCH_METHODS: usize = 5;

/// Methods that are iterated beside the papers' own, at two resolutions: MINRES takes minutes, and
/// with a foundation, which buckles in the middle of the way, it finds no wrinkles at all.
const ITERATED: [Method; 4] = [
    hinged(method("constraint", "quadrature", "uniform", "minres")),
    hinged(method("constraint", "area", "adaptive", "minres")),
    method("hybrid", "quadrature", "adaptive", "minres"),
    method("elastic", "quadrature", "adaptive", "minres"),
];
const ITERATED_POINTS: [u32; 2] = [6, 12];

/// All runs: first those of the quick chart, seed after seed, so that it is whole early, then the
/// rest.
pub(super) fn runs(quick: bool) -> Vec<Run> {
    let (seeds, limit_s) = match quick {
        true => (QUICK_SEEDS, QUICK_LIMIT_S),
        false => (SEEDS, LIMIT_S),
    };
    let first = settings(true);
    let rest = settings(quick).into_iter();
    let rest: Vec<Setting> = rest.filter(|setting| !first.contains(setting)).collect();
    let mut runs = Vec::new();
    for settings in [first, rest] {
        for seed in 1..=seeds {
            runs.extend(settings.iter().map(|&setting| Run {
                setting,
                seed,
                limit_s,
            }));
        }
    }
    runs
}

fn settings(quick: bool) -> Vec<Setting> {
    let mut settings = Vec::new();
    let mut add = |problem: Problem, method: &Method, points: &[u32]| {
        settings.extend(points.iter().map(|&points| Setting {
            problem,
            method: *method,
            points,
        }));
    };
    if quick {
        // The default up to the fine quality, the others as far as the time allows.
        for (problem, count) in [(Problem::Film, QUICK_METHODS), (Problem::Patch, 3)] {
            for method in &FACTORISED[..count] {
                let count = if *method == DEFAULT { 6 } else { 4 };
                add(problem, method, &POINTS[..count]);
            }
        }
        add(Problem::Film, &PAPERS, &POINTS[..4]);
        add(Problem::Patch, &PAPERS, &POINTS[1..2]);
        return settings;
    }
    for (problem, count) in [
        (Problem::Film, FACTORISED.len()),
        (Problem::Patch, PATCH_METHODS),
    ] {
        for method in &FACTORISED[..count] {
            let is_reference = (problem, *method) == (Problem::Patch, REFERENCE.setting.method);
            let count = if is_reference { BELOW_REFERENCE } else { 6 };
            add(problem, method, &POINTS[..count]);
        }
    }
    add(Problem::Film, &PAPERS, &POINTS);
    add(Problem::Patch, &PAPERS, &ITERATED_POINTS);
    for method in &ITERATED {
        add(Problem::Film, method, &ITERATED_POINTS);
    }
    settings
}

/// What patches are compared with. An even mesh halves the artist's squares, a quarter of a wavelength
/// wide, until it is fine enough: 32 points.
pub(super) const REFERENCE: Run = Run {
    setting: Setting {
        problem: Problem::Patch,
        method: method("hybrid", "quadrature", "uniform", "ldlt"),
        points: 28,
    },
    seed: 1,
    limit_s: 600.0,
};

/// Resolutions at which the reference's own method is tried: with more points it is the reference.
const BELOW_REFERENCE: usize = 4;

impl Run {
    /// What the measuring program is asked.
    pub(super) fn request(&self) -> Value {
        let method = &self.setting.method;
        json!({
            "problem": self.setting.problem.name(),
            "points": f64::from(self.setting.points),
            "coupling": method.coupling,
            "sampling": method.sampling,
            "bending": method.bending,
            "mesh": method.mesh,
            "solver": method.solver,
            "seed": self.seed,
            "limit_s": self.limit_s,
        })
    }
}

impl Method {
    /// The same, solved by factorisation.
    pub(super) fn factorised(self) -> Self {
        Self {
            solver: "ldlt",
            ..self
        }
    }

    /// In words, for people.
    pub(super) fn words(&self) -> String {
        let sampling = match self.coupling {
            "elastic" => String::new(),
            _ => format!(" {}", self.sampling),
        };
        let bending = match self.bending {
            "hinge" => "hinges",
            _ => "vertex curvature",
        };
        let solver = match self.solver {
            "ldlt" => "LDLT",
            _ => "MINRES",
        };
        format!(
            "{}{sampling}, {bending}, {} mesh, {solver}",
            self.coupling, self.mesh
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_asked_for_once_and_the_quick_ones_are_among_them() {
        let key = |run: &Run| format!("{:?} {}", run.setting, run.seed);
        let mut full: Vec<String> = runs(false).iter().map(key).collect();
        let count = full.len();
        full.sort();
        full.dedup();
        assert_eq!(full.len(), count);
        assert!(runs(true).iter().all(|run| full.contains(&key(run))));
    }

    #[test]
    fn default_and_papers_are_measured_at_every_quality() {
        let has = |quick: bool, method: Method, points: u32| {
            let wanted = Setting {
                problem: Problem::Film,
                method,
                points,
            };
            runs(quick).iter().any(|run| run.setting == wanted)
        };
        for (_, points) in QUALITIES {
            assert!(has(false, DEFAULT, points) && has(true, DEFAULT, points));
            assert!(has(false, PAPERS, points));
        }
    }
}
