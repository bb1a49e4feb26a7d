//! A glTF document on its way back: what is added to it, everything else untouched.

use std::ops::Range;

use nalgebra::{Vector3, Vector4};
use serde_json::value::{RawValue, to_raw_value};

use crate::glb_buffer::GlbBuffer;
use crate::glb_content::{GlbAdditions, GlbContent, wrinkle_maps};
use crate::glb_frames::{FileSpace, single, unit, unit_tangent};
use crate::glb_moved::{AddedShapes, are_weights_animated, carriers};
use crate::gltf_document::{GltfDocument, PartSource};
use crate::gltf_images::embed_images;
use crate::gltf_uri::encode_data_uri;
use crate::json_text::JsonObject;
use crate::{MeshFile, MeshPart};

/// Cosine of the angle by which the file's tangents may differ from those of the maps: 5 degrees.
const SAME_TANGENT: f64 = 0.996;

/// Share of a primitive's vertices whose tangents may differ more: tools disagree where a texture
/// has no direction.
const FEW: f64 = 0.01;

/// The document with tangents, the maps named in the mesh's `extras`, and the files of buffers and
/// images inside.
///
/// # Errors
/// None that a document that was read could cause; the type is that of JSON's writers.
pub(crate) fn document_content(
    file: &MeshFile,
    document: &GltfDocument,
    additions: &GlbAdditions<'_>,
) -> serde_json::Result<GlbContent> {
    let mut root = document.json.clone();
    let bytes = document.buffers.first().cloned().unwrap_or_default();
    let counts = ["bufferViews", "accessors"].map(|name| root.array(name).len());
    let mut writer = Writer {
        file,
        additions,
        normals: file.mesh.normals.as_deref().or(additions.normals),
        space: FileSpace::of(&file.stretch),
        buffer: GlbBuffer::after(bytes, counts[0], counts[1]),
        written: Vec::new(),
        warnings: Vec::new(),
    };
    let lists_maps = writer.edit_mesh(&mut root, document)?;
    let (mut warnings, mut buffer) = (writer.warnings, writer.buffer);
    let (path, missing) = (&document.path, &document.missing_images);
    warnings.extend(embed_images(&mut root, path, missing, &mut buffer)?);
    extend(&mut root, "bufferViews", &buffer.views)?;
    extend(&mut root, "accessors", &buffer.accessors)?;
    set_buffers(&mut root, document, buffer.len())?;
    let coordinates = document.parts.iter().filter_map(|part| {
        let coordinates = part.coordinates.as_ref()?;
        Some(coordinates.of_maps(part.primitive))
    });
    Ok(GlbContent {
        json: serde_json::to_string(&root)?,
        binary: buffer.into_bytes(),
        maps: lists_maps.then(|| format!("/meshes/{}/extras/wrinkleMaps", document.mesh)),
        coordinates: coordinates.collect(),
        warnings,
    })
}

/// Adds elements at the end of an array of the document.
fn extend(
    root: &mut JsonObject,
    name: &str,
    added: &[serde_json::Value],
) -> serde_json::Result<()> {
    if added.is_empty() {
        return Ok(());
    }
    let mut elements = root.array(name);
    for element in added {
        elements.push(to_raw_value(element)?);
    }
    root.set(name, &elements)
}

/// The first buffer becomes the binary chunk; the files of others, which a GLB has no chunk for,
/// become text, so that nothing that speaks of a buffer by number need change.
fn set_buffers(
    root: &mut JsonObject,
    document: &GltfDocument,
    length: usize,
) -> serde_json::Result<()> {
    let mut buffers = root.array("buffers");
    if buffers.is_empty() && length > 0 {
        buffers.push(to_raw_value(&JsonObject::default())?);
    }
    for (number, text) in buffers.iter_mut().enumerate() {
        let mut buffer = JsonObject::parse(text.get())?;
        let uri: Option<String> = buffer.read("uri");
        if number == 0 {
            buffer.remove("uri");
            buffer.set("byteLength", &length)?;
        } else if uri.is_some_and(|uri| !uri.starts_with("data:")) {
            buffer.set("uri", &encode_data_uri(&document.buffers[number]))?;
        }
        *text = to_raw_value(&buffer)?;
    }
    match buffers.is_empty() {
        true => Ok(()),
        false => root.set("buffers", &buffers),
    }
}

fn has_normals(primitive: &RawValue) -> bool {
    let primitive = JsonObject::parse(primitive.get()).unwrap_or_default();
    let attributes: JsonObject = primitive.read("attributes").unwrap_or_default();
    attributes.get("NORMAL").is_some()
}

/// The primitive with more morph targets.
fn with_targets(text: &RawValue, added: &[serde_json::Value]) -> serde_json::Result<Box<RawValue>> {
    let mut primitive = JsonObject::parse(text.get())?;
    extend(&mut primitive, "targets", added)?;
    to_raw_value(&primitive)
}

struct Writer<'a> {
    file: &'a MeshFile,
    additions: &'a GlbAdditions<'a>,
    /// Those that the tangents were made with.
    normals: Option<&'a [Vector3<f64>]>,
    space: FileSpace,
    buffer: GlbBuffer,
    /// Vertex ranges with the numbers of the accessors made for them.
    written: Vec<(Range<usize>, Added)>,
    warnings: Vec<String>,
}

/// Accessors that were added for a range of vertices.
#[derive(Clone, Copy)]
struct Added {
    tangent: usize,
    /// Accessor of the normals, where the file has none.
    normal: Option<usize>,
}

impl Writer<'_> {
    /// Adds tangents and the list of maps; returns whether the maps could be listed.
    fn edit_mesh(
        &mut self,
        root: &mut JsonObject,
        document: &GltfDocument,
    ) -> serde_json::Result<bool> {
        let mut meshes = root.array("meshes");
        let mut mesh = JsonObject::parse(meshes[document.mesh].get())?;
        let mut primitives = mesh.array("primitives");
        let nodes = carriers(root, document.mesh);
        let mut shapes = AddedShapes::new(self.file, self.additions.moved);
        let has_room = !shapes.is_empty() && self.has_room(root, &primitives, &nodes);
        for (part, source) in self.file.parts.iter().zip(&document.parts) {
            let text = &mut primitives[source.primitive];
            let had_normals = has_normals(text);
            if let Some(edited) = self.with_tangents(text, part, source)? {
                *text = edited;
            }
            if has_room {
                // Where others of the mesh have none, nobody has kept the file's.
                let normals = match (had_normals, has_normals(text)) {
                    (true, _) => self.file.mesh.normals.as_deref(),
                    (false, true) => self.additions.normals,
                    (false, false) => None,
                };
                let (buffer, vertices) = (&mut self.buffer, (&part.vertices, normals));
                let added = shapes.targets(buffer, &self.space, vertices);
                *text = with_targets(text, &added)?;
            }
        }
        mesh.set("primitives", &primitives)?;
        if has_room {
            self.play(root, (&mut mesh, &nodes), &shapes)?;
        }
        let lists_maps = self.list_maps(&mut mesh)?;
        meshes[document.mesh] = to_raw_value(&mesh)?;
        root.set("meshes", &meshes)?;
        Ok(lists_maps)
    }

    /// Whether all of the mesh can take more blend shapes; else a warning says why not.
    fn has_room(
        &mut self,
        root: &JsonObject,
        primitives: &[Box<RawValue>],
        nodes: &[usize],
    ) -> bool {
        let is_compressed = |text: &RawValue| {
            let primitive = JsonObject::parse(text.get()).unwrap_or_default();
            let extensions: JsonObject = primitive.read("extensions").unwrap_or_default();
            extensions.get("KHR_draco_mesh_compression").is_some()
        };
        let why = if are_weights_animated(root, nodes) {
            "an animation of the file drives its blend shapes, and says how many there are"
        } else if primitives.len() != self.file.parts.len() {
            "parts of it are no triangles"
        } else if primitives.iter().any(|text| is_compressed(text)) {
            "it is compressed by Draco"
        } else {
            return true;
        };
        self.warnings.push(format!(
            "the GLB does not show how the mesh moves, because {why}; the OBJ files beside it do"
        ));
        false
    }

    /// Gives the mesh names and weights of the shapes that were added, and an animation to every pose.
    fn play(
        &mut self,
        root: &mut JsonObject,
        (mesh, carriers): (&mut JsonObject, &[usize]),
        shapes: &AddedShapes<'_>,
    ) -> serde_json::Result<()> {
        shapes.extend_weights(mesh)?;
        let extras = mesh.get("extras").map_or("{}", RawValue::get);
        // Where they are no object, `list_maps` warns of them.
        if let Ok(mut extras) = JsonObject::parse(extras) {
            extras.set("targetNames", &shapes.names())?;
            mesh.set("extras", &extras)?;
        }
        let mut nodes = root.array("nodes");
        for &carrier in carriers {
            let mut node = JsonObject::parse(nodes[carrier].get())?;
            shapes.extend_weights(&mut node)?;
            nodes[carrier] = to_raw_value(&node)?;
        }
        if !carriers.is_empty() {
            root.set("nodes", &nodes)?;
        }
        let animations = shapes.animations(&mut self.buffer, carriers);
        extend(root, "animations", &animations)
    }

    fn list_maps(&mut self, mesh: &mut JsonObject) -> serde_json::Result<bool> {
        if self.additions.maps.is_empty() {
            return Ok(false);
        }
        let extras = mesh.get("extras").map_or("{}", RawValue::get);
        let Ok(mut extras) = JsonObject::parse(extras) else {
            let warning = "the `extras` of the mesh are no JSON object and stay as they are: a \
                           program that looks for the maps finds them in wrinkles.json alone";
            self.warnings.push(warning.to_owned());
            return Ok(false);
        };
        extras.set("wrinkleMaps", &wrinkle_maps(self.additions.maps))?;
        mesh.set("extras", &extras)?;
        Ok(true)
    }

    /// The primitive with `TANGENT`, if it is to have one that it has not.
    fn with_tangents(
        &mut self,
        text: &RawValue,
        part: &MeshPart,
        source: &PartSource,
    ) -> serde_json::Result<Option<Box<RawValue>>> {
        let (Some(tangents), Some(normals)) = (self.additions.tangents, self.normals) else {
            return Ok(None);
        };
        let mut primitive = JsonObject::parse(text.get())?;
        let mut attributes: JsonObject = primitive.read("attributes").unwrap_or_default();
        if attributes.get("TANGENT").is_some() {
            self.compare_tangents(part, source, tangents);
            return Ok(None);
        }
        if source.coordinates.is_none() || self.is_compressed(&primitive, source) {
            return Ok(None);
        }
        let has_normals = attributes.get("NORMAL").is_some();
        self.warn_of_normals(has_normals, source);
        let added = self.added(&part.vertices, tangents, normals, has_normals);
        if let Some(normal) = added.normal {
            attributes.set("NORMAL", &normal)?;
        }
        attributes.set("TANGENT", &added.tangent)?;
        primitive.set("attributes", &attributes)?;
        to_raw_value(&primitive).map(Some)
    }

    /// Draco decodes vertices in an order of its own, which added attributes cannot follow.
    fn is_compressed(&mut self, primitive: &JsonObject, source: &PartSource) -> bool {
        let extensions: JsonObject = primitive.read("extensions").unwrap_or_default();
        let is_compressed = extensions.get("KHR_draco_mesh_compression").is_some();
        if is_compressed {
            self.warnings.push(format!(
                "primitive {} is compressed by Draco and gets no tangents: export without mesh \
                 compression",
                source.primitive
            ));
        }
        is_compressed
    }

    fn warn_of_normals(&mut self, has_normals: bool, source: &PartSource) {
        let number = source.primitive;
        if !has_normals {
            self.warnings.push(format!(
                "primitive {number} has no normals; smooth ones are added, because the maps are \
                 relative to them"
            ));
        } else if self.file.mesh.normals.is_none() {
            self.warnings.push(format!(
                "primitive {number} has normals, but others of its mesh have none: the maps are \
                 relative to smooth normals, so its wrinkles are lit a little wrongly; export normals \
                 for the whole mesh"
            ));
        }
    }

    fn added(
        &mut self,
        range: &Range<usize>,
        tangents: &[Vector4<f64>],
        normals: &[Vector3<f64>],
        has_normals: bool,
    ) -> Added {
        if let Some((_, added)) = self.written.iter().find(|(other, _)| other == range) {
            return *added;
        }
        let normals: Vec<Vector3<f64>> = normals[range.clone()].iter().map(unit).collect();
        let tangents = tangents[range.clone()].iter().zip(&normals);
        let tangents: Vec<[f32; 4]> = tangents
            .map(|(tangent, normal)| self.space.tangent(unit_tangent(tangent, normal)))
            .collect();
        let in_file = normals.iter().map(|n| single(self.space.normal(n)));
        let in_file: Vec<[f32; 3]> = in_file.collect();
        let added = Added {
            tangent: self.buffer.attribute(&tangents, "VEC4"),
            normal: (!has_normals).then(|| self.buffer.attribute(&in_file, "VEC3")),
        };
        self.written.push((range.clone(), added));
        added
    }

    /// The file's own tangents stay, because its normal map was made for them; the wrinkle maps
    /// were made for MikkTSpace.
    fn compare_tangents(
        &mut self,
        part: &MeshPart,
        source: &PartSource,
        tangents: &[Vector4<f64>],
    ) {
        let Some(theirs) = &source.tangents else {
            return;
        };
        let triangles = &self.file.mesh.triangles[part.triangles.clone()];
        let mut used: Vec<usize> = triangles.iter().flatten().map(|v| *v as usize).collect();
        used.sort_unstable();
        used.dedup();
        let differs = |vertex: &&usize| {
            let own = Vector4::from(self.space.tangent(tangents[**vertex])).cast::<f64>();
            let Some(theirs) = theirs.get(*vertex - part.vertices.start) else {
                return true;
            };
            let theirs = Vector4::from(*theirs);
            let cosine = own.xyz().dot(&theirs.xyz().normalize());
            // Written so that what is no number differs.
            !(cosine > SAME_TANGENT && own.w * theirs.w > 0.0)
        };
        let different = used.iter().filter(differs).count();
        if different as f64 > FEW * used.len() as f64 {
            self.warnings.push(format!(
                "the tangents of primitive {} stay as they are, but at {different} of {} vertices \
                 they are not those of MikkTSpace, which the maps are relative to: wrinkles look \
                 turned there. Export with MikkTSpace tangents, or without any",
                source.primitive,
                used.len()
            ));
        }
    }
}
