//! Files: glTF and OBJ in, GLB, OBJ, PNG and EXR out, and the scene.
