//! The welded control mesh that blend shapes move.

use std::iter;

use nalgebra::{SVector, Vector2, Vector3};
use ruga_mesh::{
    FaceId, Id, MeshError, PerFace, PerVertex, TriMesh, VertexId, Weld, sharp_border_corners, weld,
};

use crate::{ArtistMesh, BlendError, nearest};

/// Finite weights of some blend shapes of a [`Driver`], which makes them by [`Driver::weights`];
/// `x(w) = rest + sum w_i delta_i` (Li 2014, 5.3). The default is the rest pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights(Vec<(usize, f64)>);

impl Weights {
    /// All weights times `factor`: the pose on its way in.
    ///
    /// # Panics
    /// When `factor` is not finite.
    pub fn scaled(&self, factor: f64) -> Self {
        assert!(factor.is_finite(), "weights times {factor}");
        Self(self.0.iter().map(|&(i, w)| (i, w * factor)).collect())
    }

    /// Indices of the shapes, in the order of [`Driver::shape_names`], each with its weight.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (usize, f64)> + '_ {
        self.0.iter().copied()
    }
}

/// The artist's mesh, welded, with its blend shapes.
///
/// Vertices that the file splits along UV seams are one vertex here: same rest position *and* same
/// deltas, so that lips which touch at rest stay apart.
#[derive(Clone, Debug)]
pub struct Driver {
    name: String,
    topology: TriMesh,
    rest: Vec<Vector3<f64>>,
    shapes: Vec<Shape>,
    uvs: PerFace<[Vector2<f64>; 3]>,
    triangles: PerFace<u32>,
    corners: PerVertex<bool>,
    degenerate: Vec<u32>,
    welded: Vec<VertexId>,
}

#[derive(Clone, Debug)]
struct Shape {
    name: String,
    deltas: Vec<Vector3<f64>>,
}

impl Driver {
    /// Welds the mesh and checks it.
    ///
    /// Triangles without area are left out; [`Driver::degenerate_triangles`] lists them.
    ///
    /// # Errors
    /// Any [`BlendError`] but `UnknownShape` and `WeightNotFinite`.
    pub fn new(artist: &ArtistMesh) -> Result<Self, BlendError> {
        check_arrays(artist)?;
        let Some(uvs) = &artist.uvs else {
            return Err(BlendError::MissingUvs {
                mesh: artist.name.clone(),
            });
        };
        // Rest and deltas together: lips that touch at rest part in some shape, and must not be
        // sewn up.
        let deltas = artist.shapes.iter().map(|shape| &shape.position_deltas[..]);
        let columns: Vec<_> = iter::once(&artist.positions[..]).chain(deltas).collect();
        let Weld {
            vertices: welded,
            points,
        } = weld(&columns);
        let gather = |values: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
            points.iter().map(|&v| values[v]).collect()
        };
        let rest = gather(&artist.positions);
        // Before the topology is built: a triangle that welding has closed would be a face with a
        // vertex twice.
        let (kept, degenerate) = split_degenerate(artist, &welded);
        if kept.is_empty() {
            return Err(BlendError::NoTriangles {
                mesh: artist.name.clone(),
            });
        }
        let corners_of = |t: u32| artist.triangles[t as usize];
        let faces = kept
            .iter()
            .map(|&t| corners_of(t).map(|v| welded[v as usize].0))
            .collect();
        let topology = TriMesh::new(rest.len(), faces).map_err(|source| BlendError::Topology {
            mesh: artist.name.clone(),
            source: with_file_numbers(source, &kept),
        })?;
        let shapes = artist
            .shapes
            .iter()
            .map(|shape| Shape {
                name: shape.name.clone(),
                deltas: gather(&shape.position_deltas),
            })
            .collect();
        Ok(Self {
            name: artist.name.clone(),
            // Judged at rest, once: corners that came and went with the pose would make the surface
            // jump.
            corners: sharp_border_corners(&topology, &rest),
            uvs: kept
                .iter()
                .map(|&t| corners_of(t).map(|v| uvs[v as usize]))
                .collect(),
            triangles: kept.into(),
            topology,
            rest,
            shapes,
            degenerate,
            welded,
        })
    }

    /// Name of the mesh.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Connectivity of the welded mesh.
    pub fn topology(&self) -> &TriMesh {
        &self.topology
    }

    /// Welded rest positions, m.
    pub fn rest(&self) -> &[Vector3<f64>] {
        &self.rest
    }

    /// Texture coordinates of the corners of every face, V down.
    pub fn uvs(&self) -> &PerFace<[Vector2<f64>; 3]> {
        &self.uvs
    }

    /// The driver with other texture coordinates: what `place` makes of those of each face, V down.
    pub fn with_uvs(mut self, place: impl Fn(&[Vector2<f64>; 3]) -> [Vector2<f64>; 3]) -> Self {
        self.uvs = self.uvs.as_slice().iter().map(place).collect();
        self
    }

    /// The file's triangle of every face.
    pub fn triangles(&self) -> &PerFace<u32> {
        &self.triangles
    }

    /// The file's triangles without area, which no face stands for.
    pub fn degenerate_triangles(&self) -> &[u32] {
        &self.degenerate
    }

    /// The welded vertex of every vertex of the file.
    pub fn welded(&self) -> &[VertexId] {
        &self.welded
    }

    /// Positions (m) of the file's vertices from those of the welded ones.
    ///
    /// # Panics
    /// When there is not one position per welded vertex.
    pub fn unweld(&self, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.welded.iter().map(|v| positions[v.index()]).collect()
    }

    /// Vertices that stay sharp under subdivision.
    pub fn corners(&self) -> &PerVertex<bool> {
        &self.corners
    }

    /// Names of the blend shapes, in order.
    pub fn shape_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.shapes.iter().map(|shape| shape.name.as_str())
    }

    /// Resolves shape names. A shape that is named twice gets the sum.
    ///
    /// # Errors
    /// [`BlendError::UnknownShape`] with the nearest name there is;
    /// [`BlendError::WeightNotFinite`].
    pub fn weights<'a>(
        &self,
        named: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Weights, BlendError> {
        named
            .into_iter()
            .map(|(name, weight)| {
                let index = self.shape_names().position(|n| n == name);
                let index = index.ok_or_else(|| self.unknown_shape(name))?;
                if !weight.is_finite() {
                    return Err(BlendError::WeightNotFinite {
                        name: name.to_owned(),
                        value: weight,
                    });
                }
                Ok((index, weight))
            })
            .collect::<Result<_, _>>()
            .map(Weights)
    }

    fn unknown_shape(&self, name: &str) -> BlendError {
        BlendError::UnknownShape {
            name: name.to_owned(),
            nearest: nearest(name, self.shape_names()),
            available: self.shapes.len(),
        }
    }

    /// Posed control points, m, one per welded vertex.
    ///
    /// # Panics
    /// When `weights` were made by another driver and name a shape that this one does not have.
    pub fn pose(&self, weights: &Weights) -> Vec<Vector3<f64>> {
        let mut posed = self.rest.clone();
        for (shape, weight) in weights.iter() {
            for (point, delta) in posed.iter_mut().zip(&self.shapes[shape].deltas) {
                *point += delta * weight;
            }
        }
        posed
    }
}

fn check_arrays(artist: &ArtistMesh) -> Result<(), BlendError> {
    let expected = artist.positions.len();
    check_array(artist, "position", &artist.positions)?;
    if let Some(normals) = &artist.normals {
        check_array(artist, "normal", normals)?;
    }
    for shape in &artist.shapes {
        check_array(artist, &shape.name, &shape.position_deltas)?;
        if let Some(deltas) = &shape.normal_deltas {
            check_array(artist, &format!("normal delta of {}", shape.name), deltas)?;
        }
    }
    if let Some(uvs) = &artist.uvs {
        check_array(artist, "texture coordinate", uvs)?;
    }
    // Checked in the file's numbers, by which welding and gathering index.
    for (face, triangle) in artist.triangles.iter().enumerate() {
        if let Some(&vertex) = triangle.iter().find(|&&v| v as usize >= expected) {
            return Err(BlendError::Topology {
                mesh: artist.name.clone(),
                source: MeshError::VertexOutOfRange {
                    face: FaceId::from_index(face),
                    vertex: VertexId(vertex),
                    count: expected,
                },
            });
        }
    }
    Ok(())
}

/// Accepts an array of one finite vector per vertex.
fn check_array<const N: usize>(
    artist: &ArtistMesh,
    what: &str,
    values: &[SVector<f64, N>],
) -> Result<(), BlendError> {
    let expected = artist.positions.len();
    if values.len() != expected {
        return Err(BlendError::Length {
            mesh: artist.name.clone(),
            what: what.to_owned(),
            found: values.len(),
            expected,
        });
    }
    match values.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
        None => Ok(()),
        Some(vertex) => Err(BlendError::NotFinite {
            mesh: artist.name.clone(),
            what: what.to_owned(),
            vertex,
        }),
    }
}

/// A triangle's area below this share of its longest side squared counts as none.
const MIN_RELATIVE_AREA: f64 = 1e-10;

fn split_degenerate(artist: &ArtistMesh, welded: &[VertexId]) -> (Vec<u32>, Vec<u32>) {
    (0..artist.triangles.len() as u32).partition(|&t| {
        let corners = artist.triangles[t as usize];
        let [a, b, c] = corners.map(|v| artist.positions[v as usize]);
        let [i, j, k] = corners.map(|v| welded[v as usize]);
        let longest = (b - a)
            .norm_squared()
            .max((c - b).norm_squared())
            .max((a - c).norm_squared());
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        // Corners may be one vertex after welding although the file keeps them apart. The area is
        // relative to a side, so that the unit of the file does not matter.
        i != j && j != k && k != i && area > MIN_RELATIVE_AREA * longest
    })
}

/// The error, in the file's triangle numbers.
fn with_file_numbers(error: MeshError, kept: &[u32]) -> MeshError {
    // Triangles without area were left out, so faces are counted differently from the file.
    let renumber = |face: FaceId| FaceId(kept[face.index()]);
    match error {
        MeshError::DuplicateFaces { first, second } => MeshError::DuplicateFaces {
            first: renumber(first),
            second: renumber(second),
        },
        MeshError::NonManifoldEdge {
            vertices,
            face,
            count,
        } => MeshError::NonManifoldEdge {
            vertices,
            face: renumber(face),
            count,
        },
        MeshError::InconsistentWinding {
            first,
            second,
            vertices,
        } => MeshError::InconsistentWinding {
            first: renumber(first),
            second: renumber(second),
            vertices,
        },
        other => other,
    }
}
