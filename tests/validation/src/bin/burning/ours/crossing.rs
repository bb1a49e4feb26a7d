//! Figure 4 (c) by the product: a hot sphere crosses a hanging sheet.

use std::error::Error;
use std::path::Path;

use nalgebra::Vector3;
use ruga_stepper::{FireSource, Handle, Heats, Keyframe, Motion, Sheet};

use super::{Film, PAPER, burning};
use crate::fires::{BALL, GRAVITY, GRID, HOT, SIDE, ball_at, is_in_picture};
use crate::pictures::Picture;
use crate::sheets::{GREY, View, draw};
use crate::squares::squares;

/// Seconds of a time step.
const TIME_STEP: f64 = 0.05;

/// Drag of air (1/s), as for the springs.
const DRAG: f64 = 10.0;

/// Edges along a side of the sheet, whatever the springs have: its cost grows faster than theirs.
const EDGES: u32 = 16;

/// Steps after which the sheet is looked at, when the sphere is where the springs' pictures have it.
const MOMENTS: [usize; 4] = [12, 25, 45, 52];

fn held(name: &str, x: f64) -> Handle {
    let small = Vector3::repeat(1e-3);
    let corner = Vector3::new(x, 0.0, 0.5 * SIDE);
    Handle::new(name, [corner - small, corner + small])
}

/// Runs and draws it.
pub(crate) fn hot_sphere(folder: &Path) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 4 (c), ruga");
    let [radius, speed, _] = BALL;
    // Slower than the sphere, so that what it does not touch is left.
    let front = [0.1 * speed, 0.01];
    let sphere = FireSource {
        name: "sphere".to_owned(),
        temperature: 1800.0,
        heats: Heats::Ball {
            centre: ball_at(0.0),
            radius,
            coefficient: 20.0,
        },
    };
    let sheet = Sheet {
        gravity: GRAVITY,
        handles: vec![held("left", -0.5 * SIDE), held("right", 0.5 * SIDE)],
        obstacles: Vec::new(),
        edge: Some(SIDE / f64::from(EDGES)),
        fire: Some(burning(front, vec![sphere])),
    };
    let steps = MOMENTS[3];
    let film = Film {
        material: PAPER,
        motions: vec![Motion {
            of: "sphere".to_owned(),
            keyframes: vec![Keyframe {
                at: 1.0,
                translation: ball_at(TIME_STEP * steps as f64) - ball_at(0.0),
                turn: Vector3::zeros(),
                about: Vector3::zeros(),
            }],
        }],
        drag: DRAG,
        time_step: TIME_STEP,
        squares: [GRID * SIDE; 2],
        moments: &MOMENTS,
    };
    // Upright in x and z, as the sheet of the springs' picture.
    let place = |[u, v]: [f64; 2]| Vector3::new(SIDE * (u - 0.5), 0.0, SIDE * (v - 0.5));
    let filmed = film.run(&squares([EDGES; 2], &place)?, &sheet)?;
    let facts = filmed.facts();
    let scenes = filmed.scenes.into_iter().zip(MOMENTS);
    let scenes: Vec<_> = scenes
        .map(|(scene, step)| {
            let centre = ball_at(TIME_STEP * step as f64);
            match is_in_picture(&centre) {
                true => scene.with_sphere(centre, radius, 2.2 * GREY.component_mul(&HOT)),
                false => scene,
            }
        })
        .collect();
    let view = View {
        turn: 0.35,
        nod: -1.35,
    };
    let file = "sphere_ruga.png".to_owned();
    draw(&folder.join(&file), &scenes, (4, [1.35 * SIDE, 0.0]), view)?;
    Ok(Picture {
        file,
        what: format!("figure 4 (c) by ruga; {EDGES} edges along a side, its own law of burning"),
        springs: 0,
        steps,
        seconds: filmed.seconds,
        facts,
    })
}
