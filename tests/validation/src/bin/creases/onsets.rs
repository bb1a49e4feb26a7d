//! Load at which a film gives way at a line, against the closed form.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, Id, TriMesh};
use ruga_shell::{
    BendingModel, Crease, FoldSense, HINGE_EXPONENT, HingeShape, ResponseQuery, RestTriangle,
    creased_response, face_corners,
};
use ruga_validation::{DrawnSheet, edges_within, feature_edges, upright};
use serde::{Deserialize, Serialize};

/// Width of the line in wavelengths, and the part of the bending stiffness that it keeps.
const WIDTH: f64 = 0.02;
const KEPT: f64 = 0.1;

/// Wavelengths of the film along the compression.
const WAVES: usize = 8;

/// Sides of the square film and angle of its line (degrees).
const SIDE: usize = 8;
const SLANT: f64 = 30.0;

/// One onset.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Onset {
    pub(crate) way: String,
    /// Points per wavelength.
    pub(crate) points: usize,
    /// Reduced load: 1 where the film wrinkles by itself.
    pub(crate) load: f64,
}

/// The names of the ways.
pub(crate) const ON_LINE: &str = "edges along the line";
pub(crate) const ASLANT: &str = "line at 30 degrees, cut and fitted";
pub(crate) const FACTOR: &str = "factor on the hinge";
/// What the mesh alone does to the load at which a film wrinkles.
pub(crate) const NO_LINE: &str = "no line";

/// Reduced stiffness of the line, `l/(c D)`.
pub(crate) fn kappa() -> f64 {
    1.0 / (TAU * Crease::strip_compliance(WIDTH, KEPT, 1.0))
}

pub(crate) fn onsets(quick: bool) -> Vec<Onset> {
    let mut all = Vec::new();
    for points in [6, 12, 24, 48] {
        for way in [ON_LINE, FACTOR, NO_LINE] {
            let load = along(points, way);
            all.push(onset(way, points, load));
        }
    }
    let slanted: &[usize] = if quick { &[6, 12] } else { &[6, 12, 24] };
    for &points in slanted {
        all.push(onset(ASLANT, points, aslant(points)));
    }
    all
}

fn onset(way: &str, points: usize, load: f64) -> Onset {
    Onset {
        way: way.to_owned(),
        points,
        load,
    }
}

fn series() -> Crease {
    Crease {
        compliance: Crease::strip_compliance(WIDTH, KEPT, 1.0),
        rest_angle: 0.0,
        sense: FoldSense::Both,
    }
}

/// On a strip whose columns of vertices are along the line.
fn along(points: usize, way: &str) -> f64 {
    let strip = upright(WAVES as f64, WAVES * points, 8);
    let (mesh, positions) = (strip.topology(), strip.compressed(0.0));
    let is_on = |v: u32| way != NO_LINE && positions[v as usize].x.abs() < 1e-9;
    let is_factor = way == FACTOR;
    let creases = edges_within(&mesh, is_on).into_iter().map(|edge| {
        let crease = match is_factor {
            false => series(),
            // A hinge of stiffness k times the factor f is k in series with 1/k (1/f - 1).
            true => Crease {
                compliance: (1.0 / KEPT - 1.0) * hinge_compliance(&mesh, &positions, edge),
                ..series()
            },
        };
        (edge, crease)
    });
    let model = match is_factor {
        false => BendingModel::VertexCurvature,
        true => BendingModel::Hinge,
    };
    let creases: Vec<_> = creases.collect();
    load(
        (&mesh, &positions),
        &strip.ends(),
        (Vector3::x(), 0.0),
        model,
        &creases,
    )
}

/// Compliance of an edge's hinge at unit modulus: angle per moment per length.
fn hinge_compliance(mesh: &TriMesh, positions: &[Vector3<f64>], edge: EdgeId) -> f64 {
    let [Some((left, tail)), Some((right, head))] = mesh.edge_sides(edge) else {
        unreachable!("a crease lies inside");
    };
    let rest = [left, right].map(|face| {
        let corners = mesh.faces()[face].map(|v| positions[v.index()]);
        RestTriangle::new(&corners, face.index()).expect("a proper triangle")
    });
    let shape = HingeShape::new(&rest[0], tail, &rest[1], head);
    let [a, b] = mesh.edges()[edge].vertices.map(|v| positions[v.index()]);
    (b - a).norm() / shape.stiffness(1.0, HINGE_EXPONENT)
}

/// On a mesh that was cut along a slanted line and fitted.
fn aslant(points: usize) -> f64 {
    let (sin, cos) = SLANT.to_radians().sin_cos();
    let along = Vector3::new(-sin, cos, 0.0);
    let half = 0.5 * SIDE as f64;
    let middle = Vector3::new(half, half, 0.0);
    let reach = half / cos.max(sin) * (1.0 - 1e-9);
    let ends = [-1.0, 1.0].map(|end| middle + along * (end * reach));
    let drawn = DrawnSheet::new(SIDE, 3);
    let line = drawn.trace(ends.to_vec());
    let made = drawn.fitted(&[line], 1.0 / points as f64, 3);
    let made = made.last().expect("there are fits");
    let creases: Vec<_> = feature_edges(made)
        .into_iter()
        .map(|edge| (edge, series()))
        .collect();
    let border = made.mesh.border_vertices();
    load(
        (&made.mesh, made.positions.as_slice()),
        border.as_slice(),
        (Vector3::new(cos, sin, 0.0), 0.48),
        BendingModel::VertexCurvature,
        &creases,
    )
}

/// Least reduced load that buckles a film of unit wavelength and modulus.
fn load(
    (mesh, positions): (&TriMesh, &[Vector3<f64>]),
    fixed: &[bool],
    (direction, poisson): (Vector3<f64>, f64),
    bending_model: BendingModel,
    creases: &[(EdgeId, Crease)],
) -> f64 {
    let query = ResponseQuery {
        mesh,
        corners: &face_corners(mesh, positions),
        directions: &vec![direction; mesh.face_count()],
        fixed,
        bending_modulus: 1.0,
        poisson,
        bending_model,
        hinge_exponent: HINGE_EXPONENT,
        normal_stiffness: TAU.powi(4),
        gradient_stiffness: 0.0,
    };
    let response = creased_response(&query, creases).expect("a valid query");
    assert!(response.converged, "{} points", positions.len());
    response.critical_force / (2.0 * TAU * TAU)
}
