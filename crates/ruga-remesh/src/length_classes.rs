//! Classes of the lengths of edges.

use rayon::prelude::*;

/// Edges that a thread takes at least.
const AT_ONCE: usize = 1 << 12;

/// The edges for which `length` gives one, each with the class of its length, classes a quarter
/// octave wide.
///
/// Sorted by class, edges of one class stay in the order of the half-edges, which are near each other in memory where
/// they are near each other on the surface. Exact order by length visits the mesh at random, and
/// on a hundred thousand faces most of the time then goes into waiting for memory.
pub(crate) fn by_length_class(
    edges: &[u32],
    length: impl Fn(u32) -> Option<f64> + Sync,
) -> Vec<(i32, u32)> {
    let class = |length: f64| (4.0 * length.max(f64::MIN_POSITIVE).log2()).floor() as i32;
    edges
        .par_iter()
        .with_min_len(AT_ONCE)
        .filter_map(|&h| length(h).map(|length| (class(length), h)))
        .collect()
}
