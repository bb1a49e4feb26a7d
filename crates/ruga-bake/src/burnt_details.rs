//! Details of a burning sheet: what is left of it, char, ash, temperature and thickness.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::error::{all_finite, all_in_range, same_length};
use crate::field_raster::Raster;
use crate::{BakeError, BakeSettings, Detail, WrinkleMap};

/// Fuel share up to which a place has burnt out: between empty vertices a rounding error may be left.
const BURNT_OUT: f64 = 1e-6;

/// Temperature and fuel of a burning sheet, over all of it as it was when fresh.
///
/// They lie on a mesh of their own in UV space and are linear inside its triangles.
#[derive(Debug, Clone, Copy)]
pub struct BurntFields<'a> {
    /// Triangles, by the numbers of their vertices.
    pub faces: &'a [[u32; 3]],
    /// Texture coordinates of the corners of every triangle, V down.
    pub uvs: &'a [[Vector2<f64>; 3]],
    /// Temperature of every vertex, K.
    pub temperature: &'a [f64],
    /// Fuel share of every vertex, from 1, fresh, to 0, burnt out.
    pub fuel: &'a [f64],
    /// Level of every vertex: the sheet is still there where it is positive.
    pub level: &'a [f64],
    /// Thickness of what has burnt out, over that of the fresh sheet.
    pub char_thickness: f64,
}

impl WrinkleMap {
    /// Adds those of `details` that a fire makes: mask, char, ash, temperature, thickness.
    ///
    /// A texel has the mean over its samples, `supersample` (1, 2 or 4) of them along each side. Texels beside
    /// the mesh take the value of a neighbour, all others are neutral. The relief is not asked for: where the
    /// sheet is gone it has none. After the maps of all layers are composed, before padding.
    ///
    /// # Errors
    /// [`BakeError::Supersample`], [`BakeError::LengthMismatch`], [`BakeError::IndexOutOfRange`],
    /// [`BakeError::NotFinite`].
    pub fn paint_burnt(
        &mut self,
        fields: &BurntFields<'_>,
        details: &[Detail],
        supersample: u32,
    ) -> Result<(), BakeError> {
        fields.validate()?;
        let settings = BakeSettings {
            size: self.size,
            supersample,
            ..BakeSettings::default()
        };
        settings.validate()?;
        let raster = Raster {
            size: self.size,
            supersample,
            square: self.square,
        };
        for &detail in details {
            let Some(value) = value_of(detail) else {
                continue;
            };
            let mut texels = raster.fill(fields.uvs, |face, l| [value(&fields.at(face, l))]);
            reach_over_border(&mut texels, self.size as usize);
            self.paint(detail, &texels);
        }
        Ok(())
    }
}

/// The fields at one sample.
struct Sample {
    temperature: f64,
    fuel: f64,
    is_there: bool,
    char_thickness: f64,
}

/// The number that a detail has at a sample; `None` for details that no fire makes.
fn value_of(detail: Detail) -> Option<fn(&Sample) -> f64> {
    Some(match detail {
        Detail::Mask => |sample| f64::from(sample.is_there),
        Detail::Char => |sample| 1.0 - sample.fuel,
        Detail::Ash => |sample| f64::from(sample.fuel <= BURNT_OUT),
        Detail::Temperature => |sample| sample.temperature,
        Detail::Thickness => |sample| {
            let left = 1.0 + (sample.char_thickness - 1.0) * (1.0 - sample.fuel);
            if sample.is_there { left } else { 0.0 }
        },
        Detail::Occlusion
        | Detail::Curvature
        | Detail::Compression
        | Detail::ObjectNormal
        | Detail::Displacement => return None,
    })
}

impl BurntFields<'_> {
    fn validate(&self) -> Result<(), BakeError> {
        let vertices = self.temperature.len();
        same_length("fuel", self.fuel.len(), vertices)?;
        same_length("level", self.level.len(), vertices)?;
        same_length("uvs", self.uvs.len(), self.faces.len())?;
        all_in_range("faces", self.faces, vertices)?;
        for (name, field) in [
            ("temperature", self.temperature),
            ("fuel", self.fuel),
            ("level", self.level),
            ("char_thickness", &[self.char_thickness]),
        ] {
            all_finite(name, field, |value| value.is_finite())?;
        }
        all_finite("uvs", self.uvs, |corners| {
            corners.iter().flatten().all(|c| c.is_finite())
        })
    }

    /// The fields at barycentric coordinates of a triangle.
    fn at(&self, face: usize, l: [f64; 3]) -> Sample {
        let corners = self.faces[face].map(|vertex| vertex as usize);
        let blend = |field: &[f64]| corners.iter().zip(l).map(|(&v, l)| field[v] * l).sum();
        let level: f64 = blend(self.level);
        Sample {
            temperature: blend(self.temperature),
            fuel: blend(self.fuel),
            is_there: level > 0.0,
            char_thickness: self.char_thickness,
        }
    }
}

/// Gives texels without a sample the value of a texel beside them.
///
/// Vertices on the middle of the artist's edges are rounded, so that a texel whose centre lies on the border of
/// an island may be inside it and beside this mesh: neutral, it would be a fresh speck on a sheet that is gone.
fn reach_over_border(texels: &mut [Option<[f64; 1]>], side: usize) {
    let beside = |texel: usize| {
        let [row, column] = [texel / side, texel % side];
        let around = |at: usize| at.saturating_sub(1)..(at + 2).min(side);
        let rows = around(row).flat_map(|row| around(column).map(move |c| row * side + c));
        rows.filter_map(|texel| texels[texel]).next()
    };
    let empty = (0..texels.len()).into_par_iter();
    let empty = empty.filter(|&texel| texels[texel].is_none());
    let found = empty.filter_map(|texel| Some((texel, beside(texel)?)));
    // All are found before the first is written: values reach one texel far.
    for (texel, value) in found.collect::<Vec<_>>() {
        texels[texel] = Some(value);
    }
}
