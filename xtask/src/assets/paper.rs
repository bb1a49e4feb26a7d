//! A sheet of paper, flat and without blend shapes.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendError};

use super::finish;

/// Sides, m.
const SIDES: [f64; 2] = [0.1, 0.07];
/// Cells along them.
const CELLS: [u32; 2] = [20, 14];
/// Share of the texture that is left free on each side.
const MARGIN: f64 = 0.02;

/// The sheet, as its file holds it: squares cut along diagonals that alternate, so that it prefers no direction.
pub(super) fn mesh() -> Result<ArtistMesh, BlendError> {
    let [columns, rows] = CELLS;
    let corners = (0..=rows).flat_map(|j| (0..=columns).map(move |i| [i, j]));
    let share = |[i, j]: [u32; 2]| {
        Vector2::new(
            f64::from(i) / f64::from(columns),
            f64::from(j) / f64::from(rows),
        )
    };
    let shares: Vec<Vector2<f64>> = corners.map(share).collect();
    let place = |share: &Vector2<f64>| Vector3::new(SIDES[0] * share.x, SIDES[1] * share.y, 0.0);
    let inside = |share: f64| MARGIN + (1.0 - 2.0 * MARGIN) * share;
    let vertex = |i: u32, j: u32| j * (columns + 1) + i;
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let triangles = cells.flat_map(|[i, j]| {
        let [a, b] = [vertex(i, j), vertex(i + 1, j)];
        let [d, c] = [vertex(i, j + 1), vertex(i + 1, j + 1)];
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    });
    finish(ArtistMesh {
        name: "Paper".to_owned(),
        positions: shares.iter().map(place).collect(),
        normals: None,
        uvs: Some(
            shares
                .iter()
                .map(|share| Vector2::new(inside(share.x), inside(1.0 - share.y)))
                .collect(),
        ),
        triangles: triangles.collect(),
        shapes: Vec::new(),
    })
}
