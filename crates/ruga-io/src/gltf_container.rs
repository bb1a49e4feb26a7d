//! glTF containers: the JSON and the bytes of every buffer, from `.glb` or `.gltf`.

use std::path::{Path, PathBuf};

use gltf::binary::Glb;
use gltf::json::Root;

use crate::IoError;
use crate::error::read_bytes;

/// A parsed file whose buffers are all loaded. Nothing in `root` has been validated.
pub(crate) struct Container {
    pub(crate) path: PathBuf,
    pub(crate) root: Root,
    pub(crate) buffers: Vec<Vec<u8>>,
}

impl Container {
    pub(crate) fn read(path: &Path) -> Result<Self, IoError> {
        let bytes = read_bytes(path)?;
        let (json, binary) = split_container(path, &bytes)?;
        let root: Root = serde_json::from_slice(&json)
            .map_err(|error| IoError::malformed(path, "JSON", error.to_string()))?;
        reject_compressed_geometry(path, &root)?;
        let mut binary = binary;
        let buffers = (0..root.buffers.len())
            .map(|i| load_buffer(path, &root, i, &mut binary))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            path: path.to_owned(),
            root,
            buffers,
        })
    }

    pub(crate) fn malformed(
        &self,
        element: impl Into<String>,
        reason: impl Into<String>,
    ) -> IoError {
        IoError::malformed(&self.path, element, reason)
    }
}

/// The JSON text and, for the binary container, its buffer. The content decides, not the name.
fn split_container(path: &Path, bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>), IoError> {
    if bytes.starts_with(b"glTF") {
        return split_glb(path, bytes);
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.trim_ascii_start().starts_with(b"{") {
        return Ok((text.to_owned(), None));
    }
    Err(IoError::UnknownFormat {
        path: path.to_owned(),
        found: "begins neither with `glTF` nor with `{`".to_owned(),
        accepted: "glTF 2.0, binary or JSON",
    })
}

fn split_glb(path: &Path, bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>), IoError> {
    let header = |reason: String| IoError::malformed(path, "GLB header", reason);
    // The gltf crate subtracts the header from this length unchecked.
    let length = bytes
        .get(8..12)
        .and_then(|b| b.try_into().ok())
        .map(u32::from_le_bytes)
        .ok_or_else(|| header(format!("only {} bytes", bytes.len())))?;
    let whole = usize::try_from(length)
        .ok()
        .filter(|length| *length >= 20)
        .and_then(|length| bytes.get(..length))
        .ok_or_else(|| header(format!("says {length} bytes, the file has {}", bytes.len())))?;
    let glb = Glb::from_slice(whole).map_err(|error| header(error.to_string()))?;
    Ok((
        glb.json.into_owned(),
        glb.bin.map(std::borrow::Cow::into_owned),
    ))
}

/// Compressed geometry reads as zeros where the extension is unknown: better to refuse.
fn reject_compressed_geometry(path: &Path, root: &Root) -> Result<(), IoError> {
    let compressed = [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
    ];
    let found = root
        .extensions_required
        .iter()
        .find(|name| compressed.contains(&name.as_str()));
    match found {
        Some(name) => Err(IoError::malformed(
            path,
            "extensionsRequired",
            format!("`{name}` is not supported; export without mesh compression"),
        )),
        None => Ok(()),
    }
}

fn load_buffer(
    path: &Path,
    root: &Root,
    index: usize,
    binary: &mut Option<Vec<u8>>,
) -> Result<Vec<u8>, IoError> {
    let element = format!("buffer {index}");
    let fault = |reason: String| IoError::malformed(path, element.clone(), reason);
    let buffer = &root.buffers[index];
    let bytes = match buffer.uri.as_deref() {
        Some(uri) if uri.starts_with("data:") => decode_data_uri(uri).map_err(fault)?,
        Some(uri) => external_file(path, uri)
            .and_then(|file| read_bytes(&file).map_err(|error| shortened(&error.to_string())))
            .map_err(fault)?,
        None if index == 0 => binary
            .take()
            .ok_or_else(|| fault("has no uri, and the file has no binary chunk".to_owned()))?,
        None => return Err(fault("has no uri".to_owned())),
    };
    if (bytes.len() as u64) < buffer.byte_length.0 {
        let (stated, found) = (buffer.byte_length.0, bytes.len());
        return Err(fault(format!("byteLength is {stated}, found {found}")));
    }
    Ok(bytes)
}

fn external_file(path: &Path, uri: &str) -> Result<PathBuf, String> {
    let has_scheme = uri
        .split_once(':')
        .is_some_and(|(scheme, _)| scheme.len() > 1 && !scheme.contains('/'));
    if has_scheme {
        let uri = shortened(uri);
        return Err(format!("uri `{uri}` is not a relative path or data: URI"));
    }
    let relative =
        decode_percent(uri).ok_or_else(|| format!("uri `{}` is not valid", shortened(uri)))?;
    Ok(path.parent().unwrap_or(Path::new("")).join(relative))
}

/// The text, or its ends: a data: URI with a slip in its first letters is megabytes long.
fn shortened(text: &str) -> String {
    const MOST: usize = 200;
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    let start: String = text.chars().take(MOST / 2).collect();
    let end: String = text.chars().rev().take(MOST / 2).collect();
    let end: String = end.chars().rev().collect();
    format!("{start} ... {end}")
}

/// Replaces `%20` and the like; `None` when the result is not UTF-8.
fn decode_percent(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail
            .get(..2)
            .filter(|_| first == b'%')
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match hex {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

fn decode_data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let (_, data) = uri
        .split_once(";base64,")
        .ok_or("its data: URI is not base64")?;
    decode_base64(data).ok_or_else(|| "its data: URI holds bad base64".to_owned())
}

/// Standard alphabet, padding optional.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut word = 0_u32;
        for &symbol in group {
            word = word << 6 | u32::from(base64_value(symbol)?);
        }
        let missing = 4 - group.len();
        if missing == 3 {
            return None;
        }
        let padded = (word << (6 * missing)).to_be_bytes();
        bytes.extend_from_slice(&padded[1..4 - missing]);
    }
    Some(bytes)
}

fn base64_value(symbol: u8) -> Option<u8> {
    match symbol {
        b'A'..=b'Z' => Some(symbol - b'A'),
        b'a'..=b'z' => Some(symbol - b'a' + 26),
        b'0'..=b'9' => Some(symbol - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}
