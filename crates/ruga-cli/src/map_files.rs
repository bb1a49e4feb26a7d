//! A baked map as the files that the scene asks for.

use std::borrow::Cow;
use std::path::Path;

use ruga_bake::{
    Detail, HEIGHT_MID, NormalY, height_range, height_to_u16, normal_to_png8, normal_to_png16,
};
use ruga_io::{
    ExrTexels, IoError, MapFormat, MapKind, PngTexels, WrinkleMap, write_exr, write_png,
};
use ruga_scene::{Scene, file};

use crate::detail_files::write_detail;
use crate::error::CliError;

/// The maps of one key of a pose, and where its files go.
pub(crate) struct KeyMaps<'a> {
    /// The output folder.
    pub(crate) folder: &'a Path,
    pub(crate) scene: &'a Scene,
    pub(crate) pose: &'a str,
    /// The fraction of the pose.
    pub(crate) key: f64,
    /// Maps of the tiles in which something was baked, at least one; the others are neutral.
    pub(crate) maps: Vec<ruga_bake::WrinkleMap>,
}

impl KeyMaps<'_> {
    /// Writes the maps and returns their entries in the manifest.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub(crate) fn write(&self) -> Result<Vec<WrinkleMap>, CliError> {
        let bake = &self.scene.file.bake;
        let write = |kind: &MapKind| match kind.detail() {
            Some(detail) => write_detail(self, bake, (*kind, detail)),
            None if *kind == MapKind::Height => self.write_heights(bake.format).map(Some),
            None => {
                let entry = WrinkleMap::normal(self.pose, self.key, bake.format, bake.normal_y);
                self.write_tiles(entry, |path, map| write_normals(path, bake, map))
                    .map(Some)
            }
        };
        let written = bake.maps.iter().map(write);
        let written = written.filter_map(Result::transpose);
        Ok(written.collect::<Result<_, _>>()?)
    }

    /// Writes the file of every tile of the mesh with `write`; returns the entry, which names them all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub(crate) fn write_tiles(
        &self,
        entry: WrinkleMap,
        write: impl Fn(&Path, &ruga_bake::WrinkleMap) -> Result<(), IoError>,
    ) -> Result<WrinkleMap, IoError> {
        let tiles = &self.scene.tiles;
        let numbers = tiles.iter().map(|tile| tile.number());
        let numbers: Vec<u32> = numbers.filter(|_| self.scene.is_tiled()).collect();
        let entry = entry.over_tiles(&numbers);
        for (tile, file) in tiles.iter().zip(entry.files()) {
            write(&self.folder.join(file), &self.map(tile.origin()))?;
        }
        Ok(entry)
    }

    /// The map of a square; engines show an error colour where a tile has none, so neutral ones are written,
    /// too.
    fn map(&self, square: [i32; 2]) -> Cow<'_, ruga_bake::WrinkleMap> {
        let found = self.maps.iter().find(|map| map.square == square);
        found.map_or_else(
            || {
                let first = &self.maps[0];
                let details: Vec<Detail> = first.details.iter().map(|map| map.detail).collect();
                let mut neutral = ruga_bake::WrinkleMap::neutral(first.size, square);
                neutral.add_neutral(&details);
                Cow::Owned(neutral)
            },
            Cow::Borrowed,
        )
    }

    /// Heights are 16-bit even beside 8-bit normals: 256 steps of height show as terraces.
    fn write_heights(&self, format: MapFormat) -> Result<WrinkleMap, IoError> {
        if format == MapFormat::Exr {
            let entry = WrinkleMap::height(self.pose, self.key, format, 1.0);
            return self.write_tiles(entry, |path, map| {
                let side = map.size as usize;
                write_exr(path, side, side, ExrTexels::Grey(&map.heights))
            });
        }
        // One scale for all tiles: to an engine they are one image.
        let range = self.maps.iter().map(height_range).fold(0.0, f64::max);
        let entry = WrinkleMap {
            mid: Some(HEIGHT_MID),
            neutral: vec![HEIGHT_MID],
            ..WrinkleMap::height(self.pose, self.key, MapFormat::Png16, range)
        };
        self.write_tiles(entry, |path, map| {
            let side = map.size as usize;
            let texels = height_to_u16(map, range)
                .expect("the range of a map is positive, and finite because its heights are");
            write_png(path, side, side, PngTexels::Grey16(&texels))
        })
    }
}

fn write_normals(
    path: &Path,
    bake: &file::Bake,
    map: &ruga_bake::WrinkleMap,
) -> Result<(), IoError> {
    let side = map.size as usize;
    let green = bake.normal_y;
    match bake.format {
        MapFormat::Png8 => {
            let texels = normal_to_png8(map, green);
            write_png(path, side, side, PngTexels::Rgb8(&texels))
        }
        MapFormat::Png16 => {
            let texels = normal_to_png16(map, green);
            write_png(path, side, side, PngTexels::Rgb16(&texels))
        }
        MapFormat::Exr => {
            let sign = if green == NormalY::Up { 1.0 } else { -1.0 };
            let normals = map.normals.iter();
            let texels: Vec<f32> = normals.flat_map(|[x, y, z]| [*x, sign * y, *z]).collect();
            write_exr(path, side, side, ExrTexels::Rgb(&texels))
        }
    }
}
