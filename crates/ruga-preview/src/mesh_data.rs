//! The mesh as one block of little-endian numbers.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use ruga_blend::{ArtistMesh, Driver, SmoothGroups, Weights};
use serde::Serialize;

use crate::PreviewError;

/// Place of an array in the block: its first byte, and how many numbers of four bytes it has.
pub(crate) type Section = [usize; 2];

/// Places of the arrays of a mesh.
#[derive(Debug, Serialize)]
pub(crate) struct MeshSections {
    positions: Section,
    /// `None` where the page computes normals, because the file does not say how shapes change them.
    normals: Option<Section>,
    uvs: Section,
    triangles: Section,
    groups: Section,
}

/// What a pose does to the vertices that it moves.
#[derive(Debug, Serialize)]
pub(crate) struct PoseSections {
    moved: Section,
    deltas: Section,
    normal_deltas: Option<Section>,
}

/// A mesh with its poses, in bytes.
#[derive(Debug)]
pub(crate) struct MeshData {
    pub(crate) bytes: Vec<u8>,
    pub(crate) mesh: MeshSections,
    pub(crate) poses: Vec<PoseSections>,
}

impl MeshData {
    /// Lays a mesh and its poses out; `turn` takes it into the world, Y up.
    ///
    /// Weights of shapes become one displacement per pose: poses are linear in them.
    ///
    /// # Errors
    /// [`PreviewError::Mesh`].
    pub(crate) fn new(
        artist: &ArtistMesh,
        turn: &Matrix3<f64>,
        poses: &[&BTreeMap<String, f64>],
    ) -> Result<Self, PreviewError> {
        let driver = Driver::new(artist)?;
        let weights = poses.iter().map(|pose| {
            let named = pose.iter().map(|(name, weight)| (name.as_str(), *weight));
            driver.weights(named)
        });
        let weights = weights.collect::<Result<Vec<Weights>, _>>()?;
        let mut block = Block::default();
        // With normals of the file in one pose and computed ones in the next the shading would jump.
        let normals = artist.normals.as_ref().filter(|_| {
            let mut used = weights.iter().flat_map(|pose| pose.iter());
            used.all(|(shape, weight)| {
                weight == 0.0 || artist.shapes[shape].normal_deltas.is_some()
            })
        });
        let uvs = artist.uvs.iter().flatten();
        let is_mirror = turn.determinant() < 0.0;
        let outward = |&[a, b, c]: &[u32; 3]| if is_mirror { [a, c, b] } else { [a, b, c] };
        let mesh = MeshSections {
            positions: block.vectors(artist.positions.iter().map(|p| turn * p)),
            normals: normals.map(|normals| block.vectors(normals.iter().map(|n| turn * n))),
            uvs: block.floats(uvs.flat_map(|uv| [uv.x, uv.y])),
            triangles: block.integers(artist.triangles.iter().flat_map(outward)),
            groups: block.integers(SmoothGroups::new(artist, &driver).of_vertex),
        };
        let of_pose =
            |pose: &Weights| pose_sections(&mut block, artist, turn, pose, normals.is_some());
        let poses = weights.iter().map(of_pose).collect();
        Ok(Self {
            bytes: block.bytes,
            mesh,
            poses,
        })
    }
}

fn pose_sections(
    block: &mut Block,
    artist: &ArtistMesh,
    turn: &Matrix3<f64>,
    weights: &Weights,
    with_normals: bool,
) -> PoseSections {
    let count = artist.positions.len();
    let (mut deltas, mut normal_deltas) =
        (vec![Vector3::zeros(); count], vec![Vector3::zeros(); count]);
    for (shape, weight) in weights.iter() {
        let shape = &artist.shapes[shape];
        add(&mut deltas, &shape.position_deltas, weight);
        add(
            &mut normal_deltas,
            shape.normal_deltas.as_deref().unwrap_or_default(),
            weight,
        );
    }
    let is_moved =
        |&v: &usize| deltas[v] != Vector3::zeros() || normal_deltas[v] != Vector3::zeros();
    let moved: Vec<usize> = (0..count).filter(is_moved).collect();
    let of_moved = |values: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
        moved.iter().map(|&vertex| turn * values[vertex]).collect()
    };
    PoseSections {
        moved: block.integers(moved.iter().map(|&vertex| vertex as u32)),
        deltas: block.vectors(of_moved(&deltas)),
        normal_deltas: with_normals.then(|| block.vectors(of_moved(&normal_deltas))),
    }
}

fn add(sums: &mut [Vector3<f64>], deltas: &[Vector3<f64>], weight: f64) {
    for (sum, delta) in sums.iter_mut().zip(deltas) {
        *sum += weight * delta;
    }
}

/// Arrays of four-byte numbers, one behind the other.
#[derive(Default)]
struct Block {
    bytes: Vec<u8>,
}

impl Block {
    fn vectors(&mut self, vectors: impl IntoIterator<Item = Vector3<f64>>) -> Section {
        self.floats(vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]))
    }

    fn floats(&mut self, values: impl IntoIterator<Item = f64>) -> Section {
        self.put(values.into_iter().map(|value| (value as f32).to_le_bytes()))
    }

    fn integers(&mut self, values: impl IntoIterator<Item = u32>) -> Section {
        self.put(values.into_iter().map(u32::to_le_bytes))
    }

    fn put(&mut self, numbers: impl Iterator<Item = [u8; 4]>) -> Section {
        let start = self.bytes.len();
        self.bytes.extend(numbers.flatten());
        [start, (self.bytes.len() - start) / 4]
    }
}
