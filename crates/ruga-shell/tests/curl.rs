//! Shapes of free sheets that bend by themselves.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod free_sheets;
mod meshes;
mod sheets;

use free_sheets::{Free, bare, disc, free_layer, in_frames, principal_curvatures};
use meshes::Mesh;
use nalgebra::{Matrix2, Rotation2, Vector2, Vector3};
use ruga_material::{Laminate, Ply};
use ruga_shell::FaceParameters;

/// Share of the length of a strip that it is wide.
const WIDTH: f64 = 0.1;

/// Irregular triangles on a strip of unit length along x.
fn strip(across: usize) -> Mesh {
    let edge = WIDTH / across as f64;
    let columns = (1.0 / (edge * 0.75_f64.sqrt())).round() as usize;
    let sheet = sheets::Sheet {
        columns,
        rows: across,
        dx: 1.0 / columns as f64,
        dy: edge,
        start: -0.5,
        jitter: 0.25,
    };
    sheet.mesh(5)
}

/// A strip of two plies, of which the upper one is `strain` longer along the strip: its curvature at rest and
/// that of the laminate.
fn bent_strip(across: usize, modulus: f64, strain: f64) -> [f64; 2] {
    let poisson = 0.3;
    let ply = |modulus: f64, natural_strain: f64, thickness: f64| Ply {
        modulus: modulus / (1.0 - poisson * poisson),
        natural_strain,
        thickness,
    };
    let plies = [ply(3.0 * modulus, 0.0, 1e-3), ply(modulus, strain, 2e-3)];
    let laminate = Laminate::new(&plies).unwrap();
    // A uniform sheet with the stiffness of the plies.
    let ratio = laminate.bending_stiffness / laminate.stretching_stiffness;
    let thickness = (12.0 * ratio).sqrt();
    let young = laminate.stretching_stiffness * (1.0 - poisson * poisson) / thickness;
    let face = bare(young, poisson, thickness);
    let mesh = strip(across);
    let mut layer = free_layer(&mesh, face);
    let tensor = Matrix2::new(laminate.natural_curvature, 0.0, 0.0, 0.0);
    layer
        .set_natural_curvatures(&in_frames(&mesh, |_| tensor))
        .unwrap();
    let sheet = Free {
        mesh: &mesh,
        layer: &layer,
        energy: 1e-3 * face.bending_modulus() * WIDTH,
    };
    let x = sheet.settle(&mesh.positions);
    let [found, _] = principal_curvatures(&mesh.positions, &x, |p| p.x.abs() < 0.05);
    [found, laminate.natural_curvature]
}

/// To half a per mille at 4, 8 and 24 edges across, of which the fit of a parabola to a circle makes most.
#[test]
fn a_strip_bends_to_the_curvature_of_its_laminate() {
    let [found, expected] = bent_strip(8, 1e9, 2.5e-3);
    assert!(expected > 1.0, "a radian or more over its length");
    assert!((found / expected - 1.0).abs() < 0.001, "{found} {expected}");
    // Whatever the modulus.
    let [stiff, _] = bent_strip(8, 1e11, 2.5e-3);
    assert!((stiff / found - 1.0).abs() < 1e-6, "{stiff} {found}");
    let [straight, _] = bent_strip(4, 1e9, 0.0);
    assert!(straight.abs() < 1e-9 * expected, "{straight}");
}

/// A disc of radius 1 and its natural curvature `load h`, the same in all directions.
struct Disc {
    mesh: Mesh,
    face: FaceParameters,
    curvature: f64,
}

impl Disc {
    /// `load` is the natural curvature in units of thickness over the radius squared.
    fn new(edges: usize, seed: u64, [load, thickness, poisson]: [f64; 3]) -> Self {
        Self {
            mesh: disc(edges, 0, 0.2, seed),
            face: bare(1.0, poisson, thickness),
            curvature: load * thickness,
        }
    }

    /// The two principal curvatures around its centre, in units of the natural one, where it comes to rest
    /// from the quadratic surface of curvature `start`.
    fn settle(&self, start: Matrix2<f64>) -> [f64; 2] {
        let mut layer = free_layer(&self.mesh, self.face);
        let natural = Matrix2::from_diagonal_element(self.curvature);
        let capped = layer
            .set_natural_curvatures(&in_frames(&self.mesh, |_| natural))
            .unwrap();
        assert_eq!(capped, 0);
        let sheet = Free {
            mesh: &self.mesh,
            layer: &layer,
            energy: self.face.bending_modulus() * self.curvature.powi(2),
        };
        let material = &self.mesh.positions;
        let raised = material.iter().map(|p| {
            let depth = 0.5 * p.xy().dot(&(start * p.xy()));
            Vector3::new(p.x, p.y, -self.curvature * depth)
        });
        let x = sheet.settle(&raised.collect::<Vec<_>>());
        let found = principal_curvatures(material, &x, |p| p.norm() < 0.5);
        found.map(|k| k / self.curvature)
    }
}

/// Curvature 1 across an axis that is turned by `angle`.
fn rolled(angle: f64) -> Matrix2<f64> {
    let across = Rotation2::new(angle) * Vector2::x();
    across * across.transpose()
}

#[test]
fn a_disc_that_bends_little_is_a_bowl() {
    for poisson in [0.0, 0.3, 0.48] {
        let disc = Disc::new(12, 3, [0.8, 0.02, poisson]);
        let [first, second] = disc.settle(0.5 * Matrix2::identity());
        assert!((first / second - 1.0).abs() < 0.002, "{first} {second}");
        // Where its edge would have to be longer, a bowl is flatter than it would like to be.
        assert!((0.9..1.0).contains(&first), "{first}");
        if poisson == 0.3 {
            assert!((first - 0.948).abs() < 0.002, "{first}");
        }
    }
}

/// A disc that bends much rolls up about one axis and keeps the moment of the other direction: `(1 + nu) k0`
/// but for the rim, where that moment vanishes. The rim is as wide as the root of thickness over curvature,
/// so that it counts for less and less: at loads of 50, 100, 200, 800 the curvature is 1.234, 1.273,
/// 1.287 and 1.30 k0 for a Poisson ratio of .3, to half a per cent from 14 edges per radius on.
#[test]
fn a_disc_that_bends_much_rolls_up() {
    for (poisson, seed) in [(0.0, 1), (0.3, 2), (0.48, 3)] {
        let disc = Disc::new(14, seed, [200.0, 1.25e-3, poisson]);
        let [first, second] = disc.settle(rolled(0.0));
        assert!(
            (first / (1.0 + poisson) - 1.0).abs() < 0.03,
            "{poisson}: {first}"
        );
        assert!(second.abs() < 0.02, "{poisson}: {second}");
    }
    let disc = Disc::new(14, 4, [50.0, 2.5e-3, 0.3]);
    let [first, _] = disc.settle(rolled(0.0));
    assert!((first - 1.234).abs() < 0.01, "{first}");
}

/// No direction of the mesh is preferred.
#[test]
fn a_disc_rolls_up_about_any_axis() {
    let disc = Disc::new(14, 5, [50.0, 5e-3, 0.3]);
    let found = [0.0, 0.5, 1.0, 1.5].map(|angle| disc.settle(rolled(angle))[0]);
    let (least, most) = found
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), &k| (a.min(k), b.max(k)));
    assert!(most / least < 1.005, "{found:?}");
}

/// The bowl gives way at a load of 5.53, 5.56 and 5.57 at 10, 20 and 32 edges per radius, for a Poisson ratio of
/// .3: from the square of the difference between the two curvatures, which grows in proportion beyond.
#[test]
fn the_bowl_gives_way_where_its_rim_can_take_no_more() {
    let curvatures = |load: f64| {
        let disc = Disc::new(12, 6, [load, 0.01, 0.3]);
        disc.settle(Matrix2::new(0.6, 0.0, 0.0, 0.4))
    };
    let [first, second] = curvatures(5.0);
    assert!(first / second < 1.02, "{first} {second}");
    let [first, second] = curvatures(6.0);
    assert!((first - 0.70).abs() < 0.03, "{first}");
    assert!((second - 0.24).abs() < 0.03, "{second}");
}
