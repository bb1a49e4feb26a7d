//! The fans of faces around the vertices of an indexed triangle mesh.

use crate::edges::{Edge, Side};
use crate::{RestTriangle, StarShape};

/// A vertex with its faces, all around it or, on a border, from one border edge to the other.
#[derive(Clone, Debug)]
pub(crate) struct Star {
    pub(crate) centre: u32,
    /// The faces, counter-clockwise, and the corner of each that is the centre.
    fan: Vec<Side>,
    /// The neighbours, counter-clockwise: as many as faces, or one more at a border.
    ring: Vec<u32>,
    /// The edges at the centre that two of its faces share, counter-clockwise.
    pub(crate) folds: Vec<Fold>,
}

/// An edge from the centre of a star to one of its neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fold {
    /// Its index among the edges.
    pub(crate) edge: usize,
    /// Tail, head, left and right apex, as its left face winds it, among [`Star::vertices`].
    pub(crate) corners: [u32; 4],
}

/// A step about a vertex needs the edges' two sides; these are their indices by face and corner.
struct Corners<'a> {
    faces: &'a [[u32; 3]],
    edges: &'a [Edge],
    /// The edge that starts at each corner of each face.
    edge: Vec<[usize; 3]>,
}

/// The stars of all vertices with at least two faces in a fan, by face and corner of their first.
///
/// A vertex at which several fans touch has a star for each.
pub(crate) fn stars(faces: &[[u32; 3]], edges: &[Edge]) -> Vec<Star> {
    let corners = Corners::new(faces, edges);
    let mut seen = vec![[false; 3]; faces.len()];
    let mut stars = Vec::new();
    for face in 0..faces.len() {
        for corner in 0..3 {
            if seen[face][corner] {
                continue;
            }
            let star = corners.star(Side { face, corner });
            for side in &star.fan {
                seen[side.face][side.corner] = true;
            }
            if !star.folds.is_empty() {
                stars.push(star);
            }
        }
    }
    stars
}

impl<'a> Corners<'a> {
    fn new(faces: &'a [[u32; 3]], edges: &'a [Edge]) -> Self {
        let mut edge = vec![[0; 3]; faces.len()];
        for (index, sides) in edges.iter().enumerate() {
            for side in std::iter::once(sides.left).chain(sides.right) {
                edge[side.face][side.corner] = index;
            }
        }
        Self { faces, edges, edge }
    }

    /// The other side of the edge that starts at this corner.
    fn across(&self, side: Side) -> Option<Side> {
        let edge = &self.edges[self.edge[side.face][side.corner]];
        if edge.left.face == side.face && edge.left.corner == side.corner {
            edge.right
        } else {
            Some(edge.left)
        }
    }

    /// The next face about the corner's vertex, counter-clockwise, and its corner there.
    fn next(&self, side: Side) -> Option<Side> {
        self.across(Side {
            corner: (side.corner + 2) % 3,
            ..side
        })
    }

    fn last(&self, side: Side) -> Option<Side> {
        self.across(side).map(|other| Side {
            corner: (other.corner + 1) % 3,
            ..other
        })
    }

    fn star(&self, any: Side) -> Star {
        let mut first = any;
        while let Some(last) = self.last(first) {
            first = last;
            if first.face == any.face {
                break;
            }
        }
        let mut fan = vec![first];
        let mut end = self.next(first);
        while let Some(side) = end.filter(|side| side.face != first.face) {
            fan.push(side);
            end = self.next(side);
        }
        let corner = |side: &Side, k: usize| self.faces[side.face][(side.corner + k) % 3];
        let mut ring: Vec<_> = fan.iter().map(|side| corner(side, 1)).collect();
        if end.is_none() {
            ring.extend(fan.last().map(|side| corner(side, 2)));
        }
        let count = ring.len();
        let folds = fan.iter().enumerate();
        Star {
            centre: corner(&first, 0),
            folds: folds
                .skip(usize::from(end.is_none()))
                .map(|(k, side)| self.fold(*side, k, count))
                .collect(),
            fan,
            ring,
        }
    }

    /// The edge at which face `k` of a star begins.
    fn fold(&self, side: Side, k: usize, count: usize) -> Fold {
        let edge = self.edge[side.face][side.corner];
        let left = self.edges[edge].left;
        let [next, last] = [(k + 1) % count, (k + count - 1) % count];
        let [end, next, last] = [k, next, last].map(|k| k as u32 + 1);
        let outward = left.face == side.face && left.corner == side.corner;
        Fold {
            edge,
            corners: if outward {
                [0, end, next, last]
            } else {
                [end, 0, last, next]
            },
        }
    }
}

impl Star {
    /// The star as its rest triangles show it.
    pub(crate) fn shape(&self, rest: &[RestTriangle]) -> StarShape {
        let fan: Vec<_> = self
            .fan
            .iter()
            .map(|side| (rest[side.face], side.corner))
            .collect();
        if self.ring.len() == fan.len() {
            StarShape::closed(&fan)
        } else {
            StarShape::open(&fan)
        }
    }

    /// Centre, then the neighbours.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(self.centre).chain(self.ring.iter().copied())
    }

    /// Every two of its vertices, the later one first, in the order of a lower triangle.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let earlier = |i: usize| self.vertices().take(i);
        self.vertices()
            .enumerate()
            .flat_map(move |(i, a)| earlier(i).map(move |b| [a, b]))
    }

    /// Mean over the faces, weighted by their area.
    pub(crate) fn mean(&self, rest: &[RestTriangle], value: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for side in &self.fan {
            sum += rest[side.face].area() * value(side.face);
            area += rest[side.face].area();
        }
        sum / area
    }
}
