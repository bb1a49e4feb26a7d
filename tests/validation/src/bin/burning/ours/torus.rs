//! Figure 7 by the product: a torus that falls on a sphere.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use nalgebra::Vector3;
use ruga_material::LayerMaterial;
use ruga_stepper::{Obstacle, ObstacleShape, Sheet};

use super::Film;
use crate::fires::GRAVITY;
use crate::pictures::{Fineness, Picture};
use crate::sheets::{GREY, View, draw};
use crate::squares::squares;
use crate::torus::{FLOOR, MASS, RING, SPHERE, START, TUBE, place};

/// Seconds of a time step, and drag of air (1/s).
const TIME_STEP: f64 = 0.01;
const DRAG: f64 = 1.0;

/// Steps after which the torus is looked at.
const MOMENTS: [usize; 4] = [1, 12, 30, 100];

/// Squares of the printed grid round the ring and round the tube.
const SQUARES: [f64; 2] = [24.0, 8.0];

/// Rubber as thick as this (m), as heavy as the springs.
const THICKNESS: f64 = 1e-3;
const YOUNG: f64 = 1e6;

/// Runs and draws it.
pub(crate) fn falling(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 7, ruga");
    let centre = Vector3::zeros();
    let radius = SPHERE * (RING - TUBE);
    let obstacles = [
        ("sphere", ObstacleShape::Sphere { centre, radius }),
        (
            "floor",
            ObstacleShape::Plane {
                point: Vector3::new(0.0, 0.0, FLOOR),
                normal: Vector3::z(),
            },
        ),
    ];
    let sheet = Sheet {
        gravity: GRAVITY,
        handles: Vec::new(),
        obstacles: obstacles
            .map(|(name, shape)| Obstacle {
                name: name.to_owned(),
                shape,
            })
            .to_vec(),
        // Longer than the mesh's own edges, which stay.
        edge: Some(RING),
        fire: None,
    };
    let area = TAU.powi(2) * RING * TUBE;
    let film = Film {
        material: LayerMaterial {
            young: YOUNG,
            poisson: 0.3,
            thickness: THICKNESS,
            density: MASS / (area * THICKNESS),
        },
        motions: Vec::new(),
        drag: DRAG,
        time_step: TIME_STEP,
        squares: SQUARES,
        moments: &MOMENTS,
    };
    let around = u32::try_from(fine.around)?;
    // The last of a turn lie where the first do, to the last bit.
    let at =
        |[u, v]: [f64; 2]| place([u, v].map(|share| TAU * (share % 1.0))) + START * Vector3::z();
    let filmed = film.run(&squares([around, around / 3], &at)?, &sheet)?;
    let mut facts = filmed.facts();
    let last = filmed.result.keys.last().and_then(|key| key.layers.first());
    if let Some(surface) = last {
        let heights = surface.positions.iter().map(|p| p.z);
        let mean = heights.clone().sum::<f64>() / surface.positions.len() as f64;
        facts.push(format!(
            "mean height {:.0} mm above the sphere's centre, lowest point {:.0} mm, after {:.1} s",
            1e3 * mean,
            1e3 * heights.fold(f64::MAX, f64::min),
            TIME_STEP * MOMENTS[3] as f64
        ));
    }
    let scenes = filmed.scenes.into_iter();
    let scenes: Vec<_> = scenes
        .map(|scene| scene.with_sphere(centre, radius, GREY))
        .collect();
    let view = View {
        turn: 0.0,
        nod: -1.25,
    };
    let file = "torus_ruga.png".to_owned();
    draw(&folder.join(&file), &scenes, (4, [0.34, 0.0]), view)?;
    Ok(Picture {
        file,
        what: format!(
            "figure 7 (a) by ruga; rubber {:.0} mm thick, as heavy as the springs, sphere and floor without friction",
            1e3 * THICKNESS
        ),
        springs: 0,
        steps: MOMENTS[3],
        seconds: filmed.seconds,
        facts,
    })
}
