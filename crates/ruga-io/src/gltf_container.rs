//! glTF containers: the JSON and the bytes of every buffer, from `.glb` or `.gltf`.

use std::path::{Path, PathBuf};

use gltf::binary::Glb;
use gltf::json::Root;

use crate::IoError;
use crate::error::read_bytes;
use crate::gltf_uri::{decode_data_uri, external_file, shortened};
use crate::json_text::JsonObject;

/// Fields of a document that say where its triangles are; the reader looks at no other, so that a
/// texture or an animation of an unknown kind is no reason to refuse a mesh.
const GEOMETRY: [&str; 9] = [
    "accessors",
    "asset",
    "buffers",
    "bufferViews",
    "extensionsRequired",
    "materials",
    "meshes",
    "nodes",
    "skins",
];

/// A parsed file whose buffers are all loaded. Nothing in `root` has been validated.
pub(crate) struct Container {
    pub(crate) path: PathBuf,
    /// The whole document.
    pub(crate) json: JsonObject,
    /// Its [`GEOMETRY`].
    pub(crate) root: Root,
    pub(crate) buffers: Vec<Vec<u8>>,
    /// Bytes of the file that belong to nothing in the document.
    pub(crate) unused_bytes: usize,
}

impl Container {
    pub(crate) fn read(path: &Path) -> Result<Self, IoError> {
        let bytes = read_bytes(path)?;
        let mut chunks = split_container(path, &bytes)?;
        let (json, root) = parse(path, chunks.json)?;
        reject_compressed_geometry(path, &root)?;
        let buffers = (0..root.buffers.len())
            .map(|i| load_buffer(path, &root, i, &mut chunks.binary))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            path: path.to_owned(),
            json,
            root,
            buffers,
            unused_bytes: chunks.others + chunks.binary.map_or(0, |bytes| bytes.len()),
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

/// Parts that a file is made of.
struct Chunks {
    json: Vec<u8>,
    binary: Option<Vec<u8>>,
    /// Bytes of further chunks, of which glTF knows none.
    others: usize,
}

/// Tells the binary container from JSON text by the content, not by the name.
fn split_container(path: &Path, bytes: &[u8]) -> Result<Chunks, IoError> {
    if bytes.starts_with(b"glTF") {
        return split_glb(path, bytes);
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.trim_ascii_start().starts_with(b"{") {
        return Ok(Chunks {
            json: text.to_owned(),
            binary: None,
            others: 0,
        });
    }
    Err(IoError::UnknownFormat {
        path: path.to_owned(),
        found: "begins neither with `glTF` nor with `{`".to_owned(),
        accepted: "glTF 2.0, binary or JSON",
    })
}

fn split_glb(path: &Path, bytes: &[u8]) -> Result<Chunks, IoError> {
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
    let binary = glb.bin.map(std::borrow::Cow::into_owned);
    let known = 20 + glb.json.len() + binary.as_ref().map_or(0, |bytes| 8 + bytes.len());
    Ok(Chunks {
        json: glb.json.into_owned(),
        binary,
        others: whole.len().saturating_sub(known),
    })
}

/// The whole document as text, and its geometry parsed.
fn parse(path: &Path, json: Vec<u8>) -> Result<(JsonObject, Root), IoError> {
    let syntax = |reason: String| IoError::malformed(path, "JSON", reason);
    let text = String::from_utf8(json).map_err(|error| syntax(error.to_string()))?;
    let json = JsonObject::parse(&text).map_err(|error| syntax(error.to_string()))?;
    let geometry =
        serde_json::to_string(&json.only(&GEOMETRY)).map_err(|error| syntax(error.to_string()))?;
    let mut document = serde_json::Deserializer::from_str(&geometry);
    let root = serde_path_to_error::deserialize(&mut document).map_err(|error| {
        let element = format!("JSON, `{}`", error.path());
        let reason = error.into_inner().to_string();
        // Lines and columns count in the text of the geometry, which the user has never seen.
        let reason = reason.split(" at line ").next().unwrap_or_default();
        IoError::malformed(path, element, reason)
    })?;
    Ok((json, root))
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
