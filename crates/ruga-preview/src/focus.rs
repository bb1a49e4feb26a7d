//! Where the camera looks when the page opens.

use nalgebra::{Matrix3, Vector2, Vector3};
use serde::Serialize;

use crate::packed_map::CELLS;
use crate::tile_split::TileSplit;

/// A sphere around the skin that wrinkles in some pose, and the side that it faces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Focus {
    /// Centre of the sphere (m).
    center: [f64; 3],
    /// Its radius (m).
    radius: f64,
    /// Unit vector from the skin towards the camera.
    direction: [f64; 3],
}

impl Focus {
    /// The focus on the triangles of a mesh, taken into the world by `turn`, that wrinkle where one of `marks` says
    /// so: `CELLS * CELLS` cells of the map of a tile each; on all of the mesh where none do.
    pub(crate) fn new<'a>(
        split: &TileSplit<'_>,
        turn: &Matrix3<f64>,
        marks: impl Iterator<Item = (usize, &'a [bool])>,
    ) -> Self {
        let mesh = &split.mesh;
        let positions: Vec<_> = mesh.positions.iter().map(|p| turn * p).collect();
        let uvs = mesh.uvs.as_deref().unwrap_or_default();
        let is_mirror = turn.determinant() < 0.0;
        let outward = |&[a, b, c]: &[u32; 3]| if is_mirror { [a, c, b] } else { [a, b, c] };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(outward).collect();
        let mut tiles = vec![vec![false; CELLS * CELLS]; split.count().max(1)];
        for (tile, marked) in marks {
            let both = tiles[tile].iter_mut().zip(marked);
            both.for_each(|(cell, wrinkled)| *cell |= wrinkled);
        }
        let wrinkles = |corners: &&[u32; 3]| {
            let mut corners = corners.iter().map(|&v| split.local(uvs[v as usize]));
            // Beyond the last of the tiles lies what no map shows.
            corners.all(|(tile, uv)| tiles.get(tile).is_some_and(|cells| cells[cell_of(uv)]))
        };
        let wrinkled: Vec<&[u32; 3]> = triangles.iter().filter(wrinkles).collect();
        match wrinkled.is_empty() {
            true => Self::around(&positions, triangles.iter()),
            false => Self::around(&positions, wrinkled.into_iter()),
        }
    }

    fn around<'a>(
        positions: &[Vector3<f64>],
        triangles: impl Iterator<Item = &'a [u32; 3]> + Clone,
    ) -> Self {
        let points = || triangles.clone().flatten().map(|&v| positions[v as usize]);
        let low = points().reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let high = points().reduce(|a, b| a.sup(&b)).unwrap_or_default();
        let center = (low + high) / 2.0;
        let radius = points().map(|p| (p - center).norm()).fold(0.0, f64::max);
        let areas = triangles.map(|corners| {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            (b - a).cross(&(c - a))
        });
        let direction = areas.sum::<Vector3<f64>>().try_normalize(1e-12);
        Self {
            center: center.into(),
            radius,
            direction: direction.map_or(Vector3::z(), from_the_side).into(),
        }
    }
}

/// A direction from which an upright camera can look: not straight from above or below.
fn from_the_side(direction: Vector3<f64>) -> Vector3<f64> {
    const STEEPEST: f64 = 0.95;
    if direction.y.abs() <= STEEPEST {
        return direction;
    }
    let height = STEEPEST.copysign(direction.y);
    let flat = Vector3::new(direction.x, 0.0, direction.z)
        .try_normalize(1e-3)
        .unwrap_or_else(Vector3::z);
    flat * (1.0 - height * height).sqrt() + Vector3::y() * height
}

/// Number of the cell in which a place of the map lies, V down.
pub(crate) fn cell_of(uv: Vector2<f64>) -> usize {
    let [column, row] = [uv.x, uv.y].map(|c| ((c * CELLS as f64) as usize).min(CELLS - 1));
    row * CELLS + column
}
