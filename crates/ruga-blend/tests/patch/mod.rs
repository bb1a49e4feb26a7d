//! A small patch for the tests.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape};

/// A unit square of `columns` by `rows` cells in the xy plane.
pub(crate) fn patch(columns: u32, rows: u32) -> ArtistMesh {
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let mut mesh = ArtistMesh {
        name: "patch".into(),
        ..ArtistMesh::default()
    };
    let mut uvs = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let (x, y) = (
                f64::from(i) / f64::from(columns),
                f64::from(j) / f64::from(rows),
            );
            mesh.positions.push(Vector3::new(x, y, 0.0));
            uvs.push(Vector2::new(x, 1.0 - y));
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.uvs = Some(uvs);
    mesh
}

/// A blend shape.
pub(crate) fn shape(name: &str, position_deltas: Vec<Vector3<f64>>) -> BlendShape {
    BlendShape {
        name: name.into(),
        position_deltas,
        normal_deltas: None,
    }
}
