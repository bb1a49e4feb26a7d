//! Centres come at the spacing that was asked for.

mod meshes;

use meshes::{Patch, equilateral_rectangle, irregular_square};
use nalgebra::{Rotation3, Vector3};
use ruga_constraint::{ClusterSettings, cluster_centres};
use ruga_mesh::{Id, PerVertex, VertexId};

fn everywhere(patch: &Patch) -> Vec<VertexId> {
    (0..patch.positions.len() as u32).map(VertexId).collect()
}

fn centres(patch: &Patch, spacing: &PerVertex<f64>) -> Vec<VertexId> {
    let settings = ClusterSettings::default();
    cluster_centres(
        &patch.mesh,
        &patch.positions,
        spacing,
        &everywhere(patch),
        &settings,
    )
    .expect("valid input")
}

/// Distances from each centre far from the border to its six nearest neighbours, over the spacing
/// at the centre: mean, and relative standard deviation.
fn neighbour_distances(
    patch: &Patch,
    chosen: &[VertexId],
    spacing: &PerVertex<f64>,
    is_inside: impl Fn(&Vector3<f64>) -> bool,
) -> (f64, f64) {
    let place = |v: VertexId| patch.positions[v.index()];
    let mut all = Vec::new();
    for &centre in chosen.iter().filter(|&&c| is_inside(&place(c))) {
        let mut distances: Vec<f64> = chosen
            .iter()
            .filter(|&&other| other != centre)
            .map(|&other| (place(other) - place(centre)).norm() / spacing[centre])
            .collect();
        distances.sort_by(f64::total_cmp);
        all.extend(&distances[..6]);
    }
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let variance = all.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / all.len() as f64;
    (mean, variance.sqrt() / mean)
}

#[test]
fn spacing_on_a_large_patch_is_the_asked_one() {
    for (patch, name) in [
        (equilateral_rectangle(2.0, 2.0, 0.0125), "equilateral"),
        (irregular_square(160, 3, &[]), "irregular"),
    ] {
        let low = patch
            .positions
            .iter()
            .fold(patch.positions[0], |m, p| m.inf(p));
        let high = patch
            .positions
            .iter()
            .fold(patch.positions[0], |m, p| m.sup(p));
        let spacing = PerVertex::filled(patch.positions.len(), 0.2);
        let chosen = centres(&patch, &spacing);
        let (mean, scatter) = neighbour_distances(&patch, &chosen, &spacing, |p| {
            p.x > low.x + 0.3 && p.y > low.y + 0.3 && p.x < high.x - 0.3 && p.y < high.y - 0.3
        });
        println!(
            "{name}: {} centres, mean {mean:.3}, scatter {scatter:.3}",
            chosen.len()
        );
        assert!((mean - 1.0).abs() < 0.05, "{name}: {mean}");
        assert!(scatter < 0.15, "{name}: {scatter}");
    }
}

#[test]
fn relaxation_evens_the_greedy_choice() {
    let patch = irregular_square(100, 4, &[]);
    let spacing = PerVertex::filled(patch.positions.len(), 0.25);
    let scatter = |relaxations| {
        let settings = ClusterSettings {
            relaxations,
            ..ClusterSettings::default()
        };
        let chosen = cluster_centres(
            &patch.mesh,
            &patch.positions,
            &spacing,
            &everywhere(&patch),
            &settings,
        )
        .expect("valid input");
        let is_inside = |p: &Vector3<f64>| p.x.abs().max(p.y.abs()) < 0.65;
        neighbour_distances(&patch, &chosen, &spacing, is_inside).1
    };
    let [greedy, relaxed] = [0, 30].map(scatter);
    println!("scatter {greedy:.3} -> {relaxed:.3}");
    assert!(relaxed < 0.8 * greedy, "{greedy} -> {relaxed}");
}

#[test]
fn spacing_follows_the_local_wavelength() {
    let patch = irregular_square(140, 5, &[]);
    let spacing: PerVertex<f64> = patch
        .positions
        .iter()
        .map(|p| 0.1 * 2.0_f64.powf(0.5 * (p.x + 1.0)))
        .collect();
    let chosen = centres(&patch, &spacing);
    for (low, high) in [(-0.8, -0.3), (-0.3, 0.2), (0.2, 0.75)] {
        let (mean, _) = neighbour_distances(&patch, &chosen, &spacing, |p| {
            p.y.abs() < 0.75 && p.x > low && p.x < high
        });
        println!("x in {low}..{high}: {mean:.3}");
        assert!((mean - 1.0).abs() < 0.07, "{low}..{high}: {mean}");
    }
}

#[test]
fn every_piece_gets_a_centre_unless_it_is_a_speck() {
    let island =
        |size: f64, at: f64| irregular_square(6, 1, &[]).mapped(|p| p * size + Vector3::x() * at);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for part in [island(1.0, 0.0), island(0.2, 3.0), island(0.05, 5.0)] {
        let offset = positions.len() as u32;
        faces.extend(part.face_list().iter().map(|f| f.map(|v| v + offset)));
        positions.extend(part.positions);
    }
    let patch = Patch::new(positions, faces);
    let spacing = PerVertex::filled(patch.positions.len(), 0.8);
    let chosen = centres(&patch, &spacing);
    let on = |island: u32| chosen.iter().filter(|v| v.0 / 49 == island).count();
    // 4 m² at 0.8 m: 4 (2/√3)/0.64 = 7.2; 0.16 m² is a quarter of a square, 0.01 m² a speck.
    assert_eq!([on(0), on(1), on(2)], [7, 1, 0]);
    assert_eq!(chosen.len(), 8);
}

#[test]
fn distances_respect_a_region_of_candidates() {
    // Of a square only the two outer fifths: centres stay in them, and each gets its share.
    let patch = irregular_square(50, 6, &[]);
    let region: Vec<VertexId> = everywhere(&patch)
        .into_iter()
        .filter(|v| patch.positions[v.index()].x.abs() > 0.6)
        .collect();
    let spacing = PerVertex::filled(patch.positions.len(), 0.2);
    let settings = ClusterSettings::default();
    let chosen = cluster_centres(&patch.mesh, &patch.positions, &spacing, &region, &settings)
        .expect("valid input");
    assert!(chosen.iter().all(|c| region.binary_search(c).is_ok()));
    let left = chosen.iter().filter(|c| patch.positions[c.index()].x < 0.0);
    let left = left.count() as f64 / chosen.len() as f64;
    assert!((left - 0.5).abs() < 0.03, "{left}");
}

#[test]
fn a_spacing_below_the_edge_takes_every_vertex_once() {
    let patch = irregular_square(6, 7, &[]);
    let spacing = PerVertex::filled(patch.positions.len(), 0.02);
    let mut chosen = centres(&patch, &spacing);
    chosen.sort();
    assert_eq!(chosen, everywhere(&patch));
}

#[test]
fn the_choice_is_the_same_on_a_moved_turned_scaled_or_mirrored_mesh() {
    for patch in [
        irregular_square(60, 8, &[]),
        equilateral_rectangle(2.0, 2.0, 0.05),
    ] {
        let spacing = PerVertex::filled(patch.positions.len(), 0.3);
        let expected = centres(&patch, &spacing);
        assert_eq!(centres(&patch, &spacing), expected);
        assert_eq!(centres(&patch.mirrored(), &spacing), expected);
        let turn = Rotation3::from_euler_angles(0.7, -0.4, 1.9);
        let moved = patch.mapped(|p| turn * p + Vector3::new(300.0, -200.0, 100.0));
        assert_eq!(centres(&moved, &spacing), expected);
        let millimetres = PerVertex::filled(patch.positions.len(), 300.0);
        assert_eq!(centres(&patch.mapped(|p| p * 1e3), &millimetres), expected);
    }
}
