//! Sizes of a surface's faces that a plan is made by, and how often faces are to be split.

use nalgebra::Vector3;
use ruga_blend::{BaseSurface, PosedSurface};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace};

use crate::{LayerSpec, Modelling, PaintedRanges};

/// Faces of the planning surface above which it is not subdivided further: on a face of 18 thousand
/// triangles a million say the same areas as 300 thousand to 1 %, in five times the time.
pub(crate) const MAX_PLANNING_FACES: usize = 400_000;
/// Splits of one face in four; ten make a metre a millimetre.
pub(crate) const MAX_LEVELS: u32 = 10;
/// Vertices that the output mesh of a fitted one may have, in vertex budgets.
pub(crate) const OUTPUT_VERTICES: f64 = 4.0;
/// Mean edge of a mesh, over the longest, whose long edges were halved.
const HALVED: f64 = 0.75;

/// Factor on the edges of an output mesh that would have so many vertices, for the budget's sake; at
/// least 1.
pub(crate) fn output_coarseness(vertices: f64, modelling: &Modelling) -> f64 {
    let budget = OUTPUT_VERTICES * modelling.vertex_budget as f64;
    (vertices / budget).sqrt().max(1.0)
}

/// Faces with edges up to `longest` (m) on an area, m².
pub(crate) fn faces_within(area: f64, longest: f64) -> f64 {
    let mean = HALVED * longest;
    4.0 * area / (3f64.sqrt() * mean * mean)
}

/// Splits until the median edge meets the target (m) and few edges are far off or longer than facets
/// may be (m), or the budget is spent.
///
/// `faces_at` and `edges_at` (median and 95th percentile, m) say what a number of splits gives.
pub(crate) fn needed_levels(
    (target, longest): (f64, Option<f64>),
    modelling: &Modelling,
    faces_at: impl Fn(u32) -> f64,
    edges_at: impl Fn(u32) -> (f64, f64),
) -> u32 {
    // A tenth of slack: the next split would quadruple the cost for little.
    let is_coarse = |levels: u32| {
        let (median, long) = edges_at(levels);
        let is_faceted = longest.is_some_and(|longest| long > longest);
        median > 1.1 * target || long > 1.65 * target || is_faceted
    };
    let vertices = match modelling.remesh {
        Some(_) => OUTPUT_VERTICES * modelling.vertex_budget as f64,
        None => modelling.vertex_budget as f64,
    };
    // There are two triangles to a vertex.
    let budget = 2.0 * vertices;
    let mut levels = 0;
    while is_coarse(levels) && levels < MAX_LEVELS && faces_at(levels + 1) <= budget {
        levels += 1;
    }
    levels
}

/// A measure of every face from its corners' positions (m) and normals at rest.
pub(crate) fn per_face(
    surface: &BaseSurface,
    measure: impl Fn([Vector3<f64>; 3], [Vector3<f64>; 3]) -> f64,
    rest: &PosedSurface,
) -> PerFace<f64> {
    surface
        .mesh()
        .faces()
        .as_slice()
        .iter()
        .map(|face| {
            let corners = face.map(|v| rest.positions[v.index()]);
            measure(corners, face.map(|v| rest.normals[v.index()]))
        })
        .collect()
}

/// Mean edge of a face, m.
pub(crate) fn mean_edge([a, b, c]: [Vector3<f64>; 3]) -> f64 {
    ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
}

/// Largest normal curvature along the edges of a face, 1/m.
pub(crate) fn curvature(corners: [Vector3<f64>; 3], normals: [Vector3<f64>; 3]) -> f64 {
    (0..3)
        .map(|i| {
            let j = (i + 1) % 3;
            (normals[j] - normals[i]).norm() / (corners[j] - corners[i]).norm()
        })
        .fold(0.0, f64::max)
}

/// Fraction of the texture's side per metre of every face.
pub(crate) fn uv_density(surface: &BaseSurface, rest: &PosedSurface) -> PerFace<f64> {
    surface
        .mesh()
        .faces()
        .iter()
        .map(|(face, vertices)| {
            let [a, b, c] = vertices.map(|v| rest.positions[v.index()]);
            let [p, q, r] = surface.uvs()[face];
            let area = (b - a).cross(&(c - a)).norm();
            let uv = (q - p).perp(&(r - p)).abs();
            (uv / area).sqrt()
        })
        .collect()
}

/// Value of a field below which so large a fraction of the faces' weights lies.
pub(crate) fn weighted_quantile(
    faces: &[FaceId],
    field: &PerFace<f64>,
    weights: &PerFace<f64>,
    fraction: f64,
) -> f64 {
    let mut pairs: Vec<(f64, f64)> = faces.iter().map(|&f| (field[f], weights[f])).collect();
    // Faces without area may have no measure. They weigh nothing, so that they are never chosen.
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pairs.iter().map(|p| p.1).sum();
    let mut sum = 0.0;
    for (value, weight) in &pairs {
        sum += weight;
        if sum >= fraction * total {
            return *value;
        }
    }
    0.0
}

/// Ranges of painted and naturally varying properties of a layer over the active faces.
pub(crate) fn painted_ranges(
    spec: &LayerSpec,
    active: &[FaceId],
    local: &PerFace<Wrinkling>,
    areas: &PerFace<f64>,
) -> Option<PaintedRanges> {
    if active.is_empty() || (spec.map.is_none() && spec.variation.is_none()) {
        return None;
    }
    let range = |value: fn(&Wrinkling) -> f64| {
        let field: PerFace<f64> = local.as_slice().iter().map(value).collect();
        [0.01, 0.99].map(|fraction| weighted_quantile(active, &field, areas, fraction))
    };
    Some(PaintedRanges {
        wavelength: range(|wrinkling| wrinkling.wavelength),
        critical_strain: range(|wrinkling| wrinkling.critical_strain),
        thickness: range(|wrinkling| {
            (12.0 * wrinkling.bending_stiffness / wrinkling.membrane_stiffness).sqrt()
        }),
    })
}
