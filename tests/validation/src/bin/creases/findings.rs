//! Everything that the study measures.

use ruga_solver::NewtonSettings;
use ruga_validation::cantilever::{Fold, fold_over_theory};
use ruga_validation::crease_cost::{band_cost, crease_cost, frame_cost};
use ruga_validation::fold_panel::{FoldRun, measure_folds};
use ruga_validation::ridge::sewn_ridge;
use ruga_validation::virtual_nodes::projected_newton;
use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::drifts::{Drift, drifts};
use crate::hung::Hung;
use crate::onsets::{Onset, onsets};
use crate::pictures::Picture;

/// All of it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Findings {
    pub(crate) folds: Vec<FoldRun>,
    pub(crate) drifts: Vec<Drift>,
    pub(crate) onsets: Vec<Onset>,
    pub(crate) rest: Option<Rest>,
    pub(crate) springs: Vec<Spring>,
    pub(crate) cost: Option<Cost>,
    pub(crate) pictures: Vec<Picture>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) cloths: Vec<Hung>,
}

/// Where the paper's quasistatic way comes to rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Rest {
    /// Energies after its steps, over that of the equilibrium.
    pub(crate) energies: Vec<f64>,
    /// Largest coordinate of its last Newton step over that of its first.
    pub(crate) last_step: f64,
    /// Newton steps that the product's solver takes with hard rows.
    pub(crate) newton_steps: usize,
}

/// Fold angles under one moment, over theory's, of lines at several places of a mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Spring {
    pub(crate) what: String,
    pub(crate) folds: Vec<f64>,
}

/// What creases cost.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Cost {
    /// Time of an assembly with ten lines over that without.
    pub(crate) assembly: f64,
    /// Time of a frame with ten lines over that without.
    pub(crate) frame: f64,
    /// Newton steps of a frame without and with ten lines.
    pub(crate) iterations: [usize; 2],
    /// Processor seconds of a frame without and with ten lines.
    pub(crate) seconds: [f64; 2],
    /// Triangles of a film with a line, and with a band in its place.
    pub(crate) faces: [usize; 2],
    /// Multiplications and additions of a factorisation, of both.
    pub(crate) flops: [f64; 2],
    /// Shortest edges of both, wavelengths.
    pub(crate) shortest: [f64; 2],
}

impl Findings {
    pub(crate) fn measure(quick: bool) -> Self {
        let told = |what: &str| eprintln!("{what}");
        told("folds whose angle varies");
        let folds = measure_folds(quick);
        told("drift");
        let drifts = drifts();
        told("onsets");
        let onsets = onsets(quick);
        told("rest and cost");
        Self {
            folds,
            drifts,
            onsets,
            rest: Some(rest()),
            springs: springs(),
            cost: Some(cost()),
            ..Self::default()
        }
    }
}

/// Squares along the side of the sewn sheet, and steps of the paper's way.
const SQUARES: usize = 4;
const STEPS: usize = 30;

fn rest() -> Rest {
    let (mut sheet, cut, rest) = sewn_ridge(SQUARES);
    let masses = cut.masses(&rest, 1.0);
    let mut positions = sheet.positions().to_vec();
    let steps = projected_newton((sheet.layer(), &cut), &masses, &mut positions, STEPS);
    let report = sheet.solve(&NewtonSettings {
        energy_tolerance: 1e-10,
        ..NewtonSettings::default()
    });
    let least = sheet.energy();
    Rest {
        energies: steps.iter().map(|step| step.energy / least).collect(),
        last_step: steps[STEPS - 1].step / steps[1].step,
        newton_steps: report.iterations,
    }
}

/// Lines across an edge and a half of the plate's mesh; none goes through a vertex.
const PLACES: [f64; 12] = [
    0.503, 0.517, 0.531, 0.545, 0.559, 0.573, 0.587, 0.601, 0.615, 0.629, 0.643, 0.657,
];

fn springs() -> Vec<Spring> {
    let ways = [
        (Fold::Crease, "crease"),
        (Fold::EvenSprings, "even springs"),
        (Fold::SpringsByDistance, "springs k L/d²"),
    ];
    let spring = |(fold, what): (Fold, &str)| Spring {
        what: what.to_owned(),
        folds: PLACES.map(|x| fold_over_theory(fold, x)).to_vec(),
    };
    ways.map(spring).to_vec()
}

fn cost() -> Cost {
    let creases = crease_cost(16, 10);
    let frame = frame_cost(8, 10);
    let band = band_cost();
    Cost {
        assembly: creases.share,
        frame: frame.share,
        iterations: frame.iterations,
        seconds: frame.seconds,
        faces: band.faces,
        flops: band.factor.map(|own| own.flops),
        shortest: band.shortest,
    }
}
