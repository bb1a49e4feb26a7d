//! What a body is made of, what holds it, and what moves.

use nalgebra::{Matrix3, Vector3};
use ruga_lattice::{Shape, SolidMaterial};

/// A soft body whose surface carries layers (Rémillard and Kry 2013, RK): what lies inside, what holds
/// it and what it runs into.
#[derive(Clone, Debug)]
pub struct Body {
    /// Lattice cells along the longest side; `None` leaves it to the plan.
    pub cells: Option<u32>,
    /// The lattice's elements.
    pub shape: Shape,
    /// Material of the inside.
    pub material: SolidMaterial,
    /// Density of the inside, kg/m3.
    pub density: f64,
    /// Acceleration of whatever has mass, m/s2.
    pub gravity: Vector3<f64>,
    /// Parts of the body that stay where they are put.
    pub handles: Vec<Handle>,
    /// Obstacles that the layer cannot enter.
    pub obstacles: Vec<Obstacle>,
    /// Stiffness per area of springs that draw the body's surface to the posed blend shapes, Pa/m
    /// (RK 7.4: muscles); `None` leaves it to itself.
    pub follow: Option<f64>,
}

/// A part of the body that moves as it is told: the lattice cells whose part of the body has its
/// centre in a box.
#[derive(Clone, Debug)]
pub struct Handle {
    /// Name in motions and messages.
    pub name: String,
    /// Lowest corner of the box, at rest, m.
    pub min: Vector3<f64>,
    /// Highest corner of the box, at rest, m.
    pub max: Vector3<f64>,
    /// Orthogonal matrix from the body's axes to those of the box, together with `shift`:
    /// `turn x + shift`.
    pub turn: Matrix3<f64>,
    /// Shift of the box's axes, m.
    pub shift: Vector3<f64>,
}

impl Handle {
    /// Whether a place at rest (m) lies in its box.
    pub(crate) fn holds(&self, place: &Vector3<f64>) -> bool {
        let place = self.turn * place + self.shift;
        (0..3).all(|c| (self.min[c]..=self.max[c]).contains(&place[c]))
    }

    /// A handle whose box lies along the body's own axes.
    pub fn new(name: impl Into<String>, [min, max]: [Vector3<f64>; 2]) -> Self {
        Self {
            name: name.into(),
            min,
            max,
            turn: Matrix3::identity(),
            shift: Vector3::zeros(),
        }
    }
}

/// A rigid thing without friction.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// Name in motions and messages.
    pub name: String,
    /// Shape and place at rest.
    pub shape: ObstacleShape,
}

/// Shapes of obstacles; lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObstacleShape {
    /// Everything behind a plane.
    Plane {
        /// A point of the plane, m.
        point: Vector3<f64>,
        /// Towards the free side; any length.
        normal: Vector3<f64>,
    },
    /// A ball.
    Sphere {
        /// Centre of the ball.
        centre: Vector3<f64>,
        /// Radius of the ball.
        radius: f64,
    },
    /// A straight cylinder with flat ends whose rim is rounded by a tenth of the radius, or of half
    /// its length if that is less: a button.
    Cylinder {
        /// Centre of one end.
        from: Vector3<f64>,
        /// Centre of the other end.
        to: Vector3<f64>,
        /// Radius of the cylinder.
        radius: f64,
    },
}

/// The way of one handle or obstacle.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Name of the handle or obstacle.
    pub of: String,
    /// Placements, ascending in `at`; interpolated linearly, from rest at 0.
    pub keyframes: Vec<Keyframe>,
}

/// Placement of a handle or obstacle at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Fraction of the pose, in (0, 1].
    pub at: f64,
    /// Way from where it is at rest, m, after it has been turned.
    pub translation: Vector3<f64>,
    /// Axis times angle, rad.
    pub turn: Vector3<f64>,
    /// A point of the axis at rest, m.
    pub about: Vector3<f64>,
}
