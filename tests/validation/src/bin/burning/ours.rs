//! Figure 4 (c) by the product: a hot sphere crosses a hanging sheet.

use std::error::Error;
use std::path::Path;

use nalgebra::{Vector2, Vector3};
use ruga_blend::Smoothing;
use ruga_material::{LayerMaterial, ShrinkLaw, Substrate};
use ruga_stepper::{
    BurntSurface, Dynamics, Fire, FireSource, Frame, FrontDesign, GrowthDirection, Handle, Heats,
    Keyframe, LayerSpec, LayerSurface, Modelling, Motion, Observer, PoseSpec, Sheet, plan_sheet,
};
use ruga_validation::cpu_seconds;

use crate::fires::{BALL, HOT, SIDE, ball_at, is_in_picture};
use crate::pictures::Picture;
use crate::sheets::{GREY, Scene, View, draw};
use crate::squares::squares;

/// Seconds of a time step, and steps: as long as the springs' run.
const TIME_STEP: f64 = 0.05;
const STEPS: u32 = 52;

/// Drag of air (1/s), as for the springs.
const DRAG: f64 = 10.0;

/// Edges along a side of the sheet, whatever the springs have: its cost grows faster than theirs.
const EDGES: u32 = 16;

/// Steps after which the sheet is looked at, when the sphere is where the springs' pictures have it.
const MOMENTS: [usize; 4] = [12, 25, 45, 52];

/// Paper that burns as fast as the sphere goes on; what is left is half as long, as a share of mass of a half makes it for
/// the springs.
fn fire() -> Fire {
    let [radius, speed, _] = BALL;
    Fire {
        front: FrontDesign {
            speed: 0.1 * speed,
            width: 0.01,
            ignition: 573.0,
            burning: 1100.0,
            surroundings: 293.0,
            loss_time: None,
        },
        edges_per_width: 2.0,
        speed: None,
        shrink: ShrinkLaw {
            along: 0.5,
            across: 0.5,
            asymmetry: 0.0,
            char_young: 0.1,
            char_thickness: 0.8,
        },
        grain: GrowthDirection::Angle(0.0),
        shrink_factor: None,
        asymmetry_factor: None,
        char_mass: 0.5,
        ash_share: 0.2,
        ash_paint: None,
        least_piece: 1e-4,
        sources: vec![FireSource {
            name: "sphere".to_owned(),
            temperature: 1800.0,
            heats: Heats::Ball {
                centre: ball_at(0.0),
                radius,
                coefficient: 20.0,
            },
        }],
    }
}

fn held(name: &str, x: f64) -> Handle {
    let small = Vector3::repeat(1e-3);
    let corner = Vector3::new(x, 0.0, 0.5 * SIDE);
    Handle::new(name, [corner - small, corner + small])
}

/// Looks at the sheet in some steps.
#[derive(Default)]
struct Eye {
    scenes: Vec<Scene>,
}

impl Observer for Eye {
    fn frame(&mut self, frame: &Frame<'_>) {
        let step = (frame.load * f64::from(STEPS)).round() as usize;
        if let (true, Some(surface)) = (MOMENTS.contains(&step), frame.layers.first()) {
            let mut scene = seen(surface);
            let centre = ball_at(TIME_STEP * step as f64);
            if is_in_picture(&centre) {
                let [radius, _, _] = BALL;
                scene = scene.with_sphere(centre, radius, 2.2 * GREY.component_mul(&HOT));
            }
            self.scenes.push(scene);
        }
    }
}

/// What is left of the sheet, with fuel and temperature of the nearest place where these are known.
fn seen(surface: &LayerSurface) -> Scene {
    let mut scene = Scene::default();
    let known = surface.burnt.as_ref().map(known).unwrap_or_default();
    for (face, uvs) in surface.faces.iter().zip(&surface.uvs) {
        let corners = face.map(|v| surface.positions[v as usize]);
        let states = uvs.map(|uv| {
            let far = |own: &&(Vector2<f64>, [f64; 2])| (own.0 - uv).norm_squared();
            let nearest = known.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            nearest.map_or([1.0, 0.0], |own| own.1)
        });
        let squares = 40.0 * SIDE;
        let marks = [0, 1, 2].map(|k| {
            let at = (uvs[k] - Vector2::repeat(0.5)) * squares + Vector2::repeat(0.5);
            // Half of the mass is left where all fuel is gone.
            at.push(0.5 + 0.5 * states[k][0])
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

/// Runs and draws it.
pub(crate) fn hot_sphere(folder: &Path) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 4 (c), ruga");
    let material = LayerMaterial {
        young: 1e8,
        poisson: 0.3,
        thickness: 2e-4,
        density: 400.0,
    };
    let nothing = Substrate {
        young: 1.0,
        poisson: 0.0,
        thickness: 1.0,
    };
    let layer = LayerSpec::new("paper", material, nothing);
    let sheet = Sheet {
        gravity: crate::fires::GRAVITY,
        handles: vec![held("left", -0.5 * SIDE), held("right", 0.5 * SIDE)],
        obstacles: Vec::new(),
        edge: Some(SIDE / f64::from(EDGES)),
        fire: Some(fire()),
    };
    let pose = PoseSpec {
        name: "burn".to_owned(),
        weights: Default::default(),
        keys: vec![1.0],
        steps: STEPS,
        motions: vec![Motion {
            of: "sphere".to_owned(),
            keyframes: vec![Keyframe {
                at: 1.0,
                translation: ball_at(TIME_STEP * f64::from(STEPS)) - ball_at(0.0),
                turn: Vector3::zeros(),
                about: Vector3::zeros(),
            }],
        }],
        growths: Vec::new(),
    };
    let modelling = Modelling {
        dynamics: Some(Dynamics {
            time_step: TIME_STEP,
            damping: DRAG,
        }),
        smoothing: Smoothing::None,
        ..Modelling::default()
    };
    // Upright in x and z, as the sheet of the springs' picture.
    let place = |[u, v]: [f64; 2]| Vector3::new(SIDE * (u - 0.5), 0.0, SIDE * (v - 0.5));
    let driver = squares([EDGES; 2], &place)?;
    let start = cpu_seconds();
    let plan = plan_sheet(&driver, &layer, &sheet, &[pose], &modelling, 512)?;
    let mut eye = Eye::default();
    let result = plan.simulate(0, &mut eye)?;
    let seconds = cpu_seconds() - start;
    let mut facts = result.warnings.clone();
    if let Some(fire) = result.layers.first().and_then(|own| own.fire.as_ref()) {
        facts.push(format!(
            "at the end {:.2} % of the fuel is left, in {} pieces",
            100.0 * fire.fuel_left,
            fire.pieces
        ));
    }
    let view = View {
        turn: 0.35,
        nod: -1.35,
    };
    let file = "sphere_ruga.png".to_owned();
    draw(
        &folder.join(&file),
        &eye.scenes,
        (4, [1.35 * SIDE, 0.0]),
        view,
    )?;
    Ok(Picture {
        file,
        what: format!("figure 4 (c) by ruga; {EDGES} edges along a side, its own law of burning"),
        springs: 0,
        steps: STEPS as usize,
        seconds,
        facts,
    })
}
