//! OBJ meshes and one OBJ per blend shape.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Matrix3, Matrix4, Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape};
use tobj::{LoadError, LoadOptions, Model};

use crate::error::read_bytes;
use crate::obj_indices::check_indices;
use crate::{IoError, MeshFile, MeshPart, ObjOptions};

/// Reads the rest shape and a file per blend shape.
///
/// OBJ numbers positions, normals and texture coordinates apart; each combination that occurs
/// becomes a vertex here. Blend shapes are matched by position, before that split, so a target may
/// carry other normals or none.
pub(crate) fn read_obj(
    path: &Path,
    mesh_name: Option<&str>,
    options: &ObjOptions,
) -> Result<MeshFile, IoError> {
    let models = load(path)?;
    let models = select(path, models, mesh_name)?;
    let name = mesh_name.map_or_else(|| default_name(path, &models), str::to_owned);
    let rest = Corners::of(path, &models, options.length_unit.metres())?;
    if rest.positions.is_empty() {
        let path = path.to_owned();
        return Err(IoError::NoTriangles { path, mesh: name });
    }
    let (mut mesh, position_of_vertex) = rest.split_vertices();
    mesh.name = name;
    for (shape, file) in &options.targets {
        let target = read_target(file, mesh_name, options)?;
        let deltas = rest.deltas(file, shape, &target)?;
        mesh.shapes.push(BlendShape {
            name: shape.clone(),
            position_deltas: position_of_vertex.iter().map(|p| deltas[*p]).collect(),
            normal_deltas: None,
        });
    }
    Ok(MeshFile {
        path: path.to_owned(),
        parts: vec![MeshPart {
            vertices: 0..mesh.positions.len(),
            triangles: 0..mesh.triangles.len(),
            material: None,
        }],
        default_weights: vec![0.0; mesh.shapes.len()],
        mesh,
        stretch: Matrix3::identity(),
        world_from_node: Matrix4::identity(),
        metres_per_unit: 1.0,
        document: None,
        warnings: Vec::new(),
    })
}

/// Triangles with an index of their own into positions, normals and texture coordinates.
struct Corners {
    positions: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    uvs: Vec<Vector2<f64>>,
    /// Position, normal and texture coordinate of each corner, three in a row per triangle.
    corners: Vec<[Option<usize>; 3]>,
}

impl Corners {
    fn of(path: &Path, models: &[Model], metres: f64) -> Result<Self, IoError> {
        let mut all = Self {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            corners: Vec::new(),
        };
        for model in models {
            let mesh = &model.mesh;
            let numbers = [&mesh.positions, &mesh.normals, &mesh.texcoords];
            if numbers.into_iter().flatten().any(|n| !n.is_finite()) {
                let element = format!("object `{}`", model.name);
                let reason = "a coordinate is not a finite number";
                return Err(IoError::malformed(path, element, reason));
            }
            let (p, n, t) = (all.positions.len(), all.normals.len(), all.uvs.len());
            let shifted = |index: Option<&u32>, by: usize| index.map(|i| *i as usize + by);
            all.corners.extend((0..mesh.indices.len()).map(|i| {
                [
                    shifted(mesh.indices.get(i), p),
                    shifted(mesh.normal_indices.get(i), n),
                    shifted(mesh.texcoord_indices.get(i), t),
                ]
            }));
            let scaled = |c: &[f64]| Vector3::new(c[0], c[1], c[2]) * metres;
            all.positions
                .extend(mesh.positions.chunks_exact(3).map(scaled));
            let vector = |c: &[f64]| Vector3::new(c[0], c[1], c[2]);
            all.normals.extend(mesh.normals.chunks_exact(3).map(vector));
            // OBJ's V points up, glTF's and ours down.
            let flipped = |c: &[f64]| Vector2::new(c[0], 1.0 - c[1]);
            all.uvs.extend(mesh.texcoords.chunks_exact(2).map(flipped));
        }
        Ok(all)
    }

    /// One vertex per combination of indices, in order of first use, and each one's position.
    fn split_vertices(&self) -> (ArtistMesh, Vec<usize>) {
        let mut number_of = HashMap::new();
        let mut combinations: Vec<[Option<usize>; 3]> = Vec::new();
        let corners: Vec<u32> = self
            .corners
            .iter()
            .map(|corner| {
                *number_of.entry(*corner).or_insert_with(|| {
                    combinations.push(*corner);
                    combinations.len() as u32 - 1
                })
            })
            .collect();
        let position_of_vertex: Vec<usize> = combinations.iter().filter_map(|c| c[0]).collect();
        let normals: Option<Vec<_>> = combinations
            .iter()
            .map(|c| self.normals.get(c[1]?).copied())
            .collect();
        let uv = |c: &[Option<usize>; 3]| self.uvs.get(c[2]?).copied();
        let has_uvs = combinations.iter().any(|c| uv(c).is_some());
        let mesh = ArtistMesh {
            name: String::new(),
            positions: position_of_vertex
                .iter()
                .map(|p| self.positions[*p])
                .collect(),
            normals,
            uvs: has_uvs.then(|| {
                combinations
                    .iter()
                    .map(|c| uv(c).unwrap_or_default())
                    .collect()
            }),
            triangles: corners
                .chunks_exact(3)
                .map(|c| [c[0], c[1], c[2]])
                .collect(),
            shapes: Vec::new(),
        };
        (mesh, position_of_vertex)
    }

    /// Displacement (m) that the target adds to each position.
    fn deltas(
        &self,
        path: &Path,
        shape: &str,
        target: &Self,
    ) -> Result<Vec<Vector3<f64>>, IoError> {
        let mismatch = |reason: String| IoError::TargetMismatch {
            path: path.to_owned(),
            target: shape.to_owned(),
            reason,
        };
        let (here, rest) = (target.positions.len(), self.positions.len());
        if here != rest {
            return Err(mismatch(format!(
                "its faces use {here} positions, the rest shape's {rest}"
            )));
        }
        let (here, rest) = (target.corners.len() / 3, self.corners.len() / 3);
        if here != rest {
            return Err(mismatch(format!(
                "it has {here} triangles, the rest shape {rest}"
            )));
        }
        let differs = |(a, b): (&[Option<usize>; 3], &[Option<usize>; 3])| a[0] != b[0];
        if let Some(corner) = target.corners.iter().zip(&self.corners).position(differs) {
            let triangle = corner / 3;
            return Err(mismatch(format!(
                "triangle {triangle} joins other vertices than in the rest shape"
            )));
        }
        let pairs = target.positions.iter().zip(&self.positions);
        Ok(pairs.map(|(posed, rest)| posed - rest).collect())
    }
}

fn read_target(
    path: &Path,
    mesh_name: Option<&str>,
    options: &ObjOptions,
) -> Result<Corners, IoError> {
    let models = load(path)?;
    // Exporters often name the object after the shape: then the whole file is meant.
    let named = |model: &Model| mesh_name == Some(model.name.as_str());
    let any_named = models.iter().any(named);
    let models: Vec<Model> = models
        .into_iter()
        .filter(|model| !any_named || named(model))
        .collect();
    Corners::of(path, &models, options.length_unit.metres())
}

fn load(path: &Path) -> Result<Vec<Model>, IoError> {
    let bytes = read_bytes(path)?;
    check_indices(path, &bytes)?;
    let bytes = without_lines(&bytes);
    let options = LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    let no_materials = |_: &Path| Err(LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_materials)
        .map_err(|error| IoError::malformed(path, "OBJ", error.to_string()))?;
    let with_faces = |model: &Model| !model.mesh.indices.is_empty();
    Ok(models.into_iter().filter(with_faces).collect())
}

/// The file without its `l` elements, of which tobj makes polygons.
fn without_lines(bytes: &[u8]) -> Vec<u8> {
    let is_kept = |line: &&[u8]| {
        let mut words = line.trim_ascii_start().split(u8::is_ascii_whitespace);
        words.next() != Some(b"l")
    };
    let lines = bytes.split_inclusive(|byte| *byte == b'\n');
    lines.filter(is_kept).flatten().copied().collect()
}

/// All models, or those of one name: groups and materials split an object into several.
fn select(path: &Path, models: Vec<Model>, name: Option<&str>) -> Result<Vec<Model>, IoError> {
    let Some(name) = name else {
        return Ok(models);
    };
    let mut names: Vec<String> = models.iter().map(|model| model.name.clone()).collect();
    names.dedup();
    let selected: Vec<Model> = models.into_iter().filter(|m| m.name == name).collect();
    if selected.is_empty() {
        return Err(IoError::unknown_mesh(path, name, names));
    }
    Ok(selected)
}

/// What tobj calls an object without name.
pub(crate) const UNNAMED: &str = "unnamed_object";

/// The object's name if there is one object, else the file's.
fn default_name(path: &Path, models: &[Model]) -> String {
    let first = models.first().map_or(UNNAMED, |model| model.name.as_str());
    let alone = models.iter().all(|model| model.name == first);
    if alone && first != UNNAMED && !first.is_empty() {
        return first.to_owned();
    }
    path.file_stem().map_or_else(
        || "mesh".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
