//! Shaded skin, seen from above at a slant.

use std::error::Error;

use nalgebra::{Matrix3, Vector2, Vector3};
use ruga_blend::face_strains;
use ruga_mesh::{Id, TriMesh, VertexId, face_normals, vertex_normals};

use super::surface::Surface;
use ruga_validation::canvas::Canvas;
use ruga_validation::light::skin;

/// Pixels across.
const WIDTH: usize = 900;

/// How far the eye goes down from above the skin, and around it, rad: to the side that lets the
/// lamp, at the upper left, shine across wrinkles that run along y.
const SLANT: f64 = 0.75;
const TURN: f64 = -0.4;

/// What compression counts beside the bends of wrinkles, when the side to look at is chosen.
const FLAT: f64 = 1e-6;

/// Draws a layer, looking at where it is bent more than at `rest`; without wrinkles, at where it is
/// compressed. Wrinkles end compression, so that it may be greater on the far side of a bent bar, which
/// grows thinner there.
pub(super) fn draw(layer: &Surface, rest: &[Vector3<f64>]) -> Result<Canvas, Box<dyn Error>> {
    let faces = face_normals(&layer.mesh, &layer.positions);
    let strains = face_strains(&layer.mesh, rest, &layer.positions);
    let [now, before] = [&layer.positions, rest].map(|positions| bends(&layer.mesh, positions));
    let mean: Vector3<f64> = faces
        .as_slice()
        .iter()
        .zip(strains.as_slice())
        .zip(now.iter().zip(&before))
        .map(|((normal, strain), (now, before))| {
            normal * ((now - before).max(0.0) + FLAT * strain.first.max(0.0))
        })
        .sum();
    let above = mean
        .try_normalize(0.0)
        .ok_or("a layer that nothing compresses has no side to look at it from")?;
    let skin_axes = skin_axes(above);
    let view = slanted() * skin_axes;
    let seen: Vec<Vector3<f64>> = layer.positions.iter().map(|p| view * p).collect();
    // The lamp stands beside the skin, not beside the eye: it must graze what it shows.
    let normals = vertex_normals(&layer.mesh, &layer.positions);
    let normals: Vec<Vector3<f64>> = normals.iter().map(|n| skin_axes * n).collect();
    let places: Vec<Vector2<f64>> = seen.iter().map(|p| p.xy()).collect();
    let mut canvas = Canvas::around(places.iter(), WIDTH);
    for (corners, normals) in layer
        .corners(&seen)
        .into_iter()
        .zip(layer.corners(&normals))
    {
        canvas.triangle(corners, |[a, b, c]| {
            let normal = normals[0] * a + normals[1] * b + normals[2] * c;
            skin(normal.try_normalize(0.0).unwrap_or_else(Vector3::z))
        });
    }
    Ok(canvas)
}

/// Half the squared angles, nearly, between each face and the normals at its corners.
fn bends(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<f64> {
    let (faces, normals) = (
        face_normals(mesh, positions),
        vertex_normals(mesh, positions),
    );
    let bend = |(normal, corners): (&Vector3<f64>, &[VertexId; 3])| {
        let beside = corners.iter().map(|v| &normals[v.index()]);
        beside.map(|other| 1.0 - normal.dot(other)).sum()
    };
    let pairs = faces.as_slice().iter().zip(mesh.faces().as_slice());
    pairs.map(bend).collect()
}

/// From space to the axes of skin that faces `above`: right, up and outward, turned for the eye.
fn skin_axes(above: Vector3<f64>) -> Matrix3<f64> {
    // Up in the picture is y, as far as the skin has such a direction.
    let up = [Vector3::y(), Vector3::x()]
        .map(|axis| axis - above * above.dot(&axis))
        .into_iter()
        .find(|up| up.norm() > 0.1)
        .unwrap_or_else(Vector3::z)
        .normalize();
    let right = up.cross(&above);
    let turned = [
        right * TURN.cos() - up * TURN.sin(),
        right * TURN.sin() + up * TURN.cos(),
        above,
    ];
    Matrix3::from_rows(&turned.map(|axis| axis.transpose()))
}

/// From the skin's axes to the eye's: right, up and towards the eye.
fn slanted() -> Matrix3<f64> {
    let (sin, cos) = SLANT.sin_cos();
    Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, sin, 0.0, -sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_a_rotation_that_keeps_the_skin_in_front() {
        for above in [Vector3::z(), Vector3::y(), -Vector3::y(), -Vector3::z()] {
            let view = slanted() * skin_axes(above);
            assert!((view * view.transpose() - Matrix3::identity()).norm() < 1e-12);
            assert!((view.determinant() - 1.0).abs() < 1e-12);
            assert!((view * above).z > 0.5);
        }
    }
}
