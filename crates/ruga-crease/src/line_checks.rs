//! What is wrong with crease lines together, before a mesh is cut along them.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh};

use crate::{CreaseError, CreaseWarning, LineCrossing, TracedLine, line_crossings};

/// Edges that a line has at least.
const LEAST_EDGES: f64 = 2.0;

/// Edges between two lines that leave room for a fold each.
const ROOM: f64 = 2.0;

/// Edges along a line from a crossing over which the other line may be near.
const NEAR_CROSSING: f64 = 5.0;

/// Distance in edges at which lines lie on each other, and share of the shorter line that has to.
const ON_EACH_OTHER: f64 = 0.1;
const MOST_COMMON: f64 = 0.8;

/// Places at which two lines may meet before it is no longer asked how.
const MOST_MEETINGS: usize = 100;

/// Sine of the angle between lines below which they run beside each other and do not cross.
const ALONG: f64 = 0.1;

/// Edges along a line from an end at the border within which it gets away from it: at 20 degrees to it and more.
const RUN_OUT: f64 = 3.0;

/// Samples per edge along a line, and at most in all.
const SAMPLES_PER_EDGE: f64 = 2.0;
const MOST_SAMPLES: f64 = 4096.0;

/// Checks lines against each other for a mesh with edges of length `edge` (m) near them, over the surface that they
/// were traced on.
///
/// # Errors
/// [`CreaseError::TooShort`] and [`CreaseError::IdenticalLines`]; [`CreaseError::OutOfRange`] for an
/// edge that is no length.
pub fn check_lines(
    lines: &[TracedLine],
    (mesh, positions): (&TriMesh, &[Vector3<f64>]),
    edge: f64,
) -> Result<Vec<CreaseWarning>, CreaseError> {
    if edge.is_nan() || edge <= 0.0 {
        return Err(CreaseError::OutOfRange {
            name: "edge",
            value: edge,
            range: "> 0 m",
        });
    }
    if let Some(line) = lines.iter().position(|line| line.is_too_short(edge)) {
        let length = lines[line].length();
        return Err(CreaseError::TooShort { line, length, edge });
    }
    let crossings = line_crossings(lines, mesh);
    let mut warnings: Vec<_> = crossings.iter().filter_map(self_crossing).collect();
    let samples = lines
        .iter()
        .map(|line| sample(line, (mesh, positions), edge));
    let samples: Vec<_> = samples.collect();
    let boxes: Vec<_> = samples.iter().map(|line| surroundings(line)).collect();
    let are_apart = |a: usize, b: usize| {
        let room = Vector3::repeat(ROOM * edge);
        let [low, high] = [boxes[a].0 - room, boxes[a].1 + room];
        (0..3).any(|i| boxes[b].1[i] < low[i] || boxes[b].0[i] > high[i])
    };
    for first in 0..lines.len() {
        for second in (first..lines.len()).filter(|second| !are_apart(first, *second)) {
            let pair = [first, second].map(|line| (line, &lines[line], samples[line].as_slice()));
            if first != second && lie_on_each_other(pair, edge) {
                let lines = [first, second];
                return Err(CreaseError::IdenticalLines { lines });
            }
            warnings.extend(too_close(pair, &crossings, edge));
        }
    }
    Ok(warnings)
}

impl TracedLine {
    /// Whether the line is shorter than a mesh with edges of length `edge` (m) can fold.
    pub fn is_too_short(&self, edge: f64) -> bool {
        self.length() < LEAST_EDGES * edge
    }

    /// From where to where (arc lengths, m) the line is less than `edge` away from the border of the surface that it
    /// was traced on, and how close it comes there (m); of several stretches the closest. `edge` is the length of an
    /// edge of the mesh that is to fold along it (m): with less between, there is no room for the skin that it folds
    /// against. `None` for a line that keeps away from the border, or only ends at it.
    pub fn beside_border(
        &self,
        (mesh, positions): (&TriMesh, &[Vector3<f64>]),
        edge: f64,
    ) -> Option<([f64; 2], f64)> {
        let samples = sample(self, (mesh, positions), edge);
        if samples.is_empty() {
            return None;
        }
        let (low, high) = surroundings(&samples);
        let [low, high] = [low.add_scalar(-edge), high.add_scalar(edge)];
        let border = mesh.edges().iter().filter(|(_, edge)| edge.is_border());
        let chords = border.map(|(_, edge)| edge.vertices.map(|v| positions[v.index()]));
        let is_around = |[a, b]: &[Vector3<f64>; 2]| {
            (0..3).all(|i| a[i].max(b[i]) >= low[i] && a[i].min(b[i]) <= high[i])
        };
        let chords: Vec<_> = chords.filter(is_around).collect();
        let distance = |p: &Vector3<f64>| {
            let distances = chords.iter().map(|chord| distance_to(p, *chord));
            distances.fold(f64::INFINITY, f64::min)
        };
        let distances: Vec<[f64; 2]> = samples.iter().map(|(at, p)| [*at, distance(p)]).collect();
        let ends = [0, distances.len() - 1].map(|i| distances[i][0]);
        let stretches = distances.chunk_by(|a, b| (a[1] < edge) == (b[1] < edge));
        let beside = stretches.filter(|stretch| stretch[0][1] < edge);
        let beside = beside.filter_map(|stretch| {
            let [from, to] = [0, stretch.len() - 1].map(|i| stretch[i][0]);
            // A line that runs out at the border leaves it at an angle.
            let runs_out = !self.is_closed() && (from == ends[0]) != (to == ends[1]);
            let least = stretch.iter().map(|place| place[1]).fold(edge, f64::min);
            (!runs_out || to - from >= RUN_OUT * edge).then_some(([from, to], least))
        });
        beside.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn self_crossing(crossing: &LineCrossing) -> Option<CreaseWarning> {
    let [line, other] = crossing.lines;
    (line == other).then_some(CreaseWarning::SelfCrossing {
        line,
        at: crossing.at,
    })
}

/// Positions along a line, each with its arc length.
fn sample(
    line: &TracedLine,
    (mesh, positions): (&TriMesh, &[Vector3<f64>]),
    edge: f64,
) -> Vec<(f64, Vector3<f64>)> {
    let length = line.length();
    let count = (SAMPLES_PER_EDGE * length / edge)
        .ceil()
        .clamp(2.0, MOST_SAMPLES);
    let at = |i: u32| length * f64::from(i) / count;
    let places = (0..=count as u32).filter_map(|i| Some((at(i), line.place(at(i))?)));
    places
        .map(|(at, place)| (at, place.interpolate(mesh, positions)))
        .collect()
}

/// The box around the samples of a line.
fn surroundings(samples: &[(f64, Vector3<f64>)]) -> (Vector3<f64>, Vector3<f64>) {
    let none = Vector3::repeat(f64::INFINITY);
    samples.iter().fold((none, -none), |(low, high), (_, p)| {
        (low.inf(p), high.sup(p))
    })
}

type Samples<'a> = &'a [(f64, Vector3<f64>)];

type Sampled<'a> = (usize, &'a TracedLine, Samples<'a>);

fn lie_on_each_other([(_, first, a), (_, second, b)]: [Sampled<'_>; 2], edge: f64) -> bool {
    let (shorter, longer) = if first.length() <= second.length() {
        (a, b)
    } else {
        (b, a)
    };
    let on = shorter.iter().filter(|(_, p)| is_on(longer, p, edge));
    let on = on.count();
    on as f64 > MOST_COMMON * shorter.len() as f64
}

/// Whether a place lies on a line.
fn is_on(line: &[(f64, Vector3<f64>)], p: &Vector3<f64>, edge: f64) -> bool {
    let mut chords = line.windows(2);
    chords.any(|pair| distance_to(p, [pair[0].1, pair[1].1]) < ON_EACH_OTHER * edge)
}

fn distance_to(p: &Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> f64 {
    let chord = b - a;
    let share = (p - a).dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE);
    (p - a - chord * share.clamp(0.0, 1.0)).norm()
}

/// Where on the first of two lines the one ends on the other. Lines that go straight on into each other do not
/// cross.
fn joints([(_, line, a), (_, other, b)]: [Sampled<'_>; 2], edge: f64) -> Vec<f64> {
    let ends = |line: &TracedLine, samples: &[(f64, Vector3<f64>)]| {
        let ends = samples.first().into_iter().chain(samples.last());
        let ends = ends.filter(|_| !line.is_closed()).copied();
        ends.collect::<Vec<_>>()
    };
    let own = ends(line, a).into_iter();
    let own = own.filter(|(_, end)| is_on(b, end, edge));
    let others = ends(other, b).into_iter();
    let others = others.filter(|(_, end)| is_on(a, end, edge));
    let nearest = |end: Vector3<f64>| {
        let distance = |p: &Vector3<f64>| (p - end).norm_squared();
        a.iter()
            .min_by(|p, q| distance(&p.1).total_cmp(&distance(&q.1)))
    };
    let others = others.filter_map(|(_, end)| nearest(end));
    own.map(|(at, _)| at)
        .chain(others.map(|(at, _)| *at))
        .collect()
}

/// Where two lines, or parts of one, come too close without meeting there.
fn too_close(
    [(first, line, a), (second, other_line, b)]: [Sampled<'_>; 2],
    crossings: &[LineCrossing],
    edge: f64,
) -> Option<CreaseWarning> {
    let near: Vec<_> = crossings
        .iter()
        .filter(|c| c.lines == [first, second])
        .collect();
    // A line that crosses itself has both places on it.
    let places = if first == second { 2 } else { 1 };
    let mut places: Vec<f64> = near.iter().flat_map(|c| &c.at[..places]).copied().collect();
    if first != second {
        places.extend(joints([(first, line, a), (second, other_line, b)], edge));
    }
    // Lines that cross in a vertex share no face there, and are seen to meet by their distance alone.
    while let Some((at, other, distance)) = closest(((line, a), b), first == second, &places, edge)
    {
        let (own, others) = (chords_at(a, at), chords_at(b, other));
        let meets = own.iter().any(|p| {
            let mut others = others.iter();
            others.any(|q| chord_distance(*p, *q) < ON_EACH_OTHER * edge)
        });
        if !meets || places.len() >= MOST_MEETINGS {
            return Some(CreaseWarning::TooClose {
                lines: [first, second],
                at,
                distance,
            });
        }
        places.push(at);
    }
    None
}

/// The chords of a sampled line that begin or end at a sample.
fn chords_at(samples: &[(f64, Vector3<f64>)], at: f64) -> Vec<[Vector3<f64>; 2]> {
    let pairs = samples.windows(2);
    let there = pairs.filter(|pair| pair[0].0 == at || pair[1].0 == at);
    there.map(|pair| [pair[0].1, pair[1].1]).collect()
}

/// Distance of two chords that lie nearly in one plane: that of an end from the other, or none where they cross;
/// infinite for chords that run along each other.
fn chord_distance(p: [Vector3<f64>; 2], q: [Vector3<f64>; 2]) -> f64 {
    let [own, other] = [p, q].map(|[from, to]| to - from);
    let normal = own.cross(&other);
    if normal.norm() <= ALONG * own.norm() * other.norm() {
        return f64::INFINITY;
    }
    // On opposite sides of each other.
    let parts = |[a, b]: [Vector3<f64>; 2], [c, d]: [Vector3<f64>; 2]| {
        let side = |x: Vector3<f64>| (d - c).cross(&(x - c)).dot(&normal);
        side(a) * side(b) <= 0.0
    };
    if parts(p, q) && parts(q, p) {
        return 0.0;
    }
    let ends = p.iter().map(|end| distance_to(end, q));
    let ends = ends.chain(q.iter().map(|end| distance_to(end, p)));
    ends.fold(f64::INFINITY, f64::min)
}

/// The places of two lines, or of two parts of one, that come closest below two edges, and their distance; not
/// near `places` on the first.
fn closest(
    ((line, a), b): ((&TracedLine, Samples<'_>), Samples<'_>),
    is_one_line: bool,
    places: &[f64],
    edge: f64,
) -> Option<(f64, f64, f64)> {
    let meets = |at: f64| {
        places
            .iter()
            .any(|s| line.apart([*s, at]) < NEAR_CROSSING * edge)
    };
    let mut closest: Option<(f64, f64, f64)> = None;
    for &(at, p) in a.iter().filter(|(at, _)| !meets(*at)) {
        for &(other, q) in b {
            // Along one line the neighbourhood is near by itself.
            if is_one_line && line.apart([at, other]) < NEAR_CROSSING * edge {
                continue;
            }
            let distance = (q - p).norm();
            if distance < ROOM * edge && closest.is_none_or(|(_, _, least)| distance < least) {
                closest = Some((at, other, distance));
            }
        }
    }
    closest
}
