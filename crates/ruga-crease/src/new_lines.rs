//! New lines where wrinkles were deep: kept apart from each other and from those that are there, and smoothed.

use std::collections::BTreeMap;

use nalgebra::Vector3;

/// Rounds of smoothing of a line whose points are an edge of a mesh apart: what is shorter than some edges is noise
/// of the mesh.
const ROUNDS: usize = 8;

/// Share of the limit up to which a valley belongs to a line.
const FOLLOWED: f64 = 0.75;

/// Spacing of the points of a new line, in its distance from others.
const SPACING: f64 = 0.25;

/// A line in space that was folded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoldedLine {
    /// Its points, m.
    pub points: Vec<Vector3<f64>>,
    /// Angle by which the skin turned across the line at each point, rad.
    pub turns: Vec<f64>,
    /// Whether the last point is joined to the first.
    pub is_closed: bool,
}

impl FoldedLine {
    /// Its length, m.
    pub fn length(&self) -> f64 {
        let ways = self
            .points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm());
        let back = match (self.is_closed, self.points.first(), self.points.last()) {
            (true, Some(first), Some(last)) => (first - last).norm(),
            _ => 0.0,
        };
        ways.sum::<f64>() + back
    }

    /// Share of the length at every point.
    pub fn shares(&self) -> Vec<f64> {
        let length = self.length();
        let mut at = 0.0;
        let mut shares = vec![0.0; self.points.len()];
        for (i, pair) in self.points.windows(2).enumerate() {
            at += (pair[1] - pair[0]).norm();
            shares[i + 1] = at / length;
        }
        shares
    }

    /// Length of what turns by more than a limit.
    fn strong_length(&self, limit: f64) -> f64 {
        let strong = self.turns.iter().filter(|turn| **turn > limit).count();
        self.length() * strong as f64 / self.turns.len().max(1) as f64
    }

    /// The line without ends that turn by less than a limit.
    fn without_weak_ends(mut self, limit: f64) -> Self {
        if !self.is_closed {
            let is_strong = |turn: &f64| *turn > limit;
            let last = self.turns.iter().rposition(is_strong).map_or(0, |i| i + 1);
            let first = self.turns.iter().position(is_strong).unwrap_or(last);
            self.points = self.points[first..last].to_vec();
            self.turns = self.turns[first..last].to_vec();
        }
        self
    }

    /// Length times turn: lines that were folded more, and longer ones, come first.
    fn weight(&self) -> f64 {
        let mean = self.turns.iter().sum::<f64>() / self.turns.len().max(1) as f64;
        self.length() * mean
    }
}

/// New lines that are found one after the other, none closer than a distance to an earlier one.
#[derive(Clone, Debug)]
pub struct NewLines {
    apart: f64,
    shortest: f64,
    limit: f64,
    /// Points that are taken, by cells as long as `apart`.
    taken: BTreeMap<[i64; 3], Vec<Vector3<f64>>>,
}

impl NewLines {
    /// Lines `apart` (m, > 0) from `others`, which are there already, that turn by more than `limit` (rad) over a
    /// length of at least `shortest` (m).
    pub fn new(
        apart: f64,
        shortest: f64,
        limit: f64,
        others: impl IntoIterator<Item = Vector3<f64>>,
    ) -> Self {
        let mut lines = Self {
            apart,
            shortest,
            limit,
            taken: BTreeMap::new(),
        };
        others.into_iter().for_each(|point| lines.take(point));
        lines
    }

    /// What is left of some lines where no other one is near: those that were folded most are chosen first.
    pub fn choose(&mut self, lines: &[FoldedLine]) -> Vec<FoldedLine> {
        let mut order: Vec<(usize, f64)> =
            lines.iter().map(FoldedLine::weight).enumerate().collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut chosen = Vec::new();
        for (number, _) in order {
            let kept: Vec<FoldedLine> = self
                .free_parts(&smoothed(&lines[number]))
                .into_iter()
                .map(|part| resampled(&part, SPACING * self.apart))
                .map(|part| part.without_weak_ends(self.limit))
                .filter(|part| part.strong_length(self.limit) >= self.shortest)
                .collect();
            for point in kept.iter().flat_map(|line| &line.points) {
                self.take(*point);
            }
            chosen.extend(kept);
        }
        chosen
    }

    fn cell(&self, point: &Vector3<f64>) -> [i64; 3] {
        [point.x, point.y, point.z].map(|c| (c / self.apart).floor() as i64)
    }

    fn take(&mut self, point: Vector3<f64>) {
        self.taken.entry(self.cell(&point)).or_default().push(point);
    }

    fn is_free(&self, point: &Vector3<f64>) -> bool {
        let cell = self.cell(point);
        let cells = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|c: i64| c - 1));
        let mut near = cells.filter_map(|d| self.taken.get(&[0, 1, 2].map(|i| cell[i] + d[i])));
        !near.any(|points| {
            points
                .iter()
                .any(|other| (other - point).norm() < self.apart)
        })
    }

    /// The parts of a line that turn enough and whose points are free.
    fn free_parts(&self, line: &FoldedLine) -> Vec<FoldedLine> {
        let turned = line.turns.iter().map(|turn| *turn >= FOLLOWED * self.limit);
        let free = line.points.iter().zip(turned);
        let free = free.map(|(point, is_turned)| is_turned && self.is_free(point));
        let free: Vec<bool> = free.collect();
        if !free.contains(&false) {
            return vec![line.clone()];
        }
        let mut parts = vec![FoldedLine::default()];
        // A ring is opened where it is not free.
        let start = match line.is_closed {
            true => free.iter().position(|is_free| !is_free).unwrap_or(0),
            false => 0,
        };
        for i in (start..line.points.len()).chain(0..start) {
            match free[i] {
                true => {
                    let part = parts.last_mut().expect("there is one from the start");
                    part.points.push(line.points[i]);
                    part.turns.push(line.turns[i]);
                }
                false => parts.push(FoldedLine::default()),
            }
        }
        parts.retain(|part| part.points.len() > 1);
        parts
    }
}

/// A line without what is shorter than some of its steps; its ends stay.
fn smoothed(line: &FoldedLine) -> FoldedLine {
    let count = line.points.len();
    let mut smooth = line.clone();
    for _ in 0..ROUNDS {
        let before = smooth.clone();
        for i in 0..count {
            let beside = match (i, line.is_closed) {
                (_, true) => Some([(i + count - 1) % count, (i + 1) % count]),
                (0, false) => None,
                (i, false) if i + 1 == count => None,
                (i, false) => Some([i - 1, i + 1]),
            };
            if let Some([a, b]) = beside {
                smooth.points[i] =
                    0.5 * before.points[i] + 0.25 * (before.points[a] + before.points[b]);
                smooth.turns[i] =
                    0.5 * before.turns[i] + 0.25 * (before.turns[a] + before.turns[b]);
            }
        }
    }
    smooth
}

/// A line with points about `spacing` (m) apart.
fn resampled(line: &FoldedLine, spacing: f64) -> FoldedLine {
    let count = line.points.len();
    let legs = if line.is_closed { count } else { count - 1 };
    let mut ends = vec![0.0];
    for leg in 0..legs {
        let way = line.points[(leg + 1) % count] - line.points[leg];
        ends.push(ends[leg] + way.norm());
    }
    let length = ends[legs];
    let steps = (length / spacing).ceil().max(2.0) as usize;
    let samples = if line.is_closed { steps } else { steps + 1 };
    let mut even = FoldedLine {
        is_closed: line.is_closed,
        ..FoldedLine::default()
    };
    for sample in 0..samples {
        let at = length * sample as f64 / steps as f64;
        let leg = ends.partition_point(|end| *end <= at).clamp(1, legs) - 1;
        let share = ((at - ends[leg]) / (ends[leg + 1] - ends[leg])).clamp(0.0, 1.0);
        // Points that lie on each other have no way between them.
        let share = if share.is_finite() { share } else { 0.0 };
        let next = (leg + 1) % count;
        even.points
            .push(line.points[leg] + (line.points[next] - line.points[leg]) * share);
        even.turns
            .push(line.turns[leg] + (line.turns[next] - line.turns[leg]) * share);
    }
    even
}
