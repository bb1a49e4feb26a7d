//! The image files that a scene names: one over the UV square, or one per UDIM tile of its mesh.

use std::path::{Path, PathBuf};

use ruga_io::{is_udim_pattern, udim_file};
use ruga_material::UvTile;

use crate::file::{self, SceneFile};
use crate::uv_tiles::are_tiled;

/// Files of an image on a mesh with these tiles, each with its tile.
///
/// A pattern stands for those of its files that are there; where none is, for the first one, so that reading
/// it says what is missing. A plain file lies on the first tile.
pub(crate) fn tile_files(image: &Path, tiles: &[UvTile]) -> Vec<(UvTile, PathBuf)> {
    let of_tile = |tile: &UvTile| (*tile, udim_file(image, tile.number()));
    let mut files: Vec<_> = tiles.iter().map(of_tile).collect();
    if !is_udim_pattern(image) {
        files.truncate(1);
        return files;
    }
    let is_there = |(_, file): &&(UvTile, PathBuf)| file.exists();
    let found: Vec<_> = files.iter().filter(is_there).cloned().collect();
    match found.is_empty() {
        true => files.into_iter().take(1).collect(),
        false => found,
    }
}

/// The grey images that decide where skin is simulated, each with its key.
pub(crate) fn mask_files(scene: &SceneFile) -> Vec<(String, &Path)> {
    let region = match &scene.driver.region {
        file::Region::Mask(mask) => Some(("driver.region".to_owned(), mask.as_path())),
        file::Region::Auto | file::Region::All => None,
    };
    let layers = scene.layers.iter().enumerate();
    let layers =
        layers.filter_map(|(i, layer)| Some((format!("layers[{i}].mask"), layer.mask.as_deref()?)));
    region.into_iter().chain(layers).collect()
}

/// Warnings about images that do not cover all tiles of the mesh, with what is done there.
pub(crate) fn warnings(scene: &SceneFile, tiles: &[UvTile]) -> Vec<String> {
    if !are_tiled(tiles) {
        return Vec::new();
    }
    let masks = mask_files(scene).into_iter();
    let masks = masks.map(|(key, image)| {
        (
            key,
            image,
            "nothing is simulated there, as if it were black",
        )
    });
    let layers = scene.layers.iter().enumerate();
    let painted = layers.flat_map(|(i, layer)| {
        let map = layer.map.iter();
        // Without tiles of its own, an image that repeats lies on all of them.
        let images = map.flat_map(|map| {
            let repeats = map.wrap == file::Wrap::Repeat;
            let images = map.named_images();
            images.filter(move |(_, image)| !repeats || is_udim_pattern(image))
        });
        images.map(move |(name, image)| {
            let key = format!("layers[{i}].map.{name}");
            (key, image, "the layer keeps its own values there")
        })
    });
    let growths = scene.growths.iter().enumerate().flat_map(|(i, growth)| {
        let black = "it is black there";
        let image = growth.image.as_deref();
        let image = image.map(|image| (format!("growths[{i}].image"), image, black));
        let direction = growth.direction_image.as_deref();
        let direction = direction.map(|image| {
            let key = format!("growths[{i}].direction_image");
            (key, image, black)
        });
        image.into_iter().chain(direction)
    });
    let burnt = scene.burn.iter().flat_map(|burn| {
        let images = burn.images().into_iter();
        images.map(|(key, image)| (key, image, "it is black there"))
    });
    let all = masks.chain(painted).chain(growths).chain(burnt);
    all.filter_map(|(key, image, meaning)| warning((&key, image), meaning, tiles))
        .collect()
}

fn warning((key, image): (&str, &Path), meaning: &str, tiles: &[UvTile]) -> Option<String> {
    let found = tile_files(image, tiles);
    let has_file = |tile: &UvTile| found.iter().any(|(other, _)| other == tile);
    let missing: Vec<UvTile> = tiles
        .iter()
        .copied()
        .filter(|tile| !has_file(tile))
        .collect();
    let first = *missing.first()?;
    let numbers: Vec<String> = missing
        .iter()
        .map(|tile| tile.number().to_string())
        .collect();
    let numbers = match numbers.as_slice() {
        [one] => format!("tile {one}"),
        several => format!("tiles {}", several.join(", ")),
    };
    Some(match is_udim_pattern(image) {
        true => format!(
            "`{key}`: {}: there is no such file, though the mesh lies in {numbers}, too; {meaning}",
            udim_file(image, first.number()).display()
        ),
        false => format!(
            "`{key}`: {}: is one image, and the mesh has UDIM tiles: it lies on tile {}; in {numbers} \
             {meaning}. Name one image per tile, as `mask.<UDIM>.png`, to paint them",
            image.display(),
            tiles[0].number()
        ),
    })
}
