//! From a scene to what the stepper simulates.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ruga_blend::{Driver, nearest};
use ruga_io::is_udim_pattern;
use ruga_material::{
    LaminatedSheet, LayerMaterial, MaterialError, PRESETS, Preset, PropertyMap, PropertyPaint,
    SheetPly, Substrate, UvTile, Variation, design_layer, preset, wrinkling,
};
use ruga_stepper::{Dynamics, EdgeLimits, LayerSpec, Modelling, PoseSpec, Presence, Region, Stack};

use crate::SceneError;
use crate::engine_names::collision;
use crate::file::{self, SceneFile};
use crate::mask_image::mask;
use crate::painted_files::tile_files;
use crate::property_images::read_property_images;
use crate::uv_tiles::are_tiled;

/// Weights beyond this look like a slip: shapes are whole at 1, and now and then overdriven a little.
const LARGE_WEIGHT: f64 = 2.0;

/// Error of a share of bending for the lowest layer of a zone, which has none below.
pub(crate) fn bending_without_layer(scene: &SceneFile, path: &Path) -> Option<SceneError> {
    let zones = scene.zones();
    let mut lowest = zones.iter().map(|zone| zone.layers[0]);
    lowest.find_map(|layer| {
        Some(SceneError::NoLayerBelow {
            scene: path.to_owned(),
            layer,
            found: scene.layers[layer].bending_transfer?,
        })
    })
}

/// The layers with their materials and what carries them, in the order of the scene, on a mesh with these
/// tiles.
///
/// # Errors
/// [`SceneError::UnknownPreset`], [`SceneError::Material`] and what a painted map is refused for, naming
/// the key.
pub(crate) fn layers(
    scene: &SceneFile,
    path: &Path,
    tiles: &[UvTile],
) -> Result<Vec<LayerSpec>, SceneError> {
    let mut layers: Vec<LayerSpec> = Vec::new();
    for (index, upper) in scene.layers.iter().enumerate() {
        let lower = (0..index).rfind(|&other| scene.layers[other].zone == upper.zone);
        let below = match lower {
            Some(lower) => Some(layers[lower].material.as_substrate()),
            None if scene.sheet.is_some() => Some(UNUSED),
            None => substrate(scene, path)?,
        };
        layers.push(layer(scene, index, below, (path, tiles))?);
    }
    Ok(layers)
}

/// Substrate in the specification of a free sheet, which lies on nothing: no result depends on it.
const UNUSED: Substrate = Substrate {
    young: 1.0,
    poisson: 0.0,
    thickness: 1.0,
};

/// Difference of wavelengths, as a fraction, from which on a preset is not what it promises.
const OTHER_WAVE: f64 = 0.1;

/// Warnings of presets that lie on another substrate than their own, and so wrinkle otherwise than they
/// promise.
pub(crate) fn preset_warnings(scene: &SceneFile, layers: &[LayerSpec]) -> Vec<String> {
    if scene.substrate.is_none() {
        return Vec::new();
    }
    let lowest: Vec<usize> = scene.zones().iter().map(|zone| zone.layers[0]).collect();
    let preset_of = |index: usize| preset(scene.layers[index].preset.as_deref()?);
    let remedy = match lowest.iter().all(|&index| preset_of(index).is_some()) {
        true => "Leave `[substrate]` out to have its own",
        false => {
            "For the wrinkles it promises, give their `wavelength` and `critical_strain` instead"
        }
    };
    let warning = |&index: &usize| {
        let (preset, spec) = (preset_of(index)?, &layers[index]);
        let own = wrinkling(&preset.layer, &preset.substrate, spec.model).ok()?;
        let here = wrinkling(&spec.material, &spec.substrate, spec.model).ok()?;
        let ratio = here.wavelength / own.wavelength;
        ((ratio - 1.0).abs() > OTHER_WAVE).then(|| {
            format!(
                "layer '{}': preset `{}` promises wrinkles of {:.2} mm from {:.1} % compression, on its own substrate; on yours they are {:.2} mm from {:.1} %. {remedy}",
                spec.name,
                preset.name,
                1e3 * own.wavelength,
                100.0 * own.critical_strain,
                1e3 * here.wavelength,
                100.0 * here.critical_strain
            )
        })
    };
    lowest.iter().filter_map(warning).collect()
}

/// Layer number `index` on what is `below`; only a preset brings its own substrate.
fn layer(
    scene: &SceneFile,
    index: usize,
    below: Option<Substrate>,
    (path, tiles): (&Path, &[UvTile]),
) -> Result<LayerSpec, SceneError> {
    // Reading a scene has refused what these three lines rely on.
    let layer = &scene.layers[index];
    let one_way = "a scene that was read describes each layer in exactly one way";
    let carried = "a scene that was read has a substrate, unless its layer is a preset";
    let key = format!("layers[{index}]");
    let wrong = |source: MaterialError| SceneError::Material {
        scene: path.to_owned(),
        key: key.clone(),
        source,
    };
    let definition = layer.definition().expect(one_way);
    let preset = match definition {
        file::LayerDefinition::Preset(name) => {
            Some(preset_named(name, &format!("{key}.preset"), path)?)
        }
        _ => None,
    };
    let substrate = below
        .or(preset.map(|preset| preset.substrate))
        .expect(carried);
    let (poisson, density) = (layer.poisson, layer.density);
    let with = |young: f64, thickness: f64| LayerMaterial {
        young,
        poisson,
        thickness,
        density,
    };
    let laminate = match definition {
        file::LayerDefinition::Plies(plies) => Some(laminate(layer, plies).map_err(wrong)?),
        _ => None,
    };
    let material = match definition {
        file::LayerDefinition::Elastic { young, thickness } => with(young, thickness),
        file::LayerDefinition::Plies(_) => *laminate.as_ref().expect(one_way).material(),
        file::LayerDefinition::Wanted {
            wavelength,
            critical_strain,
        } => design_layer(wavelength, critical_strain, poisson, density, &substrate)
            .map_err(wrong)?,
        file::LayerDefinition::Preset(_) => {
            let preset = preset.expect(one_way);
            with(preset.layer.young, preset.layer.thickness)
        }
    };
    let map = layer
        .map
        .as_ref()
        .map(|map| property_map(map, (path, &format!("{key}.map")), tiles))
        .transpose()?;
    let spec = LayerSpec {
        laminate,
        model: layer.model,
        coupling: layer.coupling,
        sampling: layer.sampling,
        map: map.map(Arc::new),
        sharp: layer.map.as_ref().is_some_and(|map| map.sharp),
        bending_transfer: layer.bending_transfer,
        presence: presence(scene, index, path, tiles)?,
        ..LayerSpec::new(&layer.name, material, substrate)
    };
    match variation(scene, index, preset) {
        // Layers are uneven each in its own way.
        Some(variation) => spec.uneven(variation, scene.solver.seed.wrapping_add(index as u64)),
        None => wrinkling(&spec.material, &spec.substrate, spec.model).map(|_| spec),
    }
    .map_err(wrong)
}

/// The bonded plies of a layer.
fn laminate(layer: &file::Layer, plies: &[file::Ply]) -> Result<LaminatedSheet, MaterialError> {
    let ply = |ply: &file::Ply| SheetPly {
        young: ply.young,
        thickness: ply.thickness,
        density: ply.density.unwrap_or(layer.density),
    };
    let plies: Vec<SheetPly> = plies.iter().map(ply).collect();
    LaminatedSheet::new(&plies, layer.poisson)
}

/// Unevenness of layer number `index`: as the scene says, or else as its preset is.
///
/// Layers that are solved as one composite or joint pair are even: their stiffness together is known
/// for even layers alone.
fn variation(scene: &SceneFile, index: usize, preset: Option<&Preset>) -> Option<Variation> {
    let layer = &scene.layers[index];
    let of_preset = || {
        let is_alone = scene.stack == Stack::Nominal;
        preset.filter(|_| is_alone)?.variation
    };
    let found = match layer.variation {
        Some(spread) => Some(Variation {
            spread,
            scale: layer.variation_scale,
        }),
        None => of_preset().map(|variation| Variation {
            scale: layer.variation_scale * variation.scale,
            ..variation
        }),
    };
    found.filter(|variation| variation.spread > 0.0)
}

/// Presence of layer number `index`: on its own mask, and in a zone on that of the zone's lowest
/// layer.
fn presence(
    scene: &SceneFile,
    index: usize,
    path: &Path,
    tiles: &[UvTile],
) -> Result<Presence, SceneError> {
    let layer = &scene.layers[index];
    let mask_of = |number: usize| Some((number, scene.layers[number].mask.as_deref()?));
    let lowest = layer.zone.as_ref().and_then(|_| {
        let mut layers = scene.layers.iter();
        layers.position(|other| other.zone == layer.zone)
    });
    let of_zone = lowest.and_then(mask_of);
    let own = mask_of(index).filter(|(_, own)| of_zone.is_none_or(|(_, other)| *own != other));
    let read = |(number, file): (usize, &Path)| {
        mask(file, (path, &format!("layers[{number}].mask")), tiles)
    };
    Ok(Presence {
        masks: of_zone
            .into_iter()
            .chain(own)
            .map(read)
            .collect::<Result<_, _>>()?,
        strength: layer.strength,
    })
}

/// The painted properties of a layer, on a mesh with these tiles.
fn property_map(
    map: &file::PropertyMap,
    (path, key): (&Path, &str),
    tiles: &[UvTile],
) -> Result<PropertyMap, SceneError> {
    let painted = |[wavelength, young, thickness]: [Option<PropertyPaint>; 3]| {
        let found = PropertyMap::painted(wavelength, young, thickness, map.wrap);
        found.map_err(|source| SceneError::Material {
            scene: path.to_owned(),
            key: key.to_owned(),
            source,
        })
    };
    let one_image = |image: &Path| {
        let (_, file) = tile_files(image, tiles).into_iter().next()?;
        Some(file)
    };
    if !are_tiled(tiles) {
        let images = read_property_images(&map.with_images(one_image), path, key)?;
        return painted(
            images
                .by_property()
                .map(|image| image.map(PropertyPaint::Whole)),
        );
    }
    // An image that repeats lies on every tile, and others on those that they have files for.
    let repeats = |image: &Path| map.wrap == file::Wrap::Repeat && !is_udim_pattern(image);
    let everywhere = map.with_images(|image| repeats(image).then(|| image.to_owned()));
    let images = read_property_images(&everywhere, path, key)?;
    let mut paints = images
        .by_property()
        .map(|image| image.map(PropertyPaint::Whole));
    for tile in tiles {
        let own = map.with_images(|image| {
            let mut files = tile_files(image, tiles).into_iter();
            let (_, file) = files.find(|(other, _)| other == tile && !repeats(image))?;
            Some(file)
        });
        let images = read_property_images(&own, path, key)?.by_property();
        for (paint, image) in paints.iter_mut().zip(images) {
            let Some(image) = image else { continue };
            let paint = paint.get_or_insert_with(|| PropertyPaint::Tiles(BTreeMap::new()));
            if let PropertyPaint::Tiles(tiles) = paint {
                tiles.insert(*tile, image);
            }
        }
    }
    painted(paints)
}

fn substrate(scene: &SceneFile, path: &Path) -> Result<Option<Substrate>, SceneError> {
    let Some(substrate) = &scene.substrate else {
        return Ok(None);
    };
    Ok(Some(match substrate.definition() {
        file::SubstrateDefinition::Preset(name) => {
            preset_named(name, "substrate.preset", path)?.substrate
        }
        file::SubstrateDefinition::Elastic(substrate) => substrate,
    }))
}

fn preset_named(name: &str, key: &str, path: &Path) -> Result<&'static Preset, SceneError> {
    let names = || PRESETS.iter().map(|preset| preset.name);
    preset(name).ok_or_else(|| SceneError::UnknownPreset {
        scene: path.to_owned(),
        key: key.to_owned(),
        name: name.to_owned(),
        suggestion: nearest(name, names()),
        listed: names().collect::<Vec<_>>().join(", "),
    })
}

/// The poses to simulate: those `wanted` by name, or all.
///
/// # Errors
/// [`SceneError::UnknownPose`], and scene errors about unknown blend shapes.
pub(crate) fn poses(
    scene: &SceneFile,
    driver: &Driver,
    wanted: &[String],
    path: &Path,
) -> Result<Vec<PoseSpec>, SceneError> {
    let shapes: Vec<String> = driver.shape_names().map(str::to_owned).collect();
    let all = scene.poses_or_shapes(&shapes, path)?;
    refuse_name_collisions(scene, &all, path)?;
    scene.check_memory(&all, path)?;
    let names = || all.iter().map(|pose| pose.name.as_str());
    if let Some(name) = wanted
        .iter()
        .find(|w| !names().any(|name| name == w.as_str()))
    {
        return Err(SceneError::UnknownPose {
            scene: path.to_owned(),
            name: name.clone(),
            suggestion: nearest(name, names()),
            listed: names().collect::<Vec<_>>().join(", "),
        });
    }
    all.iter()
        .filter(|pose| wanted.is_empty() || wanted.contains(&pose.name))
        .map(|pose| pose_spec(pose, driver, path))
        .collect()
}

/// Refuses poses that an engine would know by one name.
fn refuse_name_collisions(
    scene: &SceneFile,
    poses: &[file::Pose],
    path: &Path,
) -> Result<(), SceneError> {
    let Some(names) = scene.pack.as_ref().and_then(|pack| pack.names) else {
        return Ok(());
    };
    let poses: Vec<String> = poses.iter().map(|pose| pose.name.clone()).collect();
    let Some([first, second, name]) = collision(&poses, names) else {
        return Ok(());
    };
    Err(SceneError::Key {
        path: path.to_owned(),
        key: "pack.names".to_owned(),
        line: None,
        reason: format!(
            "poses `{first}` and `{second}` would both be `{name}`; make one pose of them, rename one, or \
             leave `names` out"
        ),
        suggestion: None,
    })
}

fn pose_spec(pose: &file::Pose, driver: &Driver, path: &Path) -> Result<PoseSpec, SceneError> {
    let named = pose.weights.iter().map(|(shape, &w)| (shape.as_str(), w));
    let weights = driver.weights(named).map_err(|source| SceneError::Mesh {
        mesh: path.to_owned(),
        source,
    })?;
    let mut keys = pose.keys.clone();
    keys.sort_by(f64::total_cmp);
    Ok(PoseSpec {
        motions: Vec::new(),
        growths: pose
            .growths
            .iter()
            .map(|(name, s)| (name.clone(), *s))
            .collect(),
        name: pose.name.clone(),
        weights,
        keys,
        steps: pose.steps,
        half: false,
    })
}

/// Warnings about weights so far beyond the whole blend shape that they look mistyped, in the poses
/// of the scene that are worked on.
pub(crate) fn weight_warnings(scene: &SceneFile, poses: &[PoseSpec]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (number, pose) in scene.poses.iter().enumerate() {
        if !poses.iter().any(|spec| spec.name == pose.name) {
            continue;
        }
        let large = pose.weights.iter().filter(|(_, w)| w.abs() > LARGE_WEIGHT);
        // Which weight would do is the plan's to say, which knows how much the skin is strained.
        warnings.extend(large.map(|(shape, &weight)| {
            format!(
                "`poses[{number}].weights.{shape}`: found {weight}; 1 is the whole blend shape, and this goes {} times as far as it was drawn",
                weight.abs()
            )
        }));
    }
    warnings
}

/// The choices that are not physics.
pub(crate) fn modelling(scene: &SceneFile, region: Region, points: Option<f64>) -> Modelling {
    let asked = scene.remesh.points_per_wavelength;
    Modelling {
        region,
        points_per_wavelength: points.unwrap_or(asked),
        remesh: scene.remesh.enabled.then_some(EdgeLimits {
            min_edge: scene.remesh.min_edge,
            max_edge: scene.remesh.max_edge,
            aspect: scene.remesh.aspect,
        }),
        vertex_budget: usize::try_from(scene.driver.vertex_budget).unwrap_or(usize::MAX),
        stack: scene.stack,
        dynamics: match scene.solver.mode {
            file::SolverMode::Static => None,
            file::SolverMode::Dynamic => Some(Dynamics {
                time_step: scene.solver.time_step,
                damping: scene.solver.damping,
            }),
        },
        smoothing: scene.driver.smoothing,
        tolerance: scene.solver.tolerance,
        seed: scene.solver.seed,
        ..Modelling::default()
    }
}
