//! glTF meshes: selection, primitives, morph targets.

use std::ops::Range;
use std::path::Path;

use gltf::json::accessor::{Accessor, Type};
use gltf::json::mesh::{Mesh, Mode, MorphTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};
use nalgebra::{Matrix3, Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape};

use crate::gltf_container::Container;
use crate::gltf_document::{GltfDocument, PartSource};
use crate::gltf_placement::{Placement, placement};
use crate::gltf_shape_names::{name_shapes, target_names};
use crate::gltf_texcoord::TexCoord;
use crate::{IoError, Material, MeshFile, MeshPart};

pub(crate) fn read_gltf(path: &Path, mesh_name: Option<&str>) -> Result<MeshFile, IoError> {
    let container = Container::read(path)?;
    let number = select_mesh(&container, mesh_name)?;
    let name = mesh_label(&container.root, number);
    let source = &container.root.meshes[number];
    let mut reader = PrimitiveReader::new(&container, number, source);
    for primitive in 0..source.primitives.len() {
        reader.read(primitive)?;
    }
    let read = reader.finish();
    let (mut mesh, mut warnings) = (read.mesh, read.warnings);
    if mesh.triangles.is_empty() {
        return Err(IoError::NoTriangles {
            path: path.to_owned(),
            mesh: name,
        });
    }
    mesh.name = name;
    name_shapes(&mut mesh, &target_names(source), &mut warnings);
    let placed = placement(&container, number)?;
    apply_stretch(&mut mesh, &placed.stretch);
    warnings.extend(placed.warnings.iter().cloned());
    let default_weights = default_weights(&placed, source, mesh.shapes.len());
    let (document, not_kept) = GltfDocument::new(container, number, read.sources);
    warnings.extend(not_kept);
    Ok(MeshFile {
        path: path.to_owned(),
        default_weights,
        mesh,
        parts: read.parts,
        stretch: placed.stretch,
        world_from_node: placed.world_from_node,
        metres_per_unit: 1.0,
        document: Some(document),
        warnings,
    })
}

/// Chooses by the mesh's name, else by the name of a node that carries it.
pub(crate) fn select_mesh(container: &Container, name: Option<&str>) -> Result<usize, IoError> {
    let root = &container.root;
    let count = root.meshes.len();
    let path = container.path.clone();
    let names: Vec<String> = (0..count).map(|i| mesh_label(root, i)).collect();
    let Some(name) = name else {
        return match count {
            0 => Err(container.malformed("meshes", "the file has none")),
            1 => Ok(0),
            _ => Err(IoError::MeshNotChosen { path, names }),
        };
    };
    let by_mesh = names.iter().position(|label| label == name);
    let by_node = root
        .nodes
        .iter()
        .filter(|node| node.name.as_deref() == Some(name))
        .filter_map(|node| node.mesh.map(|index| index.value()))
        .find(|index| *index < count);
    by_mesh
        .or(by_node)
        .ok_or_else(|| IoError::unknown_mesh(&path, name, names))
}

fn mesh_label(root: &Root, number: usize) -> String {
    let of_node = || {
        root.nodes
            .iter()
            .find(|node| node.mesh.is_some_and(|index| index.value() == number))
            .and_then(|node| node.name.clone())
    };
    let own = root.meshes[number].name.clone();
    own.or_else(of_node)
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| format!("mesh_{number}"))
}

/// Concatenates primitives; those that name the same accessors share their vertices.
struct PrimitiveReader<'a> {
    container: &'a Container,
    number: usize,
    source: &'a Mesh,
    mesh: ArtistMesh,
    parts: Vec<MeshPart>,
    sources: Vec<PartSource>,
    /// Primitives whose vertices are in `mesh`, with the vertices and the coordinates they took.
    read: Vec<(usize, Range<usize>, Option<TexCoord>)>,
    lacks_normals: bool,
    has_uvs: bool,
    lacks_uvs: bool,
    warnings: Vec<String>,
}

impl<'a> PrimitiveReader<'a> {
    fn new(container: &'a Container, number: usize, source: &'a Mesh) -> Self {
        Self {
            container,
            number,
            source,
            mesh: ArtistMesh {
                normals: Some(Vec::new()),
                uvs: Some(Vec::new()),
                ..ArtistMesh::default()
            },
            parts: Vec::new(),
            sources: Vec::new(),
            read: Vec::new(),
            lacks_normals: false,
            has_uvs: false,
            lacks_uvs: false,
            warnings: Vec::new(),
        }
    }

    fn finish(mut self) -> ReadPrimitives {
        if self.lacks_normals {
            self.mesh.normals = None;
        }
        if !self.has_uvs {
            self.mesh.uvs = None;
        } else if self.lacks_uvs {
            self.warnings.push(
                "a part of the mesh has no texture coordinates; they are taken as (0, 0) there"
                    .to_owned(),
            );
        }
        for shape in &mut self.mesh.shapes {
            shape.normal_deltas = shape
                .normal_deltas
                .take()
                .filter(|deltas| deltas.iter().any(|delta| *delta != Vector3::zeros()));
        }
        ReadPrimitives {
            mesh: self.mesh,
            parts: self.parts,
            sources: self.sources,
            warnings: self.warnings,
        }
    }

    fn read(&mut self, index: usize) -> Result<(), IoError> {
        let primitive = &self.source.primitives[index];
        let mode = match primitive.mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => return Err(self.fault(index, "its mode is unknown")),
        };
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            self.warnings.push(format!(
                "primitive {index} of mesh {} is points or lines; it is left out",
                self.number
            ));
            return Ok(());
        }
        let vertices = self.vertices(index)?;
        let corners = match primitive.indices {
            Some(indices) => {
                let role = self.role(index, "indices");
                self.container
                    .read_indices(indices, vertices.len(), &role)?
            }
            None => (0..vertices.len() as u32).collect(),
        };
        if mode == Mode::Triangles && corners.len() % 3 != 0 {
            let reason = format!("has {} corners, not a multiple of 3", corners.len());
            return Err(self.fault(index, &reason));
        }
        let first = self.mesh.triangles.len();
        let offset = vertices.start as u32;
        self.mesh.triangles.extend(
            triangles_of(mode, &corners)
                .into_iter()
                .map(|triangle| triangle.map(|corner| corner + offset)),
        );
        self.sources.push(PartSource {
            primitive: index,
            coordinates: self.coordinates(primitive),
            tangents: self.tangents(primitive),
        });
        self.parts.push(MeshPart {
            vertices,
            triangles: first..self.mesh.triangles.len(),
            material: self.material(primitive).map(keep_material),
        });
        Ok(())
    }

    fn vertices(&mut self, index: usize) -> Result<Range<usize>, IoError> {
        let primitive = &self.source.primitives[index];
        let coordinates = self.coordinates(primitive);
        let same = self.read.iter().find(|(other, _, taken)| {
            let other = &self.source.primitives[*other];
            *taken == coordinates
                && same_attributes(primitive, other)
                && same_targets(primitive, other)
        });
        if let Some((_, range, _)) = same {
            return Ok(range.clone());
        }
        let positions = attribute(primitive, Semantic::Positions)
            .ok_or_else(|| self.fault(index, "has no POSITION"))?;
        let positions = self.vectors(positions, &self.role(index, "POSITION"))?;
        let start = self.mesh.positions.len();
        let range = start..start + positions.len();
        if u32::try_from(range.end).is_err() {
            return Err(self.fault(index, "the mesh has more than 4294967295 vertices"));
        }
        self.append_normals(index, positions.len())?;
        self.append_uvs(index, coordinates.as_ref(), positions.len())?;
        self.mesh.positions.extend(positions);
        self.append_targets(index, &range)?;
        self.read.push((index, range.clone(), coordinates));
        Ok(range)
    }

    fn append_normals(&mut self, index: usize, count: usize) -> Result<(), IoError> {
        let found = attribute(&self.source.primitives[index], Semantic::Normals);
        self.lacks_normals |= found.is_none();
        let normals = self.sized_vectors(found, count, &self.role(index, "NORMAL"))?;
        self.mesh.normals.get_or_insert_default().extend(normals);
        Ok(())
    }

    fn append_uvs(
        &mut self,
        index: usize,
        coordinates: Option<&TexCoord>,
        count: usize,
    ) -> Result<(), IoError> {
        let uvs = self.mesh.uvs.get_or_insert_default();
        let Some(coordinates) = coordinates else {
            self.lacks_uvs = true;
            uvs.resize(uvs.len() + count, Vector2::zeros());
            return Ok(());
        };
        let semantic = Semantic::TexCoords(coordinates.set);
        let Some(found) = attribute(&self.source.primitives[index], semantic) else {
            return Ok(());
        };
        self.has_uvs = true;
        let role = format!(
            "TEXCOORD_{} of primitive {index} of mesh {}",
            coordinates.set, self.number
        );
        let values = self.container.read_vectors::<2>(found, Type::Vec2, &role)?;
        self.check_count(found, &role, values.len(), count)?;
        let resolved: Vec<_> = values.into_iter().map(|uv| coordinates.apply(uv)).collect();
        if resolved.iter().flatten().any(|value| !value.is_finite()) {
            let element = format!("accessor {} ({role})", found.value());
            let reason = "KHR_texture_transform makes it infinite";
            return Err(self.container.malformed(element, reason));
        }
        self.mesh.uvs.get_or_insert_default().extend(resolved);
        Ok(())
    }

    fn append_targets(&mut self, index: usize, range: &Range<usize>) -> Result<(), IoError> {
        let targets = self.source.primitives[index].targets.as_deref();
        let targets = targets.unwrap_or_default();
        if self.read.is_empty() {
            self.mesh.shapes = vec![BlendShape::default(); targets.len()];
        } else if targets.len() != self.mesh.shapes.len() {
            let (here, before) = (targets.len(), self.mesh.shapes.len());
            let reason = format!("has {here} morph targets, the primitives before it {before}");
            return Err(self.fault(index, &reason));
        }
        for (number, target) in targets.iter().enumerate() {
            let role = self.role(index, &format!("POSITION of target {number}"));
            let deltas = self.sized_vectors(target.positions, range.len(), &role)?;
            let role = self.role(index, &format!("NORMAL of target {number}"));
            let normals = self.sized_vectors(target.normals, range.len(), &role)?;
            let shape = &mut self.mesh.shapes[number];
            shape.position_deltas.extend(deltas);
            shape.normal_deltas.get_or_insert_default().extend(normals);
        }
        Ok(())
    }

    /// The first of the material's coordinate sets that the primitive has.
    fn coordinates(&self, primitive: &Primitive) -> Option<TexCoord> {
        TexCoord::candidates(self.material(primitive))
            .into_iter()
            .find(|c| attribute(primitive, Semantic::TexCoords(c.set)).is_some())
    }

    /// The file's tangents, which no result depends on: unreadable ones count as none.
    fn tangents(&self, primitive: &Primitive) -> Option<Vec<[f64; 4]>> {
        let found = attribute(primitive, Semantic::Tangents)?;
        let read = self.container.read_vectors(found, Type::Vec4, "TANGENT");
        read.ok()
    }

    fn material(&self, primitive: &Primitive) -> Option<&'a gltf::json::Material> {
        let index = primitive.material?.value();
        self.container.root.materials.get(index)
    }

    fn vectors(&self, accessor: Index<Accessor>, role: &str) -> Result<Vec<Vector3<f64>>, IoError> {
        let values = self
            .container
            .read_vectors::<3>(accessor, Type::Vec3, role)?;
        Ok(values.into_iter().map(Vector3::from).collect())
    }

    /// Reads as many vectors as there are vertices; zeros where there is no accessor.
    fn sized_vectors(
        &self,
        accessor: Option<Index<Accessor>>,
        count: usize,
        role: &str,
    ) -> Result<Vec<Vector3<f64>>, IoError> {
        let Some(accessor) = accessor else {
            return Ok(vec![Vector3::zeros(); count]);
        };
        let values = self.vectors(accessor, role)?;
        self.check_count(accessor, role, values.len(), count)?;
        Ok(values)
    }

    fn check_count(
        &self,
        accessor: Index<Accessor>,
        role: &str,
        found: usize,
        vertices: usize,
    ) -> Result<(), IoError> {
        if found == vertices {
            return Ok(());
        }
        let element = format!("accessor {} ({role})", accessor.value());
        let reason = format!("has {found} elements, POSITION has {vertices}");
        Err(self.container.malformed(element, reason))
    }

    fn role(&self, index: usize, what: &str) -> String {
        format!("{what} of primitive {index} of mesh {}", self.number)
    }

    fn fault(&self, index: usize, reason: &str) -> IoError {
        let element = format!("primitive {index} of mesh {}", self.number);
        self.container.malformed(element, reason)
    }
}

/// Primitives of a mesh, read into one.
struct ReadPrimitives {
    mesh: ArtistMesh,
    parts: Vec<MeshPart>,
    /// One per part.
    sources: Vec<PartSource>,
    warnings: Vec<String>,
}

pub(crate) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

fn same_attributes(a: &Primitive, b: &Primitive) -> bool {
    let values = |p: &Primitive| -> Vec<_> {
        p.attributes
            .iter()
            .map(|(semantic, index)| (format!("{semantic:?}"), index.value()))
            .collect()
    };
    values(a) == values(b)
}

fn same_targets(a: &Primitive, b: &Primitive) -> bool {
    let value = |index: &Option<Index<Accessor>>| index.map(|i| i.value());
    let values = |p: &Primitive| -> Vec<_> {
        p.targets
            .iter()
            .flatten()
            .map(|t: &MorphTarget| (value(&t.positions), value(&t.normals)))
            .collect()
    };
    values(a) == values(b)
}

fn triangles_of(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .map(|(i, w)| [w[0], w[1 + i % 2], w[2 - i % 2]])
            .collect(),
        Mode::TriangleFan => corners
            .windows(2)
            .skip(1)
            .map(|w| [corners[0], w[0], w[1]])
            .collect(),
        _ => corners
            .chunks_exact(3)
            .map(|c| [c[0], c[1], c[2]])
            .collect(),
    }
}

fn keep_material(material: &gltf::json::Material) -> Material {
    let look = &material.pbr_metallic_roughness;
    let unit = |value: f32| f64::from(value).clamp(0.0, 1.0);
    Material {
        name: material.name.clone(),
        base_color: look.base_color_factor.0.map(unit),
        metallic: unit(look.metallic_factor.0),
        roughness: unit(look.roughness_factor.0),
        double_sided: material.double_sided,
    }
}

/// Multiplies positions by `S` and normals by its inverse.
fn apply_stretch(mesh: &mut ArtistMesh, stretch: &Matrix3<f64>) {
    if *stretch == Matrix3::identity() {
        return;
    }
    for position in &mut mesh.positions {
        *position = stretch * *position;
    }
    for delta in mesh.shapes.iter_mut().flat_map(|s| &mut s.position_deltas) {
        *delta = stretch * *delta;
    }
    let uniform = *stretch == Matrix3::from_diagonal_element(stretch[(0, 0)]);
    let (Some(normals), false, Some(inverse)) = (&mut mesh.normals, uniform, stretch.try_inverse())
    else {
        return;
    };
    let turned = |normal: Vector3<f64>| (inverse * normal).try_normalize(0.0).unwrap_or(normal);
    for shape in &mut mesh.shapes {
        for (delta, normal) in shape.normal_deltas.iter_mut().flatten().zip(normals.iter()) {
            *delta = turned(normal + *delta) - turned(*normal);
        }
    }
    for normal in normals {
        *normal = turned(*normal);
    }
}

fn default_weights(placed: &Placement, mesh: &Mesh, shapes: usize) -> Vec<f64> {
    placed
        .weights
        .as_ref()
        .or(mesh.weights.as_ref())
        .filter(|weights| weights.len() == shapes && weights.iter().all(|w| w.is_finite()))
        .map(|weights| weights.iter().map(|w| f64::from(*w)).collect())
        .unwrap_or_else(|| vec![0.0; shapes])
}
