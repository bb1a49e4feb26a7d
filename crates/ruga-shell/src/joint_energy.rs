//! Two layers that move together: each one's energy, and the springs between them.

use nalgebra::{Matrix2, Matrix3, Vector3};

use crate::layer_energy::gather;
use crate::parameters::{check_finite, check_length};
use crate::pattern::{Pattern, Slot};
use crate::{EnergyParts, LayerEnergy, LayerTie, ShellError, TieParameters, TieState};

/// A lower layer on its foundation, an upper layer on the lower one.
///
/// The reference for methods that solve the layers one after the other: nothing is passed on, both
/// are unknown. The layers have the same faces, and vertex `i` of the upper layer lies above vertex
/// `i` of the lower one. Energies are those of both [`LayerEnergy`]s and of a [`LayerTie`] per face;
/// small waves of the pair are those of the matrix that `two_shells` in the material crate states.
///
/// # Shapes and units
/// Positions are those of all lower vertices, then of all upper ones (m). Degrees of freedom run
/// over the free vertices in the same order, three each; the pattern is in the conventions of
/// [`LayerEnergy::pattern`]. A pinned vertex is pinned in both layers.
///
/// # Panics
/// As [`LayerEnergy`], when a position or target slice has the wrong length.
#[derive(Clone, Debug)]
pub struct JointEnergy {
    lower: LayerEnergy,
    upper: LayerEnergy,
    parameters: Vec<TieParameters>,
    levers: Vec<f64>,
    ties: Vec<TieElement>,
    pattern: Pattern,
}

#[derive(Clone, Copy, Debug)]
struct TieElement {
    tie: LayerTie,
    /// Lower corners, then upper ones, as numbered among the positions of both layers.
    vertices: [u32; 6],
    slots: [Slot; 15],
}

/// Row and column, within a tie, of the off-diagonal blocks in the order of the slots, and their
/// positions in the stencil's list of lower blocks.
const PAIRS: [([usize; 2], usize); 15] = [
    ([1, 0], 1),
    ([2, 0], 3),
    ([2, 1], 4),
    ([3, 0], 6),
    ([3, 1], 7),
    ([3, 2], 8),
    ([4, 0], 10),
    ([4, 1], 11),
    ([4, 2], 12),
    ([4, 3], 13),
    ([5, 0], 15),
    ([5, 1], 16),
    ([5, 2], 17),
    ([5, 3], 18),
    ([5, 4], 19),
];
const DIAGONAL: [usize; 6] = [0, 2, 5, 9, 14, 20];

/// Where the energy of two layers sits (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointParts {
    /// The lower layer with its foundation.
    pub lower: EnergyParts,
    /// The upper layer; its foundation parts are zero.
    pub upper: EnergyParts,
    /// The springs between them; membrane and bending are zero.
    pub tie: EnergyParts,
}

impl JointParts {
    /// Sum of the parts (J).
    pub fn total(&self) -> f64 {
        self.lower.total() + self.upper.total() + self.tie.total()
    }
}

impl JointEnergy {
    /// Lays `upper` on `lower`: `parameters` has one entry per face, `levers` the distance (m) of
    /// the mid-surfaces, along the lower layer's normal, per vertex.
    ///
    /// The present rest metrics, rest angles and base of the layers are kept.
    ///
    /// # Errors
    /// [`ShellError::LayersDiffer`], [`ShellError::PinnedInOneLayer`],
    /// [`ShellError::SupportedUpperLayer`]; arrays of other lengths and parameters out of range.
    pub fn new(
        lower: LayerEnergy,
        upper: LayerEnergy,
        parameters: &[TieParameters],
        levers: &[f64],
    ) -> Result<Self, ShellError> {
        check_layers(&lower, &upper)?;
        check_length("tie parameters", lower.faces().len(), parameters.len())?;
        for (face, parameters) in parameters.iter().enumerate() {
            parameters.check(face)?;
        }
        check_levers(levers, lower.vertex_count())?;
        let count = lower.vertex_count();
        let pinned: Vec<bool> = (0..2 * count)
            .map(|vertex| lower.is_pinned(vertex % count))
            .collect();
        let pattern = Pattern::new(&pinned, pairs(&lower, &upper));
        let ties = ties(&lower, parameters, levers)
            .zip(lower.faces())
            .map(|(tie, face)| {
                let vertices = both(face, count);
                TieElement {
                    tie,
                    vertices,
                    slots: PAIRS.map(|([i, j], _)| pattern.slot(vertices[i], vertices[j])),
                }
            })
            .collect();
        Ok(Self {
            parameters: parameters.to_vec(),
            levers: levers.to_vec(),
            lower,
            upper,
            ties,
            pattern,
        })
    }

    /// The lower layer; its positions are the first half.
    pub fn lower(&self) -> &LayerEnergy {
        &self.lower
    }

    /// The upper layer; its positions are the second half.
    pub fn upper(&self) -> &LayerEnergy {
        &self.upper
    }

    /// Replaces the surface below the lower layer, as [`LayerEnergy::set_base`].
    ///
    /// # Errors
    /// Those of [`LayerEnergy::set_base`].
    pub fn set_base(
        &mut self,
        points: &[Vector3<f64>],
        normals: &[Vector3<f64>],
        offsets: &[f64],
    ) -> Result<(), ShellError> {
        self.lower.set_base(points, normals, offsets)
    }

    /// Stretches the rest triangles of both layers, as [`LayerEnergy::set_rest_metric`]; the tie
    /// follows the lower one.
    ///
    /// # Errors
    /// Those of [`LayerEnergy::set_rest_metric`]; both layers are then unchanged.
    pub fn set_rest_metric(
        &mut self,
        lower: &[Matrix2<f64>],
        upper: &[Matrix2<f64>],
    ) -> Result<(), ShellError> {
        let mut stretched = self.lower.clone();
        stretched.set_rest_metric(lower)?;
        self.upper.set_rest_metric(upper)?;
        self.lower = stretched;
        let ties = ties(&self.lower, &self.parameters, &self.levers);
        for (element, tie) in self.ties.iter_mut().zip(ties) {
            element.tie = tie;
        }
        Ok(())
    }

    /// Sets every face's Green strain without stress, of each layer, as
    /// [`LayerEnergy::set_natural_strains`].
    ///
    /// # Errors
    /// Those of [`LayerEnergy::set_natural_strains`]; both layers are then unchanged.
    pub fn set_natural_strains(
        &mut self,
        lower: &[Matrix2<f64>],
        upper: &[Matrix2<f64>],
    ) -> Result<(), ShellError> {
        self.upper.check_natural_strains(upper)?;
        self.lower.set_natural_strains(lower)?;
        self.upper.set_natural_strains(upper)
    }

    /// Makes the angles of `positions` (m, both layers) the rest angles of each layer.
    ///
    /// # Errors
    /// [`ShellError::LengthMismatch`] for an array of another size; [`ShellError::NotFinite`]. Both
    /// layers are then unchanged.
    pub fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) -> Result<(), ShellError> {
        check_length("positions", self.vertex_count(), positions.len())?;
        check_finite("position", positions.iter().flatten(), 3)?;
        let (lower, upper) = positions.split_at(self.lower.vertex_count());
        self.lower.set_rest_angles(lower)?;
        self.upper.set_rest_angles(upper)
    }

    /// Scales the bending stiffness of both layers, which share their mesh, as
    /// [`LayerEnergy::set_bending_factor`].
    ///
    /// # Errors
    /// [`ShellError::BendingFactor`] unless the factor is positive and finite.
    pub fn set_bending_factor(&mut self, factor: f64) -> Result<(), ShellError> {
        self.lower.set_bending_factor(factor)?;
        self.upper.set_bending_factor(factor)
    }

    /// Number of vertices of both layers, pinned ones included.
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

    /// Energy (J) at the positions `x` (m) of all vertices of both layers.
    pub fn value(&self, x: &[Vector3<f64>]) -> f64 {
        self.energy_parts(x).total()
    }

    /// Energy (J) with the surface below at other `points`, as [`LayerEnergy::value_over`].
    pub fn value_over(&self, x: &[Vector3<f64>], points: &[Vector3<f64>]) -> f64 {
        let (lower, upper) = self.split(x);
        let layers = self.lower.value_over(lower, points) + self.upper.value(upper);
        layers + self.tie_parts(x).total()
    }

    /// Energy by layer and origin.
    pub fn energy_parts(&self, x: &[Vector3<f64>]) -> JointParts {
        let (lower, upper) = self.split(x);
        JointParts {
            lower: self.lower.energy_parts(lower),
            upper: self.upper.energy_parts(upper),
            tie: self.tie_parts(x),
        }
    }

    fn tie_parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        let mut tie = EnergyParts::default();
        for element in &self.ties {
            let [normal, gradient, tangential] = element.tie.values(&gather(x, &element.vertices));
            tie.normal += normal;
            tie.gradient += gradient;
            tie.tangential += tangential;
        }
        tie
    }

    /// Writes the derivative of the energy by the degrees of freedom (N).
    pub fn gradient(&self, x: &[Vector3<f64>], gradient: &mut [f64]) {
        let (lower, _) = self.split(x);
        let (below, _) = gradient.split_at_mut(self.lower.dof_count());
        self.lower.gradient(lower, below);
        self.add_upper_gradient(x, gradient);
    }

    /// Writes the derivative with the surface below at other `points` and returns the pull of the
    /// springs there, as [`LayerEnergy::gradient_over`].
    pub fn gradient_over(
        &self,
        x: &[Vector3<f64>],
        points: &[Vector3<f64>],
        gradient: &mut [f64],
    ) -> Vec<Vector3<f64>> {
        let (lower, _) = self.split(x);
        let (below, _) = gradient.split_at_mut(self.lower.dof_count());
        let springs = self.lower.gradient_over(lower, points, below);
        self.add_upper_gradient(x, gradient);
        springs
    }

    /// What the upper layer and the ties add to the lower layer's gradient, which is written.
    fn add_upper_gradient(&self, x: &[Vector3<f64>], gradient: &mut [f64]) {
        let (_, upper) = self.split(x);
        assert_eq!(gradient.len(), self.dof_count(), "one entry per dof");
        let (_, above) = gradient.split_at_mut(self.lower.dof_count());
        self.upper.gradient(upper, above);
        for TieElement { tie, vertices, .. } in &self.ties {
            let forces = tie.gradient(&gather(x, vertices));
            self.pattern.add_forces(gradient, vertices, &forces);
        }
    }

    /// Writes the second derivative (N/m), values in the order of [`Self::pattern`].
    ///
    /// `relaxed`, if asked for, takes that of [`LayerEnergy::hessian`] and, in the ties, the
    /// Gauss-Newton part. It is positive semidefinite up to a negative `K1`, of the lower layer or
    /// of the ties, which both matrices keep as in a single layer.
    pub fn hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: Option<&mut [f64]>) {
        match relaxed {
            None => {
                self.write_layers(x, exact, None);
                self.add_ties(x, exact, &mut []);
            }
            Some(relaxed) => {
                self.write_layers(x, exact, Some(relaxed));
                self.add_ties(x, exact, relaxed);
            }
        }
    }

    /// Each layer writes its Hessian in one piece; the lower one's columns are then spread out.
    fn write_layers(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: Option<&mut [f64]>) {
        let (lower, upper) = self.split(x);
        let first = self.pattern.column_starts[self.lower.dof_count()];
        let size = self.lower.pattern().1.len();
        match relaxed {
            None => {
                self.lower.hessian(lower, &mut exact[..size], None);
                self.upper.hessian(upper, &mut exact[first..], None);
            }
            Some(relaxed) => {
                let (below, above) = relaxed.split_at_mut(first);
                self.lower
                    .hessian(lower, &mut exact[..size], Some(&mut below[..size]));
                self.upper.hessian(upper, &mut exact[first..], Some(above));
                self.spread(below);
            }
        }
        self.spread(&mut exact[..first]);
    }

    /// Moves the lower layer's values from its own pattern to the joint one, in place.
    ///
    /// In a joint column the layer's own rows come first, then those of the upper layer. Backwards,
    /// no column is overwritten before it has moved.
    fn spread(&self, values: &mut [f64]) {
        let (own, _) = self.lower.pattern();
        let joint = &self.pattern.column_starts;
        for column in (0..self.lower.dof_count()).rev() {
            let length = own[column + 1] - own[column];
            values.copy_within(own[column]..own[column + 1], joint[column]);
            values[joint[column] + length..joint[column + 1]].fill(0.0);
        }
    }

    /// An empty `relaxed` is not wanted.
    fn add_ties(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        for element in &self.ties {
            let state = TieState::new(&gather(x, &element.vertices));
            let mut blocks = element.tie.gauss_newton(&state);
            let add = |values: &mut [f64], blocks: &[Matrix3<f64>; 21]| {
                for (&vertex, block) in element.vertices.iter().zip(DIAGONAL) {
                    self.pattern.add_diagonal(values, vertex, &blocks[block]);
                }
                for (&slot, (_, block)) in element.slots.iter().zip(PAIRS) {
                    Pattern::add_block(values, slot, &blocks[block]);
                }
            };
            if !relaxed.is_empty() {
                add(relaxed, &blocks);
            }
            element.tie.add_curvature(&state, &mut blocks);
            add(exact, &blocks);
        }
    }

    fn split<'a>(&self, x: &'a [Vector3<f64>]) -> (&'a [Vector3<f64>], &'a [Vector3<f64>]) {
        assert_eq!(x.len(), self.vertex_count(), "one position per vertex");
        x.split_at(self.lower.vertex_count())
    }
}

fn ties<'a>(
    lower: &'a LayerEnergy,
    parameters: &'a [TieParameters],
    levers: &'a [f64],
) -> impl Iterator<Item = LayerTie> + 'a {
    let faces = lower.faces().iter().zip(lower.rest_triangles());
    faces.zip(parameters).map(|((face, rest), parameters)| {
        LayerTie::new(rest, parameters, face.map(|v| levers[v as usize]))
    })
}

/// A face of the lower layer and the one above it, among the vertices of both.
fn both([a, b, c]: &[u32; 3], count: usize) -> [u32; 6] {
    let above = |vertex: &u32| vertex + count as u32;
    [*a, *b, *c, above(a), above(b), above(c)]
}

/// Every two vertices of both layers that share a stencil.
fn pairs<'a>(
    lower: &'a LayerEnergy,
    upper: &'a LayerEnergy,
) -> impl Iterator<Item = [u32; 2]> + 'a {
    let count = lower.vertex_count();
    let above = upper
        .stencil_pairs()
        .map(move |pair| pair.map(|vertex| vertex + count as u32));
    let between = lower.faces().iter().flat_map(move |face| {
        let vertices = both(face, count);
        (0..9).map(move |k| [vertices[k / 3], vertices[3 + k % 3]])
    });
    lower.stencil_pairs().chain(above).chain(between)
}

fn check_layers(lower: &LayerEnergy, upper: &LayerEnergy) -> Result<(), ShellError> {
    check_length("upper layer", lower.vertex_count(), upper.vertex_count())?;
    let (below, above) = (lower.faces(), upper.faces());
    let longest = below.len().max(above.len());
    if let Some(face) = (0..longest).find(|&face| below.get(face) != above.get(face)) {
        return Err(ShellError::LayersDiffer { face });
    }
    let differs = |&vertex: &usize| lower.is_pinned(vertex) != upper.is_pinned(vertex);
    if let Some(vertex) = (0..lower.vertex_count()).find(differs) {
        return Err(ShellError::PinnedInOneLayer { vertex });
    }
    if upper.is_unsupported() {
        Ok(())
    } else {
        Err(ShellError::SupportedUpperLayer)
    }
}

fn check_levers(levers: &[f64], vertices: usize) -> Result<(), ShellError> {
    check_length("levers", vertices, levers.len())?;
    let valid = |lever: &f64| *lever >= 0.0 && lever.is_finite();
    match levers.iter().position(|lever| !valid(lever)) {
        None => Ok(()),
        Some(index) => Err(ShellError::ParameterOutOfRange {
            element: "vertex",
            index,
            name: "lever",
            value: levers[index],
            range: ">= 0",
        }),
    }
}
