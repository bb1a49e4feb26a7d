//! Cuts a mesh along crease lines, so that each is a chain of its edges.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_mesh::{
    Edge, EdgeId, EdgeSplit, FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh, VertexId,
    mean_edge_lengths, split_edges,
};

use crate::crossings::meet_in_face;
use crate::{CreaseWarning, LineSegment, TracedLine};
use moved_vertices::{MovedVertex, move_onto_lines, parts_of};

mod moved_vertices;

/// Distance of a crossing from a vertex that stays where it is, in edges, up to which the line goes through it.
///
/// A vertex beside its line bends the normals there by as much as the distance over an edge: half a degree in a fold of
/// 90. Less than this would leave triangles so thin that texture coordinates on smooth surfaces turn them over.
const SNAP: f64 = 0.01;

/// Distance of a crossing, in edges, up to which the line goes through a vertex that is on it already. Without it the
/// line would leave along one edge of a vertex that another edge has drawn it to, and turn by a right angle.
const SNAP_ON_LINE: f64 = 0.2;

/// Passes: each cuts an edge once, and eight lines may lie across one.
const MOST_PASSES: usize = 10;

/// A mesh whose faces lie in the triangles that lines were traced over.
#[derive(Clone, Debug)]
pub struct MeshPiece {
    /// Connectivity.
    pub mesh: TriMesh,
    /// Where every face lies in which traced triangle.
    pub origins: PerFace<FaceOrigin>,
    /// Positions of the vertices (m): lengths are all that is asked of them.
    pub positions: Vec<Vector3<f64>>,
}

impl MeshPiece {
    /// The mesh that lines were traced over, as it is.
    pub fn whole(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Self {
        let origin = |face| FaceOrigin {
            face,
            corners: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        Self {
            mesh: mesh.clone(),
            origins: mesh.faces().ids().map(origin).collect(),
            positions: positions.to_vec(),
        }
    }
}

/// A vertex of a cut mesh that lies on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// The line.
    pub line: usize,
    /// Arc length along it (m).
    pub at: f64,
    /// The place of the line itself, on the mesh that it was traced over. A vertex that stays where it was, at a corner
    /// of that mesh or at the border, lies up to a hundredth of an edge beside it.
    pub place: MaterialPoint,
}

/// An edge of a cut mesh that lies on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseEdge {
    /// The edge.
    pub edge: EdgeId,
    /// The line.
    pub line: usize,
    /// Arc lengths along it at the edge's two vertices, in its own order (m). Where a closed line closes, the far
    /// end counts on beyond its length: the two are never farther apart than the edge is long.
    pub at: [f64; 2],
}

/// A mesh with edges on lines.
#[derive(Clone, Debug)]
pub struct LineCut {
    /// The cut mesh; its first vertices are those of the piece before, of which some have been moved onto lines.
    pub piece: MeshPiece,
    /// Where every face lies in which face of the piece before, for what else its corners carry.
    pub parts: PerFace<FaceOrigin>,
    /// The vertices on lines, by line and then along it.
    pub vertices: Vec<LineVertex>,
    /// The edges on lines, by line and then along it: each once, and none at the border.
    pub edges: Vec<CreaseEdge>,
    /// Stretches that were not cut, or were cut for two lines.
    pub warnings: Vec<CreaseWarning>,
}

impl LineCut {
    /// Cuts a mesh as [`cut_lines`] does, leaving the vertices of which `is_kept` says so where they are.
    pub fn keeping(
        lines: &[TracedLine],
        piece: MeshPiece,
        is_kept: &dyn Fn(VertexId) -> bool,
    ) -> Self {
        cut_passes(Cutter::new(lines, piece, is_kept))
    }

    /// The `lines` as they lie on the cut mesh: segments along its edges, with arc lengths of the lines
    /// themselves; those of a closed line count from its first vertex here. Stretches without an edge are
    /// left out, and those whose edges an earlier line has.
    pub fn lines(&self, lines: &[TracedLine]) -> Vec<TracedLine> {
        let on_mesh = lines.iter().enumerate().map(|(line, traced)| {
            let own = self.edges.iter().filter(|crease| crease.line == line);
            let first = own.clone().next().filter(|_| traced.is_closed());
            let first = first.map_or(0.0, |crease| crease.at[0].min(crease.at[1]));
            let segments = own.map(|crease| self.segment(crease, first)).collect();
            TracedLine::of_segments(segments, traced.is_closed())
        });
        on_mesh.collect()
    }

    /// The segment along an edge, its arc length counted from `first` (m).
    fn segment(&self, crease: &CreaseEdge, first: f64) -> LineSegment {
        let mesh = &self.piece.mesh;
        let sides = mesh.edge_sides(crease.edge);
        let (face, corner) = sides[0].expect("a crease has a face to its left");
        let ends = [corner, (corner + 1) % 3]
            .map(|corner| MaterialPoint::at_corner(face, corner).barycentric);
        let [a, b] = crease.at;
        let is_along =
            (mesh.faces()[face][corner] == mesh.edges()[crease.edge].vertices[0]) == (a < b);
        let [from, to] = if is_along { ends } else { [ends[1], ends[0]] };
        LineSegment {
            face,
            from,
            to,
            start: a.min(b) - first,
            length: (b - a).abs(),
        }
    }
}

/// Gives a mesh edges along lines.
///
/// Vertices within a quarter of an edge of a line are moved onto it first, inside the triangles that they were traced
/// over and along their edges. Then every edge that a line crosses gets a vertex there, and the faces around it
/// are split. Where a line passes a vertex that cannot move within a hundredth of an edge, it goes through it. A
/// line that ends inside a face ends at the last edge or vertex before. Between the vertices on it a line is
/// straight: what it does inside a face becomes a chord.
pub fn cut_lines(lines: &[TracedLine], piece: MeshPiece) -> LineCut {
    LineCut::keeping(lines, piece, &|_| false)
}

/// Snaps and cuts until no line crosses an edge any more.
fn cut_passes(mut cutter: Cutter<'_>) -> LineCut {
    for _ in 0..MOST_PASSES {
        let crossings = cutter.crossings();
        // Before any edge is cut, or one would be cut beside a vertex that the line goes through.
        cutter.snap(&crossings);
        let places = cutter.places(&crossings);
        if places.iter().all(Option::is_none) {
            break;
        }
        cutter.cut(&places);
    }
    cutter.finish()
}

/// Where a line crosses an edge.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Fraction of the way from the edge's first vertex.
    fraction: f64,
    line: usize,
    at: f64,
}

/// Place of a vertex on a line.
#[derive(Clone, Copy, Debug)]
struct OnLine {
    line: usize,
    at: f64,
    /// How far beside it, in edges.
    off: f64,
}

struct Cutter<'a> {
    lines: &'a [TracedLine],
    piece: MeshPiece,
    parts: PerFace<FaceOrigin>,
    /// Segments in every traced triangle: line and number.
    segments: Vec<Vec<(u32, u32)>>,
    /// Mean length of the uncut edges around every vertex (m).
    sizes: Vec<f64>,
    on_line: Vec<Vec<OnLine>>,
    /// Faces that the last pass made.
    is_new: Vec<bool>,
}

impl<'a> Cutter<'a> {
    fn new(
        lines: &'a [TracedLine],
        mut piece: MeshPiece,
        is_kept: &dyn Fn(VertexId) -> bool,
    ) -> Self {
        let mut segments: Vec<Vec<(u32, u32)>> = Vec::new();
        for (line, traced) in (0..).zip(lines) {
            for (number, segment) in (0..).zip(traced.segments()) {
                let face = segment.face.index();
                if segments.len() <= face {
                    segments.resize(face + 1, Vec::new());
                }
                segments[face].push((line, number));
            }
        }
        let sizes = mean_edge_lengths(&piece.mesh, &piece.positions);
        let before = piece.origins.clone();
        let moved = move_onto_lines((lines, &segments), &mut piece, &sizes, is_kept);
        let mut on_line = vec![Vec::new(); piece.positions.len()];
        for MovedVertex { vertex, line, at } in moved {
            on_line[vertex].push(OnLine { line, at, off: 0.0 });
        }
        Self {
            lines,
            segments,
            sizes,
            on_line,
            is_new: vec![true; piece.mesh.face_count()],
            parts: parts_of(&before, &piece.origins),
            piece,
        }
    }

    /// Where lines cross every edge beside a new face.
    fn crossings(&self) -> Vec<Vec<Crossing>> {
        let edges = self.piece.mesh.edges().iter();
        let crossings = edges.map(|(id, edge)| {
            let mut found: Vec<Crossing> = Vec::new();
            for &face in edge.faces.iter().flatten() {
                if self.is_new[face.index()] {
                    self.add_crossings(face, id, edge, &mut found);
                }
            }
            found
        });
        crossings.collect()
    }

    fn add_crossings(&self, face: FaceId, id: EdgeId, edge: &Edge, found: &mut Vec<Crossing>) {
        let origin = &self.piece.origins[face];
        let Some(segments) = self
            .segments
            .get(origin.face.index())
            .filter(|all| !all.is_empty())
        else {
            return;
        };
        let mesh = &self.piece.mesh;
        let corner = mesh.face_edges(face).iter().position(|&e| e == id);
        let corner = corner.expect("a face has the edges that have the face");
        let [mut from, mut to] = [corner, (corner + 1) % 3].map(|at| origin.corners[at]);
        if mesh.faces()[face][corner] != edge.vertices[0] {
            std::mem::swap(&mut from, &mut to);
        }
        for &(line, number) in segments {
            let segment = &self.lines[line as usize].segments()[number as usize];
            let Some([fraction, share]) = meet_in_face([[from, to], [segment.from, segment.to]])
            else {
                continue;
            };
            let crossing = Crossing {
                fraction: fraction.clamp(0.0, 1.0),
                line: line as usize,
                at: segment.start + segment.length * share.clamp(0.0, 1.0),
            };
            // Both sides of an edge, and both segments at a joint on it, find the same crossing.
            let is_known = |other: &Crossing| {
                other.line == crossing.line && (other.fraction - crossing.fraction).abs() < 1e-6
            };
            if !found.iter().any(is_known) {
                found.push(crossing);
            }
        }
    }

    /// Distances of a crossing from both ends of its edge, in edges of the uncut mesh.
    fn distances(&self, edge: &Edge, crossing: &Crossing) -> [f64; 2] {
        let [a, b] = edge.vertices.map(Id::index);
        let length = (self.piece.positions[b] - self.piece.positions[a]).norm();
        // Measured by a pass's own shorter edges, every pass would make smaller faces than the one before.
        [
            crossing.fraction * length / self.sizes[a],
            (1.0 - crossing.fraction) * length / self.sizes[b],
        ]
    }

    /// Lets lines that pass a vertex closely go through it.
    fn snap(&mut self, crossings: &[Vec<Crossing>]) {
        let Self { piece, .. } = &*self;
        let mut snapped = Vec::new();
        for (edge, found) in piece.mesh.edges().as_slice().iter().zip(crossings) {
            for crossing in found {
                for (v, off) in edge
                    .vertices
                    .into_iter()
                    .zip(self.distances(edge, crossing))
                {
                    if off < SNAP {
                        let Crossing { line, at, .. } = *crossing;
                        snapped.push((v.index(), OnLine { line, at, off }));
                    }
                }
            }
        }
        for (v, on) in snapped {
            match self.beside(v, on.line, on.at) {
                None => self.on_line[v].push(on),
                Some(known) if on.off < self.on_line[v][known].off => self.on_line[v][known] = on,
                Some(_) => {}
            }
        }
    }

    /// Which passage of a line through a vertex is that at an arc length.
    fn beside(&self, v: usize, line: usize, at: f64) -> Option<usize> {
        let traced = &self.lines[line];
        self.on_line[v]
            .iter()
            .position(|on| on.line == line && traced.apart([on.at, at]) < self.sizes[v])
    }

    /// Where each edge is to be cut, as a fraction of the way: at the crossing farthest from its ends.
    fn places(&self, crossings: &[Vec<Crossing>]) -> Vec<Option<f64>> {
        let edges = self.piece.mesh.edges().as_slice().iter();
        let place = |(edge, found): (&Edge, &Vec<Crossing>)| {
            let room = |crossing: &Crossing| {
                let on = edge
                    .vertices
                    .map(|v| self.beside(v.index(), crossing.line, crossing.at).is_some());
                // An edge that lies on the line.
                if on == [true; 2] {
                    return None;
                }
                let distances = self.distances(edge, crossing);
                let least = on.map(|on| if on { SNAP_ON_LINE } else { SNAP });
                let is_inside = (0..2).all(|end| distances[end] >= least[end]);
                is_inside.then(|| distances[0].min(distances[1]))
            };
            let inside = found.iter().filter_map(|c| Some((room(c)?, c.fraction)));
            // One cut to an edge and pass: a further crossing lies on one of the halves in the next.
            inside
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, fraction)| fraction)
        };
        edges.zip(crossings).map(place).collect()
    }

    fn cut(&mut self, places: &[Option<f64>]) {
        let EdgeSplit {
            mesh,
            born,
            origins,
        } = split_edges(&self.piece.mesh, places, &mut self.piece.positions);
        for vertex in &born {
            let [a, b] = vertex.ends.map(|v| self.sizes[v.index()]);
            self.sizes.push(a + (b - a) * vertex.fraction);
            // The next pass finds the lines there, at the end of an edge.
            self.on_line.push(Vec::new());
        }
        let origins = origins.as_slice();
        let lift = |above: &PerFace<FaceOrigin>| -> PerFace<FaceOrigin> {
            let lifted = origins.iter().map(|part| FaceOrigin {
                face: above[part.face].face,
                corners: part.corners.map(|weights| above[part.face].lift(weights)),
            });
            lifted.collect()
        };
        (self.piece.origins, self.parts) = (lift(&self.piece.origins), lift(&self.parts));
        // The parts of a face stand side by side.
        let is_part = |at: usize, beside: Option<usize>| {
            let other = beside.and_then(|beside| origins.get(beside));
            other.is_some_and(|other| other.face == origins[at].face)
        };
        let faces = 0..origins.len();
        self.is_new = faces
            .map(|at| is_part(at, at.checked_sub(1)) || is_part(at, Some(at + 1)))
            .collect();
        self.piece.mesh = mesh;
    }

    fn finish(self) -> LineCut {
        let mut vertices = Vec::new();
        for (v, all) in self.on_line.iter().enumerate() {
            for &OnLine { line, at, .. } in all {
                vertices.extend(self.lines[line].place(at).map(|place| LineVertex {
                    vertex: VertexId::from_index(v),
                    line,
                    at,
                    place,
                }));
            }
        }
        vertices.sort_by(|a, b| a.line.cmp(&b.line).then(a.at.total_cmp(&b.at)));
        let (edges, warnings) = self.edges(&vertices);
        LineCut {
            piece: self.piece,
            parts: self.parts,
            vertices,
            edges,
            warnings,
        }
    }

    /// The edges between vertices that follow each other on a line, each for the first line that has it.
    fn edges(&self, vertices: &[LineVertex]) -> (Vec<CreaseEdge>, Vec<CreaseWarning>) {
        let mesh = &self.piece.mesh;
        let (mut edges, mut warnings) = (Vec::new(), Vec::new());
        let mut line_of: BTreeMap<EdgeId, usize> = BTreeMap::new();
        for (line, traced) in self.lines.iter().enumerate() {
            let on: Vec<_> = vertices.iter().filter(|v| v.line == line).collect();
            let mut has_edges = false;
            let closing = on.first().map(|first| LineVertex {
                at: first.at + traced.length(),
                ..**first
            });
            let closing = closing.filter(|_| traced.is_closed() && on.len() > 2);
            let ends = on.iter().copied().skip(1).chain(&closing);
            for (from, to) in on.iter().zip(ends) {
                let at = [from.at, to.at];
                let found = edge_between(mesh, [from.vertex, to.vertex]);
                // At the border there is nothing to fold against.
                let inner = found.filter(|(edge, _)| !mesh.edges()[*edge].is_border());
                let Some((edge, is_along)) = inner else {
                    warnings.push(CreaseWarning::Gap { line, at });
                    continue;
                };
                has_edges = true;
                if let Some(&other) = line_of.get(&edge) {
                    add_shared(&mut warnings, [other, line], at);
                    continue;
                }
                line_of.insert(edge, line);
                let at = if is_along { at } else { [at[1], at[0]] };
                edges.push(CreaseEdge { edge, line, at });
            }
            if !has_edges {
                warnings.push(CreaseWarning::NoEdges { line });
            }
        }
        (edges, warnings)
    }
}

/// Adds that two lines share an edge, to the stretch before if that is where it goes on.
fn add_shared(warnings: &mut Vec<CreaseWarning>, lines: [usize; 2], at: [f64; 2]) {
    match warnings.last_mut() {
        Some(CreaseWarning::Shared {
            lines: before,
            at: [_, end],
        }) if *before == lines && *end == at[0] => *end = at[1],
        _ => warnings.push(CreaseWarning::Shared { lines, at }),
    }
}

/// The edge between two vertices, and whether it runs from the first to the second.
fn edge_between(mesh: &TriMesh, [from, to]: [VertexId; 2]) -> Option<(EdgeId, bool)> {
    // A hairpin inside one face comes back to its vertex.
    if from == to {
        return None;
    }
    let edges = mesh
        .vertex_faces(from)
        .iter()
        .flat_map(|&face| mesh.face_edges(face));
    let mut edges = edges.map(|edge| (edge, mesh.edges()[edge].vertices));
    let found = edges.find(|(_, ends)| ends.contains(&from) && ends.contains(&to));
    found.map(|(edge, ends)| (edge, ends[0] == from))
}
