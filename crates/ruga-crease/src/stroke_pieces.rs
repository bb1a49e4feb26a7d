//! The parts of a painted stroke that lie on islands of a texture layout.

use nalgebra::Vector2;

use crate::islands::{Islands, RimPlace};
use crate::strokes::Stroke;

/// Share of a stroke's half width from which on it counts as whole: towards the corner of a square end, or of one that
/// a border cuts off aslant, the middle line lies in ever smaller discs. Half a texel less is rounding.
const WHOLE: f64 = 0.85;
const ROUNDING: f64 = 0.5;

/// Half widths, and texels at least, over which the end of a stroke may be such a corner.
const CORNER: f64 = 4.0;
const CORNER_TEXELS: f64 = 12.0;

/// Half widths, and texels at least, over which the direction of an end is measured.
const DIRECTION: f64 = 2.0;
const DIRECTION_TEXELS: f64 = 6.0;

/// Texels by which what is painted up to a border may end before it: those that the border only grazes are left out.
const SLACK: f64 = 2.0;

/// Largest distance of the last two points (texels), as [`crate::skeleton_lines`] sets them.
const LAST_POINTS: f64 = 5.7;

/// Least sine of the angle at which a stroke still runs into a border: 20 degrees.
const LEAST_SINE: f64 = 0.34;

/// Distance from a border at which a line is led along it (texels).
const INSIDE: f64 = 0.5;

/// A place on the middle line of a stroke.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    pub(crate) uv: Vector2<f64>,
    /// Half the width of the stroke there (texels).
    pub(crate) half_width: f64,
}

/// A part of a stroke on one island.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// Number of the stroke.
    pub(crate) stroke: usize,
    pub(crate) island: u32,
    pub(crate) texel: Vector2<f64>,
    pub(crate) marks: Vec<Mark>,
    /// Where its start and its end lie on the border of the island, if they do.
    pub(crate) rims: [Option<RimPlace>; 2],
    pub(crate) is_closed: bool,
}

impl Piece {
    /// Length in texels.
    pub(crate) fn texels(&self) -> f64 {
        let legs = self.marks.windows(2);
        legs.map(|pair| (pair[1].uv - pair[0].uv).component_div(&self.texel).norm())
            .sum()
    }
}

/// A stroke without what lies outside all islands.
#[derive(Debug, Default)]
pub(crate) struct ClippedStroke {
    pub(crate) pieces: Vec<Piece>,
    /// Length in all, and outside of all islands (texels).
    pub(crate) length: f64,
    pub(crate) outside: f64,
}

impl ClippedStroke {
    /// Clips a stroke, by its `number`, to the islands, and lets those of its ends that are `free` run on to a border
    /// right before them.
    pub(crate) fn new(
        islands: &Islands<'_>,
        (number, stroke): (usize, &Stroke),
        free: [bool; 2],
    ) -> Self {
        let pairs = stroke.points.iter().zip(&stroke.half_width);
        let mark = |(uv, half_width): (&Vector2<f64>, &f64)| Mark {
            uv: *uv,
            half_width: *half_width,
        };
        let mut marks: Vec<Mark> = pairs.map(mark).collect();
        let mut rims = [None; 2];
        match stroke.is_closed {
            true => marks.extend(marks.first().copied()),
            false => {
                for side in [1, 0] {
                    if free[side] {
                        rims[side] = run_out(islands, &mut marks, stroke.texel);
                    }
                    // The start comes next, and the right order after that.
                    marks.reverse();
                }
            }
        }
        let mut clipped = Self::default();
        let piece = Piece {
            stroke: number,
            island: 0,
            texel: stroke.texel,
            marks: Vec::new(),
            rims: [None; 2],
            is_closed: false,
        };
        clipped.clip(islands, &marks, piece);
        clipped.close(&marks, (stroke.is_closed, rims));
        clipped
    }

    /// Adds the parts of a middle line that lie on islands, like `empty` in all else.
    fn clip(&mut self, islands: &Islands<'_>, marks: &[Mark], empty: Piece) {
        let points: Vec<_> = marks.iter().map(|mark| mark.uv).collect();
        let around = islands.around(&points);
        let texel = empty.texel;
        let mut open: Option<Piece> = None;
        // What lies outside since the last piece.
        let mut gap: Vec<Mark> = Vec::new();
        for pair in marks.windows(2) {
            let [from, to] = [pair[0].uv, pair[1].uv];
            let length = (to - from).component_div(&texel).norm();
            if length == 0.0 {
                continue;
            }
            let is_first = self.length == 0.0;
            self.length += length;
            for part in around.shares([from, to]).windows(2) {
                let at = |share: f64| Mark {
                    uv: from + (to - from) * share,
                    half_width: pair[0].half_width
                        + (pair[1].half_width - pair[0].half_width) * share,
                };
                let here = islands.at(at(0.5 * (part[0] + part[1])).uv);
                if here.is_none() {
                    self.outside += length * (part[1] - part[0]);
                    gap.extend([part[0], 0.5 * (part[0] + part[1]), part[1]].map(at));
                }
                if open.as_ref().map(|piece| piece.island) == here {
                    continue;
                }
                let cut = at(part[0]);
                self.pieces.extend(open.take().map(|mut piece| {
                    piece.marks.push(cut);
                    piece.rims[1] = islands.nearest(piece.island, cut.uv, texel);
                    piece
                }));
                let Some(island) = here else {
                    continue;
                };
                let is_start = is_first && part[0] == 0.0;
                let outside = std::mem::take(&mut gap);
                let next = at(0.5 * (part[0] + part[1]));
                let again = self.reopened((islands, island), &outside, next);
                open = again.or_else(|| {
                    Some(Piece {
                        island,
                        marks: vec![cut],
                        rims: [
                            islands.nearest(island, cut.uv, texel).filter(|_| !is_start),
                            None,
                        ],
                        ..empty.clone()
                    })
                });
            }
            if let Some(piece) = &mut open {
                piece.marks.push(pair[1]);
            }
        }
        self.pieces.extend(open);
    }

    /// The last piece again, where the stroke has only gone along the border of its island: led inside what lies less
    /// than half its width `outside`, it is one line with the `next` mark and what follows it.
    fn reopened(
        &mut self,
        (islands, island): (&Islands<'_>, u32),
        outside: &[Mark],
        next: Mark,
    ) -> Option<Piece> {
        let last = self.pieces.last()?;
        if last.island != island || outside.is_empty() {
            return None;
        }
        let texel = last.texel;
        let mut led = Vec::new();
        for mark in outside {
            let border = islands.uv(islands.nearest(island, mark.uv, texel)?);
            let way = (border - mark.uv).component_div(&texel);
            if way.norm() > mark.half_width + SLACK {
                return None;
            }
            // What lies on the border itself says nothing of which side is inside.
            if let Some(inward) = way.try_normalize(1e-6) {
                let uv = border + (inward * INSIDE).component_mul(&texel);
                led.extend((islands.at(uv) == Some(island)).then_some(Mark { uv, ..*mark }));
            }
        }
        // The border may still have a corner between two of them.
        let before = last.marks.iter().rev().nth(1)?.uv;
        let led_points = led.iter().map(|mark| mark.uv);
        let way: Vec<_> = [before]
            .into_iter()
            .chain(led_points)
            .chain([next.uv])
            .collect();
        let around = islands.around(&way);
        if way
            .windows(2)
            .any(|leg| around.shares([leg[0], leg[1]]).len() > 2)
        {
            return None;
        }
        let mut piece = self.pieces.pop()?;
        piece.marks.pop();
        piece.marks.extend(led);
        piece.rims[1] = None;
        Some(piece)
    }

    /// Puts the first and the last piece of a ring together, or gives those of an open stroke the places on borders
    /// where it was found to end.
    fn close(&mut self, marks: &[Mark], (is_closed, rims): (bool, [Option<RimPlace>; 2])) {
        let [Some(start), Some(end)] = [marks.first(), marks.last()].map(|mark| mark.map(|m| m.uv))
        else {
            return;
        };
        let begins = |piece: &Piece| piece.rims[0].is_none() && piece.marks[0].uv == start;
        let ends = |piece: &Piece| {
            piece.rims[1].is_none() && piece.marks.last().is_some_and(|mark| mark.uv == end)
        };
        let has = [
            self.pieces.first().is_some_and(begins),
            self.pieces.last().is_some_and(ends),
        ];
        match (is_closed, self.pieces.as_mut_slice()) {
            (true, [ring]) if has == [true; 2] => {
                ring.marks.pop();
                ring.is_closed = true;
            }
            (true, [first, .., last]) if has == [true; 2] => {
                last.marks.extend(first.marks.drain(..).skip(1));
                last.rims[1] = first.rims[1];
                self.pieces.remove(0);
            }
            (false, [first, ..]) => {
                if has[0] {
                    first.rims[0] = rims[0];
                }
                if let (true, Some(last)) = (has[1], self.pieces.last_mut()) {
                    last.rims[1] = rims[1];
                }
            }
            _ => {}
        }
    }
}

/// Makes a middle line end on the border of its island if its stroke was painted up to there.
///
/// Thinning leaves the middle line half a width short of where a stroke ends, or in one of the corners.
fn run_out(islands: &Islands<'_>, marks: &mut Vec<Mark>, texel: Vector2<f64>) -> Option<RimPlace> {
    let away = |a: &Mark, b: &Mark| (b.uv - a.uv).component_div(&texel).norm();
    let (mut along, mut half_width) = (0.0, 0.0_f64);
    for (number, mark) in marks.iter().enumerate().rev() {
        along += marks.get(number + 1).map_or(0.0, |next| away(mark, next));
        let wider = half_width.max(mark.half_width);
        if along > (CORNER * wider).max(CORNER_TEXELS) {
            break;
        }
        half_width = wider;
    }
    let is_whole = |mark: &Mark| mark.half_width >= WHOLE * half_width - ROUNDING;
    let whole = marks.iter().rposition(is_whole)?;
    // The last point is the middle of a texel where those before are smoothed: it would turn the line aside.
    let whole = match marks.len() {
        count if count > 3 => whole.min(count - 2),
        _ => whole,
    };
    let tip = marks[whole];
    let rough = marks.last().map_or(0.0, |last| away(&tip, last));
    let base = (DIRECTION * half_width).max(DIRECTION_TEXELS);
    let before = marks[..whole].iter().rfind(|mark| away(mark, &tip) >= base);
    let before = before.or(marks[..whole].first())?;
    let ahead = islands.ahead(islands.at(tip.uv)?, tip.uv, tip.uv - before.uv, texel)?;
    let reach = rough.min(LAST_POINTS) + (half_width + SLACK) / ahead.sine.max(LEAST_SINE);
    if ahead.distance > reach {
        return None;
    }
    marks.truncate(whole + 1);
    marks.push(Mark {
        uv: islands.uv(ahead.place),
        half_width,
    });
    Some(ahead.place)
}
