//! Whether a surface encloses a body: closed, not crossing itself, normals outwards.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, PerFace, TriMesh};

use crate::error::{LatticeError, check_length};
use crate::self_intersection::intersecting_pairs;

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
    let (parts, count) = mesh.components();
    let volumes = part_volumes(mesh, positions, &parts, count as usize);
    for (part, &volume) in volumes.iter().enumerate() {
        let Some((face, _)) = parts.iter().find(|&(_, &p)| p as usize == part) else {
            continue;
        };
        let point = positions[mesh.faces()[face][0].index()];
        let depth = depth_within_others(mesh, positions, &parts, part as u32, &point);
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

fn part_volumes(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    parts: &PerFace<u32>,
    count: usize,
) -> Vec<f64> {
    // Measured from a point of the surface, a body far from the origin loses no digits.
    let origin = positions[mesh.faces()[FaceId(0)][0].index()];
    let mut volumes = vec![0.0; count];
    for (face, vertices) in mesh.faces().iter() {
        let [a, b, c] = vertices.map(|v| positions[v.index()] - origin);
        volumes[parts[face] as usize] += a.dot(&b.cross(&c)) / 6.0;
    }
    volumes
}

/// The winding number of all other parts around a point: a sum of solid angles.
fn depth_within_others(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    parts: &PerFace<u32>,
    own: u32,
    point: &Vector3<f64>,
) -> i64 {
    let others = mesh.faces().iter().filter(|(face, _)| parts[*face] != own);
    let angle: f64 = others
        .map(|(_, face)| solid_angle(&face.map(|v| positions[v.index()] - point)))
        .sum();
    (angle / (2.0 * TAU)).round() as i64
}

/// Van Oosterom and Strackee 1983, eq. (8).
fn solid_angle([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
    let sine = a.dot(&b.cross(c));
    let cosine = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * sine.atan2(cosine)
}
