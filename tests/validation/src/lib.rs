//! What judges the product from outside: films on soft bases whose wrinkles are known, skins on
//! meshes from files, references that share no code with the product, the papers' methods, soft
//! bodies, and the plots of what was measured.
//!
//! Tests and programs of this package take minutes to hours: `cargo xtask validate`. The test suite
//! takes what it needs from here for its small cases.

pub mod baselines;
pub mod body;
pub mod canvas;
mod cpu_time;
mod drawing;
mod film_anchor;
mod finding;
mod flat_film;
mod flat_surface;
pub mod light;
mod patch;
pub mod plot;
mod rectangle;
pub mod reference;
mod sheet;
mod skin;
pub mod small_patch;
mod two_scales;

pub use cpu_time::cpu_seconds;
pub use drawing::Drawing;
pub use film_anchor::{Anchor, SOFTER, STIFFER, check_film};
pub use finding::{Finding, table_line};
pub use flat_film::{FilmState, FlatFilm};
pub use flat_surface::{FlatSurface, Lines, baked_lines};
pub use patch::{Patch, patch_driver, patch_pose};
pub use rectangle::Rectangle;
pub use sheet::{FilmCoupling, FilmSpec, Sheet, SheetSpec, Strip, equilateral, upright};
pub use skin::{EveryFrame, Skin, asset, findings, shared_data, skin_layer, tilts};
pub use two_scales::{FineHeights, Profile, TwoScales, Window};
