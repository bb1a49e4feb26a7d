//! Which vertices of a mesh lie beside which.

use ruga_mesh::{Id, TriMesh};

/// The vertices that every vertex shares an edge with.
pub(crate) struct Neighbourhood(Vec<Vec<u32>>);

impl Neighbourhood {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let mut near = vec![Vec::new(); mesh.vertex_count()];
        for edge in mesh.edges().as_slice() {
            let [a, b] = edge.vertices;
            near[a.index()].push(b.0);
            near[b.index()].push(a.0);
        }
        Self(near)
    }

    /// The vertices at most `rings` edges from `core` that are `free`; both are ascending, and so is what
    /// comes out.
    pub(crate) fn grown(&self, core: &[u32], rings: usize, free: &[u32]) -> Vec<u32> {
        let mut is_in = vec![false; self.0.len()];
        core.iter().for_each(|&v| is_in[v as usize] = true);
        let (mut all, mut border) = (core.to_vec(), core.to_vec());
        for _ in 0..rings {
            let mut next = Vec::new();
            for &other in border.iter().flat_map(|&v| &self.0[v as usize]) {
                if !std::mem::replace(&mut is_in[other as usize], true) {
                    next.push(other);
                }
            }
            all.extend(&next);
            border = next;
        }
        all.retain(|v| free.binary_search(v).is_ok());
        all.sort_unstable();
        all
    }

    /// All vertices that edges join to the `first` ones, from near to far, over those that `may` be passed.
    pub(crate) fn reached_from(&self, first: Vec<u32>, may: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut is_in = vec![false; self.0.len()];
        first.iter().for_each(|&v| is_in[v as usize] = true);
        let (mut order, mut done) = (first, 0);
        while let Some(&v) = order.get(done) {
            done += 1;
            for &other in &self.0[v as usize] {
                if may(other) && !std::mem::replace(&mut is_in[other as usize], true) {
                    order.push(other);
                }
            }
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of nine squares, two vertices high.
    fn strip() -> Neighbourhood {
        let squares = (0..9).map(|i| 2 * i);
        let faces = squares.flat_map(|a| [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
        Neighbourhood::new(&TriMesh::new(20, faces.collect()).expect("a strip"))
    }

    #[test]
    fn a_group_grows_by_edges_over_free_vertices() {
        let free: Vec<u32> = (0..20).filter(|&v| v != 9).collect();
        assert_eq!(strip().grown(&[10, 11], 0, &free), [10, 11]);
        assert_eq!(strip().grown(&[10, 11], 1, &free), [8, 10, 11, 12, 13]);
    }

    #[test]
    fn the_last_is_the_farthest_that_may_be_reached() {
        let all = strip().reached_from(vec![0], |_| true);
        assert_eq!((all.len(), all[0], all.last()), (20, 0, Some(&19)));
        // Both vertices of one rung stop it.
        let some = strip().reached_from(vec![0], |v| v != 8 && v != 9);
        assert!(some.len() == 8 && some.iter().all(|&v| v < 8), "{some:?}");
    }
}
