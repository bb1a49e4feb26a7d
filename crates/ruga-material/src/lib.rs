//! Materials of a stiff layer and of what carries it in, wrinkle wavelength and critical strain out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`LayerMaterial`] lies bonded on a [`Substrate`], whose lower face is held. [`wrinkling`]
//! compares bending with the foundation and returns a [`Wrinkling`]: which wave appears, at what
//! compression, and the spring constants that make a shell on a base surface reproduce both.
//! [`design_layer`] inverts it; [`PRESETS`] are nominal skins to start from.
//!
//! A wave of number `k` needs the compressive force `N(k) = D k² + K(k)/k²`, with `D` the bending
//! stiffness of the layer and `K(k)` that of the foundation ([`substrate_stiffness`]). The wave with
//! the smallest force is the one seen. Rémillard and Kry 2013, eq. 3, and Li 2014, eq. 3.1, are
//! limits of this and can be chosen by [`WavelengthModel`].
//!
//! A [`PropertyMap`] is what an artist paints over a layer; [`local_wrinkling`] is [`wrinkling`] at one
//! painted place. A [`VariationField`] makes thickness as uneven as skin's is by nature. A [`StackPair`] is a layer that carries another one: which of the two scales comes
//! first, how they wrinkle together, and, by [`composite_layers`], what single layer stands for both.
//!
//! A straight crease in a film folds before the film wrinkles: [`crease_onset`], [`crease_depth`] and
//! [`crease_profile`] say at what load and how far.
//!
//! A sheet whose plies shrink unequally bends by itself: [`Laminate`] says how much, [`LaminatedSheet`] also where they
//! shrink in directions of their own, and [`ShrinkLaw`] what burning or drying makes of lengths, stiffness and curvature.
//!
//! SI units; lengths in the rest configuration; compressive strain is positive. All is linear film
//! theory, which fades above a critical strain of about 10 % (a modulus ratio below 50).

mod crease;
mod design;
mod error;
mod foundation;
mod laminate;
mod laminated_sheet;
mod material;
mod preset;
mod property_map;
mod relative;
mod sharp_boundary;
mod shrink_law;
mod stack;
mod strain;
mod two_shells;
mod uv_tile;
mod variation;
mod wrinkling;

pub use crease::{
    CreaseLoad, anchor_pull, crease_depth, crease_fold, crease_onset, crease_profile,
};
pub use design::design_layer;
pub use error::MaterialError;
pub use foundation::substrate_stiffness;
pub use laminate::{Laminate, Ply, linear_profile_curvature};
pub use laminated_sheet::{LaminatedSheet, NaturalShape, SheetPly};
pub use material::{LayerMaterial, Substrate};
pub use preset::{PRESETS, Preset, preset};
pub use property_map::{PropertyImage, PropertyMap, PropertyPaint, PropertyRanges, Wrap};
pub use relative::{RelativeProperties, local_wrinkling};
pub use sharp_boundary::{BoundaryCrossing, SHARP_RATIO, sharp_edges};
pub use shrink_law::{FreshSheet, ShrinkLaw, ShrunkSheet};
pub use stack::{CompositeLayer, FirstScale, JointMode, StackLayer, StackPair, composite_layers};
pub use strain::{CAP_START, capped_strain, effective_strain};
pub use uv_tile::UvTile;
pub use variation::{Variation, VariationField};
pub use wrinkling::{WavelengthModel, Wrinkling, wrinkling};
