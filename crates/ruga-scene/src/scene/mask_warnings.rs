//! Warnings about masks that may not be what they were meant to be.

use ruga_io::read_mask;
use ruga_material::UvTile;

use crate::file::SceneFile;
use crate::painted_files::{mask_files, tile_files};

/// Warnings about unusual masks of the region and of the layers that can be read.
pub(super) fn mask_warnings(scene: &SceneFile, tiles: &[UvTile]) -> Vec<String> {
    let masks = mask_files(scene).into_iter();
    let files = masks.flat_map(|(key, image)| {
        let files = tile_files(image, tiles).into_iter();
        files.map(move |(_, file)| (key.clone(), file))
    });
    let mut warnings = Vec::new();
    for (key, file) in files {
        // What cannot be read is a problem already, where the mask itself is wanted.
        let Ok(image) = read_mask(&file) else {
            continue;
        };
        let mut warn = |what: String| warnings.push(format!("`{key}`: {}: {what}", file.display()));
        if image.width != image.height {
            let (width, height) = (image.width, image.height);
            warn(format!(
                "the mask is {width} x {height} texels and is stretched over the whole UV square; if it \
                 was painted on a layout of those proportions, save it as a square"
            ));
        }
        if image.had_transparency {
            warn(
                "the mask is transparent in places, which count as black: nothing wrinkles there; \
                 fill them if it should"
                    .to_owned(),
            );
        }
    }
    warnings
}
