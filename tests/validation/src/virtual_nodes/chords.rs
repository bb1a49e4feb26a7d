//! Which triangles a traced line cuts, and where.

use std::collections::BTreeMap;

use ruga_crease::{LineSegment, TracedLine};
use ruga_mesh::{FaceId, Id, TriMesh};

use super::LineEnds;
use super::pieces::{Chord, SAME};

/// Chords of every face that lines cut.
pub(super) type Chords = BTreeMap<usize, Vec<Chord>>;

/// A stretch of a line inside one face.
struct Run {
    face: FaceId,
    chord: Chord,
}

/// The chords of a line. Parts that end inside a face are dropped; then the ends are treated.
///
/// # Panics
/// When the line goes through a vertex, as the paper's may not.
pub(super) fn add_chords(mesh: &TriMesh, line: &TracedLine, ends: LineEnds, chords: &mut Chords) {
    let mut runs = runs(line);
    let mut tips = Vec::new();
    if !line.is_closed() {
        // From either end: of the first run, seen along the line, and of the last, seen against it.
        for is_end in [false, true] {
            let run = match is_end {
                false => runs.first(),
                true => runs.last(),
            };
            let Some(run) = run else { return };
            let [outer, inner] = match is_end {
                false => run.chord,
                true => [run.chord[1], run.chord[0]],
            };
            if side(&outer).is_none() {
                // Ends inside the face: what is left of it is the way to its vertex opposite.
                tips.push((run.face, inner));
                let dropped = if is_end { runs.len() - 1 } else { 0 };
                runs.remove(dropped);
            } else if let Some(beyond) = across(mesh, run.face, &outer) {
                tips.push(beyond);
            }
        }
    }
    if ends == LineEnds::AtVertices {
        for (face, inner) in tips {
            let corner = side(&inner).expect("a line leaves a face through a side");
            let mut vertex = [0.0; 3];
            vertex[(corner + 2) % 3] = 1.0;
            runs.push(Run {
                face,
                chord: [vertex, inner],
            });
        }
    }
    for run in runs {
        chords.entry(run.face.index()).or_default().push(run.chord);
    }
}

/// Stretches of a line in one face after another.
fn runs(line: &TracedLine) -> Vec<Run> {
    let segments = line.segments();
    let start = match line.is_closed() {
        true => segments
            .iter()
            .zip(segments.iter().skip(1))
            .position(|(a, b)| a.face != b.face)
            .map_or(0, |last| last + 1),
        false => 0,
    };
    let in_order = segments[start..].iter().chain(&segments[..start]);
    let mut runs: Vec<Run> = Vec::new();
    for LineSegment { face, from, to, .. } in in_order {
        match runs.last_mut() {
            Some(run) if run.face == *face => run.chord[1] = *to,
            _ => runs.push(Run {
                face: *face,
                chord: [*from, *to],
            }),
        }
    }
    runs
}

/// The corner at which the side begins that a point lies on.
fn side(point: &[f64; 3]) -> Option<usize> {
    let zeros = (0..3).filter(|&corner| point[corner].abs() < SAME);
    let zeros: Vec<_> = zeros.collect();
    assert!(zeros.len() < 2, "a line goes through a vertex: {point:?}");
    zeros.first().map(|corner| (corner + 1) % 3)
}

/// The face beyond the side that a point lies on, and the point there; `None` at the border.
fn across(mesh: &TriMesh, face: FaceId, point: &[f64; 3]) -> Option<(FaceId, [f64; 3])> {
    let corner = side(point)?;
    let beyond = mesh.neighbour(face, corner)?;
    let mut there = [0.0; 3];
    for corner in [corner, (corner + 1) % 3] {
        let vertex = mesh.faces()[face][corner];
        let own = mesh.faces()[beyond].iter().position(|&v| v == vertex);
        there[own.expect("neighbours share a side")] = point[corner];
    }
    Some((beyond, there))
}
