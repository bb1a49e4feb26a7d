//! What is left of a burning sheet, cut along the line at which it falls off.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, PerVertex};
use ruga_remesh::{CutPoint, LevelCut};

use super::burning::{Burning, FireState};
use super::field_grid::lifted;
use super::state::SheetState;
use crate::{ComputedMesh, FaceState, LayerSurface, StepperError};

/// Share of an edge within which the line goes to a vertex, so that it leaves no slivers.
const SNAP: f64 = 0.02;

impl SheetState<'_> {
    /// The part of `whole`, the fresh sheet as others see it, that the fire has left.
    pub(super) fn cut(
        &self,
        whole: LayerSurface,
        (fire, burning): (&FireState<'_>, &Burning),
    ) -> Result<LayerSurface, StepperError> {
        let grid = &fire.grid;
        let burnt = fire.surface(burning);
        let level = PerVertex::from(burnt.level.clone());
        let cut = LevelCut::new(&grid.mesh, &level, SNAP).map_err(|source| {
            let layer = self.spec.name.clone();
            StepperError::Remesh { layer, source }
        })?;
        // The last two per cent of a triangle are in nobody's energy, and stay behind when the others move.
        let is_standing = self.stands();
        let kept: Vec<FaceId> = cut
            .mesh
            .faces()
            .ids()
            .filter(|face| is_standing[fire.owner(cut.parents[*face]).index()])
            .collect();
        let part = cut.mesh.submesh(&kept);
        let coarse = &self.region.skin.mesh;
        let at_cut = |values: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            let fine = grid.interpolated(coarse, values);
            let vertices = part.vertices.as_slice().iter();
            vertices.map(|v| cut.vertices[*v].value(&fine)).collect()
        };
        let own = at_cut(&whole.positions);
        let mut normals = at_cut(&whole.driver_normals);
        for normal in &mut normals {
            *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
        }
        let faces = part.mesh.faces().as_slice().iter();
        // Per corner its parts of the parent's corners.
        let corners = part.mesh.faces().iter().map(|(face, corners)| {
            let parent = cut.parents[part.faces[face]];
            let of_parent = grid.mesh.faces()[parent];
            let parts = corners
                .map(|v| barycentric(&cut.vertices[part.vertices[v]], of_parent.map(|v| v.0)));
            (parent, parts)
        });
        let corners: Vec<(FaceId, [[f64; 3]; 3])> = corners.collect();
        let uvs = corners.iter().map(|(parent, parts)| {
            let [a, b, c] = grid.uvs[parent.index()];
            parts.map(|[u, v, w]| a * u + b * v + c * w)
        });
        let artist = corners.iter().map(|(parent, parts)| {
            let (triangle, corners) = &grid.artist[parent.index()];
            (*triangle, parts.map(|place| lifted(place, corners)))
        });
        let face_states = whole.face_states.map(|states| {
            let of_face = |(parent, _): &(FaceId, _)| states[fire.owner(*parent).index()];
            corners.iter().map(of_face).collect::<Vec<FaceState>>()
        });
        let computed = whole.computed;
        let standing = computed
            .faces
            .iter()
            .zip(&is_standing)
            .filter(|(_, stands)| **stands);
        Ok(LayerSurface {
            positions: own.clone(),
            relief: own,
            driver_positions: at_cut(&whole.driver_positions),
            driver_normals: normals,
            faces: faces.map(|corners| corners.map(|v| v.0)).collect(),
            uvs: uvs.collect(),
            artist: artist.collect(),
            face_states,
            computed: ComputedMesh {
                faces: standing.map(|(face, _)| *face).collect(),
                ..computed
            },
            burnt: Some(burnt),
            ..whole
        })
    }
}

/// Barycentric coordinates in a triangle of a point on one of its edges.
fn barycentric(point: &CutPoint, corners: [u32; 3]) -> [f64; 3] {
    let mut parts = [0.0; 3];
    for (end, part) in point
        .ends
        .iter()
        .zip([1.0 - point.fraction, point.fraction])
    {
        for (corner, sum) in corners.iter().zip(&mut parts) {
            if *corner == end.0 {
                *sum += part;
            }
        }
    }
    parts
}
