//! A new mesh for a sheet whose fire has come to where the old one is too coarse.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_mesh::FaceId;

use super::fitting::Refitted;
use super::meshed::Meshed;
use super::pieces::stands;
use super::standing::Standing;
use super::state::SheetState;
use crate::StepperError;
use crate::support::Moves;

/// Time (s) over which what is gone is moved back to find its velocity; any short one would do.
const MOMENT: f64 = 1e-3;

impl SheetState<'_> {
    /// Whether its mesh is too coarse for what burns between two fractions of a pose; never for one that has edges of
    /// one length.
    pub(super) fn is_too_coarse(&self, moves: &Moves<'_>, times: [f64; 2]) -> bool {
        let Some(fitting) = self.fitting.as_ref().filter(|_| !self.is_gone()) else {
            return false;
        };
        fitting.is_too_coarse(&self.zones(moves, times))
    }

    fn zones(&self, moves: &Moves<'_>, times: [f64; 2]) -> Vec<super::zones::Zone> {
        let (Some(fitting), Some((fire, burning))) = (&self.fitting, self.fire()) else {
            return Vec::new();
        };
        let balls = fire.balls(moves, times);
        let places = match balls.is_empty() {
            true => Vec::new(),
            false => fitting.linear(&self.moving.positions),
        };
        let count = self.region.skin.mesh.vertex_count();
        fire.zones(burning, count, (&balls, &places))
    }

    /// Goes on with a mesh that is fine enough for what burns between two fractions of a pose.
    pub(super) fn refit(
        &mut self,
        driver: &Driver,
        (moves, times): (&Moves<'_>, [f64; 2]),
    ) -> Result<(), StepperError> {
        let zones = self.zones(moves, times);
        let Some(fitting) = &self.fitting else {
            return Ok(());
        };
        // What is gone goes along with what is left: a new vertex may lie between the two.
        let positions = self.carried_positions();
        let velocities = self.carried_velocities(&positions);
        let around = (driver, &self.region);
        let made = fitting.again(around, &zones, (&positions, &self.curvatures));
        let made = made.map_err(|source| StepperError::Remesh {
            layer: self.spec.name.clone(),
            source,
        })?;
        let Refitted {
            fitting,
            skin,
            transfer,
        } = made;
        let rest = &self.meshed.skin.rest.positions;
        let moved = positions.iter().zip(rest).map(|(x, rest)| x - rest);
        let moved = transfer.rows.apply(&moved.collect::<Vec<Vector3<f64>>>());
        let at_rest = skin.rest.positions.iter().zip(moved);
        self.moving.positions = at_rest.map(|(rest, moved)| rest + moved).collect();
        self.moving.velocities = transfer.rows.apply(&velocities);
        self.meshed = Meshed::new(driver, (self.spec, self.sheet), skin, self.bending)?;
        self.curvatures = vec![0.0; self.meshed.face_areas.len()];
        if let Some((fire, burning)) = self.fire.as_mut().zip(self.moving.burning.as_ref()) {
            let skin = &self.meshed.skin;
            let covering = fitting.covering(&fire.grid, &self.region, skin);
            let fresh = self.meshed.materials.clone();
            fire.put_on(driver, (skin, fresh), Some(covering));
            let remains = fire.remains(burning)?;
            let faces = skin.mesh.faces().ids();
            let faces: Vec<FaceId> = faces.filter(|face| stands(&remains[*face])).collect();
            let part = skin.mesh.submesh(&faces);
            let (materials, held) = (&self.meshed.materials, &self.meshed.held);
            self.meshed.standing =
                Standing::new(self.spec, skin, part, materials, held, self.bending)?;
        }
        self.fitting = Some(fitting);
        Ok(())
    }

    /// Velocities of all vertices, which are at `positions` (m); those that are gone go along with what is left, m/s.
    fn carried_velocities(&self, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let moving = self.moving.positions.iter().zip(&self.moving.velocities);
        let before: Vec<Vector3<f64>> = moving.map(|(x, v)| x - v * MOMENT).collect();
        let before = self.carried(&before).into_iter();
        let pairs = positions.iter().zip(before);
        pairs.map(|(now, before)| (now - before) / MOMENT).collect()
    }
}
