//! Files of the quantities beside normals and heights.

use std::path::Path;

use ruga_bake::{Detail, Encoding};
use ruga_io::{
    ExrTexels, IoError, MapFormat, MapKind, PngTexels, WrinkleMap, write_exr, write_png,
};
use ruga_scene::file;

use crate::map_files::KeyMaps;

/// Smallest range of displacements in a PNG, m: a map without relief needs one, too.
const LEAST_RANGE: f64 = 1e-6;

/// Writes the maps of a detail, if the bake has it, and returns their entry in the manifest.
///
/// # Errors
/// [`IoError::Unwritable`].
pub(crate) fn write_detail(
    baked: &KeyMaps<'_>,
    bake: &file::Bake,
    (kind, detail): (MapKind, Detail),
) -> Result<Option<WrinkleMap>, IoError> {
    let of_maps = || baked.maps.iter().filter_map(|map| map.detail(detail));
    if of_maps().next().is_none() {
        return Ok(None);
    }
    let format = match (bake.format, detail) {
        // Displacements are 16-bit for the reason that heights are, and 256 steps of temperature are 8 K each.
        (MapFormat::Png8, Detail::Displacement | Detail::Temperature) => MapFormat::Png16,
        (format, _) => format,
    };
    let bits = if format == MapFormat::Png8 { 8 } else { 16 };
    let encoding = match detail {
        Detail::Occlusion
        | Detail::Compression
        | Detail::Mask
        | Detail::Char
        | Detail::Ash
        | Detail::Thickness => Encoding::SHARE,
        Detail::ObjectNormal => Encoding::DIRECTION,
        Detail::Curvature => Encoding::signed(bits, 1.0 / bake.curvature_length),
        Detail::Displacement => {
            // One scale for all tiles.
            let holding = of_maps().map(|values| Encoding::holding(values, LEAST_RANGE).scale);
            Encoding::signed(16, holding.fold(0.0, f64::max))
        }
        Detail::Temperature => {
            let hottest = of_maps().flatten().copied().fold(0.0, f32::max);
            Encoding::temperature(f64::from(hottest))
        }
    };
    let entry = WrinkleMap::detail(baked.pose, baked.key, (kind, detail), format, encoding);
    let write = |path: &Path, map: &ruga_bake::WrinkleMap| {
        let values = map.detail(detail).unwrap_or_default();
        write_texels(path, map.size, format, encoding, values)
    };
    baked.write_tiles(entry, write).map(Some)
}

/// Writes numbers of one or three channels as the image of a format.
///
/// # Errors
/// [`IoError::Unwritable`].
pub(crate) fn write_texels(
    path: &Path,
    size: u32,
    format: MapFormat,
    encoding: Encoding,
    values: &[f32],
) -> Result<(), IoError> {
    let side = size as usize;
    let is_grey = values.len() == side * side;
    match format {
        MapFormat::Png8 => {
            let texels = encoding.to_u8(values);
            let texels = match is_grey {
                true => PngTexels::Grey8(&texels),
                false => PngTexels::Rgb8(&texels),
            };
            write_png(path, side, side, texels)
        }
        MapFormat::Png16 => {
            let texels = encoding.to_u16(values);
            let texels = match is_grey {
                true => PngTexels::Grey16(&texels),
                false => PngTexels::Rgb16(&texels),
            };
            write_png(path, side, side, texels)
        }
        MapFormat::Exr => {
            let texels = match is_grey {
                true => ExrTexels::Grey(values),
                false => ExrTexels::Rgb(values),
            };
            write_exr(path, side, side, texels)
        }
    }
}
