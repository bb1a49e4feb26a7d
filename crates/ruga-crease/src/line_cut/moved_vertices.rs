//! Moves vertices that lie closely beside a line onto it, before the mesh is cut along it.
//!
//! A line that ran beside a row of vertices would leave a row of triangles as thin as the gap between, on which no
//! normal can be told from noise. The idea is that of isosurface stuffing (Labelle and Shewchuk 2007): what is
//! nearer than a share of an edge is warped, and only what is farther is cut.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{FaceId, FaceOrigin, Id, PerFace, VertexId};

use super::MeshPiece;
use crate::TracedLine;
use crate::crossings::meet_in_face;

/// Distance of a line from a vertex, in edges, up to which the vertex is moved. Triangles that stay are cut no
/// closer to a vertex than this; more would move vertices farther than their triangles bear.
const NEAR: f64 = 0.25;

/// The same for a place where lines cross, which is worth a longer way: no vertex there means two
/// beside each other, and a small triangle between.
const NEAR_CROSSING: f64 = 0.4;

/// Shape of a triangle (1 equilateral, 0 degenerate) below which a move may not make it worse.
const LEAST_SHAPE: f64 = 0.3;

/// Barycentric coordinate below which a vertex lies on an edge of a traced triangle: rounding.
const ON_EDGE: f64 = 1e-9;

/// Segments of lines in every traced triangle: line and number.
pub(super) type Segments = [Vec<(u32, u32)>];

/// A vertex that has been moved onto a line.
pub(super) struct MovedVertex {
    pub(super) vertex: usize,
    pub(super) line: usize,
    /// Arc length along it (m).
    pub(super) at: f64,
}

/// Where a vertex could go.
struct Move {
    vertex: usize,
    to: Vector3<f64>,
    /// How far that is, in edges over the way allowed.
    way: f64,
    /// Its change in barycentric coordinates of each traced triangle that it lies in.
    changes: Vec<(FaceId, Vector3<f64>)>,
    passages: Passages,
}

/// The lines at a place, each with its arc length there (m).
type Passages = Vec<(usize, f64)>;

/// Moves vertices of a piece within the traced triangles that they lie in, and along their edges; those
/// at corners of traced triangles, at the border and where `is_kept` stay. `sizes` are
/// lengths of the edges around every vertex (m).
pub(super) fn move_onto_lines(
    (lines, segments): (&[TracedLine], &Segments),
    piece: &mut MeshPiece,
    sizes: &[f64],
    is_kept: &dyn Fn(VertexId) -> bool,
) -> Vec<MovedVertex> {
    let border = piece.mesh.border_vertices();
    let movable = border.ids().filter(|&v| !border[v] && !is_kept(v));
    let finder = Finder {
        lines,
        segments,
        piece,
        sizes,
    };
    let mut moves: Vec<Move> = movable.filter_map(|v| finder.best(v)).collect();
    // The shortest ways come first: what they leave of a triangle is asked of the longer ones.
    moves.sort_by(|a, b| a.way.total_cmp(&b.way).then(a.vertex.cmp(&b.vertex)));
    let mut moved = Vec::new();
    for Move {
        vertex,
        to,
        changes,
        passages,
        ..
    } in moves
    {
        if !keeps_shape(piece, vertex, &to) {
            continue;
        }
        apply(piece, vertex, &to, &changes);
        let on = passages
            .into_iter()
            .map(|(line, at)| MovedVertex { vertex, line, at });
        moved.extend(on);
    }
    moved
}

/// Places of a piece's faces in those of the piece before its vertices were moved. Weights of moved
/// corners may be beyond a face's edges, still in its plane.
pub(super) fn parts_of(
    before: &PerFace<FaceOrigin>,
    after: &PerFace<FaceOrigin>,
) -> PerFace<FaceOrigin> {
    let whole = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let parts = before.iter().map(|(face, old)| {
        let new = after[face];
        let inverse = matrix(&old.corners).try_inverse();
        let corner = |corner: usize| match (&inverse, new.corners[corner] == old.corners[corner]) {
            (Some(inverse), false) => (inverse * Vector3::from(new.corners[corner])).into(),
            _ => whole[corner],
        };
        FaceOrigin {
            face,
            corners: std::array::from_fn(corner),
        }
    });
    parts.collect()
}

fn matrix(corners: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_columns(&corners.map(Vector3::from))
}

/// Finds moves on a piece that nothing has moved yet.
struct Finder<'a> {
    lines: &'a [TracedLine],
    segments: &'a Segments,
    piece: &'a MeshPiece,
    sizes: &'a [f64],
}

impl Finder<'_> {
    /// The shortest way of a vertex onto a line, or onto two.
    fn best(&self, v: VertexId) -> Option<Move> {
        let mesh = &self.piece.mesh;
        let around = mesh.vertex_faces(v);
        let origin = |face: FaceId| self.piece.origins[face].face;
        if !around
            .iter()
            .any(|&face| !self.segments_in(face).is_empty())
        {
            return None;
        }
        let first = *around.first()?;
        let place = self.corner(first, v);
        let inside = place.iter().filter(|weight| **weight > ON_EDGE).count();
        let is_in_one = around.iter().all(|&face| origin(face) == origin(first));
        match (inside, is_in_one) {
            (3, true) => self.inside(v, first),
            (2, false) => self.along_edge(v),
            _ => None,
        }
    }

    fn segments_in(&self, face: FaceId) -> &[(u32, u32)] {
        let segments = self.segments.get(self.piece.origins[face].face.index());
        segments.map_or(&[], Vec::as_slice)
    }

    /// Barycentric coordinates of a face's corner in the traced triangle.
    fn corner(&self, face: FaceId, v: VertexId) -> Vector3<f64> {
        let corner = self.piece.mesh.faces()[face].iter().position(|&c| c == v);
        self.piece.origins[face].corners[corner.expect("a face around it")].into()
    }

    /// The move of a vertex inside a traced triangle, of which `face` is a part.
    fn inside(&self, v: VertexId, face: FaceId) -> Option<Move> {
        let corners = self.piece.mesh.faces()[face].map(|v| self.piece.positions[v.index()]);
        let inverse = matrix(&self.piece.origins[face].corners).try_inverse()?;
        // Positions are linear in barycentric coordinates of the traced triangle.
        let in_space = Matrix3::from_columns(&corners) * inverse;
        let (from, here) = (self.corner(face, v), self.piece.positions[v.index()]);
        let size = self.sizes[v.index()];
        let mut near: Vec<(f64, Vector3<f64>, [u32; 2], f64)> = Vec::new();
        for &(line, number) in self.segments_in(face) {
            let segment = &self.lines[line as usize].segments()[number as usize];
            let [tail, head] = [segment.from, segment.to].map(Vector3::from);
            let along = in_space * (head - tail);
            let share = (here - in_space * tail).dot(&along) / along.norm_squared();
            let share = share.clamp(0.0, 1.0);
            let foot = tail + (head - tail) * share;
            let way = (in_space * foot - here).norm() / size;
            if way < NEAR_CROSSING {
                near.push((way, foot, [line, number], share));
            }
        }
        let to = |way: f64, foot: Vector3<f64>, passages| Move {
            vertex: v.index(),
            to: in_space * foot,
            way,
            changes: vec![(self.piece.origins[face].face, foot - from)],
            passages,
        };
        let crossings = near.iter().enumerate().flat_map(|(i, first)| {
            near[i + 1..]
                .iter()
                .filter_map(move |second| self.crossing([first.2, second.2]))
        });
        let crossings = crossings.filter_map(|(foot, passages)| {
            let way = (in_space * foot - here).norm() / size;
            // That a way may be longer must not make it come later.
            (way < NEAR_CROSSING).then(|| to(way * NEAR / NEAR_CROSSING, foot, passages))
        });
        let least = crossings.min_by(|a, b| a.way.total_cmp(&b.way));
        least.or_else(|| {
            let nearest = near.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
            let &(way, foot, [line, number], share) = nearest;
            let at = self.at(line, number, share);
            (way < NEAR).then(|| to(way, foot, vec![(line as usize, at)]))
        })
    }

    fn at(&self, line: u32, number: u32, share: f64) -> f64 {
        let segment = &self.lines[line as usize].segments()[number as usize];
        segment.start + segment.length * share.clamp(0.0, 1.0)
    }

    /// Where two segments of different lines cross.
    fn crossing(&self, [a, b]: [[u32; 2]; 2]) -> Option<(Vector3<f64>, Passages)> {
        if a[0] == b[0] {
            return None;
        }
        let segment =
            |[line, number]: [u32; 2]| &self.lines[line as usize].segments()[number as usize];
        let [first, second] = [segment(a), segment(b)];
        let [s, t] = meet_in_face([[first.from, first.to], [second.from, second.to]])?;
        let passages = [(a, s), (b, t)]
            .map(|([line, number], share)| (line as usize, self.at(line, number, share)));
        Some((
            first.place(s.clamp(0.0, 1.0)).barycentric.into(),
            passages.to_vec(),
        ))
    }

    /// The move of a vertex along the edge between two traced triangles on which it lies.
    fn along_edge(&self, v: VertexId) -> Option<Move> {
        let mesh = &self.piece.mesh;
        let here = self.piece.positions[v.index()];
        let mut best: Option<(f64, VertexId, f64, (usize, f64))> = None;
        for &face in mesh.vertex_faces(v) {
            let from = self.corner(face, v);
            for other in mesh.faces()[face].into_iter().filter(|&other| other != v) {
                let to = self.corner(face, other);
                let is_along = (0..3).any(|i| from[i].abs() < ON_EDGE && to[i].abs() < ON_EDGE);
                if !is_along {
                    continue;
                }
                let way =
                    (self.piece.positions[other.index()] - here).norm() / self.sizes[v.index()];
                for &(line, number) in self.segments_in(face) {
                    let segment = &self.lines[line as usize].segments()[number as usize];
                    let met = meet_in_face([[from.into(), to.into()], [segment.from, segment.to]]);
                    let Some([fraction, share]) = met else {
                        continue;
                    };
                    let way = way * fraction.max(0.0);
                    if way < NEAR && best.as_ref().is_none_or(|best| way < best.0) {
                        let passage = (line as usize, self.at(line, number, share));
                        best = Some((way, other, fraction.max(0.0), passage));
                    }
                }
            }
        }
        let (way, other, fraction, passage) = best?;
        let beside = mesh
            .vertex_faces(v)
            .iter()
            .filter(|&&face| mesh.faces()[face].contains(&other));
        let changes = beside.map(|&face| {
            let change = (self.corner(face, other) - self.corner(face, v)) * fraction;
            (self.piece.origins[face].face, change)
        });
        let changes: Vec<_> = changes.collect();
        // A line along a seam of the traced mesh has one triangle there.
        (changes.len() == 2 && changes[0].0 != changes[1].0).then(|| Move {
            vertex: v.index(),
            to: here.lerp(&self.piece.positions[other.index()], fraction),
            way,
            changes,
            passages: vec![passage],
        })
    }
}

/// Whether all triangles around a vertex stay upright and in good shape where it goes.
fn keeps_shape(piece: &MeshPiece, vertex: usize, to: &Vector3<f64>) -> bool {
    let v = VertexId::from_index(vertex);
    piece.mesh.vertex_faces(v).iter().all(|&face| {
        let corners = piece.mesh.faces()[face];
        let before = corners.map(|v| piece.positions[v.index()]);
        let mut after = before;
        for (place, _) in after.iter_mut().zip(corners).filter(|(_, c)| *c == v) {
            *place = *to;
        }
        let [normal, moved] = [before, after].map(|[a, b, c]| (b - a).cross(&(c - a)));
        let least = shape(&before).min(LEAST_SHAPE);
        normal.dot(&moved) > 0.0 && shape(&after) >= least
    })
}

/// Shape of a triangle: 1 for an equilateral one, 0 for one without area.
fn shape([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    let area = (b - a).cross(&(c - a)).norm();
    2.0 * 3.0_f64.sqrt() * area / sides.max(f64::MIN_POSITIVE)
}

fn apply(
    piece: &mut MeshPiece,
    vertex: usize,
    to: &Vector3<f64>,
    changes: &[(FaceId, Vector3<f64>)],
) {
    let v = VertexId::from_index(vertex);
    piece.positions[vertex] = *to;
    for &face in piece.mesh.vertex_faces(v) {
        let corner = piece.mesh.faces()[face].iter().position(|&c| c == v);
        let origin = &mut piece.origins[face];
        let weights = &mut origin.corners[corner.expect("a face around it")];
        let change = changes.iter().find(|(traced, _)| *traced == origin.face);
        let (_, change) = change.expect("a change for every triangle that it lies in");
        *weights = (Vector3::from(*weights) + change).into();
    }
}
