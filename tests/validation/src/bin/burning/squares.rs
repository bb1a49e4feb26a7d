//! Sheets for the product.

use std::error::Error;
use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, Driver};

/// A sheet of so many squares each way, each cut in two, with `place` (m) for shares of its sides.
pub(crate) fn squares(
    [columns, rows]: [u32; 2],
    place: &dyn Fn([f64; 2]) -> Vector3<f64>,
) -> Result<Arc<Driver>, Box<dyn Error>> {
    let corner = |i: u32, j: u32| j * (columns + 1) + i;
    let corners = (0..=rows).flat_map(|j| (0..=columns).map(move |i| [i, j]));
    let share = |[i, j]: [u32; 2]| {
        [
            f64::from(i) / f64::from(columns),
            f64::from(j) / f64::from(rows),
        ]
    };
    let shares: Vec<[f64; 2]> = corners.map(share).collect();
    let squares = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let triangles = squares.flat_map(|[i, j]| {
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [d, c] = [corner(i, j + 1), corner(i + 1, j + 1)];
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    });
    let uvs = shares.iter().map(|[u, v]| Vector2::new(*u, 1.0 - v));
    let mesh = ArtistMesh {
        name: "sheet".to_owned(),
        positions: shares.iter().map(|share| place(*share)).collect(),
        uvs: Some(uvs.collect()),
        triangles: triangles.collect(),
        ..ArtistMesh::default()
    };
    Ok(Arc::new(Driver::new(&mesh)?))
}
