//! The paper's figures by its springs, some by the product too, as far as captions and text say what they show.

use std::error::Error;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::{fires, ours, stiffness, torus};

/// A picture, and what its run came to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Picture {
    pub(crate) file: String,
    /// What it shows, from left to right, and after which figure.
    pub(crate) what: String,
    /// Springs of one sheet; none if the product ran.
    pub(crate) springs: usize,
    /// Time steps of all runs in the picture.
    pub(crate) steps: usize,
    /// Processor seconds of these.
    pub(crate) seconds: f64,
    /// What was measured, a line each.
    pub(crate) facts: Vec<String>,
}

/// How finely sheets are cut into cells, and how many steps are made.
#[derive(Clone, Copy)]
pub(crate) struct Fineness {
    /// Cells along the longer side of a sheet; a multiple of 4.
    pub(crate) cells: usize,
    /// Cells round a torus; those round its tube are a third.
    pub(crate) around: usize,
}

/// Draws all of them.
pub(crate) fn draw_all(folder: &Path, quick: bool) -> Result<Vec<Picture>, Box<dyn Error>> {
    let fine = match quick {
        true => Fineness {
            cells: 16,
            around: 36,
        },
        false => Fineness {
            cells: 28,
            around: 48,
        },
    };
    let mut pictures = vec![fires::paper(folder, fine)?, ours::paper::paper(folder)?];
    pictures.extend(fires::hot_sphere(folder, fine)?);
    pictures.push(ours::crossing::hot_sphere(folder)?);
    pictures.push(torus::falling(folder, fine)?);
    pictures.push(ours::torus::falling(folder, fine)?);
    pictures.push(stiffness::one_layer(folder, fine)?);
    pictures.push(stiffness::thicknesses(folder, fine)?);
    pictures.push(torus::burning(folder, fine)?);
    Ok(pictures)
}
