//! The smooth surface between the artist's vertices.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{
    FaceId, FaceOrigin, Id, MaterialPoint, PerFace, SparseRows, Subdivision, Submesh, TriMesh,
    VertexId, limit_rows_at, subdivide_while, vertex_normals,
};

use crate::Driver;

/// How the surface runs between the artist's vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Smoothing {
    /// Loop subdivision.
    ///
    /// The surface is the limit of infinitely many subdivisions.
    #[default]
    Loop,
    /// Not at all.
    ///
    /// The surface is the artist's flat facets, with normals interpolated.
    None,
}

/// The base mesh: some faces of the driver, subdivided, with rows that pose it.
///
/// Its vertices lie on the limit surface, not on control points.
#[derive(Clone, Debug)]
pub struct BaseSurface {
    mesh: TriMesh,
    origins: PerFace<FaceOrigin>,
    path: PerFace<u64>,
    uvs: PerFace<[Vector2<f64>; 3]>,
    levels: u32,
    position: SparseRows,
    tangents: [SparseRows; 2],
}

/// Places of the smooth surface in one pose.
#[derive(Clone, Debug, Default)]
pub struct PosedSurface {
    /// Position of every place, m.
    pub positions: Vec<Vector3<f64>>,
    /// Unit normal of the smooth surface at every place.
    pub normals: Vec<Vector3<f64>>,
    /// Unit tangent at every place that moves with the material.
    pub tangents: Vec<Vector3<f64>>,
}

impl BaseSurface {
    /// Subdivides the driver's `faces` `levels` times.
    ///
    /// Two rings of further faces are carried along while subdividing, so that a part of a mesh
    /// gets the very positions that the whole would give it.
    ///
    /// # Panics
    /// When a face is none of the driver's, or the result would have more than
    /// [`TriMesh::MAX_COUNT`] faces: [`Self::split_count`] times four to the power of `levels`.
    pub fn new(driver: &Driver, faces: &[FaceId], levels: u32, smoothing: Smoothing) -> Self {
        Self::new_while(driver, faces, levels, smoothing, &mut || true)
            .expect("nothing ends it early")
    }

    /// Does what [`Self::new`] does as long as `goes_on`, which is asked about every half second for
    /// a million faces, agrees; `None` when it does not.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn new_while(
        driver: &Driver,
        faces: &[FaceId],
        levels: u32,
        smoothing: Smoothing,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        // A place of the limit surface depends on one ring of each level, half as wide as that of
        // the level before: on less than two rings of the driver in all.
        let part = driver
            .topology()
            .submesh(&with_rings(driver.topology(), faces, 2));
        let corners = part
            .vertices
            .as_slice()
            .iter()
            .map(|&v| driver.corners()[v]);
        let fine = subdivide_while(&part.mesh, levels, &corners.collect(), goes_on)?;
        // The rings have shaped the border by now, and go.
        let mut wanted = PerFace::filled(driver.topology().face_count(), false);
        faces.iter().for_each(|&f| wanted[f] = true);
        let own = fine.origins.iter();
        let own = own.filter(|(_, origin)| wanted[part.faces[origin.face]]);
        let own = fine.mesh.submesh(&own.map(|(f, _)| f).collect::<Vec<_>>());
        let (position, tangents) = match smoothing {
            Smoothing::Loop => loop_rows(&fine, (&part, &own), goes_on)?,
            Smoothing::None => facet_rows(&fine, (&part, &own)),
        };
        let origin_of = |f: &FaceId| FaceOrigin {
            face: part.faces[fine.origins[*f].face],
            corners: fine.origins[*f].corners,
        };
        let path_of = |f: &FaceId| {
            // Numbered as if all of the driver were subdivided, so that surfaces made for different
            // faces agree on a face that both have.
            let coarse = part.faces[fine.origins[*f].face].0 as u64;
            // A face's four children follow each other, so the low bits of its number are the way
            // down from the face of the part.
            let child = f.0 as u64 & ((1 << (2 * levels)) - 1);
            (coarse << (2 * levels)) | child
        };
        let origins: PerFace<FaceOrigin> = own.faces.as_slice().iter().map(origin_of).collect();
        goes_on().then(|| Self {
            uvs: fine_uvs(driver, &origins),
            path: own.faces.as_slice().iter().map(path_of).collect(),
            origins,
            mesh: own.mesh,
            levels,
            position,
            tangents,
        })
    }

    /// Number of the driver's faces that [`Self::new`] splits: `faces` and two rings around.
    ///
    /// # Panics
    /// When a face is none of the driver's.
    pub fn split_count(driver: &Driver, faces: &[FaceId]) -> usize {
        with_rings(driver.topology(), faces, 2).len()
    }

    /// The part of this surface made of `faces`.
    ///
    /// # Panics
    /// When a face is none of this surface's.
    pub fn restrict(&self, faces: &[FaceId]) -> Self {
        let part = self.mesh.submesh(faces);
        let rows = |rows: &SparseRows| rows.select(part.vertices.as_slice());
        Self {
            origins: part
                .faces
                .as_slice()
                .iter()
                .map(|&f| self.origins[f])
                .collect(),
            path: part
                .faces
                .as_slice()
                .iter()
                .map(|&f| self.path[f])
                .collect(),
            uvs: part.faces.as_slice().iter().map(|&f| self.uvs[f]).collect(),
            levels: self.levels,
            position: rows(&self.position),
            tangents: [rows(&self.tangents[0]), rows(&self.tangents[1])],
            mesh: part.mesh,
        }
    }

    /// Connectivity.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Place of each base face in the driver's faces.
    pub fn origins(&self) -> &PerFace<FaceOrigin> {
        &self.origins
    }

    /// Texture coordinates of the corners of every base face, V down.
    pub fn uvs(&self) -> &PerFace<[Vector2<f64>; 3]> {
        &self.uvs
    }

    /// The driver's material point under every base vertex.
    pub fn vertex_points(&self) -> Vec<MaterialPoint> {
        let vertices = (0..self.mesh.vertex_count()).map(VertexId::from_index);
        vertices
            // No vertex is lost: in a submesh each has a face.
            .filter_map(|vertex| MaterialPoint::of_vertex(&self.mesh, vertex))
            .map(|point| self.origins[point.face].place(point.barycentric))
            .collect()
    }

    /// Number of times that the driver's faces were split in four.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    /// The number that a face's ancestor at `level` has when the *whole* driver is subdivided.
    ///
    /// # Panics
    /// When `level` is above [`BaseSurface::levels`], or `face` is none of this surface's.
    pub fn ancestor(&self, face: FaceId, level: u32) -> u64 {
        assert!(level <= self.levels, "level {level} of {}", self.levels);
        self.path[face] >> (2 * (self.levels - level))
    }

    /// Positions, normals and tangents from the driver's control points (m).
    ///
    /// # Panics
    /// When there are fewer control points than the driver has vertices.
    pub fn pose(&self, control: &[Vector3<f64>]) -> PosedSurface {
        let positions = self.position.apply(control);
        let [first, second] = [0, 1].map(|i| self.tangents[i].apply(control));
        let area_normals = vertex_normals(&self.mesh, &positions);
        let mut normals = Vec::with_capacity(positions.len());
        let mut tangents = Vec::with_capacity(positions.len());
        for i in 0..positions.len() {
            // Corners and collapsed fans have no limit tangents; the faces around them must do.
            let cross = first[i].cross(&second[i]);
            let size = first[i].norm() * second[i].norm();
            let normal = if cross.norm() > 1e-6 * size {
                cross.normalize()
            } else {
                area_normals[i]
            };
            normals.push(normal);
            tangents.push(material_tangent(&first[i], &normal));
        }
        for (_, face) in self.mesh.faces().iter() {
            // A vertex without limit tangents takes its first edge as the direction it turns with.
            for corner in 0..3 {
                let v = face[corner].index();
                if tangents[v] == Vector3::zeros() {
                    let edge = positions[face[(corner + 1) % 3].index()] - positions[v];
                    tangents[v] = material_tangent(&edge, &normals[v]);
                }
            }
        }
        PosedSurface {
            positions,
            normals,
            tangents,
        }
    }
}

pub(crate) fn material_tangent(direction: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    // What is left of a direction along the normal is rounding, and would turn at random.
    let tangent = direction - normal * normal.dot(direction);
    tangent
        .try_normalize(1e-9 * direction.norm())
        .unwrap_or_else(Vector3::zeros)
}

/// `faces` and `rings` rings of vertex-neighbours, in ascending order.
fn with_rings(mesh: &TriMesh, faces: &[FaceId], rings: u32) -> Vec<FaceId> {
    let mut chosen = PerFace::filled(mesh.face_count(), false);
    faces.iter().for_each(|&f| chosen[f] = true);
    for _ in 0..rings {
        // From a copy, or the ring would run on through the faces that it has just added.
        let before = chosen.clone();
        for (face, _) in before.iter().filter(|(_, c)| **c) {
            for vertex in mesh.faces()[face] {
                mesh.vertex_faces(vertex)
                    .iter()
                    .for_each(|&f| chosen[f] = true);
            }
        }
    }
    chosen.iter().filter(|(_, c)| **c).map(|(f, _)| f).collect()
}

type BaseRows = (SparseRows, [SparseRows; 2]);

/// Rows of the limit surface at the vertices of `own`, a part of `fine`; `part` is what was
/// subdivided of the driver.
fn loop_rows(
    fine: &Subdivision,
    (part, own): (&Submesh, &Submesh),
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<BaseRows> {
    let limit = limit_rows_at(&fine.mesh, &fine.corners, own.vertices.as_slice());
    // Subdivision and limit as one product: a pose is then one sparse product with the control
    // points, whatever the levels.
    let from_driver = fine
        .fine_from_coarse
        .with_columns_at(part.vertices.as_slice());
    let mut compose = |rows: &SparseRows| goes_on().then(|| rows.after(&from_driver));
    Some((
        compose(&limit.position)?,
        [
            compose(&limit.first_tangent)?,
            compose(&limit.second_tangent)?,
        ],
    ))
}

/// Positions on the flat facets; no tangents, so that vertex normals of the faces are taken.
fn facet_rows(fine: &Subdivision, (part, own): (&Submesh, &Submesh)) -> BaseRows {
    let mut position = SparseRows::default();
    let mut empty = SparseRows::default();
    for &vertex in own.vertices.as_slice() {
        let mut terms = Vec::new();
        if let Some(point) = MaterialPoint::of_vertex(&fine.mesh, vertex) {
            let origin = &fine.origins[point.face];
            let weights = origin.lift(point.barycentric);
            for (corner, weight) in part.mesh.faces()[origin.face].iter().zip(weights) {
                if weight != 0.0 {
                    terms.push((part.vertices[*corner].0, weight));
                }
            }
        }
        position.push_row(&mut terms);
        empty.push_row(&mut []);
    }
    (position, [empty.clone(), empty])
}

fn fine_uvs(driver: &Driver, origins: &PerFace<FaceOrigin>) -> PerFace<[Vector2<f64>; 3]> {
    origins
        .as_slice()
        .iter()
        .map(|origin| {
            // Linear although positions are smooth: renderers interpolate UVs so, and an address in
            // UV has to mean the same on the artist's mesh and on this one.
            let [a, b, c] = driver.uvs()[origin.face];
            origin.corners.map(|[u, v, w]| a * u + b * v + c * w)
        })
        .collect()
}
