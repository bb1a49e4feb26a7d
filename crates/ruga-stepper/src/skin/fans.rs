//! Parts of a mesh that touch at a vertex only.

use ruga_mesh::{Id, TriMesh, VertexFan, VertexId};

/// The mesh with a vertex for every fan of faces, and the old vertex of every new one.
///
/// Two parts of a region that touch at a vertex only have nothing to do with each other.
pub(crate) fn one_fan_per_vertex(mesh: &TriMesh) -> (TriMesh, Vec<VertexId>) {
    let mut copied: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::from_index).collect();
    let mut fans = VertexFan::all(mesh);
    // Most vertices have one fan, which has all of their faces.
    fans.retain(|fan| fan.faces.len() < mesh.vertex_faces(fan.vertex).len());
    if fans.is_empty() {
        return (mesh.clone(), copied);
    }
    fans.sort_by_key(|fan| fan.vertex);
    let faces = mesh.faces().as_slice().iter();
    let mut faces: Vec<[u32; 3]> = faces.map(|face| face.map(|v| v.0)).collect();
    for pair in fans.windows(2) {
        if pair[0].vertex == pair[1].vertex {
            for &(face, corner) in &pair[1].faces {
                faces[face.index()][corner] = copied.len() as u32;
            }
            copied.push(pair[1].vertex);
        }
    }
    let split = TriMesh::new(copied.len(), faces);
    (
        split.expect("fans taken apart leave a manifold a manifold"),
        copied,
    )
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
