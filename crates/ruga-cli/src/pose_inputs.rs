//! What each pose of a scene is made from, as a number that changes when any of it does.

use std::collections::BTreeMap;

use ruga_io::read_bytes;
use ruga_scene::Scene;
use ruga_scene::file::{self, SceneFile};
use ruga_stepper::Region;

use crate::error::CliError;
use crate::fingerprint::Fingerprint;

/// A pose of the scene, whether this run simulates it or not.
#[derive(Clone, Debug)]
pub(crate) struct ScenePose {
    pub(crate) name: String,
    /// Weight of each blend shape.
    pub(crate) weights: BTreeMap<String, f64>,
    /// Strength of each growth.
    pub(crate) growths: BTreeMap<String, f64>,
    /// Time that it takes (s); 1 where nothing moves in time.
    pub(crate) seconds: f64,
    /// Fingerprint of all that its results depend on but how fine the meshes are.
    pub(crate) inputs: Fingerprint,
}

/// Every pose of the scene in its order.
///
/// Comments, the order of the keys in the file and the other poses do not count; nor does the quality,
/// because results of another quality fit beside these.
///
/// # Errors
/// The scene file, a painted map or the mask of a layer has gone.
pub(crate) fn scene_poses(scene: &Scene) -> Result<Vec<ScenePose>, CliError> {
    let shared = shared_inputs(scene)?;
    let shapes: Vec<String> = scene.driver.shape_names().map(str::to_owned).collect();
    let poses = scene.file.poses_or_shapes(&shapes, &scene.path)?;
    let step = scene.modelling.dynamics.map(|moves| moves.time_step);
    let pose = |pose: &file::Pose| ScenePose {
        seconds: step.map_or(1.0, |step| f64::from(pose.steps) * step),
        name: pose.name.clone(),
        weights: pose.weights.clone(),
        growths: pose.growths.clone(),
        inputs: shared.with(format!("{pose:?}").as_bytes()),
    };
    Ok(poses.iter().map(pose).collect())
}

/// Fingerprint of all that every pose depends on: release, scene, mesh, masks and painted maps.
fn shared_inputs(scene: &Scene) -> Result<Fingerprint, CliError> {
    let text = String::from_utf8_lossy(&read_bytes(&scene.path)?).into_owned();
    // Parsed anew, because the scene's own copy has paths that depend on where the command was run.
    let mut file = SceneFile::from_toml(&text, &scene.path)?;
    file.poses.clear();
    // What is packed are the maps as they are.
    file.pack = None;
    // What `ruga age` is to find; a network counts by its lines.
    file.memory = None;
    file.remesh.points_per_wavelength = 0.0;
    let mut hash = Fingerprint::new()
        .with(env!("CARGO_PKG_VERSION").as_bytes())
        .with(file.to_toml().as_bytes())
        .with_mesh(&scene.mesh.mesh)
        .with_numbers(scene.mesh.world_from_node.iter().copied());
    if let Region::Mask(mask) = &scene.modelling.region {
        if let (true, file::Region::Mask(image)) = (scene.is_tiled(), &scene.file.driver.region) {
            // The same picture may have become that of another tile.
            for file in scene.image_files(image) {
                hash = hash.with(file.file_name().unwrap_or_default().as_encoded_bytes());
            }
        }
        for (shape, values) in mask.images() {
            let values = values.iter().map(|&v| f64::from(v));
            hash = hash.with_numbers(shape.into_iter().map(f64::from).chain(values));
        }
    }
    let layers = scene.file.layers.iter();
    let painted = layers.flat_map(|layer| {
        let maps = layer.map.iter().flat_map(|map| map.images());
        maps.chain(layer.mask.as_deref())
    });
    let growths = scene.file.growths.iter();
    let grown = growths.flat_map(|growth| [&growth.image, &growth.direction_image]);
    let grown = grown.filter_map(Option::as_deref);
    let burnt = scene.file.burn.iter().flat_map(|burn| burn.images());
    let burnt = burnt.map(|(_, image)| image);
    for image in painted.chain(grown).chain(burnt) {
        for file in scene.image_files(image) {
            // Which of the tiles a file is of counts, too.
            if scene.is_tiled() {
                let name = file.file_name().unwrap_or_default();
                hash = hash.with(name.as_encoded_bytes());
            }
            hash = hash.with(&read_bytes(&file)?);
        }
    }
    // Where lines lie is in images, in other meshes of the file and in a network, which has what they keep.
    for crease in scene.layers.iter().flat_map(|layer| &layer.creases) {
        for segment in crease.line.segments() {
            let face = f64::from(segment.face.0);
            let ends = segment.from.into_iter().chain(segment.to);
            hash = hash.with_numbers(std::iter::once(face).chain(ends));
        }
        for (share, kept) in crease.memory.samples() {
            hash = hash.with_numbers([*share, kept.angle, kept.softness]);
        }
    }
    Ok(hash)
}
