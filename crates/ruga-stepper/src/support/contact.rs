//! What keeps a layer out of obstacles.

use nalgebra::{Matrix3, Vector3};

use super::obstacle::PlacedObstacle;

/// Distance at which an obstacle begins to push, in thicknesses of the layer.
const REACH: f64 = 0.05;

/// Way into an obstacle, in thicknesses, for which the pressure grows by Young's modulus: of the
/// interior, which bears no more than a part of that, and of the layer, which is bent around edges
/// by pressures far above the interior's modulus. With eight edges to a wave the obstacle is then about
/// as stiff for a vertex as the layer's own faces are; far stiffer it cost half as many
/// factorisations again, for with every vertex that comes into contact unforeseen a step has to be
/// shortened.
const GIVE: [f64; 2] = [0.03, 25.0];

/// Ways through an obstacle that are looked at between two places of a vertex.
const SAMPLES: u32 = 8;

/// Frictionless obstacles: an energy per area of the distance `d` of every vertex.
///
/// ```text
/// s = reach - d     W = 0,  k s^3 / (6 reach),  k/2 (s - reach/2)^2 + k reach^2/24
///                       for s < 0, up to reach, beyond
/// ```
/// Twice continuously differentiable: with a kink in the pressure Newton's method goes back and
/// forth between touching and not touching.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) obstacles: Vec<PlacedObstacle>,
    /// Pressure per depth `k`, Pa/m.
    stiffness: f64,
    /// Distance at which an obstacle begins to push, m.
    reach: f64,
}

impl Contact {
    /// Contact of `obstacles` with a layer of `thickness` (m); moduli of interior and layer in Pa.
    pub(crate) fn new(
        obstacles: Vec<PlacedObstacle>,
        [interior, layer]: [f64; 2],
        thickness: f64,
    ) -> Self {
        let stiffness = (interior / GIVE[0] + layer / GIVE[1]) / thickness;
        Self::of_stiffness(obstacles, stiffness, REACH * thickness)
    }

    /// Obstacles that push from a distance `reach` (m) on with a pressure per depth (Pa/m).
    pub(crate) fn of_stiffness(obstacles: Vec<PlacedObstacle>, stiffness: f64, reach: f64) -> Self {
        Self {
            obstacles,
            stiffness,
            reach,
        }
    }

    /// Energy (J) of vertices with these areas (m²).
    pub(crate) fn value(&self, x: &[Vector3<f64>], areas: &[f64]) -> f64 {
        let pairs = || x.iter().zip(areas);
        let of = |obstacle: &PlacedObstacle| -> f64 {
            let energy = |(x, area)| area * self.pressure(obstacle.distance(x).value)[0];
            pairs().map(energy).sum()
        };
        self.obstacles.iter().map(of).sum()
    }

    /// Force on a vertex against growing coordinates: the energy's gradient, N.
    pub(crate) fn gradient(&self, x: &Vector3<f64>, area: f64) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for obstacle in &self.obstacles {
            let distance = obstacle.distance(x);
            // The energy falls as the distance grows.
            sum -= distance.gradient * (area * self.pressure(distance.value)[1]);
        }
        sum
    }

    /// The energy's second derivative at a vertex without that of the distance; `None` where nothing
    /// touches, N/m.
    ///
    /// What is left out is the pressure times the obstacle's curvature. In equilibrium it is little;
    /// at the beginning of a step, with vertices as deep inside as the obstacle has moved, it is a
    /// thousand times as much, and every iteration would look for an instability that is none.
    pub(crate) fn hessian(&self, x: &Vector3<f64>, area: f64) -> Option<Matrix3<f64>> {
        let mut sum = None;
        for obstacle in &self.obstacles {
            let distance = obstacle.distance(x);
            let [_, slope, bend] = self.pressure(distance.value);
            if slope > 0.0 {
                let normal = distance.gradient;
                let stiff = normal * normal.transpose() * (area * bend);
                sum = Some(sum.unwrap_or_else(Matrix3::zeros) + stiff);
            }
        }
        sum
    }

    /// Largest depth of any vertex in any obstacle, m; 0 where none is inside.
    pub(crate) fn penetration(&self, x: &[Vector3<f64>]) -> f64 {
        let depths = self.obstacles.iter().flat_map(|obstacle| {
            let depth = |x: &Vector3<f64>| -obstacle.distance(x).value;
            x.iter().map(depth)
        });
        depths.fold(0.0, f64::max)
    }

    /// Whether a vertex has passed through an obstacle on a straight line, as seen by the obstacle,
    /// from one place to another, or has ended more than `depth` (m) inside.
    pub(crate) fn is_passed(
        &self,
        (from, x): (&[PlacedObstacle], &[Vector3<f64>]),
        to: &[Vector3<f64>],
        depth: f64,
    ) -> bool {
        let passes = |(before, now): (&PlacedObstacle, &PlacedObstacle)| {
            // This is well before the middle of a thin obstacle, beyond which it would push a
            // vertex out at the far side.
            let depth = depth.min(0.5 * now.shape.half_depth());
            x.iter().zip(to).any(|(x, to)| {
                // In the obstacle's own frame both may move, and a thin obstacle that sweeps past
                // is seen too.
                let start = before.placement.pull_back(x);
                let displacement = now.placement.pull_back(to) - start;
                (1..=SAMPLES).any(|k| {
                    let place = start + displacement * (f64::from(k) / f64::from(SAMPLES));
                    super::obstacle::distance(&now.shape, &place).value < -depth
                })
            })
        };
        from.iter().zip(&self.obstacles).any(passes)
    }

    /// Energy per area (J/m²), pressure (Pa) and stiffness per area (Pa/m) at a distance (m).
    fn pressure(&self, distance: f64) -> [f64; 3] {
        let Self {
            stiffness: k,
            reach,
            ..
        } = *self;
        let s = reach - distance;
        if s <= 0.0 {
            [0.0; 3]
        } else if s < reach {
            let fraction = s / reach;
            [
                k * s * s * fraction / 6.0,
                0.5 * k * s * fraction,
                k * fraction,
            ]
        } else {
            // Pressure is straight from here on, as if it had begun at half of the reach.
            let t = s - 0.5 * reach;
            [0.5 * k * t * t + k * reach * reach / 24.0, k * t, k]
        }
    }
}
