//! Reading accessors, with every number checked before it is used.
//!
//! The gltf crate's own iterators trust the file: they panic on sparse accessors that run short
//! and read strides that reach outside their view. So the bytes are decoded here.

use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::Checked;
use gltf::json::{Index, accessor};

use crate::IoError;
use crate::gltf_container::Container;

/// Elements that an accessor without bytes of its own may claim; more is a damaged count.
const MOST_UNBACKED: usize = 1 << 24;

/// Layout of the bytes of an accessor.
#[derive(Clone, Copy)]
struct Layout {
    component: ComponentType,
    normalized: bool,
    width: usize,
}

impl Layout {
    fn element_size(self) -> usize {
        self.component.size() * self.width
    }
}

impl Container {
    /// Vectors of floats or (KHR_mesh_quantization) integers; all values finite.
    ///
    /// `role` says what the accessor is for, in messages.
    pub(crate) fn read_vectors<const N: usize>(
        &self,
        index: Index<Accessor>,
        shape: Type,
        role: &str,
    ) -> Result<Vec<[f64; N]>, IoError> {
        let reader = AccessorReader::new(self, index, role)?;
        let layout = reader.layout(shape)?;
        if layout.component == ComponentType::U32 {
            return Err(reader.fault("unsigned 32-bit integers are for indices only"));
        }
        let flat = reader.values(layout)?;
        Ok(flat
            .chunks_exact(N)
            .map(|chunk| std::array::from_fn(|i| chunk[i]))
            .collect())
    }

    /// Vertex indices, each below `vertices`.
    pub(crate) fn read_indices(
        &self,
        index: Index<Accessor>,
        vertices: usize,
        role: &str,
    ) -> Result<Vec<u32>, IoError> {
        let reader = AccessorReader::new(self, index, role)?;
        let layout = reader.layout(Type::Scalar)?;
        let unsigned = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        if !unsigned.contains(&layout.component) || layout.normalized {
            return Err(reader.fault("indices must be unsigned integers, not normalized"));
        }
        let indices: Vec<u32> = reader.values(layout)?.iter().map(|i| *i as u32).collect();
        match indices.iter().position(|i| *i as usize >= vertices) {
            Some(at) => Err(reader.fault(format!(
                "index {at} is {}, but there are {vertices} vertices",
                indices[at]
            ))),
            None => Ok(indices),
        }
    }
}

struct AccessorReader<'a> {
    container: &'a Container,
    accessor: &'a Accessor,
    element: String,
}

impl<'a> AccessorReader<'a> {
    fn new(container: &'a Container, index: Index<Accessor>, role: &str) -> Result<Self, IoError> {
        let element = format!("accessor {} ({role})", index.value());
        match container.root.accessors.get(index.value()) {
            Some(accessor) => Ok(Self {
                container,
                accessor,
                element,
            }),
            None => {
                let count = container.root.accessors.len();
                let reason = format!("does not exist; the file has {count} accessors");
                Err(container.malformed(element, reason))
            }
        }
    }

    fn fault(&self, reason: impl Into<String>) -> IoError {
        self.container.malformed(self.element.clone(), reason)
    }

    fn layout(&self, shape: Type) -> Result<Layout, IoError> {
        match (self.accessor.component_type, self.accessor.type_) {
            (Checked::Valid(component), Checked::Valid(found)) if found == shape => Ok(Layout {
                component: component.0,
                normalized: self.accessor.normalized,
                width: shape.multiplicity(),
            }),
            (Checked::Valid(_), Checked::Valid(found)) => {
                Err(self.fault(format!("its type is {found:?}, expected {shape:?}")))
            }
            _ => Err(self.fault("its type or componentType is unknown")),
        }
    }

    /// All components of all elements in a row.
    fn values(&self, layout: Layout) -> Result<Vec<f64>, IoError> {
        let count = self.count(self.accessor.count.0)?;
        let mut values = match self.accessor.buffer_view {
            Some(view) => {
                let offset = self.accessor.byte_offset.unwrap_or_default().0;
                self.block(view, offset, count, layout, true)?
            }
            None if count > MOST_UNBACKED => {
                return Err(self.fault(format!("count {count} without a bufferView")));
            }
            None => vec![0.0; count * layout.width],
        };
        if let Some(sparse) = &self.accessor.sparse {
            self.apply_sparse(sparse, layout, count, &mut values)?;
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(self.fault(format!(
                "element {} is {}; numbers must be finite",
                at / layout.width,
                values[at]
            ))),
            None => Ok(values),
        }
    }

    fn apply_sparse(
        &self,
        sparse: &accessor::sparse::Sparse,
        layout: Layout,
        count: usize,
        values: &mut [f64],
    ) -> Result<(), IoError> {
        let changed = self.count(sparse.count.0)?;
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(self.fault("the componentType of its sparse indices is unknown"));
        };
        let index_layout = Layout {
            component: component.0,
            normalized: false,
            width: 1,
        };
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
        let indices = self.block(view, offset, changed, index_layout, false)?;
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
        let replacements = self.block(view, offset, changed, layout, false)?;
        let mut least = 0;
        for (index, replacement) in indices.iter().zip(replacements.chunks_exact(layout.width)) {
            let index = *index as usize;
            if index < least {
                return Err(self.fault("its sparse indices do not strictly increase"));
            }
            if index >= count {
                return Err(self.fault(format!("sparse index {index}, but count is {count}")));
            }
            least = index + 1;
            values[index * layout.width..][..layout.width].copy_from_slice(replacement);
        }
        Ok(())
    }

    fn count(&self, count: u64) -> Result<usize, IoError> {
        // Vertices are numbered with 32 bits throughout.
        u32::try_from(count)
            .ok()
            .filter(|count| *count > 0)
            .map(|count| count as usize)
            .ok_or_else(|| self.fault(format!("count is {count}; accepted: 1 to 4294967295")))
    }

    fn block(
        &self,
        view: Index<View>,
        offset: u64,
        count: usize,
        layout: Layout,
        strided: bool,
    ) -> Result<Vec<f64>, IoError> {
        let (bytes, stride) = self.view(view)?;
        let size = layout.element_size();
        let stride = stride.filter(|_| strided).unwrap_or(size);
        if stride < size || stride > 252 {
            return Err(self.fault(format!("byteStride {stride}, elements have {size} bytes")));
        }
        let needed = (count as u64 - 1) * stride as u64 + size as u64;
        let available = (bytes.len() as u64).checked_sub(offset);
        if available.is_none_or(|available| available < needed) {
            return Err(self.fault(format!(
                "needs {needed} bytes from offset {offset} of bufferView {}, which has {}",
                view.value(),
                bytes.len()
            )));
        }
        let bytes = &bytes[offset as usize..];
        let mut values = Vec::with_capacity(count * layout.width);
        for element in 0..count {
            let element = &bytes[element * stride..][..size];
            values.extend(
                element
                    .chunks_exact(layout.component.size())
                    .map(|component| decode(component, layout)),
            );
        }
        Ok(values)
    }

    fn view(&self, index: Index<View>) -> Result<(&'a [u8], Option<usize>), IoError> {
        let number = index.value();
        let view = self
            .container
            .root
            .buffer_views
            .get(number)
            .ok_or_else(|| self.fault(format!("bufferView {number} does not exist")))?;
        let buffer = view.buffer.value();
        let bytes = self
            .container
            .buffers
            .get(buffer)
            .ok_or_else(|| self.fault(format!("buffer {buffer} does not exist")))?;
        let start = view.byte_offset.unwrap_or_default().0;
        let range = start
            .checked_add(view.byte_length.0)
            .filter(|end| *end <= bytes.len() as u64)
            .map(|end| start as usize..end as usize);
        match range {
            Some(range) => Ok((&bytes[range], view.byte_stride.map(|stride| stride.0))),
            None => Err(self.fault(format!(
                "bufferView {number} reaches past the {} bytes of buffer {buffer}",
                bytes.len()
            ))),
        }
    }
}

/// One component; `bytes` has exactly its size.
fn decode(bytes: &[u8], layout: Layout) -> f64 {
    let (value, largest) = match (layout.component, bytes) {
        (ComponentType::I8, &[a]) => (f64::from(a as i8), f64::from(i8::MAX)),
        (ComponentType::U8, &[a]) => (f64::from(a), f64::from(u8::MAX)),
        (ComponentType::I16, &[a, b]) => {
            (f64::from(i16::from_le_bytes([a, b])), f64::from(i16::MAX))
        }
        (ComponentType::U16, &[a, b]) => {
            (f64::from(u16::from_le_bytes([a, b])), f64::from(u16::MAX))
        }
        (ComponentType::U32, &[a, b, c, d]) => (
            f64::from(u32::from_le_bytes([a, b, c, d])),
            f64::from(u32::MAX),
        ),
        (ComponentType::F32, &[a, b, c, d]) => {
            return f64::from(f32::from_le_bytes([a, b, c, d]));
        }
        _ => unreachable!("chunks have the size of one component"),
    };
    if layout.normalized {
        (value / largest).max(-1.0)
    } else {
        value
    }
}
