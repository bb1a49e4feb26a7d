//! The growths of a scene on its layers.

use std::path::Path;

use ruga_material::UvTile;
use ruga_stepper::{Grows, GrowthDirection, GrowthSpec, LayerSpec, PaintedNumber};

use crate::SceneError;
use crate::file::{Growth, SceneFile};
use crate::mask_image::{channel_masks, mask};

/// Adds the growths of a scene to its layers.
///
/// # Errors
/// What is wrong with an image, naming its key.
pub(crate) fn add_growths(
    scene: &SceneFile,
    path: &Path,
    tiles: &[UvTile],
    layers: &mut [LayerSpec],
) -> Result<(), SceneError> {
    for (number, growth) in scene.growths.iter().enumerate() {
        let key = format!("growths[{number}]");
        let spec = spec_of(growth, (path, &key), tiles)?;
        match scene.grown_layer(growth) {
            Some(layer) => layers[layer].growths.push(GrowthSpec {
                grows: scene.grown_ply(growth).map_or(Grows::Layer, Grows::Ply),
                ..spec
            }),
            None => layers.iter_mut().for_each(|layer| {
                layer.growths.push(GrowthSpec {
                    grows: Grows::Below,
                    ..spec.clone()
                });
            }),
        }
    }
    Ok(())
}

/// Warnings of growths that no pose switches on; a scene without poses has one for each.
pub(crate) fn unused_growths(scene: &SceneFile) -> Vec<String> {
    if scene.poses.is_empty() {
        return Vec::new();
    }
    let is_unused = |growth: &&Growth| {
        let mut strengths = scene
            .poses
            .iter()
            .filter_map(|pose| pose.growths.get(&growth.name));
        strengths.all(|strength| *strength == 0.0)
    };
    let unused = scene.growths.iter().filter(is_unused);
    unused
        .map(|growth| {
            let name = &growth.name;
            format!(
                "growth `{name}`: no pose switches it on, so that it changes nothing; add `growths = {{ {name} = 1.0 }}` to one"
            )
        })
        .collect()
}

fn spec_of(
    growth: &Growth,
    (path, key): (&Path, &str),
    tiles: &[UvTile],
) -> Result<GrowthSpec, SceneError> {
    let [along, across] = growth.changes();
    let paint = |image: &Path| -> Result<PaintedNumber, SceneError> {
        Ok(PaintedNumber {
            image: mask(image, (path, &format!("{key}.image")), tiles)?,
            range: growth.range,
        })
    };
    let direction = match &growth.direction_image {
        None => GrowthDirection::Angle(growth.direction.to_radians()),
        Some(image) => direction(image, (path, &format!("{key}.direction_image")), tiles)?,
    };
    Ok(GrowthSpec {
        name: growth.name.clone(),
        grows: Grows::Layer,
        along,
        across,
        curl: growth.curl,
        direction,
        paint: growth.image.as_deref().map(paint).transpose()?,
    })
}

/// The direction in an image of which red is the part to the right and green the part up.
fn direction(
    image: &Path,
    named: (&Path, &str),
    tiles: &[UvTile],
) -> Result<GrowthDirection, SceneError> {
    let [right, up] = channel_masks(
        image,
        named,
        tiles,
        "red, the part to the right, and green, the part up",
    )?;
    Ok(GrowthDirection::Painted { right, up })
}
