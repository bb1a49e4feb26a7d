//! The artist's mesh as GLB, with tangents and the baked maps.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use gltf::binary::{Glb, Header};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3, Vector4};
use serde_json::{Map, Value, json};

use crate::glb_buffer::GlbBuffer;
use crate::glb_content::{GlbAdditions, GlbContent, wrinkle_maps};
use crate::glb_frames::{FileSpace, single, unit, unit_tangent};
use crate::glb_moved::AddedShapes;
use crate::gltf_write::document_content;
use crate::{
    GlbReference, IoError, MapCoordinates, Material, MeshFile, MeshPart, WrinkleMap,
    write_atomically,
};

/// Report of what was written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenGlb {
    /// The file's name and where in it the maps are referenced, for `wrinkles.json`.
    pub reference: GlbReference,
    /// Warnings in words for the user: what could not be carried or does not fit the maps.
    pub warnings: Vec<String>,
}

/// Writes the artist's mesh as GLB, with tangents and the list of its maps.
///
/// A mesh that was read from glTF ([`MeshFile::document`]) is written as the document it came from:
/// every accessor, image, material, node, skin, animation and extension as it was, the text of its
/// JSON and the bytes of its buffers included; changes to [`MeshFile::mesh`] are not. Files of
/// buffers and images are copied into the GLB, so that it stands alone. Added are
/// - `TANGENT` where a primitive with texture coordinates has none, and `NORMAL` where it has none
///   of these either. Vertices are not split: where the triangles around one want different
///   tangents, it gets the one that it was given. Tangents that the file has stay; a warning says
///   if they are not those of `additions`.
/// - a blend shape per mesh of [`GlbAdditions::moved`], and an animation per pose of these; where the document cannot
///   take them, a warning says so.
/// - `wrinkleMaps` in the mesh's `extras`: all maps, by pose and key. Materials are not touched.
///
/// Any other mesh is written anew: vertices, triangles and blend shapes under a node with the
/// world transform they had, in the file's own units, materials without images.
///
/// # Errors
/// [`IoError::Unwritten`] when an array is not one per vertex or the file would be larger than a
/// GLB can be, [`IoError::Unwritable`] when the file cannot be written.
pub fn write_glb(
    path: &Path,
    file: &MeshFile,
    additions: &GlbAdditions<'_>,
) -> Result<WrittenGlb, IoError> {
    check(path, file, additions)?;
    let content = match &file.document {
        Some(document) => document_content(file, document, additions)
            .map_err(|error| IoError::unwritten(path, error.to_string()))?,
        None => {
            check_numbers(path, file)?;
            NewDocument::new(file, additions).content()
        }
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let written = WrittenGlb {
        reference: GlbReference {
            file: name.into_owned(),
            maps: content.maps,
            coordinates: content.coordinates,
        },
        warnings: content.warnings,
    };
    write_atomically(path, &glb_bytes(path, content.json, content.binary)?)?;
    Ok(written)
}

fn glb_bytes(path: &Path, json: String, binary: Vec<u8>) -> Result<Vec<u8>, IoError> {
    // Lengths have 32 bits; headers and padding take less than 64 bytes.
    if u32::try_from(json.len() + binary.len() + 64).is_err() {
        let reason = "with its buffers and images it is larger than the 4 GiB of a GLB";
        return Err(IoError::unwritten(path, reason));
    }
    let header = Header {
        magic: *b"glTF",
        version: 2,
        length: 0,
    };
    Glb {
        header,
        json: Cow::Owned(json.into_bytes()),
        bin: (!binary.is_empty()).then_some(Cow::Owned(binary)),
    }
    .to_vec()
    .map_err(|error| IoError::unwritten(path, error.to_string()))
}

fn check(path: &Path, file: &MeshFile, additions: &GlbAdditions<'_>) -> Result<(), IoError> {
    let mesh = &file.mesh;
    let vertices = mesh.positions.len();
    let mut lengths = vec![
        ("uvs", mesh.uvs.as_ref().map(Vec::len)),
        ("normals", mesh.normals.as_ref().map(Vec::len)),
        ("tangents", additions.tangents.map(<[_]>::len)),
        ("added normals", additions.normals.map(<[_]>::len)),
    ];
    for shape in &mesh.shapes {
        lengths.push((&shape.name, Some(shape.position_deltas.len())));
        lengths.push((&shape.name, shape.normal_deltas.as_ref().map(Vec::len)));
    }
    for moved in additions.moved {
        lengths.push((&moved.pose, Some(moved.positions.len())));
        lengths.push((&moved.pose, Some(moved.normals.len())));
        let fits = |v: &Vector3<f64>| v.iter().all(|c| (*c as f32).is_finite());
        let is_in_reach = moved.positions.iter().chain(&moved.normals).all(fits);
        let (pose, seconds) = (&moved.pose, moved.seconds);
        let reason = if !is_in_reach {
            format!("pose '{pose}' has moved it out of reach")
        } else if !(seconds > 0.0 && (seconds as f32).is_finite()) {
            format!("pose '{pose}' has a shape at {seconds} s, which is to be above 0")
        } else {
            continue;
        };
        return Err(IoError::unwritten(path, reason));
    }
    let wrong = |(_, length): &(&str, Option<usize>)| length.is_some_and(|n| n != vertices);
    if let Some((name, Some(length))) = lengths.into_iter().find(wrong) {
        let reason = format!("`{name}` has {length} entries, the mesh {vertices} vertices");
        return Err(IoError::unwritten(path, reason));
    }
    let corners = mesh.triangles.iter().flatten();
    if file.parts.is_empty()
        || file.parts.iter().any(|part| part.vertices.end > vertices)
        || file
            .parts
            .iter()
            .any(|part| part.triangles.end > mesh.triangles.len())
        || corners.into_iter().any(|c| *c as usize >= vertices)
    {
        return Err(IoError::unwritten(path, "its parts do not fit its mesh"));
    }
    match &file.document {
        Some(document) if document.parts.len() != file.parts.len() => Err(IoError::unwritten(
            path,
            "its parts do not fit its document",
        )),
        _ => Ok(()),
    }
}

/// glTF has 32 bits for a number, and accepts no infinite ones.
fn check_numbers(path: &Path, file: &MeshFile) -> Result<(), IoError> {
    let mesh = &file.mesh;
    let units = units_per_metre(file);
    let fits = |value: f64| (value as f32).is_finite();
    let shapes = mesh.shapes.iter().map(|shape| &shape.position_deltas);
    for vectors in std::iter::once(&mesh.positions).chain(shapes) {
        let wrong = |v: &Vector3<f64>| !v.iter().all(|c| fits(c * units));
        if let Some(vertex) = vectors.iter().position(wrong) {
            let reason = format!("a coordinate of vertex {vertex} needs more than 32 bits");
            return Err(IoError::unwritten(path, reason));
        }
    }
    let uvs = mesh.uvs.iter().flatten().flatten();
    match uvs.into_iter().all(|c| fits(*c)) {
        true => Ok(()),
        false => Err(IoError::unwritten(
            path,
            "a texture coordinate needs more than 32 bits",
        )),
    }
}

/// The document of a mesh that came without one.
struct NewDocument<'a> {
    file: &'a MeshFile,
    maps: &'a [WrinkleMap],
    tangents: Option<&'a [Vector4<f64>]>,
    normals: Option<&'a [Vector3<f64>]>,
    /// File units per metre where one number does it; else the mesh is written in metres.
    units_per_metre: f64,
    moved: AddedShapes<'a>,
    buffer: GlbBuffer,
    /// Attributes and targets of the vertex ranges written so far.
    written: Vec<(Range<usize>, Value, Value)>,
    materials: Vec<Value>,
}

impl<'a> NewDocument<'a> {
    fn new(file: &'a MeshFile, additions: &GlbAdditions<'a>) -> Self {
        let normals = file.mesh.normals.as_deref().or(additions.normals);
        Self {
            file,
            maps: additions.maps,
            tangents: additions.tangents.filter(|_| normals.is_some()),
            normals,
            units_per_metre: units_per_metre(file),
            moved: AddedShapes::new(file, additions.moved),
            buffer: GlbBuffer::default(),
            written: Vec::new(),
            materials: Vec::new(),
        }
    }

    fn content(mut self) -> GlbContent {
        let file = self.file;
        let primitives: Vec<Value> = file.parts.iter().map(|p| self.primitive(p)).collect();
        let json = self.root(primitives).to_string();
        let coordinates = (0..file.parts.len()).filter(|_| file.mesh.uvs.is_some());
        GlbContent {
            json,
            binary: self.buffer.into_bytes(),
            maps: (!self.maps.is_empty()).then(|| "/meshes/0/extras/wrinkleMaps".to_owned()),
            coordinates: coordinates.map(MapCoordinates::plain).collect(),
            warnings: Vec::new(),
        }
    }

    fn primitive(&mut self, part: &MeshPart) -> Value {
        let earlier = self.written.iter().find(|w| w.0 == part.vertices);
        let (attributes, targets) = match earlier {
            Some((_, attributes, targets)) => (attributes.clone(), targets.clone()),
            None => {
                let attributes = self.attributes(&part.vertices);
                let targets = self.targets(&part.vertices);
                let range = part.vertices.clone();
                self.written
                    .push((range, attributes.clone(), targets.clone()));
                (attributes, targets)
            }
        };
        let first = part.vertices.start as u32;
        let corners = self.file.mesh.triangles[part.triangles.clone()]
            .iter()
            .flatten();
        let corners: Vec<u32> = corners.map(|corner| corner - first).collect();
        let mut primitive = json!({
            "attributes": attributes,
            "indices": self.buffer.indices(&corners, part.vertices.len()),
        });
        if let Some(material) = self.material(part.material.as_ref()) {
            primitive["material"] = json!(material);
        }
        if self.has_shapes() {
            primitive["targets"] = targets;
        }
        primitive
    }

    fn has_shapes(&self) -> bool {
        !self.file.mesh.shapes.is_empty() || !self.moved.is_empty()
    }

    fn attributes(&mut self, range: &Range<usize>) -> Value {
        let mesh = &self.file.mesh;
        let scale = self.units_per_metre;
        let positions: Vec<[f32; 3]> = mesh.positions[range.clone()]
            .iter()
            .map(|p| single(p * scale))
            .collect();
        let mut attributes = json!({ "POSITION": self.buffer.bounded(&positions) });
        if let Some(normals) = self.normals {
            let normals: Vec<Vector3<f64>> = normals[range.clone()].iter().map(unit).collect();
            let singles: Vec<[f32; 3]> = normals.iter().copied().map(single).collect();
            attributes["NORMAL"] = json!(self.buffer.attribute(&singles, "VEC3"));
            if let Some(tangents) = self.tangents {
                let tangents: Vec<[f32; 4]> = tangents[range.clone()]
                    .iter()
                    .zip(&normals)
                    .map(|(tangent, normal)| unit_tangent(tangent, normal).cast::<f32>().into())
                    .collect();
                attributes["TANGENT"] = json!(self.buffer.attribute(&tangents, "VEC4"));
            }
        }
        if let Some(uvs) = &mesh.uvs {
            let uvs: Vec<[f32; 2]> = uvs[range.clone()]
                .iter()
                .map(|uv| [uv.x as f32, uv.y as f32])
                .collect();
            attributes["TEXCOORD_0"] = json!(self.buffer.attribute(&uvs, "VEC2"));
        }
        attributes
    }

    fn targets(&mut self, range: &Range<usize>) -> Value {
        let file = self.file;
        let scale = self.units_per_metre;
        let with_normals = self.normals.is_some();
        let mut targets: Vec<Value> = file
            .mesh
            .shapes
            .iter()
            .map(|shape| {
                let deltas: Vec<[f32; 3]> = shape.position_deltas[range.clone()]
                    .iter()
                    .map(|delta| single(delta * scale))
                    .collect();
                let mut target = json!({ "POSITION": self.buffer.deltas(&deltas) });
                if let Some(normals) = shape.normal_deltas.as_ref().filter(|_| with_normals) {
                    let normals: Vec<[f32; 3]> =
                        normals[range.clone()].iter().copied().map(single).collect();
                    target["NORMAL"] = json!(self.buffer.deltas(&normals));
                }
                target
            })
            .collect();
        let space = FileSpace::of(&Matrix3::from_diagonal_element(1.0 / scale));
        let moved = (range, self.normals);
        targets.extend(self.moved.targets(&mut self.buffer, &space, moved));
        Value::Array(targets)
    }

    /// Number of the material.
    fn material(&mut self, material: Option<&Material>) -> Option<usize> {
        let json = material_json(material?);
        let known = self.materials.iter().position(|other| *other == json);
        Some(known.unwrap_or_else(|| {
            self.materials.push(json);
            self.materials.len() - 1
        }))
    }

    fn root(&mut self, primitives: Vec<Value>) -> Value {
        let mesh = &self.file.mesh;
        let mut mesh_json = json!({ "name": mesh.name, "primitives": primitives });
        let mut extras = Map::new();
        if self.has_shapes() {
            let names = self.moved.names();
            let mut weights = self.file.default_weights.clone();
            weights.resize(names.len(), 0.0);
            mesh_json["weights"] = json!(weights);
            extras.insert("targetNames".to_owned(), json!(names));
        }
        let animations = self.moved.animations(&mut self.buffer, &[0]);
        if !self.maps.is_empty() {
            extras.insert("wrinkleMaps".to_owned(), wrinkle_maps(self.maps));
        }
        if !extras.is_empty() {
            mesh_json["extras"] = Value::Object(extras);
        }
        let mut root = json!({
            "asset": { "version": "2.0", "generator": concat!("ruga ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [self.node()],
            "meshes": [mesh_json],
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [{ "byteLength": self.buffer.len() }],
        });
        if !animations.is_empty() {
            root["animations"] = json!(animations);
        }
        if !self.materials.is_empty() {
            root["materials"] = json!(self.materials);
        }
        root
    }

    fn node(&self) -> Value {
        let world = &self.file.world_from_node;
        let linear: Matrix3<f64> = world.fixed_view::<3, 3>(0, 0).into_owned();
        let mut node = json!({ "mesh": 0, "name": self.file.mesh.name });
        let unit = self.file.metres_per_unit;
        let translation: Vector3<f64> = world.fixed_view::<3, 1>(0, 3) / unit;
        if translation != Vector3::zeros() {
            node["translation"] = json!(translation.as_slice());
        }
        // `linear = turn stretch`; a mirroring turn becomes a negative scale.
        let Some(unstretched) = self.file.stretch.try_inverse() else {
            return node;
        };
        let turn = linear * unstretched;
        let mirror = turn.determinant().signum();
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_eps(
            &(turn * mirror),
            1e-12,
            100,
            Rotation3::identity(),
        ));
        if rotation.angle() > 1e-9 {
            node["rotation"] = json!(rotation.coords.as_slice());
        }
        let scale = mirror / (self.units_per_metre * unit);
        if scale != 1.0 {
            node["scale"] = json!([scale, scale, scale]);
        }
        node
    }
}

fn units_per_metre(file: &MeshFile) -> f64 {
    1.0 / uniform_scale(&file.stretch).unwrap_or(1.0)
}

/// The factor of a stretch that is one number.
fn uniform_scale(stretch: &Matrix3<f64>) -> Option<f64> {
    let scale = stretch[(0, 0)];
    (*stretch == Matrix3::from_diagonal_element(scale)).then_some(scale)
}

fn material_json(material: &Material) -> Value {
    let mut json = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": material.base_color,
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
        "doubleSided": material.double_sided,
    });
    if let Some(name) = &material.name {
        json["name"] = json!(name);
    }
    json
}
