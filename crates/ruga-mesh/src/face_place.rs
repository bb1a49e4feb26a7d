//! A place in a face that is followed into smaller and smaller faces.

use crate::box_spline::{Basis, Derivatives, basis};

/// Barycentric coordinates in some face, and how they move with those of corners 1 and 2 of the
/// face where the place was given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacePlace {
    at: [f64; 3],
    along: [[f64; 3]; 2],
}

impl FacePlace {
    /// A place in the face itself.
    pub(crate) fn new(barycentric: [f64; 3]) -> Self {
        Self {
            at: barycentric,
            along: [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]],
        }
    }

    /// The quarter of the face that holds the place, numbered as subdivision does.
    pub(crate) fn child(&self) -> usize {
        // At most one coordinate exceeds a half. Places on the middle quarter's rim count as its
        // own.
        self.at.iter().position(|&b| b > 0.5).unwrap_or(3)
    }

    /// Coordinates of the place in a quarter of the face.
    pub(crate) fn in_child(&self, child: usize) -> Self {
        self.map(|b, sum| match child {
            3 => [sum - 2.0 * b[2], sum - 2.0 * b[0], sum - 2.0 * b[1]],
            corner => std::array::from_fn(|i| 2.0 * b[i] - if i == corner { sum } else { 0.0 }),
        })
    }

    /// Renames the corners so that `corner` is the first.
    pub(crate) fn starting_at(&self, corner: usize) -> Self {
        self.map(|b, _| std::array::from_fn(|i| b[(corner + i) % 3]))
    }

    /// Applies a linear map of barycentric coordinates, given them and their sum.
    fn map(&self, map: impl Fn([f64; 3], f64) -> [f64; 3]) -> Self {
        Self {
            // Coordinates of a place sum to one, those of a direction to zero: one map serves both.
            at: map(self.at, 1.0),
            along: self.along.map(|b| map(b, 0.0)),
        }
    }

    /// Distance from the first corner: zero there, one on the opposite edge.
    ///
    /// From the two other coordinates, which keep their digits near the corner.
    pub(crate) fn distance_from_first(&self) -> f64 {
        self.at[1] + self.at[2]
    }

    /// Leaves the first quarter along the ray from corner 0; returns how far the place was on the
    /// way there, from 0 at the corner to 1 where it need not move.
    pub(crate) fn push_out_of_first(&mut self) -> f64 {
        let distance = self.distance_from_first();
        if distance >= 0.5 {
            // Doubling has cost this coordinate digits that the others still have.
            self.at[0] = 1.0 - distance;
            return 1.0;
        }
        let [_, u, v] = self.at;
        self.at = if distance > 0.0 {
            [0.5, 0.5 * u / distance, 0.5 * v / distance]
        } else {
            // No ray leads to the corner itself: the middle one stands for all.
            [0.5, 0.25, 0.25]
        };
        (2.0 * distance).max(0.0)
    }

    /// The box spline basis of this face here, with derivatives by the coordinates first given.
    pub(crate) fn basis(&self) -> Basis {
        let local = basis(self.at[1], self.at[2]);
        let [[_, a, b], [_, c, d]] = self.along;
        let mut result = Basis::zeros();
        for (from, mut to) in local.column_iter().zip(result.column_iter_mut()) {
            // The map between the coordinates is affine: no second derivatives of its own come in.
            let (u, v) = (from[1], from[2]);
            let (uu, uv, vv) = (from[3], from[4], from[5]);
            to.copy_from(&Derivatives::from([
                from[0],
                a * u + b * v,
                c * u + d * v,
                a * a * uu + 2.0 * a * b * uv + b * b * vv,
                a * c * uu + (a * d + b * c) * uv + b * d * vv,
                c * c * uu + 2.0 * c * d * uv + d * d * vv,
            ]));
        }
        result
    }
}
