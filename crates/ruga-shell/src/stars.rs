//! The fans of faces around the vertices of a mesh, as stencils of bending.

use std::f64::consts::{PI, TAU};

use ruga_mesh::{EdgeId, FaceId, Id, TriMesh, VertexFan, VertexId};

use crate::layer_part::rank;
use crate::stencil::FaceCorner;
use crate::{RestTriangle, StarShape};

/// How far the faces of a star go around its vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Extent {
    /// All around.
    Closed,
    /// From one border edge to the other.
    Open,
    /// From one edge on a plane of symmetry to the other, and on as the mirror image of these faces.
    Mirrored,
}

/// A vertex with its faces, all around it or, on a border, from one border edge to the other.
#[derive(Clone, Debug)]
pub(crate) struct Star {
    /// The faces, counter-clockwise, and the corner of each that is the centre.
    fan: Vec<FaceCorner>,
    extent: Extent,
    /// Centre, then the neighbours, counter-clockwise.
    pub(crate) vertices: Vec<u32>,
    /// The edges at the centre that two of its faces share, or one and its mirror image, counter-clockwise.
    pub(crate) folds: Vec<Fold>,
}

/// An edge from the centre of a star to one of its neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fold {
    pub(crate) edge: EdgeId,
    /// Tail, head, left and right apex, as its left face winds it, among [`Star::vertices`].
    pub(crate) corners: [u32; 4],
}

/// The stars of all fans with at least two faces, or with one that goes on as its mirror image because the border
/// edges are `on_plane` (empty for no plane).
pub(crate) fn stars(mesh: &TriMesh, on_plane: &[bool]) -> Vec<Star> {
    let is_on_plane = |v: VertexId| on_plane.get(v.index()).copied().unwrap_or(false);
    let fans = VertexFan::all(mesh).into_iter();
    let stars = fans.map(|fan| {
        let ends = [fan.spokes[0], fan.spokes[fan.spokes.len() - 1], fan.vertex];
        let extent = match fan.closed {
            true => Extent::Closed,
            false if ends.into_iter().all(is_on_plane) => Extent::Mirrored,
            false => Extent::Open,
        };
        Star::new(mesh, fan, extent)
    });
    stars.filter(|star| !star.folds.is_empty()).collect()
}

impl Star {
    fn new(mesh: &TriMesh, fan: VertexFan, extent: Extent) -> Self {
        let count = fan.spokes.len() as u32;
        let fold = |(k, &(face, corner)): (u32, &(FaceId, usize))| {
            let edge = mesh.face_edges(face)[corner];
            // The centre is vertex 0 of the star, so that its neighbours count from one.
            let before = match (k, extent) {
                // Mirror image of the next one.
                (0, Extent::Mirrored) => 1,
                _ => (k + count - 1) % count,
            };
            let [end, next, last] = [k, (k + 1) % count, before].map(|k| k + 1);
            // The angle's derivatives come in the order of the hinge, which has the edge's own
            // direction: out of this star or into it.
            let is_outward = mesh.edges()[edge].faces[0] == Some(face);
            Fold {
                edge,
                corners: if is_outward {
                    [0, end, next, last]
                } else {
                    [end, 0, last, next]
                },
            }
        };
        // An open fan's first face begins at a border edge, which has no angle.
        let border = usize::from(extent == Extent::Open);
        let mut folds: Vec<Fold> = (0..).zip(&fan.faces).skip(border).map(fold).collect();
        if let (Extent::Mirrored, Some(&(face, corner))) = (extent, fan.faces.last()) {
            // The last face's other edge, which it winds towards the centre.
            folds.push(Fold {
                edge: mesh.face_edges(face)[(corner + 2) % 3],
                corners: [count, 0, count - 1, count - 1],
            });
        }
        let spokes = fan.spokes.iter().map(|v| v.0);
        Self {
            folds,
            vertices: std::iter::once(fan.vertex.0).chain(spokes).collect(),
            extent,
            fan: fan.faces.into_iter().map(FaceCorner::new).collect(),
        }
    }

    /// The star in a part of the layer, which has these `vertices`.
    pub(crate) fn part(&self, vertices: &[u32]) -> Self {
        Self {
            fan: self.fan.iter().map(|side| side.of_no_face()).collect(),
            extent: self.extent,
            vertices: self.vertices.iter().map(|&v| rank(vertices, v)).collect(),
            folds: self.folds.clone(),
        }
    }

    /// The star as its rest triangles show it.
    pub(crate) fn shape(&self, rest: &[RestTriangle]) -> StarShape {
        let fan = self.fan.iter().map(|side| side.pair());
        let fan: Vec<_> = fan
            .map(|(face, corner)| (rest[face.index()], corner))
            .collect();
        match self.extent {
            Extent::Closed => StarShape::closed(&fan),
            Extent::Open => StarShape::open(&fan),
            Extent::Mirrored => StarShape::mirrored(&fan),
        }
    }

    /// The faces, each with its part of their area.
    pub(crate) fn shares(&self, rest: &[RestTriangle]) -> impl Iterator<Item = (usize, f64)> {
        let faces = self.fan.iter().map(|side| side.pair().0.index());
        let whole: f64 = faces.clone().map(|face| rest[face].area()).sum();
        faces.map(move |face| (face, rest[face].area() / whole))
    }

    /// Angle (rad), from 0 to pi, by which a line turns at the centre that comes in on one inner edge and goes
    /// out on another, in the plane of [`StarShape`].
    pub(crate) fn turn(&self, rest: &[RestTriangle], [from, to]: [u32; 2]) -> f64 {
        let angle = |side: &FaceCorner| {
            let (face, corner) = side.pair();
            let (length, foot, height) = rest[face.index()].seen_from_edge(corner);
            height.atan2(foot * length)
        };
        let angles: Vec<_> = self.fan.iter().map(angle).collect();
        // Inner edge `k` is the one at which face `k` begins, but for the first face at a border.
        let border = usize::from(self.extent == Extent::Open);
        let [first, last] = [from.min(to), from.max(to)].map(|fold| fold as usize + border);
        let between: f64 = angles[first..last].iter().sum();
        let scale = match self.extent == Extent::Closed {
            true => TAU / angles.iter().sum::<f64>(),
            false => 1.0,
        };
        (PI - scale * between).abs()
    }

    /// Mean over the faces, weighted by their area.
    pub(crate) fn mean(&self, rest: &[RestTriangle], value: impl Fn(usize) -> f64) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for side in &self.fan {
            let face = side.pair().0.index();
            sum += rest[face].area() * value(face);
            area += rest[face].area();
        }
        sum / area
    }
}
