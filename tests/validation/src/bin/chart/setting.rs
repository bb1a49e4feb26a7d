//! How a run is set up, and what came of it.

use std::collections::BTreeMap;

use ruga_constraint::Sampling;
use ruga_solver::{Minimise, minimise};
use ruga_stepper::{BendingModel, Coupling as Held, EdgeLimits};
use serde::{Deserialize, Serialize};

use crate::product::pushed_minres;
use crate::results::Measure;

/// One run.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Run {
    #[serde(flatten)]
    pub(crate) setting: Setting,
    /// Of the artist's mesh and of the initial noise.
    pub(crate) seed: u64,
    /// Seconds of the processor after which the run counts as failed.
    pub(crate) limit_s: f64,
}

/// A method at a resolution, on a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
pub(crate) struct Setting {
    pub(crate) problem: Problem,
    /// Mesh edges per wavelength, across the wrinkles.
    pub(crate) points: u32,
    #[serde(flatten)]
    pub(crate) method: Method,
}

/// How skin is discretised and solved, but for its resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
pub(crate) struct Method {
    pub(crate) coupling: Coupling,
    pub(crate) sampling: RowSampling,
    pub(crate) bending: Bending,
    pub(crate) mesh: Mesh,
    pub(crate) solver: Solver,
}

/// What is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Problem {
    /// A film compressed evenly, against theory.
    Film,
    /// A patch of skin compressed most in its middle, as a user would have it, against a finer mesh.
    Patch,
}

/// What holds the skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Coupling {
    Constraint,
    Elastic,
    Hybrid,
}

/// How averages are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum RowSampling {
    Area,
    Adjusted,
    Quadrature,
}

/// What resists bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Bending {
    /// Hinges, corrected by what their mesh responds with.
    Hinge,
    /// Curvature at vertices.
    VertexCurvature,
}

/// Shape of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Mesh {
    /// As long as wide everywhere.
    Uniform,
    /// Longer along the wrinkles than across them, as far as the bending model allows.
    Adaptive,
    /// The same, but at most twice as long as across.
    AdaptiveTwo,
}

/// Solver of the linear systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Solver {
    Ldlt,
    Minres,
}

/// What a value is called in results, and by whoever draws them.
pub(crate) fn word(value: impl Serialize) -> String {
    let value = serde_json::to_value(value).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
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

impl Coupling {
    /// The product's name for it.
    pub(crate) fn held(self) -> Held {
        match self {
            Self::Constraint => Held::Constraint,
            Self::Elastic => Held::Elastic,
            Self::Hybrid => Held::Hybrid,
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
    /// The method of a simulation with it.
    pub(crate) fn minimise(self) -> Minimise {
        match self {
            Self::Ldlt => minimise,
            Self::Minres => pushed_minres,
        }
    }
}

impl Method {
    /// How much longer than wide triangles may be; nothing where they are not fitted at all.
    pub(crate) fn aspect(&self) -> Option<f64> {
        match self.mesh {
            Mesh::Uniform => None,
            Mesh::Adaptive => Some(self.bending.aspect()),
            Mesh::AdaptiveTwo => Some(self.bending.aspect().min(2.0)),
        }
    }

    /// The same, solved by factorisation.
    pub(crate) fn factorised(self) -> Self {
        Self {
            solver: Solver::Ldlt,
            ..self
        }
    }

    /// In words, for people.
    pub(crate) fn words(&self) -> String {
        let sampling = match self.coupling {
            Coupling::Elastic => String::new(),
            _ => format!(" {}", word(self.sampling)),
        };
        let bending = match self.bending {
            Bending::Hinge => "hinges",
            Bending::VertexCurvature => "vertex curvature",
        };
        let mesh = match self.mesh {
            Mesh::AdaptiveTwo => "adaptive mesh of aspect 2",
            Mesh::Adaptive => "adaptive mesh",
            Mesh::Uniform => "uniform mesh",
        };
        let solver = match self.solver {
            Solver::Ldlt => "LDLT",
            Solver::Minres => "MINRES",
        };
        let coupling = word(self.coupling);
        format!("{coupling}{sampling}, {bending}, {mesh}, {solver}")
    }
}

/// A run with what came of it.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Line {
    pub(crate) request: Run,
    #[serde(flatten)]
    pub(crate) outcome: Outcome,
}

/// What came of a run.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
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
    /// Signed relative errors, and angles in degrees; without those that could not be measured.
    pub(crate) errors: BTreeMap<Measure, f64>,
    /// What patches are compared with, if this run is what they are compared with.
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
