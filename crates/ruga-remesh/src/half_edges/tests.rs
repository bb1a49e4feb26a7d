//! Edits keep the connectivity whole.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::VertexId;

use super::*;

/// Two by two cells with a diagonal each.
fn square() -> HalfEdges {
    let mut faces = Vec::new();
    for v in [0, 1, 3, 4] {
        faces.extend([[v, v + 1, v + 4], [v, v + 4, v + 3]]);
    }
    let mesh = TriMesh::new(9, faces).expect("a grid is a mesh");
    let features = PerEdge::filled(mesh.edges().len(), false);
    HalfEdges::new(&mesh, &features).expect("a grid has single fans")
}

fn check(mesh: &HalfEdges) {
    let faces: Vec<[u32; 3]> = (0..mesh.face_slots() as u32)
        .filter_map(|f| mesh.face(f))
        .collect();
    let whole = TriMesh::new(mesh.vertex_slots(), faces).expect("manifold");
    for h in (0..mesh.tails.len() as u32).filter(|&h| mesh.tail(h) != NONE) {
        match mesh.twin(h) {
            Some(twin) => {
                assert_eq!(mesh.twin(twin), Some(h));
                assert_eq!(
                    (mesh.tail(h), mesh.head(h)),
                    (mesh.head(twin), mesh.tail(twin))
                );
                assert_eq!(mesh.is_feature(h), mesh.is_feature(twin));
            }
            None => assert!(mesh.is_feature(h)),
        }
    }
    for v in 0..mesh.vertex_slots() as u32 {
        let faces = whole.vertex_faces(VertexId(v)).len();
        assert_eq!(mesh.is_alive_vertex(v), faces > 0);
        if faces > 0 {
            assert_eq!(mesh.outgoing(v).count(), faces);
            assert!(mesh.outgoing(v).all(|h| mesh.tail(h) == v));
            let ring = whole.ring(VertexId(v)).expect("one fan");
            assert_eq!(ring.closed, !mesh.is_border_vertex(v));
            assert_eq!(mesh.neighbours(v).count(), ring.spokes.len());
        }
    }
}

#[test]
fn renumbering_keeps_who_is_joined_to_whom() {
    let mut mesh = square();
    for h in [0, 4, 9, 13] {
        mesh.split(h);
    }
    let before = mesh.clone();
    let count = mesh.vertex_slots() as u32;
    let order: Vec<u32> = (0..count).map(|v| (5 * v + 3) % count).collect();
    mesh.renumber(&order);
    check(&mesh);
    for (a, &old_a) in (0..).zip(&order) {
        for (b, &old_b) in (0..).zip(&order) {
            assert_eq!(mesh.are_joined(a, b), before.are_joined(old_a, old_b));
        }
    }
}

#[test]
fn random_edits_keep_the_connectivity_sound() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut mesh = square();
    let mut done = [0; 3];
    for _ in 0..600 {
        let edges: Vec<u32> = mesh.edges().collect();
        let h = edges[random.random_range(0..edges.len())];
        // Splits and collapses are equally likely while the mesh is small.
        match random.random_range(0..3) {
            0 if edges.len() < 120 => {
                mesh.split(h);
                done[0] += 1;
            }
            1 => {
                if let Some(twin) = mesh.twin(h)
                    && !mesh.are_joined(mesh.apex(h), mesh.apex(twin))
                {
                    mesh.flip(h);
                    done[1] += 1;
                }
            }
            _ => {
                if mesh.can_collapse(h) {
                    let gone = if random.random() {
                        mesh.tail(h)
                    } else {
                        mesh.head(h)
                    };
                    mesh.collapse(h, gone);
                    done[2] += 1;
                }
            }
        }
        check(&mesh);
    }
    assert!(done.iter().all(|&count| count > 50), "{done:?}");
}
