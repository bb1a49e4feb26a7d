//! The bytes of a GLB, and the accessors and views into them.

use gltf::json::accessor::{FLOAT, UNSIGNED_INT, UNSIGNED_SHORT};
use gltf::json::buffer::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER};
use serde_json::{Value, json};

/// One buffer being filled; every method returns the number of the accessor it made.
#[derive(Default)]
pub(crate) struct GlbBuffer {
    bytes: Vec<u8>,
    /// Views and accessors that a document has already; those made here come after them.
    views_before: usize,
    accessors_before: usize,
    pub(crate) views: Vec<Value>,
    pub(crate) accessors: Vec<Value>,
}

impl GlbBuffer {
    /// Continues the first buffer of a document that has so many views and accessors.
    pub(crate) fn after(mut bytes: Vec<u8>, views: usize, accessors: usize) -> Self {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        Self {
            bytes,
            views_before: views,
            accessors_before: accessors,
            ..Self::default()
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Vertex indices, in 16 bits where they fit: 65535 is reserved in those.
    pub(crate) fn indices(&mut self, corners: &[u32], vertices: usize) -> usize {
        let (component, bytes) = index_bytes(corners, vertices);
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view,
            "componentType": component,
            "count": corners.len(),
            "type": "SCALAR",
        }))
    }

    /// One vector per vertex.
    pub(crate) fn attribute<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let view = self.view(&float_bytes(values), Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": values.len(),
            "type": kind,
        }))
    }

    /// Positions, which must say how far they reach.
    pub(crate) fn bounded(&mut self, values: &[[f32; 3]]) -> usize {
        let number = self.attribute(values, "VEC3");
        let (min, max) = bounds(values);
        let accessor = &mut self.accessors[number - self.accessors_before];
        accessor["min"] = json!(min);
        accessor["max"] = json!(max);
        number
    }

    /// Displacements: sparse without a base where that is smaller, which every reader knows.
    pub(crate) fn deltas(&mut self, values: &[[f32; 3]]) -> usize {
        let moved = |i: &u32| values[*i as usize] != [0.0; 3];
        let mut indices: Vec<u32> = (0..values.len() as u32).filter(moved).collect();
        // A sparse accessor has at least one element.
        if indices.is_empty() {
            indices.push(0);
        }
        if indices.len() * 16 > values.len() * 12 {
            return self.bounded(values);
        }
        let changed: Vec<[f32; 3]> = indices.iter().map(|i| values[*i as usize]).collect();
        let (component, bytes) = index_bytes(&indices, values.len());
        let index_view = self.view(&bytes, None);
        let value_view = self.view(&float_bytes(&changed), None);
        let (min, max) = bounds(values);
        self.accessor(json!({
            "componentType": FLOAT,
            "count": values.len(),
            "type": "VEC3",
            "min": min,
            "max": max,
            "sparse": {
                "count": indices.len(),
                "indices": { "bufferView": index_view, "componentType": component },
                "values": { "bufferView": value_view },
            },
        }))
    }

    /// Times of an animation, ascending, s.
    pub(crate) fn times(&mut self, values: &[f32]) -> usize {
        let number = self.scalars(values);
        let accessor = &mut self.accessors[number - self.accessors_before];
        accessor["min"] = json!([values.first()]);
        accessor["max"] = json!([values.last()]);
        number
    }

    /// Numbers of an animation.
    pub(crate) fn scalars(&mut self, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        self.accessor(json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": values.len(),
            "type": "SCALAR",
        }))
    }

    /// The bytes of an image file; returns the number of their view.
    pub(crate) fn image(&mut self, bytes: &[u8]) -> usize {
        self.view(bytes, None)
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors_before + self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
        });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.bytes.extend_from_slice(bytes);
        // The next view may hold floats, which lie at multiples of four.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views_before + self.views.len() - 1
    }
}

fn index_bytes(indices: &[u32], vertices: usize) -> (u32, Vec<u8>) {
    if vertices <= usize::from(u16::MAX) {
        let bytes = indices.iter().flat_map(|i| (*i as u16).to_le_bytes());
        (UNSIGNED_SHORT, bytes.collect())
    } else {
        let bytes = indices.iter().flat_map(|i| i.to_le_bytes());
        (UNSIGNED_INT, bytes.collect())
    }
}

fn float_bytes<const N: usize>(values: &[[f32; N]]) -> Vec<u8> {
    values
        .iter()
        .flatten()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn bounds(values: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let start = values.first().copied().unwrap_or_default();
    values.iter().fold((start, start), |(min, max), value| {
        (
            std::array::from_fn(|i| min[i].min(value[i])),
            std::array::from_fn(|i| max[i].max(value[i])),
        )
    })
}
