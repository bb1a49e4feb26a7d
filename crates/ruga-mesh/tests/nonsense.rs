//! Nonsense is refused, left out, or ends in the panic that the documentation promises.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{
    FaceId, LoopSurface, MaterialPoint, MeshError, PerVertex, PlanarLookup, SparseRows,
    SurfaceLookup, TangentCentre, TriMesh, VertexId, edge_distances, face_normals, limit_rows,
    subdivide, tangent_coordinates, vertex_areas, vertex_normals,
};

fn square() -> (TriMesh, Vec<Vector3<f64>>) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    (
        TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]]).expect("a square"),
        corners.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
    )
}

/// The message of the panic that `action` ends in.
fn panic_of<T>(action: impl FnOnce() -> T) -> String {
    let Err(payload) = catch_unwind(AssertUnwindSafe(action)) else {
        panic!("no panic");
    };
    let text = payload.downcast_ref::<String>().cloned();
    let literal = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    text.or(literal).expect("a message")
}

#[test]
fn a_mesh_that_cannot_be_numbered_is_an_error() {
    for count in [TriMesh::MAX_COUNT + 1, 1 << 40, usize::MAX] {
        let error = TriMesh::new(count, vec![[0, 1, 2]]).expect_err("too many");
        assert_eq!(
            error,
            MeshError::TooLarge {
                what: "vertices",
                count,
                limit: TriMesh::MAX_COUNT
            }
        );
        assert!(error.to_string().contains("at most 268435456"), "{error}");
    }
}

#[test]
fn arrays_of_another_mesh_are_told_apart_at_once() {
    let (mesh, positions) = square();
    for other in [
        &positions[..3],
        &[positions.clone(), positions.clone()].concat(),
    ] {
        for message in [
            panic_of(|| face_normals(&mesh, other)),
            panic_of(|| vertex_normals(&mesh, other)),
            panic_of(|| vertex_areas(&mesh, other)),
            panic_of(|| SurfaceLookup::new(&mesh, other)),
            panic_of(|| edge_distances(&mesh, other, [], 1.0)),
        ] {
            assert!(message.contains("one position per vertex"), "{message}");
        }
    }
    let corners = PerVertex::filled(3, false);
    for message in [
        panic_of(|| subdivide(&mesh, 0, &corners)),
        panic_of(|| limit_rows(&mesh, &corners)),
        panic_of(|| LoopSurface::new(&mesh, &corners)),
    ] {
        assert!(message.contains("one corner flag per vertex"), "{message}");
    }
}

#[test]
fn too_many_levels_end_before_memory_is_asked_for() {
    let (mesh, _) = square();
    let corners = PerVertex::filled(4, false);
    for levels in [14, 31, 32, u32::MAX] {
        let message = panic_of(|| subdivide(&mesh, levels, &corners));
        assert!(
            message.contains(&format!("2 faces cannot be subdivided {levels} times")),
            "{message}"
        );
    }
}

#[test]
fn ids_of_another_mesh() {
    let (mesh, positions) = square();
    assert_eq!(MaterialPoint::of_vertex(&mesh, VertexId(4)), None);
    assert_eq!(MaterialPoint::of_vertex(&mesh, VertexId(u32::MAX)), None);
    let message = panic_of(|| MaterialPoint::at_corner(FaceId(0), 3));
    assert!(message.contains("no corner 3"), "{message}");
    // Panics that the documentation names; nothing else is promised of them.
    panic_of(|| mesh.vertex_faces(VertexId(4)).len());
    panic_of(|| mesh.face_edges(FaceId(2)));
    panic_of(|| mesh.neighbour(FaceId(0), 3));
    panic_of(|| mesh.submesh(&[FaceId(2)]));
    panic_of(|| SparseRows::identity(3).apply(&positions[..2]));
    panic_of(|| SparseRows::identity(3).row(3).count());
    panic_of(|| SparseRows::identity(3).after(&SparseRows::identity(2)));
}

#[test]
fn places_that_are_not_finite_are_never_found() {
    let (mesh, positions) = square();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let lookup = SurfaceLookup::new(&mesh, &positions);
        let target = Vector3::new(0.5, bad, 0.0);
        assert_eq!(lookup.closest(&target), None);
        assert_eq!(lookup.closest_near(FaceId(0), &target, 1.0), None);

        let uvs = mesh.faces().as_slice().iter();
        let uvs = uvs.map(|face| face.map(|v| positions[v.0 as usize].xy()));
        let chart = PlanarLookup::new(uvs.collect());
        assert_eq!(chart.locate(Vector2::new(bad, 0.5)), None);

        let mut broken = positions.clone();
        broken[1].x = bad;
        let distances = edge_distances(&mesh, &broken, [VertexId(0)], 10.0);
        assert_eq!(distances[VertexId(1)], f64::INFINITY);
        assert_eq!(distances[VertexId(3)], 1.0);
        let normals = vertex_normals(&mesh, &broken);
        assert!(normals.iter().flatten().all(|c| c.is_finite()));

        let centre = TangentCentre {
            origin: positions[0],
            normal: Vector3::z(),
            axis: Vector3::x(),
            around: vec![VertexId(0)],
        };
        let up = [Vector3::z(); 4];
        let found = tangent_coordinates(&mesh, &broken, &up, &centre, 10.0);
        assert!(found.iter().all(|c| c.place.iter().all(|c| c.is_finite())));
        assert_eq!(found.len(), 3, "all but vertex 1: {found:?}");
        let nowhere = tangent_coordinates(&mesh, &positions, &up, &centre, f64::NAN);
        assert!(nowhere.is_empty());
    }
}

/// As with tiled textures: every face covers the whole chart.
#[test]
fn faces_that_all_lie_on_each_other_take_no_more_memory_than_others() {
    let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Vector2::from);
    let faces = 30_000;
    let chart = PlanarLookup::new(vec![[a, b, c]; faces].into());
    let found = chart.locate(Vector2::new(0.3, 0.3)).expect("inside");
    assert_eq!(found.face, FaceId(0));
    assert_eq!(chart.locate(Vector2::new(0.9, 0.9)), None);
    // The lists of all cells, seen from outside: with one entry per cell and face there would be
    // 900 million of them, and building would take minutes.
    let thin = |i: usize| {
        let y = i as f64 / faces as f64;
        [
            a + Vector2::y() * y,
            b + Vector2::y() * y,
            b + Vector2::y() * (y + 1e-5),
        ]
    };
    let strips = PlanarLookup::new((0..faces).map(thin).collect());
    let place = strips
        .locate(Vector2::new(0.5, 0.5 + 3e-6))
        .expect("inside");
    assert_eq!(place.face, FaceId(faces as u32 / 2));
}
