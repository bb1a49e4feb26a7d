//! A cloth hung by two corners, with a line that it folds along and without (after the paper's figure 9).

use std::error::Error;
use std::path::Path;

use nalgebra::{Rotation3, Vector3};
use ruga_validation::hung_cloth::{HungFold, hang};
use serde::{Deserialize, Serialize};

use crate::sheets::{Seen, draw_turned};

/// One of the cloths.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Hung {
    pub(crate) what: String,
    /// Triangles.
    pub(crate) faces: usize,
    /// Processor seconds of the solve.
    pub(crate) seconds: f64,
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
    /// Energy with that of its weight, J.
    pub(crate) energy: f64,
    /// Mean angle along the line, degrees.
    pub(crate) fold: f64,
}

/// Edges along a side.
const COARSE: usize = 8;
const FINE: usize = 32;

/// From left to right, a row after the other.
const CLOTHS: [(&str, HungFold, usize); 6] = [
    ("no crease, coarse", HungFold::None, COARSE),
    ("no crease, fine", HungFold::None, FINE),
    ("crease, coarse", HungFold::Crease, COARSE),
    ("crease, fine", HungFold::Crease, FINE),
    ("virtual nodes, springs, coarse", HungFold::Springs, COARSE),
    ("virtual nodes, coarse", HungFold::VirtualNodes, COARSE),
];

/// Cloths in a row of the picture, and from one to the next.
const COLUMNS: usize = 3;
const PITCH: [f64; 2] = [1.15, 1.05];

/// Hangs all cloths and draws them.
pub(crate) fn draw_hung(folder: &Path) -> Result<Vec<Hung>, Box<dyn Error>> {
    let mut all = Vec::new();
    let mut triangles: Vec<Seen> = Vec::new();
    // The line from corner to corner is level, and seen from beside its end and a little from above.
    let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.3)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), 1.05)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_4);
    for (place, (what, fold, edges)) in CLOTHS.into_iter().enumerate() {
        let cloth = hang(fold, edges);
        let [column, row] = [place % COLUMNS, place / COLUMNS].map(|n| n as f64);
        let shift = Vector3::new(PITCH[0] * column, -PITCH[1] * row, 0.0);
        let own = cloth.triangles.iter();
        triangles.extend(own.map(|(corners, flat)| (corners.map(|p| turned * p + shift), *flat)));
        all.push(Hung {
            what: what.to_owned(),
            faces: cloth.faces,
            seconds: cloth.seconds,
            iterations: cloth.iterations,
            converged: cloth.converged,
            energy: cloth.energy,
            fold: cloth.fold,
        });
    }
    draw_turned(&folder.join("hung.png"), &triangles, 16.0)?;
    Ok(all)
}
