//! Meshes taken apart where their faces only touch: at a vertex, or along creases.

use ruga_mesh::{EdgeId, FaceId, Id, PerEdge, PerVertex, TriMesh, VertexFan, VertexId};

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

/// The corners of every face of a mesh that is open along some of its edges, with a vertex for each side
/// of them, and the old vertex of every new one; the first vertices are the old ones.
///
/// The last edge of a line that ends inside the mesh stays closed: opened, the vertex at its tip would lie on a
/// border with all of its faces, where smooth surfaces have no tangent plane.
pub(crate) fn open_along(
    mesh: &TriMesh,
    edges: impl IntoIterator<Item = EdgeId>,
) -> (Vec<[u32; 3]>, Vec<VertexId>) {
    let edges: Vec<EdgeId> = edges.into_iter().collect();
    let mut is_open = PerEdge::filled(mesh.edges().len(), false);
    let mut counts = PerVertex::filled(mesh.vertex_count(), 0);
    for &edge in &edges {
        mesh.edges()[edge]
            .vertices
            .iter()
            .for_each(|&v| counts[v] += 1);
    }
    let border = mesh.border_vertices();
    let mut vertices = Vec::new();
    for edge in edges {
        let ends = mesh.edges()[edge].vertices;
        if ends.iter().all(|&v| counts[v] > 1 || border[v]) {
            is_open[edge] = true;
            vertices.extend(ends);
        }
    }
    vertices.sort_unstable();
    vertices.dedup();
    let mut copied: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::from_index).collect();
    let faces = mesh.faces().as_slice().iter();
    let mut faces: Vec<[u32; 3]> = faces.map(|face| face.map(|v| v.0)).collect();
    for vertex in vertices {
        let mut left: Vec<FaceId> = mesh.vertex_faces(vertex).to_vec();
        let mut is_first = true;
        while let Some(&seed) = left.first() {
            let side = one_side(mesh, vertex, seed, &is_open);
            left.retain(|face| !side.contains(face));
            if is_first {
                is_first = false;
                continue;
            }
            for face in side {
                let corner = mesh.faces()[face].iter().position(|&v| v == vertex);
                faces[face.index()][corner.expect("a face around it")] = copied.len() as u32;
            }
            copied.push(vertex);
        }
    }
    (faces, copied)
}

/// The faces around a vertex that can be reached from one of them across edges that are not open.
fn one_side(
    mesh: &TriMesh,
    vertex: VertexId,
    seed: FaceId,
    is_open: &PerEdge<bool>,
) -> Vec<FaceId> {
    let mut side = vec![seed];
    let mut next = 0;
    while let Some(&face) = side.get(next) {
        next += 1;
        for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
            let is_beside = mesh.edges()[edge].vertices.contains(&vertex);
            if let Some(other) = mesh.neighbour(face, corner)
                && is_beside
                && !is_open[edge]
                && !side.contains(&other)
            {
                side.push(other);
            }
        }
    }
    side
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line across the middle of a square opens it into two sides.
    #[test]
    fn lines_open_into_two_sides() {
        // Three by three vertices.
        let squares = [0, 1, 3, 4];
        let faces = squares.map(|a| [[a, a + 1, a + 4], [a, a + 4, a + 3]]);
        let mesh = TriMesh::new(9, faces.concat()).expect("a square");
        let edge = |a: u32, b: u32| {
            let mut edges = mesh.edges().iter();
            let found = edges.find(|(_, e)| {
                e.vertices.contains(&VertexId(a)) && e.vertices.contains(&VertexId(b))
            });
            found.expect("an edge").0
        };
        let (opened, copied) = open_along(&mesh, [edge(3, 4), edge(4, 5)]);
        assert_eq!(copied[9..], [VertexId(3), VertexId(4), VertexId(5)]);
        let opened = TriMesh::new(12, opened).expect("two halves");
        assert_eq!(opened.connected_parts(|_| true).len(), 2);
        // One that ends in the middle has no other edge that could open.
        let (_, copied) = open_along(&mesh, [edge(3, 4)]);
        assert_eq!(copied.len(), 9);
    }

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
