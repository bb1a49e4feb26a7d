//! A cushion that falls onto a table between four walls and is pressed by a ball, again and again.

use std::error::Error;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, Smoothing};
use ruga_io::{ObjOptions, read_mesh};
use ruga_material::{
    LayerMaterial, MaterialError, Substrate, WavelengthModel, Wrinkling, wrinkling,
};
use ruga_solver::Minimise;
use ruga_stepper::{
    Body, CellShape, ComputedMesh, Coupling, Dynamics, EdgeLimits, Frame, Keyframe, LayerReport,
    Modelling, Motion, Observer, Obstacle, ObstacleShape, Phase, Plan, PoseResult, PoseSpec,
    Progress, Region, SolidMaterial, plan_body,
};

use super::slab::skin_of;
use super::stopwatch::{Stopwatch, Times};
use crate::asset;

/// Sides of the shipped cushion, m.
const SIDES: [f64; 3] = [0.12, 0.12, 0.04];

/// The table, the walls and the ball, in heights of the cushion: the fall, the room on each side, the
/// ball's radius, its rest above the cushion, and how far it comes down.
const FALL: f64 = 0.25;
const ROOM: f64 = 0.25;
const RADIUS: f64 = 0.75;
const ABOVE: f64 = 0.1;
const WAY: f64 = 0.8;

/// Seconds from one press to the next, for a cushion 4 cm high.
const PERIOD: f64 = 0.4;

/// Of the inside and of its weight.
const YOUNG: f64 = 2e4;
const DENSITY: f64 = 1000.0;

/// A cushion and how its motion is computed.
#[derive(Clone, Copy, Debug)]
pub struct Cushion {
    /// Size over that of the shipped one, 12 x 12 x 4 cm.
    pub scale: f64,
    /// Of the cover, m.
    pub thickness: f64,
    /// Young's modulus of the cover over that of the inside.
    pub ratio: f64,
    /// Lattice cells along the longest side.
    pub cells: u32,
    /// Edges of the cover's mesh per wavelength.
    pub points: f64,
    /// Whether the cover's mesh is fitted to what a first run finds, or fine everywhere.
    pub is_fitted: bool,
    /// How the cover is held.
    pub coupling: Coupling,
    /// Length of a step in time, s.
    pub time_step: f64,
    /// Steps in time.
    pub steps: u32,
    /// Method that finds the end of every step in time.
    pub minimise: Minimise,
}

/// What became of it.
#[derive(Clone, Debug)]
pub struct Thrown {
    /// Whether every step in time was found.
    pub converged: bool,
    /// Steps that were found.
    pub frames: usize,
    /// What they took.
    pub times: Times,
    /// Farthest way of a vertex out of the room in any step, in heights of the cushion.
    pub outside: f64,
    /// Least and greatest height of the cushion after a step, over that at rest.
    pub heights: [f64; 2],
    /// What the simulator measured in the end.
    pub report: LayerReport,
    /// What it warned of.
    pub warnings: Vec<String>,
    /// The mesh of the cover, where it ended.
    pub cover: ComputedMesh,
}

impl Cushion {
    /// Throws the cushion.
    ///
    /// # Errors
    /// What the simulator refuses.
    pub fn throw(&self) -> Result<Thrown, Box<dyn Error>> {
        let (driver, modelling) = (self.driver()?, self.modelling());
        let mut watch = Watch::new(self);
        let plan = self.plan(&driver, &modelling)?;
        let PoseResult {
            keys,
            layers,
            converged,
            frames,
            warnings,
            ..
        } = plan.simulate(0, &mut watch)?;
        Ok(Thrown {
            converged,
            frames,
            times: watch.stopwatch.times,
            outside: watch.outside,
            heights: watch.heights,
            report: layers.into_iter().next().unwrap_or_default(),
            warnings,
            cover: (keys.into_iter().flat_map(|key| key.layers).next())
                .map_or_else(ComputedMesh::default, |layer| layer.computed),
        })
    }

    /// Of the cover.
    pub(super) const POISSON: f64 = 0.48;

    /// Young's modulus of the cover, Pa.
    pub(super) fn young(&self) -> f64 {
        self.ratio * YOUNG
    }

    /// The cover, and the inside as it sees it.
    pub(super) fn materials(&self) -> (LayerMaterial, Substrate) {
        let cover = LayerMaterial {
            young: self.young(),
            poisson: Self::POISSON,
            thickness: self.thickness,
            density: DENSITY,
        };
        let inside = Substrate {
            young: YOUNG,
            poisson: 0.4,
            thickness: 0.5 * self.sides().z,
        };
        (cover, inside)
    }

    /// Theory's numbers for the cover.
    pub(super) fn theory(&self) -> Result<Wrinkling, MaterialError> {
        let (cover, inside) = self.materials();
        wrinkling(&cover, &inside, WavelengthModel::HalfSpace)
    }

    fn sides(&self) -> Vector3<f64> {
        Vector3::from(SIDES) * self.scale
    }

    pub(super) fn driver(&self) -> Result<Arc<Driver>, Box<dyn Error>> {
        let mut mesh = read_mesh(&asset("pillow/pillow.glb"), None, &ObjOptions::default())?.mesh;
        for place in &mut mesh.positions {
            *place *= self.scale;
        }
        Ok(Arc::new(Driver::new(&mesh)?))
    }

    fn plan(&self, driver: &Arc<Driver>, modelling: &Modelling) -> Result<Plan, Box<dyn Error>> {
        let layer = skin_of(self.materials(), self.coupling);
        let thrown = PoseSpec {
            name: "thrown".into(),
            weights: Default::default(),
            keys: vec![1.0],
            steps: self.steps,
            motions: vec![self.presses()],
            growths: Vec::new(),
            half: false,
        };
        Ok(plan_body(
            driver,
            &[layer],
            &self.body(),
            &[thrown],
            modelling,
            1024,
        )?)
    }

    pub(super) fn body(&self) -> Body {
        let sides = self.sides();
        let plane = |name: &str, way: Vector3<f64>, distance: f64| Obstacle {
            name: name.into(),
            shape: ObstacleShape::Plane {
                point: -way * distance,
                normal: way,
            },
        };
        let room = 0.5 * sides.x + ROOM * sides.z;
        let ball = Obstacle {
            name: "ball".into(),
            shape: ObstacleShape::Sphere {
                centre: Vector3::z() * ((0.5 + ABOVE + RADIUS) * sides.z),
                radius: RADIUS * sides.z,
            },
        };
        Body {
            cells: Some(self.cells),
            shape: CellShape::Quadratic,
            material: SolidMaterial {
                young: YOUNG,
                poisson: 0.4,
            },
            density: DENSITY,
            gravity: Vector3::z() * -9.81,
            handles: Vec::new(),
            obstacles: vec![
                plane("table", Vector3::z(), (0.5 + FALL) * sides.z),
                plane("left wall", Vector3::x(), room),
                plane("right wall", -Vector3::x(), room),
                plane("front wall", Vector3::y(), room),
                plane("back wall", -Vector3::y(), room),
                ball,
            ],
            follow: None,
        }
    }

    /// Down in the first half of every period, up again in the second.
    fn presses(&self) -> Motion {
        let whole = f64::from(self.steps) * self.time_step;
        let half = 0.5 * PERIOD * self.scale.sqrt() / whole;
        let down = -WAY * self.sides().z * Vector3::z();
        let key = |at: f64, translation| Keyframe {
            at,
            translation,
            turn: Vector3::zeros(),
            about: Vector3::zeros(),
        };
        let times = (1..).map(|k| f64::from(k) * half);
        let ways = [down, Vector3::zeros()].into_iter().cycle();
        let mut keyframes: Vec<_> = times
            .zip(ways)
            .take_while(|(at, _)| *at < 1.0)
            .map(|(at, way)| key(at, way))
            .collect();
        if keyframes.is_empty() {
            keyframes.push(key(1.0, down / half));
        }
        Motion {
            of: "ball".into(),
            keyframes,
        }
    }

    fn modelling(&self) -> Modelling {
        Modelling {
            points_per_wavelength: self.points,
            smoothing: Smoothing::None,
            region: Region::All,
            remesh: self.is_fitted.then(EdgeLimits::default),
            minimise: self.minimise,
            dynamics: Some(Dynamics {
                time_step: self.time_step,
                damping: 0.5,
            }),
            ..Modelling::default()
        }
    }
}

/// Takes times, and looks where the cushion is.
struct Watch {
    stopwatch: Stopwatch,
    sides: Vector3<f64>,
    outside: f64,
    heights: [f64; 2],
}

impl Watch {
    fn new(cushion: &Cushion) -> Self {
        Self {
            stopwatch: Stopwatch::new(),
            sides: cushion.sides(),
            outside: 0.0,
            heights: [f64::INFINITY, 0.0],
        }
    }
}

impl Observer for Watch {
    fn phase(&mut self, layer: usize, phase: Phase) {
        self.stopwatch.phase(layer, phase);
    }

    fn progress(&mut self, progress: Progress) -> bool {
        self.stopwatch.progress(progress)
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        self.stopwatch.frame(frame);
        let Some(layer) = frame.layers.first() else {
            return;
        };
        let height = self.sides.z;
        let room = 0.5 * self.sides.x + ROOM * height;
        let floor = -(0.5 + FALL) * height;
        for p in &layer.positions {
            let beyond = (p.x.abs() - room).max(p.y.abs() - room).max(floor - p.z);
            let outside = beyond / height;
            self.outside = self.outside.max(outside);
        }
        let (low, high) = layer
            .positions
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p.z), high.max(p.z))
            });
        let now = (high - low) / height;
        self.heights = [self.heights[0].min(now), self.heights[1].max(now)];
    }
}
