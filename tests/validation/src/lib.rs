//! What judges the product from outside: films on soft bases whose wrinkles are known, skins on
//! meshes from files, references that share no code with the product, the papers' methods, soft
//! bodies, and the plots of what was measured.
//!
//! Tests and programs of this package take minutes to hours: `cargo xtask validate`. The test suite
//! takes what it needs from here for its small cases.

mod base;
pub mod baselines;
pub mod body;
mod drawing;
mod film;
mod film_anchor;
mod film_objective;
mod film_probe;
mod film_rows;
mod film_spec;
pub mod light;
mod patch;
pub mod plot;
mod rectangle;
pub mod reference;
mod remeshed_film;
mod skin;
pub mod small_patch;
mod stability;
mod stack_strip;
mod strip;
mod two_scales;

pub use base::Base;
pub use drawing::Drawing;
pub use film::{Film, Noise, Step};
pub use film_anchor::{Anchor, SOFTER, STIFFER, check_film};
pub use film_probe::FlatMode;
pub use film_spec::{BaseReaction, FilmCoupling, FilmSpec};
pub use patch::Patch;
pub use rectangle::Rectangle;
pub use remeshed_film::{Carry, RemeshedFilm, RemeshedSpec, Target, WrinkledState};
pub use skin::{Skin, asset, findings, shared_data, skin_layer, tilts};
pub use stability::{Finding, Sheet, SheetSpec, table_line};
pub use stack_strip::{StackState, StackStrip};
pub use strip::{Strip, equilateral, equilateral_tube, unstructured};
pub use two_scales::{FineHeights, Profile, TwoScales, Window};
