//! The skin of a layer: its meshes, where they lie on each other, and what it is made of there.

pub(crate) mod boundary_cut;
pub(crate) mod cover;
pub(crate) mod crease_cut;
pub(crate) mod crease_neighbours;
mod facet_address;
pub(crate) mod fading;
pub(crate) mod fans;
mod folds_below;
pub(crate) mod identity;
pub(crate) mod interpolation;
pub(crate) mod local_skin;
mod local_skins;
pub(crate) mod material_places;
pub(crate) mod measure;
pub(crate) mod mirror;
pub(crate) mod parts;
pub(crate) mod piece;
pub(crate) mod place;
pub(crate) mod quiet;
pub(crate) mod refined;
pub(crate) mod relief;
pub(crate) mod skin_mesh;
pub(crate) mod upper_shell;
pub(crate) mod wavelength_field;
