//! MikkTSpace on the artist's mesh, with glTF's sign.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use nalgebra::{Vector2, Vector3};

use crate::BakeError;
use crate::error::{all_finite, all_in_range, same_length};

/// The tangent frame of one corner of a triangle, glTF's convention.
///
/// The bitangent is `sign * normal x tangent` and points where V *decreases* (up in the image), so
/// that green is up. `normal` and `tangent` are unit vectors, not orthogonal to each other in
/// general. Inside a triangle both are interpolated linearly and *not* renormalised before the
/// bitangent is formed: a client's shader adds `x T + y B + z N` and normalises once, and the
/// baker inverts exactly that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentFrame {
    /// The vertex normal that was passed in, unit.
    pub normal: Vector3<f64>,
    /// MikkTSpace's tangent, unit, along increasing U.
    pub tangent: Vector3<f64>,
    /// `+1` where U, V-up and the normal are right-handed, `-1` where the UVs are mirrored.
    pub sign: f64,
}

/// MikkTSpace frames of the corners of every triangle.
///
/// The algorithm sees the triangles unindexed and welds corners whose position, normal and UV
/// agree bit for bit, as its reference implementation does. It wants V up; glTF's V points down,
/// which turns its sign around, so the sign is negated here (three.js and glTF exporters do the
/// same; without it the green channel is inverted).
///
/// A corner for which MikkTSpace has no answer (a degenerate triangle without neighbours) gets an
/// arbitrary tangent orthogonal to its normal.
///
/// # Shapes and units
/// `positions` (m), `normals` (unit) and `uvs` (V down) per vertex; `triangles` index them.
///
/// # Errors
/// [`BakeError::LengthMismatch`], [`BakeError::IndexOutOfRange`], [`BakeError::NotFinite`],
/// [`BakeError::NotUnit`] for normals more than a thousandth off unit length, and
/// [`BakeError::TangentSpace`] when MikkTSpace fails.
pub fn tangent_frames(
    positions: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    uvs: &[Vector2<f64>],
    triangles: &[[u32; 3]],
) -> Result<Vec<[TangentFrame; 3]>, BakeError> {
    same_length("normals", normals.len(), positions.len())?;
    same_length("uvs", uvs.len(), positions.len())?;
    all_in_range("triangles", triangles, positions.len())?;
    all_finite("positions", positions, |p| p.iter().all(|c| c.is_finite()))?;
    all_finite("uvs", uvs, |p| p.iter().all(|c| c.is_finite()))?;
    all_unit("normals", normals)?;

    let frames = triangles
        .iter()
        .map(|triangle| triangle.map(|v| fallback_frame(normals[v as usize])))
        .collect();
    let mut corners = Corners {
        positions,
        normals,
        uvs,
        triangles,
        frames,
    };
    generate_tangents(&mut corners).map_err(|error| BakeError::TangentSpace(error.to_string()))?;
    Ok(corners.frames)
}

/// Fails on the first normal that is not finite or not of unit length.
pub(crate) fn all_unit(array: &'static str, normals: &[Vector3<f64>]) -> Result<(), BakeError> {
    const TOLERANCE: f64 = 1e-3;
    all_finite(array, normals, |n| n.iter().all(|c| c.is_finite()))?;
    for (index, normal) in normals.iter().enumerate() {
        let length = normal.norm();
        if (length - 1.0).abs() > TOLERANCE {
            return Err(BakeError::NotUnit {
                array,
                index,
                length,
            });
        }
    }
    Ok(())
}

/// One tangent per vertex, `[x, y, z, sign]`, for glTF's TANGENT attribute.
///
/// Corners of a vertex disagree where MikkTSpace splits it (mirrored UVs, or a seam that the
/// vertices do not follow). The sign is then the one most corners have (`+1` in a tie), the
/// tangent the normalised mean over the corners with that sign. A vertex without triangles, or
/// whose mean vanishes, gets `[1, 0, 0, 1]`.
///
/// # Errors
/// [`BakeError::LengthMismatch`] when `frames` and `triangles` differ in number,
/// [`BakeError::IndexOutOfRange`] when a triangle refers past `vertex_count`.
pub fn vertex_tangents(
    frames: &[[TangentFrame; 3]],
    triangles: &[[u32; 3]],
    vertex_count: usize,
) -> Result<Vec<[f32; 4]>, BakeError> {
    same_length("frames", frames.len(), triangles.len())?;
    all_in_range("triangles", triangles, vertex_count)?;
    let mut votes = vec![0.0; vertex_count];
    for (triangle, corners) in triangles.iter().zip(frames) {
        for (&vertex, frame) in triangle.iter().zip(corners) {
            votes[vertex as usize] += frame.sign;
        }
    }
    let signs: Vec<f64> = votes
        .into_iter()
        .map(|sum: f64| if sum < 0.0 { -1.0 } else { 1.0 })
        .collect();
    let mut sums = vec![Vector3::zeros(); vertex_count];
    for (triangle, corners) in triangles.iter().zip(frames) {
        for (&vertex, frame) in triangle.iter().zip(corners) {
            // Tangents on both sides of a mirror line cancel, so only one side is averaged.
            if frame.sign == signs[vertex as usize] {
                sums[vertex as usize] += frame.tangent;
            }
        }
    }
    let tangent = |(sum, sign): (Vector3<f64>, f64)| match sum.try_normalize(1e-9) {
        Some(unit) => [unit.x as f32, unit.y as f32, unit.z as f32, sign as f32],
        None => [1.0, 0.0, 0.0, 1.0],
    };
    Ok(sums.into_iter().zip(signs).map(tangent).collect())
}

fn fallback_frame(normal: Vector3<f64>) -> TangentFrame {
    TangentFrame {
        normal,
        tangent: any_orthogonal(&normal),
        sign: 1.0,
    }
}

/// A unit vector orthogonal to `normal`.
pub(crate) fn any_orthogonal(normal: &Vector3<f64>) -> Vector3<f64> {
    // The axis furthest from the normal leaves the cross product the most digits.
    let axis = match normal.iamin() {
        0 => Vector3::x(),
        1 => Vector3::y(),
        _ => Vector3::z(),
    };
    normal
        .cross(&axis)
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::x)
}

/// The unindexed view of the mesh that MikkTSpace asks for.
struct Corners<'a> {
    positions: &'a [Vector3<f64>],
    normals: &'a [Vector3<f64>],
    uvs: &'a [Vector2<f64>],
    triangles: &'a [[u32; 3]],
    frames: Vec<[TangentFrame; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    // Single precision throughout, as in the reference implementation: it welds by equal bits, and
    // clients have the same ones.
    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        self.positions[self.vertex(face, vert)]
            .map(|c| c as f32)
            .into()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.normals[self.vertex(face, vert)]
            .map(|c| c as f32)
            .into()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, vert)].map(|c| c as f32).into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
        let Some(space) = space else { return };
        let [x, y, z, sign] = space.tangent_encoded().map(f64::from);
        let tangent = Vector3::new(x, y, z);
        if let Some(unit) = tangent.try_normalize(1e-6) {
            let frame = &mut self.frames[face][vert];
            frame.tangent = unit;
            // MikkTSpace means V up; glTF's points down, which turns the sign.
            frame.sign = -sign;
        }
    }
}
