//! OBJ meshes and one OBJ per blend shape.

use std::path::Path;

use crate::{IoError, MeshFile, ObjOptions};

pub(crate) fn read_obj(
    path: &Path,
    _mesh_name: Option<&str>,
    _options: &ObjOptions,
) -> Result<MeshFile, IoError> {
    Err(IoError::malformed(path, "file", "not read yet"))
}
