//! The two surfaces that a map compares: the layer and the driver below it.

use nalgebra::{Vector2, Vector3};

use crate::error::{all_finite, all_in_range, same_length};
use crate::tangent_frames::all_unit;
use crate::{BakeError, TangentFrame};

/// The top layer of one pose, with the smooth driver below each of its vertices.
///
/// All per-vertex arrays are in the layer's own vertex order. `faces` are counter-clockwise seen
/// from outside, so that their normals agree with `driver_normals`.
#[derive(Debug, Clone, Copy)]
pub struct Relief<'a> {
    /// The layer's vertices, m.
    pub positions: &'a [Vector3<f64>],
    /// The posed driver at each vertex's own material point, m.
    pub driver_positions: &'a [Vector3<f64>],
    /// Smooth unit normal of the posed driver there.
    pub driver_normals: &'a [Vector3<f64>],
    /// Distance from the driver to the unwrinkled layer along the normal, m.
    pub offset: f64,
    /// Triangles of the layer; vertices are shared across UV seams.
    pub faces: &'a [[u32; 3]],
    /// UV of the corners of every face, V down. Each face lies in one chart.
    pub uvs: &'a [[Vector2<f64>; 3]],
    /// Artist's triangle whose skin each face is, with barycentric coordinates of the face's
    /// corners' UVs there; beside an edge of that triangle they may leave [0, 1].
    pub artist: &'a [(u32, [[f64; 3]; 3])],
}

impl Relief<'_> {
    /// Checks lengths, index ranges and that everything is finite.
    pub(crate) fn validate(&self, frames: &[[TangentFrame; 3]]) -> Result<(), BakeError> {
        let vertices = self.positions.len();
        same_length("driver_positions", self.driver_positions.len(), vertices)?;
        same_length("driver_normals", self.driver_normals.len(), vertices)?;
        same_length("uvs", self.uvs.len(), self.faces.len())?;
        same_length("artist", self.artist.len(), self.faces.len())?;
        all_in_range("faces", self.faces, vertices)?;
        let finite = |p: &Vector3<f64>| p.iter().all(|c| c.is_finite());
        all_finite("offset", &[self.offset], |offset| offset.is_finite())?;
        all_finite("positions", self.positions, finite)?;
        all_finite("driver_positions", self.driver_positions, finite)?;
        all_unit("driver_normals", self.driver_normals)?;
        // A NaN would become coordinate zero on the integer grid and paint a false triangle.
        all_finite("uvs", self.uvs, |corners| {
            corners.iter().flatten().all(|c| c.is_finite())
        })?;
        all_finite("artist", self.artist, |(_, corners)| {
            corners.iter().flatten().all(|c| c.is_finite())
        })?;
        all_finite("frames", frames, |corners| {
            corners
                .iter()
                .all(|f| finite(&f.normal) && finite(&f.tangent) && f.sign.is_finite())
        })?;
        self.check_artist_triangles(frames.len())
    }

    fn check_artist_triangles(&self, count: usize) -> Result<(), BakeError> {
        let found = self
            .artist
            .iter()
            .position(|&(triangle, _)| triangle as usize >= count);
        match found {
            None => Ok(()),
            Some(index) => Err(BakeError::IndexOutOfRange {
                array: "artist",
                index,
                value: self.artist[index].0,
                count,
            }),
        }
    }
}
