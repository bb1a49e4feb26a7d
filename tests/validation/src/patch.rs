//! Flat patches of skin that one blend shape compresses in one direction.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
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

/// Share of a square by which vertices of an uneven mesh are moved at most.
const UNEVEN: f64 = 0.25;

impl Patch {
    /// The artist's mesh: squares of about a sixth of the width, cut in two.
    ///
    /// # Panics
    /// When the patch has no area.
    pub fn driver(&self) -> Arc<Driver> {
        let columns = (ROWS as f64 * self.length / self.width).round() as usize;
        let shrink = |p: Vector2<f64>| {
            let posed = Vector3::new((1.0 - self.compression) * p.x, p.y, 0.0);
            [p.push(0.0), posed]
        };
        patch_driver([self.length, self.width], [columns, ROWS], None, shrink)
    }

    /// The compressed patch, reached in `steps` load steps.
    ///
    /// # Panics
    /// When `driver` is not a patch's.
    pub fn pose(&self, driver: &Driver, steps: u32) -> PoseSpec {
        patch_pose(driver, vec![1.0], steps)
    }
}

/// A pose of a [`patch_driver`], with results at `keys`.
///
/// # Panics
/// When `driver` is not a patch's.
pub fn patch_pose(driver: &Driver, keys: Vec<f64>, steps: u32) -> PoseSpec {
    PoseSpec {
        name: "compress".to_owned(),
        weights: driver
            .weights([("compress", 1.0)])
            .expect("the shape of every patch"),
        keys,
        steps,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }
}

/// A rectangle of this extent (m) in so many squares, with one blend shape: `shape` says where a place
/// of the rectangle, from its middle, is at rest and where in the pose (m). Inner vertices are moved
/// about where there is a seed; the texture covers the rectangle once.
///
/// # Panics
/// When the rectangle has no area.
pub fn patch_driver(
    [length, width]: [f64; 2],
    [columns, rows]: [usize; 2],
    seed: Option<u64>,
    shape: impl Fn(Vector2<f64>) -> [Vector3<f64>; 2],
) -> Arc<Driver> {
    let mut random = seed.map(Pcg64Mcg::seed_from_u64);
    let mut uv = |i: usize, j: usize| {
        let is_inner = (1..rows).contains(&j) && (1..columns).contains(&i);
        let shift = match &mut random {
            Some(random) if is_inner => {
                Vector2::from_fn(|_, _| random.random_range(-UNEVEN..UNEVEN))
            }
            _ => Vector2::zeros(),
        };
        let at = Vector2::new(i as f64, j as f64) + shift;
        Vector2::new(at.x / columns as f64, at.y / rows as f64)
    };
    let corners = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j)));
    let uvs: Vec<_> = corners.map(|(i, j)| uv(i, j)).collect();
    let place = |uv: &Vector2<f64>| Vector2::new((uv.x - 0.5) * length, (uv.y - 0.5) * width);
    let places: Vec<[Vector3<f64>; 2]> = uvs.iter().map(|uv| shape(place(uv))).collect();
    let artist = ArtistMesh {
        name: "patch".to_owned(),
        shapes: vec![BlendShape {
            name: "compress".to_owned(),
            position_deltas: places.iter().map(|[rest, posed]| posed - rest).collect(),
            normal_deltas: None,
        }],
        positions: places.iter().map(|[rest, _]| *rest).collect(),
        normals: None,
        uvs: Some(uvs),
        triangles: triangles([columns, rows]),
    };
    Arc::new(Driver::new(&artist).expect("a rectangle"))
}

/// Squares cut along diagonals that alternate, so that the mesh prefers neither.
fn triangles([columns, rows]: [usize; 2]) -> Vec<[u32; 3]> {
    let vertex = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let square = |i: usize, j: usize| {
        let [a, b] = [vertex(i, j), vertex(i + 1, j)];
        let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    };
    (0..rows)
        .flat_map(|j| (0..columns).flat_map(move |i| square(i, j)))
        .collect()
}
