//! Crease lines as they are drawn.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{MaterialPoint, VertexId};

/// Treatment of the corners of a polyline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corners {
    /// A smooth curve goes through the points; where the polyline turns by more than 60 degrees it keeps a
    /// corner.
    #[default]
    Round,
    /// The polyline stays as it is.
    Keep,
}

/// A crease line as it was drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum LineInput {
    /// A polyline in texture space.
    Uv {
        /// Texture coordinates. Seams are crossed by a point on the seam in one chart followed by the same
        /// place in the other.
        points: Vec<Vector2<f64>>,
        /// Whether the last point is joined to the first.
        is_closed: bool,
        /// Treatment of its corners.
        corners: Corners,
    },
    /// A polyline in space, projected to the closest places of the surface.
    Positions {
        /// Points (m).
        points: Vec<Vector3<f64>>,
        /// Whether the last point is joined to the first.
        is_closed: bool,
        /// Largest distance of a point from the surface (m), > 0.
        reach: f64,
        /// Treatment of its corners.
        corners: Corners,
    },
    /// Places on the surface, joined by straight ways over it.
    Places {
        /// The places.
        places: Vec<MaterialPoint>,
        /// Whether the last is joined to the first.
        is_closed: bool,
    },
    /// A path along edges of the mesh, closed if it ends where it began.
    Edges {
        /// Vertices in order, neighbours joined by edges.
        vertices: Vec<VertexId>,
    },
}
