//! The paper's scenes by the product.

pub(crate) mod crossing;
pub(crate) mod paper;
pub(crate) mod torus;

use std::error::Error;
use std::sync::Arc;

use nalgebra::Vector2;
use ruga_blend::{Driver, Smoothing};
use ruga_material::{LayerMaterial, ShrinkLaw, Substrate};
use ruga_stepper::{
    BurntSurface, Dynamics, Fire, FireSource, Frame, FrontDesign, GrowthDirection, LayerSpec,
    LayerSurface, Modelling, Motion, Observer, PoseResult, PoseSpec, Sheet, plan_sheet,
};
use ruga_validation::cpu_seconds;

use crate::sheets::Scene;

/// Share of its mass and of its lengths that burnt-out paper keeps; springs with half of their mass are half as long.
const LEFT: f64 = 0.5;

/// Paper that is soft enough to fall to the ground as the springs do.
const PAPER: LayerMaterial = LayerMaterial {
    young: 1e8,
    poisson: 0.3,
    thickness: 2e-4,
    density: 400.0,
};

/// Fire of paper with a front of this speed (m/s) and width (m), lit by `sources`.
fn burning([speed, width]: [f64; 2], sources: Vec<FireSource>) -> Fire {
    Fire {
        front: FrontDesign {
            speed,
            width,
            ignition: 573.0,
            burning: 1100.0,
            surroundings: 293.0,
            loss_time: None,
        },
        edges_per_width: 2.0,
        speed: None,
        shrink: ShrinkLaw {
            along: 1.0 - LEFT,
            across: 1.0 - LEFT,
            asymmetry: 0.0,
            char_young: 0.1,
            char_thickness: 0.8,
        },
        grain: GrowthDirection::Angle(0.0),
        shrink_factor: None,
        asymmetry_factor: None,
        char_mass: LEFT,
        ash_share: 0.2,
        ash_paint: None,
        least_piece: 1e-4,
        sources,
    }
}

/// How a sheet moves, and when it is looked at.
struct Film<'a> {
    material: LayerMaterial,
    motions: Vec<Motion>,
    /// Drag of air, 1/s.
    drag: f64,
    /// Seconds of a time step.
    time_step: f64,
    /// Squares of the printed grid along the two texture coordinates.
    squares: [f64; 2],
    /// Steps after which it is looked at, ascending; the last one ends it.
    moments: &'a [usize],
}

/// What was seen of a run, with its processor seconds.
struct Filmed {
    scenes: Vec<Scene>,
    result: PoseResult,
    seconds: f64,
}

impl Film<'_> {
    /// Runs a sheet up to the last moment.
    fn run(self, driver: &Arc<Driver>, sheet: &Sheet) -> Result<Filmed, Box<dyn Error>> {
        let nothing = Substrate {
            young: 1.0,
            poisson: 0.0,
            thickness: 1.0,
        };
        let layer = LayerSpec::new("sheet", self.material, nothing);
        let last = self.moments.last().ok_or("no moment")?;
        let pose = PoseSpec {
            name: "all".to_owned(),
            weights: Default::default(),
            keys: vec![1.0],
            steps: u32::try_from(*last)?,
            motions: self.motions,
            growths: Vec::new(),
            half: false,
        };
        let modelling = Modelling {
            dynamics: Some(Dynamics {
                time_step: self.time_step,
                damping: self.drag,
            }),
            smoothing: Smoothing::None,
            ..Modelling::default()
        };
        let start = cpu_seconds();
        let plan = plan_sheet(driver, &layer, sheet, &[pose], &modelling, 512)?;
        let mut eye = Eye {
            moments: self.moments,
            squares: self.squares,
            scenes: Vec::new(),
        };
        let result = plan.simulate(0, &mut eye)?;
        Ok(Filmed {
            scenes: eye.scenes,
            seconds: cpu_seconds() - start,
            result,
        })
    }
}

impl Filmed {
    /// Warnings, and what is left of a fire.
    fn facts(&self) -> Vec<String> {
        let mut facts = self.result.warnings.clone();
        let fires = self.result.layers.iter();
        facts.extend(fires.filter_map(|layer| layer.fire.as_ref()).map(|fire| {
            format!(
                "at the end {:.2} % of the fuel is left, in {} pieces",
                100.0 * fire.fuel_left,
                fire.pieces
            )
        }));
        facts
    }
}

/// Looks at the sheet in some steps.
struct Eye<'a> {
    moments: &'a [usize],
    squares: [f64; 2],
    scenes: Vec<Scene>,
}

impl Observer for Eye<'_> {
    fn frame(&mut self, frame: &Frame<'_>) {
        let steps = self.moments.last().copied().unwrap_or_default() as f64;
        let step = (frame.load * steps).round() as usize;
        if let (true, Some(surface)) = (self.moments.contains(&step), frame.layers.first()) {
            self.scenes.push(seen(surface, self.squares));
        }
    }
}

/// What is left of the sheet, with fuel and temperature of the nearest place where these are known.
fn seen(surface: &LayerSurface, squares: [f64; 2]) -> Scene {
    let mut scene = Scene::default();
    let known = surface.burnt.as_ref().map(known).unwrap_or_default();
    for (face, uvs) in surface.faces.iter().zip(surface.uvs.iter()) {
        let corners = face.map(|v| surface.positions[v as usize]);
        let states = uvs.map(|uv| {
            let far = |own: &&(Vector2<f64>, [f64; 2])| (own.0 - uv).norm_squared();
            let nearest = known.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            nearest.map_or([1.0, 0.0], |own| own.1)
        });
        let marks = [0, 1, 2].map(|k| {
            let at = (uvs[k] - Vector2::repeat(0.5)).component_mul(&Vector2::from(squares))
                + Vector2::repeat(0.5);
            at.push(LEFT + (1.0 - LEFT) * states[k][0])
        });
        scene.add_paper(corners, marks, states.map(|own| own[1]));
    }
    scene
}

/// Texture coordinates, and fuel and temperature (K) there.
fn known(burnt: &BurntSurface) -> Vec<(Vector2<f64>, [f64; 2])> {
    let corners = burnt.faces.iter().zip(&burnt.uvs);
    let mut known: Vec<Option<(Vector2<f64>, [f64; 2])>> = vec![None; burnt.fuel.len()];
    for (face, uvs) in corners {
        for (v, uv) in face.iter().zip(uvs) {
            let v = *v as usize;
            known[v] = Some((*uv, [burnt.fuel[v], burnt.temperature[v]]));
        }
    }
    known.into_iter().flatten().collect()
}
