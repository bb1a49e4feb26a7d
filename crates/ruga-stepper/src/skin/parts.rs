//! Lists with something for every vertex of a mesh, made for some vertices at a time.

use std::ops::Range;

use rayon::prelude::*;

/// Vertices of a part: what goes into a list of results takes more memory than the list, for all of an output mesh.
pub(crate) const VERTICES_AT_A_TIME: usize = 1 << 15;

/// Parts made before what was made is put in its place: no more threads than these are used, and no more memory.
const PARTS_AT_A_TIME: usize = 8;

/// What `make` gives for all of so many vertices, by their numbers, some at a time; parts run in parallel, and `take`
/// gets them in their order.
pub(crate) fn in_parts<R: Send>(
    vertices: usize,
    make: impl Fn(Range<usize>) -> R + Sync,
    take: impl FnMut(R),
) {
    in_parts_of(VERTICES_AT_A_TIME, vertices, make, take);
}

/// Does what [`in_parts`] does, `most` vertices at a time.
pub(crate) fn in_parts_of<R: Send>(
    most: usize,
    vertices: usize,
    make: impl Fn(Range<usize>) -> R + Sync,
    mut take: impl FnMut(R),
) {
    let starts: Vec<usize> = (0..vertices).step_by(most).collect();
    for starts in starts.chunks(PARTS_AT_A_TIME) {
        let parts = starts.par_iter();
        let parts = parts.map(|&start| make(start..vertices.min(start + most)));
        let parts: Vec<R> = parts.collect();
        parts.into_iter().for_each(&mut take);
    }
}
