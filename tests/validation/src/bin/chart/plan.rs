//! Which runs the chart is made of.

use std::ops::RangeInclusive;

use crate::setting::Coupling::{self, Constraint, Elastic, Hybrid};
use crate::setting::Mesh::{self, Adaptive, AdaptiveTwo, Uniform};
use crate::setting::RowSampling::{self, Adjusted, Area, Quadrature};
use crate::setting::Solver::{self, Ldlt, Minres};
use crate::setting::{Bending, Method, Problem, Run, Setting};

/// Points per wavelength.
const POINTS: [u32; 6] = [4, 6, 8, 12, 16, 24];

/// Seeds of each setting; what nobody would choose has the first one alone.
const SEEDS: u64 = 3;

/// Seeds of the default on the film at every quality. Errors differ by more from mesh to mesh than from
/// one version of the program to the next, so that three meshes tell little.
const DEFAULT_SEEDS: u64 = 9;

/// Seconds of the processor after which a run counts as failed.
const LIMIT_S: f64 = 60.0;

const fn method(coupling: Coupling, sampling: RowSampling, mesh: Mesh, solver: Solver) -> Method {
    Method {
        coupling,
        sampling,
        bending: Bending::VertexCurvature,
        mesh,
        solver,
    }
}

/// The same with hinges instead of curvature at vertices.
const fn hinged(method: Method) -> Method {
    Method {
        bending: Bending::Hinge,
        ..method
    }
}

/// What `ruga` does unless told otherwise.
pub(crate) const DEFAULT: Method = method(Hybrid, Quadrature, Adaptive, Ldlt);

/// What the papers do: Rémillard & Kry 2013 and Li 2014.
pub(crate) const PAPERS: Method = hinged(method(Constraint, Area, Uniform, Minres));

/// What `ruga` does, but for its bending.
pub(crate) const HINGED: Method = hinged(DEFAULT);

/// The qualities of the command line, by their points per wavelength.
pub(crate) const QUALITIES: [(&str, u32); 3] = [("draft", 6), ("standard", 12), ("fine", 24)];

/// The default with the meshes of hinges: triangles twice as long as wide instead of four times.
pub(crate) const SHORTER: Method = Method {
    mesh: AdaptiveTwo,
    ..DEFAULT
};

/// The default on triangles as long as wide.
const UNIFORM: Method = Method {
    mesh: Uniform,
    ..DEFAULT
};

/// The default without rows. Nothing is sampled then.
pub(crate) const ELASTIC: Method = Method {
    coupling: Elastic,
    ..DEFAULT
};

/// The default with hard rows alone.
const CONSTRAINT: Method = Method {
    coupling: Constraint,
    ..DEFAULT
};

/// What differs from the default in one choice and is as fast.
const ONE_FACTOR: [Method; 3] = [ELASTIC, HINGED, SHORTER];

/// What differs in one choice and is slower, or differs little.
const OTHER_FACTOR: [Method; 4] = [
    UNIFORM,
    CONSTRAINT,
    method(Hybrid, Area, Adaptive, Ldlt),
    method(Hybrid, Adjusted, Adaptive, Ldlt),
];

/// What differs from the papers in one choice or two; nobody would choose these.
const BESIDE_PAPERS: [Method; 4] = [
    hinged(method(Constraint, Quadrature, Uniform, Ldlt)),
    hinged(method(Constraint, Adjusted, Uniform, Ldlt)),
    hinged(method(Constraint, Area, Adaptive, Ldlt)),
    hinged(method(Hybrid, Quadrature, Uniform, Ldlt)),
];

/// Iterated, these too. With a foundation, which buckles in the middle of the way, MINRES finds no wrinkles
/// at all.
const ITERATED: [Method; 3] = [
    method(Hybrid, Quadrature, Adaptive, Minres),
    hinged(method(Constraint, Quadrature, Uniform, Minres)),
    hinged(method(Constraint, Area, Adaptive, Minres)),
];

/// Resolutions of what nobody would choose.
const FEW_POINTS: [u32; 2] = [6, 12];

/// Some settings, and the seeds that each has.
type Stage = (Vec<Setting>, RangeInclusive<u64>);

/// All runs, stage after stage, within each seed after seed: what matters most is whole first.
pub(crate) fn runs(quick: bool) -> Vec<Run> {
    let stages: Vec<Stage> = match quick {
        true => vec![(quick_settings(), 1..=SEEDS)],
        false => vec![
            (main_settings(), 1..=SEEDS),
            (quality_settings(), SEEDS + 1..=DEFAULT_SEEDS),
            (one_factor_settings(), 1..=SEEDS),
            (other_settings(), 1..=1),
        ],
    };
    let mut runs = Vec::new();
    for (settings, seeds) in stages {
        for seed in seeds {
            runs.extend(settings.iter().map(|&setting| Run {
                setting,
                seed,
                limit_s: LIMIT_S,
            }));
        }
    }
    runs
}

fn settings(problem: Problem, method: Method, points: &[u32]) -> impl Iterator<Item = Setting> {
    points.iter().map(move |&points| Setting {
        problem,
        method,
        points,
    })
}

/// The default up to the fine quality, the papers' way where that is cheap.
fn quick_settings() -> Vec<Setting> {
    use Problem::{Film, Patch};
    let mut all = Vec::new();
    all.extend(settings(Film, DEFAULT, &POINTS));
    all.extend(settings(Film, PAPERS.factorised(), &POINTS[..2]));
    all.extend(settings(Patch, DEFAULT, &POINTS[..4]));
    all.extend(settings(Patch, PAPERS, &POINTS[..2]));
    all
}

/// The default at every resolution, and the papers' way where it may end within the limit: of the film,
/// which is four times as large as the patch, MINRES does not.
fn main_settings() -> Vec<Setting> {
    use Problem::{Film, Patch};
    let mut all = Vec::new();
    all.extend(settings(Film, DEFAULT, &POINTS));
    all.extend(settings(Patch, DEFAULT, &POINTS));
    all.extend(settings(Film, PAPERS.factorised(), &POINTS[..2]));
    all.extend(settings(Patch, PAPERS, &POINTS[..2]));
    all
}

/// The default at the qualities of the command line.
fn quality_settings() -> Vec<Setting> {
    let points = QUALITIES.map(|(_, points)| points);
    settings(Problem::Film, DEFAULT, &points).collect()
}

fn one_factor_settings() -> Vec<Setting> {
    use Problem::{Film, Patch};
    let mut all = Vec::new();
    for method in ONE_FACTOR {
        all.extend(settings(Film, method, &POINTS[..4]));
    }
    for method in [ELASTIC, HINGED] {
        all.extend(settings(Patch, method, &POINTS[..4]));
    }
    all
}

fn other_settings() -> Vec<Setting> {
    use Problem::{Film, Patch};
    let mut all: Vec<Setting> = settings(Film, PAPERS, &POINTS[..2]).collect();
    all.extend(settings(Patch, PAPERS, &POINTS[2..3]));
    all.extend(settings(Film, PAPERS.factorised(), &POINTS[2..4]));
    for method in OTHER_FACTOR {
        all.extend(settings(Film, method, &FEW_POINTS));
    }
    for method in BESIDE_PAPERS {
        all.extend(settings(Film, method, &FEW_POINTS[..1]));
    }
    for method in ITERATED {
        all.extend(settings(Patch, method, &FEW_POINTS[..1]));
    }
    all.extend(settings(Patch, PAPERS.factorised(), &FEW_POINTS));
    all.extend(settings(Patch, REFERENCE.setting.method, &FEW_POINTS));
    all
}

/// What patches are compared with. An even mesh halves the artist's squares, a quarter of a wavelength
/// wide, until it is fine enough: 32 points.
pub(crate) const REFERENCE: Run = Run {
    setting: Setting {
        problem: Problem::Patch,
        method: method(Hybrid, Quadrature, Uniform, Ldlt),
        points: 28,
    },
    seed: 1,
    limit_s: 600.0,
};

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
    fn the_default_is_measured_at_every_quality_and_the_papers_way_where_it_ends() {
        let has = |quick: bool, method: Method, points: u32| {
            let is_it = |run: &Run| (run.setting.method, run.setting.points) == (method, points);
            runs(quick).iter().any(is_it)
        };
        for (_, points) in QUALITIES {
            assert!(has(false, DEFAULT, points) && has(true, DEFAULT, points));
        }
        for points in &POINTS[..2] {
            assert!(has(false, PAPERS, *points) && has(true, PAPERS, *points));
        }
    }
}
