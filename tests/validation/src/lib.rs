//! What judges the product from outside: films on soft bases whose wrinkles are known, skins on
//! meshes from files, references that share no code with the product, the papers' methods, soft
//! bodies, and the plots of what was measured.
//!
//! Tests and programs of this package take minutes to hours: `cargo xtask validate`. The test suite
//! takes what it needs from here for its small cases.

pub mod baselines;
pub mod body;
pub mod cantilever;
pub mod canvas;
mod cpu_time;
pub mod crease_cost;
pub mod curl_panel;
pub mod curling_strip;
mod drawing;
mod drawn_sheet;
mod film_anchor;
mod finding;
mod flat_film;
mod flat_surface;
pub mod fold_panel;
mod folded_paper;
pub mod hung_cloth;
pub mod light;
mod patch;
pub mod plot;
mod rectangle;
pub mod reference;
pub mod ridge;
mod sheet;
mod skin;
pub mod small_patch;
pub mod spring_sheet;
mod two_scales;
mod unit_film;
pub mod virtual_nodes;

pub use cpu_time::cpu_seconds;
pub use drawing::Drawing;
pub use drawn_sheet::{DrawnSheet, feature_edges};
pub use film_anchor::{Anchor, SOFTER, STIFFER, check_film};
pub use finding::{Finding, table_line};
pub use flat_film::{Cause, FilmState, FlatFilm};
pub use flat_surface::{FlatSurface, Lines, baked_lines};
pub use folded_paper::{FoldedPaper, edges_within};
pub use patch::{Patch, patch_driver, patch_pose};
pub use rectangle::Rectangle;
pub use sheet::{FilmCoupling, FilmSpec, Link, Sheet, SheetSpec, Strip, equilateral, upright};
pub use skin::{EveryFrame, Skin, asset, findings, shared_data, skin_layer, test_scene, tilts};
pub use two_scales::{FineHeights, Profile, TwoScales, Window};
pub use unit_film::{unit_face, unit_film};
