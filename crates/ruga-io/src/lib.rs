//! Files: glTF and OBJ in, GLB, OBJ, VTU, USD, PNG and EXR out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! [`MeshFile`] is the artist's file: the mesh with its blend shapes, and the document around it, which
//! [`write_glb`] writes back unchanged. [`Image`] is a picture as plain numbers. [`Wrinkles`] says which
//! baked map belongs to which pose; [`Report`] says how the run went. [`IoError`] is for people: it names
//! the file, the element in it, what was found and what is accepted.
//!
//! Formats: glTF 2.0 with `KHR_texture_transform` and `KHR_mesh_quantization`; Wavefront OBJ; PNG
//! without colour-space chunks; OpenEXR of 32-bit floats; JSON; for simulated frames ([`LayerFrame`]) VTK XML
//! and USD as text.
//!
//! Lengths are metres at the size a thing has in the world: OBJ coordinates times
//! [`LengthUnit::metres`], glTF coordinates times the scale of their node. Rotation and translation
//! of nodes are left aside. UVs have V pointing down. Images begin with their top row, and their
//! numbers are never converted between colour spaces.
//!
//! Every writer goes through [`AtomicFile`]: a file appears whole or not at all. No input, however
//! damaged, makes a reader panic or return a number that is not finite.

mod atomic_file;
mod error;
mod glb_buffer;
mod glb_content;
mod glb_frames;
mod glb_moved;
mod glb_write;
mod gltf_accessor;
mod gltf_container;
mod gltf_document;
mod gltf_images;
mod gltf_lines;
mod gltf_mesh;
mod gltf_placement;
mod gltf_shape_names;
mod gltf_texcoord;
mod gltf_uri;
mod gltf_write;
mod image_read;
mod image_write;
mod json_text;
mod layer_frame;
mod line_curves;
mod line_joining;
mod map_kinds;
mod mesh_file;
mod obj_frame;
mod obj_indices;
mod obj_lines;
mod obj_mesh;
mod pack;
mod read_mesh;
mod report;
mod udim;
mod usd_series;
mod vtu;
mod wrinkles;

pub use atomic_file::{AtomicFile, write_atomically};
pub use error::{IoError, read_bytes};
pub use glb_content::GlbAdditions;
pub use glb_moved::MovedMesh;
pub use glb_write::{WrittenGlb, write_glb};
pub use gltf_document::GltfDocument;
pub use image_read::{GreyImage, Image, read_image, read_mask};
pub use image_write::{ExrTexels, PngTexels, write_exr, write_png};
pub use layer_frame::{Field, FieldValues, FrameMesh, LayerFrame};
pub use line_curves::{LineCurve, read_line_curves};
pub use map_kinds::{MapFormat, MapKind};
pub use mesh_file::{LengthUnit, Material, MeshFile, MeshPart, ObjOptions};
pub use obj_frame::{read_obj_positions, write_obj_frame};
pub use pack::{PackManifest, PackedImage, PackedMap, PackedPose};
pub use read_mesh::read_mesh;
pub use report::{CreaseReport, FireReport, LayerReport, MeanAndMost, PoseReport, Report, Seconds};
pub use ruga_bake::{Frame, NormalY};
pub use udim::{is_udim_pattern, udim_file, udim_name, udim_pattern};
pub use usd_series::UsdSeries;
pub use vtu::{write_pvd, write_vtu};
pub use wrinkles::{
    Blend, GlbReference, MapCoordinates, WrinkleMap, Wrinkles, key_percent, map_file,
};
