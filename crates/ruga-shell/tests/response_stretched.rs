//! The bending modulus with which irregular and stretched meshes respond, with either model.

mod meshes;

use std::f64::consts::PI;

use meshes::{PeriodicMesh, blue_noise};
use nalgebra::{Vector2, Vector3};
use ruga_shell::{BendingModel, HINGE_EXPONENT, ResponseQuery, response_modulus};

/// Blue noise stretched along x and compressed at an angle to it, in a periodic cell.
struct Noise {
    stretch: f64,
    /// Degrees between the long side of the triangles and the compression.
    angle: f64,
    /// Edges per wavelength, along the compression.
    edges: f64,
    smoothings: usize,
    seed: u64,
}

/// Response of a mesh over the modulus that it was given.
#[derive(Clone, Copy, Debug)]
struct Response {
    /// As the layer wrinkles, with its half-consistent foundation.
    whole: f64,
    /// Without what the foundation's mass takes off.
    bending: f64,
}

impl Noise {
    fn direction(&self) -> Vector3<f64> {
        let (sin, cos) = self.angle.to_radians().sin_cos();
        Vector3::new(cos, sin, 0.0)
    }

    /// A cell of about three wavelengths of unit length, which fit along the compression.
    fn mesh(&self) -> PeriodicMesh {
        let d = self.direction();
        let edge = (d.x / self.stretch).hypot(d.y) / self.edges;
        let side = |cosine: f64| {
            if cosine < 1e-9 {
                2.0
            } else {
                (3.0 * cosine).round() / cosine
            }
        };
        let cell = Vector2::new(side(d.x) / self.stretch, side(d.y));
        let count = (cell.x * cell.y / (edge * edge * 0.75_f64.sqrt())).round() as usize;
        let margin = (6.0 * edge).min(cell.x).min(cell.y);
        PeriodicMesh::delaunay(cell, blue_noise(cell, count, self.seed), margin)
            .smoothed(self.smoothings, margin)
            .stretched(self.stretch)
    }

    fn response(&self, mesh: &PeriodicMesh, model: BendingModel, poisson: f64) -> Response {
        let result = response_modulus(&ResponseQuery {
            mesh: &mesh.topology(),
            corners: &mesh.corners,
            directions: &vec![self.direction(); mesh.faces.len()],
            fixed: &vec![false; mesh.points.len()],
            bending_modulus: 1.0,
            poisson,
            bending_model: model,
            hinge_exponent: HINGE_EXPONENT,
            normal_stiffness: (2.0 * PI).powi(4),
            gradient_stiffness: 0.0,
        })
        .expect("a valid query");
        assert!(result.converged);
        Response {
            whole: result.bending_modulus,
            bending: result.bending_modulus / result.mass_share,
        }
    }
}

fn star_and_hinge(noise: &Noise, poisson: f64) -> [Response; 2] {
    let mesh = noise.mesh();
    let models = [BendingModel::VertexCurvature, BendingModel::Hinge];
    models.map(|model| noise.response(&mesh, model, poisson))
}

#[test]
fn stars_respond_as_the_plate_on_blue_noise() {
    for (seed, smoothings, poisson) in [(1, 0, 0.0), (2, 0, 0.48), (3, 3, 0.0), (4, 3, 0.48)] {
        for edges in [8.0, 12.0, 16.0] {
            let (stretch, angle) = (1.0, 90.0);
            let noise = Noise {
                stretch,
                angle,
                edges,
                smoothings,
                seed,
            };
            let [star, hinge] = star_and_hinge(&noise, poisson);
            // Measured: 0.998 to 1.013, and with the foundation's mass 0.98 at 12 edges.
            assert!(
                (star.bending - 1.0).abs() < 0.02,
                "{seed} {edges}: {star:?}"
            );
            let defect = if edges < 10.0 { 0.05 } else { 0.03 };
            assert!(
                (star.whole - 1.0).abs() < defect,
                "{seed} {edges}: {star:?}"
            );
            // Hinges have their factor to thank for 1.00 to 1.08.
            assert!(hinge.bending > 0.99 && hinge.bending < 1.1, "{hinge:?}");
        }
    }
}

#[test]
fn stars_respond_as_the_plate_on_triangles_stretched_2_to_1_in_any_direction() {
    // Hinges, 90 to 0 degrees: 0.77, 1.05, 1.3, 1.8, 2.7.
    let hinges = [
        (90.0, 0.77),
        (60.0, 1.05),
        (45.0, 1.3),
        (30.0, 1.8),
        (0.0, 2.7),
    ];
    for (seed, (angle, expected)) in hinges.into_iter().enumerate() {
        for (smoothings, poisson) in [(0, 0.0), (3, 0.48)] {
            let noise = Noise {
                stretch: 2.0,
                angle,
                edges: 12.0,
                smoothings,
                seed: seed as u64,
            };
            let [star, hinge] = star_and_hinge(&noise, poisson);
            assert!(
                (star.bending - 1.0).abs() < 0.025,
                "{angle} {smoothings}: {star:?}"
            );
            assert!(
                (star.whole - 1.0).abs() < 0.03,
                "{angle} {smoothings}: {star:?}"
            );
            assert!(
                (hinge.bending / expected - 1.0).abs() < 0.15,
                "{angle}: {hinge:?}"
            );
        }
    }
}

#[test]
fn stars_bear_triangles_stretched_4_to_1_with_the_short_side_across_the_wrinkles() {
    for (seed, smoothings, poisson) in [(1, 0, 0.48), (2, 3, 0.0), (3, 3, 0.48)] {
        let across = |angle| Noise {
            stretch: 4.0,
            angle,
            edges: 12.0,
            smoothings,
            seed,
        };
        let [star, hinge] = star_and_hinge(&across(90.0), poisson);
        assert!((star.bending - 1.0).abs() < 0.02, "{seed}: {star:?}");
        assert!((star.whole - 1.0).abs() < 0.035, "{seed}: {star:?}");
        assert!((hinge.bending - 0.7).abs() < 0.04, "{seed}: {hinge:?}");
        let [star, _] = star_and_hinge(&across(60.0), poisson);
        assert!((star.bending - 1.0).abs() < 0.06, "{seed}: {star:?}");
        assert!((star.whole - 1.0).abs() < 0.06, "{seed}: {star:?}");
    }
}

/// Their long side across the wrinkles, obtuse triangles make the Laplacian itself too stiff; not
/// twenty times, as hinges.
#[test]
fn stars_are_a_tenth_too_stiff_with_the_long_side_across_the_wrinkles_at_4_to_1() {
    for angle in [45.0, 30.0, 0.0] {
        let noise = Noise {
            stretch: 4.0,
            angle,
            edges: 12.0,
            smoothings: 3,
            seed: 1,
        };
        let [star, hinge] = star_and_hinge(&noise, 0.3);
        assert!(
            star.bending > 1.02 && star.bending < 1.16,
            "{angle}: {star:?}"
        );
        assert!(hinge.bending > 1.7, "{angle}: {hinge:?}");
    }
}

/// With a Poisson ratio of one the energy is that of the Laplacian alone: what linear triangles make
/// of it at twelve edges per wavelength is as large as the whole excess, and falls with the square of the
/// edge. With others the traceless part leaves 3 to 11 % however fine the mesh.
#[test]
fn the_laplacian_alone_exceeds_as_much_at_4_to_1_and_converges() {
    for angle in [60.0, 45.0, 30.0, 0.0] {
        let excess = |edges| {
            let noise = Noise {
                stretch: 4.0,
                angle,
                edges,
                smoothings: 0,
                seed: 1,
            };
            let mesh = noise.mesh();
            let of = |poisson| {
                let response = noise.response(&mesh, BendingModel::VertexCurvature, poisson);
                response.bending - 1.0
            };
            [of(1.0), of(0.3)]
        };
        let [[coarse, whole], [fine, limit]] = [12.0, 36.0].map(excess);
        println!(
            "{angle}: Laplacian {coarse:.3}, then {fine:.3}; all of it {whole:.3}, then {limit:.3}"
        );
        assert!(coarse > 0.7 * whole, "{angle}: {coarse} of {whole}");
        assert!(fine < 0.2 * coarse && fine < 0.035, "{angle}: {fine}");
        assert!((0.02..0.13).contains(&limit), "{angle}: {limit}");
    }
}

/// Also with three edges per wavelength, where the space of all modes is soon exhausted.
#[test]
fn coarse_meshes_respond_like_skin() {
    for seed in 0..40 {
        for edges in [3.0, 4.0, 5.0] {
            let noise = Noise {
                stretch: 1.0,
                angle: 90.0,
                edges,
                smoothings: 1,
                seed,
            };
            let mesh = noise.mesh();
            let response = noise.response(&mesh, BendingModel::VertexCurvature, 0.3);
            println!("{} {seed} {edges} {response:?}", mesh.points.len());
            assert!(
                (0.6..1.4).contains(&response.bending),
                "{seed} {edges} {response:?}"
            );
        }
    }
}
