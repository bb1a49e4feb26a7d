//! Incidence, rings, components and submeshes of random valid meshes.

use proptest::prelude::*;
use ruga_mesh::{EdgeId, FaceId, Id, PerFace, TriMesh, VertexId};

/// Some faces of a grid, sometimes closed to a torus, with shuffled vertices and turned corners:
/// holes, pieces, bow ties and lonely vertices all occur.
fn random_mesh() -> impl Strategy<Value = TriMesh> {
    (3_usize..7, 3_usize..7, any::<bool>()).prop_flat_map(|(width, height, closed)| {
        let faces = grid(width, height, closed);
        let vertices = if closed {
            width * height
        } else {
            (width + 1) * (height + 1)
        };
        let shuffled = Just((0..vertices as u32).collect::<Vec<u32>>()).prop_shuffle();
        let kept = prop::collection::vec((prop::bool::weighted(0.8), 0_usize..3), faces.len());
        (shuffled, kept).prop_map(move |(names, kept)| {
            let chosen = faces.iter().zip(kept).filter(|(_, (keep, _))| *keep);
            let renamed = chosen.map(|(face, (_, turn))| {
                let mut face = face.map(|v| names[v as usize]);
                face.rotate_left(turn);
                face
            });
            TriMesh::new(vertices, renamed.collect()).expect("part of a grid is a mesh")
        })
    })
}

fn grid(width: usize, height: usize, closed: bool) -> Vec<[u32; 3]> {
    let columns = if closed { width } else { width + 1 };
    let rows = if closed { height } else { height + 1 };
    let vertex = |i: usize, j: usize| ((j % rows) * columns + i % columns) as u32;
    let mut faces = Vec::new();
    for j in 0..height {
        for i in 0..width {
            let [a, b, c, d] = [
                vertex(i, j),
                vertex(i + 1, j),
                vertex(i + 1, j + 1),
                vertex(i, j + 1),
            ];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    faces
}

/// Fans of faces at a vertex: groups connected across edges that contain it.
fn fan_count(mesh: &TriMesh, vertex: VertexId) -> usize {
    let mut left: Vec<FaceId> = mesh.vertex_faces(vertex).to_vec();
    let mut count = 0;
    while let Some(seed) = left.pop() {
        count += 1;
        let mut stack = vec![seed];
        while let Some(face) = stack.pop() {
            for corner in 0..3 {
                let edge = &mesh.edges()[mesh.face_edges(face)[corner]];
                if !edge.vertices.contains(&vertex) {
                    continue;
                }
                if let Some(next) = mesh.neighbour(face, corner)
                    && let Some(at) = left.iter().position(|&f| f == next)
                {
                    stack.push(left.swap_remove(at));
                }
            }
        }
    }
    count
}

fn is_face(mesh: &TriMesh, wanted: [VertexId; 3]) -> bool {
    mesh.vertex_faces(wanted[0]).iter().any(|&f| {
        let mut face = mesh.faces()[f];
        (0..3).any(|_| {
            face.rotate_left(1);
            face == wanted
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    #[test]
    fn edges_faces_and_neighbours_agree(mesh in random_mesh()) {
        let incidences: usize = (0..mesh.vertex_count() as u32)
            .map(|v| mesh.vertex_faces(VertexId(v)).len())
            .sum();
        prop_assert_eq!(incidences, 3 * mesh.face_count());
        for (face, vertices) in mesh.faces().iter() {
            for corner in 0..3 {
                let edge = &mesh.edges()[mesh.face_edges(face)[corner]];
                let ends = [vertices[corner], vertices[(corner + 1) % 3]];
                let side = if edge.faces[0] == Some(face) { 0 } else { 1 };
                prop_assert_eq!(edge.faces[side], Some(face));
                prop_assert_eq!(edge.apexes[side], Some(vertices[(corner + 2) % 3]));
                let expected = if side == 0 { edge.vertices } else { [edge.vertices[1], edge.vertices[0]] };
                prop_assert_eq!(ends, expected);
                prop_assert_eq!(mesh.neighbour(face, corner), edge.faces[1 - side]);
            }
            prop_assert!(vertices.iter().all(|&v| mesh.vertex_faces(v).contains(&face)));
        }
        let sides: usize = mesh.edges().iter().map(|(_, e)| if e.is_border() { 1 } else { 2 }).sum();
        prop_assert_eq!(sides, 3 * mesh.face_count());
    }

    #[test]
    fn rings_turn_once_around_single_fans(mesh in random_mesh()) {
        let border = mesh.border_vertices();
        for (vertex, &is_border) in border.iter() {
            let ring = mesh.ring(vertex);
            prop_assert_eq!(ring.is_some(), fan_count(&mesh, vertex) == 1);
            let Some(ring) = ring else { continue };
            let count = ring.spokes.len();
            prop_assert_eq!(ring.closed, !is_border);
            let faces = mesh.vertex_faces(vertex).len();
            prop_assert_eq!(count, if ring.closed { faces } else { faces + 1 });
            for i in 0..faces {
                let next = ring.spokes[(i + 1) % count];
                prop_assert!(is_face(&mesh, [vertex, ring.spokes[i], next]));
            }
            let mut distinct = ring.spokes.clone();
            distinct.sort();
            distinct.dedup();
            prop_assert_eq!(distinct.len(), count);
        }
    }

    #[test]
    fn parts_are_what_neighbours_connect(mesh in random_mesh()) {
        let parts = mesh.connected_parts(|_| true);
        let mut part_of = PerFace::filled(mesh.face_count(), usize::MAX);
        for (number, part) in parts.iter().enumerate() {
            part.iter().for_each(|&face| part_of[face] = number);
            prop_assert_eq!(part.iter().min(), part.first());
        }
        for face in part_of.ids() {
            for next in (0..3).filter_map(|corner| mesh.neighbour(face, corner)) {
                prop_assert_eq!(part_of[face], part_of[next]);
            }
        }
        prop_assert!(parts.is_sorted_by_key(|part| part[0]));
        prop_assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), mesh.face_count());
        prop_assert_eq!(parts.len(), count_by_merging(&mesh));
    }

    #[test]
    fn a_submesh_is_the_chosen_faces(mesh in random_mesh(), picks in prop::collection::vec(any::<prop::sample::Index>(), 0..40)) {
        prop_assume!(mesh.face_count() > 0);
        let chosen: Vec<FaceId> = picks.iter().map(|p| FaceId(p.index(mesh.face_count()) as u32)).collect();
        let part = mesh.submesh(&chosen);
        let mut distinct = chosen.clone();
        distinct.sort();
        distinct.dedup();
        prop_assert_eq!(part.mesh.face_count(), distinct.len());
        let mut taken = PerFace::filled(mesh.face_count(), false);
        for (local, &whole) in part.faces.iter() {
            prop_assert!(!std::mem::replace(&mut taken[whole], true));
            let corners = part.mesh.faces()[local].map(|v| part.vertices[v]);
            prop_assert_eq!(corners, mesh.faces()[whole]);
        }
        // First appearance decides the order, and no vertex comes along unused.
        let order: Vec<usize> = part.faces.as_slice().iter()
            .filter_map(|f| chosen.iter().position(|c| c == f))
            .collect();
        prop_assert!(order.is_sorted());
        for (vertex, _) in part.vertices.iter() {
            prop_assert!(!part.mesh.vertex_faces(vertex).is_empty());
        }
    }

    #[test]
    fn edges_are_numbered_by_first_appearance(mesh in random_mesh()) {
        let mut next = 0;
        for face in mesh.faces().ids() {
            for edge in mesh.face_edges(face) {
                prop_assert!(edge.index() <= next);
                if edge == EdgeId::from_index(next) {
                    next += 1;
                }
            }
        }
        prop_assert_eq!(next, mesh.edges().len());
    }
}

/// Components by repeatedly giving neighbours the lower of their numbers.
fn count_by_merging(mesh: &TriMesh) -> usize {
    let mut number: Vec<usize> = (0..mesh.face_count()).collect();
    let mut has_changed = true;
    while has_changed {
        has_changed = false;
        for face in mesh.faces().ids() {
            for next in (0..3).filter_map(|corner| mesh.neighbour(face, corner)) {
                let lower = number[face.index()].min(number[next.index()]);
                has_changed |= number[face.index()] != lower || number[next.index()] != lower;
                number[face.index()] = lower;
                number[next.index()] = lower;
            }
        }
    }
    number.sort();
    number.dedup();
    number.len()
}
