//! A mesh, its poses and their wrinkle maps go in; a page that shows them comes out, one HTML file that works
//! from disk and offline.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`PackedMap`] is a normal map made small: two channels of 8 bits, and only the part that wrinkles; a mesh
//! with UDIM tiles has one for each. A
//! [`Preview`] has the artist's mesh and [`PreviewPose`]s with their maps; [`Preview::to_html`] writes all of
//! it into one text. There the mesh follows a slider per pose; its normals and tangents are computed anew as
//! the baker does, and the maps are blended in the fragment shader: linear between keys, poses over each other
//! by reoriented normal mapping (Barré-Brisebois and Hill 2012, *Blending in detail*; Li 2014, figure 5-2).
//!
//! A [`PlanPreview`] is the same page before anything is baked: an [`Overlay`] per pose shows on the mesh what a plan
//! says of it, all tiles in one picture as their [`Atlas`] says.
//!
//! Lengths are metres; texture coordinates have V down; X of a normal lies along U, Y up. Nothing here reads
//! or writes files. Same input, any number of threads: the same text out.
//!
//! The page's sources are in `page/`; `page/bundle.js` is made of them and of three.js by `cargo xtask page`.

mod atlas;
mod packed_map;
mod plan_preview;
mod preview;

mod about;
mod error;
mod focus;
mod mesh_data;
mod template;
mod tile_split;

pub use atlas::Atlas;
pub use packed_map::{MAX_SIDE, PackedMap};
pub use plan_preview::{Legend, Overlay, PlanPreview, PlannedPose};
pub use preview::{Preview, PreviewPose};

pub use error::PreviewError;
