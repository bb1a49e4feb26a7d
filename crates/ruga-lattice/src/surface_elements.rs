//! Which element of a lattice is around a point of its surface, or in a cell.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, TriMesh, closest_on_triangle};

use crate::ElementId;
use crate::face_cutting::Fragment;
use crate::grid::{Grid, Index};
use crate::pieces::Dissection;

/// The surface that a lattice was built from, and the elements around its fragments.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceElements {
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

impl SurfaceElements {
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
    pub(crate) fn element_of_face(
        &self,
        face: FaceId,
        point: &Vector3<f64>,
        grid: &Grid,
    ) -> ElementId {
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
    pub(crate) fn elements_in(&self, cell: Index) -> &[(Index, ElementId)] {
        let start = self.element_cells.partition_point(|e| e.0 < cell);
        let end = self.element_cells.partition_point(|e| e.0 <= cell);
        &self.element_cells[start..end]
    }

    /// The element of the fragment in a cell that is closest to a point.
    pub(crate) fn element_of_closest_fragment(
        &self,
        cell: Index,
        point: &Vector3<f64>,
    ) -> Option<ElementId> {
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

pub(crate) fn distance_to_cell(grid: &Grid, cell: Index, point: &Vector3<f64>) -> f64 {
    let local = grid.local(cell, point);
    let outside = local.map(|t| t - t.clamp(0.0, 1.0));
    // In metres, as cells are not quite cubes.
    outside.component_mul(&grid.size).norm()
}
