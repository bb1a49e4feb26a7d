//! Which line a place lies on, and where along it.

use ruga_mesh::{EdgeId, Id, MaterialPoint, TriMesh};

use crate::walk::{faces_at, place_in};
use crate::{CreaseEdge, TracedLine};

/// Distance from a line, in barycentric coordinates, up to which a place is on it: what interpolation along a
/// segment rounds to, and far less than there is between two lines.
const ON_LINE: f64 = 1e-6;

/// Finds lines at places of the mesh that they were traced over.
///
/// After a remesh that keeps features on their curves this tells which edges are creases of which line, and
/// so how soft and how folded they are.
#[derive(Clone, Debug)]
pub struct LinePlaces<'a> {
    lines: &'a [TracedLine],
    mesh: &'a TriMesh,
    /// Segments in every face: line and number.
    segments: Vec<Vec<(usize, usize)>>,
}

impl<'a> LinePlaces<'a> {
    /// The places of lines over a mesh.
    ///
    /// # Panics
    /// When a line runs over a face that the mesh does not have.
    pub fn new(lines: &'a [TracedLine], mesh: &'a TriMesh) -> Self {
        let mut segments = vec![Vec::new(); mesh.face_count()];
        for (line, traced) in lines.iter().enumerate() {
            for (number, segment) in traced.segments().iter().enumerate() {
                segments[segment.face.index()].push((line, number));
            }
        }
        Self {
            lines,
            mesh,
            segments,
        }
    }

    /// The lines that pass a place, each with the arc length there (m), by line and then along it.
    pub fn passages(&self, place: &MaterialPoint) -> Vec<(usize, f64)> {
        let mut found: Vec<(usize, f64)> = Vec::new();
        for face in faces_at(self.mesh, place) {
            let Some(at) = place_in(self.mesh, place, face) else {
                continue;
            };
            for &(line, number) in &self.segments[face.index()] {
                let segment = &self.lines[line].segments()[number];
                if let Some(share) = on_segment([segment.from, segment.to], at) {
                    found.push((line, segment.start + segment.length * share));
                }
            }
        }
        found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        // Both segments at a joint have found the place.
        found.dedup_by(|b, a| {
            a.0 == b.0 && self.lines[a.0].apart([a.1, b.1]) < ON_LINE * self.lines[a.0].length()
        });
        found
    }

    /// The marked edges of another mesh, whose vertices lie at `points`, that lie on lines; by edge.
    ///
    /// # Panics
    /// When there is not one point per vertex.
    pub fn edges(
        &self,
        mesh: &TriMesh,
        points: &[MaterialPoint],
        is_marked: impl Fn(EdgeId) -> bool,
    ) -> Vec<CreaseEdge> {
        assert_eq!(points.len(), mesh.vertex_count(), "one point per vertex");
        let edges = mesh.edges().iter().filter(|(id, _)| is_marked(*id));
        let found = edges.filter_map(|(edge, ends)| {
            let [a, b] = ends.vertices.map(|v| self.passages(&points[v.index()]));
            let both = a.iter().flat_map(|from| b.iter().map(move |to| (from, to)));
            let same = both.filter(|(from, to)| from.0 == to.0);
            let along = same.map(|(from, to)| (from.0, [from.1, to.1]));
            // A line that passes a vertex twice is followed from the nearer passage.
            let nearest = along.min_by(|a, b| {
                let [a, b] = [a, b].map(|(line, at)| self.lines[*line].apart(*at));
                a.total_cmp(&b)
            });
            nearest.map(|(line, at)| CreaseEdge {
                edge,
                line,
                at: self.unrolled(line, at),
            })
        });
        found.collect()
    }

    /// The ends of an edge on a line, of which one counts on beyond the length of a closed line that closes
    /// between them.
    fn unrolled(&self, line: usize, [from, to]: [f64; 2]) -> [f64; 2] {
        let traced = &self.lines[line];
        let length = traced.length();
        match traced.is_closed() && (to - from).abs() > 0.5 * length {
            true if from < to => [from + length, to],
            true => [from, to + length],
            false => [from, to],
        }
    }
}

/// The share of a segment at a place, if that is on it.
fn on_segment([from, to]: [[f64; 3]; 2], at: [f64; 3]) -> Option<f64> {
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let minus = |u: [f64; 3], v: [f64; 3]| [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    let (along, offset) = (minus(to, from), minus(at, from));
    let share = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
    let off = minus(offset, along.map(|c| c * share));
    off.iter().all(|c| c.abs() < ON_LINE).then_some(share)
}
