//! Further quantities of the texels of a map, beside its normals and heights.

use nalgebra::Vector3;

use crate::WrinkleMap;

/// Quantity that a detail map holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// Share of the light of an even sky that the relief leaves a place, 0 to 1: 1 where nothing
    /// stands in its way. What the driver's own shape hides is not in it.
    Occlusion,
    /// Mean curvature of the relief, 1/m: positive on ridges, negative in furrows, zero where the
    /// layer follows the driver. A ridge of radius `r` has `1 / (2 r)`.
    Curvature,
    /// Compression that the pose asks of the skin over the critical one, from 0 to 1.
    Compression,
    /// Normal in the axes of the mesh, unit: what a shader makes of the normal map on the artist's
    /// posed mesh.
    ObjectNormal,
    /// Way from the driver's own point to the layer, less the layer's distance at rest: along the
    /// tangent, the bitangent (up in the image) and the driver's smooth normal, m.
    Displacement,
    /// Share of a burning sheet that is left, 0 to 1: 1 where it has not fallen off.
    Mask,
    /// Share of the fuel of a burning sheet that has burnt, 0 to 1, also where the sheet is gone.
    Char,
    /// Share of a burning sheet that has burnt out, 0 to 1, also where the sheet is gone: 1 where no fuel is
    /// left.
    Ash,
    /// Temperature of a burning sheet, K, also where the sheet is gone.
    Temperature,
    /// Thickness of a burning sheet over that of the fresh one; 0 where it is gone.
    Thickness,
}

impl Detail {
    /// Numbers per texel.
    pub fn channels(self) -> usize {
        match self {
            Detail::ObjectNormal | Detail::Displacement => 3,
            Detail::Occlusion
            | Detail::Curvature
            | Detail::Compression
            | Detail::Mask
            | Detail::Char
            | Detail::Ash
            | Detail::Temperature
            | Detail::Thickness => 1,
        }
    }

    /// Value of each channel of a texel without wrinkles or fire. Object-space normals have none: there it
    /// is the mesh's own normal, and outside the islands this one. Temperatures are those of the sheet's
    /// surroundings, and outside the islands 293.15 K.
    pub fn neutral(self) -> &'static [f32] {
        match self {
            Detail::Occlusion | Detail::Mask | Detail::Thickness => &[1.0],
            Detail::Curvature | Detail::Compression | Detail::Char | Detail::Ash => &[0.0],
            Detail::Temperature => &[293.15],
            Detail::ObjectNormal => &[0.0, 0.0, 1.0],
            Detail::Displacement => &[0.0; 3],
        }
    }

    /// Value of a channel where two reliefs that were each faded before lie over each other.
    fn sum(self, a: f32, b: f32) -> f32 {
        match self {
            // To first order the shares that are hidden add up.
            Detail::Occlusion => a * b,
            Detail::Curvature | Detail::Displacement => a + b,
            Detail::Compression => a.max(b),
            // Made once for all layers together.
            Detail::ObjectNormal
            | Detail::Mask
            | Detail::Char
            | Detail::Ash
            | Detail::Temperature
            | Detail::Thickness => b,
        }
    }
}

/// One further quantity of every texel of a [`WrinkleMap`], in the same order.
#[derive(Debug, Clone, PartialEq)]
pub struct DetailMap {
    /// The quantity.
    pub detail: Detail,
    /// [`Detail::channels`] numbers per texel, side by side.
    pub values: Vec<f32>,
}

impl DetailMap {
    /// A map of neutral texels.
    pub(crate) fn neutral(detail: Detail, texels: usize) -> Self {
        Self {
            detail,
            values: detail.neutral().repeat(texels),
        }
    }

    /// Copies the texel `from` to the texel `to`.
    pub(crate) fn copy(&mut self, from: usize, to: usize) {
        let channels = self.detail.channels();
        self.values
            .copy_within(from * channels..(from + 1) * channels, to * channels);
    }

    fn texel(&mut self, texel: usize) -> &mut [f32] {
        let channels = self.detail.channels();
        &mut self.values[texel * channels..(texel + 1) * channels]
    }
}

impl WrinkleMap {
    /// The values of a detail, if the map has it.
    pub fn detail(&self, detail: Detail) -> Option<&[f32]> {
        let mut details = self.details.iter();
        let found = details.find(|map| map.detail == detail)?;
        Some(&found.values)
    }

    /// Takes the details of `upper` in a texel that it covers.
    pub(crate) fn cover_details(&mut self, upper: &Self, texel: usize) {
        self.combine_details(upper, texel, |_, _, upper| upper);
    }

    /// Adds the details of a relief that lies beside this one.
    pub(crate) fn add_details(&mut self, other: &Self, texel: usize) {
        self.combine_details(other, texel, Detail::sum);
    }

    fn combine_details(
        &mut self,
        other: &Self,
        texel: usize,
        combine: impl Fn(Detail, f32, f32) -> f32,
    ) {
        for map in &mut self.details {
            let detail = map.detail;
            let Some(values) = other.detail(detail) else {
                continue;
            };
            let channels = detail.channels();
            let others = &values[texel * channels..(texel + 1) * channels];
            for (own, other) in map.texel(texel).iter_mut().zip(others) {
                *own = combine(detail, *own, *other);
            }
        }
    }

    /// Adds neutral maps of `details`, as they are where nothing was baked.
    pub fn add_neutral(&mut self, details: &[Detail]) {
        for detail in details {
            self.set_detail(DetailMap::neutral(*detail, self.coverage.len()));
        }
    }

    /// Adds a detail map or replaces the one of its quantity.
    pub(crate) fn set_detail(&mut self, map: DetailMap) {
        self.details.retain(|other| other.detail != map.detail);
        self.details.push(map);
    }

    /// The normal of a texel.
    pub(crate) fn normal(&self, texel: usize) -> Vector3<f64> {
        Vector3::from(self.normals[texel].map(f64::from))
    }
}
