//! The way straight across triangles from one place of a surface to another.

use ruga_mesh::{FaceId, Id, MaterialPoint, TriMesh};

/// Weights below this are rounding: the place lies on the edge or vertex opposite.
const ON_EDGE: f64 = 1e-12;

/// A straight way, as two functions that are linear in every triangle.
pub(crate) trait Straight {
    /// On which side of the way the corners of a face lie, and how far.
    fn side(&self, face: FaceId) -> [f64; 3];
    /// How far along the way the corners of a face are: 0 at its start, 1 at its end.
    fn along(&self, face: FaceId) -> [f64; 3];
    /// Whether a place of a face is the start or the end of the way: on a seam not every face that touches one
    /// has it where the way is drawn.
    fn is_at(&self, end: End, face: FaceId, barycentric: [f64; 3]) -> bool;
    /// Whether the way goes on across an edge of a face, given by its first corner, into the next face.
    fn goes_on(&self, face: FaceId, corner: usize, next: FaceId) -> bool;
}

/// One of the two ends of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Start,
    Goal,
}

/// A part of the way: triangle, start and end.
pub(crate) type Step = (FaceId, [f64; 3], [f64; 3]);

/// Why a way ends before its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// At the border of the surface, in this face.
    Border(FaceId),
    /// At an edge that the way does not cross, in this face.
    Seam(FaceId),
    /// Past the end, or going nowhere.
    Lost,
}

/// The way from one place to another.
///
/// A corner that lies on the way counts as left of it. So every face that is entered is left again through
/// exactly one other edge, even where the way runs through vertices or along edges. Along a border there may be
/// faces on one side alone: then such corners count as right of the way.
pub(crate) fn walk(
    mesh: &TriMesh,
    way: &impl Straight,
    ends: [MaterialPoint; 2],
) -> Result<Vec<Step>, Stop> {
    let left = walk_beside(mesh, &Sided { way, on_way: true }, ends);
    left.or_else(|stop| walk_beside(mesh, &Sided { way, on_way: false }, ends).map_err(|_| stop))
}

/// A way, and whether what lies on it is left of it.
struct Sided<'a, W> {
    way: &'a W,
    on_way: bool,
}

impl<W: Straight> Sided<'_, W> {
    fn is_left(&self, face: FaceId) -> [bool; 3] {
        let side = self.way.side(face);
        side.map(|side| if side == 0.0 { self.on_way } else { side > 0.0 })
    }
}

fn walk_beside<W: Straight>(
    mesh: &TriMesh,
    way: &Sided<'_, W>,
    [start, end]: [MaterialPoint; 2],
) -> Result<Vec<Step>, Stop> {
    let in_face = |which: End, place: &MaterialPoint, face: FaceId| {
        place_in(mesh, place, face).filter(|&at| way.way.is_at(which, face, at))
    };
    let around = faces_at(mesh, &start);
    for &face in &around {
        let ends = (
            in_face(End::Start, &start, face),
            in_face(End::Goal, &end, face),
        );
        if let (Some(from), Some(to)) = ends {
            return Ok(vec![(face, from, to)]);
        }
    }
    let exits = around.iter().filter_map(|&face| {
        let from = in_face(End::Start, &start, face)?;
        let exit = exits(way, face).into_iter().flatten();
        let farthest = exit.max_by(|a, b| a.along.total_cmp(&b.along))?;
        Some((face, from, farthest))
    });
    let first = exits.max_by(|a, b| a.2.along.total_cmp(&b.2.along));
    let (mut face, mut from, mut exit) = first
        .filter(|first| first.2.along > 0.0)
        .ok_or(Stop::Lost)?;
    let mut steps = Vec::new();
    for _ in 0..=mesh.face_count() {
        steps.push((face, from, exit.place()));
        let next = mesh
            .neighbour(face, exit.corner)
            .ok_or(Stop::Border(face))?;
        if !way.way.goes_on(face, exit.corner, next) {
            return Err(Stop::Seam(face));
        }
        let crossed = MaterialPoint {
            face,
            barycentric: exit.place(),
        };
        let tail = mesh.faces()[face][exit.corner];
        from = place_in(mesh, &crossed, next).ok_or(Stop::Lost)?;
        if let Some(to) = in_face(End::Goal, &end, next) {
            steps.push((next, from, to));
            return Ok(steps);
        }
        // A little past the end is rounding; more is another part of the surface.
        if exit.along > 1.0 + 1e-6 {
            return Err(Stop::Lost);
        }
        exit = exit_beyond(mesh, way, next, (tail.index(), exit.tail_is_left)).ok_or(Stop::Lost)?;
        face = next;
    }
    Err(Stop::Lost)
}

/// Where the way leaves a face.
#[derive(Clone, Copy, Debug)]
struct Exit {
    /// First corner of the edge.
    corner: usize,
    /// Fraction of the way along it.
    fraction: f64,
    along: f64,
    tail_is_left: bool,
}

impl Exit {
    fn place(&self) -> [f64; 3] {
        let mut place = [0.0; 3];
        place[self.corner] = 1.0 - self.fraction;
        place[(self.corner + 1) % 3] = self.fraction;
        place
    }
}

/// The crossing of an edge of a face whose ends are left of the way or not.
fn crossing(way: &impl Straight, face: FaceId, corner: usize, is_left: [bool; 3]) -> Option<Exit> {
    let next = (corner + 1) % 3;
    if is_left[corner] == is_left[next] {
        return None;
    }
    let (side, along) = (way.side(face), way.along(face));
    // Sides may come from the face before, whose rounding was another one.
    let fraction = (side[corner] / (side[corner] - side[next])).clamp(0.0, 1.0);
    let fraction = if fraction.is_nan() { 0.5 } else { fraction };
    Some(Exit {
        corner,
        fraction,
        along: along[corner] + (along[next] - along[corner]) * fraction,
        tail_is_left: is_left[corner],
    })
}

fn exits<W: Straight>(way: &Sided<'_, W>, face: FaceId) -> [Option<Exit>; 3] {
    let is_left = way.is_left(face);
    [0, 1, 2].map(|corner| crossing(way.way, face, corner, is_left))
}

/// Where the way leaves a face that it entered by the edge that ends at the vertex `tail`, whose side is known.
fn exit_beyond<W: Straight>(
    mesh: &TriMesh,
    way: &Sided<'_, W>,
    face: FaceId,
    (tail, tail_is_left): (usize, bool),
) -> Option<Exit> {
    // The two faces of an edge run it in opposite directions.
    let head = mesh.faces()[face].iter().position(|v| v.index() == tail)?;
    let [entry, apex] = [head + 2, head + 1].map(|corner| corner % 3);
    let mut is_left = way.is_left(face);
    (is_left[entry], is_left[head]) = (!tail_is_left, tail_is_left);
    crossing(way.way, face, head, is_left).or_else(|| crossing(way.way, face, apex, is_left))
}

/// The faces that a place lies in: one, or two at an edge, or the fan of a vertex.
pub(crate) fn faces_at(mesh: &TriMesh, place: &MaterialPoint) -> Vec<FaceId> {
    let corners = mesh.faces()[place.face];
    let on = |i: usize| place.barycentric[i] > ON_EDGE;
    let mut faces = vec![place.face];
    for corner in corners {
        for &face in mesh.vertex_faces(corner) {
            let has = |i: usize| !on(i) || mesh.faces()[face].contains(&corners[i]);
            if !faces.contains(&face) && (0..3).all(has) {
                faces.push(face);
            }
        }
    }
    faces
}

/// Barycentric coordinates of a place in a face that it lies in.
pub(crate) fn place_in(mesh: &TriMesh, place: &MaterialPoint, face: FaceId) -> Option<[f64; 3]> {
    if place.face == face {
        return Some(place.barycentric);
    }
    let corners = mesh.faces()[face];
    let mut weights = [0.0; 3];
    for (vertex, weight) in mesh.faces()[place.face].into_iter().zip(place.barycentric) {
        match corners.iter().position(|&v| v == vertex) {
            Some(corner) => weights[corner] = weight,
            None if weight > ON_EDGE => return None,
            None => {}
        }
    }
    let sum: f64 = weights.iter().sum();
    Some(weights.map(|weight| weight / sum))
}

/// Whether two places are one.
pub(crate) fn is_same(mesh: &TriMesh, a: &MaterialPoint, b: &MaterialPoint) -> bool {
    faces_at(mesh, a).contains(&b.face)
        && place_in(mesh, a, b.face)
            .is_some_and(|weights| (0..3).all(|i| (weights[i] - b.barycentric[i]).abs() < 1e-9))
}
