//! What the film lies on.

use nalgebra::Vector3;

use crate::Strip;

/// The shape of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// The plane; x shrinks.
    Flat,
    /// A cylinder of this radius (m) around an axis along y, seen from inside if negative; its arc
    /// shrinks, the radius stays.
    Cylinder(f64),
    /// A whole cylinder of this radius (m), which a closed strip fits. Nothing shrinks; the film
    /// grows along the circle. The same compression at a fixed radius, without ends.
    Tube(f64),
}

impl Base {
    /// Length along the strip over its rest length, of the base and of the film at its natural
    /// size, when the base compresses the film by `strain`.
    pub(crate) fn stretches(self, strain: f64) -> [f64; 2] {
        match self {
            Self::Flat | Self::Cylinder(_) => [1.0 - strain, 1.0],
            Self::Tube(_) => [1.0, 1.0 / (1.0 - strain)],
        }
    }

    /// Where the points of `strip` are when the base, shrinking about its middle,
    /// compresses the film by `strain`, m.
    pub fn points(self, strip: &Strip, strain: f64) -> Vec<Vector3<f64>> {
        let place = |x: f64, y: f64| match self {
            Self::Flat => Vector3::new(x, y, 0.0),
            Self::Cylinder(radius) | Self::Tube(radius) => {
                let (sin, cos) = (x / radius).sin_cos();
                Vector3::new(radius * sin, y, radius * cos)
            }
        };
        let stretch = self.stretches(strain)[0];
        let shrunk = |x: f64| (x - 0.5 * strip.length) * stretch;
        strip
            .points
            .iter()
            .map(|p| place(shrunk(p.x), p.y))
            .collect()
    }

    /// Outward unit normals at [`points`](Self::points).
    pub fn normals(self, strip: &Strip, strain: f64) -> Vec<Vector3<f64>> {
        match self {
            Self::Flat => vec![Vector3::z(); strip.points.len()],
            Self::Cylinder(radius) | Self::Tube(radius) => self
                .points(strip, strain)
                .iter()
                .map(|p| Vector3::new(p.x, 0.0, p.z) / radius)
                .collect(),
        }
    }

    /// Direction in which the base compresses the film, at a point on it.
    pub(crate) fn direction(self, point: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Flat => Vector3::x(),
            Self::Cylinder(_) | Self::Tube(_) => Vector3::new(point.z, 0.0, -point.x).normalize(),
        }
    }
}
