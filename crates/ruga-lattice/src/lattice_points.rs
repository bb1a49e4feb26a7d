//! Points of a lattice: the element each one is in, and its coordinates there.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint, SurfaceLookup};

use crate::surface_elements::distance_to_cell;
use crate::{ElementId, Lattice, LatticeError};

/// A point of a lattice: an element and coordinates in its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticePoint {
    /// The element.
    pub element: ElementId,
    /// Coordinates along x, y, z, 0 to 1 from corner to corner of its cell. Beyond that the
    /// element's polynomials are extrapolated.
    pub local: Vector3<f64>,
}

impl Lattice {
    /// Locates a material point of the surface at its rest position.
    ///
    /// # Errors
    /// [`LatticeError::FaceOutOfRange`], [`LatticeError::NotFinite`]; the point counts as point 0.
    pub fn locate(&self, point: &MaterialPoint) -> Result<LatticePoint, LatticeError> {
        self.locate_numbered(0, point)
    }

    pub(crate) fn locate_numbered(
        &self,
        index: usize,
        point: &MaterialPoint,
    ) -> Result<LatticePoint, LatticeError> {
        self.check_face(index, point)?;
        let surface = self.surface();
        let position = point.interpolate(surface.mesh(), surface.positions());
        self.locate_moved(index, point, &position)
    }

    /// Locates a point near the surface in the element that its material point belongs to.
    ///
    /// So a point of a smooth surface that stands a little off its face is extrapolated from that
    /// face's own piece of the body, and not from another one that is close in space.
    pub(crate) fn locate_moved(
        &self,
        index: usize,
        point: &MaterialPoint,
        position: &Vector3<f64>,
    ) -> Result<LatticePoint, LatticeError> {
        self.check_face(index, point)?;
        if !position.iter().all(|c| c.is_finite()) {
            let what = "position of point";
            return Err(LatticeError::NotFinite { what, index });
        }
        let element = self
            .surface()
            .element_of_face(point.face, position, self.grid());
        Ok(self.locate_in(element, position))
    }

    fn check_face(&self, index: usize, point: &MaterialPoint) -> Result<(), LatticeError> {
        let count = self.surface().mesh().face_count();
        if point.face.index() < count {
            Ok(())
        } else {
            let face = point.face;
            Err(LatticeError::FaceOutOfRange {
                point: index,
                face,
                count,
            })
        }
    }

    pub(crate) fn check_point(
        &self,
        index: usize,
        point: &LatticePoint,
    ) -> Result<(), LatticeError> {
        let (element, count) = (point.element, self.element_count());
        if element.index() >= count {
            return Err(LatticeError::ElementOutOfRange {
                point: index,
                element,
                count,
            });
        }
        if !point.local.iter().all(|c| c.is_finite()) {
            let what = "place";
            return Err(LatticeError::NotFinite { what, index });
        }
        Ok(())
    }

    /// Locates a rest position (m) in a given element, inside its cell or not.
    ///
    /// # Panics
    /// When the lattice does not have the element.
    pub fn locate_in(&self, element: ElementId, position: &Vector3<f64>) -> LatticePoint {
        LatticePoint {
            element,
            local: self.grid().local(self.cell(element), position),
        }
    }

    /// Locates rest positions (m) anywhere: in the body, on its surface or outside.
    ///
    /// Inside the body the element is that of the piece around the point. Outside, it is that of the
    /// piece in the same cell whose surface is closest; in a cell without any, that of the closest
    /// point of the whole surface, extrapolated.
    ///
    /// # Errors
    /// [`LatticeError::NotFinite`].
    pub fn locate_near(
        &self,
        positions: &[Vector3<f64>],
    ) -> Result<Vec<LatticePoint>, LatticeError> {
        let surface = self.surface();
        let lookup = SurfaceLookup::new(surface.mesh(), surface.positions());
        let points = positions.iter().enumerate().map(|(index, position)| {
            let is_finite = position.iter().all(|c| c.is_finite());
            let element = is_finite.then(|| self.element_near(position, &lookup));
            let what = "position of point";
            let element = element.flatten();
            let element = element.ok_or(LatticeError::NotFinite { what, index })?;
            Ok(self.locate_in(element, position))
        });
        points.collect()
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
