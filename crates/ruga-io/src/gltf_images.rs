//! Images that lie in files of their own, on their way into a GLB.

use std::path::{Path, PathBuf};

use crate::error::read_bytes;
use crate::glb_buffer::GlbBuffer;
use crate::gltf_uri::{external_file, shortened};
use crate::json_text::JsonObject;

/// The images that are neither in the document nor in a file that is there, each with a warning.
pub(crate) fn missing_images(json: &JsonObject, path: &Path) -> Vec<(usize, String)> {
    let files = image_files(json, path).into_iter();
    let missing = files.filter_map(|(image, file)| match file.file {
        Ok(file) if file.is_file() => None,
        Ok(_) => Some((
            image,
            left_outside(image, &file.uri, "there is no such file"),
        )),
        Err(reason) => Some((image, left_outside(image, &file.uri, &reason))),
    });
    missing.collect()
}

/// Copies the files of images into `buffer`, byte for byte, but those of `missing`; returns a
/// warning for each that stays outside.
pub(crate) fn embed_images(
    json: &mut JsonObject,
    path: &Path,
    missing: &[usize],
    buffer: &mut GlbBuffer,
) -> serde_json::Result<Vec<String>> {
    let mut warnings = Vec::new();
    let mut images = json.array("images");
    for (number, ImageFile { uri, file }) in image_files(json, path) {
        let (Ok(file), false) = (file, missing.contains(&number)) else {
            continue;
        };
        let mut image = JsonObject::parse(images[number].get())?;
        let stated: Option<String> = image.read("mimeType");
        let bytes = read_bytes(&file).map_err(|error| error.to_string());
        let embedded = bytes.and_then(|bytes| {
            let mime = stated.or_else(|| mime_type(&bytes, &file).map(str::to_owned));
            mime.map(|mime| (bytes, mime))
                .ok_or_else(|| "its kind of image is unknown".to_owned())
        });
        match embedded {
            Ok((bytes, mime)) => {
                image.remove("uri");
                image.set("mimeType", &mime)?;
                image.set("bufferView", &buffer.image(&bytes))?;
                images[number] = serde_json::value::to_raw_value(&image)?;
            }
            Err(reason) => warnings.push(left_outside(number, &uri, &reason)),
        }
    }
    if !images.is_empty() {
        json.set("images", &images)?;
    }
    Ok(warnings)
}

/// An image outside the document.
struct ImageFile {
    uri: String,
    /// Its file, or why the URI means none.
    file: Result<PathBuf, String>,
}

fn image_files(json: &JsonObject, path: &Path) -> Vec<(usize, ImageFile)> {
    let images = json.array("images").into_iter().enumerate();
    let outside = images.filter_map(|(number, image)| {
        let uri: String = JsonObject::parse(image.get()).ok()?.read("uri")?;
        let file = match uri.starts_with("data:") {
            true => return None,
            false => external_file(path, &uri),
        };
        Some((number, ImageFile { uri, file }))
    });
    outside.collect()
}

fn left_outside(number: usize, uri: &str, reason: &str) -> String {
    let uri = shortened(uri);
    format!(
        "image {number} is not written into the GLB, which names `{uri}` as before: {reason}; put the \
         image beside the GLB"
    )
}

/// MIME type by the first bytes, else by the name.
fn mime_type(bytes: &[u8], file: &Path) -> Option<&'static str> {
    if bytes.starts_with(b"\x89PNG") {
        return Some("image/png");
    }
    if bytes.starts_with(b"\xff\xd8\xff") {
        return Some("image/jpeg");
    }
    if bytes.starts_with(b"\xabKTX 20") {
        return Some("image/ktx2");
    }
    if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        return Some("image/webp");
    }
    let extension = file.extension()?.to_string_lossy().to_lowercase();
    match extension.as_str() {
        "avif" => Some("image/avif"),
        "dds" => Some("image/vnd-ms.dds"),
        "ktx" => Some("image/ktx"),
        _ => None,
    }
}
