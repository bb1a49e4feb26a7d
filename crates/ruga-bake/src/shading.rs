//! The normal and height inside one triangle.

use nalgebra::Vector3;

use crate::relief_normals::VertexRelief;
use crate::tangent_frames::any_orthogonal;
use crate::{Frame, Relief, TangentFrame};

/// Smallest Z that a normal map gets; glTF wants blue above one half.
const MIN_Z: f64 = 0.02;

/// The value of one sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shaded {
    /// Unit normal in tangent space.
    pub normal: Vector3<f64>,
    /// Height above the artist's surface, m.
    pub height: f64,
    /// True where the normal had to be tilted back above the tangent plane.
    pub folded: bool,
}

/// A field inside a triangle: linear between the corners plus one parabola per edge.
#[derive(Debug, Clone, Copy)]
struct Quadratic<T> {
    corners: [T; 3],
    /// Four times the deviation at the middle of the edge *opposite* each corner.
    bulges: [T; 3],
}

/// One triangle, ready to be evaluated at barycentric coordinates.
#[derive(Debug, Clone)]
pub(crate) struct TriangleShader {
    frame: Frame,
    base: [Vector3<f64>; 3],
    tilt: Quadratic<Vector3<f64>>,
    height: Quadratic<f64>,
    frame_normals: [Vector3<f64>; 3],
    tangents: [Vector3<f64>; 3],
    sign: f64,
}

impl TriangleShader {
    pub(crate) fn new(
        relief: &Relief,
        vertices: &[VertexRelief],
        frames: &[[TangentFrame; 3]],
        frame: Frame,
        face: usize,
    ) -> Self {
        let ids = relief.faces[face].map(|v| v as usize);
        let corners = ids.map(|v| vertices[v]);
        let (artist, weights) = relief.artist[face];
        let frames = frames[artist as usize];
        // Interpolation inside the artist's triangle is linear, so it may as well start from its
        // values at the corners of this one.
        let blend = |values: [Vector3<f64>; 3]| {
            weights.map(|[u, v, w]| values[0] * u + values[1] * v + values[2] * w)
        };
        let (tilt_bulges, height_bulges) = bulges(relief, ids, &corners);
        Self {
            frame,
            base: corners.map(|c| c.base),
            tilt: Quadratic {
                corners: corners.map(|c| c.tilt),
                bulges: tilt_bulges,
            },
            height: Quadratic {
                corners: corners.map(|c| c.height),
                bulges: height_bulges,
            },
            frame_normals: blend(frames.map(|f| f.normal)),
            tangents: blend(frames.map(|f| f.tangent)),
            // MikkTSpace's sign is that of the triangle's UV area, the same at all corners.
            sign: frames[0].sign,
        }
    }

    /// Evaluates at barycentric coordinates.
    pub(crate) fn shade(&self, l: [f64; 3]) -> Shaded {
        // Each product vanishes on the two other edges and is a quarter in the middle of its own,
        // which the factor four of `bulges` makes up for.
        let pairs = [l[1] * l[2], l[2] * l[0], l[0] * l[1]];
        let base = linear(&self.base, l);
        // Base and tilt are interpolated apart: where nothing wrinkles the tilt is zero, and a base
        // that turns across the face leaves no trace in the map.
        let tilt = linear(&self.tilt.corners, l) + linear(&self.tilt.bulges, pairs);
        let tangent = linear(&self.tangents, l);
        let normal = match self.frame {
            Frame::Driver => in_driver_frame(base, tilt, tangent, self.sign),
            Frame::Mesh => {
                let frame_normal = linear(&self.frame_normals, l);
                in_mesh_frame(base + tilt, frame_normal, tangent, self.sign)
            }
        };
        let scalar =
            |values: &[f64; 3], l: [f64; 3]| values[0] * l[0] + values[1] * l[1] + values[2] * l[2];
        let height = scalar(&self.height.corners, l) + scalar(&self.height.bulges, pairs);
        above_surface(normal, height)
    }
}

fn linear(values: &[Vector3<f64>; 3], l: [f64; 3]) -> Vector3<f64> {
    values[0] * l[0] + values[1] * l[1] + values[2] * l[2]
}

/// Four times the deviation from the mean at the edge midpoints, from values and derivatives at
/// both ends: a cubic `f` has `f(1/2) = (f_0 + f_1)/2 + (f'_0 - f'_1)/8`.
///
/// Linear interpolation alone leaves an error of `(k h)²/8` of the slope at wavenumber `k` and edge
/// length `h`, 5 % at ten vertices per wave; with it, the error is of third order. Both triangles
/// at an edge compute the same parabola, so the field stays continuous.
fn bulges(
    relief: &Relief,
    ids: [usize; 3],
    corners: &[VertexRelief; 3],
) -> ([Vector3<f64>; 3], [f64; 3]) {
    let edge = |opposite: usize| {
        let [i, j] = [(opposite + 1) % 3, (opposite + 2) % 3];
        let along = relief.driver_positions[ids[j]] - relief.driver_positions[ids[i]];
        // The formula's eighth times four: products of two coordinates reach a quarter only.
        let tilt = (corners[i].slope - corners[j].slope) * along / 2.0;
        let height = (corners[i].height_slope - corners[j].height_slope).dot(&along) / 2.0;
        (tilt, height)
    };
    let [a, b, c] = [edge(0), edge(1), edge(2)];
    ([a.0, b.0, c.0], [a.1, b.1, c.1])
}

/// `base + tilt` against the smooth driver normal `base`, and the tangent made orthogonal to it.
fn in_driver_frame(
    base: Vector3<f64>,
    tilt: Vector3<f64>,
    tangent: Vector3<f64>,
    sign: f64,
) -> Vector3<f64> {
    let length = base.norm();
    let normal = base / length;
    // The artist's tangent goes with the artist's normal, not with the smooth one. Only its
    // direction about the smooth normal is of use.
    let tangent = (tangent - normal * normal.dot(&tangent))
        .try_normalize(1e-9)
        .unwrap_or_else(|| any_orthogonal(&normal));
    let bitangent = normal.cross(&tangent) * sign;
    Vector3::new(
        tilt.dot(&tangent),
        tilt.dot(&bitangent),
        length + tilt.dot(&normal),
    )
}

/// Solves `x T + y B + z N = direction` with `B = sign N × T`, nothing normalised.
fn in_mesh_frame(
    direction: Vector3<f64>,
    normal: Vector3<f64>,
    tangent: Vector3<f64>,
    sign: f64,
) -> Vector3<f64> {
    // As a client's shader forms it: no Gram-Schmidt, no normalisation.
    let bitangent = normal.cross(&tangent) * sign;
    let volume = tangent.cross(&bitangent).dot(&normal);
    // Scaled by the volume, whose sign is that of `sign`; the length is normalised away later.
    Vector3::new(
        direction.dot(&bitangent.cross(&normal)),
        direction.dot(&normal.cross(&tangent)),
        direction.dot(&tangent.cross(&bitangent)),
    ) * volume.signum()
}

/// Normalises, and keeps the result above the tangent plane.
fn above_surface(normal: Vector3<f64>, height: f64) -> Shaded {
    let Some(unit) = normal.try_normalize(0.0) else {
        return Shaded {
            normal: Vector3::z(),
            height,
            folded: true,
        };
    };
    if unit.z >= MIN_Z {
        return Shaded {
            normal: unit,
            height,
            folded: false,
        };
    }
    // The direction in the plane is kept, so a fold still leans the way it does. A normal straight
    // down has none, and any will do.
    let flat = Vector3::new(unit.x, unit.y, 0.0)
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::x);
    Shaded {
        normal: flat * (1.0 - MIN_Z * MIN_Z).sqrt() + Vector3::z() * MIN_Z,
        height,
        folded: true,
    }
}
