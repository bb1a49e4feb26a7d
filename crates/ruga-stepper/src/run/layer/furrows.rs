//! How creases that fold draw the layer down, and up beside them, where averages are taken of it.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_material::crease_fold;
use ruga_mesh::{FaceId, Id, VertexId};

use super::Layer;
use super::pulls::DrawnDown;

impl Layer {
    /// How far down (m) the furrows of creases lie in the mean, by vertices.
    ///
    /// A line folded by an angle `φ` draws the film as a load `D φ δ''` across it does. The foundation carries that
    /// load, which has no sum but sinks the line and lifts the skin beside it; averages over little more than a furrow
    /// feel it, and held at zero they would take a fortieth of the depth. Lines that take up compression are left out,
    /// because little carries the skin beside them.
    pub(super) fn furrows(&self) -> DrawnDown {
        let (mesh, rest) = (&self.skin.mesh, &self.skin.rest.positions);
        let mut bends: BTreeMap<usize, f64> = BTreeMap::new();
        for (rank, crease) in self.skin.creases.iter().enumerate() {
            if self.spec.creases[crease.line].absorbs {
                continue;
            }
            let ends = mesh.edges()[crease.edge].vertices;
            let [from, to] = ends.map(|v| rest[v.index()]);
            let bend = 0.5 * (to - from).norm() * self.bend(rank);
            for v in ends {
                *bends.entry(v.index()).or_default() += bend;
            }
        }
        let mut forces: BTreeMap<usize, f64> = BTreeMap::new();
        for (u, bend) in bends.into_iter().filter(|(_, bend)| *bend != 0.0) {
            let faces = mesh.vertex_faces(VertexId::from_index(u)).iter();
            let spokes: Vec<_> = faces.flat_map(|&face| self.spokes(face, u)).collect();
            let area: f64 = spokes.iter().map(|(_, _, area)| area).sum();
            // The second derivative of what is averaged, by the Laplace operator of the mesh.
            for (v, weight, _) in spokes {
                let force = bend / area * weight;
                *forces.entry(v).or_default() += force;
                *forces.entry(u).or_default() -= force;
            }
        }
        let way = |(v, force): (usize, f64)| (v, -force / self.carrying(v));
        let ways = forces.into_iter().map(way);
        // Where nothing carries the skin there is no mean to tell.
        ways.filter(|(_, way)| way.is_finite()).collect()
    }

    /// The two edges of a face at a vertex: other end, weight in the cotangent Laplacian, and a sixth of the face's
    /// area (m²).
    fn spokes(&self, face: FaceId, vertex: usize) -> [(usize, f64, f64); 2] {
        let corners = self.skin.mesh.faces()[face].map(Id::index);
        let at = corners.iter().position(|v| *v == vertex).unwrap_or(0);
        let [own, next, last] = [0, 1, 2].map(|k| corners[(at + k) % 3]);
        let [x, y, z] = [own, next, last].map(|v| self.skin.rest.positions[v]);
        let twice = (y - x).cross(&(z - x)).norm();
        let half_cotangent = |[at, a, b]: [Vector3<f64>; 3]| 0.5 * (a - at).dot(&(b - at)) / twice;
        [
            (next, half_cotangent([z, x, y]), twice / 12.0),
            (last, half_cotangent([y, z, x]), twice / 12.0),
        ]
    }

    /// Bending stiffness of the skin beside an edge on a crease times the angle by which the linear theory of one
    /// straight line says that it folds, N m.
    fn bend(&self, rank: usize) -> f64 {
        let anchor = self.drawn_anchor(rank).map_or((0.0, 0.0), |anchor| {
            (
                anchor.stiffness,
                0.5 * (anchor.depths[0] + anchor.depths[1]),
            )
        });
        self.beside(self.skin.creases[rank].edge, |face| {
            let load = self.crease_load(rank, face, anchor);
            self.wrinkling(face).bending_stiffness * crease_fold(&load)
        })
    }
}
