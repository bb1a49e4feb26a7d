//! The poses of an output folder, packed into a few maps with masks.

use std::fs;
use std::path::{Path, PathBuf};

use ruga_bake::{Encoding, KeyStrength, POSES_PER_MASK, PoseRegion, mask_image, pack, share_maps};
use ruga_io::{
    IoError, MapFormat, MapKind, NormalY, PackManifest, PackedImage, PackedMap, PackedPose,
    PngTexels, WrinkleMap, read_bytes, read_image, udim_name, udim_pattern, write_png,
};
use ruga_scene::{Scene, counted, engine_name, file};

use crate::artist_file::file_name;
use crate::detail_files::write_texels;
use crate::error::CliError;
use crate::messages;
use crate::pose_inputs::ScenePose;
use crate::pose_record::PoseRecord;

/// Folder of packed maps in the output folder.
const FOLDER: &str = "packed";

/// Removes what an earlier packing has left: it is of maps that were there then.
///
/// # Errors
/// A file that cannot be removed.
pub(crate) fn remove_packed(output: &Path) -> Result<(), IoError> {
    let folder = output.join(FOLDER);
    let path = folder.join("pack.json");
    // The manifest goes last: until then it says which images are ours.
    let files = named_files(&path).into_iter().map(|file| folder.join(file));
    for path in files.chain([path.clone()]) {
        match fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                return Err(IoError::Unwritable { path, source });
            }
            _ => {}
        }
    }
    Ok(())
}

/// Packs the finished poses of an output folder, where nothing of an earlier packing is left.
///
/// Everything is known to fit before the first file is written, and `pack.json` comes last: where it
/// is, all that it names is there.
///
/// # Errors
/// [`CliError::TooFewMaps`]; a map cannot be read, or a file not be written.
pub(crate) fn write_packed(
    output: &Path,
    scene: &Scene,
    settings: &file::Pack,
    (records, poses): (&[PoseRecord], &[ScenePose]),
) -> Result<(), CliError> {
    let finished = records.iter().filter(|record| !record.report.interrupted);
    let records: Vec<&PoseRecord> = finished.filter(|r| r.last_key().is_some()).collect();
    let packer = Packer {
        output,
        scene,
        settings,
        plates: plates(output, scene, &records)?,
        records,
    };
    let regions = packer.regions()?;
    let map_of = share_maps(&regions, settings.maps as usize);
    let map_of = map_of.map_err(|source| CliError::TooFewMaps {
        scene: scene.path.clone(),
        poses: packer.names(&source.poses),
        maps: source.maps,
        needed: source.needed,
    })?;
    packer.write(&regions, &map_of, poses)
}

/// A kind of maps as it is packed: one encoding for all poses.
struct Plate {
    kind: MapKind,
    /// Texels per side.
    size: u32,
    format: MapFormat,
    /// Rule for the stored values, 0 to 1, that are compared and packed.
    encoding: Encoding,
    /// Stored value of a texel without wrinkles.
    neutral: Vec<f32>,
    green: Option<NormalY>,
    unit: Option<String>,
}

impl Plate {
    /// The values of a map, in the encoding of the plate; of a mesh with UDIM tiles those of the tile with
    /// this number in the list.
    fn stored(&self, output: &Path, entry: &WrinkleMap, tile: usize) -> Result<Vec<f32>, IoError> {
        let path = output.join(&entry.files()[tile]);
        let image = read_image(&path)?;
        let (size, channels) = (self.size as usize, self.neutral.len());
        if [image.width, image.height, image.channels] != [size, size, channels] {
            return Err(IoError::Malformed {
                path,
                element: "image".to_owned(),
                reason: format!(
                    "is {} x {} with {} channels, not {size} x {size} with {channels} as it was baked; bake its pose again",
                    image.width, image.height, image.channels
                ),
            });
        }
        let mut values = image.values;
        let own = own_encoding(entry);
        if own != self.encoding {
            for value in &mut values {
                let number = own.number(f64::from(*value));
                *value = (self.encoding.mid + number / self.encoding.scale) as f32;
            }
        }
        Ok(values)
    }
}

/// Rule for the values in the file of a map.
fn own_encoding(entry: &WrinkleMap) -> Encoding {
    match (entry.mid, entry.scale) {
        (Some(mid), Some(scale)) => Encoding { mid, scale },
        // A normal map: from 0 to 1 in PNG, from -1 to 1 in EXR.
        _ if entry.format == MapFormat::Exr => Encoding::SHARE,
        _ => Encoding::DIRECTION,
    }
}

/// The plates of the kinds that are of wrinkles alone, which have a neutral value and are it elsewhere.
fn plates(output: &Path, scene: &Scene, records: &[&PoseRecord]) -> Result<Vec<Plate>, IoError> {
    let kinds = scene.file.bake.maps.iter();
    let kinds = kinds.filter(|kind| kind.is_packed());
    let plate = |kind: &MapKind| -> Result<Option<Plate>, IoError> {
        let entries = records.iter().filter_map(|record| record.last_map(*kind));
        let entries: Vec<&WrinkleMap> = entries.collect();
        let Some(first) = entries.first() else {
            return Ok(None);
        };
        let mut encoding = own_encoding(first);
        if first.format == MapFormat::Exr {
            // Numbers as they are: a range is needed to say what a step of 8 bits is.
            let mut most = 1e-6_f64;
            for file in entries.iter().flat_map(|entry| entry.files()) {
                let values = read_image(&output.join(&file))?.values;
                most = most.max(Encoding::holding(&values, 0.0).scale);
            }
            encoding = Encoding::signed(16, most);
        } else if *kind != MapKind::Normal {
            let scales = entries.iter().filter_map(|entry| entry.scale);
            encoding.scale = scales.fold(encoding.scale, f64::max);
        }
        // The codes that a neutral texel has in an image of 8 or 16 bits.
        let codes = if first.format == MapFormat::Png8 {
            255.0
        } else {
            65535.0
        };
        let own = own_encoding(first);
        let stored = |value: &f64| {
            let common = match first.format {
                MapFormat::Exr => encoding.mid + own.number(*value) / encoding.scale,
                MapFormat::Png8 | MapFormat::Png16 => *value,
            };
            ((codes * common).round() / codes) as f32
        };
        Ok(Some(Plate {
            kind: *kind,
            size: scene.file.bake.size,
            format: first.format,
            encoding,
            neutral: first.neutral.iter().map(stored).collect(),
            green: first.green,
            unit: first.unit.clone(),
        }))
    };
    kinds.filter_map(|kind| plate(kind).transpose()).collect()
}

struct Packer<'a> {
    output: &'a Path,
    scene: &'a Scene,
    settings: &'a file::Pack,
    plates: Vec<Plate>,
    records: Vec<&'a PoseRecord>,
}

impl Packer<'_> {
    fn names(&self, poses: &[usize]) -> String {
        let names = poses.iter().map(|&pose| &self.records[pose].report.name);
        let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
        names.join(", ")
    }

    /// The region of every pose in every tile, with its margin.
    fn regions(&self) -> Result<Vec<Vec<PoseRegion>>, IoError> {
        let region = |record: &PoseRecord, tile: usize| {
            let mut region = PoseRegion::new(self.scene.file.bake.size);
            for plate in &self.plates {
                if let Some(entry) = record.last_map(plate.kind) {
                    let is_dithered =
                        plate.kind == MapKind::Normal && plate.format == MapFormat::Png8;
                    let steps = if is_dithered { 1.5 } else { 0.5 };
                    let values = plate.stored(self.output, entry, tile)?;
                    region.add(&values, &plate.neutral, steps);
                }
            }
            Ok(region.with_margin())
        };
        let tiles = 0..self.scene.tiles.len();
        let of_tiles = |record: &&PoseRecord| tiles.clone().map(|t| region(record, t)).collect();
        self.records.iter().map(of_tiles).collect()
    }

    fn write(
        &self,
        regions: &[Vec<PoseRegion>],
        map_of: &[usize],
        poses: &[ScenePose],
    ) -> Result<(), CliError> {
        let folder = self.output.join(FOLDER);
        let path = folder.join("pack.json");
        let mut manifest = PackManifest {
            version: PackManifest::VERSION,
            mesh: self.scene.mesh.mesh.name.clone(),
            size: self.scene.file.bake.size,
            tiles: self.tiles(),
            maps: Vec::new(),
            poses: Default::default(),
        };
        for map in 0..map_of.iter().max().map_or(0, |last| last + 1) {
            let members: Vec<usize> = (0..map_of.len()).filter(|&p| map_of[p] == map).collect();
            manifest.maps.push(PackedMap {
                images: self.write_images(&folder, map, &members, regions)?,
                masks: self.write_masks(&folder, map, &members, regions)?,
            });
            for (place, &member) in members.iter().enumerate() {
                let record = self.records[member];
                let name = &record.report.name;
                let own = poses.iter().find(|pose| pose.name == *name);
                let packed = PackedPose {
                    name: engine_name(name, self.settings.names),
                    map,
                    mask: place / POSES_PER_MASK,
                    channel: ["r", "g", "b", "a"][place % POSES_PER_MASK].to_owned(),
                    curve: self.curve(record)?,
                    weights: own.map_or_else(Default::default, |pose| pose.weights.clone()),
                    growths: own.map_or_else(Default::default, |pose| pose.growths.clone()),
                };
                manifest.poses.insert(name.clone(), packed);
            }
        }
        manifest.write(&path)?;
        messages::note(&format!(
            "{} packed into {}: {}",
            counted(self.records.len(), "pose"),
            counted(manifest.maps.len(), "map"),
            path.display()
        ));
        Ok(())
    }

    fn write_images(
        &self,
        folder: &Path,
        map: usize,
        members: &[usize],
        regions: &[Vec<PoseRegion>],
    ) -> Result<Vec<PackedImage>, IoError> {
        let size = self.scene.file.bake.size;
        let image = |plate: &Plate| {
            let y = plate.green.map(|green| match green {
                NormalY::Up => "gl",
                NormalY::Down => "dx",
            });
            let name = self.file_name(map, plate.kind.word(), y);
            let file = self.pattern(format!("{name}.{}", plate.format.extension()));
            for (tile, path) in self.files(folder, &file).into_iter().enumerate() {
                let packed = self.packed(plate, members, (tile, regions))?;
                write_texels(&path, size, plate.format, Encoding::SHARE, &packed)?;
            }
            let encoding = match plate.format {
                MapFormat::Exr => Encoding::SHARE,
                MapFormat::Png8 | MapFormat::Png16 => plate.encoding,
            };
            let has_numbers = plate.kind != MapKind::Normal;
            Ok(PackedImage {
                kind: plate.kind,
                file,
                format: plate.format,
                green: plate.green,
                unit: plate.unit.clone(),
                mid: has_numbers.then_some(encoding.mid),
                scale: has_numbers.then_some(encoding.scale),
                neutral: self.neutral(plate),
            })
        };
        self.plates.iter().map(image).collect()
    }

    /// The values of one tile of a packed map, as they stand in its file.
    fn packed(
        &self,
        plate: &Plate,
        members: &[usize],
        (tile, regions): (usize, &[Vec<PoseRegion>]),
    ) -> Result<Vec<f32>, IoError> {
        let side = plate.size as usize;
        let mut packed = plate.neutral.repeat(side * side);
        for &member in members {
            if let Some(entry) = self.records[member].last_map(plate.kind) {
                let values = plate.stored(self.output, entry, tile)?;
                let region = &regions[member][tile];
                pack(&mut packed, &values, plate.neutral.len(), region);
            }
        }
        if plate.format == MapFormat::Exr {
            for value in &mut packed {
                *value = plate.encoding.number(f64::from(*value)) as f32;
            }
        }
        Ok(packed)
    }

    /// Numbers of the UDIM tiles; none where the mesh has no tiles.
    fn tiles(&self) -> Vec<u32> {
        let tiles = self.scene.tiles.iter().map(|tile| tile.number());
        tiles.filter(|_| self.scene.is_tiled()).collect()
    }

    /// A file name as the manifest has it: with UDIM tiles one with `<UDIM>` in it.
    fn pattern(&self, file: String) -> String {
        match self.scene.is_tiled() {
            true => udim_pattern(&file),
            false => file,
        }
    }

    /// The files of a name in the manifest, one for each tile.
    fn files(&self, folder: &Path, pattern: &str) -> Vec<PathBuf> {
        let tiles = self.scene.tiles.iter();
        tiles
            .map(|tile| folder.join(udim_name(pattern, tile.number())))
            .collect()
    }

    /// The value of a neutral texel in the file of a plate.
    fn neutral(&self, plate: &Plate) -> Vec<f64> {
        let neutral = plate.neutral.iter().map(|value| f64::from(*value));
        match plate.format {
            MapFormat::Exr => neutral.map(|v| plate.encoding.number(v)).collect(),
            MapFormat::Png8 | MapFormat::Png16 => neutral.collect(),
        }
    }

    fn write_masks(
        &self,
        folder: &Path,
        map: usize,
        members: &[usize],
        regions: &[Vec<PoseRegion>],
    ) -> Result<Vec<String>, IoError> {
        let size = self.scene.file.bake.size;
        let masks = members.chunks(POSES_PER_MASK).enumerate();
        let mask = |(number, four): (usize, &[usize])| {
            let name = self.file_name(map, &format!("mask{}", number + 1), None);
            let file = self.pattern(format!("{name}.png"));
            for (tile, path) in self.files(folder, &file).into_iter().enumerate() {
                let own = four.iter().map(|&pose| &regions[pose][tile]);
                let texels = mask_image(&own.collect::<Vec<_>>(), size);
                let side = size as usize;
                write_png(&path, side, side, PngTexels::Rgba8(&texels))?;
            }
            Ok(file)
        };
        masks.map(mask).collect()
    }

    fn file_name(&self, map: usize, kind: &str, y: Option<&str>) -> String {
        let mesh = file_name(&self.scene.mesh);
        self.settings.file_name(&mesh, map, kind, y)
    }

    /// Strength of the packed map at each key of a pose.
    fn curve(&self, record: &PoseRecord) -> Result<Vec<[f64; 2]>, IoError> {
        let mut curve = vec![[0.0, 0.0]];
        let (Some(plate), Some(last)) = (self.plates.first(), record.last_key()) else {
            return Ok(curve);
        };
        let Some(whole) = record.map(plate.kind, last) else {
            curve.push([last, 1.0]);
            return Ok(curve);
        };
        let keys = || record.keys.iter().copied().filter(|key| *key < last);
        let mut parts: Vec<(f64, &WrinkleMap, KeyStrength)> = keys()
            .filter_map(|key| Some((key, record.map(plate.kind, key)?, KeyStrength::default())))
            .collect();
        for tile in 0..self.scene.tiles.len() {
            let whole = plate.stored(self.output, whole, tile)?;
            for (_, part, strength) in &mut parts {
                let part = plate.stored(self.output, part, tile)?;
                strength.add(&whole, &part, &plate.neutral);
            }
        }
        curve.extend(
            parts
                .iter()
                .map(|(key, _, strength)| [*key, strength.value()]),
        );
        curve.push([last, 1.0]);
        Ok(curve)
    }
}

/// The images that a manifest names, if it is there.
fn named_files(manifest: &Path) -> Vec<String> {
    let text = read_bytes(manifest).ok();
    let found = text.and_then(|text| serde_json::from_slice::<PackManifest>(&text).ok());
    let files = found.into_iter().flat_map(|manifest| {
        let maps = manifest.maps.into_iter();
        let patterns = maps.flat_map(|map| {
            let images = map.images.into_iter().map(|image| image.file);
            images.chain(map.masks)
        });
        let files = patterns.flat_map(|pattern| match manifest.tiles.as_slice() {
            [] => vec![pattern],
            tiles => tiles
                .iter()
                .map(|tile| udim_name(&pattern, *tile))
                .collect(),
        });
        files.collect::<Vec<_>>()
    });
    // A name with a folder in it is none of ours.
    files.filter(|file| !file.contains(['/', '\\'])).collect()
}
