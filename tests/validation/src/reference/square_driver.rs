//! A square that a blend shape shrinks.

use nalgebra::Vector2;
use ruga_blend::{ArtistMesh, BlendShape, Driver};

/// A flat square about the origin, of a given side (m), with the shape `shrink`, which takes a share
/// of its length in both directions.
///
/// # Panics
/// When the square has no area.
pub fn shrinking_square(side: f64, strain: f64) -> Driver {
    const CELLS: usize = 8;
    let place = |i: usize| Vector2::new((i % (CELLS + 1)) as f64, (i / (CELLS + 1)) as f64);
    let uvs: Vec<_> = (0..(CELLS + 1).pow(2))
        .map(|i| place(i) / CELLS as f64)
        .collect();
    let positions: Vec<_> = uvs
        .iter()
        .map(|uv| (uv.add_scalar(-0.5) * side).push(0.0))
        .collect();
    let cell = |i: usize| {
        let [a, b] = [i / CELLS, i / CELLS + 1].map(|j| (j * (CELLS + 1) + i % CELLS) as u32);
        [[a, a + 1, b], [a + 1, b + 1, b]]
    };
    let artist = ArtistMesh {
        name: "square".to_owned(),
        shapes: vec![BlendShape {
            name: "shrink".to_owned(),
            position_deltas: positions.iter().map(|p| p * -strain).collect(),
            normal_deltas: None,
        }],
        positions,
        uvs: Some(uvs),
        triangles: (0..CELLS * CELLS).flat_map(cell).collect(),
        normals: None,
    };
    Driver::new(&artist).expect("a square")
}
