//! A scene file, read, checked and made into a plan that simulates and bakes.
//!
//! [`Scene`] is a `scene.toml` with its mesh and images, converted to what the other crates take;
//! [`SceneFile`] is what stands in the file. [`Scene::plan`] says what will wrinkle and
//! what it costs, [`ScenePlan::simulate`] simulates a pose, [`Scene::bake_key`] bakes its maps.
//! [`Inspection`] finds everything that is wrong with a scene at once. [`SceneError`] is for people: it
//! names the file, the key or element, what was found and what is accepted.
//!
//! Lengths are metres, axes are those of the mesh file; [`Placement`] says where that is in the world.
//! Texture coordinates have V pointing down.
//!
//! From a scene to a map:
//!
//! ```
//! use ruga_scene::Scene;
//! use ruga_stepper::Silent;
//!
//! # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/forearm");
//! # let path = std::path::Path::new(folder).join("scene.toml");
//! let mut scene = Scene::read(&path)?;
//! # scene.file.bake.size = 64;
//! # scene.modelling.points_per_wavelength = 6.0;
//! # scene.poses.truncate(1);
//! let plan = scene.plan()?;
//! for (number, pose) in scene.poses.iter().enumerate() {
//!     let result = plan.simulate(number, &mut Silent)?;
//!     for key in &result.keys {
//!         // One map, as the mesh has no UDIM tiles.
//!         let map = &scene.bake_key(pose, key)?[0];
//!         let steepest = map.normals.iter().map(|[_, _, z]| *z).fold(1.0, f32::min);
//!         assert!(steepest < 0.99, "the skin wrinkles");
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bake;
mod body;
mod crease_checks;
mod crease_lines;
mod crease_presets;
mod creases;
mod details;
mod engine_names;
mod error;
mod fading_memory;
pub mod file;
mod fire;
mod folds;
mod growth_presets;
mod growths;
mod halves;
mod kept_places;
mod mask_image;
pub mod mesh_size;
mod mirror;
mod model;
mod network;
mod network_creases;
mod painted_files;
mod painted_lines;
mod placement;
mod plan;
mod posed_frames;
mod property_images;
mod scene;
mod symmetry;
mod texture_space;
mod uv_tiles;

pub use crease_presets::{CREASE_PRESETS, CreasePreset};
pub use engine_names::engine_name;
pub use error::{SceneError, counted};
pub use file::SceneFile;
pub use folds::{CreaseFolds, LayerFolds, PoseFolds, ValleyFold};
pub use growth_presets::{GROWTH_PRESETS, GrowthPreset};
pub use mirror::{Mirror, SymmetryFault};
pub use network::{CreaseNetwork, KeptCrease, KeptSample};
pub use placement::Placement;
pub use plan::{ScenePlan, ZonePlan};
pub use property_images::{PropertyImages, read_property_images};
pub use scene::{Inspection, Scene, SceneOptions, driver_of};
pub use uv_tiles::are_tiled;
