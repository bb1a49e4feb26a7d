//! The artist's mesh, carried along by a sheet, and the sheet as others see it.

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_mesh::Id;

use super::state::SheetState;
use crate::support::{PosedDriver, Support};
use crate::{ComputedMesh, LayerSurface};

/// Barycentric weight of a corner from which on a point lies on it.
const ON_VERTEX: f64 = 1.0 - 1e-9;

impl SheetState<'_> {
    /// Positions of the driver's vertices, in the order of [`Driver::pose`], m: each moves with the sheet's vertex
    /// at its place.
    pub(super) fn artist_positions(&self, driver: &Driver) -> Vec<Vector3<f64>> {
        let mut positions = driver.rest().to_vec();
        let carried = self.on_region(&self.carried_positions());
        let skin = &self.region.skin;
        for (i, point) in skin.points.points().iter().enumerate() {
            let on = point
                .barycentric
                .iter()
                .position(|weight| *weight > ON_VERTEX);
            if let Some(corner) = on {
                let v = driver.topology().faces()[point.face][corner].index();
                // Of a curved mesh the smooth surface lies beside its vertices, and stays so far beside them.
                let displacement = carried[i] - skin.rest.positions[i];
                positions[v] = driver.rest()[v] + displacement;
            }
        }
        positions
    }

    /// The sheet as others see it, over the smooth surface of the artist's mesh that it carries along.
    pub(super) fn surface(&self, driver: &Driver, artist: &[Vector3<f64>]) -> LayerSurface {
        let region = &self.region;
        let below = PosedDriver {
            control: artist.to_vec(),
        };
        let below = below.pose(&region.skin);
        // The surface is smooth across what is gone, which would else have stayed where it burnt.
        let own = &match &self.fitting {
            Some(_) => self.on_region(&self.carried_positions()),
            None => self.moving.positions.clone(),
        };
        let shown = region.shown(driver).clone();
        LayerSurface {
            name: self.spec.name.clone(),
            positions: region.on_both_sides(own.clone()),
            relief: region.on_both_sides(own.clone()),
            driver_positions: region.on_both_sides(below.positions),
            driver_normals: region.on_both_sides(below.normals),
            offset: 0.0,
            faces: shown.faces,
            uvs: shown.uvs,
            on_plane: Arc::default(),
            artist: shown.artist,
            computed: ComputedMesh::new(driver, &self.meshed.skin, &self.moving.positions),
            face_states: None,
            burnt: None,
        }
    }
}
