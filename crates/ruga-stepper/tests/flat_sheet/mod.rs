//! Flat sheets of paper that tests hold, bend and burn.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, Driver};
use ruga_material::{LayerMaterial, Substrate};
use ruga_stepper::{GrowthSpec, Handle, LayerSpec};

/// A flat rectangle from the origin in the plane z = 0, m, of about square cells.
pub(crate) fn rectangle([length, width]: [f64; 2], cells: [u32; 2]) -> Arc<Driver> {
    laid(cells, |u, v| Vector3::new(length * u, width * v, 0.0))
}

/// A rectangle of so many cells that is laid somewhere (m), by the shares of its length and width.
pub(crate) fn laid(
    [columns, rows]: [u32; 2],
    place: impl Fn(f64, f64) -> Vector3<f64>,
) -> Arc<Driver> {
    let corner = |i: u32, j: u32| j * (columns + 1) + i;
    let places = (0..=rows).flat_map(|j| (0..=columns).map(move |i| [i, j]));
    let share = |[i, j]: [u32; 2]| {
        [
            f64::from(i) / f64::from(columns),
            f64::from(j) / f64::from(rows),
        ]
    };
    let shares: Vec<[f64; 2]> = places.map(share).collect();
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let triangles = cells.flat_map(|[i, j]| {
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [d, c] = [corner(i, j + 1), corner(i + 1, j + 1)];
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    });
    let mesh = ArtistMesh {
        name: "sheet".into(),
        positions: shares.iter().map(|[u, v]| place(*u, *v)).collect(),
        uvs: Some(
            shares
                .iter()
                .map(|[u, v]| Vector2::new(*u, 1.0 - v))
                .collect(),
        ),
        triangles: triangles.collect(),
        ..ArtistMesh::default()
    };
    Arc::new(Driver::new(&mesh).expect("a rectangle"))
}

/// Paper without a Poisson ratio, .1 mm thick.
pub(crate) fn paper(growths: Vec<GrowthSpec>) -> LayerSpec {
    let material = LayerMaterial {
        young: 3e9,
        poisson: 0.0,
        thickness: 1e-4,
        density: 800.0,
    };
    let nothing = Substrate {
        young: 1.0,
        poisson: 0.0,
        thickness: 1.0,
    };
    LayerSpec {
        growths,
        ..LayerSpec::new("paper", material, nothing)
    }
}

/// The end of a strip at x = 0, held.
pub(crate) fn clamp(length: f64) -> Handle {
    let box_ = [
        Vector3::new(-1.0, -1.0, -1.0),
        Vector3::new(length, 1.0, 1.0),
    ];
    Handle::new("clamp", box_)
}
