//! A plate clamped at one end and pressed down at the other, with a line across it that folds under the moment
//! there: `phi = c m`, whatever the mesh.

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, Id};
use ruga_shell::{Crease, FaceParameters, FoldSense, LayerParameters};
use ruga_solver::NewtonSettings;

use crate::virtual_nodes::{LineEnds, SpringLaw, VirtualNodes};
use crate::{DrawnSheet, Sheet, SheetSpec, feature_edges, unit_film};

/// Squares of the drawn mesh along a side of the plate, of unit length.
const SQUARES: usize = 8;

/// Material. Poisson's ratio is zero, so that the plate bends along x alone.
const YOUNG: f64 = 1e6;
const THICKNESS: f64 = 0.02;

/// Stiffness of the line over that of the plate along its length: nearly all of the bend is at the line.
const SOFT: f64 = 0.03;

/// Angle that the line is to have, rad: small, so that theory is linear.
const ANGLE: f64 = 0.02;

/// What resists the fold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    /// The product's crease.
    Crease,
    /// The paper's springs, all of the stiffness that is right for nodes half an edge from the line.
    EvenSprings,
    /// The paper's springs, by their nodes' distance from the line.
    SpringsByDistance,
}

/// A plate before its end is pressed down.
struct Plate {
    spec: SheetSpec,
    creases: Vec<(EdgeId, Crease)>,
}

/// Fold angle of a line at `x` in a plate of unit length, over `c m`.
///
/// # Panics
/// When the product refuses the plate or does not converge.
pub fn fold_over_theory(fold: Fold, x: f64) -> f64 {
    let Plate { spec, creases } = Plate::new(fold, x);
    let (faces, rest) = (spec.faces.clone(), spec.rest.clone());
    let is_end = |p: &Vector3<f64>| p.x > 1.0 - 1e-9;
    let ends = rest.iter().filter(|p| is_end(p)).count();
    let force = ANGLE * SOFT * face(1.0).bending_modulus() / (1.0 - x);
    let mut sheet = Sheet::new(spec);
    sheet.crease(&creases, &[]);
    // Vertices at both corners own half an edge.
    let of_end = force / (ends - 1) as f64;
    sheet.load(|p| match (is_end(p), p.y < 1e-9 || p.y > 1.0 - 1e-9) {
        (true, false) => Vector3::z() * of_end,
        (true, true) => Vector3::z() * (0.5 * of_end),
        _ => Vector3::zeros(),
    });
    let report = sheet.solve(&NewtonSettings {
        energy_tolerance: 1e-12,
        ..NewtonSettings::default()
    });
    assert!(report.converged, "{fold:?} {x}: {report:?}");

    // Mean slopes of faces that lie on one side, without what the plate bends by itself.
    let mut slopes = [[0.0; 2]; 2];
    for face in &faces {
        let at = face.map(|v| rest[v as usize].x);
        let side = match (
            at.iter().all(|a| *a < x + 1e-9),
            at.iter().all(|a| *a > x - 1e-9),
        ) {
            (true, _) => 0,
            (_, true) => 1,
            _ => continue,
        };
        let [a, b, c] = face.map(|v| sheet.positions()[v as usize]);
        let normal = (b - a).cross(&(c - a));
        let middle = at.iter().sum::<f64>() / 3.0;
        let own = ANGLE * SOFT / (1.0 - x) * (middle - 0.5 * middle * middle);
        slopes[side][0] += normal.norm() * (-normal.x / normal.z - own);
        slopes[side][1] += normal.norm();
    }
    let [before, after] = slopes.map(|[sum, area]| sum / area);
    (after - before) / ANGLE
}

fn face(share: f64) -> FaceParameters {
    FaceParameters {
        young: share * YOUNG,
        poisson: 0.0,
        thickness: THICKNESS,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    }
}

impl Plate {
    fn new(fold: Fold, x: f64) -> Self {
        let mut drawn = DrawnSheet::new(SQUARES, 3);
        for p in &mut drawn.positions {
            *p /= SQUARES as f64;
        }
        let line = drawn.trace([0.0, 1.0].map(|y| Vector3::new(x, y, 0.0)).to_vec());
        let stiffness = SOFT * face(1.0).bending_modulus();
        let edge = 1.0 / SQUARES as f64;
        let law = match fold {
            Fold::Crease => {
                let made = drawn.fitted(&[line], edge, 1).pop().expect("one mesh");
                let crease = Crease {
                    compliance: 1.0 / stiffness,
                    rest_angle: 0.0,
                    sense: FoldSense::Both,
                };
                let creases = feature_edges(&made).into_iter();
                let faces = made.mesh.faces().as_slice().iter();
                let faces = faces.map(|face| (face.map(|v| v.index() as u32), 1.0));
                let rest = made.positions.as_slice().to_vec();
                return Self {
                    spec: spec(rest, faces.collect()),
                    creases: creases.map(|edge| (edge, crease)).collect(),
                };
            }
            Fold::EvenSprings => SpringLaw::Even(stiffness / (0.5 * edge).powi(2)),
            Fold::SpringsByDistance => SpringLaw::ByDistance(stiffness),
        };
        let cut = VirtualNodes::cut(&drawn.mesh, &[line], LineEnds::AtVertices);
        let faces = cut.faces.iter().map(|own| (own.nodes, own.share));
        let mut spec = spec(cut.spread(&drawn.positions), faces.collect());
        spec.links = cut.springs(&drawn.positions, law);
        spec.ties = cut.rows;
        Self {
            spec,
            creases: Vec::new(),
        }
    }
}

/// A plate of faces with their share of material.
fn spec(rest: Vec<Vector3<f64>>, faces: Vec<([u32; 3], f64)>) -> SheetSpec {
    let parameters = LayerParameters {
        faces: faces.iter().map(|(_, share)| face(*share)).collect(),
        tangential_stiffness: vec![0.0; rest.len()],
    };
    let (mut theory, _) = unit_film(0.05);
    theory.bending_stiffness = face(1.0).bending_modulus();
    theory.membrane_stiffness = face(1.0).tension_modulus();
    // Scales for the solver: that of the fold's energy.
    theory.normal_stiffness = theory.bending_stiffness;
    theory.critical_strain =
        ANGLE * (SOFT * theory.bending_stiffness / theory.membrane_stiffness).sqrt();
    // All around the first column of squares, so that the end has no slope. The plate is then a little shorter than
    // its theory, which counts as little as its own bend.
    let pinned = rest.iter().map(|p| p.x < 1.4 / SQUARES as f64);
    let pinned = pinned.collect();
    let faces = faces.into_iter().map(|(face, _)| face).collect();
    SheetSpec::bare((theory, THICKNESS), (rest, faces), parameters, pinned)
}
