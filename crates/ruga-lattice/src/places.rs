//! From a material point, or a point in space, to a place in an element.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, MaterialPoint, SurfaceLookup, TriMesh, closest_on_triangle};

use crate::face_cutting::Fragment;
use crate::grid::{Grid, Index};
use crate::pieces::Dissection;
use crate::{ElementId, Lattice, LatticeError};

/// A place in an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The element.
    pub element: ElementId,
    /// Coordinates along x, y, z, 0 to 1 from corner to corner of its cell. Beyond that the
    /// element's polynomials are extrapolated.
    pub local: Vector3<f64>,
}

/// The surface that a lattice was built from, and the elements around its fragments.
#[derive(Clone, Debug)]
pub(crate) struct SurfacePlaces {
    mesh: TriMesh,
    positions: Vec<Vector3<f64>>,
    /// Sorted by face.
    fragments: Vec<Fragment>,
    elements: Vec<ElementId>,
    face_starts: Vec<u32>,
    /// Elements sorted by cell, and fragments sorted by cell.
    element_cells: Vec<(Index, ElementId)>,
    fragment_cells: Vec<(Index, u32)>,
}

impl SurfacePlaces {
    pub(crate) fn new(mesh: &TriMesh, positions: &[Vector3<f64>], dissection: Dissection) -> Self {
        let pieces = dissection.pieces.iter().enumerate();
        let fragments = dissection.fragments;
        let mut face_starts = vec![0u32; mesh.face_count() + 1];
        for fragment in &fragments {
            face_starts[fragment.face.index() + 1] += 1;
        }
        for i in 0..mesh.face_count() {
            face_starts[i + 1] += face_starts[i];
        }
        let cells = fragments.iter().enumerate();
        let mut fragment_cells: Vec<_> = cells.map(|(i, f)| (f.cell, i as u32)).collect();
        fragment_cells.sort_unstable();
        Self {
            mesh: mesh.clone(),
            positions: positions.to_vec(),
            elements: (dissection.piece_of_fragment.iter())
                .map(|&piece| ElementId::from_index(piece))
                .collect(),
            element_cells: pieces
                .map(|(i, piece)| (piece.cell, ElementId::from_index(i)))
                .collect(),
            fragments,
            face_starts,
            fragment_cells,
        }
    }

    pub(crate) fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    pub(crate) fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// The element of a face whose cell is closest to a point on or near the face.
    ///
    /// A face has one part per cell, so within the face this is exact; rounding at a border
    /// between cells picks one of the two, which agree there.
    fn element_of_face(&self, face: FaceId, point: &Vector3<f64>, grid: &Grid) -> ElementId {
        let range = |i: usize| self.face_starts[i] as usize..self.face_starts[i + 1] as usize;
        let own = range(face.index());
        let nearest = own.min_by(|&a, &b| {
            let distance = |f: usize| distance_to_cell(grid, self.fragments[f].cell, point);
            distance(a).total_cmp(&distance(b))
        });
        let nearest = nearest.expect("every face has a fragment");
        self.elements[nearest]
    }

    /// The elements in a cell.
    fn elements_in(&self, cell: Index) -> &[(Index, ElementId)] {
        let start = self.element_cells.partition_point(|e| e.0 < cell);
        let end = self.element_cells.partition_point(|e| e.0 <= cell);
        &self.element_cells[start..end]
    }

    /// The element of the fragment in a cell that is closest to a point.
    fn element_of_closest_fragment(&self, cell: Index, point: &Vector3<f64>) -> Option<ElementId> {
        let start = self.fragment_cells.partition_point(|f| f.0 < cell);
        let end = self.fragment_cells.partition_point(|f| f.0 <= cell);
        let distances = self.fragment_cells[start..end].iter().map(|&(_, i)| {
            let triangles = self.fragments[i as usize].triangles();
            let squared = triangles.map(|t| closest_on_triangle(&t, point).1);
            (squared.fold(f64::INFINITY, f64::min), i)
        });
        let closest = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.elements[closest.1 as usize])
    }
}

impl Lattice {
    /// The place of a material point of the surface at its rest position.
    ///
    /// # Errors
    /// [`LatticeError::FaceOutOfRange`], [`LatticeError::NotFinite`]; the point counts as point 0.
    pub fn place(&self, point: &MaterialPoint) -> Result<Place, LatticeError> {
        self.place_numbered(0, point)
    }

    pub(crate) fn place_numbered(
        &self,
        index: usize,
        point: &MaterialPoint,
    ) -> Result<Place, LatticeError> {
        self.check_face(index, point)?;
        let surface = self.surface();
        let position = point.interpolate(surface.mesh(), surface.positions());
        self.place_moved(index, point, &position)
    }

    /// The place of a point near the surface, in the element that its material point belongs to.
    ///
    /// So a point of a smooth surface that stands a little off its face is extrapolated from that
    /// face's own piece of the body, and not from another one that is close in space.
    pub(crate) fn place_moved(
        &self,
        index: usize,
        point: &MaterialPoint,
        position: &Vector3<f64>,
    ) -> Result<Place, LatticeError> {
        self.check_face(index, point)?;
        if !position.iter().all(|c| c.is_finite()) {
            let what = "position of point";
            return Err(LatticeError::NotFinite { what, index });
        }
        let element = self
            .surface()
            .element_of_face(point.face, position, self.grid());
        Ok(self.place_in(element, position))
    }

    fn check_face(&self, point: usize, place: &MaterialPoint) -> Result<(), LatticeError> {
        let count = self.surface().mesh().face_count();
        if place.face.index() < count {
            Ok(())
        } else {
            let face = place.face;
            Err(LatticeError::FaceOutOfRange { point, face, count })
        }
    }

    pub(crate) fn check_place(&self, index: usize, place: &Place) -> Result<(), LatticeError> {
        let (element, count) = (place.element, self.element_count());
        if element.index() >= count {
            return Err(LatticeError::ElementOutOfRange {
                place: index,
                element,
                count,
            });
        }
        if !place.local.iter().all(|c| c.is_finite()) {
            let what = "place";
            return Err(LatticeError::NotFinite { what, index });
        }
        Ok(())
    }

    /// The place of a rest position (m) in a given element, inside its cell or not.
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn place_in(&self, element: ElementId, position: &Vector3<f64>) -> Place {
        Place {
            element,
            local: self.grid().local(self.cell(element), position),
        }
    }

    /// The places of rest positions (m) anywhere: in the body, on its surface or outside.
    ///
    /// Inside the body it is the piece around the point. Outside, it is the piece in the same cell
    /// whose surface is closest; in a cell without any, the one of the closest point of the whole
    /// surface, extrapolated.
    ///
    /// # Errors
    /// [`LatticeError::NotFinite`].
    pub fn places_near(&self, positions: &[Vector3<f64>]) -> Result<Vec<Place>, LatticeError> {
        let surface = self.surface();
        let lookup = SurfaceLookup::new(surface.mesh(), surface.positions());
        let places = positions.iter().enumerate().map(|(index, position)| {
            let is_finite = position.iter().all(|c| c.is_finite());
            let element = is_finite.then(|| self.element_near(position, &lookup));
            let what = "position of point";
            let element = element.flatten();
            let element = element.ok_or(LatticeError::NotFinite { what, index })?;
            Ok(self.place_in(element, position))
        });
        places.collect()
    }

    fn element_near(&self, point: &Vector3<f64>, lookup: &SurfaceLookup) -> Option<ElementId> {
        let surface = self.surface();
        let cell = self.grid().cell_at(point);
        let is_in_cell = distance_to_cell(self.grid(), cell, point) == 0.0;
        match surface.elements_in(cell) {
            [(_, only)] if is_in_cell => Some(*only),
            // A straight line to the closest fragment of the cell crosses no other: it stays
            // within one piece.
            [_, ..] if is_in_cell => surface.element_of_closest_fragment(cell, point),
            _ => {
                let closest = lookup.closest(point)?.point;
                let on_surface = closest.interpolate(surface.mesh(), surface.positions());
                Some(surface.element_of_face(closest.face, &on_surface, self.grid()))
            }
        }
    }
}

fn distance_to_cell(grid: &Grid, cell: Index, point: &Vector3<f64>) -> f64 {
    let local = grid.local(cell, point);
    let outside = local.map(|t| t - t.clamp(0.0, 1.0));
    // In metres, as cells are not quite cubes.
    outside.component_mul(&grid.size).norm()
}
