//! Parts of a mesh that touch at a vertex only.

use ruga_mesh::{FaceId, Id, TriMesh, VertexId};

/// The mesh with a vertex for every fan of faces, and the old vertex of every new one.
///
/// Two parts of a region that touch at a vertex only have nothing to do with each other.
pub(crate) fn one_fan_per_vertex(mesh: &TriMesh) -> (TriMesh, Vec<VertexId>) {
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for face in mesh.faces().as_slice() {
        faces.push(face.map(|v| v.0));
    }
    let mut copied: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::from_index).collect();
    for vertex in (0..mesh.vertex_count()).map(VertexId::from_index) {
        for fan in fans(mesh, vertex).into_iter().skip(1) {
            let copy = copied.len() as u32;
            copied.push(vertex);
            for face in fan {
                let corners = &mut faces[face.index()];
                let corner = corners.iter_mut().find(|corner| **corner == vertex.0);
                if let Some(corner) = corner {
                    *corner = copy;
                }
            }
        }
    }
    let split = TriMesh::new(copied.len(), faces);
    (
        split.expect("fans taken apart leave a manifold a manifold"),
        copied,
    )
}

/// The faces around a vertex, in groups that hang together by edges.
fn fans(mesh: &TriMesh, vertex: VertexId) -> Vec<Vec<FaceId>> {
    let mut left: Vec<FaceId> = mesh.vertex_faces(vertex).to_vec();
    let mut fans = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut fan = vec![first];
        left.remove(0);
        let mut next = 0;
        while next < fan.len() {
            for corner in 0..3 {
                let neighbour = mesh.neighbour(fan[next], corner);
                if let Some(at) = left.iter().position(|&f| Some(f) == neighbour) {
                    fan.push(left.remove(at));
                }
            }
            next += 1;
        }
        fans.push(fan);
    }
    fans
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that share a vertex alone come apart there, and nowhere else.
    #[test]
    fn fans_come_apart() {
        let mesh = TriMesh::new(5, vec![[0, 1, 2], [2, 3, 4]]).expect("two triangles");
        let (split, copied) = one_fan_per_vertex(&mesh);
        assert_eq!(split.vertex_count(), 6);
        assert_eq!(copied[5], VertexId(2));
        assert_eq!(split.faces().as_slice()[0].map(|v| v.0), [0, 1, 2]);
        assert_eq!(split.faces().as_slice()[1].map(|v| v.0), [5, 3, 4]);
    }
}
