//! The rows that keep a layer's large shape on the surface below.

use ruga_constraint::{ClusterSettings, Kernel, cluster_centres, constraint_rows};
use ruga_mesh::{Id, MaterialPoint, PerVertex, VertexId};
use ruga_solver::ConstraintRows;

use crate::local_skin::SkinProperties;
use crate::skin_mesh::SkinMesh;
use crate::{Coupling, LayerSpec, StepperError};

/// Spacing of the low-pass rows beside a foundation, in wavelengths: away from the wavelength
/// itself, with which the rows' reactions would resonate on a curved surface.
const HYBRID_SPACING: f64 = 1.5;
/// Spacing of rows that act alone: a hex lattice then lets the wavelength itself through
/// and holds everything longer.
const CONSTRAINT_SPACING: f64 = 0.577_350_269_189_625_8;
/// A row is dropped when less than this share of its weight is on vertices that move.
const MIN_FREE_WEIGHT: f64 = 0.2;

/// The rows of the layer's coupling on the coordinates of its free vertices, x, y, z in turn.
pub(crate) fn low_pass_rows(
    spec: &LayerSpec,
    properties: &SkinProperties,
    skin: &SkinMesh,
    pinned: &PerVertex<bool>,
    free: &[VertexId],
) -> Result<ConstraintRows, StepperError> {
    let solver = |source| StepperError::Solver {
        layer: spec.name.clone(),
        source,
    };
    let spacing = match spec.coupling {
        Coupling::Elastic => return Ok(ConstraintRows::none(3 * free.len())),
        Coupling::Hybrid => HYBRID_SPACING,
        Coupling::Constraint => CONSTRAINT_SPACING,
    };
    let wavelength = |v: usize| properties.vertices[v].wrinkling.wavelength;
    let kernel = |centre: &VertexId| match spec.coupling {
        Coupling::Constraint => Kernel::alone(wavelength(centre.index())),
        _ => Kernel::beside_foundation(spacing * wavelength(centre.index())),
    };
    if free.is_empty() {
        return Ok(ConstraintRows::none(0));
    }
    let constraint = |source| StepperError::Constraint {
        layer: spec.name.clone(),
        source,
    };
    let SkinMesh { mesh, rest, .. } = skin;
    let spacings = (0..mesh.vertex_count()).map(|v| spacing * wavelength(v));
    let centres = cluster_centres(
        mesh,
        &rest.positions,
        &spacings.collect(),
        free,
        &ClusterSettings::default(),
    )
    .map_err(constraint)?;
    let place = |&centre: &VertexId| MaterialPoint::of_vertex(mesh, centre);
    let set = constraint_rows(
        mesh,
        &rest.positions,
        &rest.normals,
        &centres.iter().filter_map(place).collect::<Vec<_>>(),
        &centres.iter().map(kernel).collect::<Vec<_>>(),
        spec.sampling,
    )
    .map_err(constraint)?;
    let mut unknown = PerVertex::filled(mesh.vertex_count(), None);
    for (i, &v) in free.iter().enumerate() {
        unknown[v] = Some(3 * i);
    }
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in &set.rows {
        // Pinned vertices lie on their targets, so their share of the average is right already.
        let moving: Vec<(usize, f64)> = row
            .weights
            .iter()
            .filter(|(v, _)| !pinned[*v])
            .filter_map(|&(v, w)| unknown[v].map(|u| (u, w)))
            .collect();
        if moving.iter().map(|m| m.1).sum::<f64>() < MIN_FREE_WEIGHT {
            continue;
        }
        for axis in 0..3 {
            columns.extend(moving.iter().map(|(u, _)| u + axis));
            values.extend(moving.iter().map(|(_, w)| w));
            starts.push(columns.len());
        }
    }
    ConstraintRows::new(starts, columns, values, 3 * free.len()).map_err(solver)
}
