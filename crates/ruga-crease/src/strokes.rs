//! Lines from strokes that are painted on the islands of a texture layout.

use nalgebra::Vector2;
use ruga_mesh::{MaterialPoint, PerFace};

use crate::islands::Islands;
use crate::rounding::rounded;
use crate::seam_joints::{Joint, join_at_seams};
use crate::stroke_pieces::{ClippedStroke, Mark, Piece};
use crate::trace::{LineTracer, stopped};
use crate::walk::Step;
use crate::{Corners, CreaseError, TracedLine};

/// Share of a stroke, or widths and texels besides, that may lie outside of the islands without a word: what is painted
/// over borders on purpose, so that they show no seam, or across a gap.
const MOST_OUTSIDE: f64 = 0.25;
const MOST_WIDTHS: f64 = 2.0;
const MOST_BLED: f64 = 32.0;

/// A painted stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Texture coordinates of points on its middle line.
    pub points: Vec<Vector2<f64>>,
    /// Half its width at every point (texels).
    pub half_width: Vec<f64>,
    /// Size of a texel in texture coordinates.
    pub texel: Vector2<f64>,
    /// Whether the last point is joined to the first.
    pub is_closed: bool,
}

/// What strokes become. Strokes are named by their number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TracedStrokes {
    /// Their lines, in the order of the strokes that they begin with.
    pub lines: Vec<TracedLine>,
    /// How wide the stroke of each line is.
    pub widths: Vec<StrokeWidth>,
    /// Strokes outside of all islands.
    pub outside: Vec<usize>,
    /// Strokes of which more is left out than what is painted over borders on purpose.
    pub shortened: Vec<usize>,
    /// Strokes that run over a gap onto an island that does not meet them there.
    pub astray: Vec<usize>,
    /// Strokes that are no line.
    pub refused: Vec<RefusedStroke>,
}

/// The width of a stroke, in the middle of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeWidth {
    /// On the surface (m).
    pub width: f64,
    /// In the image.
    pub texels: f64,
    /// Texture coordinates of a point of its line.
    pub uv: Vector2<f64>,
}

/// A stroke that is no line.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedStroke {
    /// Its number.
    pub stroke: usize,
    /// Texture coordinates near which something is wrong.
    pub uv: Vector2<f64>,
    /// What is wrong.
    pub error: CreaseError,
}

impl LineTracer<'_> {
    /// Traces painted strokes.
    ///
    /// What lies outside of all islands is left out. A stroke that was painted up to the border of an island ends on
    /// it; two of them that come to one place of a seam, each on its side, are one line.
    ///
    /// # Errors
    /// [`CreaseError::NoTextureCoordinates`].
    pub fn trace_strokes(
        &self,
        strokes: &[Stroke],
        corners: Corners,
    ) -> Result<TracedStrokes, CreaseError> {
        let uvs = self.texture()?;
        let islands = Islands::new(self.mesh(), uvs, self.plane(uvs));
        let mut found = TracedStrokes::default();
        let (mut pieces, mut bleeding) = (Vec::new(), Vec::new());
        for (number, stroke) in strokes.iter().enumerate() {
            let clipped =
                ClippedStroke::new(&islands, (number, stroke), free_ends(strokes, number));
            let widest = stroke.half_width.iter().copied().fold(0.0, f64::max);
            let most = (MOST_OUTSIDE * clipped.length).max(MOST_WIDTHS * 2.0 * widest + MOST_BLED);
            if clipped.pieces.is_empty() {
                found.outside.push(number);
            } else if clipped.outside > most {
                found.shortened.push(number);
            }
            pieces.extend(clipped.pieces);
            bleeding.push(most);
        }
        let joints = join_at_seams(&islands, &mut pieces);
        let astray = astray(&pieces, &joints);
        found.astray = astray.iter().map(|piece| pieces[*piece].stroke).collect();
        found.astray.dedup();
        let is_bled = |piece: &usize| pieces[*piece].texels() <= bleeding[pieces[*piece].stroke];
        let left_out: Vec<usize> = astray.into_iter().filter(is_bled).collect();
        for chain in chains(&pieces, &joints, &left_out) {
            match self.trace_chain((&islands, uvs), (&pieces, &joints, &chain), corners) {
                Ok(Some(line)) => {
                    found.widths.push(width(&pieces, &chain, line.length()));
                    found.lines.push(line);
                }
                Ok(None) => {
                    let stroke = pieces[chain.pieces[0].0].stroke;
                    let own = pieces.iter().filter(|piece| piece.stroke == stroke);
                    found.outside.extend((own.count() == 1).then_some(stroke));
                }
                Err(refused) => found.refused.push(refused),
            }
        }
        Ok(found)
    }

    /// The line of some pieces one after the other; none if it has no length.
    fn trace_chain(
        &self,
        (islands, uvs): (&Islands<'_>, &PerFace<[Vector2<f64>; 3]>),
        (pieces, joints, chain): (&[Piece], &[Joint], &Chain),
        corners: Corners,
    ) -> Result<Option<TracedLine>, RefusedStroke> {
        let mut steps: Vec<Step> = Vec::new();
        for &(number, is_reversed) in &chain.pieces {
            let piece = &pieces[number];
            let place = |side: usize| {
                let joined = joints.iter().find_map(|joint| {
                    let end = joint.ends.iter().position(|end| *end == (number, side))?;
                    Some(joint.places[end])
                });
                joined.or(piece.rims[side].map(|rim| islands.on_mesh(rim)))
            };
            let found = self.trace_piece(uvs, (piece, [place(0), place(1)]), corners);
            let mut found = found.map_err(|error| refused(piece, error))?;
            if is_reversed {
                found.reverse();
                for (_, from, to) in &mut found {
                    std::mem::swap(from, to);
                }
            }
            steps.extend(found);
        }
        let line = self.finish(steps, chain.is_closed);
        match (line, chain.pieces.first()) {
            (Ok(line), _) => Ok(Some(line)),
            // As little as a stroke that touches an island leaves of it.
            (Err(CreaseError::ZeroLength), _) | (_, None) => Ok(None),
            (Err(error), Some((first, _))) => Err(refused(&pieces[*first], error)),
        }
    }

    /// The way along a piece, from and to these places if it has them.
    fn trace_piece(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        (piece, [start, end]): (&Piece, [Option<MaterialPoint>; 2]),
        corners: Corners,
    ) -> Result<Vec<Step>, CreaseError> {
        let points: Vec<_> = piece.marks.iter().map(|mark| mark.uv).collect();
        let curve = rounded(&points, piece.is_closed, corners);
        let mut places: Vec<(MaterialPoint, usize)> = Vec::with_capacity(curve.len());
        for (i, &(uv, leg)) in curve.iter().enumerate() {
            let exact = match i {
                0 => start,
                _ if i + 1 == curve.len() => end,
                _ => None,
            };
            let place = match exact {
                Some(place) => place,
                None => match self.locate(uvs, uv, leg) {
                    // A curve may swing over a border between points on the island.
                    Err(CreaseError::OutsideUv { .. }) => continue,
                    found => found?,
                },
            };
            places.push((place, leg));
        }
        let mut steps = Vec::new();
        for pair in places.windows(2) {
            let [(from, leg), (to, _)] = [pair[0], pair[1]];
            let straight = self.walk_in_uv(uvs, [from, to]);
            let found = straight.or_else(|stop| {
                let over_border = self.walk_in_space([from, to], leg);
                over_border.map_err(|_| stopped(stop, leg))
            });
            steps.extend(found?);
        }
        Ok(steps)
    }
}

/// The median of a line's widths; its length on the surface is `length` (m).
fn width(pieces: &[Piece], chain: &Chain, length: f64) -> StrokeWidth {
    let own = chain.pieces.iter().map(|(number, _)| &pieces[*number]);
    let painted: f64 = own.clone().map(Piece::texels).sum();
    let marks = own.flat_map(|piece| &piece.marks).copied();
    let mut marks: Vec<Mark> = marks.collect();
    let uv = marks[marks.len() / 2].uv;
    marks.sort_by(|a, b| a.half_width.total_cmp(&b.half_width));
    let texels = 2.0 * marks[marks.len() / 2].half_width;
    StrokeWidth {
        width: texels * length / painted,
        texels,
        uv,
    }
}

fn refused(piece: &Piece, error: CreaseError) -> RefusedStroke {
    let point = error.point().unwrap_or(0).min(piece.marks.len() - 1);
    RefusedStroke {
        stroke: piece.stroke,
        uv: piece.marks[point].uv,
        error,
    }
}

/// Which ends of a stroke no other stroke has: where strokes cross, they end on each other.
fn free_ends(strokes: &[Stroke], number: usize) -> [bool; 2] {
    let ends = |stroke: &Stroke| {
        [
            stroke.points.first().copied(),
            stroke.points.last().copied(),
        ]
    };
    let own = ends(&strokes[number]);
    let is_free = |side: usize| {
        let all = strokes.iter().enumerate();
        let mut others = all.flat_map(|(i, stroke)| {
            let ends = ends(stroke).into_iter().enumerate();
            ends.filter(move |(end, _)| (i, *end) != (number, side))
        });
        others.all(|(_, end)| end != own[side])
    };
    [is_free(0), is_free(1)]
}

/// Pieces of strokes on islands that do not meet them there: nothing joins them, and more of their stroke lies on
/// another island.
fn astray(pieces: &[Piece], joints: &[Joint]) -> Vec<usize> {
    let is_joined = |number: usize| {
        let mut ends = joints.iter().flat_map(|joint| joint.ends);
        ends.any(|(piece, _)| piece == number)
    };
    let is_astray = |number: usize| {
        let piece = &pieces[number];
        let mut others = pieces
            .iter()
            .filter(|other| other.stroke == piece.stroke && other.island != piece.island);
        !is_joined(number) && others.any(|other| other.texels() > piece.texels())
    };
    let all = 0..pieces.len();
    all.filter(|number| is_astray(*number)).collect()
}

/// Pieces that go on into each other, each with whether it is run backwards.
#[derive(Debug)]
struct Chain {
    pieces: Vec<(usize, bool)>,
    is_closed: bool,
}

/// The chains of all pieces that are not `left_out`, in the order of the first piece of each, which runs forwards.
fn chains(pieces: &[Piece], joints: &[Joint], left_out: &[usize]) -> Vec<Chain> {
    let beyond = |piece: usize, side: usize| {
        let pairs = joints.iter().flat_map(|joint| {
            let [a, b] = joint.ends;
            [(a, b), (b, a)]
        });
        let mut others = pairs.filter(|(own, _)| *own == (piece, side));
        others.next().map(|(_, other)| other)
    };
    let mut is_used = vec![false; pieces.len()];
    left_out.iter().for_each(|piece| is_used[*piece] = true);
    let mut chains = Vec::new();
    for first in 0..pieces.len() {
        if is_used[first] {
            continue;
        }
        // Back to where the line begins; round a ring that is the first piece again.
        let (mut piece, mut side) = (first, 0);
        while let Some((before, end)) = beyond(piece, side) {
            (piece, side) = (before, 1 - end);
            if before == first {
                break;
            }
        }
        let mut chain = Chain {
            pieces: Vec::new(),
            is_closed: pieces[piece].is_closed || beyond(piece, side).is_some(),
        };
        while !is_used[piece] {
            is_used[piece] = true;
            chain.pieces.push((piece, side == 1));
            if let Some(next) = beyond(piece, 1 - side) {
                (piece, side) = next;
            }
        }
        chains.push(chain);
    }
    chains
}
