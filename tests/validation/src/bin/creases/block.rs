//! A soft block with a stiff skin that is pressed along one side: without lines, with lines that are cut into the
//! flesh, and with these held by anchors (after the paper's figure 11).

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use nalgebra::{Rotation3, Vector3};
use ruga_io::IoError;
use ruga_scene::Scene;
use ruga_stepper::{CreaseSpec, LayerSurface, PoseResult, Silent};
use ruga_validation::canvas::Canvas;
use ruga_validation::light::{SKIN, lit};
use ruga_validation::test_scene;
use serde::{Deserialize, Serialize};

/// One of the blocks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Block {
    pub(crate) what: String,
    /// Triangles of its skin.
    pub(crate) faces: usize,
    /// Time that it took, s.
    pub(crate) seconds: f64,
    pub(crate) converged: bool,
    pub(crate) lines: Vec<Line>,
    /// Largest height of the skin over its lowest place in the middle of the block, m.
    pub(crate) relief: f64,
}

/// How one of its lines has folded.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Line {
    /// Mean and largest fold angle, degrees; positive in a valley.
    pub(crate) fold: [f64; 2],
    /// Mean depth below the flesh beside it, m.
    pub(crate) depth: f64,
}

/// What becomes of the scene's creases, and what that is called.
type Change = fn(&mut Vec<CreaseSpec>);

const BLOCKS: [(&str, Change); 3] = [
    ("no line", Vec::clear),
    ("lines cut into the flesh", |creases| {
        for crease in creases {
            crease.anchor = None;
        }
    }),
    ("the same with anchors", |_| {}),
];

/// Presses the three blocks and draws them from left to right.
pub(crate) fn draw_blocks(folder: &Path) -> Result<Vec<Block>, Box<dyn Error>> {
    let mut skins = Vec::new();
    let mut blocks = Vec::new();
    for (what, change) in BLOCKS {
        let mut scene = Scene::read(&test_scene("block.toml"))?;
        change(&mut scene.layers[0].creases);
        let start = Instant::now();
        let result = scene.plan()?.simulate(0, &mut Silent)?;
        let seconds = start.elapsed().as_secs_f64();
        let surface = result.keys.last().and_then(|key| key.layers.first());
        let surface = surface.ok_or("the block has no skin")?;
        blocks.push(block(what, &result, (surface, seconds)));
        skins.push(surface.clone());
    }
    draw(&folder.join("block.png"), &skins)?;
    Ok(blocks)
}

fn block(what: &str, result: &PoseResult, (surface, seconds): (&LayerSurface, f64)) -> Block {
    let report = &result.layers[0];
    let lines = report.creases.iter().map(|own| Line {
        fold: [own.fold, own.largest_fold].map(f64::to_degrees),
        depth: own.depth,
    });
    let middle = surface.positions.iter();
    let middle = middle.filter(|p| p.x.abs() < MIDDLE && p.y.abs() < MIDDLE);
    let (low, high) = middle.fold((f64::MAX, f64::MIN), |(low, high), p| {
        (low.min(p.z), high.max(p.z))
    });
    Block {
        what: what.to_owned(),
        faces: report.faces,
        seconds,
        converged: result.converged,
        lines: lines.collect(),
        relief: high - low,
    }
}

/// Half the side of the part of the top that is far from its borders, m.
const MIDDLE: f64 = 0.035;

/// From block to block in the picture, m.
const PITCH: f64 = 0.13;

/// A low lamp on the left, so that slopes of a few degrees are seen.
const LAMP: Vector3<f64> = Vector3::new(-0.92, 0.2, 0.33);

/// Draws skins, each so far to the right of the one before, as they are seen from above their front.
fn draw(path: &Path, skins: &[LayerSurface]) -> Result<(), IoError> {
    let nod = Rotation3::from_axis_angle(&Vector3::x_axis(), -0.6);
    let mut triangles = Vec::new();
    for (place, skin) in skins.iter().enumerate() {
        let shift = Vector3::x() * (PITCH * place as f64);
        let corner = |v: u32| nod * skin.positions[v as usize] + shift;
        triangles.extend(skin.faces.iter().map(|face| face.map(corner)));
    }
    let places: Vec<_> = triangles.iter().flatten().map(|p| p.xy()).collect();
    let mut canvas = Canvas::around(places.iter(), 1500);
    for corners in triangles {
        let [a, b, c] = corners;
        if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) {
            canvas.triangle(corners, |_| lit(SKIN, normal, LAMP, 1.0));
        }
    }
    canvas.write(path)
}
