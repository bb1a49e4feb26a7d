//! Reasons why a crease line is refused.

use thiserror::Error;

/// A mistake in a crease line, in an image of lines or in what a crease is to be like.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CreaseError {
    /// A line has no two points, or a closed one no three that differ.
    #[error(
        "the line has {count} different point{}; accepted: at least 2, and 3 where it is closed",
        if *count == 1 { "" } else { "s" }
    )]
    TooFewPoints {
        /// Points given, or of a closed line those that differ.
        count: usize,
    },
    /// A point has a coordinate that is infinite or not a number.
    #[error("point {point} of the line has a coordinate that is no finite number")]
    NotFinite {
        /// Number of the point, from 0.
        point: usize,
    },
    /// All points of a line lie on one place.
    #[error(
        "the line has no length: all its points are one place; draw it from one place to another"
    )]
    ZeroLength,
    /// A line is shorter than the mesh that is to fold along it can resolve.
    #[error(
        "line {line} is {:.2} mm long, less than two edges of the mesh, which are {:.2} mm: lengthen it or refine the mesh",
        length * 1e3, edge * 1e3
    )]
    TooShort {
        /// Number of the line.
        line: usize,
        /// Its length (m).
        length: f64,
        /// Length of an edge (m).
        edge: f64,
    },
    /// A line is given in texture coordinates, but the surface has none.
    #[error("the line is drawn in texture coordinates, but the mesh has none")]
    NoTextureCoordinates,
    /// A point lies outside every triangle of the texture layout.
    #[error("near its point {point}, at UV ({}, {}), the line lies in no triangle of the texture layout: move it onto an island; U and V count from the upper left of the texture", short(uv[0]), short(uv[1]))]
    OutsideUv {
        /// Number of the point.
        point: usize,
        /// Its texture coordinates.
        uv: [f64; 2],
    },
    /// A point lies where charts of the texture layout lie on each other.
    #[error("near its point {point}, at UV ({}, {}), the line lies in triangles {} and {}, which overlap in the texture layout: give the line by vertices of the mesh or as a curve in space, or move one of the islands", short(uv[0]), short(uv[1]), faces[0], faces[1])]
    OverlappingCharts {
        /// Number of the point.
        point: usize,
        /// Its texture coordinates.
        uv: [f64; 2],
        /// Two of the triangles.
        faces: [u32; 2],
    },
    /// A line crosses a seam of the texture layout without points on both sides of it.
    #[error(
        "after its point {leg} the line crosses a UV seam at triangle {face}: give a point on the seam in that island, and next the same place in the other"
    )]
    AcrossSeam {
        /// Number of the first of the two points.
        leg: usize,
        /// The triangle before the seam.
        face: u32,
    },
    /// A line runs over the border of the surface.
    #[error(
        "after its point {leg} the line leaves the surface at triangle {face}: keep it on the skin"
    )]
    LeavesSurface {
        /// Number of the first of the two points.
        leg: usize,
        /// The triangle at the border.
        face: u32,
    },
    /// No way along the surface leads from one point to the next.
    #[error(
        "no way along the surface leads from point {leg} of the line to the next: they lie on separate parts, or too far apart; give points between them"
    )]
    NoWay {
        /// Number of the first of the two points.
        leg: usize,
    },
    /// The two points of a line on both sides of a seam are not one place.
    #[error(
        "points {leg} and {} of the line lie on both sides of a UV seam, {:.2} mm from each other on the surface: give the same place of the seam in both islands",
        leg + 1, distance * 1e3
    )]
    ApartOnSeam {
        /// Number of the first of the two points.
        leg: usize,
        /// Their distance (m).
        distance: f64,
    },
    /// A point is too far from the surface.
    #[error(
        "point {point} of the line is {:.2} mm from the surface, more than a reach of {:.2} mm",
        distance * 1e3, reach * 1e3
    )]
    BeyondReach {
        /// Number of the point.
        point: usize,
        /// Its distance (m).
        distance: f64,
        /// Largest distance allowed (m).
        reach: f64,
    },
    /// A vertex of an edge path is not in the mesh.
    #[error("vertex {vertex} of the line is not in the mesh")]
    UnknownVertex {
        /// The vertex.
        vertex: u32,
    },
    /// Two vertices of an edge path have no edge between them.
    #[error("vertices {} and {} of the line share no edge; accepted: a way from neighbour to neighbour along edges of the mesh", vertices[0], vertices[1])]
    NotAnEdge {
        /// The vertices.
        vertices: [u32; 2],
    },
    /// A line runs along the border, where there is nothing to fold against.
    #[error(
        "the line runs along the border of the surface at triangle {face}, where there is nothing to fold against: move it inwards"
    )]
    AlongBorder {
        /// A triangle there.
        face: u32,
    },
    /// A line runs over a triangle without area.
    #[error(
        "the line runs over triangle {face}, which has no area: move the line, or mend the mesh there"
    )]
    DegenerateFace {
        /// The triangle.
        face: u32,
    },
    /// Two lines lie on each other.
    #[error("lines {} and {} lie on each other: leave one out", lines[0], lines[1])]
    IdenticalLines {
        /// Their numbers.
        lines: [usize; 2],
    },
    /// A property of a crease is outside its range.
    #[error("{name} = {value}; accepted: {range}")]
    OutOfRange {
        /// The property.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        range: &'static str,
    },
    /// An image has no texels, or not as many values as its size says.
    #[error("an image of {width} x {height} texels has {values} values")]
    ImageSize {
        /// Texels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        values: usize,
    },
    /// No texel of an image is bright enough, or too few for a line.
    #[error("the image shows no line: {}; paint lines white on black", no_line(*bright, *threshold))]
    NoLineInImage {
        /// Texels that are bright enough.
        bright: usize,
        /// The least brightness of a line.
        threshold: f64,
    },
    /// Most of an image is bright: its middle lines mean nothing.
    #[error("{:.0} % of the image is bright; paint lines as thin white strokes on black", share * 100.0)]
    AllLineInImage {
        /// Share of the texels.
        share: f64,
    },
    /// The skeleton of an image has so many branches that it is noise.
    #[error(
        "the image shows {branches} lines, more than {limit}: it is noise, or no image of lines; paint lines as clean white strokes on black"
    )]
    TooManyBranches {
        /// Branches found.
        branches: usize,
        /// Most that are accepted.
        limit: usize,
    },
}

impl CreaseError {
    /// Number of the point at which, or after which, a line is wrong.
    pub fn point(&self) -> Option<usize> {
        match *self {
            Self::NotFinite { point }
            | Self::OutsideUv { point, .. }
            | Self::OverlappingCharts { point, .. } => Some(point),
            Self::AcrossSeam { leg, .. }
            | Self::LeavesSurface { leg, .. }
            | Self::ApartOnSeam { leg, .. }
            | Self::NoWay { leg } => Some(leg),
            _ => None,
        }
    }
}

/// Why an image shows no line: what is as bright as one may still be no stroke.
fn no_line(bright: usize, threshold: f64) -> String {
    let least = short(threshold * 100.0);
    match bright {
        0 => format!("no texel is as bright as {least} %"),
        1 => format!("only 1 texel is as bright as {least} %, and a line needs several in a row"),
        more => {
            format!("{more} texels are as bright as {least} %, but too few of them in a row")
        }
    }
}

/// A number with four decimals, fewer where they are zero.
fn short(number: f64) -> f64 {
    (number * 1e4).round() / 1e4
}
