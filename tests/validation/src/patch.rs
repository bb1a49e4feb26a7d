//! A flat patch of skin that one blend shape compresses in one direction.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_stepper::PoseSpec;

/// A rectangle about the origin of the plane `z = 0`, m.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Extent along x, the direction of the compression, m.
    pub length: f64,
    /// Extent along y, m.
    pub width: f64,
    /// Share of its length that the shape takes away.
    pub compression: f64,
}

/// Edges of the artist's mesh along the patch's width.
const ROWS: usize = 6;

impl Patch {
    /// The artist's mesh: squares of about a sixth of the width, cut in two.
    ///
    /// # Panics
    /// When the patch has no area.
    pub fn driver(&self) -> Arc<Driver> {
        let columns = (ROWS as f64 * self.length / self.width).round() as usize;
        let uv =
            |i: usize, j: usize| Vector2::new(i as f64 / columns as f64, j as f64 / ROWS as f64);
        let uvs: Vec<_> = (0..=ROWS)
            .flat_map(|j| (0..=columns).map(move |i| uv(i, j)))
            .collect();
        let place = |uv: &Vector2<f64>| {
            Vector3::new((uv.x - 0.5) * self.length, (uv.y - 0.5) * self.width, 0.0)
        };
        let positions: Vec<_> = uvs.iter().map(place).collect();
        let shrink = |p: &Vector3<f64>| Vector3::new(-self.compression * p.x, 0.0, 0.0);
        let artist = ArtistMesh {
            name: "patch".to_owned(),
            shapes: vec![BlendShape {
                name: "compress".to_owned(),
                position_deltas: positions.iter().map(shrink).collect(),
                normal_deltas: None,
            }],
            positions,
            normals: None,
            uvs: Some(uvs),
            triangles: triangles(columns),
        };
        Arc::new(Driver::new(&artist).expect("a rectangle"))
    }

    /// The compressed patch, reached in `steps` load steps.
    ///
    /// # Panics
    /// When `driver` is not a patch's.
    pub fn pose(&self, driver: &Driver, steps: u32) -> PoseSpec {
        PoseSpec {
            name: "compress".to_owned(),
            weights: driver
                .weights([("compress", 1.0)])
                .expect("the shape of every patch"),
            keys: vec![1.0],
            steps,
            motions: Vec::new(),
        }
    }

    /// Where a point of the posed driver was at rest, in the plane.
    pub fn material(&self, posed: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(posed.x / (1.0 - self.compression), posed.y)
    }
}

/// Squares cut along diagonals that alternate, so that the mesh prefers neither.
fn triangles(columns: usize) -> Vec<[u32; 3]> {
    let vertex = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let square = |i: usize, j: usize| {
        let [a, b] = [vertex(i, j), vertex(i + 1, j)];
        let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    };
    (0..ROWS)
        .flat_map(|j| (0..columns).flat_map(move |i| square(i, j)))
        .collect()
}
