//! What a step of a large burning sheet takes: factorisations, and time by what it goes into.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use nalgebra::Vector3;
use ruga_blend::Smoothing;
use ruga_material::{LayerMaterial, ShrinkLaw, Substrate};
use ruga_solver::{Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError, minimise};
use ruga_stepper::{
    Dynamics, Fire, FireSource, Frame, FrontDesign, GrowthDirection, Handle, Heats, LayerSpec,
    Modelling, Observer, Phase, PoseSpec, Progress, Sheet, plan_sheet,
};
use serde::{Deserialize, Serialize};

use crate::squares::squares;

/// Sides of the sheet, m, and squares of its mesh.
const SIDES: [f64; 2] = [0.1, 0.07];
const SQUARES: [u32; 2] = [23, 17];

/// Longest edges (m) of meshes of one length: 100 thousand triangles.
const EDGE: f64 = 6e-4;

/// Widths of fronts (m): that of most shipped scenes, and a narrow one.
const WIDE: f64 = 4e-3;
const NARROW: f64 = 1.4e-3;

/// Length of a step, s: a narrow front goes on by a seventh of its width.
const TIME_STEP: f64 = 0.1;

/// Factorisations of all solves since [`factorisations`] took them last. Static, because [`Modelling::minimise`] is a
/// plain function.
static FACTORISATIONS: AtomicUsize = AtomicUsize::new(0);

/// A run of a large sheet.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct LargeRun {
    /// Width of the front, m.
    pub(crate) width: f64,
    /// Whether edges have one length everywhere.
    pub(crate) is_even: bool,
    pub(crate) triangles: usize,
    pub(crate) remeshings: usize,
    pub(crate) steps: u32,
    /// Newton iterations of every step; in the first it catches fire, and the last is as exact as a result.
    pub(crate) iterations: Vec<usize>,
    /// Factorisations of every step.
    pub(crate) factorisations: Vec<usize>,
    /// Seconds of all steps for temperature and fuel, for new meshes, for the solver, and for the cut and the mesh that
    /// is seen.
    pub(crate) seconds: [f64; 4],
}

/// Runs it with edges of one length and with a mesh that follows the fire.
pub(crate) fn measure(quick: bool) -> Result<Vec<LargeRun>, Box<dyn Error>> {
    let runs: &[(f64, Option<f64>, u32)] = match quick {
        true => &[(WIDE, Some(EDGE), 3), (NARROW, None, 4)],
        false => &[
            (WIDE, Some(EDGE), 20),
            (NARROW, Some(EDGE), 4),
            (NARROW, None, 20),
        ],
    };
    let mut done = Vec::new();
    for &(width, edge, steps) in runs {
        eprintln!("a large sheet, {steps} steps");
        done.push(run(width, edge, steps)?);
    }
    Ok(done)
}

/// The product's solver, which also records its factorisations.
fn counted(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let report = minimise(objective, rhs, x, kkt, settings, keep_going)?;
    FACTORISATIONS.fetch_add(report.factorizations, Ordering::Relaxed);
    Ok(report)
}

/// Factorisations since the last call.
fn factorisations() -> usize {
    FACTORISATIONS.swap(0, Ordering::Relaxed)
}

fn run(width: f64, edge: Option<f64>, steps: u32) -> Result<LargeRun, Box<dyn Error>> {
    let material = LayerMaterial {
        young: 3e9,
        poisson: 0.3,
        thickness: 1e-4,
        density: 800.0,
    };
    let nothing = Substrate {
        young: 1.0,
        poisson: 0.0,
        thickness: 1.0,
    };
    let layer = LayerSpec::new("paper", material, nothing);
    let small = Vector3::repeat(1e-3);
    let far = Vector3::new(0.0, SIDES[1], 0.0);
    let sheet = Sheet {
        gravity: Vector3::new(9.81, 0.0, 0.0),
        handles: vec![Handle::new("clip", [-small, far + small])],
        obstacles: Vec::new(),
        edge,
        fire: Some(fire(width)),
    };
    let pose = PoseSpec {
        name: "burn".to_owned(),
        weights: Default::default(),
        keys: vec![1.0],
        steps,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    };
    let modelling = Modelling {
        dynamics: Some(Dynamics {
            time_step: TIME_STEP,
            damping: 2.0,
        }),
        smoothing: Smoothing::None,
        minimise: counted,
        ..Modelling::default()
    };
    let place = |[u, v]: [f64; 2]| Vector3::new(SIDES[0] * u, SIDES[1] * v, 0.0);
    let driver = squares(SQUARES, &place)?;
    let plan = plan_sheet(&driver, &layer, &sheet, &[pose], &modelling, 1024)?;
    let mut clock = Clock::default();
    let result = plan.simulate(0, &mut clock)?;
    clock.close();
    // The last frame has opened a step that is not there.
    clock.iterations.pop();
    let report = result.layers.first().ok_or("no layer")?;
    let fire = report.fire.as_ref().ok_or("no fire")?;
    Ok(LargeRun {
        width,
        is_even: edge.is_some(),
        triangles: report.faces,
        remeshings: fire.remeshed,
        steps,
        iterations: clock.iterations,
        factorisations: clock.factorisations,
        seconds: clock.seconds,
    })
}

/// The fire of `assets/paper/corner.toml` with a front of such a width, m.
fn fire(width: f64) -> Fire {
    Fire {
        front: FrontDesign {
            speed: 2e-3,
            width,
            ignition: 573.0,
            burning: 1100.0,
            surroundings: 293.0,
            loss_time: None,
        },
        edges_per_width: 4.0,
        speed: None,
        shrink: ShrinkLaw {
            along: 0.25,
            across: 0.25,
            asymmetry: 0.02,
            char_young: 0.1,
            char_thickness: 0.8,
        },
        grain: GrowthDirection::Angle(0.0),
        shrink_factor: None,
        asymmetry_factor: None,
        char_mass: 0.2,
        ash_share: 0.15,
        ash_paint: None,
        least_piece: 1e-6,
        sources: vec![FireSource {
            name: "match".to_owned(),
            temperature: 1300.0,
            heats: Heats::Ball {
                centre: Vector3::new(SIDES[0], SIDES[1], 0.0),
                radius: 0.012,
                coefficient: 20.0,
            },
        }],
    }
}

/// Number of what a step's time goes into, in [`LargeRun::seconds`].
const FIELDS: usize = 0;
const REMESHING: usize = 1;
const SOLVER: usize = 2;
const CUT: usize = 3;

/// Adds up what goes into what, from the first solve on.
#[derive(Default)]
struct Clock {
    seconds: [f64; 4],
    open: Option<(usize, Instant)>,
    has_begun: bool,
    iterations: Vec<usize>,
    factorisations: Vec<usize>,
}

impl Clock {
    fn close(&mut self) -> Option<usize> {
        let (work, since) = self.open.take()?;
        self.seconds[work] += since.elapsed().as_secs_f64();
        Some(work)
    }
}

impl Observer for Clock {
    fn phase(&mut self, _: usize, phase: Phase) {
        let last = self.close();
        if phase == Phase::Integration && !std::mem::replace(&mut self.has_begun, true) {
            // What was made before the first step is made once.
            self.seconds = [0.0; 4];
        }
        let work = match phase {
            Phase::Integration | Phase::Constraints => SOLVER,
            Phase::Remeshing => REMESHING,
            // After a solve it is what the frame shows.
            Phase::Sampling if last == Some(SOLVER) => CUT,
            Phase::Sampling => FIELDS,
        };
        self.open = Some((work, Instant::now()));
    }

    fn progress(&mut self, _: Progress) -> bool {
        match self.iterations.last_mut() {
            Some(own) => *own += 1,
            None => self.iterations.push(1),
        }
        true
    }

    fn frame(&mut self, _: &Frame<'_>) {
        self.close();
        self.iterations.push(0);
        self.factorisations.push(factorisations());
    }
}
