//! Baked normal maps as lit skin, side by side: `cargo xtask picture DIR`.
//!
//! A map holds surface normals in the frame of the flat texture (x right, y up, z towards the
//! eye), so that lighting it shows the flat patch from above. Light is added up in linear units
//! and stored with the sRGB curve.

#![allow(
    clippy::print_stdout,
    reason = "the picture's path is for the person who started this"
)]

use std::error::Error;
use std::path::Path;

use nalgebra::Vector3;
use ruga_io::{Image, PngTexels, map_file, read_image, write_png};
use ruga_io::{MapFormat, MapKind};
use ruga_validation::asset;
use ruga_validation::light::{Light, skin, texel};

/// From left to right; each at its full pose.
const POSES: [&str; 3] = ["compress", "twist", "pinch"];

/// Where the picture goes, below the assets.
const PICTURE: &str = "forearm/wrinkles.png";

/// Side of a pose's square, and the strip between two, pixels.
const SIDE: usize = 392;
const GAP: usize = 12;
const WIDTH: usize = 3 * SIDE + 2 * GAP;

/// Normals seen for one pixel along each axis: maps are about this much finer.
const SAMPLES: usize = 3;

/// Shades the maps of a finished bake of the forearm.
fn main() -> Result<(), Box<dyn Error>> {
    let bake = std::env::args_os().nth(1).ok_or("usage: picture DIR")?;
    let mut pixels = vec![u8::MAX; WIDTH * SIDE * 3];
    for (i, pose) in POSES.iter().enumerate() {
        let file = map_file(pose, 1.0, MapKind::Normal, MapFormat::Png16);
        let map = read_normals(&Path::new(&bake).join(file))?;
        draw(&map, i * (SIDE + GAP), &mut pixels);
    }
    let picture = asset(PICTURE);
    write_png(&picture, WIDTH, SIDE, PngTexels::Rgb8(&pixels))?;
    println!("{}", picture.display());
    Ok(())
}

fn read_normals(path: &Path) -> Result<Image, Box<dyn Error>> {
    let map = read_image(path)?;
    if map.channels != 3 {
        return Err(format!("{}: a grey image, not a normal map", path.display()).into());
    }
    Ok(map)
}

/// Fills the square whose left column is `left`.
fn draw(map: &Image, left: usize, pixels: &mut [u8]) {
    for row in 0..SIDE {
        for column in 0..SIDE {
            let start = 3 * (row * WIDTH + left + column);
            pixels[start..start + 3].copy_from_slice(&pixel(map, row, column));
        }
    }
}

/// The mean light of a pixel's samples; a mean of normals would dull the highlights.
fn pixel(map: &Image, row: usize, column: usize) -> [u8; 3] {
    let mut light = Light::zeros();
    for sample in 0..SAMPLES * SAMPLES {
        let [i, j] = [sample / SAMPLES, sample % SAMPLES];
        let at = |start: usize, k: usize, texels: usize| {
            (start * SAMPLES + k) * texels / (SIDE * SAMPLES)
        };
        light += skin(normal(
            map,
            at(row, i, map.height),
            at(column, j, map.width),
        ));
    }
    texel(light / (SAMPLES * SAMPLES) as f64)
}

fn normal(map: &Image, row: usize, column: usize) -> Vector3<f64> {
    let start = 3 * (row * map.width + column);
    let [x, y, z] = [0, 1, 2].map(|c| 2.0 * f64::from(map.values[start + c]) - 1.0);
    Vector3::new(x, y, z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_shows_the_texels_under_it() {
        let facing = [0.5, 0.5, 1.0];
        let away = [0.9, 0.1, 0.6];
        let map = Image {
            width: 2,
            height: 2,
            channels: 3,
            values: [away, away, facing, away].concat(),
        };
        let bright = |row, column| pixel(&map, row, column)[0];
        assert!(bright(SIDE - 1, 0) > bright(0, 0));
        assert!(bright(SIDE - 1, 0) > bright(SIDE - 1, SIDE - 1));
        assert_eq!(bright(SIDE / 2, 0), bright(SIDE - 1, SIDE / 2 - 1));
    }
}
