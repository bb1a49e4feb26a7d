//! Figures 1 and 12 by the product: paper on a floor that is too hot at first.

use std::error::Error;
use std::path::Path;

use nalgebra::Vector3;
use ruga_stepper::{FireSource, Heats, Mask, Obstacle, ObstacleShape, PaintedNumber, Sheet};

use super::{Film, PAPER, burning};
use crate::fires::{FLOOR, GRAVITY, GRID, LEAST_RATE, SIDE, texture};
use crate::pictures::Picture;
use crate::sheets::{View, draw};
use crate::squares::squares;

/// Seconds of a time step, and drag of air (1/s).
const TIME_STEP: f64 = 0.05;
const DRAG: f64 = 10.0;

/// Height of the sheet over its width.
const HEIGHT: f64 = 0.75;

/// Edges along the sides of the sheet.
const EDGES: [u32; 2] = [28, 21];

/// Speed (m/s) and width (m) of the front where the texture is white: fuel burns in about half a second there.
const FRONT: [f64; 2] = [0.02, 0.01];

/// Steps after which the sheet is looked at.
const MOMENTS: [usize; 5] = [1, 6, 12, 20, 40];

/// Texels along a side of the texture.
const TEXELS: u32 = 128;

/// Runs and draws it.
pub(crate) fn paper(folder: &Path) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figures 1 and 12, ruga");
    let everywhere = FireSource {
        name: "heat".to_owned(),
        temperature: 900.0,
        heats: Heats::Start(Mask::new(1, 1, vec![1.0])?),
    };
    let mut fire = burning(FRONT, vec![everywhere]);
    let share = |i: u32| (f64::from(i) + 0.5) / f64::from(TEXELS);
    let rows = (0..TEXELS).flat_map(|row| (0..TEXELS).map(move |column| [column, row]));
    let greys = rows.map(|[column, row]| {
        // Texture coordinates point down; as on the springs' sheet, whose height is three quarters of its width.
        let rate = texture(share(column), 0.5 + HEIGHT * (0.5 - share(row)));
        ((rate - LEAST_RATE) / (1.0 - LEAST_RATE)) as f32
    });
    fire.speed = Some(PaintedNumber {
        image: Mask::new(TEXELS, TEXELS, greys.collect())?,
        range: [LEAST_RATE, 1.0],
    });
    let floor = ObstacleShape::Plane {
        point: FLOOR,
        normal: Vector3::z(),
    };
    let sheet = Sheet {
        gravity: GRAVITY,
        handles: Vec::new(),
        obstacles: vec![Obstacle {
            name: "floor".to_owned(),
            shape: floor,
        }],
        edge: Some(SIDE / f64::from(EDGES[0])),
        fire: Some(fire),
    };
    let film = Film {
        material: PAPER,
        motions: Vec::new(),
        drag: DRAG,
        time_step: TIME_STEP,
        squares: [GRID * SIDE, GRID * HEIGHT * SIDE],
        moments: &MOMENTS,
    };
    let place = |[u, v]: [f64; 2]| Vector3::new(SIDE * (u - 0.5), HEIGHT * SIDE * (v - 0.5), 0.0);
    let filmed = film.run(&squares(EDGES, &place)?, &sheet)?;
    let facts = filmed.facts();
    let scenes = filmed.scenes.into_iter();
    let scenes: Vec<_> = scenes
        .map(|scene| scene.with_floor(FLOOR, 0.58 * SIDE))
        .collect();
    let view = View {
        turn: 0.3,
        nod: -0.85,
    };
    let file = "paper_ruga.png".to_owned();
    draw(&folder.join(&file), &scenes, (5, [1.25 * SIDE, 0.0]), view)?;
    Ok(Picture {
        file,
        what: format!(
            "figures 1 and 12 by ruga; {} by {} edges, its own law of burning, a floor without friction",
            EDGES[0], EDGES[1]
        ),
        springs: 0,
        steps: MOMENTS[4],
        seconds: filmed.seconds,
        facts,
    })
}
