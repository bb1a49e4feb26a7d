//! Lists of the faces that operations changed.

use crate::half_edges::HalfEdges;

/// Faces that were touched, each listed once, in order.
pub(crate) struct Touched {
    faces: Vec<u32>,
    is_listed: Vec<bool>,
}

impl Touched {
    pub(crate) fn new() -> Self {
        Self {
            faces: Vec::new(),
            is_listed: Vec::new(),
        }
    }

    /// Lists some faces.
    pub(crate) fn extend(&mut self, faces: impl IntoIterator<Item = u32>) {
        for face in faces {
            let i = face as usize;
            if self.is_listed.len() <= i {
                self.is_listed.resize(i + 1, false);
            }
            if !std::mem::replace(&mut self.is_listed[i], true) {
                self.faces.push(face);
            }
        }
    }

    /// Lists the faces around a vertex.
    pub(crate) fn add_around(&mut self, topology: &HalfEdges, v: u32) {
        self.extend(topology.outgoing(v).map(|h| h / 3));
    }

    pub(crate) fn contains(&self, face: u32) -> bool {
        self.is_listed.get(face as usize).copied().unwrap_or(false)
    }

    /// One half-edge of every edge of the listed faces that still exist.
    pub(crate) fn edges(&self, topology: &HalfEdges) -> Vec<u32> {
        let mut edges = Vec::with_capacity(3 * self.faces.len());
        for &face in &self.faces {
            if topology.face(face).is_none() {
                continue;
            }
            for h in 3 * face..3 * face + 3 {
                if topology
                    .twin(h)
                    // Edges between two listed faces come from their lower half-edge only.
                    .is_none_or(|t| h < t || !self.contains(t / 3))
                {
                    edges.push(h);
                }
            }
        }
        edges
    }

    /// Adds the faces around every vertex of the listed faces.
    pub(crate) fn grow(&mut self, topology: &HalfEdges) {
        for i in 0..self.faces.len() {
            for v in topology.face(self.faces[i]).into_iter().flatten() {
                self.add_around(topology, v);
            }
        }
    }
}
