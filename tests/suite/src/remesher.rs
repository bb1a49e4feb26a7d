//! Meshes and metrics for the remesher: needles, slivers, odd scales, contradictory sizes.

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use ruga_mesh::{PerEdge, PerFace, PerVertex, TriMesh};
use ruga_remesh::{
    FaceDriver, PolyhedralSurface, Refinement, RemeshError, RemeshSettings, Remeshed, SizeLimits,
    Sizing, SizingInput, SurfaceMesh, remesh, sizing_field,
};

use super::{Chance, FuzzSheet, Tried, put};

/// Vertices that a sizing may ask for; few, so that many inputs are tried.
const MOST_VERTICES: usize = 3000;

pub(super) fn remeshed(folder: &Path, chance: &mut Chance) -> Tried {
    let mut sheet = FuzzSheet::sound(1.0, chance);
    for _ in 0..chance.below(3) {
        sheet.make_odd(chance);
    }
    if chance.one_in(4) {
        jitter(&mut sheet.positions, chance);
    }
    put(folder, "mesh.obj", sheet.obj(&sheet.positions));
    let Ok(base) = TriMesh::new(sheet.positions.len(), sheet.triangles.clone()) else {
        return Ok(false);
    };
    let seams = PerEdge::filled(base.edges().len(), false);
    let mesh = PolyhedralSurface::new(&base, &sheet.positions, &seams)
        .and_then(|surface| surface.vertex_points().map(|points| (surface, points)))
        .and_then(|(surface, points)| {
            SurfaceMesh::on_surface(base.clone(), points, &surface).map(|mesh| (surface, mesh))
        });
    let Ok((surface, mut mesh)) = mesh else {
        return Ok(false);
    };
    let marked = chance.one_in(3);
    mesh.features = (0..base.edges().len())
        .map(|_| marked && chance.one_in(6))
        .collect();
    mesh.fixed = (0..base.vertex_count())
        .map(|_| marked && chance.one_in(6))
        .collect();
    let settings = settings(chance);
    let Some(sizing) = sizing(&mesh, chance) else {
        return Ok(false);
    };
    put(folder, "sizing.txt", described(&sizing, &settings));
    let Ok(first) = remesh(&mesh, &sizing, &surface, &settings) else {
        return Ok(false);
    };
    check(&mesh, &first)?;
    // What came out is itself an input that must be taken, unless the estimate was far too low.
    let settings = RemeshSettings {
        max_vertices: 3 * MOST_VERTICES,
        ..settings
    };
    let again = match remesh(&first.mesh, &first.sizing, &surface, &settings) {
        Err(RemeshError::TooManyVertices { .. }) => return Ok(true),
        again => again.map_err(|error| format!("the result is refused: {error}"))?,
    };
    check(&first.mesh, &again)?;
    Ok(true)
}

fn jitter(positions: &mut [Vector3<f64>], chance: &mut Chance) {
    let amount = chance.magnitude(-6.0, 0.0);
    for p in positions {
        let [x, y, z] = [0; 3].map(|_| chance.between(-1.0, 1.0));
        *p += Vector3::new(x, y, z) * amount;
    }
}

fn settings(chance: &mut Chance) -> RemeshSettings {
    let max_edge = chance.magnitude(-3.0, 4.0);
    RemeshSettings {
        limits: SizeLimits {
            min_edge: if chance.one_in(2) {
                0.0
            } else {
                max_edge * chance.between(0.0, 1.1)
            },
            max_edge,
            aspect: [1.0, 2.0, 4.0, 1e6, 0.5][chance.below(5)],
            grading: [0.5, 0.01, f64::INFINITY, 1e-9, 0.0][chance.below(5)],
        },
        corner_angle: [0.35, 0.0, 1.5, f64::NAN][chance.below(4)],
        max_vertices: MOST_VERTICES,
    }
}

/// A tensor per vertex, or what a random shape and driver ask for.
fn sizing(mesh: &SurfaceMesh, chance: &mut Chance) -> Option<Sizing> {
    if chance.one_in(3) {
        return field(mesh, chance);
    }
    let positions = mesh.positions.as_slice();
    let extent = positions
        .iter()
        .map(|p| (p - positions[0]).norm())
        .fold(0.0, f64::max);
    let wanted = extent * chance.magnitude(-1.7, 0.5);
    let spread = chance.between(0.0, 1.5);
    let wild = chance.one_in(5);
    let tensors = (0..positions.len()).map(|_| {
        let edges = Vector3::from_fn(|_, _| wanted * chance.magnitude(-spread, spread));
        let mut values = edges.map(|edge| edge.powi(-2));
        if wild && chance.one_in(9) {
            values[chance.below(3)] = chance.wild_float();
        }
        let angles = [0; 3].map(|_| chance.between(-PI, PI));
        let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let turn = turn.to_rotation_matrix();
        let tensor = turn * Matrix3::from_diagonal(&values) * turn.transpose();
        (tensor + tensor.transpose()) * 0.5
    });
    Some(Sizing {
        tensors: tensors.collect(),
    })
}

fn field(mesh: &SurfaceMesh, chance: &mut Chance) -> Option<Sizing> {
    let mut shape = mesh.positions.as_slice().to_vec();
    jitter(&mut shape, chance);
    let wild = chance.one_in(4);
    let mut number = |low: f64, high: f64| match wild && chance.one_in(8) {
        true => chance.wild_float(),
        false => chance.magnitude(low, high),
    };
    let faces = mesh.mesh.face_count();
    let drivers: PerFace<FaceDriver> = (0..faces)
        .map(|_| FaceDriver {
            compression: Matrix3::from_diagonal(&Vector3::from_fn(|_, _| number(-3.0, 0.0))),
            wavelength: number(-2.0, 1.0),
            critical_strain: number(-2.0, 0.0),
            poisson: 0.48,
        })
        .collect();
    let input = SizingInput {
        mesh,
        shape: &shape,
        driver: Some(&drivers),
        refinement: Refinement {
            angle: number(-2.0, 1.0),
            ..Refinement::default()
        },
    };
    sizing_field(&input).ok()
}

/// What every remesh keeps: finite numbers, whole weights, the surface's topology.
fn check(old: &SurfaceMesh, new: &Remeshed) -> Result<(), String> {
    let mesh = &new.mesh;
    let finite = |p: &Vector3<f64>| p.iter().all(|c| c.is_finite());
    if !mesh.positions.as_slice().iter().all(finite) {
        return Err("a position that is not finite".to_owned());
    }
    for (_, point) in mesh.points.iter() {
        let sum: f64 = point.barycentric.iter().sum();
        if (sum - 1.0).abs() > 1e-6
            || point
                .barycentric
                .iter()
                .any(|c| !c.is_finite() || *c < -1e-6)
        {
            return Err(format!("a place with coordinates {:?}", point.barycentric));
        }
    }
    for row in 0..new.transfer.rows.row_count() {
        let weights: Vec<f64> = new.transfer.rows.row(row).map(|term| term.1).collect();
        let sum: f64 = weights.iter().sum();
        if (sum - 1.0).abs() > 1e-6 || weights.iter().any(|w| *w < 0.0) {
            return Err(format!("row {row} of the transfer has weights {weights:?}"));
        }
    }
    if !new
        .sizing
        .tensors
        .as_slice()
        .iter()
        .flatten()
        .all(|t| t.is_finite())
    {
        return Err("a tensor that is not finite".to_owned());
    }
    let report = &new.report;
    if mesh.mesh.face_count() > 0 && !report.metric_lengths.iter().all(|l| l.is_finite()) {
        return Err(format!("metric lengths {:?}", report.metric_lengths));
    }
    if mesh.mesh.vertex_count() > old.mesh.vertex_count() + 6 * MOST_VERTICES {
        return Err(format!("{} vertices", mesh.mesh.vertex_count()));
    }
    let (before, after) = (euler(&old.mesh), euler(&mesh.mesh));
    if before != after {
        return Err(format!(
            "the Euler characteristic was {before} and is {after}"
        ));
    }
    let fans = mesh.mesh.vertex_count();
    let single = PerVertex::filled(fans, ())
        .ids()
        .all(|v| mesh.mesh.ring(v).is_some());
    match single {
        true => Ok(()),
        false => Err("a vertex with several fans of faces, or none".to_owned()),
    }
}

fn euler(mesh: &TriMesh) -> i64 {
    mesh.vertex_count() as i64 - mesh.edges().len() as i64 + mesh.face_count() as i64
}

fn described(sizing: &Sizing, settings: &RemeshSettings) -> String {
    let mut text = format!("{settings:?}\n");
    for (vertex, tensor) in sizing.tensors.iter() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}: {:?}", vertex.0, tensor.as_slice());
    }
    text
}
