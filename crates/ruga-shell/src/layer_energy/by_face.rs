//! The energy of a layer, face by face.

use nalgebra::Vector3;

use super::LayerEnergy;
use crate::EnergyParts;

impl LayerEnergy {
    /// Energy (J) of every face by origin, with the surface below at `points` (m) and with its present normals:
    /// a list per sheet, the lower one first.
    ///
    /// The sum over all faces of all sheets is that of [`Self::energy_parts`], where `points` are those that
    /// were set: a vertex, an edge or the star of a vertex shares its energy among its faces. The springs
    /// between two sheets ([`Self::spring_parts`]) belong to neither, and line anchors to no face: both are left
    /// out.
    pub fn face_energies(
        &self,
        x: &[Vector3<f64>],
        points: &[Vector3<f64>],
    ) -> Vec<Vec<EnergyParts>> {
        self.check(x);
        let mut sheets: Vec<_> = self
            .sheets
            .iter()
            .map(|sheet| sheet.face_values(x))
            .collect();
        let anchors = self.foundation.anchors_at(points);
        self.foundation
            .add_to_faces(self.lower(), &anchors, x, &mut sheets[0]);
        sheets
    }
}
