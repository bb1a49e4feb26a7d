//! How far a point is from a rigid thing, and how that changes.

use nalgebra::Vector3;

use super::placement::Placement;
use crate::{Obstacle, ObstacleShape, StepperError};

/// Radius of a button's rim over its own.
const RIM: f64 = 0.1;

/// Signed distance to a surface with its derivative; negative inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distance {
    /// Distance, negative inside, m.
    pub(crate) value: f64,
    /// Unit vector away from the obstacle.
    pub(crate) gradient: Vector3<f64>,
}

/// An obstacle where it is now.
#[derive(Clone, Debug)]
pub(crate) struct PlacedObstacle {
    pub(crate) shape: ObstacleShape,
    pub(crate) placement: Placement,
}

impl PlacedObstacle {
    pub(crate) fn at_rest(obstacle: &Obstacle) -> Self {
        Self {
            shape: obstacle.shape,
            placement: Placement::default(),
        }
    }

    pub(crate) fn distance(&self, x: &Vector3<f64>) -> Distance {
        let own = distance(&self.shape, &self.placement.pull_back(x));
        Distance {
            value: own.value,
            gradient: self.placement.rotation() * own.gradient,
        }
    }
}

impl ObstacleShape {
    /// Half of the least distance through it, m; infinite for what has no other side.
    pub(crate) fn half_depth(&self) -> f64 {
        match self {
            Self::Plane { .. } => f64::INFINITY,
            Self::Sphere { radius, .. } => *radius,
            Self::Cylinder { from, to, radius } => radius.min(0.5 * (to - from).norm()),
        }
    }
}

pub(crate) fn check(obstacle: &Obstacle) -> Result<(), StepperError> {
    let is_fine = match obstacle.shape {
        ObstacleShape::Plane { point, normal } => {
            normal.norm() > 0.0 && is_finite(&point) && is_finite(&normal)
        }
        ObstacleShape::Sphere { centre, radius } => is_length(radius) && is_finite(&centre),
        ObstacleShape::Cylinder { from, to, radius } => {
            is_length(radius) && (to - from).norm() > 0.0 && is_finite(&from) && is_finite(&to)
        }
    };
    match is_fine {
        true => Ok(()),
        false => Err(StepperError::ShapelessObstacle {
            obstacle: obstacle.name.clone(),
            shape: obstacle.shape,
        }),
    }
}

fn is_length(length: f64) -> bool {
    length > 0.0 && length.is_finite()
}

fn is_finite(v: &Vector3<f64>) -> bool {
    v.iter().all(|c| c.is_finite())
}

/// Distance of a point from a shape where it is at rest.
pub(crate) fn distance(shape: &ObstacleShape, x: &Vector3<f64>) -> Distance {
    match shape {
        ObstacleShape::Plane { point, normal } => {
            let gradient = normal.normalize();
            Distance {
                value: gradient.dot(&(x - point)),
                gradient,
            }
        }
        ObstacleShape::Sphere { centre, radius } => {
            // From the very centre any direction leads out.
            let (length, gradient) = direction(&(x - centre), &Vector3::z());
            Distance {
                value: length - radius,
                gradient,
            }
        }
        ObstacleShape::Cylinder { from, to, radius } => button([from, to], *radius, x),
    }
}

/// A cylinder with a rounded rim: in the plane through its axis, the distance to a rectangle that is
/// smaller by the rim's radius all around, less that radius.
fn button([from, to]: [&Vector3<f64>; 2], radius: f64, x: &Vector3<f64>) -> Distance {
    let axis = (to - from).normalize();
    let half = 0.5 * (to - from).norm();
    let rim = RIM * radius.min(half);
    let arm = x - 0.5 * (from + to);
    let height = axis.dot(&arm);
    let (reach, outward) = direction(&(arm - axis * height), &any_normal(&axis));
    let along = axis * height.signum();
    let [out, up] = [reach - (radius - rim), height.abs() - (half - rim)];
    let (value, gradient) = if out > 0.0 && up > 0.0 {
        let length = out.hypot(up);
        (length, (outward * out + along * up) / length)
    } else if out > up {
        // Inside both are negative, and the larger one belongs to the nearer side.
        (out, outward)
    } else {
        (up, along)
    };
    Distance {
        value: value - rim,
        gradient,
    }
}

/// Length and direction of a vector; of one without a direction, the one given.
fn direction(v: &Vector3<f64>, otherwise: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let length = v.norm();
    if length > 0.0 {
        (length, v / length)
    } else {
        (f64::MIN_POSITIVE.sqrt(), *otherwise)
    }
}

fn any_normal(axis: &Vector3<f64>) -> Vector3<f64> {
    // This axis is farthest from parallel, so that the cross product is long.
    let thinnest = axis.abs().imin();
    let mut other = Vector3::zeros();
    other[thinnest] = 1.0;
    axis.cross(&other).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gradient of every shape against differences, outside and in, on all parts of a button;
    /// and the surface is where it is said to be.
    #[test]
    fn distances_have_their_gradients() {
        let v = Vector3::new;
        let shapes = [
            ObstacleShape::Plane {
                point: v(0.1, 0.2, 0.3),
                normal: v(1.0, 2.0, -0.5),
            },
            ObstacleShape::Sphere {
                centre: v(0.1, -0.2, 0.3),
                radius: 0.7,
            },
            ObstacleShape::Cylinder {
                from: v(0.0, 0.0, -0.4),
                to: v(0.3, 0.1, 0.5),
                radius: 0.6,
            },
        ];
        let points = [
            v(0.9, 0.3, 0.2),
            v(0.1, 0.2, 1.4),
            v(0.75, 0.3, 0.65),
            v(0.3, 0.3, 0.1),
        ];
        let step = 1e-6;
        for shape in &shapes {
            for x in &points {
                let here = distance(shape, x);
                assert!((here.gradient.norm() - 1.0).abs() < 1e-12);
                for axis in 0..3 {
                    let mut displacement = Vector3::zeros();
                    displacement[axis] = step;
                    let [up, down] =
                        [x + displacement, x - displacement].map(|p| distance(shape, &p));
                    let slope = (up.value - down.value) / (2.0 * step);
                    assert!((slope - here.gradient[axis]).abs() < 1e-8, "{shape:?} {x}");
                }
            }
        }
        let button = ObstacleShape::Cylinder {
            from: v(0.0, 0.0, 0.0),
            to: v(0.0, 0.0, 1.0),
            radius: 0.5,
        };
        for on in [v(0.5, 0.0, 0.5), v(0.1, 0.0, 1.0), v(0.0, 0.0, 0.0)] {
            assert!(distance(&button, &on).value.abs() < 1e-15);
        }
        // The corner itself is cut off by the rim.
        let corner = distance(&button, &v(0.5, 0.0, 1.0)).value;
        assert!((corner - 0.05 * (2f64.sqrt() - 1.0)).abs() < 1e-15);
    }
}
