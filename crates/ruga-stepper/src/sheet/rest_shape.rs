//! What growth and fire make of a sheet: its rest shape, its material, and what is left of it.

use nalgebra::Matrix2;
use ruga_blend::Driver;
use ruga_mesh::{FaceId, Id, PerFace};

use super::burning::{Burning, FireState, Remains};
use super::meshed::lumped;
use super::pieces::{Around, let_go, stands};
use super::plan::longest_side;
use super::standing::Standing;
use super::state::{Moving, SheetState, shell_error};
use crate::growth::PoseGrowth;
use crate::support::Moves;
use crate::support::motion::Inertia;
use crate::{FireReport, PoseSpec, StepperError};

impl<'a> SheetState<'a> {
    /// Lets it burn during a step in time, and takes away what has burnt; gives what is left of every face, or `None`
    /// without a fire.
    pub(super) fn burn(
        &mut self,
        (moves, times): (&Moves<'_>, [f64; 2]),
        inertia: Option<&Inertia>,
    ) -> Result<Option<PerFace<Remains>>, StepperError> {
        let Moving {
            positions, burning, ..
        } = &mut self.moving;
        let (Some(fire), Some(burning), Some(inertia)) = (&mut self.fire, burning, inertia) else {
            return Ok(None);
        };
        let skin = &self.meshed.skin;
        let rest = &skin.rest.positions;
        let heated = match &self.fitting {
            // What is gone goes along with what is left beside it, or a place between the two would be nowhere.
            Some(fitting) => {
                let standing = &self.meshed.standing;
                &fitting.linear(&standing.carried(&skin.mesh, rest, positions))
            }
            None => &*positions,
        };
        fire.advance(
            burning,
            (&self.region.skin.mesh, heated),
            (moves, times),
            inertia.time_step(),
        )?;
        let around = Around {
            mesh: &skin.mesh,
            rest,
            positions,
            held: &self.meshed.held,
            side: longest_side(rest),
            least: fire.least_piece(),
        };
        let remains = let_go(fire, burning, &around)?;
        let standing = skin
            .mesh
            .faces()
            .ids()
            .filter(|face| stands(&remains[*face]));
        let standing: Vec<FaceId> = standing.collect();
        if !self.meshed.standing.is_of(&standing) {
            let part = skin.mesh.submesh(&standing);
            let (materials, held) = (&self.meshed.materials, &self.meshed.held);
            self.meshed.standing =
                Standing::new(self.spec, skin, part, materials, held, self.bending)?;
        }
        Ok(Some(remains))
    }

    /// Gives it the rest shape and the material that growth and fire have made, which has left `remains`.
    pub(super) fn shape(
        &mut self,
        driver: &Driver,
        pose: &PoseSpec,
        time: f64,
        remains: Option<PerFace<Remains>>,
    ) -> Result<(), StepperError> {
        let growth = PoseGrowth::new(self.spec, pose);
        let skin = &self.meshed.skin;
        let grown = growth.on_skin(driver, skin, time);
        if grown.is_none() && remains.is_none() {
            return Ok(());
        }
        let faces = skin.mesh.face_count();
        let one = Matrix2::identity();
        let mut stretches = grown.unwrap_or_else(|| PerFace::filled(faces, one));
        let mut curvatures = growth.curls_on_skin(driver, skin, time);
        if let Some(remains) = remains {
            self.burn_faces(&remains, (&mut stretches, &mut curvatures))?;
        }
        let largest = |tensor: &Matrix2<f64>| tensor.symmetric_eigenvalues().amax();
        self.curvatures = curvatures.as_slice().iter().map(largest).collect();
        let standing = &mut self.meshed.standing;
        let stretches = standing.of_faces(stretches.as_slice(), |stretch| *stretch);
        let curvatures = standing.of_faces(curvatures.as_slice(), |curvature| *curvature);
        let energy = &mut standing.energy;
        let outcome = energy.set_rest_metric(&stretches);
        let outcome = outcome.and_then(|()| energy.set_natural_curvatures(&curvatures));
        self.capped = outcome.map_err(|source| shell_error(self.spec, source))?;
        Ok(())
    }

    /// Gives the faces that are left the material and the mass that the fire has left, and adds its shrinkage and curl
    /// to these stretches and curvatures.
    fn burn_faces(
        &mut self,
        remains: &PerFace<Remains>,
        (stretches, curvatures): (&mut PerFace<Matrix2<f64>>, &mut PerFace<Matrix2<f64>>),
    ) -> Result<(), StepperError> {
        let Some(fire) = &self.fire else {
            return Ok(());
        };
        // Fire curls by the difference of two faces, and those of a laminate are not as far apart as those of
        // the even sheet that stands for it.
        let laminate = self.spec.laminate.as_ref();
        let thinner = laminate.map_or(1.0, |plies| {
            self.spec.material.thickness / plies.thickness()
        });
        let meshed = &mut self.meshed;
        let mut masses = vec![0.0; remains.len()];
        for face in meshed.standing.part.faces.as_slice() {
            let burnt = fire.face(*face, &remains[*face])?;
            // What has grown burns: fire shrinks the lengths that growth has left.
            stretches[*face] = burnt.stretch * stretches[*face];
            curvatures[*face] += burnt.curvature * thinner;
            meshed.materials[face.index()] = burnt.material;
            let left = fire.area(*face) * remains[*face].share;
            masses[face.index()] = left * meshed.densities[face.index()] * burnt.mass;
        }
        meshed.masses = lumped(&meshed.skin, &masses);
        let standing = &mut meshed.standing;
        let shares: Vec<f64> = standing.of_faces(remains.as_slice(), |remains| remains.share);
        let parameters = standing.of_faces(&meshed.materials, |material| *material);
        let energy = &mut standing.energy;
        let set = energy.set_face_parameters(&parameters);
        let set = set.and_then(|()| energy.set_area_left(&shares));
        set.map_err(|source| shell_error(self.spec, source))
    }

    /// The fire and what it has done.
    pub(super) fn fire(&self) -> Option<(&FireState<'a>, &Burning)> {
        self.fire.as_ref().zip(self.moving.burning.as_ref())
    }

    /// Whether nothing is left of it.
    pub(super) fn is_gone(&self) -> bool {
        self.meshed.standing.part.faces.is_empty()
    }

    /// What the fire has done.
    pub(super) fn fire_report(&self) -> Option<FireReport> {
        let (fire, burning) = self.fire()?;
        let pieces = self
            .meshed
            .standing
            .part
            .mesh
            .connected_parts(|_| true)
            .len();
        let mass = self.meshed.masses.iter().sum();
        Some(fire.report(burning, (mass, pieces, self.capped)))
    }

    /// Handles of which all that they held has burnt or fallen off.
    pub(super) fn burnt_handles(&self) -> impl Iterator<Item = &str> {
        let mut holds = vec![false; self.sheet.handles.len()];
        for v in self.meshed.standing.part.vertices.as_slice() {
            if let Some(handle) = self.meshed.holders[v.index()] {
                holds[handle] = true;
            }
        }
        let handles = self.sheet.handles.iter().zip(holds);
        handles
            .filter(|(_, holds)| !holds)
            .map(|(handle, _)| handle.name.as_str())
    }
}
