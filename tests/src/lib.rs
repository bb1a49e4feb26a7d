//! What the end-to-end tests share: strips of film on a soft base, on flat and curved bases.

mod film;
mod strip;

pub use film::{Base, Film, FilmCoupling, Step};
pub use strip::{Strip, equilateral, unstructured};
