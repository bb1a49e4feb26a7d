//! Bakes a round bump on a flat square and draws its height map in characters.
//!
//! `cargo run --release -p ruga-bake --example ridge`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::{Vector2, Vector3};
use ruga_bake::{BakeError, BakeSettings, Relief, bake, height_range, tangent_frames};

/// Cells along a side of the layer's mesh.
const CELLS: u32 = 64;

fn main() -> Result<(), BakeError> {
    // The artist's square is two triangles of 10 cm; V points down.
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let square = corners.map(|[x, y]| Vector3::new(0.1 * x, 0.1 * y, 0.0));
    let uv = |p: Vector3<f64>| Vector2::new(10.0 * p.x, 1.0 - 10.0 * p.y);
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let uvs = triangles.map(|triangle: [u32; 3]| triangle.map(|v| uv(square[v as usize])));
    let frames = tangent_frames(&square, &[Vector3::z(); 4], &uvs, &triangles)?;

    let side = CELLS + 1;
    let driver: Vec<Vector3<f64>> = (0..side * side)
        .map(|i| {
            Vector3::new(f64::from(i % side), f64::from(i / side), 0.0) * 0.1 / f64::from(CELLS)
        })
        .collect();
    let bump =
        |p: &Vector3<f64>| 2e-3 * (-((p.x - 0.05).powi(2) + (p.y - 0.03).powi(2)) / 4e-4).exp();
    let layer: Vec<Vector3<f64>> = driver.iter().map(|p| p + Vector3::z() * bump(p)).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    let mut artist = Vec::new();
    for cell in 0..CELLS * CELLS {
        let a = cell / CELLS * side + cell % CELLS;
        let [b, c, d] = [a + 1, a + side + 1, a + side];
        // Cells below the diagonal lie in the first of the artist's triangles.
        let below = cell % CELLS >= cell / CELLS;
        for face in [[a, b, c], [a, c, d]] {
            let lower = below && (face[1] == b || cell % CELLS > cell / CELLS);
            faces.push(face);
            artist.push((
                u32::from(!lower),
                face.map(|v| address(driver[v as usize] * 10.0, lower)),
            ));
        }
    }
    let face_uvs: Vec<_> = faces
        .iter()
        .map(|face| face.map(|v| uv(driver[v as usize])))
        .collect();
    let relief = Relief {
        positions: &layer,
        driver_positions: &driver,
        driver_normals: &vec![Vector3::z(); driver.len()],
        offset: 0.0,
        faces: &faces,
        uvs: &face_uvs,
        artist: &artist,
    };
    let settings = BakeSettings {
        size: 32,
        ..BakeSettings::default()
    };
    let map = bake(&relief, &frames, &settings)?;
    let range = height_range(&map);
    for row in map.heights.chunks(map.size as usize) {
        let shade =
            |height: &f32| b" .:-=+*#%@"[(9.0 * f64::from(*height) / range) as usize] as char;
        println!("{}", row.iter().map(shade).collect::<String>());
    }
    Ok(())
}

/// Barycentric coordinates of a place of the unit square in the artist's lower or upper triangle.
fn address(p: Vector3<f64>, lower: bool) -> [f64; 3] {
    match lower {
        true => [1.0 - p.x, p.x - p.y, p.y],
        false => [1.0 - p.y, p.x, p.y - p.x],
    }
}
