//! Supports that can't carry an affine row, lists with mistakes, and input that is refused.

mod meshes;

use meshes::{Patch, irregular_square};
use nalgebra::Vector3;
use ruga_constraint::{
    ClusterSettings, ConstraintError, Degradation, Kernel, Order, Sampling, cluster_centres,
    constraint_rows,
};
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, TriMesh, VertexId, vertex_normals};

/// `columns` by 3 vertices, rows one unit apart, columns `step` apart; the middle row first.
fn tall_strip(columns: usize, step: f64) -> Patch {
    let mut positions = Vec::new();
    for y in [0.0, -1.0, 1.0] {
        positions.extend((0..columns).map(|i| Vector3::new(i as f64 * step, y, 0.0)));
    }
    let n = columns as u32;
    let quad = |low: u32, high: u32, i: u32| {
        let [a, b, c, d] = [low + i, low + i + 1, high + i + 1, high + i];
        [[a, b, c], [a, c, d]]
    };
    let faces = (0..n - 1).flat_map(|i| [quad(n, 0, i), quad(0, 2 * n, i)].concat());
    Patch::new(positions, faces.collect())
}

/// Vertices, weight at the centre and outcome of the adjusted row in the middle of a tall strip.
fn adjusted_on_line(vertices_each_side: f64) -> (usize, Order, Option<Degradation>) {
    let patch = tall_strip(41, 0.05);
    let kernel = Kernel {
        sigma: 0.05 * (vertices_each_side + 0.5) / 2.0,
        cut: 2.0,
    };
    let set = patch.rows(&[VertexId(20)], kernel, Sampling::Adjusted);
    let row = &set.rows[0];
    let sum: f64 = row.weights.iter().map(|pair| pair.1).sum();
    assert!((sum - 1.0).abs() < 1e-12 && row.weights.iter().all(|pair| pair.1 > 0.0));
    (
        row.weights.len(),
        row.order,
        set.degraded.first().map(|d| d.1),
    )
}

#[test]
fn one_vertex_and_few_or_many_on_a_line_degrade_to_a_constant() {
    let few = Some(Degradation::FewVertices);
    assert_eq!(adjusted_on_line(0.0), (1, Order::Constant, few));
    assert_eq!(adjusted_on_line(1.0), (3, Order::Constant, few));
    let line = Some(Degradation::Collinear);
    assert_eq!(adjusted_on_line(5.0), (11, Order::Constant, line));
}

#[test]
fn two_three_and_four_vertices_degrade_to_a_constant() {
    let triangle = vec![
        Vector3::zeros(),
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, 2.0, 0.0),
    ];
    let mut square = triangle.clone();
    square.push(Vector3::new(-1.0, 0.0, 0.0));
    let kernel = |radius: f64| Kernel {
        sigma: radius / 2.0,
        cut: 2.0,
    };
    for (positions, faces, radius, count) in [
        (triangle.clone(), vec![[0, 1, 2]], 1.5, 2),
        (triangle, vec![[0, 1, 2]], 3.0, 3),
        (square, vec![[0, 1, 2], [0, 2, 3]], 3.0, 4),
    ] {
        let patch = Patch::new(positions, faces);
        let set = patch.rows(&[VertexId(0)], kernel(radius), Sampling::Adjusted);
        assert_eq!(set.rows[0].weights.len(), count);
        assert_eq!(set.rows[0].order, Order::Constant);
        assert_eq!(set.degraded, [(0, Degradation::FewVertices)]);
    }
}

#[test]
fn quadrature_needs_no_vertex_in_the_support_but_the_centre() {
    let patch = tall_strip(41, 0.05);
    let kernel = Kernel {
        sigma: 0.01,
        cut: 2.0,
    };
    let set = patch.rows(&[VertexId(20)], kernel, Sampling::Quadrature);
    assert!(set.degraded.is_empty());
    let centroid: f64 = set.rows[0]
        .weights
        .iter()
        .map(|(v, w)| w * (patch.positions[v.0 as usize].x - 1.0))
        .sum();
    assert!(centroid.abs() < 1e-12 * 0.02, "{centroid}");
}

#[test]
fn a_place_that_was_listed_before_is_left_out_under_any_address() {
    let patch = irregular_square(4, 1, &[]);
    let kernel = Kernel {
        sigma: 0.3,
        cut: 2.0,
    };
    let vertex = VertexId(12);
    let fan = patch.mesh.vertex_faces(vertex);
    let first = patch.mesh.faces()[fan[0]];
    let other = *first.iter().find(|&&v| v != vertex).expect("two others");
    // A part of the way from one vertex to the other.
    let place = |part: f64, &face: &FaceId| MaterialPoint {
        face,
        barycentric: patch.mesh.faces()[face].map(|v| match v {
            v if v == vertex => 1.0 - part,
            v if v == other => part,
            _ => 0.0,
        }),
    };
    let mut centres: Vec<_> = fan[..3].iter().map(|face| place(0.0, face)).collect();
    let is_beside = |face: &&FaceId| patch.mesh.faces()[**face].contains(&other);
    centres.extend(fan.iter().filter(is_beside).map(|face| place(0.25, face)));
    assert_eq!(centres.len(), 5);
    for sampling in [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature] {
        let set = patch.rows_at(&centres, kernel, sampling);
        let kept: Vec<usize> = set.rows.iter().map(|row| row.centre).collect();
        assert_eq!(kept, [0, 3]);
        assert_eq!(set.duplicates, [1, 2, 4]);
    }
}

#[test]
fn slivers_and_flat_faces_give_finite_weights() {
    let places = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.5, 1e-7], [1.0, 1.0]];
    let patch = Patch::new(
        places.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        // The first face has no area, the second almost none.
        vec![[0, 1, 2], [0, 2, 3], [3, 2, 4]],
    );
    let kernel = Kernel {
        sigma: 0.5,
        cut: 2.5,
    };
    let centres = [0, 2, 3, 4].map(VertexId);
    for sampling in [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature] {
        for row in patch.rows(&centres, kernel, sampling).rows {
            assert!(row.weights.iter().all(|pair| pair.1.is_finite()));
            assert!(!row.weights.is_empty());
        }
    }
}

#[test]
fn mistakes_are_named() {
    let patch = irregular_square(4, 0, &[]);
    let kernel = Kernel {
        sigma: 0.5,
        cut: 2.0,
    };
    let at = |face: u32, barycentric: [f64; 3]| MaterialPoint {
        face: FaceId(face),
        barycentric,
    };
    let middle = at(3, [0.25, 0.25, 0.5]);
    let rows = |patch: &Patch, centre: MaterialPoint, kernel: Kernel, kernels: usize| {
        constraint_rows(
            &patch.mesh,
            &patch.positions,
            &patch.normals,
            &[centre],
            &vec![kernel; kernels],
            Sampling::Area,
        )
    };
    assert_eq!(
        rows(&patch, at(32, [1.0, 0.0, 0.0]), kernel, 1),
        Err(ConstraintError::FaceOutOfRange {
            centre: 0,
            face: FaceId(32),
            count: 32
        })
    );
    for barycentric in [
        [0.5, 0.6, -0.1],
        [0.5, 0.5, 0.1],
        [0.0; 3],
        [f64::NAN, 0.5, 0.5],
        [f64::INFINITY, 0.0, 0.0],
    ] {
        let result = rows(&patch, at(3, barycentric), kernel, 1);
        assert!(matches!(
            result,
            Err(ConstraintError::OutsideFace { centre: 0, .. })
        ));
    }
    assert_eq!(
        rows(&patch, middle, kernel, 2),
        Err(ConstraintError::WrongLength {
            what: "kernels",
            expected: 1,
            found: 2
        })
    );
    for (sigma, cut) in [
        (0.0, 2.0),
        (-1.0, 2.0),
        (f64::NAN, 2.0),
        (0.5, f64::NAN),
        (0.5, 0.0),
    ] {
        let result = rows(&patch, middle, Kernel { sigma, cut }, 1);
        assert!(matches!(result, Err(ConstraintError::BadKernel { .. })));
    }
    let mut broken = patch.clone();
    broken.positions[7].y = f64::INFINITY;
    assert_eq!(
        rows(&broken, middle, kernel, 1),
        Err(ConstraintError::PositionNotFinite {
            vertex: VertexId(7)
        })
    );
    let [first, second, _] = patch.mesh.faces()[FaceId(3)];
    let mut lost = patch.clone();
    lost.normals[first.0 as usize] = Vector3::zeros();
    let no_normal = Err(ConstraintError::NoNormal { centre: 0 });
    assert_eq!(rows(&lost, middle, kernel, 1), no_normal);
    // On the edge that it isn't on it plays no part.
    assert!(rows(&lost, at(3, [0.0, 0.5, 0.5]), kernel, 1).is_ok());
    let mut folded = patch.clone();
    folded.normals[second.0 as usize] = -folded.normals[first.0 as usize];
    assert_eq!(rows(&folded, at(3, [0.5, 0.5, 0.0]), kernel, 1), no_normal);
}

#[test]
fn mistakes_in_a_region_are_named() {
    let patch = irregular_square(4, 0, &[]);
    let spacing = PerVertex::filled(25, 0.5);
    let centres = |mesh: &TriMesh, spacing: &PerVertex<f64>, candidates: &[u32]| {
        let candidates: Vec<VertexId> = candidates.iter().copied().map(VertexId).collect();
        let settings = ClusterSettings::default();
        cluster_centres(mesh, &patch.positions, spacing, &candidates, &settings)
    };
    let empty = TriMesh::new(25, vec![]).expect("an empty mesh");
    assert!(vertex_normals(&empty, &patch.positions).len() == 25);
    assert_eq!(
        centres(&empty, &spacing, &[1]),
        Err(ConstraintError::EmptyRegion)
    );
    assert_eq!(
        centres(&patch.mesh, &spacing, &[]),
        Err(ConstraintError::EmptyRegion)
    );
    assert_eq!(
        centres(&patch.mesh, &spacing, &[1, 30]),
        Err(ConstraintError::VertexOutOfRange {
            vertex: VertexId(30),
            count: 25
        })
    );
    for bad in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let mut spacing = spacing.clone();
        spacing[VertexId(4)] = bad;
        assert!(matches!(
            centres(&patch.mesh, &spacing, &[3, 4]),
            Err(ConstraintError::BadSpacing {
                vertex: VertexId(4),
                ..
            })
        ));
        // Outside the region nobody asks for it.
        assert!(centres(&patch.mesh, &spacing, &[7, 8]).is_ok());
    }
}
