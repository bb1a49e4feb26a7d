//! The glTF document that a mesh was read from.

use std::fmt;
use std::path::PathBuf;

use serde_json::Value;

use crate::gltf_container::Container;
use crate::gltf_images::missing_images;
use crate::gltf_texcoord::TexCoord;
use crate::json_text::JsonObject;

/// The whole glTF document that a mesh was read from, with its buffers: what [`write_glb`] writes
/// back unchanged.
///
/// [`write_glb`]: crate::write_glb
#[derive(Clone)]
pub struct GltfDocument {
    /// The file that it was read from.
    pub(crate) path: PathBuf,
    pub(crate) json: JsonObject,
    pub(crate) buffers: Vec<Vec<u8>>,
    /// Number of the mesh that was read.
    pub(crate) mesh: usize,
    /// One entry per part of the mesh.
    pub(crate) parts: Vec<PartSource>,
    /// Images whose files are not there; ascending.
    pub(crate) missing_images: Vec<usize>,
}

/// Place of a part of a mesh in its document.
#[derive(Clone, Debug)]
pub(crate) struct PartSource {
    /// Number of the primitive.
    pub(crate) primitive: usize,
    /// The texture coordinates that were read, if it has any.
    pub(crate) coordinates: Option<TexCoord>,
    /// The tangents that the file has.
    pub(crate) tangents: Option<Vec<[f64; 4]>>,
}

impl GltfDocument {
    /// Keeps a file that has been read, and says what of it cannot be written back.
    pub(crate) fn new(
        container: Container,
        mesh: usize,
        parts: Vec<PartSource>,
    ) -> (Self, Vec<String>) {
        let mut warnings = Vec::new();
        if container.unused_bytes > 0 {
            warnings.push(format!(
                "{} bytes of the file belong to no buffer and are not written into the GLB; mesh, \
                 materials and animations are whole",
                container.unused_bytes
            ));
        }
        let missing = missing_images(&container.json, &container.path);
        let (missing_images, reasons): (Vec<_>, Vec<_>) = missing.into_iter().unzip();
        warnings.extend(reasons);
        warnings.extend(files_of_extensions(&container.json));
        let document = Self {
            path: container.path,
            json: container.json,
            buffers: container.buffers,
            mesh,
            parts,
            missing_images,
        };
        (document, warnings)
    }
}

/// Megabytes of text and bytes help nobody in a message.
impl fmt::Debug for GltfDocument {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("GltfDocument")
            .field("path", &self.path)
            .field("mesh", &self.mesh)
            .finish_non_exhaustive()
    }
}

/// Files that extensions name, which stay outside the GLB.
fn files_of_extensions(json: &JsonObject) -> Vec<String> {
    let rest = json.without(&["buffers", "images"]);
    let rest = serde_json::to_value(&rest).unwrap_or_default();
    let mut found = Vec::new();
    collect_uris(&rest, &mut found);
    found.sort();
    found.dedup();
    let warning = |uri: String| {
        format!(
            "an extension of the file names `{uri}`, which is not written into the GLB: put that file beside \
             the GLB"
        )
    };
    found.into_iter().map(warning).collect()
}

/// Every `uri` outside `extras` that is not data.
fn collect_uris(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Array(elements) => elements.iter().for_each(|e| collect_uris(e, found)),
        Value::Object(fields) => {
            for (name, value) in fields.iter().filter(|(name, _)| *name != "extras") {
                match value {
                    Value::String(uri) if name == "uri" && !uri.starts_with("data:") => {
                        found.push(crate::gltf_uri::shortened(uri));
                    }
                    _ => collect_uris(value, found),
                }
            }
        }
        _ => {}
    }
}
