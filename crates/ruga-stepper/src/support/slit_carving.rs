//! Thin wedges carved out of a closed surface along chains of its edges.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, FaceId, Id, PerFace, TriMesh, VertexFan, VertexId};

/// Share of the least height of the triangles beside a slit up to which it is opened: more could turn one over.
const SHARE_OF_HEIGHT: f64 = 0.25;

/// An edge of a slit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlitEdge {
    pub(crate) edge: EdgeId,
    /// Number of the slit.
    pub(crate) slit: usize,
    /// Whether the slit runs as the edge does.
    pub(crate) is_along: bool,
    /// From the lips at its two vertices, in its own order, to the bottom below, m.
    pub(crate) down: [Vector3<f64>; 2],
}

/// A surface with slits.
#[derive(Clone, Debug)]
pub(crate) struct Carved {
    /// The faces before, of which those to the left of a slit have new vertices, then the walls.
    pub(crate) mesh: TriMesh,
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Whether a face of before touches the left lip of a slit, and the right one.
    pub(crate) touches: PerFace<[bool; 2]>,
    /// Slit of every wall.
    pub(crate) slits: Vec<usize>,
    /// Pairs of walls on both sides of a slit, by its number.
    pub(crate) pairs: Vec<(usize, [Wall; 2])>,
}

/// A wall on the left or on the right of a slit, with the corner at its lip and that at the bottom, which both have.
pub(crate) type Wall = (FaceId, [usize; 2]);

/// Two slits that meet at a vertex, or one that meets itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting(pub(crate) [usize; 2]);

/// A vertex in the middle of a slit, in three copies.
struct Copies {
    /// Of both lips and of the bottom.
    lips: [VertexId; 2],
    bottom: VertexId,
}

/// Opens a surface along edges by at most `opening` (m).
///
/// ```text
///   left lip  >---.     .---<  right lip      every vertex in the middle of a chain gets three copies: one to
///                  \   /                      either side, half the opening away, and one at the bottom; the
///                   \ /                       two walls between them close the surface. A vertex at an end stays
///                    V  bottom                single, and the slit runs out to it over its last edge.
/// ```
/// # Errors
/// [`Meeting`] where more than two edges meet, or two of different slits or that run against each other.
pub(crate) fn carve(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    edges: &[SlitEdge],
    opening: f64,
) -> Result<Carved, Meeting> {
    let chains = Chains::new(mesh, edges)?;
    let half = (0.5 * opening).min(SHARE_OF_HEIGHT * least_height(mesh, positions, &chains));
    let mut faces = mesh.faces().as_slice().to_vec();
    let mut places = positions.to_vec();
    let mut touches = PerFace::filled(faces.len(), [false; 2]);
    let mut copies: BTreeMap<u32, Copies> = BTreeMap::new();
    for (&v, &(before, after)) in &chains.middles {
        let i = v as usize;
        let down = before.down[1];
        let along = positions[after.to.index()] - positions[before.from.index()];
        // Where the chain turns back on itself there is no way across, and the lips stay together.
        let across = along.cross(&down).try_normalize(0.0);
        let across = across.unwrap_or_else(Vector3::zeros) * half;
        places[i] = positions[i] - across;
        let mut add = |place: Vector3<f64>| {
            places.push(place);
            VertexId::from_index(places.len() - 1)
        };
        let left = add(positions[i] + across);
        let bottom = add(positions[i] + down);
        let on_left = left_faces(mesh, VertexId(v), (before.from, after.to));
        for &face in mesh.vertex_faces(VertexId(v)) {
            match on_left.iter().find(|(own, _)| *own == face) {
                Some(&(_, corner)) => {
                    faces[face.index()][corner] = left;
                    touches[face][0] = true;
                }
                None => touches[face][1] = true,
            }
        }
        let lips = [left, VertexId(v)];
        copies.insert(v, Copies { lips, bottom });
    }
    let (mut slits, mut pairs) = (Vec::new(), Vec::new());
    let mut add_wall = |corners: [VertexId; 3], slit: usize| {
        faces.push(corners);
        slits.push(slit);
        FaceId::from_index(faces.len() - 1)
    };
    for edge in &chains.edges {
        let ends = [edge.from, edge.to];
        let [a, b] = ends.map(|v| copies.get(&v.0));
        let slit = edge.slit;
        // Both walls have the same diagonal, from the lip at `a` to the bottom at `b`, so that they cannot cross.
        if let Some(b) = b {
            let lip = |side: usize| a.map_or(edge.from, |a| a.lips[side]);
            let left = add_wall([b.lips[0], lip(0), b.bottom], slit);
            let right = add_wall([lip(1), b.lips[1], b.bottom], slit);
            pairs.push((slit, [(left, [0, 2]), (right, [1, 2])]));
        }
        if let Some(a) = a {
            let far = b.map_or(edge.to, |b| b.bottom);
            add_wall([a.lips[0], a.bottom, far], slit);
            add_wall([a.lips[1], far, a.bottom], slit);
        }
    }
    let corners = faces.into_iter().map(|face| face.map(|v| v.0));
    let mesh = TriMesh::new(places.len(), corners.collect());
    Ok(Carved {
        mesh: mesh.expect("a surface that is cut along edges stays one"),
        positions: places,
        touches,
        slits,
        pairs,
    })
}

/// An edge of a slit in the direction in which that runs.
#[derive(Clone, Copy)]
struct Step {
    from: VertexId,
    to: VertexId,
    slit: usize,
    /// From the lips at both ends to the bottom below.
    down: [Vector3<f64>; 2],
}

struct Chains {
    edges: Vec<Step>,
    /// The edges before and after every vertex that is not at an end.
    middles: BTreeMap<u32, (Step, Step)>,
}

impl Chains {
    fn new(mesh: &TriMesh, edges: &[SlitEdge]) -> Result<Self, Meeting> {
        let step = |edge: &SlitEdge| {
            let [a, b] = mesh.edges()[edge.edge].vertices;
            let mut step = Step {
                from: a,
                to: b,
                slit: edge.slit,
                down: edge.down,
            };
            if !edge.is_along {
                std::mem::swap(&mut step.from, &mut step.to);
                step.down.reverse();
            }
            step
        };
        let edges: Vec<Step> = edges.iter().map(step).collect();
        let (mut into, mut out) = (BTreeMap::new(), BTreeMap::new());
        for &step in &edges {
            for (known, vertex) in [(&mut out, step.from), (&mut into, step.to)] {
                let other: Option<Step> = known.insert(vertex.0, step);
                if let Some(other) = other {
                    return Err(Meeting([other.slit, step.slit]));
                }
            }
        }
        let middles = into.iter().filter_map(|(&v, before)| {
            let after = out.get(&v)?;
            Some((v, (*before, *after)))
        });
        let middles: BTreeMap<u32, (Step, Step)> = middles.collect();
        let mut joined = middles.values();
        match joined.find(|(before, after)| before.slit != after.slit) {
            None => Ok(Self { middles, edges }),
            Some((before, after)) => Err(Meeting([before.slit, after.slit])),
        }
    }
}

/// The faces around a vertex to the left of the way from one neighbour to another, each with its corner there.
fn left_faces(
    mesh: &TriMesh,
    vertex: VertexId,
    (from, to): (VertexId, VertexId),
) -> Vec<(FaceId, usize)> {
    let face = mesh.vertex_faces(vertex)[0];
    let corner = mesh.faces()[face].iter().position(|&v| v == vertex);
    let fan = VertexFan::around(mesh, face, corner.expect("a face of the vertex"));
    let count = fan.faces.len();
    let first = fan.spokes.iter().position(|&v| v == to);
    let first = first.expect("a slit runs along edges");
    let turn = (0..count).map(|i| (first + i) % count);
    let left = turn.take_while(|&i| fan.spokes[i] != from);
    left.map(|i| fan.faces[i]).collect()
}

/// Least height of the triangles at the vertices that get copies, m.
fn least_height(mesh: &TriMesh, positions: &[Vector3<f64>], chains: &Chains) -> f64 {
    let faces = chains
        .middles
        .keys()
        .flat_map(|&v| mesh.vertex_faces(VertexId(v)));
    let height = |&face: &FaceId| {
        let [a, b, c] = mesh.faces()[face].map(|v| positions[v.index()]);
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        (b - a).cross(&(c - a)).norm() / longest
    };
    faces.map(height).fold(f64::INFINITY, f64::min)
}
