//! What layers lie on: the posed driver, or a soft body that moves with them.

mod body;
pub(crate) mod contact;
pub(crate) mod embedding_lattice;
mod flesh;
pub(crate) mod handles;
mod interior;
pub(crate) mod lattice_size;
mod layout;
mod line_anchors;
mod mass;
pub(crate) mod motion;
pub(crate) mod obstacle;
pub(crate) mod placement;
mod prediction;
mod slit_carving;
mod solid;
mod springs;
pub(crate) mod support_surface;
pub(crate) mod surface_below;

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{PosedSurface, SurfacePoints};
use ruga_lattice::Embedding;

use crate::skin::identity::Mark;
use crate::skin::skin_mesh::SkinMesh;

pub use body::{Body, Handle, Keyframe, Motion, Obstacle, ObstacleShape};
pub(crate) use handles::Moves;
pub(crate) use interior::Interior;
pub(crate) use solid::{Frozen, Solid, SolidState};

/// A surface that gives position and normal at every material point of the skin.
pub(crate) trait Support {
    /// The vertices of `skin`, without its offset, on this surface.
    fn under<'s>(&'s self, skin: &'s SkinMesh) -> Box<dyn Under + 's>;

    /// Positions (m), unit normals and tangents at the vertices of `skin`, without its offset.
    fn pose(&self, skin: &SkinMesh) -> PosedSurface {
        self.under(skin).pose(0..skin.mesh.vertex_count())
    }
}

/// What carries a mesh, at some of its vertices at a time.
pub(crate) trait Under: Sync {
    /// Positions (m), unit normals and tangents at the vertices with these numbers.
    fn pose(&self, vertices: Range<usize>) -> PosedSurface;

    /// Two tangents at each of them that move with the material, m: how the surface changes with the
    /// barycentric coordinates of the driver's face there.
    fn derivatives(&self, vertices: Range<usize>) -> Vec<[Vector3<f64>; 2]>;
}

/// The driver under blend shapes.
pub(crate) struct PosedDriver {
    /// Positions of its vertices, m.
    pub(crate) control: Vec<Vector3<f64>>,
}

impl Support for PosedDriver {
    fn under<'s>(&'s self, skin: &'s SkinMesh) -> Box<dyn Under + 's> {
        Box::new(OnDriver {
            points: &skin.points,
            control: &self.control,
        })
    }
}

struct OnDriver<'s> {
    points: &'s SurfacePoints,
    control: &'s [Vector3<f64>],
}

impl Under for OnDriver<'_> {
    fn pose(&self, vertices: Range<usize>) -> PosedSurface {
        self.points.pose_some(vertices, self.control)
    }

    fn derivatives(&self, vertices: Range<usize>) -> Vec<[Vector3<f64>; 2]> {
        self.points.some_derivatives(vertices, self.control)
    }
}

/// The surface of a soft body.
pub(crate) struct PosedBody<'a> {
    pub(crate) interior: &'a Interior,
    /// Rest positions of the driver's vertices, m.
    pub(crate) rest: &'a [Vector3<f64>],
    /// Positions of the lattice's nodes, m.
    pub(crate) q: Vec<Vector3<f64>>,
    pub(crate) embeddings: Rc<Embeddings>,
}

impl Support for PosedBody<'_> {
    fn under<'s>(&'s self, skin: &'s SkinMesh) -> Box<dyn Under + 's> {
        Box::new(OnBody {
            points: &skin.points,
            rest: self.rest,
            embedding: self.embeddings.of(self.interior, skin, self.rest),
            nodes: self.interior.embedding_lattice.lattice.rest_positions(),
            posed: &self.q,
        })
    }
}

struct OnBody<'s> {
    points: &'s SurfacePoints,
    rest: &'s [Vector3<f64>],
    embedding: Arc<Embedding>,
    /// Positions of the lattice's nodes at rest and now, m.
    nodes: &'s [Vector3<f64>],
    posed: &'s [Vector3<f64>],
}

impl Under for OnBody<'_> {
    fn pose(&self, vertices: Range<usize>) -> PosedSurface {
        let before = self.points.pose_some(vertices.clone(), self.rest);
        posed((&self.embedding, vertices), self.posed, &before)
    }

    fn derivatives(&self, vertices: Range<usize>) -> Vec<[Vector3<f64>; 2]> {
        let of = |q| tangents((&self.embedding, vertices.clone()), q);
        let [of_rest, of_posed] = [self.nodes, self.posed].map(of);
        let along = self.points.some_derivatives(vertices.clone(), self.rest);
        // The rest tangents are orthonormal: a tangent's coordinates in them stay what they are.
        let turned = along.into_iter().enumerate().map(|(i, pair)| {
            pair.map(|tangent| {
                (0..2)
                    .map(|k| of_posed[k][i] * of_rest[k][i].dot(&tangent))
                    .sum()
            })
        });
        turned.collect()
    }
}

/// The derivatives of some embedded positions along two tangents of the rest surface.
fn tangents(
    (embedding, points): (&Embedding, Range<usize>),
    q: &[Vector3<f64>],
) -> [Vec<Vector3<f64>>; 2] {
    let rows = embedding.tangent_rows().each_ref();
    rows.map(|rows| rows.apply_some(points.clone(), q))
}

/// Some points of an embedded surface with the nodes at `q` (m); where it has collapsed, with the frame of `before`.
pub(crate) fn posed(
    (embedding, points): (&Embedding, Range<usize>),
    q: &[Vector3<f64>],
    before: &PosedSurface,
) -> PosedSurface {
    let [first, second] = tangents((embedding, points.clone()), q);
    let frame = |i: usize| {
        let tangent = first[i].try_normalize(0.0);
        let normal = first[i].cross(&second[i]).try_normalize(0.0);
        // What has collapsed has no normal, and a solve may pass through such a state. The frame
        // before serves until it has one again.
        let found = tangent.zip(normal);
        found.unwrap_or((before.tangents[i], before.normals[i]))
    };
    let (tangents, normals) = (0..first.len()).map(frame).unzip();
    PosedSurface {
        positions: embedding.rows().apply_some(points, q),
        normals,
        tangents,
    }
}

/// The embeddings of meshes that still exist.
#[derive(Debug, Default)]
pub(crate) struct Embeddings {
    known: RefCell<Vec<(Mark, Arc<Embedding>)>>,
}

impl Embeddings {
    /// That of `skin` in a body whose surface has these control points at `rest`, m.
    fn of(&self, interior: &Interior, skin: &SkinMesh, rest: &[Vector3<f64>]) -> Arc<Embedding> {
        let mut known = self.known.borrow_mut();
        known.retain(|(mark, _)| !mark.is_stale());
        if let Some((_, found)) = known.iter().find(|(mark, _)| mark.is_of(&skin.identity)) {
            return Arc::clone(found);
        }
        let points = skin.points.points();
        let made = interior
            .embedding_lattice
            .embed(points, &skin.points.pose(rest));
        let made =
            Arc::new(made.expect("points of the driver have finite places and unit normals"));
        known.push((skin.identity.mark(), Arc::clone(&made)));
        made
    }
}
