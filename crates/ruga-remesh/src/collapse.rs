//! Collapses edges that are too short.

use crate::counts::Counts;
use crate::flip::flip_around;
use crate::length_classes::by_length_class;
use crate::patch::Patch;
use crate::touched::Touched;

/// Passes after which collapsing stops; each removes a share of what can go, so a mesh a thousand
/// times too fine needs about twenty.
const MAX_PASSES: usize = 64;

/// Shape under which a collapse may not make a face worse than the worst it replaces: half of an
/// equilateral's in the metric, a right triangle of sides 1 : 3.4. Edges shorter than this metric
/// length may leave worse faces; see [`least_shape`].
const WORST_SHAPE: f64 = 0.5;

/// Collapses short edges, shortest first, then flips around them, until none can go.
///
/// Returns whether it ended by itself. It ends because every collapse removes a vertex.
pub(crate) fn collapse_short_edges(patch: &mut Patch, corner: f64, counts: &mut Counts) -> bool {
    let mut candidates: Vec<u32> = patch.topology.edges().collect();
    for _ in 0..MAX_PASSES {
        // A collapse lengthens the edges around it, so the shortest come first: it spares those
        // beside it that are hardly too short.
        let mut touched = Touched::new();
        for h in short_edges(patch, &candidates) {
            collapse_edge(patch, h, corner, &mut touched, counts);
        }
        let edges = touched.edges(&patch.topology);
        if edges.is_empty() {
            return true;
        }
        flip_around(patch, edges, &mut touched, counts);
        // What failed before may succeed now where a neighbour changed.
        touched.grow(&patch.topology);
        candidates = touched.edges(&patch.topology);
    }
    false
}

/// The edges that are too short, shortest first.
fn short_edges(patch: &Patch, candidates: &[u32]) -> Vec<u32> {
    let mut short = by_length_class(candidates, |h| {
        let length = patch.half_edge_length(h);
        patch.is_short(h, length).then_some(length)
    });
    short.sort_unstable();
    short.into_iter().map(|(_, h)| h).collect()
}

fn collapse_edge(
    patch: &mut Patch,
    h: u32,
    corner: f64,
    touched: &mut Touched,
    counts: &mut Counts,
) {
    // An earlier collapse may have removed the face or changed what runs here.
    let topology = &patch.topology;
    if topology.face(h / 3).is_none()
        || !patch.is_short(h, patch.half_edge_length(h))
        || !topology.can_collapse(h)
    {
        return;
    }
    let ends = [patch.topology.tail(h), patch.topology.head(h)];
    // Either end may go. The one that leaves the better faces does, since later passes work with
    // them.
    let best = ends
        .into_iter()
        .filter_map(|gone| collapse_shape(patch, h, gone, corner).map(|shape| (shape, gone)))
        .reduce(|best, other| if other.0 > best.0 { other } else { best });
    let gone = match best {
        Some((_, gone)) => gone,
        None if patch.may_ends_meet && move_head_to_middle(patch, h) => ends[0],
        None => return,
    };
    let kept = patch.topology.other_end(h, gone);
    patch.topology.collapse(h, gone);
    // Its neighbours have changed, so relaxing may even out what the collapse has left.
    patch.set_free(kept);
    counts.collapses += 1;
    touched.add_around(&patch.topology, kept);
}

/// Moves the head of an edge to its middle where its tail may then collapse onto it; says whether
/// it did.
///
/// Between vertices of the old mesh either end may be too far from the other's neighbours, and the
/// middle seldom is: of an uneven grid coarsened by a third one edge in forty stayed under half
/// the wanted length. Ends come first, so that vertices stay where they are wherever that does.
fn move_head_to_middle(patch: &mut Patch, h: u32) -> bool {
    let (gone, kept) = (patch.topology.tail(h), patch.topology.head(h));
    if !patch.is_free(gone) || !patch.is_free(kept) {
        return false;
    }
    let faces_around = |v: u32, other: u32| {
        let faces = patch.topology.outgoing(v).map(|out| patch.corners(out));
        faces.filter(move |face| !face.contains(&other))
    };
    let faces: Vec<[u32; 3]> = faces_around(gone, kept)
        .chain(faces_around(kept, gone))
        .collect();
    // The two faces at the edge count before, though they vanish: for a needle less a face as bad
    // may stay.
    let mut before = [1.0f64; 2];
    let both = [gone, kept].map(|v| patch.topology.outgoing(v));
    for out in both.into_iter().flatten() {
        include(&mut before, patch, patch.corners(out));
    }
    let least = least_shape(patch.half_edge_length(h)).min(before[0]);
    patch.try_merge([gone, kept], |moved| {
        let mut after = [1.0f64; 2];
        for &[_, first, second] in &faces {
            include(&mut after, moved, [kept, first, second]);
        }
        let mut rim = faces.iter().flat_map(|face| &face[1..]);
        // All spokes of the merged vertex are new edges, and none may be one that would be split.
        rim.all(|&v| moved.may_join(kept, v))
            && after[0] >= least
            && Patch::stays_upright(before[1], after[1])
    })
}

/// The worst shape of the faces around after the end `gone` of `h` has moved onto the other end;
/// `None` where that is not allowed. The topology allows it.
fn collapse_shape(patch: &Patch, h: u32, gone: u32, corner: f64) -> Option<f64> {
    let topology = &patch.topology;
    let kept = topology.other_end(h, gone);
    if !may_leave(patch, gone, kept, topology.is_feature(h), corner) {
        return None;
    }
    let faces = || topology.outgoing(gone).map(|out| patch.corners(out));
    let is_left = |face: &[u32; 3]| !face.contains(&kept);
    // Lengths first, because they refuse more than shapes and cost less.
    let may_join =
        |[_, first, second]: [u32; 3]| patch.may_join(kept, first) && patch.may_join(kept, second);
    if !faces().filter(is_left).all(may_join) {
        return None;
    }
    // Faces at the edge count before and not after, as they vanish.
    let (mut before, mut after) = ([1.0f64; 2], [1.0f64; 2]);
    for face in faces() {
        include(&mut before, patch, face);
        if is_left(&face) {
            include(&mut after, patch, [kept, face[1], face[2]]);
        }
    }
    let least = least_shape(patch.half_edge_length(h)).min(before[0]);
    let is_sound = after[0] >= least && Patch::stays_upright(before[1], after[1]);
    is_sound.then_some(after[0])
}

/// The shape that a collapse of an edge of a metric length must leave, unless it was worse before.
///
/// Among edges that all are far too short every collapse makes some face worse for a while, and
/// with one bound for all lengths such clusters lock: of a sphere coarsened eighteenfold 6 % of
/// the edges stayed under half the wanted length, down to a tenth. Flips and moves mend the shape
/// once the cluster is gone; in proportion to the length they always can.
fn least_shape(length: f64) -> f64 {
    length.min(WORST_SHAPE)
}

/// Lowers the worst shape and uprightness to those of a face.
fn include(worst: &mut [f64; 2], patch: &Patch, face: [u32; 3]) {
    worst[0] = worst[0].min(patch.quality(face));
    worst[1] = worst[1].min(patch.uprightness(face));
}

/// Says whether a vertex may be removed towards `kept`: free, and on a feature only along it where
/// it runs straight on to within the cosine `corner`, before and after.
fn may_leave(patch: &Patch, gone: u32, kept: u32, is_feature: bool, corner: f64) -> bool {
    if patch.is_fixed(gone) {
        return false;
    }
    match feature_neighbours(patch, gone) {
        Features::None => true,
        Features::Curve(ends) if is_feature => {
            let other = if ends[0] == kept { ends[1] } else { ends[0] };
            turn_cosine(patch, other, gone, kept) >= corner
                && stays_straight(patch, kept, gone, other, corner)
                && stays_straight(patch, other, gone, kept, corner)
        }
        // Where features end or meet they have their shape from the vertex.
        _ => false,
    }
}

/// Whether a feature that runs straight on at `v` still does so when it runs to `after` instead
/// of `before`. Without this the turns of removed vertices would pile up in those that stay.
fn stays_straight(patch: &Patch, v: u32, before: u32, after: u32, corner: f64) -> bool {
    let Features::Curve(ends) = feature_neighbours(patch, v) else {
        return true;
    };
    let far = if ends[0] == before { ends[1] } else { ends[0] };
    far == after
        || turn_cosine(patch, far, v, before) < corner
        || turn_cosine(patch, far, v, after) >= corner
}

/// Cosine of the turn at `at` on the way from one vertex to another.
fn turn_cosine(patch: &Patch, from: u32, at: u32, to: u32) -> f64 {
    let [p, q, r] = [from, at, to].map(|v| patch.position(v));
    let (back, on) = (q - p, r - q);
    back.dot(&on) / (back.norm() * on.norm()).max(f64::MIN_POSITIVE)
}

/// Features that meet at a vertex.
enum Features {
    /// There is none.
    None,
    /// One passes, with these neighbours on it.
    Curve([u32; 2]),
    /// One ends or several meet.
    Junction,
}

fn feature_neighbours(patch: &Patch, v: u32) -> Features {
    let mut on_feature = patch.topology.neighbours(v).filter(|n| n.1).map(|n| n.0);
    match (on_feature.next(), on_feature.next(), on_feature.next()) {
        (None, _, _) => Features::None,
        (Some(first), Some(second), None) => Features::Curve([first, second]),
        _ => Features::Junction,
    }
}
