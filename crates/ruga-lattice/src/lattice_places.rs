//! Places of surface points in a lattice.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint, SurfaceLookup};

use crate::places::{Place, distance_to_cell};
use crate::{ElementId, Lattice, LatticeError};

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
