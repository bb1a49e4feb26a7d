//! The fans of faces around the vertices of a mesh, as stencils of bending.

use std::f64::consts::{PI, TAU};

use ruga_mesh::{EdgeId, FaceId, Id, TriMesh, VertexFan};

use crate::layer_part::rank;
use crate::stencil::FaceCorner;
use crate::{RestTriangle, StarShape};

/// A vertex with its faces, all around it or, on a border, from one border edge to the other.
#[derive(Clone, Debug)]
pub(crate) struct Star {
    /// The faces, counter-clockwise, and the corner of each that is the centre.
    fan: Vec<FaceCorner>,
    is_closed: bool,
    /// Centre, then the neighbours, counter-clockwise.
    pub(crate) vertices: Vec<u32>,
    /// The edges at the centre that two of its faces share, counter-clockwise.
    pub(crate) folds: Vec<Fold>,
}

/// An edge from the centre of a star to one of its neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fold {
    pub(crate) edge: EdgeId,
    /// Tail, head, left and right apex, as its left face winds it, among [`Star::vertices`].
    pub(crate) corners: [u32; 4],
}

/// The stars of all fans with at least two faces.
pub(crate) fn stars(mesh: &TriMesh) -> Vec<Star> {
    let fans = VertexFan::all(mesh).into_iter();
    let stars = fans.map(|fan| Star::new(mesh, fan));
    stars.filter(|star| !star.folds.is_empty()).collect()
}

impl Star {
    fn new(mesh: &TriMesh, fan: VertexFan) -> Self {
        let count = fan.spokes.len() as u32;
        let fold = |(k, &(face, corner)): (u32, &(FaceId, usize))| {
            let edge = mesh.face_edges(face)[corner];
            // The centre is vertex 0 of the star, so that its neighbours count from one.
            let [end, next, last] = [k, (k + 1) % count, (k + count - 1) % count].map(|k| k + 1);
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
        let border = usize::from(!fan.closed);
        let spokes = fan.spokes.iter().map(|v| v.0);
        Self {
            folds: (0..).zip(&fan.faces).skip(border).map(fold).collect(),
            vertices: std::iter::once(fan.vertex.0).chain(spokes).collect(),
            is_closed: fan.closed,
            fan: fan.faces.into_iter().map(FaceCorner::new).collect(),
        }
    }

    /// The star in a part of the layer, which has these `vertices`.
    pub(crate) fn part(&self, vertices: &[u32]) -> Self {
        Self {
            fan: self.fan.iter().map(|side| side.of_no_face()).collect(),
            is_closed: self.is_closed,
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
        if self.is_closed {
            StarShape::closed(&fan)
        } else {
            StarShape::open(&fan)
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
        let border = usize::from(!self.is_closed);
        let [first, last] = [from.min(to), from.max(to)].map(|fold| fold as usize + border);
        let between: f64 = angles[first..last].iter().sum();
        let scale = match self.is_closed {
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
