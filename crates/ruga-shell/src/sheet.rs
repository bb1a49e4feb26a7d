//! Membrane and bending of one sheet among the vertices of a layer.

use std::sync::OnceLock;

use nalgebra::{Matrix2, Vector3};

use ruga_mesh::{BlockPattern, EdgeId, TriMesh};

use crate::layer_bending::{LayerBending, inner_edges};
use crate::layer_part::{PartNumbers, pick, rank};
use crate::membrane::{Membrane, Stress};
use crate::shared_out::{for_each_numbered_mut, in_order, numbered};
use crate::sheet_slots::SheetSlots;
use crate::stars::stars;
use crate::stencil::{add_blocks, gather};
use crate::{
    BendingModel, Crease, CreaseState, EnergyParts, FaceParameters, RestTriangle, ShellError,
};

#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    faces: Vec<[u32; 3]>,
    parameters: Vec<FaceParameters>,
    /// Share of each face's area that is left.
    area_left: Vec<f64>,
    /// Natural curvature of each face (1/m); empty for a sheet that has none.
    natural_curvatures: Vec<Matrix2<f64>>,
    /// Number of faces whose natural curvature is scaled down.
    capped_faces: usize,
    /// Rest triangles without any stretch, and as they are now.
    unstretched: Vec<RestTriangle>,
    rest: Vec<RestTriangle>,
    membranes: Vec<Membrane>,
    bending: LayerBending,
    /// Looked up when a matrix is first asked for.
    slots: OnceLock<SheetSlots>,
}

impl Sheet {
    /// A sheet on `mesh`, its vertices after `before` others, at rest at the `positions` (m) of all vertices of the
    /// layer. Beyond border edges with both ends `on_plane` (empty for no plane) it goes on as its mirror image.
    pub(crate) fn new(
        (mesh, on_plane): (&TriMesh, &[bool]),
        (before, model): (u32, BendingModel),
        positions: &[Vector3<f64>],
        parameters: Vec<FaceParameters>,
    ) -> Result<Self, ShellError> {
        let (mut inner, mut stars) = rayon::join(
            || inner_edges(mesh, on_plane),
            || match model {
                BendingModel::Hinge => Vec::new(),
                BendingModel::VertexCurvature => stars(mesh, on_plane),
            },
        );
        for edge in &mut inner {
            edge.vertices = edge.vertices.map(|v| before + v);
        }
        for vertex in stars.iter_mut().flat_map(|star| &mut star.vertices) {
            *vertex += before;
        }
        let faces = mesh.faces().as_slice().iter();
        let faces: Vec<_> = faces.map(|face| face.map(|v| before + v.0)).collect();
        let rest = numbered(faces.len(), |face| {
            RestTriangle::new(&gather(positions, &faces[face]), face)
        });
        // Of several errors the first is told, whichever thread was first.
        let rest = rest.into_iter().collect::<Result<Vec<_>, _>>()?;
        let area_left = vec![1.0; faces.len()];
        let mut this = Self {
            membranes: membranes(&rest, &parameters, &area_left),
            area_left,
            natural_curvatures: Vec::new(),
            capped_faces: 0,
            bending: LayerBending::new(stars, (mesh, &inner), positions),
            slots: OnceLock::new(),
            unstretched: rest.clone(),
            faces,
            parameters,
            rest,
        };
        this.set_bending_stiffness();
        Ok(this)
    }

    /// The vertices of every stencil.
    pub(crate) fn stencils(&self) -> impl Iterator<Item = &[u32]> {
        let faces = self.faces.iter().map(<[u32; 3]>::as_slice);
        faces.chain(self.bending.stencils())
    }

    /// How the sheet bends.
    pub(crate) fn bending(&self) -> &LayerBending {
        &self.bending
    }

    /// The sheet in a part of the layer; values are to be taken over.
    pub(crate) fn part(&self, numbers: &PartNumbers) -> Self {
        let face = |&number: &u32| self.faces[number as usize].map(|v| rank(&numbers.vertices, v));
        Self {
            faces: numbers.faces.iter().map(face).collect(),
            parameters: Vec::new(),
            area_left: Vec::new(),
            natural_curvatures: Vec::new(),
            capped_faces: 0,
            unstretched: Vec::new(),
            rest: Vec::new(),
            membranes: Vec::new(),
            bending: self.bending.part(numbers),
            slots: OnceLock::new(),
        }
    }

    /// Takes over the values of the whole that this is a part of.
    pub(crate) fn follow(&mut self, whole: &Self, numbers: &PartNumbers) {
        let faces = &numbers.faces;
        pick(&mut self.parameters, &whole.parameters, faces);
        pick(&mut self.area_left, &whole.area_left, faces);
        pick(&mut self.rest, &whole.rest, faces);
        pick(&mut self.membranes, &whole.membranes, faces);
        self.bending.follow(&whole.bending, numbers);
    }

    /// Forgets the slots of its stencils.
    pub(crate) fn release_slots(&mut self) {
        self.slots = OnceLock::new();
    }

    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    pub(crate) fn parameters(&self) -> &[FaceParameters] {
        &self.parameters
    }

    /// Share of each face's area that is left.
    pub(crate) fn area_left(&self) -> &[f64] {
        &self.area_left
    }

    /// Number of faces whose natural curvature is scaled down.
    pub(crate) fn capped_faces(&self) -> usize {
        self.capped_faces
    }

    /// Rest triangles under the present rest metric.
    pub(crate) fn rest(&self) -> &[RestTriangle] {
        &self.rest
    }

    /// The rest triangles as built, stretched.
    pub(crate) fn stretched(
        &self,
        stretches: &[Matrix2<f64>],
    ) -> Result<Vec<RestTriangle>, ShellError> {
        // Always from the triangles as built: stretches of one frame after the other would pile up.
        let stretched = numbered(stretches.len(), |face| {
            self.unstretched[face].stretched(&stretches[face], face)
        });
        // Of several errors the first is told, whichever thread was first.
        stretched.into_iter().collect()
    }

    pub(crate) fn set_rest(&mut self, rest: Vec<RestTriangle>) {
        // New membranes have no natural strain: the former one was written in the frame of the
        // former rest triangles.
        self.membranes = membranes(&rest, &self.parameters, &self.area_left);
        self.rest = rest;
        self.set_bending_stiffness();
        self.bend_naturally();
    }

    /// Replaces material and springs, and the share of each face's area that is left.
    pub(crate) fn set_material(&mut self, parameters: Vec<FaceParameters>, area_left: Vec<f64>) {
        (self.parameters, self.area_left) = (parameters, area_left);
        let membranes = membranes(&self.rest, &self.parameters, &self.area_left);
        let pairs = self.membranes.iter_mut().zip(membranes);
        for (old, new) in pairs {
            *old = new.with_natural_strain(old.natural_strain());
        }
        self.set_bending_stiffness();
    }

    /// Sets every face's natural curvature (1/m).
    pub(crate) fn set_natural_curvatures(&mut self, curvatures: &[Matrix2<f64>]) {
        self.natural_curvatures = curvatures.to_vec();
        self.bend_naturally();
    }

    /// Recomputes the angles of the natural curvature for the present rest triangles.
    fn bend_naturally(&mut self) {
        if !self.natural_curvatures.is_empty() {
            let curvatures = &self.natural_curvatures;
            self.capped_faces = self.bending.set_natural_curvatures(&self.rest, curvatures);
        }
    }

    /// Sets every face's Green strain without stress.
    pub(crate) fn set_natural_strains(&mut self, strains: &[Matrix2<f64>]) {
        for_each_numbered_mut(&mut self.membranes, |face, membrane| {
            *membrane = membrane.with_natural_strain(strains[face]);
        });
    }

    pub(crate) fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) {
        self.bending.set_rest_angles(positions);
    }

    /// Replaces all creases.
    pub(crate) fn set_creases(&mut self, creases: &[(EdgeId, Crease)]) -> Result<(), ShellError> {
        self.bending.set_creases(creases)?;
        self.bending.size_creases(&self.rest, &self.parameters);
        Ok(())
    }

    pub(crate) fn crease_states(&self, x: &[Vector3<f64>]) -> Vec<CreaseState> {
        self.bending.crease_states(x)
    }

    pub(crate) fn set_bending_factor(&mut self, factor: f64) {
        self.bending.set_factor(factor);
        self.set_bending_stiffness();
    }

    fn set_bending_stiffness(&mut self) {
        let material = (self.parameters.as_slice(), self.area_left.as_slice());
        self.bending.set_rest(&self.rest, material);
    }

    /// Energies of membrane and bending (J).
    pub(crate) fn values(&self, x: &[Vector3<f64>]) -> [f64; 2] {
        let faces = self.faces.iter().zip(&self.membranes);
        let membrane = faces.map(|(face, membrane)| membrane.value(&gather(x, face)));
        [membrane.sum(), self.bending.value(x)]
    }

    /// Energies of membrane and bending (J), face by face.
    pub(crate) fn face_values(&self, x: &[Vector3<f64>]) -> Vec<EnergyParts> {
        let faces = self.faces.iter().zip(&self.membranes);
        let of_face = |(face, membrane): (&[u32; 3], &Membrane)| EnergyParts {
            membrane: membrane.value(&gather(x, face)),
            ..EnergyParts::default()
        };
        let mut parts: Vec<_> = faces.map(of_face).collect();
        self.bending.add_to_faces(x, &self.rest, &mut parts);
        parts
    }

    pub(crate) fn add_gradient(
        &self,
        x: &[Vector3<f64>],
        pattern: &BlockPattern,
        gradient: &mut [f64],
    ) {
        let forces = |i: usize, face: &[u32; 3]| self.membranes[i].gradient(&gather(x, face));
        in_order(&self.faces, forces, |face, forces| {
            pattern.add_forces(gradient, face, &forces);
        });
        self.bending.add_gradient(x, pattern, gradient);
    }

    /// Adds the second derivative to both matrices; an empty `relaxed` is not wanted. `pattern` has to be that of the
    /// first call, whose slots are kept. The membrane's stress is that predicted at `from`, if it is given.
    pub(crate) fn add_hessian(
        &self,
        (x, from): (&[Vector3<f64>], Option<&[Vector3<f64>]>),
        pattern: &BlockPattern,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        let slots = self.slots.get_or_init(|| {
            let bending = &self.bending;
            let (hinges, stars) = (bending.hinge_stencils(), bending.star_stencils());
            SheetSlots::new(pattern, &self.faces, hinges, stars)
        });
        let elements = self.faces.iter().zip(&self.membranes);
        for ((face, membrane), slots) in elements.zip(&slots.faces) {
            let corners = gather(x, face);
            let state = match from {
                None => membrane.state(&corners),
                Some(from) => membrane.predicted_state(&gather(from, face), &corners),
            };
            // The two matrices differ in the stress alone; the costlier part is formed once for
            // both.
            let material = membrane.material_blocks(&state);
            let add = |values: &mut [f64], stress: Stress| {
                let blocks = membrane.with_stress(&material, &state, stress);
                add_blocks(values, slots, &blocks);
            };
            add(exact, Stress::Full);
            if !relaxed.is_empty() {
                add(relaxed, Stress::Tensile);
            }
        }
        self.bending.add_hessian(x, slots, exact, relaxed);
    }
}

fn membranes(
    rest: &[RestTriangle],
    parameters: &[FaceParameters],
    area_left: &[f64],
) -> Vec<Membrane> {
    numbered(rest.len(), |face| {
        let p = &parameters[face];
        Membrane::new(
            &rest[face],
            area_left[face] * p.tension_modulus(),
            p.poisson,
        )
    })
}
