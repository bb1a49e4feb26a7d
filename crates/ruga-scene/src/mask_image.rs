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

/// The first `N` of the red, the green and the blue channel of a file that `key` of a scene names, on a mesh with
/// these tiles; of a grey image the refusal tells what they mean.
pub(crate) fn channel_masks<const N: usize>(
    file: &Path,
    named: (&Path, &str),
    tiles: &[UvTile],
    meaning: &str,
) -> Result<[Mask; N], SceneError> {
    let files = tile_files(file, tiles).into_iter();
    let pairs = files.map(|(tile, file)| Ok((tile, square_channels(&file, named, meaning)?)));
    let mut pairs = pairs.collect::<Result<Vec<_>, SceneError>>()?;
    Ok(match are_tiled(tiles) {
        true => std::array::from_fn(|channel| {
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

/// Channels in one file, over a unit square.
fn square_channels<const N: usize>(
    file: &Path,
    named: (&Path, &str),
    meaning: &str,
) -> Result<[Mask; N], SceneError> {
    let image = read_image(file).map_err(|source| unreadable(named, source))?;
    if image.channels != 3 {
        let reason = format!("found 1 channel; accepted: {meaning}");
        let source = IoError::malformed(file, "channels", reason);
        return Err(unreadable(named, source));
    }
    let plane = |channel: usize| {
        let values = image.values.iter().skip(channel).step_by(image.channels);
        // Paint programs leave numbers a little beyond the range behind; one that is none becomes middle grey, which
        // is no direction and the middle of a range.
        let values = values.map(|value| match value.is_nan() {
            true => 0.5,
            false => value.clamp(0.0, 1.0),
        });
        square([image.width, image.height], values.collect(), named)
    };
    let planes = (0..N).map(plane).collect::<Result<Vec<_>, _>>()?;
    let planes = <[Mask; N]>::try_from(planes);
    Ok(planes.unwrap_or_else(|_| unreachable!("one mask for each of N channels")))
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
