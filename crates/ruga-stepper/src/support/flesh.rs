//! How deep a body is below places of its surface.

use nalgebra::Vector3;
use ruga_blend::{BaseSurface, Driver};
use ruga_mesh::{Id, MaterialPoint, face_normals};

/// Distance, in sizes of the body, up to which a ray is still in the triangle that it starts from.
const OWN: f64 = 1e-6;

/// Sine of the angle between a ray and a triangle up to which it runs along that.
const FLAT: f64 = 1e-9;

/// Barycentric distance by which rays count beyond a triangle's edges, or one might slip through between two of them.
const SLACK: f64 = 1e-9;

/// The surface of a body at rest, for rays into it.
pub(crate) struct Flesh<'a> {
    surface: &'a BaseSurface,
    positions: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    /// Shortest way to another triangle that counts, m.
    own: f64,
}

impl<'a> Flesh<'a> {
    pub(crate) fn new(driver: &Driver, surface: &'a BaseSurface, sides: &Vector3<f64>) -> Self {
        let positions = surface.pose(driver.rest()).positions;
        let normals = face_normals(surface.mesh(), &positions);
        let unit = normals.as_slice().iter().map(|normal| normal.normalize());
        Self {
            surface,
            normals: unit.collect(),
            positions,
            own: OWN * sides.norm(),
        }
    }

    /// Way (m) from a place of the surface, straight inwards, to where the body ends.
    pub(crate) fn below(&self, place: &MaterialPoint) -> f64 {
        let mesh = self.surface.mesh();
        let start = place.interpolate(mesh, &self.positions);
        let inwards = -self.normals[place.face.index()];
        let ways = mesh.faces().as_slice().iter().filter_map(|corners| {
            let corners = corners.map(|v| self.positions[v.index()]);
            way_to(&corners, &start, &inwards)
        });
        let beyond = ways.filter(|&way| way > self.own);
        beyond.fold(f64::INFINITY, f64::min)
    }
}

/// Way from `start` along a unit vector to a triangle (Möller and Trumbore 1997), before or behind.
fn way_to(corners: &[Vector3<f64>; 3], start: &Vector3<f64>, along: &Vector3<f64>) -> Option<f64> {
    let [a, b, c] = corners;
    let (first, second) = (b - a, c - a);
    let across = along.cross(&second);
    let volume = first.dot(&across);
    // What lies along the ray has no volume but by rounding, and no such coordinates.
    if volume.abs() <= FLAT * first.norm() * second.norm() {
        return None;
    }
    let from = start - a;
    let u = from.dot(&across) / volume;
    let turned = from.cross(&first);
    let v = along.dot(&turned) / volume;
    let is_inside = u >= -SLACK && v >= -SLACK && u + v <= 1.0 + SLACK;
    is_inside.then(|| second.dot(&turned) / volume)
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    /// A ray within the plane of a triangle does not end in it, however the plane lies.
    #[test]
    fn rays_along_triangles_do_not_end_there() {
        let triangle = [
            Vector3::new(0.0, 0.0, 0.0),
            Vector3::new(0.03, 0.0, 0.0),
            Vector3::new(0.0, 0.0, -0.02),
        ];
        let (start, inwards) = (Vector3::new(0.01, 0.0, 0.0), -Vector3::z());
        let across = Vector3::y();
        for turn in 0..50 {
            let turn = f64::from(turn);
            let turn = Rotation3::from_euler_angles(0.37 * turn, 1.1 * turn, 2.3 * turn);
            let turned = triangle.map(|corner| turn * corner);
            assert_eq!(way_to(&turned, &(turn * start), &(turn * inwards)), None);
            let above = start + across * 0.004 - Vector3::z() * 0.001;
            let way = way_to(&turned, &(turn * above), &(turn * -across));
            assert!((way.expect("it hits") - 0.004).abs() < 1e-12);
        }
    }
}
