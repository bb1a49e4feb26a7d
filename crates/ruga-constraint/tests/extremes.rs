//! Lengths that don't go with the mesh, and numbers that are none: a sound row or an error, soon.

mod meshes;

use meshes::{Patch, irregular_square};
use nalgebra::Vector3;
use ruga_constraint::{
    ClusterSettings, ConstraintError, Kernel, Order, Sampling, cluster_centres, constraint_rows,
};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, VertexId};

fn centres(
    patch: &Patch,
    spacing: f64,
    settings: &ClusterSettings,
) -> Result<Vec<VertexId>, ConstraintError> {
    let spacing = PerVertex::filled(patch.positions.len(), spacing);
    let all: Vec<VertexId> = spacing.ids().collect();
    cluster_centres(&patch.mesh, &patch.positions, &spacing, &all, settings)
}

/// The first two took for ever: lengths in spacings overflowed.
#[test]
fn a_spacing_in_another_unit_is_refused_at_once() {
    let patch = irregular_square(30, 1, &[]);
    let settings = ClusterSettings::default();
    for spacing in [1e-12, 1e-10, 1e-6, 1e-100, 1e-300, f64::MIN_POSITIVE] {
        let found = centres(&patch, spacing, &settings);
        let Err(ConstraintError::TooManyCentres { wanted, vertices }) = found else {
            panic!("{spacing}: {found:?}");
        };
        assert!(wanted > 1e12 && vertices == 961, "{wanted} {vertices}");
    }
    // As are positions whose areas overflow.
    let far = patch.mapped(|p| p * 1e200);
    let found = centres(&far, 1e200, &settings);
    assert!(matches!(found, Err(ConstraintError::TooManyCentres { .. })));
    assert_eq!(centres(&patch, 1e12, &settings).map(|it| it.len()), Ok(0));
}

#[test]
fn one_vertex_with_a_tiny_spacing_does_not_stop_the_others() {
    let patch = irregular_square(20, 1, &[]);
    let mut spacing = PerVertex::filled(patch.positions.len(), 0.3);
    spacing[VertexId(200)] = 1e-3;
    let all: Vec<VertexId> = spacing.ids().collect();
    let settings = ClusterSettings::default();
    let found = cluster_centres(&patch.mesh, &patch.positions, &spacing, &all, &settings);
    assert!(found.is_ok_and(|found| !found.is_empty()));
}

#[test]
fn settings_outside_their_range_are_named() {
    let patch = irregular_square(6, 1, &[]);
    let bad = |relaxations, smallest_piece| {
        let settings = ClusterSettings {
            relaxations,
            smallest_piece,
        };
        match centres(&patch, 0.5, &settings) {
            Err(ConstraintError::BadSetting { setting, .. }) => setting,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(bad(u32::MAX, 0.05), "relaxations");
    for smallest_piece in [f64::NAN, -1.0, f64::INFINITY] {
        assert_eq!(bad(30, smallest_piece), "smallest_piece");
    }
}

#[test]
fn a_normal_that_is_no_number_is_named() {
    let mut patch = irregular_square(6, 1, &[]);
    patch.normals[40].y = f64::NAN;
    let found = constraint_rows(
        &patch.mesh,
        &patch.positions,
        &patch.normals,
        &[MaterialPoint::at_corner(FaceId(0), 0)],
        &[Kernel::beside_foundation(0.5)],
        Sampling::Quadrature,
    );
    let vertex = VertexId(40);
    assert_eq!(found, Err(ConstraintError::NormalNotFinite { vertex }));
}

/// A kernel much wider than the mesh weighs all of it evenly; it gave one vertex a weight of one.
#[test]
fn a_kernel_far_beyond_the_mesh_is_the_mean_of_the_mesh() {
    let patch = irregular_square(12, 3, &[]);
    let centre = patch.vertex_near(Vector3::new(0.3, -0.2, 0.0));
    for sigma in [1e2, 1e4, 1e9] {
        let kernel = Kernel { sigma, cut: 2.5 };
        let set = patch.rows(&[centre], kernel, Sampling::Quadrature);
        let row = &set.rows[0];
        assert!(set.degraded.is_empty());
        assert_eq!(row.weights.len(), patch.positions.len());
        assert!(row.weights.iter().all(|w| (0.0..0.02).contains(&w.1)));
        for [x, y] in [[1.0, 0.0], [0.0, 1.0]] {
            let mean = patch.average(row, |p| x * p.x + y * p.y);
            assert!(mean.abs() < 1e-3, "{sigma} {mean}");
        }
        let square = patch.average(row, |p| p.x * p.x);
        assert!((square - 1.0 / 3.0).abs() < 5e-3, "{sigma} {square}");
    }
}

#[test]
fn a_kernel_far_below_the_mesh_is_its_centre() {
    let patch = irregular_square(6, 3, &[]);
    let place = MaterialPoint {
        face: FaceId(20),
        barycentric: [0.2, 0.3, 0.5],
    };
    for sigma in [1e-3, 1e-9, 1e-12] {
        let kernel = Kernel { sigma, cut: 2.5 };
        let set = patch.rows_at(&[place], kernel, Sampling::Quadrature);
        let row = &set.rows[0];
        assert_eq!(row.order, Order::Affine);
        let corners = patch.mesh.faces()[place.face];
        for (corner, expected) in corners.into_iter().zip(place.barycentric) {
            let found = row.weights.iter().find(|w| w.0 == corner);
            let found = found.map_or(0.0, |w| w.1);
            assert!(
                (found - expected).abs() < 1e-6,
                "{sigma} {}",
                corner.index()
            );
        }
    }
}
