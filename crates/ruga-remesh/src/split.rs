//! Splits edges until none is too long.

use std::cmp::Reverse;

use rayon::prelude::*;

use crate::counts::Counts;
use crate::flip::flip_around;
use crate::length_classes::by_length_class;
use crate::patch::{Patch, Placed};
use crate::touched::Touched;

/// Passes after which splitting stops. Three at most are needed to halve all edges of a face, so
/// this reaches edges a million times shorter than the input's.
const MAX_PASSES: usize = 64;

/// Passes within which the longest edge becomes shorter, unless splits and flips go in circles. A
/// pass halves it where no neighbour is as long.
const PATIENCE: usize = 4;

/// Edges whose middles are found before the first of them is split. All of a large mesh at once would take
/// more memory than its vertices.
const AT_A_TIME: usize = 1 << 13;

/// Edges that a thread takes at least.
const AT_ONCE: usize = 1 << 6;

/// Splits, in each pass, the longest edges of which no two share a face, then flips around them.
///
/// The independent set and its order by length are those of Narain et al. (2012). Nothing is
/// split twice in a pass, so that flips can mend triangles before they are cut again. Returns
/// whether it ended by itself, not at `most_vertices`. An edge that the surface has no middle for
/// stays.
///
/// Where the metric varies over an edge, a part of it can measure more than the whole. The parts then
/// come before the whole in every pass, flips bring them back, and between them needles shrink
/// without end: when the longest edge stays as long as it was, lengths in space decide the order.
pub(crate) fn split_long_edges(
    patch: &mut Patch,
    counts: &mut Counts,
    most_vertices: usize,
) -> bool {
    let mut candidates: Vec<u32> = patch.topology.edges().collect();
    let mut longest = Vec::new();
    for pass in 0..MAX_PASSES {
        let mut long = long_edges(patch, &candidates);
        let Some(&(Reverse(class), _)) = long.first() else {
            return true;
        };
        // Classes, not lengths, so that a shrinking by rounding does not count as progress.
        longest.push(class);
        if pass >= PATIENCE && class >= longest[pass - PATIENCE] {
            long = by_plain_length(patch, &long);
        }
        let (mut touched, mut foreseen) = (Touched::new(), Touched::new());
        for edges in long.chunks(AT_A_TIME) {
            let middles = middles(patch, edges, (&touched, &mut foreseen));
            for (&(_, h), middle) in edges.iter().zip(middles) {
                if patch.topology.vertex_slots() >= most_vertices {
                    return false;
                }
                split_if_untouched(patch, (h, middle), &mut touched, counts);
            }
        }
        // An edge that waited has a touched face, so it is met again among their edges.
        let edges = touched.edges(&patch.topology);
        flip_around(patch, edges, &mut touched, counts);
        candidates = touched.edges(&patch.topology);
    }
    false
}

/// The middles of those edges that will be split if every split succeeds, `None` for the others: no split
/// of a pass moves another one's middle. `foreseen` has the faces that are cut then, beside those that were
/// `touched` before.
fn middles(
    patch: &Patch,
    edges: &[(Reverse<i32>, u32)],
    (touched, foreseen): (&Touched, &mut Touched),
) -> Vec<Option<Placed>> {
    let mut split = Vec::with_capacity(edges.len());
    for &(_, h) in edges {
        let is_whole = |face| !touched.contains(face) && !foreseen.contains(face);
        let is_split = faces_of(patch, h).all(is_whole);
        if is_split {
            foreseen.extend(faces_of(patch, h));
        }
        split.push(is_split.then_some(h));
    }
    let each = split.into_par_iter().with_min_len(AT_ONCE);
    each.map(|h| h.map(|h| patch.middle(h))).collect()
}

/// The faces that are cut when an edge is split: in an independent set no two edges share one.
fn faces_of(patch: &Patch, h: u32) -> impl Iterator<Item = u32> + Clone + use<> {
    let sides = [Some(h), patch.topology.twin(h)];
    sides.into_iter().flatten().map(|side| side / 3)
}

/// Splits an edge unless an earlier split touched its faces.
fn split_if_untouched(
    patch: &mut Patch,
    (h, middle): (u32, Option<Placed>),
    touched: &mut Touched,
    counts: &mut Counts,
) {
    let faces = faces_of(patch, h);
    let first_new = patch.topology.face_slots() as u32;
    if faces.clone().any(|face| touched.contains(face)) {
        return;
    }
    let is_still = |middle: &Placed| middle.point == patch.middle(h).point;
    debug_assert!(middle.as_ref().is_none_or(is_still));
    // Not foreseen where a split beside it was expected, and failed.
    let middle = middle.unwrap_or_else(|| patch.middle(h));
    if !patch.try_split(h, middle) {
        return;
    }
    counts.splits += 1;
    touched.extend(faces.chain(first_new..patch.topology.face_slots() as u32));
}

/// The edges that are too long, longest first, each with the class of its length.
fn long_edges(patch: &Patch, candidates: &[u32]) -> Vec<(Reverse<i32>, u32)> {
    let long = by_length_class(candidates, |h| {
        let length = patch.half_edge_length(h);
        patch.is_long(h, length).then_some(length)
    });
    longest_first(long)
}

/// Sorts edges by their lengths in space, longest first.
fn by_plain_length(patch: &Patch, long: &[(Reverse<i32>, u32)]) -> Vec<(Reverse<i32>, u32)> {
    let edges: Vec<u32> = long.iter().map(|&(_, h)| h).collect();
    longest_first(by_length_class(&edges, |h| {
        let ends = [patch.topology.tail(h), patch.topology.head(h)];
        let [tail, head] = ends.map(|v| patch.position(v));
        Some((head - tail).norm())
    }))
}

fn longest_first(classes: Vec<(i32, u32)>) -> Vec<(Reverse<i32>, u32)> {
    let mut edges: Vec<_> = classes
        .into_iter()
        .map(|(class, h)| (Reverse(class), h))
        .collect();
    edges.sort_unstable();
    edges
}
