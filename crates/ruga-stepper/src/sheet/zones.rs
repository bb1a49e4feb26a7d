//! Where a sheet burns, and where it will before long.

use nalgebra::Vector3;
use ruga_mesh::{Id, TriMesh};

use super::burning::{Burning, FireState, TOUCHED};
use super::fire::Heats;
use crate::support::Moves;

/// Share of the rise to the temperature of ignition from which on a place counts as burning soon: 1.2 widths ahead of a
/// front that loses no heat.
const SOON: f64 = 0.3;

/// The same share for being meshed finely as well: 4.6 widths ahead, so that the mesh lasts for the time in which the
/// front passes the difference.
const LATER: f64 = 0.01;

/// Widths of the front around a ball's way that count as burning soon, and that are meshed finely.
const AROUND_BALLS: [f64; 2] = [1.0, 4.0];

/// What a place of a burning sheet asks of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Zone {
    /// Nothing burns near, nothing is left to burn, or nothing is left.
    Quiet,
    /// It is ahead of what burns.
    Ahead,
    /// It burns, has burnt in part, or will before long.
    Burning,
}

/// Rings of edges around these zones that are meshed finely as well, also where nothing is left to burn.
const RINGS: usize = 2;

/// A ball that heats, during one step.
pub(super) struct BallPath {
    /// Places of its centre on the way, m.
    way: Vec<Vector3<f64>>,
    radius: f64,
}

impl BallPath {
    /// Distance of a place from what the ball touches, m.
    fn distance(&self, x: &Vector3<f64>) -> f64 {
        let pairs = self.way.windows(2);
        let distances = pairs.map(|pair| {
            let way = pair[1] - pair[0];
            let along = (x - pair[0]).dot(&way) / way.norm_squared();
            // A ball at rest has no way, and its share of it is no number.
            let along = if along > 0.0 { along.min(1.0) } else { 0.0 };
            (x - pair[0] - way * along).norm()
        });
        distances.fold(f64::INFINITY, f64::min) - self.radius
    }
}

impl FireState<'_> {
    /// The balls that heat it between two fractions of a pose.
    pub(super) fn balls(&self, moves: &Moves<'_>, times: [f64; 2]) -> Vec<BallPath> {
        let parts = self.parts(moves, times);
        let balls = self.fire.sources.iter().filter_map(|source| {
            let Heats::Ball { centre, radius, .. } = source.heats else {
                return None;
            };
            // A motion may turn, so that its way is no straight line.
            let [from, to] = times;
            let at = |part: u32| from + (to - from) * f64::from(part) / f64::from(parts);
            let places = (0..=parts).map(|part| moves.place_of(&source.name, &centre, at(part)));
            Some(BallPath {
                way: places.collect(),
                radius,
            })
        });
        balls.collect()
    }

    /// The zones of the vertices of `region`, the mesh whose vertices are the first of the field mesh; these are at
    /// `places` (m), which only balls ask for.
    pub(super) fn zones(
        &self,
        burning: &Burning,
        region: &TriMesh,
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
                return Zone::Quiet;
            }
            let warm = (temperature - front.surroundings) / rise;
            let distances = balls.iter().map(|ball| ball.distance(&places[v]));
            let distance = distances.fold(f64::INFINITY, f64::min);
            if fuel < 1.0 - TOUCHED || warm > SOON || distance < near[0] {
                Zone::Burning
            } else if warm > LATER || distance < near[1] {
                Zone::Ahead
            } else {
                Zone::Quiet
            }
        };
        let mut zones: Vec<Zone> = (0..region.vertex_count()).map(zone).collect();
        for _ in 0..RINGS {
            let before = zones.clone();
            for corners in region.faces().as_slice() {
                let corners = corners.map(|v| v.index());
                if corners.iter().any(|v| before[*v] != Zone::Quiet) {
                    for v in corners.into_iter().filter(|v| before[*v] == Zone::Quiet) {
                        zones[v] = Zone::Ahead;
                    }
                }
            }
        }
        zones
    }
}
