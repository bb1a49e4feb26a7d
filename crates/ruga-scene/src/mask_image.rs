//! Masks from images.

use std::path::Path;

use ruga_io::read_mask;
use ruga_stepper::Mask;

use crate::SceneError;

/// The grey image in a file that `key` of a scene names.
pub(crate) fn mask(file: &Path, (scene, key): (&Path, &str)) -> Result<Mask, SceneError> {
    let image = read_mask(file).map_err(|source| SceneError::NamedFile {
        scene: scene.to_owned(),
        key: key.to_owned(),
        source: Box::new(source),
    })?;
    let side = |texels: usize| u32::try_from(texels).unwrap_or(u32::MAX);
    let mask = Mask::new(side(image.width), side(image.height), image.values);
    mask.map_err(|source| SceneError::Model {
        scene: scene.to_owned(),
        source: Box::new(source),
    })
}
