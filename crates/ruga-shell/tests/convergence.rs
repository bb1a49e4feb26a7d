//! Bending and foundation against their continuum values.

mod meshes;

use std::f64::consts::PI;

use meshes::{jittered, lattice};
use nalgebra::Vector3;
use ruga_shell::{
    BendingModel, FaceParameters, HingeShape, LayerEnergy, LayerParameters, MAX_EDGE_RATIO,
    RestTriangle,
};

const SKIN: FaceParameters = FaceParameters {
    young: 6e8,
    poisson: 0.48,
    thickness: 1.2e-4,
    normal_stiffness: 0.0,
    gradient_stiffness: 0.0,
};

/// Twice the bending energy of the surface `z = shape(x, y)` over `D kappa^2` and the area that
/// bends, curvature scaled to one.
fn bending(
    model: BendingModel,
    poisson: f64,
    rotation: f64,
    shape: impl Fn(f64, f64) -> f64,
) -> f64 {
    let (columns, rows, edge, curvature) = (80, 92, 1e-3, 0.05);
    let mesh = lattice(columns, rows, edge);
    let skin = FaceParameters { poisson, ..SKIN };
    let layer = mesh.layer(skin, model);
    let (sin, cos) = rotation.sin_cos();
    let x: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| {
            let (u, v) = (cos * p.x + sin * p.y, cos * p.y - sin * p.x);
            p + Vector3::z() * (curvature * shape(u, v))
        })
        .collect();
    // Outline hinges are missing: the lattice has 3 hinges per vertex inside; count their share.
    let hinges = mesh.faces.len() as f64 * 1.5;
    let outline = (2 * (columns - 1) + 2 * (rows - 1)) as f64;
    let present = match model {
        BendingModel::Hinge => (3.0 * mesh.faces.len() as f64 - outline) / 2.0 / hinges,
        BendingModel::VertexCurvature => 1.0,
    };
    let area: f64 = layer.vertex_areas().iter().sum();
    2.0 * layer.energy_parts(&x).bending
        / (skin.bending_modulus() * curvature * curvature * area * present)
}

#[test]
fn cylinders_bend_with_the_plate_modulus_in_every_direction() {
    for k in 0..12 {
        let rotation = f64::from(k) * PI / 12.0;
        let stiffness = bending(BendingModel::Hinge, 0.48, rotation, |u, _| 0.5 * u * u);
        // The outline's missing hinges are not spread evenly over the three directions.
        assert!((stiffness - 1.0).abs() < 0.01, "{k}: {stiffness}");
        for poisson in [0.0, 0.3, 0.48] {
            let model = BendingModel::VertexCurvature;
            let stiffness = bending(model, poisson, rotation, |u, _| 0.5 * u * u);
            // At the outline, 2 % of the area, nothing resists bending across it.
            assert!(
                stiffness < 1.001 && stiffness > 0.98,
                "{poisson} {k}: {stiffness}"
            );
        }
    }
}

#[test]
fn sphere_and_saddle_show_the_poisson_ratio_of_stars() {
    for poisson in [0.0, 0.3, 0.48] {
        for (sign, expected) in [(1.0, 2.0 * (1.0 + poisson)), (-1.0, 2.0 * (1.0 - poisson))] {
            let model = BendingModel::VertexCurvature;
            let found = bending(model, poisson, 0.2, |u, v| 0.5 * (u * u + sign * v * v));
            // 2 % of the area lie at the outline, where bending across it is free.
            let ratio = found / expected;
            assert!(ratio < 1.001 && ratio > 0.975, "{poisson} {sign}: {ratio}");
        }
    }
}

/// Left apex, edge along x from 0 to 1, right apex.
fn hinge(left: [f64; 2], right: [f64; 2]) -> (HingeShape, [[f64; 2]; 4], f64) {
    let points = [[0.0, 0.0], [1.0, 0.0], left, right];
    let triangle = |corners: [usize; 3]| {
        let corners = corners.map(|k| Vector3::new(points[k][0], points[k][1], 0.0));
        RestTriangle::new(&corners, 0).expect("a proper triangle")
    };
    // The left one winds 0, 1, 2 from another start; the right one 1, 0, 3.
    let (left, right) = (triangle([2, 0, 1]), triangle([1, 0, 3]));
    (
        HingeShape::new(&left, 1, &right, 0),
        points,
        left.area() + right.area(),
    )
}

#[test]
fn the_full_factor_gives_each_hinge_the_mean_energy_of_a_cylinder() {
    let (shape, points, areas) = hinge([0.3, 0.8], [0.6, -0.9]);
    let modulus = 2.0;
    let stiffness = shape.stiffness(modulus, 1.0);
    let by_height = shape.angle_by_height();
    let count = 720;
    let mean = (0..count)
        .map(|i| {
            let (sin, cos) = (PI * f64::from(i) / f64::from(count)).sin_cos();
            let angle: f64 = (0..4)
                .map(|k| {
                    let along = cos * points[k][0] + sin * points[k][1];
                    by_height[k] * 0.5 * along * along
                })
                .sum();
            0.5 * stiffness * angle * angle
        })
        .sum::<f64>()
        / f64::from(count);
    // A hinge stands for a third of its two triangles.
    assert!((mean / (0.5 * modulus * areas / 3.0) - 1.0).abs() < 1e-12);
    // The default lies half way, in the geometric sense.
    let plain = shape.stiffness(modulus, 0.0);
    assert!((plain - modulus / areas).abs() < 1e-14);
    let half = shape.stiffness(modulus, 0.5);
    assert!((half - (plain * stiffness).sqrt()).abs() < 1e-14);
    assert!((stiffness / plain - 1.0).abs() > 0.01);
}

#[test]
fn stretched_triangles_keep_the_plain_hinge() {
    let (shape, _, areas) = hinge([0.5, 0.4], [0.5, -0.4]);
    assert!(1.0 / 0.5_f64.hypot(0.4) > MAX_EDGE_RATIO);
    assert_eq!(shape.stiffness(3.0, 0.5), 3.0 / areas);
}

#[test]
fn sphere_and_saddle_show_the_hinges_poisson_ratio_of_minus_a_third() {
    // Table of the calibration: 4/3 and 8/3 of the cylinder; a plate has 2 (1 +- nu).
    let hinges = BendingModel::Hinge;
    let sphere = bending(hinges, 0.48, 0.2, |u, v| 0.5 * (u * u + v * v));
    let saddle = bending(hinges, 0.48, 0.2, |u, v| 0.5 * (u * u - v * v));
    assert!((sphere - 4.0 / 3.0).abs() < 0.01, "{sphere}");
    assert!((saddle - 8.0 / 3.0).abs() < 0.02, "{saddle}");
}

#[test]
fn a_developable_bend_costs_little_membrane_energy() {
    for model in [BendingModel::Hinge, BendingModel::VertexCurvature] {
        let (columns, rows, edge, radius) = (40, 12, 1e-4, 5e-3);
        let mesh = jittered(columns, rows, edge, 0.2, 8);
        let layer = mesh.layer(SKIN, model);
        let bend = |p: &Vector3<f64>| {
            let angle = p.x / radius;
            Vector3::new(radius * angle.sin(), p.y, radius * (1.0 - angle.cos()))
        };
        let x: Vec<_> = mesh.positions.iter().map(bend).collect();
        let parts = layer.energy_parts(&x);
        assert!(parts.membrane < 0.01 * parts.bending, "{parts:?}");
    }
}

/// Foundation energy of `w = sin(k x)` over whole wavelengths, per `1/4 area`: `K0 + K1 k^2`.
fn foundation(points_per_wavelength: usize, normal: f64, gradient: f64) -> f64 {
    let (waves, edge) = (4, 1e-4);
    let mesh = lattice(points_per_wavelength * waves + 1, 21, edge);
    let wavelength = points_per_wavelength as f64 * edge;
    let k = 2.0 * PI / wavelength;
    let face = FaceParameters {
        normal_stiffness: normal,
        gradient_stiffness: gradient,
        ..SKIN
    };
    let parameters = LayerParameters::uniform(face, mesh.faces.len(), 0.0, mesh.positions.len());
    let pinned = vec![false; mesh.positions.len()];
    let layer = LayerEnergy::new(&mesh.topology(), &mesh.positions, parameters, &pinned)
        .expect("a valid lattice");
    let lifted: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| p + Vector3::z() * (1e-5 * (k * p.x).sin()))
        .collect();
    let parts = layer.energy_parts(&lifted);
    let area: f64 = layer.vertex_areas().iter().sum();
    (parts.normal + parts.gradient) / (0.25 * area * 1e-10)
}

#[test]
fn foundation_dispersion() {
    let (normal, gradient) = (3e9, 5.0);
    for points in [8, 12, 24, 48] {
        let edge = 1e-4;
        let k = 2.0 * PI / (points as f64 * edge);
        // Mass: half lumped (1) and half consistent (1 - (ka)^2/8 on this lattice to second
        // order); gradient of linear elements: (sin(ka/2)/(ka/2))^2 to second order.
        let order = (k * edge) * (k * edge);
        let mass = foundation(points, normal, 0.0) / normal;
        let slope = foundation(points, 0.0, gradient) / (gradient * k * k);
        assert!((mass - 1.0).abs() < 0.1 * order, "{points}: {mass}");
        assert!((slope - 1.0).abs() < 0.1 * order, "{points}: {slope}");
        let both = foundation(points, normal, -gradient);
        let expected = normal * mass - gradient * k * k * slope;
        assert!((both - expected).abs() < 1e-9 * normal);
    }
}
