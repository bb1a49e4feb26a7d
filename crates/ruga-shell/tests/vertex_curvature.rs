//! The stencil around a vertex: derivatives against central differences, and what it must not feel.

mod differences;
mod meshes;

use std::f64::consts::PI;

use differences::{check_layer, dense};
use meshes::{random_rotation, random_vector, rng, symmetric};
use nalgebra::{Matrix3, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{
    BendingModel, FaceParameters, HingeState, LayerEnergy, LayerParameters, RestTriangle, StarShape,
};

/// A vertex and `valence` neighbours at unequal angles and distances, `height(x, y)` above a plane.
fn star(valence: usize, seed: u64, height: impl Fn(f64, f64) -> f64) -> Vec<Vector3<f64>> {
    let mut rng = rng(seed);
    let mut points = vec![Vector3::zeros()];
    for k in 0..valence {
        let angle = 2.0 * PI * (k as f64 + 0.25 * symmetric(&mut rng)) / valence as f64;
        let length = 1.0 + 0.3 * symmetric(&mut rng);
        let (sin, cos) = angle.sin_cos();
        points.push(Vector3::new(length * cos, length * sin, 0.0));
    }
    for p in &mut points {
        p.z = height(p.x, p.y);
    }
    points
}

/// The faces of a star whose first neighbour follows the last, or of one with a border between.
fn fan(points: &[Vector3<f64>], faces: usize) -> Vec<(RestTriangle, usize)> {
    let neighbours = points.len() - 1;
    (0..faces)
        .map(|k| {
            // Each face starts at another corner, so that none is taken for granted.
            let mut corners = [0, k + 1, (k + 1) % neighbours + 1].map(|i| points[i]);
            corners.rotate_right(k % 3);
            let face = RestTriangle::new(&corners, k).expect("a proper triangle");
            (face, k % 3)
        })
        .collect()
}

fn closed(points: &[Vector3<f64>]) -> StarShape {
    StarShape::closed(&fan(points, points.len() - 1))
}

/// Angles at the edges from the first point to each neighbour.
fn angles(points: &[Vector3<f64>]) -> Vec<f64> {
    let count = points.len() - 1;
    (0..count)
        .map(|k| {
            let at = |i: usize| points[1 + (k + i) % count];
            HingeState::new(&[points[0], at(0), at(1), at(count - 1)]).angle()
        })
        .collect()
}

/// A thick layer of the faces of a star, with no foundation.
fn layer(rest: &[Vector3<f64>], faces: usize, poisson: f64) -> LayerEnergy {
    let count = rest.len() as u32 - 1;
    let corners = (0..faces as u32).map(|k| [0, k + 1, (k + 1) % count + 1]);
    let mesh = TriMesh::new(rest.len(), corners.collect()).expect("a star is a mesh");
    let face = FaceParameters {
        young: 1.0,
        poisson,
        thickness: 3.0,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let parameters = LayerParameters::uniform(face, faces, 0.0, rest.len());
    let model = BendingModel::VertexCurvature;
    LayerEnergy::with_bending(&mesh, rest, parameters, &vec![false; rest.len()], model)
        .expect("a valid layer")
}

fn closed_layer(rest: &[Vector3<f64>], poisson: f64) -> LayerEnergy {
    layer(rest, rest.len() - 1, poisson)
}

/// Bending energy of one star (J), for a stiffness of 2 J m².
fn energy(shape: &StarShape, poisson: f64, bends: &[f64]) -> f64 {
    let rows = shape.rows(2.0, poisson);
    let bend: Vector3<f64> = rows
        .iter()
        .zip(bends)
        .map(|(row, angle)| row * *angle)
        .sum();
    0.5 * bend.norm_squared()
}

/// The points of a star from its first neighbour to the one `faces` on.
fn half_star(faces: usize, seed: u64, height: impl Fn(f64, f64) -> f64) -> Vec<Vector3<f64>> {
    let mut points = star(2 * faces, seed, height);
    points.truncate(faces + 2);
    points
}

fn saddle(x: f64, y: f64) -> f64 {
    0.3 * (x * x - y * y) + 0.1 * x * y
}

#[test]
fn derivatives_of_stars_of_any_valence() {
    for valence in 3..=9 {
        for (case, noise) in [0.0, 1e-3, 0.1, 0.3].into_iter().enumerate() {
            let seed = (10 * valence + case) as u64;
            let mut rng = rng(seed);
            // Flat rest for even cases, curved for odd ones.
            let rest = star(valence, seed, |x, y| {
                if case % 2 == 0 { 0.0 } else { saddle(x, y) }
            });
            let layer = closed_layer(&rest, [0.0, 0.3, 0.48, -0.3][case]);
            let turn = random_rotation(&mut rng);
            let x: Vec<_> = rest
                .iter()
                .map(|p| turn * p * 0.95 + random_vector(&mut rng) * noise)
                .collect();
            check_layer(&layer, &x);
        }
    }
}

#[test]
fn derivatives_of_border_stars() {
    for faces in 2..=6 {
        for (case, noise) in [1e-3, 0.1, 0.3].into_iter().enumerate() {
            let seed = (100 * faces + case) as u64;
            let mut rng = rng(seed);
            let rest = half_star(faces, seed, saddle);
            let x: Vec<_> = rest
                .iter()
                .map(|p| p + random_vector(&mut rng) * noise)
                .collect();
            check_layer(&layer(&rest, faces, 0.3), &x);
        }
    }
}

/// Bent along the border a plate's border is a beam; bent across it costs nothing there.
#[test]
fn border_stars_have_no_moment_across_the_border() {
    let lattice = affine_star();
    // Along the first axis: neighbours on the border are the first and the fourth.
    let half: Vec<_> = [0, 1, 2, 3, 4].map(|i| lattice[i]).to_vec();
    let shape = StarShape::open(&fan(&half, 3));
    for poisson in [0.0, 0.3, 0.48] {
        for (k, l, m) in [
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (0.0, 0.0, 1.0),
            (1.0, -2.0, 0.5),
        ] {
            let scale = 1e-4;
            let bent: Vec<_> = half
                .iter()
                .map(|p| {
                    let z = 0.5 * (k * p.x * p.x + l * p.y * p.y) + m * p.x * p.y;
                    Vector3::new(p.x, p.y, scale * z)
                })
                .collect();
            let expected = (1.0 - poisson * poisson) * k * k + 2.0 * (1.0 - poisson) * m * m;
            let found = energy(&shape, poisson, &angles(&bent)[1..3]) / (scale * scale);
            assert!(
                (found - expected).abs() < 1e-6,
                "{poisson} {k} {l} {m}: {found}, {expected}"
            );
        }
    }
}

/// Bent by more than a right angle over the star.
#[test]
fn derivatives_of_strongly_bent_stars() {
    for valence in 3..=9 {
        let rest = star(valence, 3, |_, _| 0.0);
        let x: Vec<_> = rest
            .iter()
            .map(|p| Vector3::new((1.2 * p.x).sin(), p.y + 0.1 * p.x, (1.2 * p.x).cos()))
            .collect();
        check_layer(&closed_layer(&rest, 0.48), &x);
    }
}

#[test]
fn the_gauss_newton_part_is_positive_and_all_there_is_at_rest() {
    for valence in 3..=9 {
        let rest = star(valence, 20, |_, _| 0.0);
        let layer = closed_layer(&rest, 0.48);
        let mut exact = vec![0.0; layer.pattern().1.len()];
        let mut part = exact.clone();
        layer.hessian(&rest, &mut exact, Some(&mut part));
        let [exact, part] = [exact, part].map(|values| dense(layer.pattern(), &values));
        assert!((&exact - &part).amax() < 1e-12 * part.amax());
        let values = part.symmetric_eigenvalues();
        assert!(values.min() > -1e-12 * values.max());
    }
}

#[test]
fn collapsed_stars_stay_finite() {
    let rest = star(6, 40, |_, _| 0.0);
    let layer = closed_layer(&rest, 0.3);
    let mut folded = rest.clone();
    folded[1] = folded[2];
    let line: Vec<_> = rest.iter().map(|p| Vector3::new(p.x, 0.0, 0.0)).collect();
    for x in [vec![Vector3::zeros(); 7], line, folded] {
        assert!(layer.value(&x).is_finite());
        let mut gradient = vec![0.0; layer.dof_count()];
        layer.gradient(&x, &mut gradient);
        let mut hessian = vec![0.0; layer.pattern().1.len()];
        layer.hessian(&x, &mut hessian, None);
        assert!(gradient.iter().chain(&hessian).all(|c| c.is_finite()));
    }
}

/// Rest stars that are needles, cones or folded far over keep finite, bounded weights.
#[test]
fn odd_rest_shapes_stay_finite() {
    let thin = star(5, 50, |_, _| 0.0);
    let thin: Vec<_> = thin
        .iter()
        .map(|p| Vector3::new(p.x, 1e-3 * p.y, 0.0))
        .collect();
    let cone = star(3, 51, |x, y| -30.0 * x.hypot(y));
    // One face takes up nearly all of what angle there is, and more than half a turn unfolded.
    let lopsided = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [-0.8, 0.5, 0.0],
        [0.1, 0.1, 1.0],
    ];
    let lopsided: Vec<_> = lopsided.map(Vector3::from).to_vec();
    for rest in [thin, cone, lopsided] {
        let shape = closed(&rest);
        assert!(energy(&shape, 0.48, &angles(&rest)).is_finite());
        assert!(shape.correction().norm() < 20.0, "{shape:?}");
    }
}

/// Curvature in components of a surface of curvature `k` (xx, yy, xy).
fn components(k: [f64; 3]) -> Vector3<f64> {
    Vector3::new(k[0] + k[1], k[0] - k[1], 2.0 * k[2]) / 2.0_f64.sqrt()
}

/// The star of a lattice, stretched and sheared: the first spoke lies on the first axis.
fn affine_star() -> Vec<Vector3<f64>> {
    let (u, v) = (Vector3::new(1.7, 0.0, 0.0), Vector3::new(0.3, 0.6, 0.0));
    vec![Vector3::zeros(), u, u + v, v, -u, -u - v, -v]
}

/// On lattices of any triangle, quadratic surfaces have their own curvature.
#[test]
fn lattice_stars_are_exact_on_quadratic_surfaces() {
    let flat = affine_star();
    let shape = closed(&flat);
    assert!((shape.correction() - Matrix3::identity()).amax() < 1e-12);
    for k in [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.3, -2.0, 0.7],
    ] {
        // Small, because the angles are those of the surface itself.
        let scale = 1e-5;
        let bent: Vec<_> = flat
            .iter()
            .map(|p| {
                let depth = 0.5 * (k[0] * p.x * p.x + k[1] * p.y * p.y) + k[2] * p.x * p.y;
                Vector3::new(p.x, p.y, -scale * depth)
            })
            .collect();
        let found = shape.curvature(&angles(&bent)) / scale;
        assert!((found - components(k)).amax() < 1e-7, "{k:?}: {found}");
    }
}

/// `A D/2 (tr^2 - 2 (1 - nu) det)` of such a star.
#[test]
fn the_poisson_ratio_is_that_of_the_plate() {
    let lattice = affine_star();
    let shape = closed(&lattice);
    for poisson in [0.0, 0.3, 0.48] {
        for (k, l) in [(1.0, 0.0), (1.0, 1.0), (1.0, -1.0), (0.5, 2.0)] {
            let scale = 1e-4;
            let bent: Vec<_> = lattice
                .iter()
                .map(|p| {
                    let z = 0.5 * scale * (k * p.x * p.x + l * p.y * p.y);
                    Vector3::new(p.x, p.y, z)
                })
                .collect();
            let expected = (k + l) * (k + l) - 2.0 * (1.0 - poisson) * k * l;
            let found = energy(&shape, poisson, &angles(&bent)) / (scale * scale);
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{poisson} {k} {l}: {found}"
            );
        }
    }
}
