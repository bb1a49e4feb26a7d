//! Springs against sliding that differs from place to place.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{BlockPattern, Id};

use super::LayerFoundation;
use crate::foundation::Anchor;
use crate::sheet::Sheet;
use crate::{EnergyParts, ShellError};

impl LayerFoundation {
    /// Sets `Kg` (N/m) of the energy on the gradient of the drifts `t` ([`Anchor::drift`]),
    ///
    /// ```text
    /// E = 1/2 Kg int |grad t|^2 = -1/2 sum_edges m_ij |t_i - t_j|^2,   m_ij = Kg sum_faces A grad phi_i . grad phi_j
    /// ```
    pub(crate) fn set_slide_gradient(
        &mut self,
        stiffness: f64,
        sheet: &Sheet,
    ) -> Result<(), ShellError> {
        if !(stiffness >= 0.0 && stiffness.is_finite()) {
            return Err(ShellError::SlideGradient { value: stiffness });
        }
        self.slide_gradient = stiffness;
        self.set_slides(sheet);
        Ok(())
    }

    /// Recomputes the edges' stiffness for the sheet's present rest metric.
    pub(super) fn set_slides(&mut self, sheet: &Sheet) {
        let (rest, left) = (sheet.rest(), sheet.area_left());
        for edge in &mut self.edges {
            // A layer that has none does not pay for it.
            if self.slide_gradient == 0.0 {
                edge.slide = 0.0;
                continue;
            }
            let entry = |(face, corner): (ruga_mesh::FaceId, usize)| {
                let face = face.index();
                let gradients = rest[face].shape_gradients();
                left[face] * rest[face].area() * gradients[corner].dot(&gradients[(corner + 1) % 3])
            };
            let sides = edge.sides.iter().flatten().map(|side| side.pair());
            edge.slide = self.slide_gradient * sides.map(entry).sum::<f64>();
        }
    }

    /// Energy (J).
    pub(super) fn slide_value(&self, anchors: &[Anchor], x: &[Vector3<f64>]) -> f64 {
        let Some(drifts) = self.drifts(anchors, x) else {
            return 0.0;
        };
        let edges = self.edges.iter();
        edges.map(|edge| edge.slide_value(&drifts)).sum()
    }

    /// Adds the energies (J) to the faces, half of an edge's to each of two.
    pub(super) fn add_slides_to_faces(
        &self,
        anchors: &[Anchor],
        x: &[Vector3<f64>],
        parts: &mut [EnergyParts],
    ) {
        let Some(drifts) = self.drifts(anchors, x) else {
            return;
        };
        for edge in &self.edges {
            let faces = edge.sides.iter().flatten();
            let share = edge.slide_value(&drifts) / faces.clone().count() as f64;
            for side in faces {
                parts[side.pair().0.index()].tangential += share;
            }
        }
    }

    /// Adds the derivative of the energy by `x` (N).
    pub(super) fn add_slide_forces(
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
            let pull = (drifts[j] - drifts[i]) * edge.slide;
            forces[i] += anchors[i].across(&pull);
            forces[j] -= anchors[j].across(&pull);
        }
    }

    /// Adds the second derivative, in the order of `pattern`.
    pub(super) fn add_slide_hessian(&self, pattern: &BlockPattern, values: &mut [f64]) {
        if self.slide_gradient == 0.0 {
            return;
        }
        let across = |v: u32| {
            let n = self.anchors[v as usize].normal;
            Matrix3::identity() - n * n.transpose()
        };
        let mut diagonal = vec![0.0; self.anchors.len()];
        for edge in &self.edges {
            let [tail, head] = edge.ends;
            for end in edge.ends {
                diagonal[end as usize] -= edge.slide;
            }
            let block = across(head) * across(tail) * edge.slide;
            edge.slot.add(values, &block);
        }
        for (vertex, stiffness) in (0..).zip(diagonal) {
            let block = across(vertex) * stiffness;
            pattern.slot(vertex, vertex).add(values, &block);
        }
    }

    /// Drifts of all vertices (m); `None` where nothing asks for them.
    fn drifts(&self, anchors: &[Anchor], x: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let drift = |(anchor, x): (&Anchor, &Vector3<f64>)| anchor.drift(x);
        (self.slide_gradient != 0.0).then(|| anchors.iter().zip(x).map(drift).collect())
    }
}

impl super::EdgeSprings {
    fn slide_value(&self, drifts: &[Vector3<f64>]) -> f64 {
        let [i, j] = self.ends.map(|v| v as usize);
        -0.5 * self.slide * (drifts[i] - drifts[j]).norm_squared()
    }
}
