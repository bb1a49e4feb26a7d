//! What the end-to-end tests share: strips of film on a soft base, on flat and curved bases.

mod base;
mod film;
mod film_objective;
mod film_rows;
mod film_spec;
mod strip;

pub use base::Base;
pub use film::{Film, Step};
pub use film_spec::{BaseReaction, FilmCoupling, FilmSpec};
pub use strip::{Strip, equilateral, equilateral_tube, unstructured};
