//! Files of the quantities beside normals and heights.

use std::path::Path;

use ruga_bake::{Detail, Encoding};
use ruga_io::{
    ExrTexels, IoError, MapFormat, MapKind, PngTexels, WrinkleMap, write_exr, write_png,
};
use ruga_scene::file;

/// Smallest range of displacements in a PNG, m: a map without relief needs one, too.
const LEAST_RANGE: f64 = 1e-6;

/// Writes the map of a detail, if the bake has it, and returns its entry in the manifest.
///
/// # Errors
/// [`IoError::Unwritable`].
pub(crate) fn write_detail(
    folder: &Path,
    bake: &file::Bake,
    (pose, key): (&str, f64),
    (kind, detail): (MapKind, Detail),
    map: &ruga_bake::WrinkleMap,
) -> Result<Option<WrinkleMap>, IoError> {
    let Some(values) = map.detail(detail) else {
        return Ok(None);
    };
    let format = match (bake.format, detail) {
        // Displacements are 16-bit for the reason that heights are.
        (MapFormat::Png8, Detail::Displacement) => MapFormat::Png16,
        (format, _) => format,
    };
    let bits = if format == MapFormat::Png8 { 8 } else { 16 };
    let encoding = match detail {
        Detail::Occlusion | Detail::Compression => Encoding::SHARE,
        Detail::ObjectNormal => Encoding::DIRECTION,
        Detail::Curvature => Encoding::signed(bits, 1.0 / bake.curvature_length),
        Detail::Displacement => Encoding::holding(values, LEAST_RANGE),
    };
    let entry = WrinkleMap::detail(pose, key, (kind, detail), format, encoding);
    let path = folder.join(&entry.file);
    write_texels(&path, map.size, format, encoding, values)?;
    Ok(Some(entry))
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
