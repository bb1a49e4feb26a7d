//! What charts are drawn with: logarithmic axes, and vector drawings with their pixels.

mod axis;
mod svg;

pub(crate) use axis::Axis;
pub(crate) use svg::{Anchor, Drawing, Style};
