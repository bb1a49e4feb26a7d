//! Where a sheet burns, and where it will before long.

use nalgebra::Vector3;

use super::burning::{Burning, FireState, TOUCHED};
use super::fire::Heats;
use crate::support::Moves;

/// Rise of temperature over that at which it ignites, from which on a place counts as burning soon: 1.2 widths of the
/// front ahead of it.
const SOON: f64 = 0.3;

/// The same for being meshed finely as well: 4.6 widths ahead, so that the mesh lasts for the time in which the front
/// passes the difference.
const LATER: f64 = 0.01;

/// Widths of the front around a ball's way that count as burning soon, and that are meshed finely.
const AROUND_BALLS: [f64; 2] = [1.0, 4.0];

/// What a place of a burning sheet asks of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Zone {
    /// Nothing burns near, nothing is left to burn, or nothing is left.
    Fresh,
    /// It is ahead of what burns.
    Ahead,
    /// It burns, has burnt in part, or will before long.
    Burning,
}

/// A ball that heats, during one step.
pub(super) struct BallPath {
    /// Its centre at both ends of the step, m.
    ends: [Vector3<f64>; 2],
    radius: f64,
}

impl BallPath {
    /// Distance of a place from what the ball touches, m.
    fn distance(&self, x: &Vector3<f64>) -> f64 {
        let [a, b] = &self.ends;
        let way = b - a;
        let along = (x - a).dot(&way) / way.norm_squared();
        // A ball at rest has no way, and its share of it is no number.
        let along = if along > 0.0 { along.min(1.0) } else { 0.0 };
        (x - a - way * along).norm() - self.radius
    }
}

impl FireState<'_> {
    /// The balls that heat it between two fractions of a pose.
    pub(super) fn balls(&self, moves: &Moves<'_>, times: [f64; 2]) -> Vec<BallPath> {
        let balls = self.fire.sources.iter().filter_map(|source| {
            let Heats::Ball { centre, radius, .. } = source.heats else {
                return None;
            };
            Some(BallPath {
                ends: times.map(|time| moves.place_of(&source.name, &centre, time)),
                radius,
            })
        });
        balls.collect()
    }

    /// The zones of the first `count` vertices of the field mesh, which are those of the region's mesh; these
    /// are at `places` (m), which only balls ask for.
    pub(super) fn zones(
        &self,
        burning: &Burning,
        count: usize,
        (balls, places): (&[BallPath], &[Vector3<f64>]),
    ) -> Vec<Zone> {
        let front = &self.fire.front;
        let rise = front.ignition - front.surroundings;
        let level = self.level(burning);
        let fields = burning.fields();
        let near = AROUND_BALLS.map(|widths| widths * front.width);
        let zone = |v: usize| {
            let (temperature, fuel) = (fields[0][v], fields[1][v]);
            if level[v] < 0.0 || fuel <= TOUCHED {
                return Zone::Fresh;
            }
            let warm = (temperature - front.surroundings) / rise;
            let distances = balls.iter().map(|ball| ball.distance(&places[v]));
            let distance = distances.fold(f64::INFINITY, f64::min);
            if fuel < 1.0 - TOUCHED || warm > SOON || distance < near[0] {
                Zone::Burning
            } else if warm > LATER || distance < near[1] {
                Zone::Ahead
            } else {
                Zone::Fresh
            }
        };
        (0..count).map(zone).collect()
    }
}
