//! The lattice: elements, nodes, and how they interpolate.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{Id, TriMesh};

use crate::closed_surface::check_closed;
use crate::face_cutting::Coincidence;
use crate::grid::{Grid, Index};
use crate::lattice_points::LatticePoint;
use crate::moments::Moments;
use crate::node_merging::merge_nodes;
use crate::pieces::{Dissection, dissect};
use crate::surface_elements::SurfaceElements;
use crate::{ElementId, LatticeError, NodeId, Shape};

/// How a lattice is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeSpec {
    /// Cells along the longest side of the surface's box, 1 to [`MAX_CELLS`]; default 6.
    ///
    /// The other sides get the nearest whole number, at least one: cells are as near to cubes as
    /// that allows, and a box is filled exactly.
    pub cells: u32,
    /// Shape functions; default quadratic.
    pub shape: Shape,
    /// Material of a cell that the body fills in part; default its piece of the body.
    pub filling: Filling,
}

/// Most cells along a side that [`LatticeSpec`] accepts: a quarter of a million if the body fills its
/// box, for which building takes 0.8 GB.
pub const MAX_CELLS: u32 = 64;

impl Default for LatticeSpec {
    fn default() -> Self {
        Self {
            cells: 6,
            shape: Shape::Quadratic,
            filling: Filling::Piece,
        }
    }
}

/// Place of an element's material, if the body fills its cell only in part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filling {
    /// Material where the body is. Quadrature points are those of the box with the piece's volume,
    /// centre and second moments: mass, its centre and its inertia are exact, and so is the energy
    /// of small strains that vary linearly, as in stretching and bending. The void has
    /// [`VOID_STIFFNESS`].
    #[default]
    Piece,
    /// Material in the whole cell, as in RK 5: at its 27 or 8 quadrature points. Superimposed
    /// elements count their cell twice, and a thin limb that lies askew in the grid is several
    /// times too stiff where cells are as thick as it is.
    Whole,
}

/// Stiffness of the void in a cell with [`Filling::Piece`], as a share of the material's.
///
/// It holds nodes that the body hardly touches, which would otherwise have next to no stiffness.
pub const VOID_STIFFNESS: f64 = 1e-3;

/// Positions of the grid that are tried until no vertex lies on a plane.
const ATTEMPTS: u32 = 8;

/// A coarse hexahedral lattice around a body: one element for each connected piece of the body in
/// a cell of a regular grid.
///
/// Elements in the same cell are superimposed: they share place but no nodes, unless they hang
/// together through neighbours. A configuration of the lattice is one vector per node; within an
/// element positions are `x = sum_i N_i(X) q_i`.
#[derive(Clone, Debug)]
pub struct Lattice {
    shape: Shape,
    filling: Filling,
    grid: Grid,
    elements: Vec<Element>,
    /// Nodes of all elements, one after the other.
    element_nodes: Vec<NodeId>,
    rest: Vec<Vector3<f64>>,
    surface: SurfaceElements,
}

#[derive(Clone, Copy, Debug)]
struct Element {
    cell: Index,
    /// Moments of its piece of the body.
    moments: Moments,
}

impl Lattice {
    /// Builds the lattice of the body inside a closed surface (RK 5.1).
    ///
    /// `positions` (m) are those of the mesh's vertices at rest. The surface may have several
    /// parts: separate bodies, and hollows whose normals point into them.
    ///
    /// # Errors
    /// [`LatticeError::OpenSurface`], [`LatticeError::SelfIntersection`] and
    /// [`LatticeError::WrongSide`] for a surface without a well-defined inside;
    /// [`LatticeError::CannotCut`] where parts of it touch up to a billionth of a cell; and those
    /// about array lengths, coordinates that are not finite, and settings out of range.
    ///
    /// # Validity
    /// The test for self-intersection is exact but for rounding: parts that touch, or overlap by
    /// less than about 1e-13 of a face's size, may pass it. Where that leads to contradicting
    /// pieces, cutting refuses it.
    pub fn build(
        mesh: &TriMesh,
        positions: &[Vector3<f64>],
        spec: &LatticeSpec,
    ) -> Result<Self, LatticeError> {
        if !(1..=MAX_CELLS).contains(&spec.cells) {
            return Err(LatticeError::Setting {
                name: "cells",
                value: f64::from(spec.cells),
                accepted: "1 to 64",
            });
        }
        check_closed(mesh, positions)?;
        let (grid, dissection) = dissect_somewhere(mesh, positions, spec.cells)?;
        Ok(Self::assemble(mesh, positions, spec, grid, dissection))
    }

    fn assemble(
        mesh: &TriMesh,
        positions: &[Vector3<f64>],
        spec: &LatticeSpec,
        grid: Grid,
        dissection: Dissection,
    ) -> Self {
        let shape = spec.shape;
        let pieces = &dissection.pieces;
        let (numbers, count) = merge_nodes(pieces.len(), &dissection.links, shape);
        let mut rest = vec![Vector3::zeros(); count];
        for (piece, nodes) in pieces.iter().zip(numbers.chunks(shape.nodes_per_element())) {
            for (local, &node) in nodes.iter().enumerate() {
                // Elements that share a node agree on its place but for rounding, and the last one
                // is kept.
                rest[node as usize] = node_rest(shape, &grid, piece.cell, local);
            }
        }
        let elements = pieces.iter().map(|piece| Element {
            cell: piece.cell,
            moments: piece.moments,
        });
        Self {
            shape,
            filling: spec.filling,
            elements: elements.collect(),
            element_nodes: numbers.into_iter().map(NodeId).collect(),
            rest,
            surface: SurfaceElements::new(mesh, positions, dissection),
            grid,
        }
    }

    /// Shape functions of the elements.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Edge lengths of a cell along x, y, z (m).
    pub fn cell_size(&self) -> Vector3<f64> {
        self.grid.size
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.elements.len()
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.rest.len()
    }

    /// All elements, in order: by cell, x slowest.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = ElementId> + use<> {
        (0..self.elements.len()).map(ElementId::from_index)
    }

    /// Node vectors at rest (m), with which every point has its rest position.
    pub fn rest_positions(&self) -> &[Vector3<f64>] {
        &self.rest
    }

    /// The nodes of an element; node `(i, j, k)` along x, y, z is entry `(i n + j) n + k`, with
    /// `n` nodes per axis.
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn element_nodes(&self, element: ElementId) -> &[NodeId] {
        let n = self.shape.nodes_per_element();
        &self.element_nodes[n * element.index()..n * (element.index() + 1)]
    }

    /// Lower corner of an element's cell (m); elements with the same one are superimposed.
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn element_corner(&self, element: ElementId) -> Vector3<f64> {
        self.grid.corner(self.cell(element))
    }

    /// Volume of the piece of the body in an element (m³).
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn element_volume(&self, element: ElementId) -> f64 {
        self.moments(element).volume
    }

    /// Centre of the piece of the body in an element (m), which lies in its cell.
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn element_centre(&self, element: ElementId) -> Vector3<f64> {
        let moments = self.moments(element);
        let size = self.cell_size();
        let centre = moments.centre();
        // Of a piece with next to no volume rounding decides.
        let inside = |c: usize| centre[c] >= 0.0 && centre[c] <= size[c];
        let local = if (0..3).all(inside) {
            centre
        } else {
            0.5 * size
        };
        self.element_corner(element) + local
    }

    /// Volume of the body (m³).
    pub fn volume(&self) -> f64 {
        self.elements.iter().map(|e| e.moments.volume).sum()
    }

    pub(crate) fn moments(&self, element: ElementId) -> &Moments {
        &self.elements[element.index()].moments
    }

    pub(crate) fn filling(&self) -> Filling {
        self.filling
    }

    pub(crate) fn cell(&self, element: ElementId) -> Index {
        self.elements[element.index()].cell
    }

    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    pub(crate) fn surface(&self) -> &SurfaceElements {
        &self.surface
    }

    /// Position (m) of a point of the lattice when the nodes are at `q` (m).
    ///
    /// # Panics
    /// When the lattice does not have the point's element, or there is not one vector per node.
    pub fn position(&self, point: &LatticePoint, q: &[Vector3<f64>]) -> Vector3<f64> {
        assert_eq!(q.len(), self.node_count(), "one vector per node");
        let shape = self.shape.evaluate(&point.local, &self.grid.size);
        let terms = self.element_nodes(point.element).iter().zip(shape.values);
        terms.map(|(node, value)| q[node.index()] * value).sum()
    }

    /// Deformation gradient `F = dx/dX` at a point of the lattice when the nodes are at `q` (m).
    ///
    /// # Panics
    /// When the lattice does not have the point's element, or there is not one vector per node.
    pub fn deformation(&self, point: &LatticePoint, q: &[Vector3<f64>]) -> Matrix3<f64> {
        assert_eq!(q.len(), self.node_count(), "one vector per node");
        let shape = self.shape.evaluate(&point.local, &self.grid.size);
        let terms = self
            .element_nodes(point.element)
            .iter()
            .zip(shape.gradients);
        terms
            .map(|(node, gradient)| q[node.index()] * gradient.transpose())
            .sum()
    }
}

fn dissect_somewhere(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    cells: u32,
) -> Result<(Grid, Dissection), LatticeError> {
    // Vertices without faces must not make the grid longer.
    let used = || mesh.faces().as_slice().iter().flatten();
    let (mut low, mut high) = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(-f64::INFINITY),
    );
    for vertex in used() {
        low = low.inf(&positions[vertex.index()]);
        high = high.sup(&positions[vertex.index()]);
    }
    let mut last = Coincidence(low);
    for attempt in 0..ATTEMPTS {
        let grid = Grid::around(&low, &high, cells, attempt);
        match dissect(mesh, positions, &grid) {
            Ok(dissection) => return Ok((grid, dissection)),
            Err(coincidence) => last = coincidence,
        }
    }
    let position = last.0.into();
    Err(LatticeError::CannotCut { position })
}

fn node_rest(shape: Shape, grid: &Grid, cell: Index, local: usize) -> Vector3<f64> {
    let n = shape.nodes_per_axis();
    let steps = [local / (n * n), local / n % n, local % n];
    let place = Vector3::from_fn(|axis, _| steps[axis] as f64 + shape.first_node());
    grid.corner(cell) + place.component_mul(&grid.size)
}
