//! The part of a sheet that is still there, as the solver sees it.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{FaceId, Id, Submesh, TriMesh, VertexId};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{ConstraintRows, Kkt, LowerPattern};

use super::state::{shell_error, solver_error};
use crate::skin::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// Levenberg damping in units of the mean membrane stiffness of a vertex: gives motions of a loose sheet a sign.
const DAMPING: f64 = 1e-10;

/// The most of it in units of inertia, which gives them one as well: more would hold up pieces that fall.
const DAMPING_OF_INERTIA: f64 = 1e-3;

/// Some triangles of a sheet, their energy and the unknowns of the vertices that move.
pub(super) struct Standing {
    pub(super) part: Submesh,
    pub(super) energy: LayerEnergy,
    /// Pattern and factor of its Hessian; `None` where nothing of it can move.
    pub(super) system: Option<(LowerPattern, Kkt)>,
    /// Vertices of the part that nothing holds.
    pub(super) free: Vec<VertexId>,
    /// Levenberg damping, N/m.
    damping: f64,
}

impl Standing {
    /// The chosen faces of a sheet with the material of all its faces; `held` vertices do not move.
    pub(super) fn new(
        spec: &LayerSpec,
        skin: &SkinMesh,
        part: Submesh,
        materials: &[FaceParameters],
        held: &[bool],
        bending: BendingModel,
    ) -> Result<Self, StepperError> {
        let vertices = || part.vertices.as_slice().iter();
        let rest: Vec<Vector3<f64>> = vertices().map(|v| skin.rest.positions[v.index()]).collect();
        let held: Vec<bool> = vertices().map(|v| held[v.index()]).collect();
        let faces = part.faces.as_slice().iter();
        let parameters = LayerParameters {
            tangential_stiffness: vec![0.0; rest.len()],
            faces: faces.map(|face| materials[face.index()]).collect(),
        };
        let shell = |source| shell_error(spec, source);
        let energy = LayerEnergy::with_bending(&part.mesh, &rest, parameters, &held, bending);
        let mut energy = energy.map_err(shell)?;
        // A curved sheet has no stress where it is at rest.
        energy.set_rest_angles(&rest).map_err(shell)?;
        let free: Vec<VertexId> = (0..held.len())
            .map(VertexId::from_index)
            .filter(|v| !held[v.index()])
            .collect();
        let solver = |source| solver_error(spec, source);
        let unknowns = 3 * free.len();
        let system = (unknowns > 0).then(|| {
            let (starts, entries) = energy.blocks().shared();
            let pattern = LowerPattern::new(starts, entries)?;
            let rows = ConstraintRows::new(vec![0], Vec::new(), Vec::new(), unknowns)?;
            let kkt = Kkt::new(&pattern, &rows, 3)?;
            Ok((pattern, kkt))
        });
        let system = system.transpose().map_err(solver)?;
        let membrane = materials.iter().map(|face| face.young * face.thickness);
        let membrane = membrane.sum::<f64>() / materials.len().max(1) as f64;
        Ok(Self {
            damping: DAMPING * membrane,
            part,
            energy,
            system,
            free,
        })
    }

    /// Levenberg damping of every unknown (N/m), by the inertia of all vertices (N/m) if there is any.
    pub(super) fn damping(&self, inertia: Option<&[f64]>) -> Vec<f64> {
        let of_vertex = |v: &VertexId| {
            let inertia = inertia.map_or(f64::INFINITY, |inertia| inertia[v.index()]);
            [self.damping.min(DAMPING_OF_INERTIA * inertia); 3]
        };
        self.free.iter().flat_map(of_vertex).collect()
    }

    /// All of a sheet, with the same numbers of vertices and faces.
    pub(super) fn whole(skin: &SkinMesh) -> Submesh {
        Submesh {
            mesh: skin.mesh.clone(),
            vertices: (0..skin.mesh.vertex_count())
                .map(VertexId::from_index)
                .collect(),
            faces: skin.mesh.faces().ids().collect(),
        }
    }

    /// Values of its vertices from those of the whole sheet.
    pub(super) fn of_vertices<T: Copy>(&self, all: &[T]) -> Vec<T> {
        let vertices = self.part.vertices.as_slice().iter();
        vertices.map(|v| all[v.index()]).collect()
    }

    /// Puts values of its vertices among those of the whole sheet.
    pub(super) fn put<T: Copy>(&self, own: &[T], all: &mut [T]) {
        for (v, value) in self.part.vertices.as_slice().iter().zip(own) {
            all[v.index()] = *value;
        }
    }

    /// Values of its faces from those of the whole sheet.
    pub(super) fn of_faces<T, U>(&self, all: &[T], value: impl Fn(&T) -> U) -> Vec<U> {
        let faces = self.part.faces.as_slice().iter();
        faces.map(|face| value(&all[face.index()])).collect()
    }

    /// Positions (m) of all vertices of a sheet; one that is gone lies on the plane of the nearest face that is there,
    /// as it did at rest.
    pub(super) fn carried(
        &self,
        mesh: &TriMesh,
        rest: &[Vector3<f64>],
        positions: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let mut carried = positions.to_vec();
        let mut nearest: Vec<Option<FaceId>> = vec![None; mesh.vertex_count()];
        let mut queue = Vec::new();
        for face in self.part.faces.as_slice() {
            for v in mesh.faces()[*face] {
                if nearest[v.index()].replace(*face).is_none() {
                    queue.push(v);
                }
            }
        }
        let there = queue.len();
        let mut next = 0;
        while let Some(v) = queue.get(next).copied() {
            next += 1;
            for face in mesh.vertex_faces(v) {
                for other in mesh.faces()[*face] {
                    if nearest[other.index()].is_none() {
                        nearest[other.index()] = nearest[v.index()];
                        queue.push(other);
                    }
                }
            }
        }
        for v in &queue[there..] {
            if let Some(face) = nearest[v.index()] {
                let corners = mesh.faces()[face].map(|v| v.index());
                let before = corners.map(|i| rest[i]);
                let after = corners.map(|i| positions[i]);
                carried[v.index()] = moved_along(&rest[v.index()], &before, &after);
            }
        }
        carried
    }

    /// Whether it is made of these faces, which ascend.
    pub(super) fn is_of(&self, faces: &[FaceId]) -> bool {
        self.part.faces.as_slice() == faces
    }
}

/// Where a place goes that moves along with a triangle, whose plane it keeps its distance from.
fn moved_along(
    x: &Vector3<f64>,
    before: &[Vector3<f64>; 3],
    after: &[Vector3<f64>; 3],
) -> Vector3<f64> {
    let normal = |[a, b, c]: &[Vector3<f64>; 3]| {
        let normal = (b - a).cross(&(c - a));
        normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    };
    let axes =
        |t: &[Vector3<f64>; 3]| Matrix3::from_columns(&[t[1] - t[0], t[2] - t[0], normal(t)]);
    let parts = axes(before)
        .try_inverse()
        .map(|inverse| inverse * (x - before[0]));
    parts.map_or(after[0], |parts| after[0] + axes(after) * parts)
}
