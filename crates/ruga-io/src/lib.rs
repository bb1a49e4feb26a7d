//! Files: glTF and OBJ in, GLB, OBJ, PNG and EXR out, and the scene.

mod atomic_file;
mod error;
mod gltf_mesh;
mod mesh_file;
mod obj_mesh;
mod report;
pub mod scene;
mod wrinkles;

pub use atomic_file::{AtomicFile, write_atomically};
pub use error::IoError;
pub use mesh_file::{LengthUnit, Material, MeshFile, MeshPart, ObjOptions, read_mesh};
pub use report::{LayerReport, PoseReport, Report, Seconds};
pub use scene::Scene;
pub use wrinkles::{Blend, WrinkleMap, Wrinkles, key_percent, map_file};
