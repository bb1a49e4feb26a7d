//! Files: glTF and OBJ in, GLB, OBJ, PNG and EXR out, and the scene.

mod atomic_file;
mod error;
mod glb_buffer;
mod glb_write;
mod gltf_accessor;
mod gltf_container;
mod gltf_mesh;
mod gltf_placement;
mod gltf_texcoord;
mod image_read;
mod image_write;
mod mesh_file;
mod obj_frame;
mod obj_mesh;
mod report;
pub mod scene;
mod wrinkles;

pub use atomic_file::{AtomicFile, write_atomically};
pub use error::IoError;
pub use glb_write::{GlbAdditions, write_glb};
pub use image_read::{GreyImage, Image, read_image, read_mask};
pub use image_write::{ExrTexels, PngTexels, write_exr, write_png};
pub use mesh_file::{LengthUnit, Material, MeshFile, MeshPart, ObjOptions, read_mesh};
pub use obj_frame::{ObjFrame, write_obj_frame};
pub use report::{LayerReport, PoseReport, Report, Seconds};
pub use scene::Scene;
pub use wrinkles::{Blend, WrinkleMap, Wrinkles, key_percent, map_file};
