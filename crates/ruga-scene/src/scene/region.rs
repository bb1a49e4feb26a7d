//! The region of a scene.

use std::path::Path;

use ruga_blend::nearest;
use ruga_io::IoError;
use ruga_material::UvTile;
use ruga_stepper::Region;

use crate::SceneError;
use crate::file::{self, SceneFile};
use crate::mask_image::mask;

/// Region where skin is simulated, its mask read.
pub(super) fn region(
    scene: &SceneFile,
    path: &Path,
    tiles: &[UvTile],
) -> Result<Region, SceneError> {
    Ok(match &scene.driver.region {
        file::Region::Auto => Region::Auto,
        file::Region::All => Region::All,
        file::Region::Mask(file) => {
            let read = mask(file, (path, "driver.region"), tiles);
            Region::Mask(read.map_err(|error| region_error(error, file))?)
        }
    })
}

/// The error of a region mask; of one that is not there, with the other words that a region takes.
fn region_error(error: SceneError, file: &Path) -> SceneError {
    match error {
        SceneError::NamedFile { scene, key, source }
            if matches!(
                *source,
                IoError::Unreadable { .. } | IoError::UnknownFormat { .. }
            ) =>
        {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            SceneError::Key {
                path: scene,
                key,
                line: None,
                reason: format!(
                    "{source}; accepted: \"auto\", \"all\", or the path of a grey image"
                ),
                suggestion: nearest(&name, ["auto", "all"]),
            }
        }
        other => other,
    }
}
