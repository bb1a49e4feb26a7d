//! Whether a glTF document was written back as it came.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;
use serde_json::value::RawValue;

/// A document with its fields as text, and its binary chunk.
struct Parts {
    fields: BTreeMap<String, Box<RawValue>>,
    binary: Vec<u8>,
}

fn parts(path: &Path) -> Parts {
    let bytes = fs::read(path).unwrap();
    if !bytes.starts_with(b"glTF") {
        let fields = serde_json::from_slice(&bytes).unwrap();
        let binary = Vec::new();
        return Parts { fields, binary };
    }
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(word(8), bytes.len());
    let json = 20..20 + word(12);
    let binary = bytes.get(json.end + 8..).unwrap_or_default().to_owned();
    Parts {
        fields: serde_json::from_slice(&bytes[json]).unwrap(),
        binary,
    }
}

impl Parts {
    fn elements(&self, name: &str) -> Vec<String> {
        let Some(text) = self.fields.get(name) else {
            return Vec::new();
        };
        let elements: Vec<Box<RawValue>> = serde_json::from_str(text.get()).unwrap();
        elements.iter().map(|e| e.get().to_owned()).collect()
    }

    fn values(&self, name: &str) -> Vec<Value> {
        let elements = self.elements(name);
        let values = elements.iter().map(|e| serde_json::from_str(e).unwrap());
        values.collect()
    }

    /// The bytes of a view into the binary chunk.
    fn view(&self, number: &Value) -> &[u8] {
        let view = &self.values("bufferViews")[number.as_u64().unwrap() as usize];
        assert_eq!(view["buffer"], 0);
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        &self.binary[start..start + view["byteLength"].as_u64().unwrap() as usize]
    }
}

/// Compares a written GLB with the file it came from: the text of every element, the bytes of every
/// buffer and image. Of `mesh` the attributes `TANGENT` and `NORMAL` and the list of maps may be new.
#[track_caller]
pub(crate) fn assert_carried(from: &Path, to: &Path, mesh: usize) {
    let (old, new) = (parts(from), parts(to));
    for (name, text) in &old.fields {
        match name.as_str() {
            "accessors" | "bufferViews" => {
                let (before, after) = (old.elements(name), new.elements(name));
                assert_eq!(after[..before.len()], before, "{name}");
            }
            "buffers" => assert_buffers(from, &old, &new),
            "images" => assert_images(from, &old, &new),
            "meshes" => assert_meshes(&old, &new, mesh),
            _ => assert_eq!(new.fields[name].get(), text.get(), "{name}"),
        }
    }
    let names: Vec<&String> = new
        .fields
        .keys()
        .filter(|n| !old.fields.contains_key(*n))
        .collect();
    assert_eq!(names, [""; 0], "nothing else is there");
}

fn assert_buffers(from: &Path, old: &Parts, new: &Parts) {
    let (before, after) = (old.values("buffers"), new.values("buffers"));
    assert_eq!(before.len(), after.len());
    assert_eq!(after[0]["byteLength"], new.binary.len());
    for (number, (before, after)) in before.iter().zip(&after).enumerate() {
        let is_file = |uri: &&str| !uri.starts_with("data:");
        let file = before["uri"].as_str().filter(is_file);
        if let (0, Some(file)) = (number, file) {
            let bytes = fs::read(from.with_file_name(file)).unwrap();
            assert!(new.binary.starts_with(&bytes), "buffer 0");
        } else if number == 0 && before["uri"].is_null() {
            let length = before["byteLength"].as_u64().unwrap() as usize;
            assert!(new.binary.starts_with(&old.binary[..length]), "buffer 0");
        } else if file.is_some() {
            assert!(after["uri"].as_str().unwrap().starts_with("data:"));
        }
        assert!(number > 0 || after.get("uri").is_none());
        assert_eq!(before.get("name"), after.get("name"));
    }
}

fn assert_images(from: &Path, old: &Parts, new: &Parts) {
    let (before, after) = (old.elements("images"), new.elements("images"));
    for (before, after) in before.into_iter().zip(after) {
        if before == after {
            continue;
        }
        let mut before: Value = serde_json::from_str(&before).unwrap();
        let mut after: Value = serde_json::from_str(&after).unwrap();
        let file = before.as_object_mut().unwrap().remove("uri").unwrap();
        let bytes = fs::read(from.with_file_name(file.as_str().unwrap())).unwrap();
        let view = after.as_object_mut().unwrap().remove("bufferView").unwrap();
        assert!(new.view(&view) == bytes, "{file} has other bytes");
        before["mimeType"] = after["mimeType"].clone();
        assert_eq!(before, after);
    }
}

fn assert_meshes(old: &Parts, new: &Parts, mesh: usize) {
    let (before, after) = (old.elements("meshes"), new.elements("meshes"));
    for (number, (before, after)) in before.iter().zip(&after).enumerate() {
        if number != mesh {
            assert_eq!(before, after, "mesh {number}");
            continue;
        }
        let before: Value = serde_json::from_str(before).unwrap();
        let mut after: Value = serde_json::from_str(after).unwrap();
        let primitives = after["primitives"].as_array_mut().unwrap();
        for (before, after) in before["primitives"]
            .as_array()
            .unwrap()
            .iter()
            .zip(primitives)
        {
            for added in ["TANGENT", "NORMAL"] {
                if before["attributes"].get(added).is_none() {
                    after["attributes"].as_object_mut().unwrap().remove(added);
                }
            }
        }
        if let Some(extras) = after.get_mut("extras").and_then(Value::as_object_mut) {
            extras.remove("wrinkleMaps");
            if extras.is_empty() && before.get("extras").is_none() {
                after.as_object_mut().unwrap().remove("extras");
            }
        }
        assert_eq!(before, after, "mesh {number}");
    }
    assert_eq!(before.len(), after.len());
}
