//! Membrane and bending of one sheet among the vertices of a layer.

use nalgebra::{Matrix2, Vector3};

use crate::edges::{Edge, edges};
use crate::layer_bending::{LayerBending, bending_stars};
use crate::layer_energy::gather;
use crate::measures::PrincipalStrain;
use crate::membrane::{Membrane, Stress};
use crate::parameters::check_finite;
use crate::pattern::{Pattern, Slot};
use crate::stars::Star;
use crate::{BendingModel, FaceParameters, RestTriangle, ShellError};

/// Row and column, within a stencil, of the off-diagonal blocks in the order of the slots, and
/// their positions in the stencil's list of lower blocks.
const FACE_PAIRS: [([usize; 2], usize); 3] = [([1, 0], 1), ([2, 0], 3), ([2, 1], 4)];
const FACE_DIAGONAL: [usize; 3] = [0, 2, 5];

/// Faces, edges and stars of a sheet, numbered by the vertices of the whole layer.
pub(crate) struct SheetTopology {
    faces: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    stars: Vec<Star>,
}

impl SheetTopology {
    /// `faces` name some of so many vertices.
    pub(crate) fn new(
        faces: Vec<[u32; 3]>,
        vertices: usize,
        model: BendingModel,
    ) -> Result<Self, ShellError> {
        let edges = edges(&faces, vertices)?;
        Ok(Self {
            stars: bending_stars(model, &faces, &edges),
            faces,
            edges,
        })
    }

    /// Every two vertices that share a stencil.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let faces_and_hinges = self.edges.iter().flat_map(|edge| {
            let apexes = edge
                .hinge(&self.faces)
                .map(|([_, _, left, right], _)| [left, right]);
            std::iter::once(edge.ends).chain(apexes)
        });
        faces_and_hinges.chain(self.stars.iter().flat_map(Star::pairs))
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    faces: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    parameters: Vec<FaceParameters>,
    /// Rest triangles without any stretch, and as they are now.
    unstretched: Vec<RestTriangle>,
    rest: Vec<RestTriangle>,
    membranes: Vec<Membrane>,
    membrane_slots: Vec<[Slot; 3]>,
    bending: LayerBending,
}

impl Sheet {
    /// A sheet at rest at the `positions` (m) of all vertices of the layer.
    pub(crate) fn new(
        topology: SheetTopology,
        positions: &[Vector3<f64>],
        parameters: Vec<FaceParameters>,
        pattern: &Pattern,
    ) -> Result<Self, ShellError> {
        let SheetTopology {
            faces,
            edges,
            stars,
        } = topology;
        let corners = faces.iter().map(|face| gather(positions, face));
        let rest = corners
            .enumerate()
            .map(|(index, corners)| RestTriangle::new(&corners, index))
            .collect::<Result<Vec<_>, _>>()?;
        let slots = |face: &[u32; 3]| FACE_PAIRS.map(|([i, j], _)| pattern.slot(face[i], face[j]));
        let mut this = Self {
            membranes: membranes(&rest, &parameters),
            membrane_slots: faces.iter().map(slots).collect(),
            bending: LayerBending::new(stars, &faces, &edges, positions, pattern),
            unstretched: rest.clone(),
            faces,
            edges,
            parameters,
            rest,
        };
        this.set_bending_stiffness();
        Ok(this)
    }

    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    pub(crate) fn edges(&self) -> &[Edge] {
        &self.edges
    }

    pub(crate) fn parameters(&self) -> &[FaceParameters] {
        &self.parameters
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
        let faces = self.unstretched.iter().zip(stretches).enumerate();
        faces
            .map(|(face, (rest, stretch))| rest.stretched(stretch, face))
            .collect()
    }

    pub(crate) fn set_rest(&mut self, rest: Vec<RestTriangle>) {
        self.membranes = membranes(&rest, &self.parameters);
        self.rest = rest;
        self.set_bending_stiffness();
    }

    /// Sets every face's Green strain without stress.
    pub(crate) fn set_natural_strains(&mut self, strains: &[Matrix2<f64>]) {
        for (membrane, strain) in self.membranes.iter_mut().zip(strains) {
            *membrane = membrane.with_natural_strain(*strain);
        }
    }

    pub(crate) fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) {
        self.bending.set_rest_angles(positions);
    }

    pub(crate) fn set_bending_factor(&mut self, factor: f64) {
        self.bending.set_factor(factor);
        self.set_bending_stiffness();
    }

    fn set_bending_stiffness(&mut self) {
        self.bending
            .set_rest(&self.edges, &self.rest, &self.parameters);
    }

    /// Energies of membrane and bending (J).
    pub(crate) fn values(&self, x: &[Vector3<f64>]) -> [f64; 2] {
        let faces = self.faces.iter().zip(&self.membranes);
        let membrane = faces.map(|(face, membrane)| membrane.value(&gather(x, face)));
        [membrane.sum(), self.bending.value(x)]
    }

    pub(crate) fn add_gradient(&self, x: &[Vector3<f64>], pattern: &Pattern, gradient: &mut [f64]) {
        for (face, membrane) in self.faces.iter().zip(&self.membranes) {
            let forces = membrane.gradient(&gather(x, face));
            pattern.add_forces(gradient, face, &forces);
        }
        self.bending.add_gradient(x, pattern, gradient);
    }

    /// An empty `relaxed` is not wanted.
    pub(crate) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        pattern: &Pattern,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        let elements = self.faces.iter().zip(&self.membranes);
        for ((face, membrane), slots) in elements.zip(&self.membrane_slots) {
            let state = membrane.state(&gather(x, face));
            let material = membrane.material_blocks(&state);
            let add = |values: &mut [f64], stress: Stress| {
                let blocks = membrane.with_stress(&material, &state, stress);
                for (&vertex, block) in face.iter().zip(FACE_DIAGONAL) {
                    pattern.add_diagonal(values, vertex, &blocks[block]);
                }
                for (&slot, (_, block)) in slots.iter().zip(FACE_PAIRS) {
                    Pattern::add_block(values, slot, &blocks[block]);
                }
            };
            add(exact, Stress::Full);
            if !relaxed.is_empty() {
                add(relaxed, Stress::Tensile);
            }
        }
        self.bending.add_hessian(x, pattern, exact, relaxed);
    }

    /// Principal strains of each face against the present rest metric.
    pub(crate) fn principal_strains(&self, x: &[Vector3<f64>]) -> Vec<PrincipalStrain> {
        let faces = self.faces.iter().zip(&self.membranes);
        let strain = |(face, membrane): (&[u32; 3], &Membrane)| {
            PrincipalStrain::from_green(&membrane.state(&gather(x, face)).strain())
        };
        faces.map(strain).collect()
    }
}

fn membranes(rest: &[RestTriangle], parameters: &[FaceParameters]) -> Vec<Membrane> {
    let faces = rest.iter().zip(parameters);
    faces
        .map(|(rest, p)| Membrane::new(rest, p.tension_modulus(), p.poisson))
        .collect()
}

/// Checks the rest positions (m) of all vertices, which some of `faces` have to hold unless they are
/// `pinned`.
pub(crate) fn check_positions(
    positions: &[Vector3<f64>],
    faces: &[[u32; 3]],
    pinned: &[bool],
) -> Result<(), ShellError> {
    let mut held = pinned.to_vec();
    for &vertex in faces.iter().flatten() {
        held[vertex as usize] = true;
    }
    if let Some(vertex) = held.iter().position(|held| !held) {
        return Err(ShellError::IsolatedVertex { vertex });
    }
    check_finite("rest position", positions.iter().flatten(), 3)
}
