//! One place for the junctions into which thinning pulls a crossing of strokes apart.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::pixel_graph::{Branch, degrees};

/// Texels by which a bar between junctions may come out too long: either end is off by up to one.
const BAR_SLACK: f64 = 2.0;

/// Times by which a bar may be longer than that of even strokes at the angle that is measured.
const BAR_TOLERANCE: f64 = 1.5;

/// Texels over which a branch's direction is measured: over 20 a step aside is 3 degrees.
const DIRECTION_LENGTH: f64 = 20.0;

/// Least sine of half the angle at which strokes count as crossing: at less than 14 degrees they run together.
const LEAST_SINE: f64 = 0.12;

/// A place where three branches or more meet, in the shape that was thinned.
#[derive(Clone, Debug)]
struct Junction {
    /// Where the branches meet (texels).
    centre: Vector2<f64>,
    /// Radius of the largest disc around the centre inside the shape (texels).
    radius: f64,
    /// Unit vectors along the branches that leave this disc.
    directions: Vec<Vector2<f64>>,
}

impl Junction {
    /// Longest way from here to the middle of a crossing of strokes (texels).
    ///
    /// Where strokes of a half width h cross at an angle θ, the middle line forks where it is as far from the
    /// strokes' outer sides as from the tip of the notch between them: with s = sin(θ/2) at a distance
    /// h (1 − s) / (s + s²) from the middle, in a disc of radius 2 h / (1 + s).
    fn reach(&self) -> f64 {
        let pairs = self.directions.iter().enumerate();
        let sines = pairs.flat_map(|(i, a)| {
            self.directions[..i]
                .iter()
                .map(move |b| (a - b).norm() / 2.0)
        });
        let sine = sines.fold(1.0, f64::min).max(LEAST_SINE);
        // At large angles the fork is near and its directions say little: there discs that touch will do.
        // The centre's texel, where the radius is measured, may lie half a texel aside.
        (self.radius + 0.5) * (BAR_TOLERANCE * (1.0 - sine) / (2.0 * sine)).max(1.0)
    }
}

/// Branches without the short bars between junctions; what else ends on these meets at their mean instead.
/// `radius` is that of the largest disc around a place inside the shape that was thinned (texels).
///
/// A bar is short if strokes that cross at the angle of the branches at its ends would leave it.
pub(crate) fn gathered(
    branches: Vec<Branch>,
    radius: impl Fn(&Vector2<f64>) -> f64,
) -> Vec<Branch> {
    let junctions = junctions(&branches, radius);
    // Longest way between the ends of a branch in one crossing, if it has two junctions.
    let span = |branch: &Branch| {
        let [from, to] = branch.nodes.filter(|[from, to]| from != to)?;
        Some(junctions.get(&from)?.reach() + junctions.get(&to)?.reach() + BAR_SLACK)
    };
    let is_bar = |branch: &Branch| span(branch).is_some_and(|span| branch.length() <= span);
    let (bars, mut arms): (Vec<_>, Vec<_>) = branches.into_iter().partition(is_bar);
    let groups = groups(&bars);
    let middles = middles(&groups, &junctions);
    // Small loops of what is one place now go too.
    arms.retain(|arm| {
        let is_round = arm.nodes.is_some_and(|ends| {
            let [a, b] = ends.map(|node| groups.get(&node));
            a.is_some() && a == b
        });
        !(is_round && span(arm).is_some_and(|span| arm.length() <= 2.0 * span))
    });
    for arm in &mut arms {
        let Some(ends) = arm.nodes else { continue };
        for node in ends {
            if let (Some(group), Some(junction)) = (groups.get(&node), junctions.get(&node)) {
                begin_at(&mut arm.points, junction, middles[group]);
            }
            // The other end comes next, and the way back after that.
            arm.points.reverse();
        }
        arm.nodes = Some(ends.map(|node| groups.get(&node).copied().unwrap_or(node)));
    }
    arms
}

fn junctions(
    branches: &[Branch],
    radius: impl Fn(&Vector2<f64>) -> f64,
) -> BTreeMap<usize, Junction> {
    let degrees = degrees(branches);
    let mut junctions = BTreeMap::new();
    for branch in branches {
        let Some([from, to]) = branch.nodes else {
            continue;
        };
        let mut points = branch.points.clone();
        for node in [from, to] {
            if degrees[&node] > 2 {
                let centre = points[0];
                let junction = junctions.entry(node).or_insert_with(|| Junction {
                    centre,
                    radius: radius(&centre),
                    directions: Vec::new(),
                });
                junction.directions.extend(direction(&points, junction));
            }
            points.reverse();
        }
    }
    junctions
}

/// Direction of a branch beyond a junction's disc, if it goes on for long enough to tell.
fn direction(points: &[Vector2<f64>], junction: &Junction) -> Option<Vector2<f64>> {
    let along = points.iter().map(|p| p - junction.centre);
    let mut beyond = along.skip_while(|p| p.norm() <= junction.radius);
    let near = beyond.next()?;
    let longest = DIRECTION_LENGTH.max(2.0 * junction.radius);
    let far = beyond
        .map(|p| p - near)
        .take_while(|p| p.norm() <= longest)
        .last()?;
    (far.norm() > longest / 4.0).then(|| far.normalize())
}

/// The least of the nodes that hang together by bars, for each node at a bar.
fn groups(bars: &[Branch]) -> BTreeMap<usize, usize> {
    let mut groups: BTreeMap<usize, usize> = BTreeMap::new();
    for [from, to] in bars.iter().filter_map(|bar| bar.nodes) {
        let [a, b] = [from, to].map(|node| *groups.entry(node).or_insert(node));
        for group in groups.values_mut().filter(|group| **group == a.max(b)) {
            *group = a.min(b);
        }
    }
    groups
}

/// The mean place of the junctions of each group.
fn middles(
    groups: &BTreeMap<usize, usize>,
    junctions: &BTreeMap<usize, Junction>,
) -> BTreeMap<usize, Vector2<f64>> {
    let mut sums: BTreeMap<usize, (Vector2<f64>, f64)> = BTreeMap::new();
    for (node, group) in groups {
        let sum = sums.entry(*group).or_insert((Vector2::zeros(), 0.0));
        *sum = (sum.0 + junctions[node].centre, sum.1 + 1.0);
    }
    let mean = |(group, (sum, count))| (group, sum / count);
    sums.into_iter().map(mean).collect()
}

/// Makes a chain of points begin elsewhere than at its junction.
///
/// Inside the junction's disc the middle line is bent by other strokes; from the place where these really meet the
/// stroke runs straight to the disc's rim.
fn begin_at(points: &mut Vec<Vector2<f64>>, junction: &Junction, middle: Vector2<f64>) {
    let is_inside = |p: &&Vector2<f64>| (**p - junction.centre).norm() <= junction.radius;
    let inside = points.iter().take_while(is_inside).count();
    // The other end stays.
    let inside = inside.min(points.len().saturating_sub(1));
    points.splice(..inside, [middle]);
}
