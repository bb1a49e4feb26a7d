//! A film on a soft base against theory: flat, curved, held by rows, choosing its wavelength.

mod constraint;
mod cylinder;
mod selection;
mod strip;
