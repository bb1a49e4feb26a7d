//! Places on seams where parts of strokes on both sides go on into each other.

use nalgebra::Vector2;
use ruga_mesh::MaterialPoint;

use crate::islands::{Islands, RimPlace};
use crate::stroke_pieces::{Mark, Piece};

/// Texels beyond half a stroke's width up to which two ends on a seam are one: either may be painted one or two aside.
const ASIDE: f64 = 4.0;

/// Times that an end is moved aside over which the line before it is bent there.
const BEND: f64 = 4.0;

/// An end of a piece on a seam.
struct SeamEnd {
    piece: usize,
    side: usize,
    rim: RimPlace,
    /// Where it is in the texture layout, and where on the other side of the seam.
    uvs: [Vector2<f64>; 2],
    texel: Vector2<f64>,
    reach: f64,
}

/// A place of a seam where two pieces meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// The pieces, and of each the end: 0 or 1.
    pub(crate) ends: [(usize, usize); 2],
    /// The place, as each of both has it.
    pub(crate) places: [MaterialPoint; 2],
}

/// Joins ends of pieces on both sides of seams, the nearest first, and moves both to one place.
pub(crate) fn join_at_seams(islands: &Islands<'_>, pieces: &mut [Piece]) -> Vec<Joint> {
    let all = pieces.iter().enumerate();
    let ends =
        all.flat_map(|(number, piece)| [0, 1].map(|side| seam_end(islands, (number, piece), side)));
    let ends: Vec<SeamEnd> = ends.flatten().collect();
    let mut pairs = Vec::new();
    for (i, a) in ends.iter().enumerate() {
        for (j, b) in ends.iter().enumerate().skip(i + 1) {
            // Only what lies on the other side of a seam is near an end there.
            let [own, others] = [(a, b), (b, a)].map(|(a, b)| a.share_of_reach(b.uvs[1]));
            if own <= 1.0 && others <= 1.0 {
                pairs.push((own + others, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_joined = vec![false; ends.len()];
    let mut joints = Vec::new();
    for (_, i, j) in pairs {
        if is_joined[i] || is_joined[j] {
            continue;
        }
        (is_joined[i], is_joined[j]) = (true, true);
        let pair = [&ends[i], &ends[j]];
        let Some((places, uvs)) = meeting(islands, pair, pieces) else {
            continue;
        };
        for (end, uv) in pair.into_iter().zip(uvs) {
            move_end(&mut pieces[end.piece].marks, (end.side, uv), end.texel);
        }
        joints.push(Joint {
            ends: pair.map(|end| (end.piece, end.side)),
            places,
        });
    }
    joints
}

fn seam_end(
    islands: &Islands<'_>,
    (number, piece): (usize, &Piece),
    side: usize,
) -> Option<SeamEnd> {
    let rim = piece.rims[side]?;
    let (_, beyond) = islands.beyond(rim)?;
    let mark = if side == 0 {
        piece.marks.first()
    } else {
        piece.marks.last()
    };
    Some(SeamEnd {
        piece: number,
        side,
        rim,
        uvs: [islands.uv(rim), beyond],
        texel: piece.texel,
        reach: mark?.half_width + ASIDE,
    })
}

impl SeamEnd {
    /// How far a point of the layout is from here, as a share of what is near.
    fn share_of_reach(&self, uv: Vector2<f64>) -> f64 {
        (uv - self.uvs[0]).component_div(&self.texel).norm() / self.reach
    }
}

/// Place on a seam in the middle between two ends, on the mesh and in the layout, as each has it.
fn meeting(
    islands: &Islands<'_>,
    [a, b]: [&SeamEnd; 2],
    pieces: &[Piece],
) -> Option<([MaterialPoint; 2], [Vector2<f64>; 2])> {
    let middle = (a.uvs[0] + b.uvs[1]) / 2.0;
    let between = islands.nearest(pieces[a.piece].island, middle, a.texel);
    // In a corner of the island the nearest border may be another one.
    let is_near = |rim: &RimPlace| {
        let beyond = islands.beyond(*rim);
        beyond.is_some_and(|(_, uv)| b.share_of_reach(uv) <= 1.0)
    };
    let rim = between.filter(is_near).unwrap_or(a.rim);
    let (place, uv) = islands.beyond(rim)?;
    Some(([islands.on_mesh(rim), place], [islands.uv(rim), uv]))
}

/// Moves the start (0) or the end (1) of a line to a point, and what is right before it by less and less.
fn move_end(marks: &mut [Mark], (side, uv): (usize, Vector2<f64>), texel: Vector2<f64>) {
    if side == 0 {
        marks.reverse();
    }
    if let Some(last) = marks.last() {
        let shift = uv - last.uv;
        let over = BEND * shift.component_div(&texel).norm();
        let mut along = 0.0;
        let mut next = last.uv;
        for mark in marks.iter_mut().rev() {
            along += (next - mark.uv).component_div(&texel).norm();
            next = mark.uv;
            if along > over {
                break;
            }
            let share = if over > 0.0 { 1.0 - along / over } else { 0.0 };
            mark.uv += shift * share;
        }
    }
    if let Some(last) = marks.last_mut() {
        last.uv = uv;
    }
    if side == 0 {
        marks.reverse();
    }
}
