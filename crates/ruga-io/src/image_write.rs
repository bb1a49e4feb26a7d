//! Baked images: PNG without any colour-space mark, and EXR.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{SpecificChannels, Vec2, WritableImage};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{
    EncodableLayout, ImageBuffer, ImageEncoder, ImageResult, Luma, PixelWithColorType, Rgb, Rgba,
};

use crate::{IoError, write_atomically};

/// Texels of a PNG, first row on top, channels side by side.
#[derive(Clone, Copy, Debug)]
pub enum PngTexels<'a> {
    /// One channel of 8 bits.
    Grey8(&'a [u8]),
    /// Red, green and blue of 8 bits.
    Rgb8(&'a [u8]),
    /// Red, green, blue and alpha of 8 bits.
    Rgba8(&'a [u8]),
    /// One channel of 16 bits.
    Grey16(&'a [u16]),
    /// Red, green and blue of 16 bits.
    Rgb16(&'a [u16]),
}

/// Texels of an EXR, first row on top, channels side by side.
#[derive(Clone, Copy, Debug)]
pub enum ExrTexels<'a> {
    /// One channel, `Y`.
    Grey(&'a [f32]),
    /// Three channels, `R`, `G` and `B`.
    Rgb(&'a [f32]),
}

/// Writes a PNG with no `gAMA`, `sRGB`, `cHRM` or `iCCP` chunk: the numbers are linear data.
///
/// # Errors
/// [`IoError::Unwritten`] when the number of texels is not `width * height`,
/// [`IoError::Unwritable`] when the file cannot be written.
pub fn write_png(
    path: &Path,
    width: usize,
    height: usize,
    texels: PngTexels<'_>,
) -> Result<(), IoError> {
    let (channels, found) = match texels {
        PngTexels::Grey8(values) => (1, values.len()),
        PngTexels::Rgba8(values) => (4, values.len()),
        PngTexels::Grey16(values) => (1, values.len()),
        PngTexels::Rgb8(values) => (3, values.len()),
        PngTexels::Rgb16(values) => (3, values.len()),
    };
    let size = checked_size(path, width, height, channels, found)?;
    let mut file = Vec::new();
    // On a 2048 normal map: a fifth of the time of `CompressionType::Default`, files a fifth larger.
    let encoder =
        PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive);
    match texels {
        PngTexels::Grey8(values) => encode::<Luma<u8>>(size, values, encoder),
        PngTexels::Rgba8(values) => encode::<Rgba<u8>>(size, values, encoder),
        PngTexels::Grey16(values) => encode::<Luma<u16>>(size, values, encoder),
        PngTexels::Rgb8(values) => encode::<Rgb<u8>>(size, values, encoder),
        PngTexels::Rgb16(values) => encode::<Rgb<u16>>(size, values, encoder),
    }
    .map_err(|error| IoError::unwritten(path, error.to_string()))?;
    write_atomically(path, &file)
}

/// Writes an EXR of 32-bit floats, losslessly compressed.
///
/// # Errors
/// [`IoError::Unwritten`] when the number of texels is not `width * height` or a value is not
/// finite, [`IoError::Unwritable`] when the file cannot be written.
pub fn write_exr(
    path: &Path,
    width: usize,
    height: usize,
    texels: ExrTexels<'_>,
) -> Result<(), IoError> {
    let (channels, values) = match texels {
        ExrTexels::Grey(values) => (1, values),
        ExrTexels::Rgb(values) => (3, values),
    };
    let size = checked_size(path, width, height, channels, values.len())?;
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let reason = format!("value {at} is {}", values[at]);
        return Err(IoError::unwritten(path, reason));
    }
    let mut file = Cursor::new(Vec::new());
    match texels {
        ExrTexels::Rgb(values) => encode::<Rgb<f32>>(size, values, OpenExrEncoder::new(&mut file))
            .map_err(|error| error.to_string()),
        // `image` writes no EXR of one channel; this is what it does for three.
        ExrTexels::Grey(values) => {
            let grey = |at: Vec2<usize>| (values[at.y() * width + at.x()],);
            let channels = SpecificChannels::build()
                .with_channel("Y")
                .with_pixel_fn(grey);
            exr::prelude::Image::from_channels((width, height), channels)
                .write()
                .non_parallel()
                .to_buffered(&mut file)
                .map_err(|error| error.to_string())
        }
    }
    .map_err(|reason| IoError::unwritten(path, reason))?;
    write_atomically(path, &file.into_inner())
}

/// Encodes texels that [`checked_size`] has counted.
fn encode<P>(
    [width, height]: [u32; 2],
    values: &[P::Subpixel],
    encoder: impl ImageEncoder,
) -> ImageResult<()>
where
    P: PixelWithColorType,
    [P::Subpixel]: EncodableLayout,
{
    ImageBuffer::<P, _>::from_raw(width, height, values)
        .expect("there is a value for each channel of each texel")
        .write_with_encoder(encoder)
}

/// The size in 32 bits, if there are texels and `found` is the number of their values.
fn checked_size(
    path: &Path,
    width: usize,
    height: usize,
    channels: usize,
    found: usize,
) -> Result<[u32; 2], IoError> {
    let expected = width
        .checked_mul(height)
        .and_then(|n| n.checked_mul(channels));
    if let (Ok(columns), Ok(rows)) = (u32::try_from(width), u32::try_from(height))
        && found > 0
        && expected == Some(found)
    {
        return Ok([columns, rows]);
    }
    let reason = format!("{found} values for {width} x {height} texels of {channels} channels");
    Err(IoError::unwritten(path, reason))
}
