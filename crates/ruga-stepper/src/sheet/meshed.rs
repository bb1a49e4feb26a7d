//! A sheet's mesh, what it is made of there, and what holds it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_material::RelativeProperties;
use ruga_mesh::{Id, PerFace, Submesh, face_areas, mean_edge_lengths};
use ruga_shell::{BendingModel, FaceParameters};

use super::Sheet;
use super::standing::Standing;
use crate::skin::local_skin::{relative_at_vertices, relative_on_faces};
use crate::skin::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// The mesh that a sheet is computed on, with what does not change while it stays the same.
pub(super) struct Meshed {
    pub(super) skin: SkinMesh,
    /// The part that is still there.
    pub(super) standing: Standing,
    /// The handle that holds a vertex, and whether one does.
    pub(super) holders: Vec<Option<usize>>,
    pub(super) held: Vec<bool>,
    /// Masses of the vertices, kg.
    pub(super) masses: Vec<f64>,
    /// Rest area of every face, m², and its mass per area, kg/m².
    pub(super) face_areas: PerFace<f64>,
    pub(super) densities: Vec<f64>,
    /// Material on every face as it is now, and its bending modulus when fresh, J.
    pub(super) materials: Vec<FaceParameters>,
    pub(super) moduli: Vec<f64>,
    /// Mean edge, m.
    pub(super) edge: f64,
    /// Mean stretching stiffness `E h` of the fresh sheet, N/m.
    pub(super) membrane: f64,
}

impl Meshed {
    /// The fresh sheet on `skin`, of which `part` is there; where only some vertices `may_be_held`, no others are.
    pub(super) fn new(
        driver: &Driver,
        (spec, sheet): (&LayerSpec, &Sheet),
        (skin, part, may_be_held): (SkinMesh, Submesh, Option<&[bool]>),
        bending: BendingModel,
    ) -> Result<Self, StepperError> {
        let mut holders = holders(sheet, &skin.rest.positions)?;
        for (holder, may_be_held) in holders.iter_mut().zip(may_be_held.into_iter().flatten()) {
            *holder = holder.filter(|_| *may_be_held);
        }
        let held: Vec<bool> = holders.iter().map(Option::is_some).collect();
        if held.iter().all(|held| *held) {
            return Err(StepperError::NoRoom {
                layer: spec.name.clone(),
            });
        }
        let materials = face_parameters(spec, driver, &skin);
        let (mesh, rest) = (&skin.mesh, skin.rest.positions.as_slice());
        let of_faces = |value: fn(&FaceParameters) -> f64| -> Vec<f64> {
            materials.iter().map(value).collect()
        };
        let standing = Standing::new(spec, &skin, part, &materials, &held, bending)?;
        let face_areas = face_areas(mesh, rest);
        let densities = materials
            .iter()
            .map(|face| face.thickness * spec.material.density);
        let densities: Vec<f64> = densities.collect();
        let on_faces = face_areas.as_slice().iter().zip(&densities);
        let on_faces: Vec<f64> = on_faces.map(|(area, density)| area * density).collect();
        Ok(Self {
            standing,
            masses: lumped(&skin, &on_faces),
            // Not the shortest edge: what is cut along a crease may be as small as it likes.
            edge: mean(&mean_edge_lengths(mesh, rest)),
            membrane: mean(&of_faces(|face| face.young * face.thickness)),
            moduli: of_faces(|face| {
                face.young * face.thickness.powi(3) / (12.0 * (1.0 - face.poisson * face.poisson))
            }),
            holders,
            held,
            face_areas,
            densities,
            materials,
            skin,
        })
    }

    /// Mean bending modulus of the fresh sheet, J.
    pub(super) fn bending(&self) -> f64 {
        mean(&self.moduli)
    }

    /// Stiffness of an obstacle against it, pressure per depth, Pa/m.
    pub(super) fn stiffness(&self) -> f64 {
        self.membrane / (self.edge * self.edge)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Masses of the vertices from those of the faces.
pub(super) fn lumped(skin: &SkinMesh, of_faces: &[f64]) -> Vec<f64> {
    let mut masses = vec![0.0; skin.mesh.vertex_count()];
    for (corners, mass) in skin.mesh.faces().as_slice().iter().zip(of_faces) {
        for v in corners {
            masses[v.index()] += mass / 3.0;
        }
    }
    masses
}

/// The handle of every vertex; of the first in whose box it is at rest.
pub(super) fn holders(
    sheet: &Sheet,
    rest: &[Vector3<f64>],
) -> Result<Vec<Option<usize>>, StepperError> {
    let mut holders = vec![None; rest.len()];
    for (number, handle) in sheet.handles.iter().enumerate() {
        let mut is_empty = true;
        let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for (holder, x) in holders.iter_mut().zip(rest) {
            let place = handle.turn * x + handle.shift;
            (low, high) = (low.inf(&place), high.sup(&place));
            if handle.holds(x) {
                is_empty &= holder.is_some();
                holder.get_or_insert(number);
            }
        }
        if is_empty {
            return Err(StepperError::EmptySheetHandle {
                handle: handle.name.clone(),
                boxes: Box::new([[handle.min, handle.max], [low, high]]),
            });
        }
    }
    Ok(holders)
}

/// The material on every face, by the map and the variation of the layer.
fn face_parameters(spec: &LayerSpec, driver: &Driver, skin: &SkinMesh) -> Vec<FaceParameters> {
    let relative = relative_at_vertices(spec, driver, skin);
    let relative = relative_on_faces(spec, skin, &relative);
    let of_face = |relative: &RelativeProperties| {
        let local = relative.scaled(&spec.material);
        FaceParameters {
            young: local.young,
            poisson: local.poisson,
            thickness: local.thickness,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        }
    };
    relative.as_slice().iter().map(of_face).collect()
}
