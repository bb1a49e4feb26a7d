//! Masks from images.

use std::path::Path;

use ruga_io::read_mask;
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

/// The grey image in one file, over a unit square.
fn square_mask(file: &Path, (scene, key): (&Path, &str)) -> Result<Mask, SceneError> {
    let image = read_mask(file).map_err(|source| SceneError::NamedFile {
        scene: scene.to_owned(),
        key: key.to_owned(),
        source: Box::new(source),
    })?;
    let side = |texels: usize| u32::try_from(texels).unwrap_or(u32::MAX);
    let mask = Mask::new(side(image.width), side(image.height), image.values);
    mask.map_err(|source| SceneError::Model {
        scene: scene.to_owned(),
        source: Box::new(source),
    })
}
