//! Rows reproduce constants and affine functions, at borders too, with weights that aren't negative.

mod meshes;

use meshes::{Patch, irregular_square};
use nalgebra::Vector2;
use ruga_constraint::{ConstraintRow, Kernel, Order, Sampling};
use ruga_mesh::{Id, VertexId};

const KERNEL: Kernel = Kernel {
    sigma: 0.16,
    cut: 2.5,
};

fn sum(row: &ConstraintRow) -> f64 {
    row.weights.iter().map(|pair| pair.1).sum()
}

/// Centroid of the weights relative to the centre, in support radii.
fn centroid(patch: &Patch, centres: &[VertexId], row: &ConstraintRow) -> Vector2<f64> {
    let origin = patch.positions[centres[row.centre].index()];
    let moment = row
        .weights
        .iter()
        .fold(Vector2::zeros(), |sum, (vertex, w)| {
            sum + (patch.positions[vertex.index()] - origin).xy() * *w
        });
    moment / KERNEL.radius()
}

/// Centroid of the kernel on a half plane whose border is `inset` away, in support radii.
fn half_plane_centroid(inset: f64) -> f64 {
    let steps = 600;
    let (mut mass, mut moment) = (0.0, 0.0);
    for i in 0..steps {
        for j in 0..steps {
            let place = |k: usize| (2.0 * (k as f64 + 0.5) / steps as f64 - 1.0) * KERNEL.radius();
            if place(i) > -inset {
                let weight = KERNEL.weight(place(i).hypot(place(j)));
                mass += weight;
                moment += weight * place(i);
            }
        }
    }
    moment / mass / KERNEL.radius()
}

fn interior(patch: &Patch) -> Vec<VertexId> {
    let limit = 1.0 - KERNEL.radius();
    let is_inside = |i: &u32| {
        let p = patch.positions[*i as usize];
        p.x.abs() < limit && p.y.abs() < limit
    };
    (0..patch.positions.len() as u32)
        .filter(is_inside)
        .map(VertexId)
        .collect()
}

#[test]
fn weights_sum_to_one_and_are_not_negative_everywhere() {
    for seed in 0..2 {
        let patch = irregular_square(20, seed, &[]);
        let all: Vec<VertexId> = (0..patch.positions.len() as u32).map(VertexId).collect();
        for sampling in [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature] {
            let set = patch.rows(&all, KERNEL, sampling);
            assert_eq!(set.rows.len(), all.len());
            assert!(set.degraded.is_empty(), "{sampling:?} {:?}", set.degraded);
            for row in &set.rows {
                assert!((sum(row) - 1.0).abs() < 1e-12, "{sampling:?} {}", sum(row));
                assert!(row.weights.iter().all(|pair| pair.1 > 0.0), "{sampling:?}");
                assert!(row.weights.is_sorted_by(|a, b| a.0 < b.0), "{sampling:?}");
            }
        }
    }
}

#[test]
fn interior_rows_have_their_centroid_at_the_centre() {
    for seed in 0..4 {
        let patch = irregular_square(24, seed, &[]);
        let centres = interior(&patch);
        let worst = |sampling| {
            let set = patch.rows(&centres, KERNEL, sampling);
            let errors = set
                .rows
                .iter()
                .map(|row| centroid(&patch, &centres, row).norm());
            errors.fold(0.0_f64, f64::max)
        };
        let [adjusted, quadrature, area] =
            [Sampling::Adjusted, Sampling::Quadrature, Sampling::Area].map(worst);
        assert!(adjusted < 1e-12, "{adjusted}");
        assert!(quadrature < 1e-12, "{quadrature}");
        // What the adjustments are for: a hundredth of the radius at about 70 vertices per support.
        assert!(area > 1e-3 && area < 3e-2, "{area}");
    }
}

#[test]
fn affine_rows_say_so() {
    let patch = irregular_square(24, 1, &[]);
    let centres = interior(&patch);
    let all_are = |sampling, order| {
        let set = patch.rows(&centres, KERNEL, sampling);
        set.rows.iter().all(|row| row.order == order)
    };
    assert!(all_are(Sampling::Area, Order::Constant));
    assert!(all_are(Sampling::Adjusted, Order::Affine));
    assert!(all_are(Sampling::Quadrature, Order::Quadratic));
}

#[test]
fn rows_at_a_border_have_the_centroid_of_the_clipped_kernel() {
    for (seed, inset) in [(0, 0.0), (1, 0.25), (2, 0.0), (3, 0.25)] {
        let place = [inset - 1.0, 0.0];
        let patch = irregular_square(24, seed, &[place]);
        let centre = patch.vertex_near([place[0], place[1], 0.0].into());
        let expected = Vector2::new(half_plane_centroid(inset), 0.0);
        for sampling in [Sampling::Adjusted, Sampling::Quadrature] {
            let set = patch.rows(&[centre], KERNEL, sampling);
            let error = (centroid(&patch, &[centre], &set.rows[0]) - expected).norm();
            assert!(error < 1e-3, "{sampling:?} at {inset}: {error}");
        }
    }
}

#[test]
fn both_affine_samplings_share_one_target_at_borders_and_corners() {
    let patch = irregular_square(24, 5, &[]);
    let all: Vec<VertexId> = (0..patch.positions.len() as u32).map(VertexId).collect();
    let adjusted = patch.rows(&all, KERNEL, Sampling::Adjusted);
    let quadrature = patch.rows(&all, KERNEL, Sampling::Quadrature);
    for (a, q) in adjusted.rows.iter().zip(&quadrature.rows) {
        let difference = (centroid(&patch, &all, a) - centroid(&patch, &all, q)).norm();
        assert!(difference < 1e-12, "vertex {}: {difference}", a.centre);
    }
}
