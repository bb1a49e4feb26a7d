//! Springs on the gradient of the drift: against sliding that differs from place to place.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::Id;

use super::{EdgeSprings, LayerFoundation};
use crate::foundation::{Anchor, NormalFoundation};
use crate::sheet::Sheet;
use crate::{EnergyParts, RestTriangle, ShellError};

impl LayerFoundation {
    /// Sets `Kg` (N/m) of the energy on the gradient of the drifts `t` ([`Anchor::drift`]),
    ///
    /// ```text
    /// E = 1/2 Kg int |grad t|^2 = -1/2 sum_edges m_ij |t_i - t_j|^2,   m_ij = Kg sum_faces A grad phi_i . grad phi_j
    /// ```
    pub(crate) fn set_drift_gradient(
        &mut self,
        stiffness: f64,
        sheet: &Sheet,
    ) -> Result<(), ShellError> {
        if !(stiffness >= 0.0 && stiffness.is_finite()) {
            return Err(ShellError::DriftGradient { value: stiffness });
        }
        self.drift_gradient = stiffness;
        self.set_drift_rest(sheet);
        Ok(())
    }

    /// Recomputes the stiffness between drifts for the sheet's present rest metric.
    pub(super) fn set_drift_rest(&mut self, sheet: &Sheet) {
        self.drift_diagonal.clear();
        // A layer that has none does not pay for it.
        if self.drift_gradient == 0.0 {
            self.edges.iter_mut().for_each(|edge| edge.drift = 0.0);
            return;
        }
        let pairs = sheet.rest().iter().zip(sheet.area_left());
        let matrices: Vec<_> = pairs.map(|pair| self.of_face(pair).matrix()).collect();
        self.drift_diagonal.resize(self.anchors.len(), 0.0);
        for (face, matrix) in sheet.faces().iter().zip(&matrices) {
            for (corner, &vertex) in face.iter().enumerate() {
                self.drift_diagonal[vertex as usize] += matrix[(corner, corner)];
            }
        }
        for edge in &mut self.edges {
            let sides = edge.sides.iter().flatten().map(|side| side.pair());
            let entries =
                sides.map(|(face, corner)| matrices[face.index()][(corner, (corner + 1) % 3)]);
            edge.drift = entries.sum();
        }
    }

    /// A drift's energy in one direction, of a face with this share of its area left.
    fn of_face(&self, (rest, left): (&RestTriangle, &f64)) -> NormalFoundation {
        NormalFoundation::new(rest, 0.0, left * self.drift_gradient)
    }

    /// Energy (J).
    pub(super) fn drift_value(&self, anchors: &[Anchor], x: &[Vector3<f64>]) -> f64 {
        let Some(drifts) = self.drifts(anchors, x) else {
            return 0.0;
        };
        let of_edge = |edge: &EdgeSprings| {
            let [i, j] = edge.ends.map(|v| v as usize);
            -0.5 * edge.drift * (drifts[i] - drifts[j]).norm_squared()
        };
        self.edges.iter().map(of_edge).sum()
    }

    /// Adds every face's own energy (J).
    pub(super) fn add_drifts_to_faces(
        &self,
        sheet: &Sheet,
        anchors: &[Anchor],
        x: &[Vector3<f64>],
        parts: &mut [EnergyParts],
    ) {
        let Some(drifts) = self.drifts(anchors, x) else {
            return;
        };
        let rest = sheet.rest().iter().zip(sheet.area_left());
        for ((face, pair), parts) in sheet.faces().iter().zip(rest).zip(parts) {
            let stencil = self.of_face(pair);
            let [a, b, c] = face.map(|v| drifts[v as usize]);
            for ((a, b), c) in a.iter().zip(&b).zip(&c) {
                let [_, energy] = stencil.values([*a, *b, *c]);
                parts.tangential += energy;
            }
        }
    }

    /// Adds the derivative of the energy by `x` (N).
    pub(super) fn add_drift_forces(
        &self,
        anchors: &[Anchor],
        x: &[Vector3<f64>],
        forces: &mut [Vector3<f64>],
    ) {
        let Some(drifts) = self.drifts(anchors, x) else {
            return;
        };
        for edge in &self.edges {
            let [i, j] = edge.ends.map(|v| v as usize);
            let pull = (drifts[j] - drifts[i]) * edge.drift;
            forces[i] += anchors[i].across(&pull);
            forces[j] -= anchors[j].across(&pull);
        }
    }

    /// Block of a vertex in the second derivative (N/m).
    pub(super) fn drift_block(&self, vertex: usize) -> Matrix3<f64> {
        let stiffness = self.drift_diagonal.get(vertex);
        stiffness.map_or_else(Matrix3::zeros, |stiffness| {
            self.anchors[vertex].across_matrix() * *stiffness
        })
    }

    /// Block of an edge in the second derivative (N/m), rows of its head and columns of its tail.
    pub(super) fn drift_edge_block(&self, edge: &EdgeSprings) -> Matrix3<f64> {
        if edge.drift == 0.0 {
            return Matrix3::zeros();
        }
        let [tail, head] = edge.ends.map(|v| self.anchors[v as usize].across_matrix());
        head * tail * edge.drift
    }

    /// Drifts of all vertices (m); `None` where nothing asks for them.
    fn drifts(&self, anchors: &[Anchor], x: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let drift = |(anchor, x): (&Anchor, &Vector3<f64>)| anchor.drift(x);
        (self.drift_gradient != 0.0).then(|| anchors.iter().zip(x).map(drift).collect())
    }
}
