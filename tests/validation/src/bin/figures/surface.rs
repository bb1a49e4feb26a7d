//! A simulated layer as read back, and the material that it is made of.

use std::error::Error;
use std::path::Path;

use nalgebra::{SVector, Vector2, Vector3};
use ruga_blend::{Driver, FaceStrain, Smoothing, SurfacePoints, face_strains};
use ruga_io::{ObjOptions, read_mesh};
use ruga_mesh::{MaterialPoint, PerFace, PlanarLookup, TriMesh, barycentric};
use ruga_scene::{SceneFile, file};

/// Times the usual stretch from space to texture at which a triangle counts as torn apart.
const TORN: f64 = 5.0;

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

    /// The surface without the triangles across seams of the texture, which a mesh with one texture
    /// coordinate per vertex tears apart there.
    pub(super) fn without_torn(&self) -> Result<Self, Box<dyn Error>> {
        let stretches: Vec<f64> = self
            .corners(&self.positions)
            .into_iter()
            .zip(self.corners(&self.uvs))
            .map(|(places, uvs)| longest(&uvs) / longest(&places))
            .collect();
        let mut sorted = stretches.clone();
        sorted.sort_by(f64::total_cmp);
        let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let mut index = vec![None; self.uvs.len()];
        let (mut positions, mut uvs) = (Vec::new(), Vec::new());
        let mut kept = |v: u32| {
            let v = v as usize;
            *index[v].get_or_insert_with(|| {
                positions.push(self.positions[v]);
                uvs.push(self.uvs[v]);
                uvs.len() as u32 - 1
            })
        };
        let faces = self.mesh.faces().as_slice().iter().zip(&stretches);
        let triangles = faces
            .filter(|(_, stretch)| **stretch <= TORN * usual)
            .map(|(face, _)| face.map(|v| kept(v.0)))
            .collect();
        Ok(Self {
            mesh: TriMesh::new(uvs.len(), triangles)?,
            positions,
            uvs,
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

/// The longest side of a triangle.
fn longest<const N: usize>(corners: &[SVector<f64, N>; 3]) -> f64 {
    (0..3).fold(0.0, |length: f64, i| {
        length.max((corners[(i + 1) % 3] - corners[i]).norm())
    })
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
        let scene = SceneFile::read(path)?;
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
                file::Smoothing::Loop => Smoothing::Loop,
                file::Smoothing::None => Smoothing::None,
            },
            driver,
        })
    }

    /// Strain of every triangle against the rest surface under its vertices.
    pub(super) fn strains(&self, layer: &Surface) -> Result<PerFace<FaceStrain>, Box<dyn Error>> {
        let rest = self.rest(layer)?;
        Ok(face_strains(&layer.mesh, &rest, &layer.positions))
    }

    /// The rest surface under each vertex, m.
    pub(super) fn rest(&self, layer: &Surface) -> Result<Vec<Vector3<f64>>, Box<dyn Error>> {
        let points = self.points(layer)?;
        let points = SurfacePoints::new(&self.driver, points, self.smoothing);
        Ok(points.pose(self.driver.rest()).positions)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_across_a_seam_are_left_out() {
        // A square, and beside it a triangle whose tip is mapped to the far left.
        let places = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(Vector2::from);
        let far = [[2.0, 0.0], [2.0, 1.0]].map(Vector2::from);
        let positions: Vec<_> = places.iter().chain(&far).map(|p| p.push(0.0)).collect();
        let uvs = [
            places.to_vec(),
            far.map(|p| p - Vector2::x() * 20.0).to_vec(),
        ]
        .concat();
        let triangles = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3]];
        let surface = Surface {
            mesh: TriMesh::new(6, triangles).unwrap(),
            positions,
            uvs,
        };
        let whole = surface.without_torn().unwrap();
        assert_eq!(whole.mesh.faces().as_slice().len(), 2);
        assert_eq!([whole.uvs.len(), whole.positions.len()], [4, 4]);
    }
}
