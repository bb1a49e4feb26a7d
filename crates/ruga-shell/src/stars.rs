//! The closed fans of faces around the inner vertices of an indexed triangle mesh.

use crate::edges::{Edge, Side};
use crate::{RestTriangle, StarShape};

/// A vertex with faces all around it.
#[derive(Clone, Debug)]
pub(crate) struct Star {
    pub(crate) centre: u32,
    /// Counter-clockwise.
    pub(crate) spokes: Vec<Spoke>,
}

/// An edge from the centre of a star outwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spoke {
    /// Its outer end.
    pub(crate) vertex: u32,
    /// Its index among the edges.
    pub(crate) edge: usize,
    /// Whether the edge runs from the centre outwards as its left face winds it.
    pub(crate) outward: bool,
    /// The face between this spoke and the next, and the corner of it that is the centre.
    pub(crate) side: Side,
}

/// The stars of all vertices that are not on a border, by ascending centre.
///
/// A vertex at which two fans touch has no star: it counts as border.
pub(crate) fn stars(faces: &[[u32; 3]], edges: &[Edge], vertices: usize) -> Vec<Star> {
    let of_corner = edges_of_corners(faces, edges);
    let mut first = vec![None; vertices];
    let mut degree = vec![0; vertices];
    for (face, corners) in faces.iter().enumerate() {
        for (corner, &vertex) in corners.iter().enumerate() {
            first[vertex as usize].get_or_insert(Side { face, corner });
            degree[vertex as usize] += 1;
        }
    }
    (0..vertices)
        .filter_map(|vertex| {
            let spokes = closed_fan(first[vertex]?, faces, edges, &of_corner)?;
            (spokes.len() == degree[vertex]).then_some(Star {
                centre: vertex as u32,
                spokes,
            })
        })
        .collect()
}

/// Index of the edge that starts at each corner of each face.
fn edges_of_corners(faces: &[[u32; 3]], edges: &[Edge]) -> Vec<[usize; 3]> {
    let mut of_corner = vec![[0; 3]; faces.len()];
    for (index, edge) in edges.iter().enumerate() {
        for side in std::iter::once(edge.left).chain(edge.right) {
            of_corner[side.face][side.corner] = index;
        }
    }
    of_corner
}

/// Turns counter-clockwise about a corner until the first face comes again; none at a border.
fn closed_fan(
    start: Side,
    faces: &[[u32; 3]],
    edges: &[Edge],
    of_corner: &[[usize; 3]],
) -> Option<Vec<Spoke>> {
    let mut spokes = Vec::with_capacity(8);
    let mut side = start;
    loop {
        let edge = of_corner[side.face][side.corner];
        let left = edges[edge].left;
        spokes.push(Spoke {
            vertex: faces[side.face][(side.corner + 1) % 3],
            edge,
            outward: left.face == side.face && left.corner == side.corner,
            side,
        });
        let last = (side.corner + 2) % 3;
        let next = &edges[of_corner[side.face][last]];
        let right = next.right?;
        // The edge ends at the centre in this face; in the next one it starts there.
        side = if next.left.face == side.face && next.left.corner == last {
            right
        } else {
            next.left
        };
        if side.face == start.face {
            return Some(spokes);
        }
    }
}

impl Star {
    /// The star as its rest triangles show it.
    pub(crate) fn shape(&self, rest: &[RestTriangle]) -> StarShape {
        let fan: Vec<_> = self
            .spokes
            .iter()
            .map(|spoke| (rest[spoke.side.face], spoke.side.corner))
            .collect();
        StarShape::new(&fan)
    }

    /// Centre, then the outer ends.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(self.centre).chain(self.spokes.iter().map(|spoke| spoke.vertex))
    }

    /// Every two of its vertices.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let second = |i: usize| self.vertices().take(i);
        self.vertices()
            .enumerate()
            .flat_map(move |(i, a)| second(i).map(move |b| [a, b]))
    }

    /// Mean over the faces, weighted by their area.
    pub(crate) fn mean(&self, rest: &[RestTriangle], value: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for Spoke { side, .. } in &self.spokes {
            sum += rest[side.face].area() * value(side.face);
            area += rest[side.face].area();
        }
        sum / area
    }
}

/// The area (m²) that each star stands for: a third of its faces, and of what the border vertices
/// have, equal shares to each of their inner neighbours.
///
/// A border vertex without inner neighbours has hinges of its own, see [`is_border_hinge`].
pub(crate) fn star_areas<'a>(
    stars: impl Iterator<Item = &'a Star> + Clone,
    faces: &[[u32; 3]],
    edges: &[Edge],
    rest: &[RestTriangle],
    vertices: usize,
) -> Vec<f64> {
    let mut own = vec![0.0; vertices];
    for (face, rest) in faces.iter().zip(rest) {
        for &vertex in face {
            own[vertex as usize] += rest.area() / 3.0;
        }
    }
    let inner = inner_vertices(stars.clone(), vertices);
    let mut receivers = vec![0_u32; vertices];
    let across = |edge: &Edge| {
        let [a, b] = edge.ends.map(|v| v as usize);
        match (inner[a], inner[b]) {
            (true, false) => Some((a, b)),
            (false, true) => Some((b, a)),
            _ => None,
        }
    };
    for (_, border) in edges.iter().filter_map(across) {
        receivers[border] += 1;
    }
    let mut areas = own.clone();
    for (receiver, border) in edges.iter().filter_map(across) {
        areas[receiver] += own[border] / f64::from(receivers[border]);
    }
    stars.map(|star| areas[star.centre as usize]).collect()
}

/// Whether each vertex is the centre of a star.
pub(crate) fn inner_vertices<'a>(
    stars: impl IntoIterator<Item = &'a Star>,
    vertices: usize,
) -> Vec<bool> {
    let mut inner = vec![false; vertices];
    for star in stars {
        inner[star.centre as usize] = true;
    }
    inner
}

/// Whether two faces meet at an edge that is a spoke of no star: it keeps a hinge, because nothing
/// else would resist its fold.
pub(crate) fn is_border_hinge(edge: &Edge, inner: &[bool]) -> bool {
    edge.right.is_some() && edge.ends.iter().all(|&v| !inner[v as usize])
}
