//! glTF meshes: selection, primitives, morph targets.

use std::path::Path;

use crate::{IoError, MeshFile};

pub(crate) fn read_gltf(path: &Path, _mesh_name: Option<&str>) -> Result<MeshFile, IoError> {
    Err(IoError::malformed(path, "file", "not read yet"))
}
