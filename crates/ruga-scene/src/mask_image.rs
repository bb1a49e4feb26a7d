//! Masks from images.

use std::path::Path;

use ruga_io::{IoError, read_image, read_mask};
use ruga_material::UvTile;
use ruga_stepper::Mask;

use crate::SceneError;
use crate::painted_files::tile_files;
use crate::uv_tiles::are_tiled;

/// The grey image in a file that `key` of a scene names, on a mesh with these tiles.
pub(crate) fn mask(
    file: &Path,
    (scene, key): (&Path, &str),
    tiles: &[UvTile],
) -> Result<Mask, SceneError> {
    let files = tile_files(file, tiles).into_iter();
    let masks = files.map(|(tile, file)| Ok((tile, square_mask(&file, (scene, key))?)));
    let mut masks = masks.collect::<Result<Vec<_>, SceneError>>()?;
    Ok(match are_tiled(tiles) {
        true => Mask::of_tiles(masks),
        false => masks.remove(0).1,
    })
}

/// The red and the green channel of a file that `key` of a scene names, on a mesh with these tiles.
pub(crate) fn channel_masks(
    file: &Path,
    named: (&Path, &str),
    tiles: &[UvTile],
) -> Result<[Mask; 2], SceneError> {
    let files = tile_files(file, tiles).into_iter();
    let pairs = files.map(|(tile, file)| Ok((tile, square_channels(&file, named)?)));
    let mut pairs = pairs.collect::<Result<Vec<_>, SceneError>>()?;
    Ok(match are_tiled(tiles) {
        true => [0, 1].map(|channel| {
            let of_tiles = pairs.iter();
            Mask::of_tiles(of_tiles.map(|(tile, masks)| (*tile, masks[channel].clone())))
        }),
        false => pairs.remove(0).1,
    })
}

/// The grey image in one file, over a unit square.
fn square_mask(file: &Path, named: (&Path, &str)) -> Result<Mask, SceneError> {
    let image = read_mask(file).map_err(|source| unreadable(named, source))?;
    square([image.width, image.height], image.values, named)
}

/// Red and green in one file, over a unit square.
fn square_channels(file: &Path, named: (&Path, &str)) -> Result<[Mask; 2], SceneError> {
    let image = read_image(file).map_err(|source| unreadable(named, source))?;
    if image.channels != 3 {
        let reason =
            "found 1 channel; accepted: red, the part to the right, and green, the part up";
        let source = IoError::malformed(file, "channels", reason);
        return Err(unreadable(named, source));
    }
    let plane = |channel: usize| {
        let values = image.values.iter().skip(channel).step_by(image.channels);
        // Paint programs leave numbers a little beyond the range behind; one that is none has no direction.
        let values = values.map(|value| match value.is_nan() {
            true => 0.5,
            false => value.clamp(0.0, 1.0),
        });
        square([image.width, image.height], values.collect(), named)
    };
    Ok([plane(0)?, plane(1)?])
}

fn unreadable((scene, key): (&Path, &str), source: IoError) -> SceneError {
    SceneError::NamedFile {
        scene: scene.to_owned(),
        key: key.to_owned(),
        source: Box::new(source),
    }
}

fn square(
    sides: [usize; 2],
    values: Vec<f32>,
    (scene, _): (&Path, &str),
) -> Result<Mask, SceneError> {
    let [width, height] = sides.map(|texels| u32::try_from(texels).unwrap_or(u32::MAX));
    let mask = Mask::new(width, height, values);
    mask.map_err(|source| SceneError::Model {
        scene: scene.to_owned(),
        source: Box::new(source),
    })
}
