//! Bakes a round bump on a flat square and draws its height map in characters.
//!
//! `cargo run --release -p ruga-bake --example ridge`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use nalgebra::{Vector2, Vector3};
use ruga_bake::{BakeError, BakeSettings, Relief, bake, height_range, tangent_frames};

/// Cells along a side of the square, which is 10 cm wide.
const CELLS: u32 = 64;

fn main() -> Result<(), BakeError> {
    let side = CELLS + 1;
    let cell = 0.1 / f64::from(CELLS);
    let driver: Vec<Vector3<f64>> = (0..side * side)
        .map(|i| Vector3::new(f64::from(i % side), f64::from(i / side), 0.0) * cell)
        .collect();
    let faces: Vec<[u32; 3]> = (0..CELLS * CELLS)
        .map(|i| i / CELLS * side + i % CELLS)
        .flat_map(|a| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]])
        .collect();
    // V points down.
    let uvs: Vec<Vector2<f64>> = (driver.iter())
        .map(|p| Vector2::new(10.0 * p.x, 1.0 - 10.0 * p.y))
        .collect();
    let normals = vec![Vector3::z(); driver.len()];
    let frames = tangent_frames(&driver, &normals, &uvs, &faces)?;

    let bump = |p: &Vector3<f64>| {
        let squared = (p.x - 0.05).powi(2) + (p.y - 0.03).powi(2);
        2e-3 * (-squared / 4e-4).exp()
    };
    let layer: Vec<Vector3<f64>> = (driver.iter())
        .map(|p| p + Vector3::z() * bump(p))
        .collect();
    // Here the artist's triangles are those of the layer.
    let whole = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let artist: Vec<_> = (0..faces.len() as u32).map(|face| (face, whole)).collect();
    let corner_uvs: Vec<_> = (faces.iter())
        .map(|face| face.map(|v| uvs[v as usize]))
        .collect();
    let relief = Relief {
        positions: &layer,
        driver_positions: &driver,
        driver_normals: &normals,
        offset: 0.0,
        faces: &faces,
        uvs: &corner_uvs,
        artist: &artist,
    };
    let settings = BakeSettings {
        size: 32,
        ..BakeSettings::default()
    };
    let map = bake(&relief, &frames, &settings)?;
    let highest = map.heights.iter().copied().fold(0.0, f32::max);
    let shade = |height: &f32| char::from(b" .:-=+*#%@"[(9.0 * height / highest) as usize]);
    for row in map.heights.chunks(map.size as usize) {
        println!("{}", row.iter().map(shade).collect::<String>());
    }
    println!(
        "heights in a file range over {:.1} mm",
        1e3 * height_range(&map)
    );
    Ok(())
}
