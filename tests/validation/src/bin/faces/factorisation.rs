//! Time of one numeric factorisation, the unit in which work is stated.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Mutex;

use ruga_scene::{Scene, SceneOptions};
use ruga_solver::{Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError, minimise};
use ruga_stepper::Silent;
use ruga_validation::cpu_seconds;
use serde::{Deserialize, Serialize};

/// A factorisation that was timed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Factorisation {
    /// Unknowns of the matrix, and rows of its averaging constraints.
    pub(crate) size: [usize; 2],
    /// Processor seconds, median.
    pub(crate) seconds: f64,
}

/// Factorisations that are timed.
const RUNS: usize = 9;

/// What [`time`] has found: the product takes a function in the place of its solver, and nothing else.
static TIMED: Mutex<Option<Factorisation>> = Mutex::new(None);

impl Factorisation {
    /// The whole KKT matrix of the lowest layer in a scene's first pose, or what was timed into `file`.
    pub(crate) fn of(
        scene: &Path,
        points_per_wavelength: f64,
        file: &Path,
    ) -> Result<Self, Box<dyn Error>> {
        if let Ok(bytes) = fs::read(file) {
            return Ok(serde_json::from_slice(&bytes)?);
        }
        let options = SceneOptions {
            points_per_wavelength: Some(points_per_wavelength),
            ..SceneOptions::default()
        };
        let mut scene = Scene::read_with(scene, &options)?;
        scene.modelling.minimise = time;
        scene.plan()?.simulate(0, &mut Silent)?;
        let timed = TIMED.lock().map_err(|error| error.to_string())?.take();
        let timed = timed.ok_or("nothing wrinkles, nothing is factorised")?;
        fs::write(file, serde_json::to_vec(&timed)?)?;
        Ok(timed)
    }
}

/// In the place of a solver: times factorisations, solves nothing and asks for no more.
fn time(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    _: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let mut exact = vec![0.0; objective.pattern().entries()];
    let mut relaxed = exact.clone();
    objective.hessian(x, &mut exact, &mut relaxed);
    let mut seconds = [0.0; RUNS];
    for seconds in &mut seconds {
        let start = cpu_seconds();
        kkt.factorize(&exact, objective.damping())?;
        *seconds = cpu_seconds() - start;
    }
    seconds.sort_by(f64::total_cmp);
    if let Ok(mut timed) = TIMED.lock() {
        // The whole of a layer is solved before its patches are.
        timed.get_or_insert(Factorisation {
            size: [kkt.pattern().size(), kkt.rows().count()],
            seconds: seconds[RUNS / 2],
        });
    }
    minimise(objective, rhs, x, kkt, settings, &mut |_| false)
}
