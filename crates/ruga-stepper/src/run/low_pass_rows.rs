//! The rows that keep a layer's large shape on the surface below.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_constraint::{
    ClusterSettings, ConstraintError, ConstraintSet, Kernel, SampleConstraints, cluster_centres,
};
use ruga_mesh::{Id, MaterialPoint, PerVertex, SurfaceLookup, VertexId};
use ruga_solver::ConstraintRows;

use crate::skin::local_skin::SkinProperties;
use crate::skin::material_places::uv;
use crate::skin::mirror::{Images, Mirrored};
use crate::skin::place::{ShapeCentres, place_of_points};
use crate::skin::skin_mesh::SkinMesh;
use crate::{Coupling, LayerSpec, StepperError};

/// Spacing of the low-pass rows beside a foundation, in wavelengths: away from the wavelength
/// itself, with which the rows' reactions would resonate on a curved surface.
const HYBRID_SPACING: f64 = 1.5;
/// Spacing of rows that act alone: a hex lattice then lets the wavelength itself through
/// and holds everything longer.
const CONSTRAINT_SPACING: f64 = 0.577_350_269_189_625_8;
/// A row is dropped when less than this fraction of its weight is on vertices that move.
const MIN_FREE_WEIGHT: f64 = 0.2;
/// A row across the plane where one half of a symmetric pose ends is dropped when what its two sides leave of each
/// other is less than this fraction of its weight.
const LEAST_ROW: f64 = 1e-2;

/// A place around which the layer's average is held, the same on every mesh of the skin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowCentre {
    /// Rest position, m.
    at: Vector3<f64>,
    kernel: Kernel,
}

/// Rows that hold a layer's averages.
pub(crate) struct LowPassRows {
    /// Three rows to an average, x, y and z; two where the plane at which one half of a symmetric pose ends holds x.
    pub(crate) rows: ConstraintRows,
    /// Number of averages.
    pub(crate) averages: usize,
    /// The middles of averages that were meant to be right for slopes, and are for constants only.
    pub(crate) degraded: Vec<VertexId>,
}

impl LowPassRows {
    /// Warning about constraints that the mesh is too coarse for.
    pub(crate) fn warning(&self, driver: &Driver, skin: &SkinMesh) -> Option<String> {
        let Self {
            averages, degraded, ..
        } = self;
        if degraded.is_empty() {
            return None;
        }
        let points = skin.points.points();
        let uvs = degraded.iter().map(|v| uv(driver, &points[v.index()]));
        let positions = degraded.iter().map(|v| skin.rest.positions[v.index()]);
        Some(format!(
            "the mesh is too coarse for {} of the {} averaging constraints that hold the layer to the surface, {}; there the skin may tilt by a degree or so, which shows as a faint slope in the map. Use `--quality fine`, or `coupling = \"elastic\"` for this layer",
            degraded.len(),
            averages,
            place_of_points(&ShapeCentres::new(driver), uvs, positions)
        ))
    }
}

/// Centres of the layer's averaging constraints, spaced by its wavelength there.
pub(crate) fn row_centres(
    spec: &LayerSpec,
    properties: &SkinProperties,
    skin: &SkinMesh,
    free: &[VertexId],
) -> Result<Vec<RowCentre>, StepperError> {
    let spacing = match spec.coupling {
        Coupling::Elastic => return Ok(Vec::new()),
        Coupling::Hybrid => HYBRID_SPACING,
        Coupling::Constraint => CONSTRAINT_SPACING,
    };
    if free.is_empty() {
        return Ok(Vec::new());
    }
    let wavelength = |v: usize| properties.at_vertex(v).wrinkling.wavelength;
    let spacings = (0..skin.mesh.vertex_count()).map(|v| spacing * wavelength(v));
    let rest = &skin.rest.positions;
    let centres = cluster_centres(
        &skin.mesh,
        rest,
        &spacings.collect(),
        free,
        &ClusterSettings::default(),
    )
    .map_err(|source| constraint(spec, source))?;
    let centre = |v: VertexId| RowCentre {
        at: rest[v.index()],
        // Rows that act alone have to hold everything longer than the wavelength. Beside a
        // foundation rows that see the wrinkles raise the onset by some per cent, so that theirs
        // are wider.
        kernel: match spec.coupling {
            Coupling::Constraint => Kernel::alone(wavelength(v.index())),
            _ => Kernel::beside_foundation(spacing * wavelength(v.index())),
        },
    };
    Ok(centres.into_iter().map(centre).collect())
}

/// The rows of the layer's coupling around `centres`, on the coordinates of its free vertices, x, y,
/// z in turn.
pub(crate) fn low_pass_rows(
    (spec, sample): (&LayerSpec, SampleConstraints),
    centres: &[RowCentre],
    skin: &SkinMesh,
    pinned: &PerVertex<bool>,
    free: &[VertexId],
) -> Result<LowPassRows, StepperError> {
    // Averages near the plane where one half of a symmetric pose ends are taken beyond it, too.
    let mirrored = match centres.is_empty() {
        true => None,
        false => skin.mirrored(),
    };
    let images = mirrored.as_ref().map(|whole| &whole.images);
    let own = images.map_or(usize::MAX, Images::own_count);
    let original = |v: VertexId| images.map_or(v, |images| images.originals()[v.index()]);
    let set = rows_around((spec, sample), centres, (skin, mirrored.as_ref()))?;
    let mut low_pass = LowPassRows {
        rows: ConstraintRows::none(3 * free.len()),
        averages: 0,
        degraded: Vec::new(),
    };
    if set.rows.is_empty() {
        // Two layers that move together have none, and more vertices than the mesh.
        return Ok(low_pass);
    }
    let mut unknown = PerVertex::filled(skin.mesh.vertex_count(), None);
    for (i, &v) in free.iter().enumerate() {
        unknown[v] = Some(3 * i);
    }
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in &set.rows {
        // Pinned vertices lie on their targets, so their part of the average is right already.
        let moving: Vec<(usize, f64, bool)> = row
            .weights
            .iter()
            .map(|&(v, w)| (original(v), w, v.index() >= own))
            .filter(|(v, ..)| !pinned[*v])
            .filter_map(|(v, w, is_image)| unknown[v].map(|u| (u, w, is_image)))
            .collect();
        // Without pinned vertices a row is kept whatever its weights sum to: those of other methods
        // than averages may sum to zero. A row of nothing would make the system singular.
        let has_pinned = moving.len() < row.weights.len();
        let weight: f64 = moving.iter().map(|m| m.1).sum();
        if moving.is_empty() || has_pinned && weight < MIN_FREE_WEIGHT {
            continue;
        }
        if set.degraded.iter().any(|(centre, _)| *centre == row.centre) {
            // A row has no position. Its heaviest vertex is what the warning names a place by.
            let heaviest = row.weights.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            low_pass
                .degraded
                .extend(heaviest.map(|(v, _)| original(*v)));
        }
        low_pass.averages += 1;
        // All three components are held. Along the surface too, or excess length would move from
        // one wrinkle to the next, which nothing in a wrinkled membrane opposes.
        for axis in 0..3 {
            if mirrored.is_none() {
                columns.extend(moving.iter().map(|(u, ..)| u + axis));
                values.extend(moving.iter().map(|(_, w, _)| w));
                starts.push(columns.len());
                continue;
            }
            let is_across = axis == 0;
            let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
            for &(u, w, is_image) in &moving {
                // What is on the plane does not move across it, and an image against its original.
                if is_across && skin.on_plane[free[u / 3].index()] {
                    continue;
                }
                let sign = if is_across && is_image { -1.0 } else { 1.0 };
                *sums.entry(u + axis).or_default() += sign * w;
            }
            if sums.values().map(|w| w.abs()).sum::<f64>() > LEAST_ROW * weight {
                columns.extend(sums.keys());
                values.extend(sums.values());
                starts.push(columns.len());
            }
        }
    }
    let rows = ConstraintRows::new(starts, columns, values, 3 * free.len());
    low_pass.rows = rows.map_err(|source| StepperError::Solver {
        layer: spec.name.clone(),
        source,
    })?;
    Ok(low_pass)
}

/// Averages around `centres`, on the mesh with its mirror image where it is given.
fn rows_around(
    (spec, sample): (&LayerSpec, SampleConstraints),
    centres: &[RowCentre],
    (skin, mirrored): (&SkinMesh, Option<&Mirrored>),
) -> Result<ConstraintSet, StepperError> {
    if centres.is_empty() {
        return Ok(ConstraintSet::default());
    }
    let (mesh, positions, normals) = match mirrored {
        None => (&skin.mesh, &skin.rest.positions, &skin.rest.normals),
        Some(whole) => (&whole.mesh, &whole.positions, &whole.normals),
    };
    let lookup = SurfaceLookup::new(mesh, positions);
    let (places, kernels): (Vec<MaterialPoint>, Vec<Kernel>) = centres
        .iter()
        .filter_map(|centre| Some((lookup.closest(&centre.at)?.point, centre.kernel)))
        .unzip();
    sample(mesh, positions, normals, &places, &kernels, spec.sampling)
        .map_err(|source| constraint(spec, source))
}

fn constraint(spec: &LayerSpec, source: ConstraintError) -> StepperError {
    StepperError::Constraint {
        layer: spec.name.clone(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use ruga_constraint::constraint_rows;

    use super::*;
    use crate::Sampling;
    use crate::test_drivers::{knuckle, skin, square};

    /// The mesh has edges of two millimetres.
    #[test]
    fn averages_over_too_few_vertices_are_warned_of() {
        let flat = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let skin = skin(&driver, 0, 0.0);
        let free: Vec<VertexId> = (0..skin.mesh.vertex_count())
            .map(VertexId::from_index)
            .collect();
        let pinned = PerVertex::filled(free.len(), false);
        let held = |wavelength: f64| {
            let centre = RowCentre {
                at: Vector3::zeros(),
                kernel: Kernel::alone(wavelength),
            };
            // Quadrature reaches all corners of the faces around a vertex.
            let spec = LayerSpec {
                sampling: Sampling::Adjusted,
                ..knuckle()
            };
            let how = (&spec, constraint_rows as SampleConstraints);
            low_pass_rows(how, &[centre], &skin, &pinned, &free).expect("a row")
        };
        let told = |wavelength: f64| held(wavelength).warning(&driver, &skin);
        let said = told(2e-3).expect("one vertex is no average");
        for words in [
            "1 of the 1 averaging",
            "u 0.00 to 0.00",
            "--quality fine",
            "elastic",
        ] {
            assert!(said.contains(words), "{said}");
        }
        assert_eq!(told(10e-3), None);
    }
}
