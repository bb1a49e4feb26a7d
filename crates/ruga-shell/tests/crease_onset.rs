//! The load at which a film gives way along a crease, against the closed form.

mod meshes;

use std::f64::consts::PI;

use meshes::{PeriodicMesh, rng, symmetric};
use nalgebra::{Vector2, Vector3};
use ruga_mesh::{EdgeId, TriMesh};
use ruga_shell::{
    BendingModel, Crease, FoldSense, HINGE_EXPONENT, HingeShape, ResponseQuery, RestTriangle,
    creased_response,
};

/// A film of unit wavelength and bending modulus in a periodic cell, compressed along y, with a crease
/// along x.
struct Film {
    mesh: PeriodicMesh,
    topology: TriMesh,
    /// Edges on the line.
    line: Vec<EdgeId>,
}

/// Wavelengths between a crease and its next copy.
const SPACING: f64 = 8.0;

impl Film {
    /// `points` rows of vertices per wavelength, triangles `aspect` times as long along the line, vertices
    /// beside the line moved by up to `jitter` edges.
    fn new(points: f64, aspect: f64, jitter: f64, seed: u64) -> Self {
        let edge = 1.0 / (points * 0.75_f64.sqrt());
        let rows = 2 * (0.5 * SPACING * points).round() as usize;
        let columns = (1.5 / (edge * aspect)).ceil().max(4.0) as usize;
        let lattice = PeriodicMesh::lattice(columns, rows, edge);
        let on_line = |vertex: usize| vertex / columns == rows / 2;
        let mut rng = rng(seed);
        let points = lattice.points.iter().enumerate().map(|(v, p)| {
            let shift = Vector2::new(symmetric(&mut rng), symmetric(&mut rng)) * (jitter * edge);
            // Vertices of the line stay on it.
            p + if on_line(v) {
                Vector2::new(shift.x, 0.0)
            } else {
                shift
            }
        });
        let moved = PeriodicMesh::with_faces(lattice.cell, points.collect(), lattice.faces);
        let mesh = moved.stretched(aspect);
        let topology = mesh.topology();
        let edges = topology.edges().iter();
        let line = edges.filter(|(_, edge)| edge.vertices.iter().all(|v| on_line(v.0 as usize)));
        let line = line.map(|(id, _)| id).collect();
        Self {
            mesh,
            topology,
            line,
        }
    }

    /// Reduced load `N/(2 D k^2)` at which it gives way.
    fn onset(&self, model: BendingModel, crease: impl Fn(EdgeId) -> f64) -> f64 {
        let creases = self.line.iter().map(|&edge| {
            let crease = Crease {
                compliance: crease(edge),
                rest_angle: 0.0,
                sense: FoldSense::Both,
            };
            (edge, crease)
        });
        let faces = self.mesh.faces.len();
        let query = ResponseQuery {
            mesh: &self.topology,
            corners: &self.mesh.corners,
            directions: &vec![Vector3::y(); faces],
            fixed: &vec![false; self.mesh.points.len()],
            bending_modulus: 1.0,
            poisson: 0.48,
            bending_model: model,
            hinge_exponent: HINGE_EXPONENT,
            normal_stiffness: (2.0 * PI).powi(4),
            gradient_stiffness: 0.0,
        };
        let response = creased_response(&query, &creases.collect::<Vec<_>>());
        let response = response.expect("a valid query");
        assert!(response.converged);
        response.critical_force / (8.0 * PI * PI)
    }

    /// Compliance of the plain hinge on an edge: angle per moment per length.
    fn hinge_compliance(&self, edge: EdgeId) -> f64 {
        let corners = self.mesh.corners.iter().enumerate();
        let rest: Vec<_> = corners
            .map(|(face, corners)| RestTriangle::new(corners, face).expect("a proper triangle"))
            .collect();
        let [Some((left, tail)), Some((right, head))] = self.topology.edge_sides(edge) else {
            panic!("a periodic cell has no border")
        };
        let shape = HingeShape::new(&rest[left.0 as usize], tail, &rest[right.0 as usize], head);
        let (length, _, _) = rest[left.0 as usize].seen_from_edge(tail);
        length / shape.stiffness(1.0, HINGE_EXPONENT)
    }
}

/// `1 - (sqrt(kappa^2 + 1) - kappa)^2/2`.
fn theory(kappa: f64) -> f64 {
    1.0 - 0.5 * (kappa.hypot(1.0) - kappa).powi(2)
}

fn compliance(kappa: f64) -> f64 {
    1.0 / (2.0 * PI * kappa)
}

const STAR: BendingModel = BendingModel::VertexCurvature;

/// Onset over the closed form.
fn ratio(film: &Film, model: BendingModel, kappa: f64) -> f64 {
    film.onset(model, |_| compliance(kappa)) / theory(kappa)
}

/// Measured: 0.984 to 1.015 at 12 points, 0.993 to 1.006 at 24; without a crease 0.988.
#[test]
fn a_crease_gives_way_at_the_closed_form_on_any_mesh() {
    for (points, longest, share) in [(12.0, 3.0, 1.0), (24.0, 4.0, 0.5)] {
        for (aspect, jitter, seed) in [(1.0, 0.25, 1), (2.0, 0.2, 2), (longest, 0.15, 3)] {
            let film = Film::new(points, aspect, jitter, seed);
            for (kappa, bound) in [(8.0, 0.02), (0.884, 0.02), (0.162, 0.03), (0.0, 0.05)] {
                let found = ratio(&film, STAR, kappa);
                let error = (found - 1.0).abs();
                assert!(error < bound * share, "{points} {aspect} {kappa}: {found}");
            }
        }
    }
}

/// Five meshes whose vertices lie elsewhere. Measured: within 1.8 % of the closed form, and within 0.4 %
/// of each other.
#[test]
fn it_gives_way_alike_on_five_meshes() {
    let films: Vec<Film> = (1..=5)
        .map(|seed| Film::new(12.0, 1.0, 0.25, seed))
        .collect();
    for kappa in [8.0, 0.884, 0.162, 0.0] {
        let found: Vec<f64> = films.iter().map(|film| ratio(film, STAR, kappa)).collect();
        let least = found.iter().copied().fold(f64::INFINITY, f64::min);
        let most = found.iter().copied().fold(0.0, f64::max);
        println!("kappa {kappa}: {least:.4} to {most:.4} of the closed form");
        assert!(least > 0.97 && most < 1.03, "{kappa}: {found:?}");
        assert!(most - least < 0.01, "{kappa}: {found:?}");
    }
}

/// Measured: 1.018, 1.005, 1.022, 1.045.
#[test]
fn hinges_do_as_well_on_equilateral_meshes() {
    let film = Film::new(12.0, 1.0, 0.25, 1);
    for (kappa, bound) in [(8.0, 0.02), (0.884, 0.02), (0.162, 0.03), (0.02, 0.05)] {
        let found = ratio(&film, BendingModel::Hinge, kappa);
        assert!((found - 1.0).abs() < bound, "{kappa}: {found}");
    }
}

/// A line with few vertices folds like a saw: below three and a half of them per wavelength that is easier
/// than to fold evenly.
#[test]
fn a_soft_crease_needs_four_vertices_per_wavelength() {
    let film = Film::new(12.0, 4.0, 0.0, 1);
    let [stiff, soft] = [0.884, 0.0].map(|kappa| ratio(&film, STAR, kappa));
    assert!((stiff - 1.0).abs() < 0.02, "{stiff}");
    assert!((soft - 0.62).abs() < 0.05, "{soft}");
}

#[test]
fn the_width_of_a_crease_does_not_matter() {
    let film = Film::new(12.0, 1.0, 0.25, 4);
    // Stiffness shares equal to the width in wavelengths.
    let onset = |width: f64| film.onset(STAR, |_| Crease::strip_compliance(width, width, 1.0));
    let [wide, narrow] = [1e-3, 1e-6].map(onset);
    assert!((wide / narrow - 1.0).abs() < 1e-3, "{wide} {narrow}");

    // A factor of 0.1 on the stiffness of the line's edges depends on the mesh instead: 0.60 to 0.89.
    let factor = |points: f64| {
        let film = Film::new(points, 1.0, 0.0, 5);
        film.onset(BendingModel::Hinge, |edge| {
            9.0 * film.hinge_compliance(edge)
        })
    };
    let [coarse, fine] = [6.0, 48.0].map(factor);
    assert!(fine / coarse > 1.2, "{coarse} {fine}");
}
