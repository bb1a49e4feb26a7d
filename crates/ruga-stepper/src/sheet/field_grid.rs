//! The mesh of temperature and fuel: that of the sheet, each of its triangles divided evenly.

use nalgebra::{Vector2, Vector3};
use ruga_blend::Driver;
use ruga_mesh::{FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh, face_areas, split_edges};

use crate::ArtistPlace;
use crate::skin::skin_mesh::RegionMesh;

/// A sheet's mesh with its triangles divided into four as often as the front needs.
///
/// That one lies in the other keeps mass and fuel the same on both: means over a triangle of the sheet are exact.
pub(super) struct FieldGrid {
    pub(super) mesh: TriMesh,
    /// Rest positions on the triangles of the sheet, m.
    pub(super) rest: Vec<Vector3<f64>>,
    /// Rest areas, m².
    pub(super) areas: PerFace<f64>,
    /// Where every vertex lies in the sheet's mesh.
    pub(super) places: Vec<MaterialPoint>,
    /// Where every face lies in the sheet's mesh, ascending.
    pub(super) origins: PerFace<FaceOrigin>,
    /// Texture coordinates of every face's corners.
    pub(super) uvs: Vec<[Vector2<f64>; 3]>,
    /// The file's triangle under every face, and its corners' places there.
    pub(super) artist: Vec<ArtistPlace>,
}

/// Barycentric coordinates in a triangle of a place that is given in another one, whose corners lie there in `corners`.
pub(super) fn lifted([u, v, w]: [f64; 3], corners: &[[f64; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = corners;
    std::array::from_fn(|i| u * a[i] + v * b[i] + w * c[i])
}

/// How often edges are to be halved so that their mean is at most `wanted`.
pub(super) fn levels(mean_edge: f64, wanted: f64) -> u32 {
    (mean_edge / wanted).log2().ceil().max(0.0) as u32
}

impl FieldGrid {
    pub(super) fn new(driver: &Driver, region: &RegionMesh, levels: u32) -> Self {
        let coarse = &region.skin.mesh;
        let mut rest = region.skin.rest.positions.clone();
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let whole = |face| FaceOrigin { face, corners };
        let mut mesh = coarse.clone();
        let mut origins: PerFace<FaceOrigin> = coarse.faces().ids().map(whole).collect();
        for _ in 0..levels {
            let halves = vec![Some(0.5); mesh.edges().len()];
            let split = split_edges(&mesh, &halves, &mut rest);
            let children = split.origins.as_slice().iter();
            origins = children
                .map(|child| FaceOrigin {
                    face: origins[child.face].face,
                    corners: child.corners.map(|corner| origins[child.face].lift(corner)),
                })
                .collect();
            mesh = split.mesh;
        }
        let nowhere = MaterialPoint {
            face: FaceId(0),
            barycentric: corners[0],
        };
        let mut places = vec![nowhere; mesh.vertex_count()];
        // Backwards, so that a vertex between triangles gets the first of them.
        for (face, vertices) in mesh.faces().iter().collect::<Vec<_>>().into_iter().rev() {
            let origin = &origins[face];
            for (v, barycentric) in vertices.iter().zip(origin.corners) {
                places[v.index()] = MaterialPoint {
                    face: origin.face,
                    barycentric,
                };
            }
        }
        let results = region.shown(driver);
        let shown = &results.uvs;
        let uvs = origins.as_slice().iter().map(|origin| {
            let [a, b, c] = shown[origin.face.index()];
            origin.corners.map(|[u, v, w]| a * u + b * v + c * w)
        });
        let under = &results.artist;
        let artist = origins.as_slice().iter().map(|origin| {
            let (triangle, corners) = &under[origin.face.index()];
            (
                *triangle,
                origin.corners.map(|place| lifted(place, corners)),
            )
        });
        Self {
            areas: face_areas(&mesh, &rest),
            uvs: uvs.collect(),
            artist: artist.collect(),
            mesh,
            rest,
            places,
            origins,
        }
    }

    /// Values at the vertices from those at the vertices of the sheet's mesh.
    pub(super) fn interpolated(
        &self,
        coarse: &TriMesh,
        values: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let at = |place: &MaterialPoint| {
            let [a, b, c] = coarse.faces()[place.face].map(|v| values[v.index()]);
            let [u, v, w] = place.barycentric;
            a * u + b * v + c * w
        };
        self.places.iter().map(at).collect()
    }

    /// A texture coordinate of every vertex: of one of its faces.
    pub(super) fn vertex_uvs(&self) -> Vec<Vector2<f64>> {
        let mut uvs = vec![Vector2::zeros(); self.mesh.vertex_count()];
        for ((_, vertices), corners) in self.mesh.faces().iter().zip(&self.uvs) {
            for (v, uv) in vertices.iter().zip(corners) {
                uvs[v.index()] = *uv;
            }
        }
        uvs
    }
}
