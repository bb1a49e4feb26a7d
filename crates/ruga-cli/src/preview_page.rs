//! `preview.html` of an output folder, made of the files in it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use ruga_io::{
    IoError, MapFormat, MapKind, MeshFile, NormalY, ObjOptions, WrinkleMap, Wrinkles, read_bytes,
    read_image, read_mesh, write_atomically,
};
use ruga_material::UvTile;
use ruga_preview::{PackedMap, Preview, PreviewPose};
use ruga_scene::Placement;

use crate::pose_record::Records;
use crate::preview_fault::PreviewFault;

/// Name of the page in the folder.
const PAGE: &str = "preview.html";

/// What stands near the top of every page that ruga makes.
const MARK: &str = "<meta name=\"generator\" content=\"ruga ";

/// Bytes of a page in which the mark stands.
const HEAD: u64 = 2000;

/// Writes the page of a folder, whole or not at all, and returns its path and its bytes; `force` replaces a file
/// of that name that is no page of ours.
///
/// Loops run on the threads of rayon's current pool; their number does not change the page.
///
/// # Errors
/// Any [`PreviewFault`]; an earlier page is left as it is then.
pub(crate) fn write(folder: &Path, force: bool) -> Result<(PathBuf, usize), PreviewFault> {
    let path = folder.join(PAGE);
    if path.exists() && !force && !is_ours(&path) {
        return Err(PreviewFault::InTheWay { path });
    }
    let manifest = manifest_of(folder)?;
    let mesh = mesh_of(folder, &manifest)?;
    let preview = Preview {
        mesh: &mesh.mesh,
        turn: Placement::of(&mesh).turn,
        poses: poses_of(folder, &manifest)?,
    };
    let html = preview.to_html().map_err(|source| PreviewFault::Page {
        folder: folder.to_owned(),
        source,
    })?;
    write_atomically(&path, html.as_bytes())?;
    Ok((path, html.len()))
}

/// Makes the page of a folder that was just baked; returns a warning where there can be none.
///
/// A page of an earlier run is removed then, as it shows other maps.
pub(crate) fn renew(folder: &Path) -> Option<String> {
    let fault = write(folder, false).err()?;
    remove(folder);
    match fault {
        // The scene asks for heights alone.
        PreviewFault::NoMaps { .. } => None,
        fault => Some(format!(
            "{PAGE} was not made, all other results are there: {fault}"
        )),
    }
}

/// Removes a page of an earlier run, which shows other maps.
pub(crate) fn remove(folder: &Path) {
    let path = folder.join(PAGE);
    if is_ours(&path) {
        // One that cannot be removed is out of date; the maps are right.
        let _ = fs::remove_file(&path);
    }
}

fn is_ours(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(MARK)
}

/// The manifest, with normal maps and a mesh.
fn manifest_of(folder: &Path) -> Result<Wrinkles, PreviewFault> {
    let path = folder.join("wrinkles.json");
    if !path.exists() {
        let folder = folder.to_owned();
        return Err(PreviewFault::NotBaked { folder });
    }
    let refuse = |reason: String| PreviewFault::Manifest {
        path: path.clone(),
        reason,
    };
    let manifest: Wrinkles = serde_json::from_slice(&read_bytes(&path)?)
        .map_err(|error| refuse(format!("is no list of wrinkle maps: {error}")))?;
    if manifest.version != Wrinkles::VERSION {
        let (found, known) = (manifest.version, Wrinkles::VERSION);
        return Err(refuse(format!("is version {found}; accepted: {known}")));
    }
    if normal_maps(&manifest).next().is_none() {
        return Err(PreviewFault::NoMaps { path });
    }
    let has_pose = |map: &&WrinkleMap| manifest.poses.contains_key(&map.pose);
    match normal_maps(&manifest).find(|map| !has_pose(map)) {
        Some(map) => Err(refuse(format!(
            "has maps of `{}`, but no such pose",
            map.pose
        ))),
        None => Ok(()),
    }?;
    Ok(manifest)
}

fn normal_maps(manifest: &Wrinkles) -> impl Iterator<Item = &WrinkleMap> {
    let maps = manifest.maps.iter();
    maps.filter(|map| map.kind == MapKind::Normal)
}

/// The mesh of the folder's GLB.
fn mesh_of(folder: &Path, manifest: &Wrinkles) -> Result<MeshFile, PreviewFault> {
    let Some(glb) = &manifest.glb else {
        let path = folder.join("wrinkles.json");
        return Err(PreviewFault::NoMesh { path });
    };
    let path = present(folder.join(&glb.file))?;
    let read = read_mesh(&path, Some(&manifest.mesh), &ObjOptions::default());
    let mesh = match read {
        Err(IoError::UnknownMesh { .. }) => {
            let reason = format!("it has no mesh `{}`", manifest.mesh);
            return Err(PreviewFault::AnotherRun { path, reason });
        }
        other => other?,
    };
    let shapes = || mesh.mesh.shapes.iter().map(|shape| &shape.name);
    for (pose, weights) in &manifest.poses {
        if let Some(absent) = weights.keys().find(|name| !shapes().any(|s| s == *name)) {
            let reason = format!("it has no blend shape `{absent}`, which pose `{pose}` needs");
            return Err(PreviewFault::AnotherRun { path, reason });
        }
    }
    Ok(mesh)
}

/// Poses with their maps, in the order in which the manifest lists them.
fn poses_of(folder: &Path, manifest: &Wrinkles) -> Result<Vec<PreviewPose>, PreviewFault> {
    let mut names: Vec<&String> = Vec::new();
    for map in normal_maps(manifest) {
        if !names.contains(&&map.pose) {
            names.push(&map.pose);
        }
    }
    for name in &names {
        refuse_other_record(folder, manifest, name)?;
    }
    let maps = map_files(folder, manifest)?;
    let packed = maps.par_iter().map(|(map, path, tile)| {
        let packed = packed(path, manifest.size, map)?;
        Ok(match tile {
            Some(tile) => packed.in_square(tile.origin()),
            None => packed,
        })
    });
    // Gathered first: which of several errors is told does not depend on threads.
    let packed: Vec<Result<PackedMap, PreviewFault>> = packed.collect();
    let mut of_pose: BTreeMap<&String, Vec<TileMap>> = BTreeMap::new();
    for ((map, _, tile), packed) in maps.iter().zip(packed) {
        let maps = of_pose.entry(&map.pose).or_default();
        maps.push((map.key, *tile, packed?));
    }
    let pose = |name: &String| {
        let maps = without_neutral_tiles(of_pose.remove(name).unwrap_or_default());
        PreviewPose {
            name: name.clone(),
            weights: manifest.poses.get(name).cloned().unwrap_or_default(),
            maps,
        }
    };
    Ok(names.into_iter().map(pose).collect())
}

/// Entry of the manifest, one of its files, and the UDIM tile of that, where the mesh has some.
type TileFile<'a> = (&'a WrinkleMap, PathBuf, Option<UvTile>);

/// Key, UDIM tile, where the mesh has some, and map.
type TileMap = (f64, Option<UvTile>, PackedMap);

/// The files of all normal maps, each with its UDIM tile, where the mesh has some.
///
/// Files that are gone are found before hours of maps are read, and always the first of them.
fn map_files<'a>(folder: &Path, manifest: &'a Wrinkles) -> Result<Vec<TileFile<'a>>, PreviewFault> {
    let mut files = Vec::new();
    for map in normal_maps(manifest) {
        let tile = |number: &u32| {
            UvTile::from_number(*number).ok_or_else(|| PreviewFault::Manifest {
                path: folder.join("wrinkles.json"),
                reason: format!("has a map of the tile {number}; accepted: 1001 to 9999"),
            })
        };
        // A map without tiles is one file.
        let tiles = map.tiles.iter().map(|number| tile(number).map(Some));
        let mut tiles: Vec<Option<UvTile>> = tiles.collect::<Result<_, _>>()?;
        if tiles.is_empty() {
            tiles.push(None);
        }
        for (file, tile) in map.files().into_iter().zip(tiles) {
            files.push((map, present(folder.join(file))?, tile));
        }
    }
    Ok(files)
}

/// The maps of a pose by key, without those of tiles that are neutral at every key: a body has many tiles, and
/// a pose wrinkles few of them. Those of the first tile stay in any case.
fn without_neutral_tiles(mut maps: Vec<TileMap>) -> Vec<(f64, PackedMap)> {
    let first = maps.first().map(|(_, tile, _)| *tile);
    let of_interest = maps
        .iter()
        .filter(|(_, tile, map)| Some(*tile) == first || !map.is_neutral());
    let wrinkled: BTreeSet<Option<UvTile>> = of_interest.map(|(_, tile, _)| *tile).collect();
    maps.retain(|(_, tile, _)| wrinkled.contains(tile));
    maps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let maps = maps.into_iter();
    maps.map(|(key, _, map)| (key, map)).collect()
}

/// Refuses maps that a later run has written over: the record of their pose lists others than the manifest.
///
/// A folder without records, such as a copy for an engine, is taken as it is.
fn refuse_other_record(folder: &Path, manifest: &Wrinkles, pose: &str) -> Result<(), PreviewFault> {
    let Some(record) = Records::of_bake(folder).read(pose) else {
        return Ok(());
    };
    let listed = manifest.maps.iter().filter(|map| map.pose == pose);
    if listed.eq(record.maps.iter()) {
        return Ok(());
    }
    Err(PreviewFault::AnotherRun {
        path: folder.join(format!("poses/{pose}.json")),
        reason: format!("pose `{pose}` was baked again since, with other maps"),
    })
}

/// A map, read and packed.
fn packed(path: &Path, size: u32, map: &WrinkleMap) -> Result<PackedMap, PreviewFault> {
    let path = path.to_owned();
    let image = read_image(&path)?;
    let (width, height, channels) = (image.width, image.height, image.channels);
    if [width, height] != [size as usize; 2] || channels != 3 {
        let reason = format!(
            "it is {width} x {height} with {channels} {}, not {size} x {size} with 3",
            if channels == 1 { "channel" } else { "channels" }
        );
        return Err(PreviewFault::AnotherRun { path, reason });
    }
    let normals = decoded(image.values, map);
    PackedMap::new(size, &normals).map_err(|source| PreviewFault::Page {
        folder: path,
        source,
    })
}

/// Unit normals of a map's stored values, Y up.
fn decoded(values: Vec<f32>, map: &WrinkleMap) -> Vec<[f32; 3]> {
    // Stored numbers of an EXR are the normals themselves, those of a PNG go from 0 to 1.
    let is_coded = map.format != MapFormat::Exr;
    let up = if map.green == Some(NormalY::Down) {
        -1.0
    } else {
        1.0
    };
    let texels = values.chunks_exact(3).map(|texel| {
        let [x, y, z] = [0, 1, 2].map(|c| match is_coded {
            true => 2.0 * texel[c] - 1.0,
            false => texel[c],
        });
        let length = (x * x + y * y + z * z).sqrt();
        match length > 0.0 {
            true => [x, up * y, z].map(|c| c / length),
            false => [0.0, 0.0, 1.0],
        }
    });
    texels.collect()
}

/// The path, if a file is there.
fn present(path: PathBuf) -> Result<PathBuf, PreviewFault> {
    match path.is_file() {
        true => Ok(path),
        false => Err(PreviewFault::Missing { path }),
    }
}
