//! A mesh with blend shapes as a binary glTF 2.0 file.

use std::collections::BTreeMap;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::Target;
use gltf_json::extras::RawValue;
use gltf_json::mesh::{Mode, MorphTarget, Primitive, Semantic};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Buffer, Index, Material, Mesh, Node, Root, Scene, buffer};
use nalgebra::Vector3;
use ruga_blend::ArtistMesh;

/// The bytes of a file with one node, one mesh and one plain skin-coloured material.
pub(super) fn write(mesh: &ArtistMesh) -> Result<Vec<u8>, gltf_json::Error> {
    let mut document = Document::default();
    let primitive = document.primitive(mesh);
    let names: Vec<&str> = mesh.shapes.iter().map(|s| s.name.as_str()).collect();
    let extras = format!(
        "{{\"targetNames\":{}}}",
        gltf_json::serialize::to_string(&names)?
    );
    let mesh_index = document.root.push(Mesh {
        extensions: None,
        extras: Some(RawValue::from_string(extras)?),
        name: Some(mesh.name.clone()),
        primitives: vec![primitive],
        weights: Some(vec![0.0; mesh.shapes.len()]),
    });
    let node = document.root.push(Node {
        mesh: Some(mesh_index),
        name: Some(mesh.name.clone()),
        ..Node::default()
    });
    let scene = document.root.push(Scene {
        extensions: None,
        extras: None,
        name: None,
        nodes: vec![node],
    });
    document.root.scene = Some(scene);
    document.root.asset.generator = Some("cargo xtask assets".to_owned());
    document.finish()
}

/// The JSON part and the binary part as they grow.
#[derive(Default)]
struct Document {
    root: Root,
    bytes: Vec<u8>,
}

impl Document {
    fn primitive(&mut self, mesh: &ArtistMesh) -> Primitive {
        let mut attributes = BTreeMap::new();
        let positions = self.vectors(&mesh.positions, true);
        attributes.insert(Checked::Valid(Semantic::Positions), positions);
        if let Some(normals) = &mesh.normals {
            let normals = self.vectors(normals, false);
            attributes.insert(Checked::Valid(Semantic::Normals), normals);
        }
        if let Some(uvs) = &mesh.uvs {
            let numbers: Vec<f32> = uvs.iter().flatten().map(|c| *c as f32).collect();
            let view = self.view(
                numbers.iter().flat_map(|c| c.to_le_bytes()),
                Target::ArrayBuffer,
            );
            let uvs = self.accessor(view, uvs.len(), ComponentType::F32, Type::Vec2);
            attributes.insert(Checked::Valid(Semantic::TexCoords(0)), uvs);
        }
        let targets = mesh.shapes.iter().map(|shape| MorphTarget {
            positions: Some(self.vectors(&shape.position_deltas, true)),
            normals: shape.normal_deltas.as_ref().map(|d| self.vectors(d, false)),
            tangents: None,
        });
        let targets = targets.collect();
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(self.indices(&mesh.triangles)),
            material: Some(self.root.push(skin())),
            mode: Checked::Valid(Mode::Triangles),
            targets: Some(targets),
        }
    }

    /// 16-bit indices: no asset has more vertices than those reach.
    fn indices(&mut self, triangles: &[[u32; 3]]) -> Index<Accessor> {
        let numbers = triangles.iter().flatten().map(|&i| i as u16);
        let view = self.view(
            numbers.flat_map(u16::to_le_bytes),
            Target::ElementArrayBuffer,
        );
        let count = 3 * triangles.len();
        self.accessor(view, count, ComponentType::U16, Type::Scalar)
    }

    fn vectors(&mut self, values: &[Vector3<f64>], bounds: bool) -> Index<Accessor> {
        let numbers = values.iter().flatten().map(|c| *c as f32);
        let view = self.view(numbers.flat_map(f32::to_le_bytes), Target::ArrayBuffer);
        let index = self.accessor(view, values.len(), ComponentType::F32, Type::Vec3);
        if bounds {
            let fold = |pick: fn(f32, f32) -> f32| {
                let single = values.iter().map(|v| v.map(|c| c as f32));
                single
                    .reduce(|a, b| a.zip_map(&b, pick))
                    .map(|v| vec![v.x, v.y, v.z].into())
            };
            let accessor = &mut self.root.accessors[index.value()];
            accessor.min = fold(f32::min);
            accessor.max = fold(f32::max);
        }
        index
    }

    fn view(&mut self, content: impl Iterator<Item = u8>, target: Target) -> Index<buffer::View> {
        let start = self.bytes.len();
        self.bytes.extend(content);
        let length = self.bytes.len() - start;
        pad(&mut self.bytes, 0);
        self.root.push(buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: Some(Checked::Valid(target)),
            extensions: None,
            extras: None,
        })
    }

    fn accessor(
        &mut self,
        view: Index<buffer::View>,
        count: usize,
        component: ComponentType,
        type_: Type,
    ) -> Index<Accessor> {
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// Header, JSON chunk padded with spaces, binary chunk padded with zeros.
    fn finish(mut self) -> Result<Vec<u8>, gltf_json::Error> {
        self.root.push(Buffer {
            byte_length: USize64::from(self.bytes.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let mut json = self.root.to_vec()?;
        pad(&mut json, b' ');
        let length = 12 + 8 + json.len() + 8 + self.bytes.len();
        let mut file = Vec::with_capacity(length);
        let word = |file: &mut Vec<u8>, number: usize| {
            file.extend((number as u32).to_le_bytes());
        };
        file.extend(b"glTF");
        word(&mut file, 2);
        word(&mut file, length);
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bytes)] {
            word(&mut file, chunk.len());
            file.extend(kind);
            file.extend(chunk);
        }
        Ok(file)
    }
}

fn skin() -> Material {
    let mut material = Material {
        name: Some("Skin".to_owned()),
        ..Material::default()
    };
    let surface = &mut material.pbr_metallic_roughness;
    surface.base_color_factor.0 = [0.8, 0.6, 0.5, 1.0];
    surface.metallic_factor.0 = 0.0;
    surface.roughness_factor.0 = 0.5;
    material
}

/// glTF aligns everything to 4 bytes.
fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}
