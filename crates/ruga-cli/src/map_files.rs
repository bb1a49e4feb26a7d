//! A baked map as the files that the scene asks for.

use std::path::Path;

use ruga_bake::{
    HEIGHT_MID, NormalY, height_range, height_to_u16, normal_to_png8, normal_to_png16,
};
use ruga_io::{
    ExrTexels, IoError, MapFormat, MapKind, PngTexels, WrinkleMap, write_exr, write_png,
};
use ruga_scene::file;

use crate::detail_files::write_detail;
use crate::error::CliError;

/// Writes the maps of one key of a pose and returns their entries in the manifest.
///
/// # Errors
/// [`IoError::Unwritable`].
pub(crate) fn write_maps(
    folder: &Path,
    bake: &file::Bake,
    pose: &str,
    key: f64,
    map: &ruga_bake::WrinkleMap,
) -> Result<Vec<WrinkleMap>, CliError> {
    let write = |kind: &MapKind| match kind.detail() {
        Some(detail) => write_detail(folder, bake, (pose, key), (*kind, detail), map),
        None if *kind == MapKind::Height => {
            write_heights(folder, bake.format, pose, key, map).map(Some)
        }
        None => {
            let entry = WrinkleMap::normal(pose, key, bake.format, bake.normal_y);
            write_normals(&folder.join(&entry.file), bake, map).map(|()| Some(entry))
        }
    };
    let written = bake.maps.iter().map(write);
    let written = written.filter_map(Result::transpose);
    Ok(written.collect::<Result<_, _>>()?)
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

/// Heights are 16-bit even beside 8-bit normals: 256 steps of height show as terraces.
fn write_heights(
    folder: &Path,
    format: MapFormat,
    pose: &str,
    key: f64,
    map: &ruga_bake::WrinkleMap,
) -> Result<WrinkleMap, IoError> {
    let side = map.size as usize;
    if format == MapFormat::Exr {
        let entry = WrinkleMap::height(pose, key, format, 1.0);
        write_exr(
            &folder.join(&entry.file),
            side,
            side,
            ExrTexels::Grey(&map.heights),
        )?;
        return Ok(entry);
    }
    let range = height_range(map);
    let entry = WrinkleMap {
        mid: Some(HEIGHT_MID),
        neutral: vec![HEIGHT_MID],
        ..WrinkleMap::height(pose, key, MapFormat::Png16, range)
    };
    let path = folder.join(&entry.file);
    let texels = height_to_u16(map, range)
        .expect("the range of a map is positive, and finite because its heights are");
    write_png(&path, side, side, PngTexels::Grey16(&texels))?;
    Ok(entry)
}
