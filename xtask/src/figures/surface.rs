//! A simulated layer as read back, and the material that it is made of.

use std::error::Error;
use std::path::Path;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{Driver, FaceStrain, Smoothing, SurfacePoints, face_strains};
use ruga_io::{ObjOptions, Scene, read_mesh, scene};
use ruga_mesh::{MaterialPoint, PerFace, PlanarLookup, TriMesh, barycentric};

/// A triangle mesh in space and in the texture.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Vertices that are one in space are several along seams of the texture.
    pub(super) mesh: TriMesh,
    /// Positions of the vertices, m.
    pub(super) positions: Vec<Vector3<f64>>,
    /// Texture coordinates of the vertices, V down.
    pub(super) uvs: Vec<Vector2<f64>>,
}

impl Surface {
    /// Reads a frame that `ruga simulate` wrote.
    pub(super) fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let file = read_mesh(path, None, &ObjOptions::default())?.mesh;
        let named = |reason: &str| format!("{}: {reason}", path.display());
        Ok(Self {
            mesh: TriMesh::new(file.positions.len(), file.triangles)?,
            positions: file.positions,
            uvs: file.uvs.ok_or_else(|| named("no texture coordinates"))?,
        })
    }

    /// The corners of a triangle, of whatever is known at the vertices.
    pub(super) fn corners<T: Copy>(&self, values: &[T]) -> Vec<[T; 3]> {
        let faces = self.mesh.faces().as_slice().iter();
        faces
            .map(|face| face.map(|v| values[v.0 as usize]))
            .collect()
    }
}

/// The artist's mesh at rest, looked up by texture coordinates.
pub(super) struct Material {
    driver: Driver,
    smoothing: Smoothing,
    lookup: PlanarLookup,
}

impl Material {
    /// Reads the mesh that a scene names.
    pub(super) fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let scene = Scene::read(path)?;
        let options = ObjOptions {
            targets: scene.driver.targets.clone(),
            length_unit: scene.length_unit,
        };
        let file = read_mesh(
            &scene.driver.mesh,
            scene.driver.mesh_name.as_deref(),
            &options,
        )?;
        let driver = Driver::new(&file.mesh)?;
        Ok(Self {
            lookup: PlanarLookup::new(driver.uvs().clone()),
            smoothing: match scene.driver.smoothing {
                scene::Smoothing::Loop => Smoothing::Loop,
                scene::Smoothing::None => Smoothing::None,
            },
            driver,
        })
    }

    /// Strain of every triangle against the rest surface under its vertices.
    pub(super) fn strains(&self, layer: &Surface) -> Result<PerFace<FaceStrain>, Box<dyn Error>> {
        let points = self.points(layer)?;
        let points = SurfacePoints::new(&self.driver, &points, self.smoothing);
        let rest = points.pose(self.driver.rest()).positions;
        Ok(face_strains(&layer.mesh, &rest, &layer.positions))
    }

    /// Where on the artist's mesh each vertex lies.
    fn points(&self, layer: &Surface) -> Result<Vec<MaterialPoint>, Box<dyn Error>> {
        let mut points = vec![None; layer.uvs.len()];
        for face in layer.mesh.faces().as_slice() {
            let corners = face.map(|v| layer.uvs[v.0 as usize]);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            for (vertex, uv) in face.iter().zip(corners) {
                let point = &mut points[vertex.0 as usize];
                if point.is_none() {
                    *point = self.point(uv, middle);
                }
            }
        }
        let found: Option<Vec<_>> = points.into_iter().collect();
        Ok(found.ok_or("a vertex of the layer lies outside of the artist's texture")?)
    }

    /// The place of `uv`. Files round, so that it may lie just outside of the texture's border:
    /// then the closest place on the triangle under `inside`.
    fn point(&self, uv: Vector2<f64>, inside: Vector2<f64>) -> Option<MaterialPoint> {
        self.lookup.locate(uv).or_else(|| {
            let face = self.lookup.locate(inside)?.face;
            let place = barycentric(self.driver.uvs()[face], uv)?.map(|b| b.max(0.0));
            let sum: f64 = place.iter().sum();
            Some(MaterialPoint {
                face,
                barycentric: place.map(|b| b / sum),
            })
        })
    }
}
