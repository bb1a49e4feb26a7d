//! Baker of wrinkle maps: the top layer of a pose and the driver below it in, its normal and height
//! map out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`Relief`] holds the layer's triangles, each inside one UV chart, and the smooth driver at
//! the same material points. [`tangent_frames`] gives the artist's posed mesh its [`TangentFrame`]s
//! (MikkTSpace, glTF's sign). [`bake`] rasterises the triangles in UV, without rays or a cage, and
//! returns a [`WrinkleMap`] of unit normals and heights, which [`normal_to_png16`] and its
//! neighbours turn into the integers of an image. [`bake_detailed`] adds maps of further quantities
//! ([`Detail`]), [`WrinkleMap::paint_burnt`] those of a sheet that burns, and [`bake_squares`] bakes the UDIM tiles
//! of a mesh. Maps of several layers are composed, then padded once ([`WrinkleMap::pad`], or across UV seams
//! [`WrinkleMap::pad_across`]). [`check_uvs`] and
//! [`uv_layout`] say beforehand whether the UVs can carry a map. [`between_keys`] and [`lay_over`] blend
//! normal maps as an engine does at run time.
//!
//! In [`Frame::Driver`] a texel holds the rotation from the normal of the *foot points*
//! `f = x - w n_q` to the normal of the layer `x`, applied to the smooth driver normal, where `w` is
//! the height of the layer above its rest distance and `n_q` the driver's normal below `x`. Both
//! normals come from one local fit with one set of weights, so facets, thickness offset, rest
//! curvature and tangential sliding cancel: where nothing wrinkles the map is neutral. Where the layer overhangs, foot
//! points run backwards, and the driver's normal below takes the place of theirs. In
//! [`Frame::Mesh`] it holds the layer's normal in the artist's frame, as a high-to-low bake does
//! (Mikkelsen 2008, *Simulation of wrinkled surfaces revisited*).
//!
//! Lengths are metres; UVs have V down as in glTF, and green points up. Same input, any number of
//! threads: the same bytes out.

mod artist_details;
mod bake;
mod blend;
mod burnt_details;
mod detail;
mod detail_bake;
mod relief;
mod tangent_frames;
mod wrinkle_map;

mod encode;
mod encoding;
mod uv_check;
mod uv_layout;

mod error;
mod face_adjacency;
mod field_raster;
mod frame;
mod horizon;
mod islands;
mod overlap_sweep;
mod packing;
mod padding;
mod raster;
mod relief_normals;
mod seam_padding;
mod seams;
mod shading;
mod surface_fit;
mod sweep_line;
mod triangle_overlap;

pub use bake::{BakeSettings, MAX_SIZE, bake};
pub use blend::{KeyNormals, between_keys, lay_over};
pub use burnt_details::BurntFields;
pub use detail::{Detail, DetailMap};
pub use detail_bake::{bake_detailed, bake_squares};
pub use frame::Frame;
pub use relief::Relief;
pub use seams::Seams;
pub use tangent_frames::{TangentFrame, tangent_frames, vertex_tangents};
pub use wrinkle_map::{Coverage, WrinkleMap};

pub use encode::{
    HEIGHT_MID, NormalY, height_range, height_to_u16, normal_to_png8, normal_to_png16,
};
pub use encoding::Encoding;
pub use packing::{
    KeyStrength, POSES_PER_MASK, PoseRegion, TooFewMaps, mask_image, pack, share_maps, unpack,
};
pub use uv_check::{MAX_OVERLAPS, UvReport, check_uvs};
pub use uv_layout::{UvLayout, island_boxes, uv_layout};

pub use error::BakeError;
