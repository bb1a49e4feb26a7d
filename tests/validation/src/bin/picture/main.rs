//! Faces with baked wrinkles, lit, side by side: `cargo xtask picture DIR`.
//!
//! Each is the posed mesh of `assets/face`, smoothed as the product smooths it, with the normal maps
//! of the bake in `DIR`. Light is added up in linear units and stored with the sRGB curve.

#![allow(
    clippy::print_stdout,
    reason = "the picture's path is for the person who started this"
)]

mod colour;
mod head;
mod normal_map;

use std::error::Error;
use std::path::Path;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{BaseSurface, Driver, Smoothing};
use ruga_validation::asset;
use ruga_validation::canvas::Canvas;

use head::{Head, View};
use normal_map::NormalMap;

/// Where the picture goes, below the assets.
const PICTURE: &str = "face/wrinkles.png";

/// Pixels across.
const WIDTH: usize = 1120;

/// From the middle of one head to the next, m.
const APART: f64 = 0.172;

/// A head of the picture: poses of the scene at full weight, their maps laid over each other.
struct Portrait {
    poses: &'static [&'static str],
    weights: &'static [(&'static str, f64)],
    view: View,
}

/// From left to right.
const PORTRAITS: [Portrait; 3] = [
    Portrait {
        poses: &["brows-up"],
        weights: &[
            ("browInnerUp", 1.0),
            ("browOuterUpLeft", 1.0),
            ("browOuterUpRight", 1.0),
        ],
        view: View {
            turn: 0.30,
            nod: 0.10,
        },
    },
    Portrait {
        poses: &["smile", "squint"],
        weights: &[
            ("mouthSmileLeft", 1.0),
            ("mouthSmileRight", 1.0),
            ("eyeSquintLeft", 1.0),
            ("eyeSquintRight", 1.0),
        ],
        view: View {
            turn: -0.42,
            nod: 0.06,
        },
    },
    Portrait {
        poses: &["frown", "sneer", "pucker"],
        weights: &[
            ("browDownLeft", 1.0),
            ("browDownRight", 1.0),
            ("noseSneerLeft", 1.0),
            ("noseSneerRight", 1.0),
            ("mouthPucker", 1.0),
        ],
        view: View {
            turn: 0.0,
            nod: 0.06,
        },
    },
];

/// Levels of subdivision: triangles of a pixel or two.
const LEVELS: u32 = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let bake = std::env::args_os().nth(1).ok_or("usage: picture DIR")?;
    let mesh = ruga_io::read_mesh(&asset("face/face.glb"), None, &Default::default())?.mesh;
    let driver = Driver::new(&mesh)?;
    let faces: Vec<_> = driver.topology().faces().ids().collect();
    let surface = BaseSurface::new(&driver, &faces, LEVELS, Smoothing::Loop);
    let rest = surface.pose(driver.rest()).positions;
    let mut heads = Vec::new();
    for (index, portrait) in PORTRAITS.iter().enumerate() {
        let weights = driver.weights(portrait.weights.iter().copied())?;
        let maps: Result<Vec<NormalMap>, _> = portrait
            .poses
            .iter()
            .map(|pose| NormalMap::read(Path::new(&bake), pose))
            .collect();
        heads.push(Head {
            surface: &surface,
            rest: &rest,
            posed: surface.pose(&driver.pose(&weights)),
            maps: maps?,
            view: portrait.view,
            at: Vector3::x() * (APART * index as f64),
        });
    }
    let places: Vec<Vector2<f64>> = heads.iter().flat_map(Head::places).collect();
    let mut canvas = Canvas::around(places.iter(), WIDTH);
    for head in &heads {
        head.draw(&mut canvas);
    }
    let picture = asset(PICTURE);
    canvas.write(&picture)?;
    println!("{}", picture.display());
    Ok(())
}
