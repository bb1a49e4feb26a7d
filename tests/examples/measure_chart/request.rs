//! What a run is asked for and what it answers.

use std::collections::BTreeMap;

use ruga_constraint::Sampling;
use ruga_solver::{Minimise, minimise};
use ruga_stepper::{BendingModel, EdgeLimits};
use ruga_tests::FilmCoupling;
use ruga_tests::baselines::{LinearSolver, by_minres};
use serde::{Deserialize, Serialize};

/// Spacing of hard rows in wavelengths: a hex lattice then lets the wavelength itself through.
const HARD_SPACING: f64 = 0.577;

/// One combination of choices.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) problem: Problem,
    /// Mesh edges per wavelength, across the wrinkles.
    pub(crate) points: f64,
    pub(crate) coupling: Coupling,
    pub(crate) sampling: RowSampling,
    pub(crate) bending: Bending,
    pub(crate) mesh: Mesh,
    pub(crate) solver: Solver,
    /// Of the mesh's irregularity and of the initial noise.
    pub(crate) seed: u64,
    /// Seconds of the processor after which the run counts as failed.
    pub(crate) limit_s: f64,
    /// What a patch is compared with: the answer to the same question at a finer resolution. A patch
    /// without one is a reference itself.
    #[serde(default, skip_serializing)]
    pub(crate) reference: Option<PatchShape>,
}

/// What of a patch is compared.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct PatchShape {
    /// Dominant wavelength, m.
    pub(crate) wavelength: f64,
    /// `sqrt(2)` RMS height, m.
    pub(crate) amplitude: f64,
    /// Along lines across the wrinkles, at equal distances: the x and y components of unit normals,
    /// one after the other.
    pub(crate) lines: Vec<Vec<f64>>,
}

/// What is simulated.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Problem {
    /// A film compressed evenly, against theory.
    Film,
    /// A patch of skin compressed most in its middle, as a user would have it, against itself.
    Patch,
}

/// What holds the skin.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Coupling {
    Constraint,
    Elastic,
    Hybrid,
}

/// How averages are sampled.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RowSampling {
    Area,
    Adjusted,
    Quadrature,
}

/// What resists bending.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Bending {
    /// Hinges, corrected by what their mesh responds with.
    Hinge,
    /// Curvature at vertices.
    VertexCurvature,
}

impl Bending {
    pub(crate) fn model(self) -> BendingModel {
        match self {
            Self::Hinge => BendingModel::Hinge,
            Self::VertexCurvature => BendingModel::VertexCurvature,
        }
    }

    /// How much longer than wide triangles may be for it.
    fn aspect(self) -> f64 {
        match self {
            Self::Hinge => 2.0,
            Self::VertexCurvature => EdgeLimits::default().aspect,
        }
    }
}

/// Shape of the triangles.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Mesh {
    /// As long as wide everywhere.
    Uniform,
    /// Longer along the wrinkles than across them, as far as the bending model allows.
    Adaptive,
    /// The same, but at most twice as long as across.
    AdaptiveTwo,
}

impl Mesh {
    /// How much longer than wide triangles may be; nothing where they are not fitted at all.
    pub(crate) fn aspect(self, bending: Bending) -> Option<f64> {
        match self {
            Self::Uniform => None,
            Self::Adaptive => Some(bending.aspect()),
            Self::AdaptiveTwo => Some(bending.aspect().min(2.0)),
        }
    }
}

/// Solver of the linear systems.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Solver {
    Ldlt,
    Minres,
}

impl Coupling {
    pub(crate) fn of_film(self) -> FilmCoupling {
        match self {
            Self::Constraint => FilmCoupling::Constraint(HARD_SPACING),
            Self::Elastic => FilmCoupling::Elastic,
            Self::Hybrid => FilmCoupling::Hybrid,
        }
    }
}

impl RowSampling {
    pub(crate) fn kind(self) -> Sampling {
        match self {
            Self::Area => Sampling::Area,
            Self::Adjusted => Sampling::Adjusted,
            Self::Quadrature => Sampling::Quadrature,
        }
    }
}

impl Solver {
    pub(crate) fn kind(self) -> LinearSolver {
        match self {
            Self::Ldlt => LinearSolver::Ldlt,
            Self::Minres => LinearSolver::minres(),
        }
    }

    /// The method of a simulation with it.
    pub(crate) fn minimise(self) -> Minimise {
        match self {
            Self::Ldlt => minimise,
            Self::Minres => by_minres,
        }
    }
}

/// A request with its answer.
#[derive(Debug, Serialize)]
pub(crate) struct Response {
    pub(crate) request: Request,
    #[serde(flatten)]
    pub(crate) outcome: Outcome,
}

/// What came of a run.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Outcome {
    /// Why the run failed; nothing when it did not.
    pub(crate) failure: Option<String>,
    /// Seconds of the processor for everything but measuring.
    pub(crate) cpu_s: f64,
    /// Load steps that were asked for.
    pub(crate) frames: usize,
    pub(crate) vertices: usize,
    /// Averages that are held, per coordinate.
    pub(crate) rows: usize,
    pub(crate) newton_iterations: usize,
    pub(crate) linear_iterations: usize,
    pub(crate) linear_stalls: usize,
    /// Signed relative errors, and the angle in degrees, by name; without those that could not be
    /// measured.
    pub(crate) errors: BTreeMap<&'static str, f64>,
    /// What else was measured, by name.
    pub(crate) values: BTreeMap<&'static str, f64>,
    /// What later patches are compared with, if this one was compared with nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shape: Option<PatchShape>,
}

impl Outcome {
    pub(crate) fn failed(reason: String) -> Self {
        Self {
            failure: Some(reason),
            ..Self::default()
        }
    }
}
