//! How far the two sides of the paper's cut drift apart (after its figure 6).

use ruga_validation::ridge::{line, unit_square};
use ruga_validation::virtual_nodes::{CutCloth, LineEnds, Stabilisation, VirtualNodes};
use serde::{Deserialize, Serialize};

/// Time that the cloth swings, s.
pub(crate) const TIME: f64 = 4.0;

/// Steps in time, s.
pub(crate) const TIME_STEPS: [f64; 3] = [0.005, 0.0025, 0.00125];

/// Ways to hold the cut, and their names.
pub(crate) const WAYS: [(Stabilisation, &str); 3] = [
    (Stabilisation::Post, "post"),
    (Stabilisation::Pre, "pre"),
    (Stabilisation::Both, "both"),
];

/// Gap of a swinging cloth of a metre over time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Drift {
    pub(crate) way: String,
    /// s.
    pub(crate) time_step: f64,
    /// Time (s) and gap (m).
    pub(crate) gaps: Vec<[f64; 2]>,
}

impl Drift {
    /// Gap at the end (m).
    pub(crate) fn last(&self) -> f64 {
        self.gaps.last().map_or(f64::NAN, |gap| gap[1])
    }
}

/// The cut cloth at rest.
pub(crate) fn cloth() -> CutCloth {
    let drawn = unit_square(8);
    let cut = VirtualNodes::cut(&drawn.mesh, &[line(&drawn)], LineEnds::AtVertices);
    CutCloth::hanging(&drawn, cut)
}

pub(crate) fn drifts() -> Vec<Drift> {
    let mut all = Vec::new();
    for (way, name) in WAYS {
        for time_step in TIME_STEPS {
            let mut cloth = cloth();
            let steps = (TIME / time_step).round() as usize;
            let gaps = (1..=steps).map(|step| {
                cloth.step(time_step, way);
                [step as f64 * time_step, cloth.gap()]
            });
            all.push(Drift {
                way: name.to_owned(),
                time_step,
                gaps: gaps.collect(),
            });
        }
    }
    all
}
