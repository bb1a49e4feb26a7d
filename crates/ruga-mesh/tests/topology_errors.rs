//! Every mistake in a face list is named, with the elements that make it.

use ruga_mesh::{FaceId, MeshError, TriMesh, VertexId};

fn error(vertex_count: usize, faces: &[[u32; 3]]) -> MeshError {
    TriMesh::new(vertex_count, faces.to_vec()).expect_err("the face list is wrong")
}

#[test]
fn a_vertex_that_does_not_exist() {
    assert_eq!(
        error(4, &[[0, 1, 2], [0, 2, 4]]),
        MeshError::VertexOutOfRange {
            face: FaceId(1),
            vertex: VertexId(4),
            count: 4
        }
    );
    assert!(TriMesh::new(5, vec![[0, 1, 2], [0, 2, 4]]).is_ok());
}

#[test]
fn a_vertex_used_twice_in_any_pair_of_corners() {
    for face in [[3, 3, 1], [1, 3, 3], [3, 1, 3]] {
        assert_eq!(
            error(4, &[[0, 1, 2], face]),
            MeshError::RepeatedVertex {
                face: FaceId(1),
                vertex: VertexId(3)
            }
        );
    }
}

#[test]
fn the_same_face_twice_however_it_is_written() {
    for copy in [[1, 2, 3], [2, 3, 1], [3, 2, 1]] {
        assert_eq!(
            error(5, &[[0, 2, 1], [1, 2, 3], [1, 3, 4], copy]),
            MeshError::DuplicateFaces {
                first: FaceId(1),
                second: FaceId(3)
            }
        );
    }
}

#[test]
fn three_faces_at_an_edge() {
    assert_eq!(
        error(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]),
        MeshError::NonManifoldEdge {
            vertices: [VertexId(0), VertexId(1)],
            face: FaceId(0),
            count: 3
        }
    );
}

#[test]
fn neighbours_of_opposite_winding() {
    assert_eq!(
        error(5, &[[0, 1, 4], [1, 2, 4], [2, 4, 3]]),
        MeshError::InconsistentWinding {
            first: FaceId(1),
            second: FaceId(2),
            vertices: [VertexId(2), VertexId(4)]
        }
    );
}

#[test]
fn messages_name_the_elements() {
    let message = error(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).to_string();
    for part in ["3 faces", "vertices 0 and 1", "face 0"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn no_faces_and_no_vertices_are_a_mesh() {
    let mesh = TriMesh::new(0, vec![]).expect("empty");
    assert_eq!((mesh.vertex_count(), mesh.face_count()), (0, 0));
    assert_eq!(mesh.connected_parts(|_| true).len(), 0);
    let lonely = TriMesh::new(3, vec![]).expect("no faces");
    assert_eq!(lonely.ring(VertexId(1)), None);
}

#[test]
fn two_fans_at_a_vertex_are_accepted_and_have_no_ring() {
    let mesh = TriMesh::new(5, vec![[0, 1, 2], [0, 3, 4]]).expect("a bow tie");
    assert_eq!(mesh.ring(VertexId(0)), None);
    assert_eq!(mesh.connected_parts(|_| true).len(), 2);
    // Two closed fans: two tetrahedra that share a tip.
    let tetrahedron = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
    let faces = [tetrahedron([0, 1, 2, 3]), tetrahedron([0, 4, 5, 6])].concat();
    let mesh = TriMesh::new(7, faces).expect("two tetrahedra");
    assert_eq!(mesh.ring(VertexId(0)), None);
    assert_eq!(mesh.ring(VertexId(1)).map(|r| r.spokes.len()), Some(3));
}
