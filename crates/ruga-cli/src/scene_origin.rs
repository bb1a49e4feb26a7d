//! Which scene the results in a folder belong to.

use std::fmt;
use std::path::{Component, Path, PathBuf};

use ruga_scene::Scene;
use serde::{Deserialize, Serialize};

/// Place of the scene file, seen from the folder, and the mesh that is driven.
///
/// Whatever is edited in the scene, it stays the same one; so it does where scene and folder are
/// moved together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SceneOrigin {
    /// The scene file relative to the folder, with `/` between folders.
    pub(crate) scene: String,
    /// Name of the artist's mesh.
    pub(crate) mesh: String,
}

impl SceneOrigin {
    /// Origin of a scene whose results go to `folder`, which exists.
    pub(crate) fn of(scene: &Scene, folder: &Path) -> Self {
        let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        Self {
            scene: relative(&whole(folder), &whole(&scene.path)),
            mesh: scene.mesh.mesh.name.clone(),
        }
    }
}

impl fmt::Display for SceneOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` with mesh `{}`", self.scene, self.mesh)
    }
}

/// The way from one absolute path to another; the second one whole where they share no drive.
fn relative(from: &Path, to: &Path) -> String {
    let shared = from.components().zip(to.components());
    let shared = shared.take_while(|(a, b)| a == b).count();
    let path: PathBuf = match shared {
        0 => to.to_owned(),
        _ => {
            let up = from.components().skip(shared).map(|_| Component::ParentDir);
            up.chain(to.components().skip(shared)).collect()
        }
    };
    path.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_seen_from_a_folder() {
        let seen = |from: &str, to: &str| relative(Path::new(from), Path::new(to));
        assert_eq!(seen("/a/b/out", "/a/b/scene.toml"), "../scene.toml");
        assert_eq!(seen("/a", "/a/b/scene.toml"), "b/scene.toml");
        assert_eq!(seen("/x/out", "/a/scene.toml"), "../../a/scene.toml");
    }
}
