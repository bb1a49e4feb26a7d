//! All energies of a layer, assembled over its free vertices.

mod by_face;
mod creases;
mod material;
mod mirror_plane;
mod rest_shape;

use nalgebra::Vector3;

use ruga_mesh::{BlockPattern, PerVertex, TriMesh, vertex_normals};

use crate::foundation::Anchor;
use crate::layer_foundation::{FoundationStiffness, LayerFoundation, anchors, deviations};
use crate::layer_part::PartNumbers;
use crate::parameters::{check_finite, check_length};
use crate::sheet::Sheet;
use crate::sheet_springs::{SheetSprings, both};
use crate::{BendingModel, EnergyParts, LayerParameters, ShellError, UpperSheet};
use mirror_plane::MirrorPlane;

/// Membrane, bending and foundation of a layer, or of a pair of sheets one on the other that move
/// together.
///
/// Every vertex has a position; only those that are not pinned have degrees of freedom, three
/// each (x, y, z) in the order of the vertices. A pinned vertex still strains its faces, bends
/// and deviates from the base. Terms are summed in a fixed order: same input, same bytes.
///
/// Of a pair the lower sheet lies on the foundation, and springs ([`crate::LayerSprings`] per face)
/// hold the upper one on it: the reference for methods that solve layers one after the other, for
/// nothing is passed on and both are unknown. Positions are those of all lower vertices, then of all
/// upper ones; small waves are those of the matrix that `two_shells` in the material crate states.
///
/// # Panics
/// Methods that take positions or a target slice panic when its length is not the layer's.
#[derive(Clone, Debug)]
pub struct LayerEnergy {
    /// Sheets, the lower one first; they have the same faces.
    sheets: Vec<Sheet>,
    /// Springs between the two sheets of a pair.
    springs: Option<SheetSprings>,
    bending_model: BendingModel,
    foundation: LayerFoundation,
    pattern: BlockPattern,
    /// Where the layer is one half of a symmetric one.
    mirror_plane: MirrorPlane,
}

impl LayerEnergy {
    /// A layer that bends in hinges, at rest on itself: [`Self::with_bending`] with
    /// [`BendingModel::Hinge`].
    ///
    /// # Errors
    /// Those of [`Self::with_bending`].
    pub fn new(
        mesh: &TriMesh,
        rest_positions: &[Vector3<f64>],
        parameters: LayerParameters,
        pinned: &[bool],
    ) -> Result<Self, ShellError> {
        let model = BendingModel::Hinge;
        Self::with_bending(mesh, rest_positions, parameters, pinned, model)
    }

    /// A layer at rest on itself: rest angles and metric are those of `rest_positions` (m), the
    /// base is the rest surface with its area-weighted normals and no offset.
    ///
    /// `rest_positions` and `pinned` have one entry per vertex.
    ///
    /// # Errors
    /// Any [`ShellError`] about lengths, degenerate faces or parameters.
    pub fn with_bending(
        mesh: &TriMesh,
        rest_positions: &[Vector3<f64>],
        parameters: LayerParameters,
        pinned: &[bool],
        bending_model: BendingModel,
    ) -> Result<Self, ShellError> {
        let at_rest = (mesh, rest_positions, pinned);
        Self::build(at_rest, &[], parameters, None, bending_model)
    }

    /// A layer that may be one half of a symmetric one, which is its own mirror image at a plane of constant x:
    /// [`Self::with_bending`] with the vertices `on_plane`, where it ends, pinned ones among them; none, or an empty
    /// list, for a layer that does not reach the plane.
    ///
    /// Energy is that of the half. It bends across the plane as if its mirror image went on there. Vertices on the
    /// plane that are not pinned keep three degrees of freedom each, of which x has no force and no coupling to others,
    /// only a positive entry on the diagonal of the Hessian: a solver leaves it as it is.
    ///
    /// # Validity
    /// Where a pinned border meets the plane, the vertex between them bends as at any other border. Natural curvatures
    /// that are askew at the plane have no mirror image.
    ///
    /// # Errors
    /// Those of [`Self::with_bending`].
    pub fn half(
        at_rest: (&TriMesh, &[Vector3<f64>], &[bool]),
        on_plane: &[bool],
        parameters: LayerParameters,
        bending_model: BendingModel,
    ) -> Result<Self, ShellError> {
        if !on_plane.is_empty() {
            check_length(
                "vertices on the plane",
                at_rest.0.vertex_count(),
                on_plane.len(),
            )?;
        }
        Self::build(at_rest, on_plane, parameters, None, bending_model)
    }

    /// A layer with an `upper` sheet that moves together with it, both at rest; a vertex is pinned in
    /// both.
    ///
    /// # Errors
    /// Those of [`Self::with_bending`], for either sheet; [`ShellError::ParameterOutOfRange`] for a
    /// mid-surface offset.
    pub fn pair(
        at_rest: (&TriMesh, &[Vector3<f64>], &[bool]),
        parameters: LayerParameters,
        upper: UpperSheet,
        bending_model: BendingModel,
    ) -> Result<Self, ShellError> {
        Self::build(at_rest, &[], parameters, Some(upper), bending_model)
    }

    fn build(
        (mesh, rest, pinned): (&TriMesh, &[Vector3<f64>], &[bool]),
        on_plane: &[bool],
        parameters: LayerParameters,
        upper: Option<UpperSheet>,
        bending_model: BendingModel,
    ) -> Result<Self, ShellError> {
        let (count, face_count) = (mesh.vertex_count(), mesh.face_count());
        check_length("rest positions", count, rest.len())?;
        check_length("pinned", count, pinned.len())?;
        parameters.check(face_count, count)?;
        check_held(mesh, pinned)?;
        let mut normals = vertex_normals(mesh, rest);
        for (normal, _) in normals.iter_mut().zip(on_plane).filter(|(_, on)| **on) {
            // The faces on the other side lean the other way.
            normal.x = 0.0;
            *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::y);
        }
        // Both sheets stand in one pattern, since the springs couple their vertices and the solver
        // sees one matrix.
        let (mut rest, mut pinned) = (rest.to_vec(), pinned.to_vec());
        let mut sheets = vec![(0, parameters.faces)];
        let mut between: Vec<[u32; 6]> = Vec::new();
        if let Some(upper) = &upper {
            upper.check(face_count, count)?;
            rest.extend_from_slice(&upper.rest_positions);
            pinned.extend_from_within(..);
            sheets.push((count as u32, upper.parameters.faces.clone()));
            let faces = mesh.faces().as_slice().iter();
            between.extend(faces.map(|face| both(face.map(|v| v.0), count as u32)));
        }
        check_finite("rest position", rest.iter().flatten(), 3)?;
        let sheets = sheets
            .into_iter()
            .map(|(before, faces)| {
                Sheet::new((mesh, on_plane), (before, bending_model), &rest, faces)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let of_sheets = sheets.iter().flat_map(Sheet::stencils);
        let stencils = of_sheets.chain(between.iter().map(<[u32; 6]>::as_slice));
        let pattern = BlockPattern::new(&pinned, stencils);
        let springs = upper.map(|upper| {
            let parameters = upper.springs(sheets[0].faces());
            SheetSprings::new(
                (&between, sheets[0].rest()),
                parameters,
                upper.offsets,
                &pattern,
            )
        });
        let anchors = normals.into_iter().zip(&rest);
        let anchors = anchors.map(|(normal, &point)| Anchor { point, normal });
        let tangential = parameters.tangential_stiffness;
        let lower = (mesh, &sheets[0]);
        let foundation = LayerFoundation::new(lower, tangential, &pattern, anchors.collect());
        let mirror_plane = MirrorPlane::new(&pattern, on_plane, sheets[0].parameters());
        Ok(Self {
            mirror_plane,
            sheets,
            springs,
            bending_model,
            foundation,
            pattern,
        })
    }

    /// The layer's sheet and foundation; `None` for a pair.
    pub(crate) fn one_sheet(&self) -> Option<(&Sheet, &LayerFoundation)> {
        match self.sheets.as_slice() {
            [sheet] => Some((sheet, &self.foundation)),
            _ => None,
        }
    }

    /// Energy of the stencils of one sheet with these numbers; values are still to be taken over by [`Self::follow`].
    pub(crate) fn part(&self, numbers: &PartNumbers) -> Self {
        let sheet = self.lower().part(numbers);
        let pinned: Vec<_> = numbers.is_free.iter().map(|free| !free).collect();
        let pattern = BlockPattern::new(&pinned, sheet.stencils());
        Self {
            mirror_plane: self.mirror_plane.part(numbers, &pattern),
            sheets: vec![sheet],
            springs: None,
            bending_model: self.bending_model,
            foundation: self.foundation.part(numbers, &pattern),
            pattern,
        }
    }

    /// Takes over the values of the `whole` that this is a part of.
    pub(crate) fn follow(&mut self, whole: &Self, numbers: &PartNumbers) {
        for (sheet, whole) in self.sheets.iter_mut().zip(&whole.sheets) {
            sheet.follow(whole, numbers);
        }
        self.foundation.follow(&whole.foundation, numbers);
    }

    /// Replaces the surface below: per vertex of the lower sheet a point (m), a unit normal and an offset (m) along it.
    ///
    /// # Errors
    /// Wrong lengths, values that are not finite, normals not of unit length.
    pub fn set_base(
        &mut self,
        points: &[Vector3<f64>],
        normals: &[Vector3<f64>],
        offsets: &[f64],
    ) -> Result<(), ShellError> {
        let anchors = anchors(points, normals, offsets, self.mesh_vertices())?;
        self.foundation.set_anchors(anchors);
        Ok(())
    }

    /// The model that the layer was built with.
    pub fn bending_model(&self) -> BendingModel {
        self.bending_model
    }

    /// Number of vertices, pinned ones included, of both sheets of a pair.
    pub fn vertex_count(&self) -> usize {
        self.pattern.point_count()
    }

    /// The free vertices; the `k`-th has degrees of freedom `3k`, `3k + 1`, `3k + 2`.
    pub fn free_vertices(&self) -> &[u32] {
        self.pattern.free_points()
    }

    /// Number of degrees of freedom.
    pub fn dof_count(&self) -> usize {
        self.pattern.size()
    }

    /// Column starts and row indices of the Hessian's lower triangle, diagonal included, rows
    /// sorted within each column.
    pub fn pattern(&self) -> (&[usize], &[u32]) {
        (self.pattern.column_starts(), self.pattern.rows())
    }

    /// The pattern by blocks of vertices.
    pub fn blocks(&self) -> &BlockPattern {
        &self.pattern
    }

    /// Forgets where the blocks of the sheets' stencils lie in a matrix; the next one looks them up anew.
    pub fn release_slots(&mut self) {
        self.sheets.iter_mut().for_each(Sheet::release_slots);
        self.mirror_plane.release_entries();
    }

    /// Energy (J) at the positions `x` (m) of all vertices.
    pub fn value(&self, x: &[Vector3<f64>]) -> f64 {
        self.total(x, self.foundation.anchors())
    }

    /// Energy (J) with the surface below at other `points` (m) but with the same normals.
    pub fn value_over(&self, x: &[Vector3<f64>], points: &[Vector3<f64>]) -> f64 {
        self.total(x, &self.foundation.anchors_at(points))
    }

    /// Energy by origin, without that of the springs between two sheets ([`Self::spring_parts`]).
    pub fn energy_parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        self.parts(x, self.foundation.anchors())
    }

    /// Energy of the springs between two sheets by origin; membrane and bending are zero.
    pub fn spring_parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        self.check(x);
        let springs = self.springs.as_ref();
        springs.map_or_else(EnergyParts::default, |springs| springs.parts(x))
    }

    fn total(&self, x: &[Vector3<f64>], anchors: &[Anchor]) -> f64 {
        let total = self.parts(x, anchors).total();
        match &self.springs {
            Some(springs) => total + springs.parts(x).total(),
            None => total,
        }
    }

    fn parts(&self, x: &[Vector3<f64>], anchors: &[Anchor]) -> EnergyParts {
        self.check(x);
        let [normal, gradient, tangential, anchored] =
            self.foundation.values(self.lower().faces(), anchors, x);
        let mut parts = EnergyParts {
            normal,
            gradient,
            tangential,
            anchored,
            ..EnergyParts::default()
        };
        for sheet in &self.sheets {
            let [membrane, bending] = sheet.values(x);
            parts.membrane += membrane;
            parts.bending += bending;
        }
        parts
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
        let springs = self.foundation.forces(self.lower().faces(), anchors, x);
        // An upper sheet has no foundation.
        gradient.fill(0.0);
        let free = gradient.chunks_exact_mut(3).zip(self.free_vertices());
        for (entries, &vertex) in free {
            if let Some(spring) = springs.get(vertex as usize) {
                entries.copy_from_slice(spring.as_slice());
            }
        }
        for sheet in &self.sheets {
            sheet.add_gradient(x, &self.pattern, gradient);
        }
        if let Some(springs) = &self.springs {
            springs.add_gradient(x, &self.pattern, gradient);
        }
        self.mirror_plane.clear_gradient(gradient);
        springs
    }

    /// Stiffness of the springs below, under the present rest metric.
    pub fn foundation_stiffness(&self) -> FoundationStiffness {
        self.foundation.stiffness()
    }

    /// Writes the second derivative (N/m), values in the order of [`Self::pattern`].
    ///
    /// `relaxed`, if asked for, takes the same matrix without compressive stress stiffness: tensile
    /// stress only in the membrane's geometric part, no second derivatives of angles in bending and of normals
    /// between sheets. It is positive
    /// semidefinite up to a negative `K1`.
    pub fn hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: Option<&mut [f64]>) {
        self.write_hessian(x, None, exact, relaxed);
    }

    /// Writes the same matrices with the membrane stress that a linearisation at `from` predicts for `x`, see
    /// [`Membrane::predicted_state`](crate::Membrane::predicted_state).
    ///
    /// A straight step that turns a face by an angle stretches it by half the square of that, which against bending
    /// is stiff; with the predicted stress the next step does not take that stretch for a tension.
    pub fn predicted_hessian(
        &self,
        x: &[Vector3<f64>],
        from: &[Vector3<f64>],
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        self.check(from);
        self.write_hessian(x, Some(from), exact, Some(relaxed));
    }

    fn write_hessian(
        &self,
        x: &[Vector3<f64>],
        from: Option<&[Vector3<f64>]>,
        exact: &mut [f64],
        relaxed: Option<&mut [f64]>,
    ) {
        self.check(x);
        let entries = self.pattern.rows().len();
        assert_eq!(exact.len(), entries, "one value per entry of the pattern");
        exact.fill(0.0);
        self.foundation.add_hessian(&self.pattern, exact);
        let relaxed = match relaxed {
            None => &mut [],
            Some(relaxed) => {
                // A negative K1 stays in: K0 and bending outweigh it, so that the sum is still
                // definite.
                relaxed.copy_from_slice(exact);
                relaxed
            }
        };
        for sheet in &self.sheets {
            sheet.add_hessian((x, from), &self.pattern, exact, relaxed);
        }
        if let Some(springs) = &self.springs {
            springs.add_hessian(x, exact, relaxed);
        }
        for values in [exact, relaxed] {
            self.mirror_plane.clear_hessian(&self.pattern, values);
        }
    }

    /// Rest area of each vertex of the lower sheet (m²): a third of what is left of its faces, under the
    /// present rest metric.
    pub fn vertex_areas(&self) -> &[f64] {
        self.foundation.vertex_areas()
    }

    /// Normal deviation of each vertex of the lower sheet from the base plus offset (m).
    pub fn deviations(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        self.check(x);
        deviations(self.foundation.anchors(), x)
    }

    fn check(&self, x: &[Vector3<f64>]) {
        assert_eq!(x.len(), self.vertex_count(), "one position per vertex");
    }

    fn lower(&self) -> &Sheet {
        &self.sheets[0]
    }

    /// Vertices of the lower sheet.
    fn mesh_vertices(&self) -> usize {
        self.foundation.anchors().len()
    }
}

/// Refuses vertices that would move without being held by any face.
fn check_held(mesh: &TriMesh, pinned: &[bool]) -> Result<(), ShellError> {
    // Without a face all rows of the vertex are zero, and the Hessian is singular.
    let faces = PerVertex::filled(mesh.vertex_count(), ())
        .ids()
        .map(|v| mesh.vertex_faces(v));
    let mut lost = faces
        .zip(pinned)
        .map(|(faces, pinned)| faces.is_empty() && !pinned);
    match lost.position(|lost| lost) {
        None => Ok(()),
        Some(vertex) => Err(ShellError::IsolatedVertex { vertex }),
    }
}
