//! Material, strain ratio and energy of a layer, face by face.

use ruga_mesh::{FaceId, Id, PerFace, face_areas};
use ruga_shell::EnergyParts;

use super::Layer;
use crate::FaceState;
use crate::run::strain_ratio::applied;
use crate::skin::local_skin::LocalSkin;

impl Layer {
    /// States of the output mesh's faces: the layer's, then those of a layer that moves together with it.
    pub(crate) fn face_states(&self) -> Vec<Vec<FaceState>> {
        let computed = self.computed_states().into_iter();
        computed
            .map(|states| self.states_on_region(states))
            .collect()
    }

    /// States of the faces of the layer's own mesh.
    fn computed_states(&self) -> Vec<PerFace<FaceState>> {
        let below = &self.support.posed.positions;
        let energies = self.energy.face_energies(&self.positions, below);
        // Per area at rest: the rest metric of the energy may be one that was shrunk.
        let areas = face_areas(&self.skin.mesh, &self.skin.rest.positions);
        let of_sheet = |(sheet, energies): (usize, Vec<EnergyParts>)| {
            let state = |face: FaceId| {
                let local = match (&self.upper, sheet) {
                    (Some(upper), 1) => &upper.local,
                    _ => self.properties.on_face(face),
                };
                self.face_state(face, local, &energies[face.index()], areas[face])
            };
            areas.ids().map(state).collect()
        };
        energies.into_iter().enumerate().map(of_sheet).collect()
    }

    fn face_state(
        &self,
        face: FaceId,
        local: &LocalSkin,
        energy: &EnergyParts,
        area: f64,
    ) -> FaceState {
        let strain = &self.strains[face];
        let [first, second] = applied(
            strain,
            self.absorption.share(face, strain),
            self.fractions[face],
        );
        let critical_strain = local.wrinkling.critical_strain;
        FaceState {
            strain_ratio: (first + local.material.poisson * second) / critical_strain,
            critical_strain,
            wavelength: local.wrinkling.wavelength,
            young: local.material.young,
            thickness: local.material.thickness,
            membrane_energy: energy.membrane / area,
            bending_energy: energy.bending / area,
            foundation_energy: (energy.normal + energy.gradient + energy.tangential) / area,
        }
    }

    fn states_on_region(&self, states: PerFace<FaceState>) -> Vec<FaceState> {
        let Some(interpolation) = self.interpolation() else {
            return states.into_vec();
        };
        let places = interpolation.places();
        let faces = self.region().skin.corner_indices().into_iter();
        faces
            .map(|corners| FaceState::mean(corners.map(|v| &states[places[v as usize].face])))
            .collect()
    }
}
