//! The painted images of a layer, as plain planes of numbers.

use std::path::{Path, PathBuf};

use ruga_io::{Image, IoError, read_image};
use ruga_material::PropertyImage;

use crate::SceneError;
use crate::file::PropertyMap;

/// Distance outside `[0, 1]` at which a number of an EXR is cut off in silence: several times the
/// rounding of half floats, and what filters of paint programs leave behind.
const SLACK: f32 = 1e-3;

/// Images painted over a layer; a property that is `None` keeps the layer's own value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PropertyImages {
    /// Relative wavelength; the red channel of a packed image.
    pub wavelength: Option<PropertyImage>,
    /// Relative Young's modulus; the green channel.
    pub young: Option<PropertyImage>,
    /// Relative thickness; the blue channel.
    pub thickness: Option<PropertyImage>,
}

impl PropertyImages {
    /// The images of wavelength, Young's modulus and thickness.
    pub(crate) fn by_property(self) -> [Option<PropertyImage>; 3] {
        [self.wavelength, self.young, self.thickness]
    }
}

/// Reads the images of a layer's map over the UV square. `key` is that of the map, such as `layers[0].map`; it and
/// `scene_path` are for messages, image paths are taken as they stand in `map` ([`crate::SceneFile::read`]
/// resolves them).
///
/// A grey image may be stored in three equal channels, as many paint programs do. A packed image
/// must have three; alpha counts for nothing in either.
///
/// # Errors
/// [`SceneError::NamedFile`] naming scene, key and image: when it is missing, damaged or of another
/// format, has the wrong channels, no texels, or numbers outside 0 to 1 (EXR).
pub fn read_property_images(
    map: &PropertyMap,
    scene_path: &Path,
    key: &str,
) -> Result<PropertyImages, SceneError> {
    let named = |name: &str| {
        let key = format!("{key}.{name}");
        move |error: IoError| SceneError::NamedFile {
            scene: scene_path.to_owned(),
            key,
            source: Box::new(error),
        }
    };
    if let Some(path) = &map.image {
        return packed(path, map).map_err(named("image"));
    }
    let own = |name: &str, path: &Option<PathBuf>, range: Option<[f64; 2]>| match (path, range) {
        (Some(path), Some(range)) => grey(path, range).map(Some).map_err(named(name)),
        _ => Ok(None),
    };
    Ok(PropertyImages {
        wavelength: own("wavelength_image", &map.wavelength_image, map.wavelength)?,
        young: own("young_image", &map.young_image, map.young)?,
        thickness: own("thickness_image", &map.thickness_image, map.thickness)?,
    })
}

fn packed(path: &Path, map: &PropertyMap) -> Result<PropertyImages, IoError> {
    let image = read_image(path)?;
    if image.channels != 3 {
        let accepted = "red (wavelength), green (Young's modulus) and blue (thickness); a grey \
                        image belongs to `wavelength_image`, `young_image` or `thickness_image`";
        let reason = format!("found {}; accepted: {accepted}", channel_count(&image));
        return Err(IoError::malformed(path, "channels", reason));
    }
    let channel = |which: usize, range: Option<[f64; 2]>| {
        range
            .map(|range| plane(&image, which, range, path))
            .transpose()
    };
    Ok(PropertyImages {
        wavelength: channel(0, map.wavelength)?,
        young: channel(1, map.young)?,
        thickness: channel(2, map.thickness)?,
    })
}

fn grey(path: &Path, range: [f64; 2]) -> Result<PropertyImage, IoError> {
    let image = read_image(path)?;
    let coloured = image
        .values
        .chunks_exact(image.channels)
        .position(|texel| texel.iter().any(|value| *value != texel[0]));
    if let Some(texel) = coloured {
        let reason = format!(
            "found {} that differ {}; accepted: one grey channel, or three equal ones",
            channel_count(&image),
            place(texel, image.width),
        );
        return Err(IoError::malformed(path, "channels", reason));
    }
    plane(&image, 0, range, path)
}

/// One channel of an image, its numbers checked and cut to `[0, 1]`.
fn plane(
    image: &Image,
    channel: usize,
    range: [f64; 2],
    path: &Path,
) -> Result<PropertyImage, IoError> {
    let numbers = || image.values.iter().skip(channel).step_by(image.channels);
    let accepted = -SLACK..=1.0 + SLACK;
    if let Some((texel, value)) = numbers().enumerate().find(|(_, c)| !accepted.contains(*c)) {
        let element = format!("channel {channel}");
        let reason = format!(
            "found {value} {}; accepted: numbers from 0 to 1, which the range is laid over",
            place(texel, image.width)
        );
        return Err(IoError::malformed(path, element, reason));
    }
    Ok(PropertyImage {
        width: image.width,
        height: image.height,
        values: numbers().map(|value| value.clamp(0.0, 1.0)).collect(),
        range,
    })
}

fn channel_count(image: &Image) -> String {
    match image.channels {
        1 => "1 channel".to_owned(),
        count => format!("{count} channels"),
    }
}

fn place(texel: usize, width: usize) -> String {
    format!("at column {}, row {}", texel % width, texel / width)
}
