//! Spheres and planes that particles do not enter.

use nalgebra::Vector3;

/// Distance (m) from a surface within which a particle touches it: far above rounding, far below all that moves.
const TOUCH: f64 = 1e-9;

/// What stands in the way of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its centre (m).
        centre: Vector3<f64>,
        /// Its radius (m).
        radius: f64,
    },
    /// Everything below a plane.
    Plane {
        /// A point of it (m).
        point: Vector3<f64>,
        /// Its upward direction, of length 1.
        normal: Vector3<f64>,
    },
}

/// A shape that stands or moves, eq. (14) and (15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// Where it is.
    pub shape: Shape,
    /// How it moves (m/s).
    pub velocity: Vector3<f64>,
    /// Change of velocity along the surface over that across it, at most. The paper says nothing of friction.
    pub friction: f64,
}

impl Collider {
    /// A shape that stands still and is smooth.
    pub fn fixed(shape: Shape) -> Self {
        Self {
            shape,
            velocity: Vector3::zeros(),
            friction: 0.0,
        }
    }

    /// Moves the shape through a time step of `h` seconds.
    pub fn advance(&mut self, h: f64) {
        let (Shape::Sphere { centre: place, .. } | Shape::Plane { point: place, .. }) =
            &mut self.shape;
        *place += self.velocity * h;
    }

    /// The direction out of the shape and how deep (m) in it a position (m) is; negative outside.
    ///
    /// The middle of a sphere has no way out of its own; up along z is as good as any.
    pub fn depth(&self, position: &Vector3<f64>) -> (Vector3<f64>, f64) {
        match self.shape {
            Shape::Sphere { centre, radius } => {
                let from = position - centre;
                let normal = from.try_normalize(0.0).unwrap_or_else(Vector3::z);
                (normal, radius - from.norm())
            }
            Shape::Plane { point, normal } => (normal, (point - position).dot(&normal)),
        }
    }

    /// Moves the positions (m) of particles that are not held to the surface if they are inside, eq. (14), and adds to
    /// `pushes` how far (m).
    pub(super) fn correct_positions(
        &self,
        positions: &mut [Vector3<f64>],
        held: &[bool],
        pushes: &mut [f64],
    ) {
        for ((position, held), push) in positions.iter_mut().zip(held).zip(pushes) {
            let (normal, depth) = self.depth(position);
            if depth > 0.0 && !held {
                *position += normal * depth;
                *push += depth;
            }
        }
    }

    /// Corrects the velocities (m/s) of particles that touch the surface, eq. (15).
    ///
    /// What goes inwards is taken away, and from what goes along friction takes its share of all change across: of what
    /// is taken away here, and of the `stopped` velocities that corrections of positions have taken away before.
    pub(super) fn correct_velocities(
        &self,
        velocities: &mut [Vector3<f64>],
        positions: &[Vector3<f64>],
        stopped: &[f64],
    ) {
        let particles = velocities.iter_mut().zip(positions).zip(stopped);
        for ((velocity, position), stopped) in particles {
            let (normal, depth) = self.depth(position);
            if depth <= -TOUCH {
                continue;
            }
            let relative = *velocity - self.velocity;
            let inward = (-relative.dot(&normal)).max(0.0);
            let outward = relative.dot(&normal).max(0.0);
            let along = relative - normal * relative.dot(&normal);
            let lost = self.friction * (inward + stopped);
            let kept = match along.norm() {
                speed if speed > lost => 1.0 - lost / speed,
                _ => 0.0,
            };
            *velocity = self.velocity + along * kept + normal * outward;
        }
    }
}
