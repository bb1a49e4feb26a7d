//! Material points: their texture coordinates, and whether they lie on a border.

use nalgebra::Vector2;
use ruga_blend::Driver;
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, TriMesh};

/// Barycentric weight under which a place lies on the opposite edge.
const ON_EDGE: f64 = 1e-9;

/// Texture coordinate of a place of the driver.
pub(crate) fn uv(driver: &Driver, place: &MaterialPoint) -> Vector2<f64> {
    let face: FaceId = place.face;
    let [a, b, c] = driver.uvs()[face];
    let [u, v, w] = place.barycentric;
    a * u + b * v + c * w
}

/// Whether a place lies on the border of its mesh. On an edge or a vertex in the middle nothing is
/// beside the mesh, however much the facets' normals there differ from the surface's.
pub(crate) fn is_on_border(
    mesh: &TriMesh,
    border: &PerVertex<bool>,
    place: &MaterialPoint,
) -> bool {
    let corners = mesh.faces()[place.face];
    let weight = |corner: usize| place.barycentric[corner % 3];
    (0..3).any(|corner| {
        let on_edge = weight(corner + 2) < ON_EDGE;
        let at_vertex = on_edge && weight(corner + 1) < ON_EDGE;
        on_edge && mesh.neighbour(place.face, corner).is_none()
            || at_vertex && border[corners[corner]]
    })
}
