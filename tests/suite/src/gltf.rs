//! glTF files with most of what the format allows, and damage to their JSON.

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::{Chance, FuzzSheet};

/// Component types of the format by number.
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// A glTF document and its only buffer.
#[derive(Clone, Debug)]
pub struct GltfParts {
    /// The document.
    pub json: Value,
    /// The buffer.
    pub binary: Vec<u8>,
}

impl GltfParts {
    /// The sheet as a plain mesh named `Sheet`, V turned down.
    pub fn plain(sheet: &FuzzSheet) -> Self {
        let mut parts = Self {
            json: json!({
                "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0, "name": "Node"}],
                "accessors": [], "bufferViews": [], "buffers": [{}], "meshes": [],
            }),
            binary: Vec::new(),
        };
        let positions = parts.vectors(&sheet.positions);
        let mut attributes = json!({"POSITION": positions});
        if let Some(uvs) = &sheet.uvs {
            let flat: Vec<f32> = uvs
                .iter()
                .flat_map(|uv| [uv.x as f32, 1.0 - uv.y as f32])
                .collect();
            attributes["TEXCOORD_0"] =
                json!(parts.accessor(&floats(&flat), F32, "VEC2", uvs.len()));
        }
        let corners: Vec<u8> = sheet
            .triangles
            .iter()
            .flatten()
            .flat_map(|corner| corner.to_le_bytes())
            .collect();
        let indices = parts.accessor(&corners, U32, "SCALAR", 3 * sheet.triangles.len());
        let targets: Vec<Value> = sheet
            .shapes
            .iter()
            .map(|(_, posed)| {
                let pairs = posed.iter().zip(&sheet.positions);
                let deltas: Vec<Vector3<f64>> = pairs.map(|(p, rest)| p - rest).collect();
                json!({"POSITION": parts.vectors(&deltas)})
            })
            .collect();
        let names: Vec<&String> = sheet.shapes.iter().map(|shape| &shape.0).collect();
        parts.json["meshes"] = json!([{
            "name": "Sheet",
            "primitives": [{"attributes": attributes, "indices": indices, "targets": targets}],
            "extras": {"targetNames": names},
        }]);
        parts
    }

    /// Adds some of what exporters write: node trees, skins, sparse targets, strides, other component
    /// types, strips, several primitives, texture transforms.
    pub fn enrich(&mut self, chance: &mut Chance) {
        for _ in 0..1 + chance.below(4) {
            match chance.below(10) {
                0 => self.add_nodes(chance),
                1 => self.add_skin(),
                2 => self.add_sparse(),
                3 => self.add_stride(),
                4 => self.add_primitive(chance),
                5 => self.quantise_uvs(),
                6 => self.json["meshes"][0]["primitives"][0]["mode"] = json!(chance.below(8)),
                7 => self.add_material(),
                8 => self.json["meshes"][0]["weights"] = json!([0.5, 0.25]),
                _ => {
                    let copy = self.json["meshes"][0].clone();
                    push(&mut self.json["meshes"], copy);
                }
            }
        }
    }

    /// Text with the buffer inside; the buffer's length is stated unless the document states one.
    pub fn to_gltf(&self) -> Vec<u8> {
        let mut json = self.sized();
        if let Some(buffer) = json.pointer_mut("/buffers/0").filter(|b| b.is_object()) {
            buffer["uri"] = json!(format!(
                "data:application/octet-stream;base64,{}",
                base64(&self.binary)
            ));
        }
        json.to_string().into_bytes()
    }

    /// The binary container.
    pub fn to_glb(&self) -> Vec<u8> {
        let mut text = self.sized().to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut binary = self.binary.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let word = |number: usize| (number as u32).to_le_bytes();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend(word(28 + text.len() + binary.len()));
        file.extend(word(text.len()));
        file.extend(b"JSON");
        file.extend(text);
        file.extend(word(binary.len()));
        file.extend(b"BIN\0");
        file.extend(binary);
        file
    }

    fn sized(&self) -> Value {
        let mut json = self.json.clone();
        let length = self.binary.len();
        if let Some(Value::Object(buffer)) = json.pointer_mut("/buffers/0") {
            buffer.entry("byteLength").or_insert(json!(length));
        }
        json
    }

    fn vectors(&mut self, values: &[Vector3<f64>]) -> usize {
        let flat: Vec<f32> = values.iter().flatten().map(|c| *c as f32).collect();
        self.accessor(&floats(&flat), F32, "VEC3", values.len())
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": shape});
        push(&mut self.json["accessors"], accessor)
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        push(&mut self.json["bufferViews"], view)
    }

    fn add_nodes(&mut self, chance: &mut Chance) {
        let scale = chance.magnitude(-3.0, 3.0);
        let node = json!({"rotation": [0, 0, 0.6, 0.8], "scale": [scale, scale, 2.0 * scale], "children": [0]});
        let number = push(&mut self.json["nodes"], node);
        push(
            &mut self.json["nodes"],
            json!({"translation": [1, 2, 3], "children": [number]}),
        );
        if chance.one_in(3) {
            // A ring of nodes, which no tree has.
            self.json["nodes"][0]["children"] = json!([number]);
        }
    }

    fn add_skin(&mut self) {
        let mut matrix = [0.0_f32; 16];
        for i in [0, 5, 10, 15] {
            matrix[i] = 1.0;
        }
        let matrices = self.accessor(&floats(&matrix), F32, "MAT4", 1);
        let joint = push(&mut self.json["nodes"], json!({"scale": [2, 2, 2]}));
        self.json["skins"] = json!([{"joints": [joint], "inverseBindMatrices": matrices}]);
        self.json["nodes"][0]["skin"] = json!(0);
    }

    fn add_sparse(&mut self) {
        let indices = self.view(&[0, 0, 3, 0]);
        let values = self.view(&floats(&[0.01; 6]));
        let sparse = json!({
            "count": 2,
            "indices": {"bufferView": indices, "componentType": U16},
            "values": {"bufferView": values},
        });
        if let Some(Value::Array(accessors)) = self.json.get_mut("accessors")
            && let Some(last) = accessors.last_mut()
        {
            last["sparse"] = sparse;
        }
    }

    /// The first accessor with four bytes between its elements.
    fn add_stride(&mut self) {
        let Some(count) = self.json["accessors"][0]["count"].as_u64() else {
            return;
        };
        let count = count as usize;
        let spread: Vec<u8> = (0..count)
            .flat_map(|i| {
                let mut element = [0; 16];
                let from = 12 * i;
                element[..12].copy_from_slice(&self.binary[from..from + 12]);
                element
            })
            .collect();
        let view = self.view(&spread);
        self.json["bufferViews"][view]["byteStride"] = json!(16);
        self.json["accessors"][0]["bufferView"] = json!(view);
    }

    fn add_primitive(&mut self, chance: &mut Chance) {
        let mut copy = self.json["meshes"][0]["primitives"][0].clone();
        match chance.below(4) {
            0 => drop(copy.as_object_mut().map(|o| o.remove("indices"))),
            1 => copy["attributes"]["NORMAL"] = copy["attributes"]["POSITION"].clone(),
            2 => copy["targets"] = json!([]),
            _ => {}
        }
        push(&mut self.json["meshes"][0]["primitives"], copy);
    }

    fn quantise_uvs(&mut self) {
        let Some(count) = self.json["accessors"][0]["count"].as_u64() else {
            return;
        };
        let bytes: Vec<u8> = (0..4 * count).map(|i| (37 * i % 251) as u8).collect();
        let accessor = self.accessor(&bytes, U8, "VEC2", count as usize);
        self.json["bufferViews"][accessor]["byteStride"] = json!(4);
        self.json["accessors"][accessor]["normalized"] = json!(true);
        self.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(accessor);
    }

    fn add_material(&mut self) {
        self.json["textures"] = json!([{}]);
        self.json["materials"] = json!([{"normalTexture": {"index": 0, "texCoord": 0, "extensions":
            {"KHR_texture_transform": {"rotation": 1.5, "scale": [2, 3], "offset": [0.1, 0.2]}}}}]);
        self.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    }
}

/// Damages a document: one of its values becomes extreme, goes, comes twice, or comes from
/// elsewhere.
pub fn damage_json(root: &mut Value, chance: &mut Chance) {
    let mut places = Vec::new();
    collect_places(root, String::new(), &mut places);
    let place = places[chance.below(places.len())].clone();
    let other = places[chance.below(places.len())].clone();
    let donor = root.pointer(&other).cloned().unwrap_or_default();
    let (parent, key) = place.rsplit_once('/').unwrap_or_default();
    let key = key.to_owned();
    match chance.below(8) {
        0 => match root.pointer_mut(parent) {
            Some(Value::Object(entries)) => drop(entries.remove(&key)),
            Some(Value::Array(items)) => drop(key.parse().map(|at: usize| items.remove(at))),
            _ => {}
        },
        1 => {
            if let Some(Value::Array(items)) = root.pointer_mut(parent)
                && let Ok(at) = key.parse::<usize>()
            {
                items.insert(at, items[at].clone());
            }
        }
        2 => set(root, &place, donor),
        3 => {
            let odd = [
                json!(null),
                json!(""),
                json!([]),
                json!({}),
                json!(true),
                json!("x"),
            ];
            set(root, &place, odd[chance.below(odd.len())].clone());
        }
        4 => set(root, &place, json!(chance.wild_float())),
        5 => set(root, &place, json!(chance.below(12))),
        _ => set(root, &place, json!(chance.wild_whole())),
    }
}

fn set(root: &mut Value, place: &str, value: Value) {
    if let Some(slot) = root.pointer_mut(place) {
        *slot = value;
    }
}

/// Every value but the root, as JSON pointers.
fn collect_places(value: &Value, path: String, places: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            for (key, inner) in entries {
                let path = format!("{path}/{}", key.replace('~', "~0").replace('/', "~1"));
                places.push(path.clone());
                collect_places(inner, path, places);
            }
        }
        Value::Array(items) => {
            for (at, inner) in items.iter().enumerate() {
                let path = format!("{path}/{at}");
                places.push(path.clone());
                collect_places(inner, path, places);
            }
        }
        _ => {}
    }
    if places.is_empty() {
        places.push(path);
    }
}

/// Appends to an array, made where there is none, and returns the new item's number.
fn push(array: &mut Value, item: Value) -> usize {
    if !array.is_array() {
        *array = json!([]);
    }
    let items = array
        .as_array_mut()
        .expect("it has just been made an array");
    items.push(item);
    items.len() - 1
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let mut padded = [0; 4];
        padded[1..=group.len()].copy_from_slice(group);
        let word = u32::from_be_bytes(padded);
        for i in 0..4 {
            let symbol = ALPHABET[(word >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= group.len() { symbol.into() } else { '=' });
        }
    }
    text
}
