//! Balance of pieces as a whole.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use petgraph::unionfind::UnionFind;
use ruga_mesh::Id;

use super::objective::SheetObjective;

impl SheetObjective<'_> {
    /// Moves every piece that nothing holds or touches to where its weight and its inertia balance: to the least of
    /// `w/2 m (x - c)^2 - m g . x` among all places that it can be moved to as it is.
    ///
    /// Forces within a piece do not change with its place. A solve ends where the energy of everything hardly changes,
    /// which leaves of this balance, and so of the momentum, more than a loose piece should take along.
    pub(super) fn balance(&self, positions: &mut [Vector3<f64>]) {
        let Some(inertia) = self.inertia else {
            return;
        };
        let mut pieces = UnionFind::new(positions.len());
        for edge in self.mesh.edges().as_slice() {
            let [a, b] = edge.vertices.map(|v| v.index());
            pieces.union(a, b);
        }
        let mut is_loose = vec![false; positions.len()];
        for v in self.free {
            let (i, x) = (v.index(), &positions[v.index()]);
            is_loose[i] = self.contact.hessian(x, self.areas[i]).is_none();
        }
        // Force (N), stiffness (N/m), and whether all of its vertices are loose.
        let mut loads: BTreeMap<usize, (Vector3<f64>, f64, bool)> = BTreeMap::new();
        for (i, x) in positions.iter().enumerate() {
            let weight = inertia.weight(self.masses[i]);
            let force = self.gravity * self.masses[i] - (x - inertia.centres[i]) * weight;
            let start = (Vector3::zeros(), 0.0, true);
            let load = loads.entry(pieces.find(i)).or_insert(start);
            load.0 += force;
            load.1 += weight;
            load.2 &= is_loose[i];
        }
        for (i, x) in positions.iter_mut().enumerate() {
            match loads[&pieces.find(i)] {
                (force, stiffness, true) if stiffness > 0.0 => *x += force / stiffness,
                _ => {}
            }
        }
    }
}
