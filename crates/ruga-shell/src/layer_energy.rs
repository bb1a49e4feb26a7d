//! All energies of one layer, assembled over its free vertices.

use nalgebra::{Matrix2, Vector3};

use crate::edges::{Edge, edges};
use crate::foundation::Anchor;
use crate::layer_bending::{LayerBending, bending_stars};
use crate::layer_foundation::{FoundationStiffness, LayerFoundation, anchors, deviations};
use crate::measures::{PrincipalStrain, vertex_normals};
use crate::membrane::{Membrane, Stress};
use crate::parameters::{check_finite, check_length};
use crate::pattern::{Pattern, Slot};
use crate::stars::Star;
use crate::{BendingModel, FaceParameters, LayerParameters, RestTriangle, ShellError};

/// Membrane, bending and foundation of one layer.
///
/// Every vertex has a position; only those that are not pinned have degrees of freedom, three
/// each (x, y, z) in the order of the vertices. A pinned vertex still strains its faces, bends
/// and deviates from the base. Terms are summed in a fixed order: same input, same bytes.
///
/// # Panics
/// Methods that take positions or a target slice panic when its length is not the layer's.
#[derive(Clone, Debug)]
pub struct LayerEnergy {
    faces: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    parameters: LayerParameters,
    /// Rest triangles without any stretch, and as they are now.
    unstretched: Vec<RestTriangle>,
    rest: Vec<RestTriangle>,
    membranes: Vec<Membrane>,
    membrane_slots: Vec<[Slot; 3]>,
    bending: LayerBending,
    bending_model: BendingModel,
    foundation: LayerFoundation,
    foundation_hessian: Vec<f64>,
    pattern: Pattern,
}

/// Row and column, within a stencil, of the off-diagonal blocks in the order of the slots, and
/// their positions in the stencil's list of lower blocks.
const FACE_PAIRS: [([usize; 2], usize); 3] = [([1, 0], 1), ([2, 0], 3), ([2, 1], 4)];
const FACE_DIAGONAL: [usize; 3] = [0, 2, 5];

/// Where the energy of a layer sits (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyParts {
    /// In-plane stretch.
    pub membrane: f64,
    /// Out of the plane.
    pub bending: f64,
    /// Foundation, `K0` term.
    pub normal: f64,
    /// Foundation, `K1` term; negative where `K1` is.
    pub gradient: f64,
    /// Tangential tie.
    pub tangential: f64,
}

impl EnergyParts {
    /// Sum of the parts (J).
    pub fn total(&self) -> f64 {
        self.membrane + self.bending + self.normal + self.gradient + self.tangential
    }
}

impl LayerEnergy {
    /// A layer that bends in hinges, at rest on itself: [`Self::with_bending`] with
    /// [`BendingModel::Hinge`].
    ///
    /// # Errors
    /// Those of [`Self::with_bending`].
    pub fn new(
        rest_positions: &[Vector3<f64>],
        faces: &[[u32; 3]],
        parameters: LayerParameters,
        pinned: &[bool],
    ) -> Result<Self, ShellError> {
        let model = BendingModel::Hinge;
        Self::with_bending(rest_positions, faces, parameters, pinned, model)
    }

    /// A layer at rest on itself: rest angles and metric are those of `rest_positions` (m), the
    /// base is the rest surface with its area-weighted normals and no offset.
    ///
    /// `faces` name vertices counter-clockwise; `pinned` has one entry per vertex.
    ///
    /// # Errors
    /// Any [`ShellError`] about lengths, indices, orientation, degenerate faces or parameters.
    pub fn with_bending(
        rest_positions: &[Vector3<f64>],
        faces: &[[u32; 3]],
        parameters: LayerParameters,
        pinned: &[bool],
        bending_model: BendingModel,
    ) -> Result<Self, ShellError> {
        let vertices = rest_positions.len();
        check_length("pinned", vertices, pinned.len())?;
        parameters.check(faces.len(), vertices)?;
        let edges = edges(faces, vertices)?;
        check_positions(rest_positions, faces, pinned)?;
        let corners = |face: &[u32; 3]| face.map(|v| rest_positions[v as usize]);
        let rest = faces
            .iter()
            .enumerate()
            .map(|(index, face)| RestTriangle::new(&corners(face), index))
            .collect::<Result<Vec<_>, _>>()?;

        let stars = bending_stars(bending_model, faces, &edges);
        let pairs = stencil_pairs(faces, &edges).chain(stars.iter().flat_map(Star::pairs));
        let pattern = Pattern::new(pinned, pairs);
        let anchors = vertex_normals(rest_positions, faces)
            .into_iter()
            .zip(rest_positions)
            .map(|(normal, &point)| Anchor { point, normal })
            .collect();
        let foundation = LayerFoundation::new(faces, &edges, &rest, &parameters, &pattern, anchors);
        let mut this = Self {
            membranes: membranes(&rest, &parameters),
            membrane_slots: faces
                .iter()
                .map(|face| FACE_PAIRS.map(|([i, j], _)| pattern.slot(face[i], face[j])))
                .collect(),
            bending: LayerBending::new(stars, faces, &edges, rest_positions, &pattern),
            bending_model,
            foundation_hessian: foundation.hessian(&edges, &pattern),
            faces: faces.to_vec(),
            unstretched: rest.clone(),
            edges,
            parameters,
            rest,
            foundation,
            pattern,
        };
        this.set_bending_stiffness();
        Ok(this)
    }

    /// Replaces the surface below: per vertex a point (m), a unit normal and an offset (m) along it.
    ///
    /// # Errors
    /// Wrong lengths, values that are not finite, normals not of unit length.
    pub fn set_base(
        &mut self,
        points: &[Vector3<f64>],
        normals: &[Vector3<f64>],
        offsets: &[f64],
    ) -> Result<(), ShellError> {
        let anchors = anchors(points, normals, offsets, self.pattern.free_of.len())?;
        self.foundation.set_anchors(anchors);
        self.foundation_hessian = self.foundation.hessian(&self.edges, &self.pattern);
        Ok(())
    }

    /// Stretches every rest triangle, as built, by a 2×2 matrix in its local frame
    /// ([`crate::rest_frame`]): the rest metric becomes `S^T S`. Replaces any earlier stretch.
    ///
    /// Membrane, bending stiffness and foundation all follow; rest angles stay, and natural strains
    /// are zero again.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`], [`ShellError::InvertedStretch`],
    /// [`ShellError::DegenerateFace`]; the layer is then unchanged.
    pub fn set_rest_metric(&mut self, stretches: &[Matrix2<f64>]) -> Result<(), ShellError> {
        check_length("rest stretches", self.faces.len(), stretches.len())?;
        self.rest = self
            .unstretched
            .iter()
            .zip(stretches)
            .enumerate()
            .map(|(face, (rest, stretch))| rest.stretched(stretch, face))
            .collect::<Result<_, _>>()?;
        self.membranes = membranes(&self.rest, &self.parameters);
        self.set_bending_stiffness();
        self.foundation
            .set_rest(&self.faces, &self.edges, &self.rest, &self.parameters);
        self.foundation_hessian = self.foundation.hessian(&self.edges, &self.pattern);
        Ok(())
    }

    /// Sets every face's Green strain without stress, in the frame of its stretched rest triangle.
    ///
    /// With `(1 - s)` times the strain of a surface the layer on it has `s` times its strain, while
    /// bending and foundation, and so the length of the waves, stay those of the rest metric.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`] for an array of another size;
    /// [`ShellError::ParameterOutOfRange`] for a strain that is not finite.
    pub fn set_natural_strains(&mut self, strains: &[Matrix2<f64>]) -> Result<(), ShellError> {
        self.check_natural_strains(strains)?;
        for (membrane, strain) in self.membranes.iter_mut().zip(strains) {
            *membrane = membrane.with_natural_strain(*strain);
        }
        Ok(())
    }

    pub(crate) fn check_natural_strains(&self, strains: &[Matrix2<f64>]) -> Result<(), ShellError> {
        check_length("natural strains", self.faces.len(), strains.len())?;
        let mut values = strains.iter().flatten().enumerate();
        match values.find(|(_, value)| !value.is_finite()) {
            None => Ok(()),
            Some((index, &value)) => Err(ShellError::ParameterOutOfRange {
                element: "face",
                index: index / 4,
                name: "natural strain",
                value,
                range: "finite",
            }),
        }
    }

    /// Makes the angles of `positions` (m) the rest angles: the layer is not bent there.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`] for an array of another size; [`ShellError::NotFinite`].
    pub fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) -> Result<(), ShellError> {
        check_length("positions", self.vertex_count(), positions.len())?;
        check_finite("position", positions.iter().flatten(), 3)?;
        self.bending.set_rest_angles(positions);
        Ok(())
    }

    fn set_bending_stiffness(&mut self) {
        self.bending
            .set_rest(&self.edges, &self.rest, &self.parameters);
    }

    /// The model that the layer was built with.
    pub fn bending_model(&self) -> BendingModel {
        self.bending_model
    }

    /// Scales the bending stiffness, 1 when built.
    ///
    /// Triangles that are not equilateral bend more or less easily than the material; the
    /// inverse of their [`response_modulus`](crate::response_modulus), as a share of the
    /// material's, makes up for it on average.
    ///
    /// # Errors
    /// [`ShellError::BendingFactor`] unless the factor is positive and finite.
    pub fn set_bending_factor(&mut self, factor: f64) -> Result<(), ShellError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(ShellError::BendingFactor { value: factor });
        }
        self.bending.set_factor(factor);
        self.set_bending_stiffness();
        Ok(())
    }

    /// Number of vertices, pinned ones included.
    pub fn vertex_count(&self) -> usize {
        self.pattern.free_of.len()
    }

    /// The free vertices; the `k`-th has degrees of freedom `3k`, `3k + 1`, `3k + 2`.
    pub fn free_vertices(&self) -> &[u32] {
        &self.pattern.free_vertices
    }

    /// Number of degrees of freedom.
    pub fn dof_count(&self) -> usize {
        3 * self.pattern.free_vertices.len()
    }

    /// Column starts and row indices of the Hessian's lower triangle, diagonal included, rows
    /// sorted within each column.
    pub fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.pattern.column_starts, &self.pattern.rows)
    }

    /// Energy (J) at the positions `x` (m) of all vertices.
    pub fn value(&self, x: &[Vector3<f64>]) -> f64 {
        self.energy_parts(x).total()
    }

    /// Energy (J) with the surface below at other `points` (m) but with the same normals.
    pub fn value_over(&self, x: &[Vector3<f64>], points: &[Vector3<f64>]) -> f64 {
        self.parts(x, &self.foundation.anchors_at(points)).total()
    }

    /// Energy by origin.
    pub fn energy_parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        self.parts(x, self.foundation.anchors())
    }

    fn parts(&self, x: &[Vector3<f64>], anchors: &[Anchor]) -> EnergyParts {
        self.check(x);
        let [normal, gradient, tangential] = self.foundation.values(&self.faces, anchors, x);
        EnergyParts {
            membrane: self
                .faces
                .iter()
                .zip(&self.membranes)
                .map(|(face, membrane)| membrane.value(&gather(x, face)))
                .sum(),
            bending: self.bending.value(x),
            normal,
            gradient,
            tangential,
        }
    }

    /// Writes the derivative of the energy by the degrees of freedom (N).
    pub fn gradient(&self, x: &[Vector3<f64>], gradient: &mut [f64]) {
        self.write_gradient(x, self.foundation.anchors(), gradient);
    }

    /// Writes the derivative by the degrees of freedom (N) with the surface below at other `points`
    /// (m) but with the same normals, and returns how the springs below pull at every vertex (N).
    ///
    /// The energy depends on differences of `x` and `points` only, so that its derivative by the
    /// points is the negative of that pull.
    pub fn gradient_over(
        &self,
        x: &[Vector3<f64>],
        points: &[Vector3<f64>],
        gradient: &mut [f64],
    ) -> Vec<Vector3<f64>> {
        self.write_gradient(x, &self.foundation.anchors_at(points), gradient)
    }

    fn write_gradient(
        &self,
        x: &[Vector3<f64>],
        anchors: &[Anchor],
        gradient: &mut [f64],
    ) -> Vec<Vector3<f64>> {
        self.check(x);
        assert_eq!(gradient.len(), self.dof_count(), "one entry per dof");
        let springs = self.foundation.forces(&self.faces, anchors, x);
        let free = gradient.chunks_exact_mut(3).zip(self.free_vertices());
        for (entries, &vertex) in free {
            entries.copy_from_slice(springs[vertex as usize].as_slice());
        }
        for (face, membrane) in self.faces.iter().zip(&self.membranes) {
            let forces = membrane.gradient(&gather(x, face));
            self.pattern.add_forces(gradient, face, &forces);
        }
        self.bending.add_gradient(x, &self.pattern, gradient);
        springs
    }

    /// Stiffness of the springs below, under the present rest metric.
    pub fn foundation_stiffness(&self) -> FoundationStiffness {
        self.foundation.stiffness(&self.edges)
    }

    /// Writes the second derivative (N/m), values in the order of [`Self::pattern`].
    ///
    /// `relaxed`, if asked for, takes the same matrix without compressive stress stiffness: tensile
    /// stress only in the membrane's geometric part, no second derivatives of angles in bending. It is positive
    /// semidefinite up to a negative `K1`.
    pub fn hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: Option<&mut [f64]>) {
        self.check(x);
        exact.copy_from_slice(&self.foundation_hessian);
        match relaxed {
            None => {
                self.add_membrane(x, exact, &mut []);
                self.bending.add_hessian(x, &self.pattern, exact, &mut []);
            }
            Some(relaxed) => {
                relaxed.copy_from_slice(&self.foundation_hessian);
                self.add_membrane(x, exact, relaxed);
                self.bending.add_hessian(x, &self.pattern, exact, relaxed);
            }
        }
    }

    /// An empty `relaxed` is not wanted.
    fn add_membrane(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        let elements = self.faces.iter().zip(&self.membranes);
        for ((face, membrane), slots) in elements.zip(&self.membrane_slots) {
            let state = membrane.state(&gather(x, face));
            let material = membrane.material_blocks(&state);
            let add = |values: &mut [f64], stress: Stress| {
                let blocks = membrane.with_stress(&material, &state, stress);
                for (&vertex, block) in face.iter().zip(FACE_DIAGONAL) {
                    self.pattern.add_diagonal(values, vertex, &blocks[block]);
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
    }

    /// Rest area of each vertex (m²): a third of its faces, under the present rest metric.
    pub fn vertex_areas(&self) -> &[f64] {
        self.foundation.vertex_areas()
    }

    /// Normal deviation of each vertex from the base plus offset (m).
    pub fn deviations(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        self.check(x);
        deviations(self.foundation.anchors(), x)
    }

    /// Principal strains of each face against the present rest metric.
    pub fn principal_strains(&self, x: &[Vector3<f64>]) -> Vec<PrincipalStrain> {
        self.check(x);
        self.faces
            .iter()
            .zip(&self.membranes)
            .map(|(face, membrane)| {
                PrincipalStrain::from_green(&membrane.state(&gather(x, face)).strain())
            })
            .collect()
    }

    fn check(&self, x: &[Vector3<f64>]) {
        assert_eq!(x.len(), self.vertex_count(), "one position per vertex");
    }

    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Rest triangles under the present rest metric.
    pub(crate) fn rest_triangles(&self) -> &[RestTriangle] {
        &self.rest
    }

    pub(crate) fn is_pinned(&self, vertex: usize) -> bool {
        self.pattern.free(vertex as u32).is_none()
    }

    /// Every two vertices that share a stencil.
    pub(crate) fn stencil_pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        stencil_pairs(&self.faces, &self.edges).chain(self.bending.star_pairs())
    }

    /// Whether no foundation holds the layer.
    pub(crate) fn is_unsupported(&self) -> bool {
        let springs = |p: &FaceParameters| p.normal_stiffness != 0.0 || p.gradient_stiffness != 0.0;
        let tied = |&stiffness: &f64| stiffness != 0.0;
        !self.parameters.faces.iter().any(springs)
            && !self.parameters.tangential_stiffness.iter().any(tied)
    }
}

#[inline]
pub(crate) fn gather<const N: usize>(x: &[Vector3<f64>], vertices: &[u32; N]) -> [Vector3<f64>; N] {
    vertices.map(|v| x[v as usize])
}

fn membranes(rest: &[RestTriangle], parameters: &LayerParameters) -> Vec<Membrane> {
    rest.iter()
        .zip(&parameters.faces)
        .map(|(rest, p)| Membrane::new(rest, p.tension_modulus(), p.poisson))
        .collect()
}

/// Every two vertices that share a face or a hinge.
fn stencil_pairs<'a>(
    faces: &'a [[u32; 3]],
    edges: &'a [Edge],
) -> impl Iterator<Item = [u32; 2]> + 'a {
    edges.iter().flat_map(|edge| {
        let apexes = edge
            .hinge(faces)
            .map(|([_, _, left, right], _)| [left, right]);
        std::iter::once(edge.ends).chain(apexes)
    })
}

fn check_positions(
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
