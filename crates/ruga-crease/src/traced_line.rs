//! Crease lines over the triangles of a surface.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, MaterialPoint, TriMesh};

/// A straight part of a line inside one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSegment {
    /// The triangle.
    pub face: FaceId,
    /// Barycentric coordinates of its start.
    pub from: [f64; 3],
    /// Barycentric coordinates of its end.
    pub to: [f64; 3],
    /// Arc length of its start along the line (m).
    pub start: f64,
    /// Its length (m).
    pub length: f64,
}

impl LineSegment {
    /// Place at a fraction of the way.
    pub fn place(&self, fraction: f64) -> MaterialPoint {
        let between = |i: usize| self.from[i] + (self.to[i] - self.from[i]) * fraction;
        MaterialPoint {
            face: self.face,
            barycentric: std::array::from_fn(between),
        }
    }
}

/// A line over the triangles of a surface: segments that follow each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedLine {
    segments: Vec<LineSegment>,
    is_closed: bool,
}

impl TracedLine {
    /// Puts pieces of a line together: triangle, start and end of each. Pieces without length are left out.
    pub(crate) fn new(
        pieces: Vec<(FaceId, [f64; 3], [f64; 3])>,
        is_closed: bool,
        (mesh, positions): (&TriMesh, &[Vector3<f64>]),
    ) -> Self {
        let place =
            |face, barycentric| MaterialPoint { face, barycentric }.interpolate(mesh, positions);
        let mut segments = Vec::with_capacity(pieces.len());
        let mut start = 0.0;
        for (face, from, to) in pieces {
            let length = (place(face, to) - place(face, from)).norm();
            if length > 0.0 {
                segments.push(LineSegment {
                    face,
                    from,
                    to,
                    start,
                    length,
                });
                start += length;
            }
        }
        Self {
            segments,
            is_closed,
        }
    }

    /// The line of these segments, which may leave stretches out.
    pub(crate) fn of_segments(segments: Vec<LineSegment>, is_closed: bool) -> Self {
        Self {
            segments,
            is_closed,
        }
    }

    /// The segments in order.
    pub fn segments(&self) -> &[LineSegment] {
        &self.segments
    }

    /// Whether the line ends where it began.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Arc length (m).
    pub fn length(&self) -> f64 {
        let last = self.segments.last();
        last.map_or(0.0, |segment| segment.start + segment.length)
    }

    /// Length of the line between two places on it (m), of a closed one the shorter way.
    pub fn apart(&self, [from, to]: [f64; 2]) -> f64 {
        let apart = (to - from).abs();
        match self.is_closed {
            true => apart.min(self.length() - apart),
            false => apart,
        }
    }

    /// Place at an arc length (m) from the start, of a closed line around and around; `None` for a line
    /// without segments.
    pub fn place(&self, at: f64) -> Option<MaterialPoint> {
        let at = match self.is_closed {
            true => at.rem_euclid(self.length()),
            false => at,
        };
        let after = self.segments.partition_point(|segment| segment.start <= at);
        let segment = self.segments.get(after.saturating_sub(1))?;
        Some(segment.place(((at - segment.start) / segment.length).clamp(0.0, 1.0)))
    }

    /// Places along the line: the start of every segment, and the end.
    pub fn places(&self) -> Vec<MaterialPoint> {
        let starts = self.segments.iter().map(|segment| segment.place(0.0));
        let end = self.segments.last().map(|segment| segment.place(1.0));
        starts.chain(end).collect()
    }
}
