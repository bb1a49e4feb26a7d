//! Painted images: masks and property maps, PNG or EXR, values as stored.

use std::error::Error;
use std::io::{Cursor, ErrorKind};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::prelude::{FlatSamples, MetaData, ReadChannels, ReadLayers, read};
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageResult, Limits};

use crate::IoError;
use crate::error::read_bytes;

/// Texels along a side that are taken for an image rather than a damaged header.
const LONGEST_SIDE: usize = 16_384;

/// Bytes that a PNG may ask for beside its texels: a few rows, colour profiles and texts.
const PNG_MEMORY: usize = 1 << 28;

/// An image of one or three channels, first row on top, values as stored: PNG from 0 to 1 without
/// any colour-space conversion, EXR as it is. Alpha is dropped.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Texels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// 1 (grey) or 3 (red, green, blue).
    pub channels: usize,
    /// `width * height * channels` values, the channels of a texel side by side.
    pub values: Vec<f32>,
}

/// A grey image, values from 0 to 1, first row on top.
#[derive(Clone, Debug, PartialEq)]
pub struct GreyImage {
    /// Whether a part of the file was transparent and so has become darker.
    pub had_transparency: bool,
    /// Texels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` values.
    pub values: Vec<f32>,
}

/// Reads a mask: grey, grey with alpha, colour or palette PNG of any bit depth, or EXR.
///
/// Colours become the mean of red, green and blue. What is transparent counts as black, what is half
/// transparent as half as bright: a mask is what the picture looks like on a black ground, so that
/// white paint on an empty layer does what it shows. The colours of an EXR are multiplied with its
/// alpha already. Values outside 0 to 1 (EXR) are clamped.
///
/// # Errors
/// [`IoError`] naming the file when it is missing, of another format, damaged or cut short.
pub fn read_mask(path: &Path) -> Result<GreyImage, IoError> {
    let (image, alpha) = read_with_alpha(path)?;
    let mean = |texel: &[f32]| texel.iter().sum::<f32>() / texel.len() as f32;
    let grey = image.values.chunks_exact(image.channels).map(mean);
    let mut values: Vec<f32> = grey.map(|value| value.clamp(0.0, 1.0)).collect();
    for (value, alpha) in values.iter_mut().zip(alpha.iter().flatten()) {
        *value *= alpha;
    }
    Ok(GreyImage {
        had_transparency: alpha.iter().flatten().any(|alpha| *alpha < 1.0),
        width: image.width,
        height: image.height,
        values,
    })
}

/// Reads an image of painted properties, PNG or EXR; the content decides, not the name.
///
/// # Errors
/// [`IoError`] naming the file when it is missing, of another format, damaged or cut short.
pub fn read_image(path: &Path) -> Result<Image, IoError> {
    Ok(read_with_alpha(path)?.0)
}

/// The image, and the alpha of each texel where a PNG has one.
fn read_with_alpha(path: &Path) -> Result<(Image, Option<Vec<f32>>), IoError> {
    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
    const EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];
    let bytes = read_bytes(path)?;
    if bytes.starts_with(PNG) {
        return read_png(&bytes).map_err(|reason| IoError::malformed(path, "PNG", reason));
    }
    if bytes.starts_with(EXR) {
        // Where the crate is built with overflow checks, its B44 decoder panics on damaged blocks.
        let read = catch_unwind(AssertUnwindSafe(|| read_exr(&bytes)));
        return read
            .unwrap_or_else(|_| Err("its texels are damaged".to_owned()))
            .map(|image| (image, None))
            .map_err(|reason| IoError::malformed(path, "EXR", reason));
    }
    let found = if bytes.starts_with(&[0xff, 0xd8, 0xff]) {
        "this is a JPEG, which is too coarse for masks and properties"
    } else {
        "its first bytes are those of no image that ruga reads"
    };
    Err(IoError::UnknownFormat {
        path: path.to_owned(),
        found: found.to_owned(),
        accepted: "PNG (8 or 16 bits), EXR",
    })
}

fn read_png(bytes: &[u8]) -> Result<(Image, Option<Vec<f32>>), String> {
    check_png(bytes)?;
    let image = decode_png(bytes).map_err(|error| match error.source() {
        Some(damage) => damage.to_string(),
        None => error.to_string(),
    })?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    // Palettes have become colours, with alpha where one of them has it.
    let (has_color, has_alpha) = (image.color().has_color(), image.color().has_alpha());
    let (channels, texels) = match has_color {
        true => (3, image.into_rgba32f().into_raw()),
        false => (1, image.to_luma_alpha32f().into_raw()),
    };
    let texels = || texels.chunks_exact(channels + 1);
    let alpha = has_alpha.then(|| texels().map(|texel| texel[channels]).collect());
    let image = Image {
        width,
        height,
        channels,
        values: texels()
            .flat_map(|texel| texel[..channels].iter().copied())
            .collect(),
    };
    Ok((image, alpha))
}

fn decode_png(bytes: &[u8]) -> ImageResult<DynamicImage> {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(PNG_MEMORY as u64);
    DynamicImage::from_decoder(PngDecoder::with_limits(Cursor::new(bytes), limits)?)
}

/// Refuses damage that `image` overlooks, by the codec below it: a header that asks for more memory
/// than its file can fill, a palette that its decoder would panic on, and anything wrong after the
/// last texel, such as a missing end. Texels are not decoded here.
fn check_png(bytes: &[u8]) -> Result<(), String> {
    let limits = png::Limits { bytes: PNG_MEMORY };
    let decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let mut reader = decoder.read_info().map_err(plain_words)?;
    let info = reader.info();
    let (width, height) = (info.width as usize, info.height as usize);
    check_size(width, height, info.raw_row_length() * height, bytes.len())?;
    // The decoder takes for granted that a palette is made of whole colours.
    if let Some(length) = info.palette.as_ref().map(|palette| palette.len())
        && length % 3 != 0
    {
        return Err(format!(
            "its palette has {length} bytes; accepted: a multiple of 3"
        ));
    }
    reader.finish().map_err(plain_words)
}

fn plain_words(error: png::DecodingError) -> String {
    match error {
        png::DecodingError::IoError(io) if io.kind() == ErrorKind::UnexpectedEof => {
            "the file is cut short".to_owned()
        }
        other => other.to_string(),
    }
}

/// Refuses a header that asks for more memory than its file can fill.
fn check_size(
    width: usize,
    height: usize,
    texel_bytes: usize,
    file_bytes: usize,
) -> Result<(), String> {
    // Deflate makes at most 258 bytes from two bits, a factor of 1032, and nothing else makes more.
    const MOST_COMPRESSED: usize = 2000;
    if width.max(height) > LONGEST_SIDE {
        return Err(format!(
            "is {width} x {height}; accepted: up to {LONGEST_SIDE} texels a side"
        ));
    }
    if texel_bytes / MOST_COMPRESSED > file_bytes {
        return Err(format!(
            "says that it is {width} x {height}, but its {file_bytes} bytes cannot hold that many texels"
        ));
    }
    Ok(())
}

/// Reads an EXR by the codec below `image`, which itself takes an EXR for colours alone: it refuses
/// one grey channel and channels of a named layer (`paint.R`), cuts texels outside the display
/// window, and takes as much memory as that window says.
fn read_exr(bytes: &[u8]) -> Result<Image, String> {
    check_exr_size(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    let layer = image.layer_data;
    let (width, height) = (layer.size.x(), layer.size.y());
    let list = &layer.channel_data.list;
    let named = |name: &str| {
        list.iter().find(|channel| {
            let full = channel.name.to_string();
            full.rsplit('.').next() == Some(name)
        })
    };
    let planes = match (list.as_slice(), [named("R"), named("G"), named("B")]) {
        ([alone], _) => vec![&alone.sample_data],
        (_, [Some(r), Some(g), Some(b)]) => vec![&r.sample_data, &g.sample_data, &b.sample_data],
        _ => match named("Y") {
            Some(grey) => vec![&grey.sample_data],
            None => return Err("has neither one channel, nor Y, nor R, G and B".to_owned()),
        },
    };
    let planes: Vec<Vec<f32>> = planes.into_iter().map(plane_values).collect();
    if width == 0 || height == 0 {
        return Err(format!(
            "is {width} x {height}; accepted: at least one texel"
        ));
    }
    if planes.iter().any(|plane| plane.len() != width * height) {
        return Err("its channels have different resolutions".to_owned());
    }
    for (channel, plane) in planes.iter().enumerate() {
        if let Some(texel) = plane.iter().position(|value| !value.is_finite()) {
            let (column, row) = (texel % width, texel / width);
            return Err(format!(
                "channel {channel} is {} at column {column}, row {row}; accepted: finite numbers",
                plane[texel]
            ));
        }
    }
    Ok(Image {
        width,
        height,
        channels: planes.len(),
        values: (0..width * height)
            .flat_map(|texel| planes.iter().map(move |plane| plane[texel]))
            .collect(),
    })
}

fn check_exr_size(bytes: &[u8]) -> Result<(), String> {
    const MOST_CHANNELS: usize = 64;
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| error.to_string())?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.x(), header.layer_size.y());
        let channels = &header.channels.list;
        if channels.len() > MOST_CHANNELS {
            let found = channels.len();
            return Err(format!(
                "has {found} channels; accepted: up to {MOST_CHANNELS}"
            ));
        }
        let texel = channels.iter().map(|c| c.sample_type.bytes_per_sample());
        let sides = width.min(LONGEST_SIDE) * height.min(LONGEST_SIDE);
        check_size(width, height, sides * texel.sum::<usize>(), bytes.len())?;
    }
    Ok(())
}

fn plane_values(samples: &FlatSamples) -> Vec<f32> {
    samples.values_as_f32().collect()
}
