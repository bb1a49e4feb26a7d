//! A new mesh for a sheet whose fire has come to where the old one is too coarse.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_mesh::{FaceId, Id, PerFace, Submesh};

use super::fitting::{Fitting, Refitted};
use super::meshed::Meshed;
use super::pieces::stands;
use super::standing::Standing;
use super::state::{SheetState, scales};
use super::zones::Zone;
use crate::StepperError;
use crate::error::Halt;
use crate::skin::skin_mesh::SkinMesh;
use crate::support::Moves;

/// Time (s) over which what is gone is moved back to find its velocity; any short one would do.
const MOMENT: f64 = 1e-3;

impl SheetState<'_> {
    /// Zones of the fire between two fractions of a pose if the mesh is too coarse for them; `None` where it is fine
    /// enough, and of a sheet whose edges have one length.
    pub(super) fn too_coarse(&self, moves: &Moves<'_>, times: [f64; 2]) -> Option<Vec<Zone>> {
        let fitting = self.fitting.as_ref().filter(|_| !self.is_gone())?;
        let zones = self.zones(moves, times);
        fitting.is_too_coarse(&zones).then_some(zones)
    }

    /// Zones of the fire between two fractions of a pose, one for each vertex of the region's mesh.
    pub(super) fn zones(&self, moves: &Moves<'_>, times: [f64; 2]) -> Vec<Zone> {
        let (Some(fitting), Some((fire, burning))) = (&self.fitting, self.fire()) else {
            return Vec::new();
        };
        let balls = fire.balls(moves, times);
        let places = match balls.is_empty() {
            true => Vec::new(),
            false => fitting.linear(&self.carried_positions()),
        };
        fire.zones(burning, &self.region.skin.mesh, (&balls, &places))
    }

    /// Meshes the sheet anew, fine where these zones burn; after an error the sheet keeps its mesh.
    pub(super) fn refit(
        &mut self,
        driver: &Driver,
        zones: &[Zone],
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<(), Halt> {
        let Some(fitting) = &self.fitting else {
            return Ok(());
        };
        // What is gone goes along with what is left: a new vertex may lie between the two.
        let positions = self.carried_positions();
        let velocities = self.carried_velocities(&positions);
        let of = (self.spec, driver, &self.region);
        let shape = (positions.as_slice(), self.curvatures.as_slice());
        let Refitted {
            fitting,
            skin,
            transfer,
        } = fitting.again(of, zones, shape, goes_on)?;
        let rest = &self.meshed.skin.rest.positions;
        let moved = positions.iter().zip(rest).map(|(x, rest)| x - rest);
        let moved = transfer.rows.apply(&moved.collect::<Vec<Vector3<f64>>>());
        let at_rest = skin.rest.positions.iter().zip(moved);
        let positions = at_rest.map(|(rest, moved)| rest + moved).collect();
        let part = self.part_on(&fitting, &skin)?;
        let on = (skin, part, Some(fitting.may_be_held()));
        let meshed = Meshed::new(driver, (self.spec, self.sheet), on, self.bending)?;
        if let Some(fire) = &mut self.fire {
            fire.put_on(driver, &meshed.skin, meshed.materials.clone());
        }
        self.moving.positions = positions;
        self.moving.velocities = transfer.rows.apply(&velocities);
        self.scales = scales(self.sheet, &meshed);
        self.curvatures = vec![0.0; meshed.face_areas.len()];
        self.meshed = meshed;
        self.fitting = Some(fitting);
        Ok(())
    }

    /// Puts the mesh of the fire on a new one of the sheet, and gives the part of this that is there.
    fn part_on(&mut self, fitting: &Fitting, skin: &SkinMesh) -> Result<Submesh, StepperError> {
        let pieces = self.pieces_of_fields();
        let (Some(fire), Some(burning)) = (&mut self.fire, &mut self.moving.burning) else {
            return Ok(Standing::whole(skin));
        };
        fire.lie_on(fitting.covering(&fire.grid, &self.region, skin));
        if let Some(pieces) = pieces {
            fire.keep_apart(burning, &skin.mesh, &pieces)?;
        }
        let remains = fire.remains(burning)?;
        let faces = skin.mesh.faces().ids();
        let faces: Vec<FaceId> = faces.filter(|face| stands(&remains[*face])).collect();
        Ok(skin.mesh.submesh(&faces))
    }

    /// The piece of the sheet, the largest first, on which every triangle of the field mesh lies; `None` while there is
    /// no more than one.
    fn pieces_of_fields(&self) -> Option<PerFace<Option<usize>>> {
        let part = &self.meshed.standing.part;
        let mut pieces = part.mesh.connected_parts(|_| true);
        if pieces.len() < 2 {
            return None;
        }
        pieces.sort_by_key(|piece| std::cmp::Reverse(piece.len()));
        let mut of_faces = vec![None; self.meshed.face_areas.len()];
        for (number, piece) in pieces.iter().enumerate() {
            for face in piece {
                of_faces[part.faces[*face].index()] = Some(number);
            }
        }
        let fire = self.fire.as_ref()?;
        let fields = fire.grid.mesh.faces().ids();
        let of_field = |field| of_faces[fire.owner(field).index()];
        Some(fields.map(of_field).collect())
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
