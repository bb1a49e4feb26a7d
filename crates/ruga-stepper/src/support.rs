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

use std::cell::RefCell;
use std::rc::Rc;

use nalgebra::Vector3;
use ruga_blend::PosedSurface;
use ruga_lattice::Embedding;

use crate::skin::identity::Mark;
use crate::skin::skin_mesh::SkinMesh;

pub use body::{Body, Handle, Keyframe, Motion, Obstacle, ObstacleShape};
pub(crate) use handles::Moves;
pub(crate) use interior::Interior;
pub(crate) use solid::{Frozen, Solid, SolidState};

/// A surface that gives position and normal at every material point of the skin.
pub(crate) trait Support {
    /// Positions (m), unit normals and tangents at the vertices of `skin`, without its offset.
    fn pose(&self, skin: &SkinMesh) -> PosedSurface;

    /// Two tangents at every vertex that move with the material, m: how the surface changes with the
    /// barycentric coordinates of the driver's face there.
    fn derivatives(&self, skin: &SkinMesh) -> Vec<[Vector3<f64>; 2]>;
}

/// The driver under blend shapes.
pub(crate) struct PosedDriver {
    /// Positions of its vertices, m.
    pub(crate) control: Vec<Vector3<f64>>,
}

impl Support for PosedDriver {
    fn pose(&self, skin: &SkinMesh) -> PosedSurface {
        skin.points.pose(&self.control)
    }

    fn derivatives(&self, skin: &SkinMesh) -> Vec<[Vector3<f64>; 2]> {
        skin.points.derivatives(&self.control)
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
    fn pose(&self, skin: &SkinMesh) -> PosedSurface {
        let rest = skin.points.pose(self.rest);
        let embedding = self.embeddings.of(self.interior, skin, &rest);
        posed(&embedding, &self.q, &rest)
    }

    fn derivatives(&self, skin: &SkinMesh) -> Vec<[Vector3<f64>; 2]> {
        let rest = skin.points.pose(self.rest);
        let embedding = self.embeddings.of(self.interior, skin, &rest);
        let lattice = self.interior.embedding_lattice.lattice.rest_positions();
        let [of_rest, of_posed] = [lattice, self.q.as_slice()].map(|q| tangents(&embedding, q));
        let along = skin.points.derivatives(self.rest).into_iter().enumerate();
        // The rest tangents are orthonormal: a tangent's coordinates in them stay what they are.
        let turned = along.map(|(i, pair)| {
            pair.map(|tangent| {
                (0..2)
                    .map(|k| of_posed[k][i] * of_rest[k][i].dot(&tangent))
                    .sum()
            })
        });
        turned.collect()
    }
}

/// The derivatives of embedded positions along two tangents of the rest surface.
fn tangents(embedding: &Embedding, q: &[Vector3<f64>]) -> [Vec<Vector3<f64>>; 2] {
    [0, 1].map(|k| embedding.tangent_rows()[k].apply(q))
}

/// An embedded surface with the nodes at `q` (m); where it has collapsed, with the frame of `before`.
pub(crate) fn posed(
    embedding: &Embedding,
    q: &[Vector3<f64>],
    before: &PosedSurface,
) -> PosedSurface {
    let [first, second] = tangents(embedding, q);
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
        positions: embedding.positions(q),
        normals,
        tangents,
    }
}

/// The embeddings of meshes that still exist.
#[derive(Debug, Default)]
pub(crate) struct Embeddings {
    known: RefCell<Vec<(Mark, Rc<Embedding>)>>,
}

impl Embeddings {
    /// That of `skin`, whose points are at `rest` without an offset.
    fn of(&self, interior: &Interior, skin: &SkinMesh, rest: &PosedSurface) -> Rc<Embedding> {
        let mut known = self.known.borrow_mut();
        known.retain(|(mark, _)| !mark.is_stale());
        if let Some((_, found)) = known.iter().find(|(mark, _)| mark.is_of(&skin.identity)) {
            return Rc::clone(found);
        }
        let made = interior.embedding_lattice.embed(skin.points.points(), rest);
        let made = Rc::new(made.expect("points of the driver have finite places and unit normals"));
        known.push((skin.identity.mark(), Rc::clone(&made)));
        made
    }
}
