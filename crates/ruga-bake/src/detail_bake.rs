//! Bakes details of a layer beside its normals and heights.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::bake::painted;
use crate::detail::DetailMap;
use crate::field_raster::Raster;
use crate::horizon::open_sky;
use crate::relief_normals::{VertexRelief, vertex_reliefs};
use crate::tangent_frames::any_orthogonal;
use crate::{BakeError, BakeSettings, Detail, Frame, Relief, TangentFrame, WrinkleMap};

/// Bakes the normal and height map of one pose, and of `details` those that are the layer's own:
/// occlusion, curvature, displacement.
///
/// The others are quantities of the artist's mesh or of a fire, for the map of all layers together:
/// [`WrinkleMap::paint_object_normals`], [`WrinkleMap::paint_compression`], [`WrinkleMap::paint_burnt`]. All are
/// neutral where nothing
/// is baked, whatever the [`Frame`] of the normals.
///
/// # Errors
/// Those of [`bake`](crate::bake).
pub fn bake_detailed(
    relief: &Relief,
    frames: &[[TangentFrame; 3]],
    settings: &BakeSettings,
    details: &[Detail],
) -> Result<WrinkleMap, BakeError> {
    let mut maps = bake_squares(relief, frames, settings, details, &[[0, 0]])?;
    Ok(maps.remove(0))
}

/// Bakes the maps of several unit squares of texture space, such as UDIM tiles: one for each of `squares`,
/// which are their lowest U and V (V down).
///
/// Each is what [`bake_detailed`] makes of UVs that are moved by its square; what the squares share is
/// computed once.
///
/// # Errors
/// Those of [`bake`](crate::bake).
pub fn bake_squares(
    relief: &Relief,
    frames: &[[TangentFrame; 3]],
    settings: &BakeSettings,
    details: &[Detail],
    squares: &[[i32; 2]],
) -> Result<Vec<WrinkleMap>, BakeError> {
    settings.validate()?;
    relief.validate(frames)?;
    let vertices = vertex_reliefs(relief, settings.frame);
    let scalars = vertex_scalars(relief, details);
    let map_of = |&square: &[i32; 2]| {
        let mut map = painted(relief, &vertices, frames, settings, square);
        let raster = Raster {
            size: settings.size,
            supersample: settings.supersample,
            square,
        };
        for (detail, values) in &scalars {
            map.paint_scalar(*detail, raster, relief, values);
        }
        if details.contains(&Detail::Displacement) {
            map.paint_displacement(raster, relief, frames);
        }
        map
    };
    Ok(squares.iter().map(map_of).collect())
}

/// Those of `details` that are one number per vertex of the layer.
fn vertex_scalars(relief: &Relief, details: &[Detail]) -> Vec<(Detail, Vec<f64>)> {
    let wants = |detail| details.contains(&detail);
    let mut scalars = Vec::new();
    if wants(Detail::Occlusion) || wants(Detail::Curvature) {
        // Relative to the driver in either frame: curvature of the base would not be neutral.
        let vertices = vertex_reliefs(relief, Frame::Driver);
        if wants(Detail::Occlusion) {
            scalars.push((Detail::Occlusion, open_sky(relief, &vertices)));
        }
        if wants(Detail::Curvature) {
            // The divergence of the unit normal over the driver is twice the mean curvature of the
            // height field, at any slope: div (-grad h / sqrt(1 + |grad h|²)) = k1 + k2.
            let mean = |v: &VertexRelief| v.slope.trace() / 2.0;
            scalars.push((Detail::Curvature, vertices.par_iter().map(mean).collect()));
        }
    }
    scalars
}

impl WrinkleMap {
    /// Paints a number per vertex of the layer, linear inside its faces.
    fn paint_scalar(&mut self, detail: Detail, raster: Raster, relief: &Relief, values: &[f64]) {
        let texels = raster.fill(relief.uvs, |face, l| {
            let corners = relief.faces[face].map(|v| values[v as usize]);
            [corners.iter().zip(l).map(|(value, l)| value * l).sum()]
        });
        self.paint(detail, &texels);
    }

    fn paint_displacement(
        &mut self,
        raster: Raster,
        relief: &Relief,
        frames: &[[TangentFrame; 3]],
    ) {
        let ways: Vec<Vector3<f64>> = (0..relief.positions.len())
            .map(|v| {
                let normal = relief.driver_normals[v];
                relief.positions[v] - relief.driver_positions[v] - normal * relief.offset
            })
            .collect();
        let texels = raster.fill(relief.uvs, |face, l| {
            let blend = |of: &[Vector3<f64>]| blend(relief.faces[face].map(|v| of[v as usize]), l);
            let (triangle, corners) = &relief.artist[face];
            let weights = [0, 1, 2].map(|k| (0..3).map(|c| corners[c][k] * l[c]).sum());
            let frames = &frames[*triangle as usize];
            let tangent = self::blend(frames.map(|frame| frame.tangent), weights);
            let [t, b, n] = orthonormal(blend(relief.driver_normals), tangent, frames[0].sign);
            let way = blend(&ways);
            [way.dot(&t), way.dot(&b), way.dot(&n)]
        });
        self.paint(Detail::Displacement, &texels);
    }

    /// A detail map with these texels, neutral where there is none.
    pub(crate) fn paint<const N: usize>(&mut self, detail: Detail, texels: &[Option<[f64; N]>]) {
        let mut map = DetailMap::neutral(detail, texels.len());
        for (values, texel) in map.values.chunks_exact_mut(N).zip(texels) {
            if let Some(texel) = texel {
                values.copy_from_slice(&texel.map(|value| value as f32));
            }
        }
        self.set_detail(map);
    }
}

/// Value at barycentric coordinates.
pub(crate) fn blend(values: [Vector3<f64>; 3], l: [f64; 3]) -> Vector3<f64> {
    values[0] * l[0] + values[1] * l[1] + values[2] * l[2]
}

/// Tangent, bitangent (up in the image) and normal of unit length, orthogonal to each other.
pub(crate) fn orthonormal(
    normal: Vector3<f64>,
    tangent: Vector3<f64>,
    sign: f64,
) -> [Vector3<f64>; 3] {
    let n = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let t = (tangent - n * n.dot(&tangent))
        .try_normalize(1e-9)
        .unwrap_or_else(|| any_orthogonal(&n));
    [t, n.cross(&t) * sign, n]
}
