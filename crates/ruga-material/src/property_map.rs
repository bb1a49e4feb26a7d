//! Painted fields of relative wavelength, Young's modulus and thickness.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::{MaterialError, RelativeProperties, UvTile};

/// What lies beyond the border of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Wrap {
    /// The border's own texels. The default, unlike that of glTF: maps are painted inside the unit
    /// square, and repeating would mix both borders along each.
    ///
    /// Inside the square the two differ only within half a texel of the border, but a patch whose UVs
    /// fill the square would get a false value all along it.
    #[default]
    #[cfg_attr(feature = "serde", serde(rename = "clamp"))]
    ClampToEdge,
    /// The image again.
    ///
    /// For UVs that leave `[0, 1]` on purpose.
    Repeat,
}

impl Wrap {
    /// The texel in `0..count` that stands for the texel number `index`, which may be outside.
    fn texel(self, index: i64, count: usize) -> usize {
        // Sides are bounded by memory, far below the range of `i64`.
        let count = count as i64;
        let inside = match self {
            Wrap::ClampToEdge => index.clamp(0, count - 1),
            Wrap::Repeat => index.rem_euclid(count),
        };
        inside as usize
    }
}

/// One painted property: a grey image and what its black and white mean.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyImage {
    /// Texels per row, at least 1.
    pub width: usize,
    /// Rows, at least 1; the first is on top, at `v = 0`.
    pub height: usize,
    /// `width * height` values `c` from 0 to 1, linear. A thousandth beyond, as filters in paint
    /// programs leave it, is cut off.
    pub values: Vec<f32>,
    /// `[lo, hi]`, both above 0, in either order: the relative property is `lo + (hi - lo) c`.
    pub range: [f64; 2],
}

/// Images of one painted property.
#[derive(Clone, Debug, PartialEq)]
pub enum PropertyPaint {
    /// One image over the unit square; beyond it lies what [`Wrap`] says.
    Whole(PropertyImage),
    /// Images of UDIM tiles. Beyond the border of a tile lie its own texels, and in a tile without image
    /// nothing is painted.
    Tiles(BTreeMap<UvTile, PropertyImage>),
}

impl PropertyPaint {
    /// Checks the images of `property` and cuts off the slack.
    fn checked(self, property: &'static str) -> Result<Self, MaterialError> {
        Ok(match self {
            Self::Whole(image) => Self::Whole(image.checked(property)?),
            Self::Tiles(tiles) => {
                let tiles = tiles.into_iter();
                let checked = tiles.map(|(tile, image)| Ok((tile, image.checked(property)?)));
                Self::Tiles(checked.collect::<Result<_, MaterialError>>()?)
            }
        })
    }

    /// The image at a place, with the place of the image's upper left corner and its way to go on beyond
    /// its border; `None` where nothing is painted.
    pub(crate) fn at(&self, uv: &Vector2<f64>, wrap: Wrap) -> Option<PlacedImage<'_>> {
        match self {
            Self::Whole(image) => Some(PlacedImage {
                image,
                origin: Vector2::zeros(),
                wrap,
            }),
            Self::Tiles(tiles) => {
                let tile = UvTile::at(uv)?;
                Some(PlacedImage {
                    image: tiles.get(&tile)?,
                    origin: Vector2::from(tile.origin().map(f64::from)),
                    wrap: Wrap::ClampToEdge,
                })
            }
        }
    }
}

/// An image at its place in texture space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedImage<'a> {
    pub(crate) image: &'a PropertyImage,
    /// UV of its upper left corner.
    pub(crate) origin: Vector2<f64>,
    pub(crate) wrap: Wrap,
}

impl PlacedImage<'_> {
    /// The relative property at a UV, bilinear between texel centres.
    pub(crate) fn sample(&self, uv: &Vector2<f64>) -> f64 {
        self.image.sample(&(uv - self.origin), self.wrap)
    }
}

/// Distance outside `[0, 1]` at which a texel is cut off in silence: several times the rounding of
/// half floats. Beyond it the painter meant something that a range from 0 to 1 cannot say.
const TEXEL_SLACK: f32 = 1e-3;

impl PropertyImage {
    /// Checks the image of `property` and cuts off the slack.
    fn checked(mut self, property: &'static str) -> Result<Self, MaterialError> {
        let Self { width, height, .. } = self;
        // Saturated, so that absurd sides fail the comparison below and not the product.
        let expected = width.saturating_mul(height);
        if expected == 0 {
            return Err(MaterialError::EmptyImage {
                property,
                width,
                height,
            });
        }
        let found = self.values.len();
        if found != expected {
            return Err(MaterialError::ImageLength {
                property,
                found,
                expected,
            });
        }
        let [low, high] = self.range;
        // Asked this way round, so that a NaN is refused, too.
        if ![low, high].iter().all(|end| *end > 0.0 && end.is_finite()) {
            return Err(MaterialError::RangeNotPositive {
                property,
                low,
                high,
            });
        }
        let accepted = -TEXEL_SLACK..=1.0 + TEXEL_SLACK;
        // A NaN is in no range.
        if let Some(index) = self.values.iter().position(|c| !accepted.contains(c)) {
            return Err(MaterialError::TexelOutOfRange {
                property,
                column: index % width,
                row: index / width,
                value: self.values[index],
            });
        }
        for value in &mut self.values {
            *value = value.clamp(0.0, 1.0);
        }
        Ok(self)
    }

    pub(crate) fn cell(&self, uv: &Vector2<f64>) -> Cell {
        // The centre of the first texel is half a texel inside the border.
        let [x, y] = [
            uv.x * self.width as f64 - 0.5,
            uv.y * self.height as f64 - 0.5,
        ];
        Cell {
            column: x.floor() as i64,
            row: y.floor() as i64,
            across: x - x.floor(),
            down: y - y.floor(),
        }
    }

    pub(crate) fn relative(&self, c: f64) -> f64 {
        let [low, high] = self.range;
        low + (high - low) * c
    }

    /// The painted number `c` of a texel that may lie beyond the border.
    pub(crate) fn texel(&self, column: i64, row: i64, wrap: Wrap) -> f64 {
        let (column, row) = (wrap.texel(column, self.width), wrap.texel(row, self.height));
        f64::from(self.values[row * self.width + column])
    }

    /// Bilinear between texel centres.
    pub(crate) fn sample(&self, uv: &Vector2<f64>, wrap: Wrap) -> f64 {
        let cell = self.cell(uv);
        // A huge UV has saturated its cell, and the neighbour must not wrap around.
        let texel = |right: i64, below: i64| {
            self.texel(
                cell.column.saturating_add(right),
                cell.row.saturating_add(below),
                wrap,
            )
        };
        // In this form texels of one value give that value exactly: a flat image has no rounding.
        let mix = |a: f64, b: f64, share: f64| a + (b - a) * share;
        let top = mix(texel(0, 0), texel(1, 0), cell.across);
        let bottom = mix(texel(0, 1), texel(1, 1), cell.across);
        self.relative(mix(top, bottom, cell.down))
    }
}

/// Place of a UV among texel centres: right of and below the centre of texel `(column, row)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) column: i64,
    pub(crate) row: i64,
    /// Fraction of the distance to the next column, in `[0, 1)`.
    pub(crate) across: f64,
    /// Fraction of the distance to the next row, in `[0, 1)`.
    pub(crate) down: f64,
}

/// Meaning of black and white in each channel of a packed image; `None` leaves the property alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PropertyRanges {
    /// Relative wavelengths that black and white mean in the red channel.
    pub wavelength: Option<[f64; 2]>,
    /// Relative Young's moduli that black and white mean in the green channel.
    pub young: Option<[f64; 2]>,
    /// Relative thicknesses that black and white mean in the blue channel.
    pub thickness: Option<[f64; 2]>,
}

/// Painted properties of a layer over UV (Li 2014, 5.2).
///
/// UVs have V pointing down: `(0, 0)` is the outer corner of the first texel, whose centre is half a
/// texel inside. Between centres the value is bilinear. Each property has its own image, so sizes
/// may differ; a property without image is 1 everywhere. No filter: a mesh coarser than the paint
/// sees single places of it.
///
/// A UV seam needs no care beyond sampling each corner of a face with its own UV; a vertex on the
/// seam takes the mean over its corners, [`PropertyMap::sample_corners`].
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyMap {
    pub(crate) wavelength: Option<PropertyPaint>,
    pub(crate) young: Option<PropertyPaint>,
    pub(crate) thickness: Option<PropertyPaint>,
    pub(crate) wrap: Wrap,
}

impl PropertyMap {
    /// A map from one grey image over the unit square per painted property.
    ///
    /// # Errors
    /// Those of [`PropertyMap::painted`].
    pub fn new(
        wavelength: Option<PropertyImage>,
        young: Option<PropertyImage>,
        thickness: Option<PropertyImage>,
        wrap: Wrap,
    ) -> Result<Self, MaterialError> {
        let [wavelength, young, thickness] =
            [wavelength, young, thickness].map(|image| image.map(PropertyPaint::Whole));
        Self::painted(wavelength, young, thickness, wrap)
    }

    /// A map from the grey images of each painted property, over the unit square or over UDIM tiles.
    ///
    /// # Errors
    /// [`MaterialError::EmptyImage`], [`MaterialError::ImageLength`],
    /// [`MaterialError::RangeNotPositive`] or [`MaterialError::TexelOutOfRange`], for the first
    /// property in this order, and the first tile of it.
    pub fn painted(
        wavelength: Option<PropertyPaint>,
        young: Option<PropertyPaint>,
        thickness: Option<PropertyPaint>,
        wrap: Wrap,
    ) -> Result<Self, MaterialError> {
        let checked = |paint: Option<PropertyPaint>, property| {
            paint.map(|paint| paint.checked(property)).transpose()
        };
        Ok(Self {
            wavelength: checked(wavelength, "wavelength")?,
            young: checked(young, "young")?,
            thickness: checked(thickness, "thickness")?,
            wrap,
        })
    }

    /// A map from one image, red the wavelength, green Young's modulus, blue the thickness: the three
    /// numbers of a texel side by side, `3 * width * height` in all. A channel without range is not
    /// looked at.
    ///
    /// # Errors
    /// Those of [`PropertyMap::new`]; a wrong length counts texels of three numbers.
    pub fn packed(
        width: usize,
        height: usize,
        values: &[f32],
        ranges: PropertyRanges,
        wrap: Wrap,
    ) -> Result<Self, MaterialError> {
        let expected = width.saturating_mul(height).saturating_mul(3);
        if values.len() != expected {
            return Err(MaterialError::ImageLength {
                property: "red, green and blue",
                found: values.len(),
                expected,
            });
        }
        let channel = |which: usize, range: Option<[f64; 2]>| {
            range.map(|range| PropertyImage {
                width,
                height,
                values: values.iter().skip(which).step_by(3).copied().collect(),
                range,
            })
        };
        Self::new(
            channel(0, ranges.wavelength),
            channel(1, ranges.young),
            channel(2, ranges.thickness),
            wrap,
        )
    }

    /// The properties at a UV; all are 1 where a coordinate is not finite, since nothing is painted there.
    pub fn sample(&self, uv: &Vector2<f64>) -> RelativeProperties {
        if !uv.iter().all(|c| c.is_finite()) {
            return RelativeProperties::default();
        }
        let at = |paint: &Option<PropertyPaint>| {
            let placed = paint.as_ref().and_then(|paint| paint.at(uv, self.wrap));
            placed.map_or(1.0, |placed| placed.sample(uv))
        };
        RelativeProperties {
            wavelength: at(&self.wavelength),
            young: at(&self.young),
            thickness: at(&self.thickness),
        }
    }

    /// The properties of a vertex: the mean over the UVs of its corners, each with its weight.
    ///
    /// Weights are the corners' angles, so that the mean does not depend on how a seam's sides
    /// happen to be triangulated, or all 1; only their ratios count. Off the seams all corners have
    /// one UV and this is [`PropertyMap::sample`]. Without corners, or with weights that do not add up
    /// to more than 0, nothing is painted: all properties are 1.
    pub fn sample_corners(
        &self,
        corners: impl IntoIterator<Item = (Vector2<f64>, f64)>,
    ) -> RelativeProperties {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for (uv, weight) in corners {
            let here = self.sample(&uv);
            let values = [here.wavelength, here.young, here.thickness];
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += weight * value;
            }
            total += weight;
        }
        if total > 0.0 {
            let [wavelength, young, thickness] = sum.map(|sum| sum / total);
            RelativeProperties {
                wavelength,
                young,
                thickness,
            }
        } else {
            RelativeProperties::default()
        }
    }

    /// The properties of a face, at the centroid of its corners' UVs, which all lie in one chart.
    ///
    /// Not the mean of the corners: next to a sharp boundary two corners lie on it, halfway between
    /// the sides, and would take two thirds of the jump away.
    pub fn sample_face(&self, corners: &[Vector2<f64>; 3]) -> RelativeProperties {
        let [a, b, c] = corners;
        self.sample(&((a + b + c) / 3.0))
    }

    /// The images of all properties at a UV.
    pub(crate) fn images_at(&self, uv: &Vector2<f64>) -> impl Iterator<Item = PlacedImage<'_>> {
        let paints = [&self.wavelength, &self.young, &self.thickness].into_iter();
        paints.flatten().filter_map(|paint| paint.at(uv, self.wrap))
    }
}
