//! Crease lines in; lines traced over the triangles of a surface, and meshes whose edges follow them, out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`LineInput`] is a line as someone drew it: points in texture space or in space, or vertices along edges.
//! [`skeleton_lines`] finds the middle lines of what is painted in a grey image, and a [`Stroke`] is one of them on a
//! texture layout. A [`LineTracer`] turns each into a [`TracedLine`]: segments inside triangles, addressed by
//! barycentric coordinates, with arc lengths. [`line_crossings`] finds where lines meet and [`check_lines`] what is
//! wrong with them together. A [`LineLaw`] says how stiff and how folded a crease is along its line. [`cut_lines`]
//! gives a mesh edges on the lines, and [`LinePlaces`] finds them again after a remesh. [`valleys`] of a relief and
//! [`NewLines`] are where wrinkles leave lines, and a [`YieldLaw`] says what a crease keeps of its folds.
//!
//! Rounding is by cubic Hermite curves through the points with tangents of Catmull and Rom 1974; the skeleton
//! is that of Pudney 1998. Positions and lengths are in metres, angles in radians.

mod islands;
mod layout_places;
mod line_input;
mod rounding;
mod seam_joints;
mod stroke_pieces;
mod strokes;
mod trace;
mod traced_line;
mod walk;
mod ways;

mod crossings;
mod junctions;
mod line_checks;
mod line_cut;
mod line_law;
mod line_places;
mod memory;
mod new_lines;
mod pixel_graph;
mod skeleton;
mod thinning;
mod valleys;

mod error;
mod warning;

pub use line_input::{Corners, LineInput};
pub use strokes::{RefusedStroke, Stroke, StrokeWidth, TracedStrokes};
pub use trace::LineTracer;
pub use traced_line::{LineSegment, TracedLine};

pub use crossings::{LineCrossing, line_crossings};
pub use line_checks::check_lines;
pub use line_cut::{CreaseEdge, LineCut, LineVertex, MeshPiece, cut_lines};
pub use line_law::{Drive, LARGEST_ANGLE, LineLaw};
pub use line_places::LinePlaces;
pub use memory::{CreaseMemory, Kept, YieldLaw};
pub use new_lines::{FoldedLine, NewLines};
pub use skeleton::{GreyImage, SkeletonLine, SkeletonSettings, skeleton_lines};
pub use valleys::{Relief, Valley, ValleyPoint, valleys};

pub use error::CreaseError;
pub use warning::CreaseWarning;
