//! Pictures of sheets with creases.

use std::error::Error;
use std::path::Path;

use nalgebra::{Rotation3, Vector2, Vector3};
use ruga_crease::{Corners, LineInput, LineTracer};
use ruga_mesh::{EdgeId, Id, TriMesh};
use ruga_stepper::Silent;
use ruga_validation::ridge::unit_square;
use ruga_validation::virtual_nodes::Stabilisation;
use ruga_validation::{
    DrawnSheet, FoldedPaper, asset, cpu_seconds, edges_within, feature_edges, upright,
};
use serde::{Deserialize, Serialize};

use crate::drifts::{TIME, TIME_STEPS, cloth};
use crate::sheets::{Seen, View, draw, draw_turned};

/// A picture, and how its sheet was solved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Picture {
    pub(crate) file: String,
    pub(crate) what: String,
    pub(crate) faces: usize,
    /// Processor seconds of the solve.
    pub(crate) seconds: f64,
    pub(crate) converged: bool,
    /// Mean of the absolute fold angles, degrees.
    pub(crate) fold: f64,
    /// Share of stretching in the energy.
    pub(crate) membrane: f64,
}

/// Draws all of them.
pub(crate) fn draw_all(folder: &Path) -> Result<Vec<Picture>, Box<dyn Error>> {
    eprintln!("pictures");
    draw_drift(folder)?;
    draw_card(folder)?;
    let all = [crossing()?, curved(), pleats()];
    let mut pictures = Vec::new();
    for scene in all {
        pictures.push(scene.fold(folder)?);
    }
    Ok(pictures)
}

/// Paper, its folds, and how it is looked at.
struct Scene {
    file: &'static str,
    what: &'static str,
    paper: FoldedPaper,
    /// Edges and angles, rad.
    folds: Vec<(EdgeId, f64)>,
    squares: f64,
    view: View,
}

impl Scene {
    fn fold(mut self, folder: &Path) -> Result<Picture, Box<dyn Error>> {
        let start = cpu_seconds();
        let report = self.paper.fold(&self.folds);
        let seconds = cpu_seconds() - start;
        let positions = self.paper.sheet.positions();
        let seen = seen(&self.paper.mesh, positions, &self.paper.rest);
        draw(&folder.join(self.file), &seen, self.squares, self.view)?;
        let states = self.paper.sheet.crease_states();
        let folds = states.iter().map(|state| state.angle.abs());
        let parts = self.paper.sheet.parts();
        Ok(Picture {
            file: self.file.to_owned(),
            what: self.what.to_owned(),
            faces: self.paper.mesh.face_count(),
            seconds,
            converged: report.converged,
            fold: (folds.sum::<f64>() / states.len() as f64).to_degrees(),
            membrane: parts.membrane / parts.total(),
        })
    }
}

fn seen(mesh: &TriMesh, positions: &[Vector3<f64>], rest: &[Vector3<f64>]) -> Vec<Seen> {
    let faces = mesh.faces().as_slice().iter();
    faces
        .map(|face| {
            let ids = face.map(Id::index);
            (ids.map(|v| positions[v]), ids.map(|v| rest[v].xy()))
        })
        .collect()
}

/// Squares along a side of the sheet with crossing folds, and edges of its fitted mesh in squares.
const SIDE: usize = 8;
const EDGE: f64 = 0.25;

/// Two lines that cross, one of them with a kink there, so that flat parts can fold about both.
fn crossing() -> Result<Scene, Box<dyn Error>> {
    let drawn = DrawnSheet::new(SIDE, 3);
    let (half, full) = (0.5 * SIDE as f64, SIDE as f64);
    // Off the vertices of the drawn mesh.
    let middle = half + 0.13;
    let kink = 0.36 * half;
    let points = |all: &[[f64; 2]]| all.iter().map(|&[x, y]| Vector3::new(x, y, 0.0)).collect();
    let lines = [
        points(&[[0.0, middle], [full, middle]]),
        points(&[
            [middle - kink, 0.0],
            [middle, middle],
            [middle - kink, full],
        ]),
    ];
    let mut traced = Vec::new();
    for points in lines {
        traced.push(LineTracer::new(&drawn.mesh, &drawn.positions).trace(
            &LineInput::Positions {
                points,
                is_closed: false,
                reach: 0.1,
                corners: Corners::Keep,
            },
        )?);
    }
    let fits = drawn.fitted(&traced, EDGE, 2);
    let made = fits.last().ok_or("no mesh was made")?;
    let rest: Vec<_> = made.positions.as_slice().iter().map(|p| p / full).collect();
    let degrees = |edge: EdgeId| {
        let [a, b] = made.mesh.edges()[edge].vertices.map(|v| made.positions[v]);
        let at = (a + b) * 0.5;
        // Valleys, but for one half of the straight line: three folds to one side and one to the other.
        match (at.y - middle).abs() < 0.02 {
            true if at.x > middle => -70.0_f64,
            _ => 70.0,
        }
    };
    let folds = feature_edges(made).into_iter();
    let folds = folds
        .map(|edge| (edge, degrees(edge).to_radians()))
        .collect();
    let faces = made.mesh.faces().as_slice().iter();
    Ok(Scene {
        file: "crossing.png",
        what: "two lines that cross (after the paper's figure 8)",
        paper: FoldedPaper::new(
            rest,
            faces.map(|face| face.map(|v| v.0)).collect(),
            0,
            FoldedPaper::THICKNESS,
        ),
        folds,
        squares: 16.0,
        view: View {
            turn: 0.6,
            nod: -0.5,
        },
    })
}

/// A ring folded along its middle.
fn curved() -> Scene {
    let (paper, middle) = FoldedPaper::ring(200_f64.to_radians(), 0.2, 8, FoldedPaper::THICKNESS);
    let line = edges_within(&paper.mesh, |v| middle.contains(&v)).into_iter();
    Scene {
        file: "curved.png",
        what: "a ring folded along its middle",
        folds: line.map(|edge| (edge, 90_f64.to_radians())).collect(),
        paper,
        squares: 20.0,
        view: View {
            turn: 0.0,
            nod: -0.8,
        },
    }
}

/// Columns of the strip to a wide and to a narrow pleat, and how many pairs of them there are.
const PLEATS: [usize; 2] = [8, 4];
const PAIRS: usize = 5;

/// A strip with folds to one side and the other by turns, in distances of two lengths.
fn pleats() -> Scene {
    let columns = PAIRS * (PLEATS[0] + PLEATS[1]);
    let length = 2.0;
    let strip = upright(length, columns, 18);
    let mesh = strip.topology();
    let rest: Vec<_> = strip.points.iter().map(|p| p.push(0.0)).collect();
    let mut folds = Vec::new();
    let mut column = 0;
    for pleat in 0..2 * PAIRS - 1 {
        column += PLEATS[pleat % 2];
        let x = length * column as f64 / columns as f64;
        let is_on = |v: u32| (rest[v as usize].x - x).abs() < 1e-9;
        let sign = if pleat % 2 == 0 { 1.0 } else { -1.0 };
        let angle = sign * 115_f64.to_radians();
        folds.extend(
            edges_within(&mesh, is_on)
                .into_iter()
                .map(|edge| (edge, angle)),
        );
    }
    Scene {
        file: "pleats.png",
        what: "knife pleats",
        paper: FoldedPaper::new(rest, strip.faces, 0, FoldedPaper::THICKNESS),
        folds,
        squares: 20.0,
        view: View {
            turn: 0.35,
            nod: -1.25,
        },
    }
}

/// The paper's cloth after its swing: with velocities made equal alone, and with positions too.
fn draw_drift(folder: &Path) -> Result<(), Box<dyn Error>> {
    let rest = unit_square(SIDE).positions;
    let mut triangles: Vec<Seen> = Vec::new();
    for (place, way) in [Stabilisation::Post, Stabilisation::Both]
        .into_iter()
        .enumerate()
    {
        let mut cloth = cloth();
        for _ in 0..(TIME / TIME_STEPS[0]).round() as usize {
            cloth.step(TIME_STEPS[0], way);
        }
        let shift = Vector3::new(1.25 * place as f64, 0.0, 0.0);
        let cut = cloth.cut();
        for face in &cut.faces {
            let nodes = face.nodes.map(|node| node as usize);
            let corners = nodes.map(|node| cloth.positions()[node] + shift);
            let flat = nodes.map(|node| rest[cut.vertices[node] as usize].xy());
            let places: Vec<(Vector3<f64>, Vector2<f64>)> = face
                .material
                .iter()
                .map(|s| {
                    let mean = corners[0] * s[0] + corners[1] * s[1] + corners[2] * s[2];
                    (mean, flat[0] * s[0] + flat[1] * s[1] + flat[2] * s[2])
                })
                .collect();
            for pair in places[1..].windows(2) {
                let all = [places[0], pair[0], pair[1]];
                triangles.push((all.map(|p| p.0), all.map(|p| p.1)));
            }
        }
    }
    let view = View {
        turn: 0.0,
        nod: -0.15,
    };
    Ok(draw(&folder.join("drift.png"), &triangles, 16.0, view)?)
}

/// The pleated card of the assets (after the paper's pleats): flat, and at its keys.
fn draw_card(folder: &Path) -> Result<(), Box<dyn Error>> {
    let scene = ruga_scene::Scene::read(&asset("paper/pleats.toml"))?;
    let result = scene.plan()?.simulate(0, &mut Silent)?;
    if !result.converged {
        return Err("the pleated card did not converge".into());
    }
    let (mesh, rest) = (scene.driver.topology(), scene.driver.rest());
    let keys = result.keys.iter();
    let moments =
        std::iter::once(rest).chain(keys.filter_map(|key| key.artist_positions.as_deref()));
    let nod = Rotation3::from_axis_angle(&Vector3::x_axis(), -0.9);
    let mut triangles: Vec<Seen> = Vec::new();
    for (place, positions) in moments.enumerate() {
        let [column, row] = [place % 2, place / 2].map(|n| n as f64);
        let shift = Vector3::new(0.21 * column, -0.15 * row, 0.0);
        let from_eye: Vec<_> = positions.iter().map(|p| nod * p + shift).collect();
        triangles.extend(seen(mesh, &from_eye, rest));
    }
    Ok(draw_turned(&folder.join("card.png"), &triangles, 60.0)?)
}
