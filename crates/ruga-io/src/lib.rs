//! Files: glTF and OBJ in, GLB, OBJ, PNG and EXR out, and the scene.
//!
//! [`Scene`] is what the user asks for (`scene.toml`). [`MeshFile`] is the artist's file: the mesh
//! with its blend shapes, and the document around it, which [`write_glb`] writes back unchanged. [`PropertyImages`] are what is
//! painted over a layer. [`Wrinkles`] says which baked map belongs to which pose; [`Report`] says how
//! the run went. [`IoError`] is for people: it names the file, the element in it, what was found and
//! what is accepted.
//!
//! Formats: glTF 2.0 with `KHR_texture_transform` and `KHR_mesh_quantization`; Wavefront OBJ; PNG
//! without colour-space chunks; OpenEXR of 32-bit floats; TOML; JSON.
//!
//! Lengths are metres at the size a thing has in the world: OBJ coordinates times
//! [`LengthUnit::metres`], glTF coordinates times the scale of their node. Rotation and translation
//! of nodes are left aside. UVs have V pointing down. Images begin with their top row, and their
//! numbers are never converted between colour spaces.
//!
//! Every writer goes through [`AtomicFile`]: a file appears whole or not at all. No input, however
//! damaged, makes a reader panic or return a number that is not finite.
//!
//! ```
//! use ruga_io::{Scene, scene::LayerDefinition};
//!
//! let text = r#"
//!     version = 1
//!     driver = { mesh = "face.glb" }
//!     layers = [{ name = "skin", preset = "knuckle", coupling = "hybird" }]
//! "#;
//! let path = "scene.toml".as_ref();
//! let error = Scene::from_toml(text, path).unwrap_err().to_string();
//! assert!(error.contains("layers[0].coupling") && error.contains("did you mean `hybrid`?"));
//! let scene = Scene::from_toml(&text.replace("hybird", "hybrid"), path)?;
//! assert_eq!(scene.layers[0].definition(), Some(LayerDefinition::Preset("knuckle")));
//! assert_eq!(scene.bake.size, 2048);
//! # Ok::<(), ruga_io::IoError>(())
//! ```

mod atomic_file;
mod error;
mod glb_buffer;
mod glb_frames;
mod glb_write;
mod gltf_accessor;
mod gltf_container;
mod gltf_document;
mod gltf_images;
mod gltf_mesh;
mod gltf_placement;
mod gltf_shape_names;
mod gltf_texcoord;
mod gltf_uri;
mod gltf_write;
mod image_read;
mod image_write;
mod json_text;
mod mesh_file;
mod obj_frame;
mod obj_indices;
mod obj_mesh;
mod property_images;
mod report;
pub mod scene;
mod wrinkles;

pub use atomic_file::{AtomicFile, write_atomically};
pub use error::IoError;
pub use glb_write::{GlbAdditions, WrittenGlb, write_glb};
pub use gltf_document::GltfDocument;
pub use image_read::{GreyImage, Image, read_image, read_mask};
pub use image_write::{ExrTexels, PngTexels, write_exr, write_png};
pub use mesh_file::{LengthUnit, Material, MeshFile, MeshPart, ObjOptions, read_mesh};
pub use obj_frame::{ObjFrame, write_obj_frame};
pub use property_images::{PropertyImages, PropertyPlane, read_property_images};
pub use report::{LayerReport, PoseReport, Report, Seconds};
pub use scene::Scene;
pub use wrinkles::{
    Blend, GlbReference, MapCoordinates, WrinkleMap, Wrinkles, key_percent, map_file,
};
