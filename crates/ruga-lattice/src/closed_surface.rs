//! Checks that a surface encloses a body: closed, not crossing itself, normals outwards.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, TriMesh, intersecting_pairs};

use crate::error::{LatticeError, check_length};

/// Refuses whatever has no well-defined inside.
pub(crate) fn check_closed(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Result<(), LatticeError> {
    check_length("positions", mesh.vertex_count(), positions.len())?;
    let is_finite = |p: &Vector3<f64>| p.iter().all(|c| c.is_finite());
    if let Some(index) = positions.iter().position(|p| !is_finite(p)) {
        let what = "position";
        return Err(LatticeError::NotFinite { what, index });
    }
    if mesh.face_count() == 0 {
        return Err(LatticeError::NoFaces);
    }
    // In this order: the volume of an open surface depends on the origin, and winding numbers are
    // whole only where no faces cross.
    check_border(mesh)?;
    let pairs = intersecting_pairs(mesh, positions);
    if let Some(&faces) = pairs.first() {
        let count = pairs.len();
        return Err(LatticeError::SelfIntersection { count, faces });
    }
    check_sides(mesh, positions)
}

fn check_border(mesh: &TriMesh) -> Result<(), LatticeError> {
    let mut open = mesh.edges().as_slice().iter().filter(|e| e.is_border());
    match open.next() {
        None => Ok(()),
        Some(first) => Err(LatticeError::OpenSurface {
            count: 1 + open.count(),
            vertices: first.vertices,
        }),
    }
}

/// Every closed part must be the outside of a body on its own, or the wall of a hollow in one.
fn check_sides(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Result<(), LatticeError> {
    let parts = mesh.connected_parts(|_| true);
    // Measured from a point of the surface, a body far from the origin loses no digits.
    let origin = positions[mesh.faces()[FaceId(0)][0].index()];
    let corners =
        |face: FaceId, from: Vector3<f64>| mesh.faces()[face].map(|v| positions[v.index()] - from);
    for (own, part) in parts.iter().enumerate() {
        let volume = part.iter().map(|&face| {
            let [a, b, c] = corners(face, origin);
            a.dot(&b.cross(&c)) / 6.0
        });
        let volume: f64 = volume.sum();
        let face = part[0];
        // The winding number of all other parts around a point of this one: a sum of solid angles.
        // Parts do not cross, so that one point tells for all of this part.
        let point = positions[mesh.faces()[face][0].index()];
        let others = parts.iter().enumerate().filter(|(other, _)| *other != own);
        let faces = others.flat_map(|(_, faces)| faces);
        let angle: f64 = faces.map(|&face| solid_angle(&corners(face, point))).sum();
        let depth = (angle / (2.0 * TAU)).round() as i64;
        // A hollow's wall counts negatively: a body that floats in a hollow has depth zero again.
        let expected = i64::from(volume < 0.0);
        // Coordinates whose cubes overflow or vanish have no volume that could be told.
        if volume == 0.0 || !volume.is_finite() || depth != expected {
            return Err(LatticeError::WrongSide {
                face,
                volume,
                depth,
            });
        }
    }
    Ok(())
}

/// Solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983, eq. 8).
fn solid_angle([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
    let sine = a.dot(&b.cross(c));
    let cosine = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    // With two arguments, since the half angle passes a right angle where the triangle covers more
    // than half of the view.
    2.0 * sine.atan2(cosine)
}
