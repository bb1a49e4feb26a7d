//! The plane at which one half of a symmetric layer ends.

use std::sync::OnceLock;

use ruga_mesh::BlockPattern;

use crate::FaceParameters;
use crate::layer_part::PartNumbers;

/// The vertices on the plane, which do not move across it.
#[derive(Clone, Debug, Default)]
pub(super) struct MirrorPlane {
    /// Whether every vertex is on the plane; empty where there is none.
    on_plane: Vec<bool>,
    /// Numbers of the free vertices on it, ascending.
    free: Vec<u32>,
    /// Stiffness on the diagonal for x of the vertices on it (N/m).
    stiffness: f64,
    /// Entries of the matrix in the rows and columns of their x, looked up when a matrix is first asked for.
    entries: OnceLock<Vec<u32>>,
}

impl MirrorPlane {
    /// The vertices `on_plane` of a layer with this `pattern` and material; none where the list is empty.
    pub(super) fn new(pattern: &BlockPattern, on_plane: &[bool], faces: &[FaceParameters]) -> Self {
        // Any positive number would do; that of the membrane is as large as other entries.
        let stiffness = faces.first().map_or(0.0, FaceParameters::tension_modulus);
        Self::of(pattern, on_plane.to_vec(), stiffness)
    }

    fn of(pattern: &BlockPattern, on_plane: Vec<bool>, stiffness: f64) -> Self {
        let numbers = (0..).zip(&on_plane).filter(|(_, on)| **on);
        let free = numbers.filter_map(|(vertex, _)| Some(pattern.free(vertex)? as u32));
        Self {
            free: free.collect(),
            on_plane,
            stiffness,
            entries: OnceLock::new(),
        }
    }

    /// The plane in a part of the layer, which has this `pattern`.
    pub(super) fn part(&self, numbers: &PartNumbers, pattern: &BlockPattern) -> Self {
        if self.free.is_empty() {
            return Self::default();
        }
        let vertices = numbers.vertices.iter();
        let on_plane = vertices.map(|&v| self.on_plane[v as usize]).collect();
        Self::of(pattern, on_plane, self.stiffness)
    }

    /// Forgets the entries of the matrix.
    pub(super) fn release_entries(&mut self) {
        self.entries = OnceLock::new();
    }

    /// Takes the forces across the plane away: the other half pushes back.
    pub(super) fn clear_gradient(&self, gradient: &mut [f64]) {
        for &free in &self.free {
            gradient[3 * free as usize] = 0.0;
        }
    }

    /// Uncouples x on the plane from everything else.
    pub(super) fn clear_hessian(&self, pattern: &BlockPattern, values: &mut [f64]) {
        if self.free.is_empty() || values.is_empty() {
            return;
        }
        let entries = self.entries.get_or_init(|| self.entries_of(pattern));
        for &entry in entries {
            values[entry as usize] = 0.0;
        }
        for &free in &self.free {
            // A column of the lower triangle begins with its diagonal.
            values[pattern.column_starts()[3 * free as usize]] = self.stiffness;
        }
    }

    fn entries_of(&self, pattern: &BlockPattern) -> Vec<u32> {
        let mut is_across = vec![false; pattern.size()];
        for &free in &self.free {
            is_across[3 * free as usize] = true;
        }
        let (starts, rows) = (pattern.column_starts(), pattern.rows());
        let mut entries = Vec::new();
        for (column, range) in starts.windows(2).enumerate() {
            let own = (range[0] as u32..).zip(&rows[range[0]..range[1]]);
            let cleared = own.filter(|(_, row)| is_across[column] || is_across[**row as usize]);
            entries.extend(cleared.map(|(entry, _)| entry));
        }
        entries
    }
}
