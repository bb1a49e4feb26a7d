//! What poses ask of every face of the planning surface, for pictures of a plan.

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_blend::{FaceStrain, face_strains};
use ruga_material::CAP_START;
use ruga_mesh::{FaceId, Id, PerFace, triangle_frame};

use super::PlanningSurface;
use crate::growth::PoseGrowth;
use crate::plan::pose_plan::{LoadPath, PlannedLayer};
use crate::plan::region::{PoseStrains, felt};
use crate::{LayerPlan, PoseSpec};

/// What a pose asks of a layer on one triangle of its skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedFace {
    /// Texture coordinates of the corners, V down.
    pub uvs: [Vector2<f64>; 3],
    /// Largest effective strain over the keys, in critical strains: beyond 1 it wrinkles.
    pub strain_ratio: f64,
    /// Critical wavelength, m.
    pub wavelength: f64,
    /// One critical wavelength across the wrinkles, in texture coordinates.
    pub across: Vector2<f64>,
    /// The same length along the wrinkles, in texture coordinates.
    pub along: Vector2<f64>,
    /// What is done there.
    pub treatment: Treatment,
}

/// What is done with a triangle of the skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Treatment {
    /// It stays as the driver has it: nothing wrinkles there, or the layer is not there.
    Smooth,
    /// It is simulated.
    Simulated,
    /// It is simulated with less compression than the pose asks for, beyond 15 %.
    Capped,
    /// It stays as the artist has folded it.
    Folded,
}

impl PlanningSurface<'_> {
    /// What `pose` asks of `layer`, which is planned as `plan` says, on every face.
    pub(crate) fn planned_faces(
        &self,
        layer: &PlannedLayer<'_>,
        (pose, path): (&PoseSpec, LoadPath),
        plan: &LayerPlan,
    ) -> Vec<PlannedFace> {
        let (keys, passing) = self.posed(pose);
        let on = (self.driver, &self.surface, &self.rest);
        let mut strains = PoseStrains::new(on, pose, &keys, &passing, layer);
        if path == LoadPath::Weight {
            strains.exclude_passing_folds();
        }
        let mesh = self.surface.mesh();
        let poisson = layer.spec.material.poisson;
        let mut strongest: PerFace<Option<FaceStrain>> = PerFace::filled(mesh.face_count(), None);
        let growth = PoseGrowth::new(layer.spec, pose);
        for (key, load) in keys.iter().zip(&pose.keys) {
            let driven = face_strains(mesh, &self.rest.positions, &key.positions);
            for (face, strain) in felt(on, driven, &growth, *load).iter() {
                let before = strongest[face].map_or(f64::NEG_INFINITY, |s| s.effective(poisson));
                if strain.effective(poisson) > before {
                    strongest[face] = Some(*strain);
                }
            }
        }
        let planned = |face: FaceId| {
            let direction = strongest[face].map_or_else(Vector2::x, |strain| strain.direction);
            let wavelength = layer.local[face].wavelength;
            let to_uvs = self.to_uvs(face) * wavelength;
            PlannedFace {
                uvs: self.surface.uvs()[face],
                strain_ratio: strains.strain_ratio(face),
                wavelength,
                across: to_uvs * direction,
                along: to_uvs * Vector2::new(-direction.y, direction.x),
                treatment: self.treatment(face, plan, &strains),
            }
        };
        mesh.faces().ids().map(planned).collect()
    }

    fn treatment(&self, face: FaceId, plan: &LayerPlan, strains: &PoseStrains) -> Treatment {
        let address = self.surface.ancestor(face, self.surface.levels());
        match plan.region.binary_search(&address) {
            Ok(_) if strains.compression[face] > CAP_START => Treatment::Capped,
            Ok(_) => Treatment::Simulated,
            Err(_) if strains.folded[face] => Treatment::Folded,
            Err(_) => Treatment::Smooth,
        }
    }

    /// Takes vectors in the rest frame of a face, m, to texture coordinates.
    fn to_uvs(&self, face: FaceId) -> Matrix2<f64> {
        let corners = self.surface.mesh().faces()[face].map(|v| self.rest.positions[v.index()]);
        let frame = triangle_frame(&corners);
        let local = |edge: Vector3<f64>| Vector2::new(edge.dot(&frame[0]), edge.dot(&frame[1]));
        let [a, b, c] = corners;
        let shape = Matrix2::from_columns(&[local(b - a), local(c - a)]);
        let [a, b, c] = self.surface.uvs()[face];
        let layout = Matrix2::from_columns(&[b - a, c - a]);
        layout * shape.try_inverse().unwrap_or_else(Matrix2::zeros)
    }
}
