//! Constraint functions sampled at the vertices of a mesh.

use std::collections::BTreeSet;
use std::iter::Sum;
use std::ops::Mul;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{Id, MaterialPoint, TriMesh, VertexId, vertex_areas};

use crate::centre::Centre;
use crate::chart::{Chart, Charts, reach};
use crate::moments::{match_centroid, match_second_moments, normalise};
use crate::quadrature::{gather, kernel_moments, quadrature_points};
use crate::{ConstraintError, Degradation, Kernel};

/// Centres that a thread samples with the same room, which is as large as the mesh: few enough to share them out.
const CENTRES_AT_ONCE: usize = 16;

/// How a continuous weighting becomes weights of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema),
    serde(rename_all = "lowercase")
)]
pub enum Sampling {
    /// Vertex areas (Li 2014, eq. 4.3).
    ///
    /// Kernel times vertex area, normalised; reproduces constants only.
    Area,
    /// Vertex areas, corrected so that centres and slopes are kept.
    ///
    /// Kernel times vertex area, rescaled to reproduce affine functions: Li 2014, section 4.3, made
    /// multiplicative so that support, sign and unit sum survive.
    Adjusted,
    /// A quadrature over the surface that is exact for quadratic functions.
    ///
    /// Its points are the vertices: kernel times vertex area, rescaled. Where vertices are too few for
    /// that, it is exact for affine functions, in the end by integrating the mesh's linear
    /// interpolation, which is so on any mesh.
    ///
    /// Linear interpolation alone sees a curved field by `f'' h²/12` too low at a crest, which
    /// changes with the edges `h`: when the mesh is exchanged, averages of a wave of 30 edges jump by
    /// 5e-4 of its height, and by 5e-5 with second moments matched.
    #[default]
    Quadrature,
}

/// Up to which functions of the tangent plane a row equals its continuous constraint function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Constants: the weights sum to one.
    Constant,
    /// Affine functions too: the centroid of the weights is that of the kernel.
    Affine,
    /// Quadratic functions too: the second moments of the weights are those of the kernel.
    Quadratic,
}

/// One weighted average over vertices; the same weights serve x, y and z.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintRow {
    /// Around which of the given centres the average is taken, counted from 0.
    pub centre: usize,
    /// Vertices with weights other than zero, ascending; the weights sum to one.
    pub weights: Vec<(VertexId, f64)>,
    /// Functions that the row reproduces.
    pub order: Order,
}

impl ConstraintRow {
    /// The average of a field, such as positions or temperatures, that has `value` at a vertex.
    pub fn average<T: Mul<f64, Output = T> + Sum>(&self, value: impl Fn(VertexId) -> T) -> T {
        let terms = self.weights.iter();
        terms.map(|&(vertex, weight)| value(vertex) * weight).sum()
    }
}

/// Rows, and what had to be given up on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstraintSet {
    /// One row per centre that was kept, in the order of the centres.
    pub rows: Vec<ConstraintRow>,
    /// Numbers of the centres whose row was meant to be affine or better and reproduces constants only.
    pub degraded: Vec<(usize, Degradation)>,
    /// Numbers of the centres that stand where an earlier one does: their row would be the same.
    pub duplicates: Vec<usize>,
}

/// Signature of [`constraint_rows`], for callers that let another method take its place.
pub type SampleConstraints = fn(
    &TriMesh,
    &[Vector3<f64>],
    &[Vector3<f64>],
    &[MaterialPoint],
    &[Kernel],
    Sampling,
) -> Result<ConstraintSet, ConstraintError>;

/// Samples one constraint function per centre on a mesh.
///
/// A centre is a place of the surface, given by its address on this mesh; a vertex is one by
/// [`MaterialPoint::of_vertex`]. After a remesh the same functions are sampled anew: the centres
/// stay where they are on the surface, and [`ruga_mesh::SurfaceLookup`] finds their addresses on
/// the new mesh. What then differs of a row's value of a smooth field is the error of sampling.
///
/// Distances and coordinates are geodesic on the given positions, which are the rest positions:
/// supports end where the surface ends and at what a centre can't see past a border; they don't
/// leap over slits or through fingers. All arithmetic is relative to the centre.
///
/// # Shapes and units
/// `positions` (m) and unit `normals` per vertex; `kernels` per centre, m.
///
/// # Errors
/// [`ConstraintError`] for an empty mesh, arrays that don't fit, a centre that is no place of the
/// mesh or has no normal, positions or normals that aren't finite, kernels that aren't positive.
pub fn constraint_rows(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    centres: &[MaterialPoint],
    kernels: &[Kernel],
    sampling: Sampling,
) -> Result<ConstraintSet, ConstraintError> {
    check_length("normals", mesh.vertex_count(), normals.len())?;
    check_length("kernels", centres.len(), kernels.len())?;
    check_mesh(mesh, positions)?;
    check_finite_normals(normals)?;
    let mut checked = Vec::with_capacity(centres.len());
    for (number, (place, kernel)) in centres.iter().zip(kernels).enumerate() {
        checked.push(Centre::new(mesh, place, number)?);
        check_kernel(number, kernel)?;
        check_normals(normals, &checked[number], number)?;
    }
    let areas = vertex_areas(mesh, positions);
    // A row that stands twice would make the constraint matrix rank-deficient and the system of
    // the solver singular.
    let mut taken = BTreeSet::new();
    let (kept, duplicates): (Vec<usize>, _) =
        (0..checked.len()).partition(|&number| taken.insert(checked[number].key()));
    let mut set = ConstraintSet {
        duplicates,
        ..ConstraintSet::default()
    };
    let reach = reach(mesh, positions);
    let sampled = kept.par_chunks(CENTRES_AT_ONCE).map(|numbers| {
        let mut charts = Charts::new(mesh, positions, normals, &reach);
        let sampled = numbers.iter().map(|&number| {
            let (centre, kernel) = (&checked[number], &kernels[number]);
            let chart = charts.around(centre, kernel.radius());
            let (weights, outcome) = sample(&chart, kernel, &areas, centre, sampling);
            (number, of_vertices(&chart, &weights), outcome)
        });
        sampled.collect::<Vec<_>>()
    });
    for (number, weights, outcome) in sampled.collect::<Vec<_>>().into_iter().flatten() {
        set.push(number, weights, outcome);
    }
    Ok(set)
}

/// The weights other than zero, by vertex.
fn of_vertices(chart: &Chart, weights: &[f64]) -> Vec<(VertexId, f64)> {
    let pairs = chart.vertices.iter().copied().zip(weights.iter().copied());
    pairs.filter(|pair| pair.1 != 0.0).collect()
}

impl ConstraintSet {
    /// The average that each row takes of a field with one value per vertex.
    ///
    /// # Panics
    /// When the field has no value for a vertex of a row.
    pub fn averages<T: Copy + Mul<f64, Output = T> + Sum>(&self, field: &[T]) -> Vec<T> {
        let rows = self.rows.iter();
        rows.map(|row| row.average(|vertex| field[vertex.index()]))
            .collect()
    }

    fn push(
        &mut self,
        centre: usize,
        weights: Vec<(VertexId, f64)>,
        outcome: Result<Order, Degradation>,
    ) {
        if let Err(reason) = outcome {
            self.degraded.push((centre, reason));
        }
        self.rows.push(ConstraintRow {
            centre,
            weights,
            order: outcome.unwrap_or(Order::Constant),
        });
    }
}

/// Weights of the chart's vertices and what they reproduce.
fn sample(
    chart: &Chart,
    kernel: &Kernel,
    areas: &[f64],
    centre: &Centre,
    sampling: Sampling,
) -> (Vec<f64>, Result<Order, Degradation>) {
    let mut weights = area_weights(chart, kernel, areas, centre);
    let outcome = match sampling {
        Sampling::Area => {
            normalise(&mut weights);
            Ok(Order::Constant)
        }
        Sampling::Adjusted => {
            let target = kernel_moments(chart, kernel, || quadrature_points(chart, kernel));
            match_centroid(&chart.places, &mut weights, &target).map(|()| Order::Affine)
        }
        Sampling::Quadrature => return integrate(chart, kernel, weights),
    };
    (weights, outcome)
}

/// Weights that integrate the kernel times as many functions exactly as the vertices allow; `areas`
/// are those of [`area_weights`].
fn integrate(
    chart: &Chart,
    kernel: &Kernel,
    mut areas: Vec<f64>,
) -> (Vec<f64>, Result<Order, Degradation>) {
    let target = kernel_moments(chart, kernel, || quadrature_points(chart, kernel));
    // The vertices alone, where they are many: a rule whose error has no preferred sign.
    if match_second_moments(&chart.places, &mut areas, &target).is_ok() {
        return (areas, Ok(Order::Quadratic));
    }
    let points = quadrature_points(chart, kernel);
    if points.is_empty() {
        // Nothing but degenerate faces.
        return (areas, Err(Degradation::FewVertices));
    }
    let (places, mut shares): (Vec<_>, Vec<_>) = points.iter().map(|p| (p.place, p.weight)).unzip();
    let outcome = match_centroid(&places, &mut shares, &target);
    // Hat functions reach over whole faces, so vertices just outside the support take part: that
    // may be enough for a match that those inside could not give.
    let mut weights = gather(chart, &points, &shares);
    if match_second_moments(&chart.places, &mut weights, &target).is_ok() {
        return (weights, Ok(Order::Quadratic));
    }
    // Of two affine rules the vertices' has the smaller error: it is not of one sign.
    if match_centroid(&chart.places, &mut areas, &target).is_ok() {
        return (areas, Ok(Order::Affine));
    }
    (weights, outcome.map(|()| Order::Affine))
}

fn area_weights(chart: &Chart, kernel: &Kernel, areas: &[f64], centre: &Centre) -> Vec<f64> {
    let seen = chart.seen_vertices();
    let mut weights: Vec<f64> = (chart.vertices.iter().zip(&chart.places).zip(seen))
        .map(|((vertex, place), is_seen)| {
            if is_seen {
                areas[vertex.index()] * kernel.weight(place.norm())
            } else {
                0.0
            }
        })
        .collect();
    // With nothing but degenerate faces around it, or no vertex near, the centre stands for itself.
    if weights.iter().all(|&w| w <= 0.0) {
        for (vertex, weight) in centre.weights() {
            if let Ok(own) = chart.vertices.binary_search(vertex) {
                weights[own] = *weight;
            }
        }
    }
    weights
}

pub(crate) fn check_mesh(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
) -> Result<(), ConstraintError> {
    if mesh.face_count() == 0 {
        return Err(ConstraintError::EmptyRegion);
    }
    check_length("positions", mesh.vertex_count(), positions.len())?;
    let is_bad = |p: &Vector3<f64>| !p.iter().all(|c| c.is_finite());
    match positions.iter().position(is_bad) {
        Some(i) => Err(ConstraintError::PositionNotFinite {
            vertex: VertexId::from_index(i),
        }),
        None => Ok(()),
    }
}

fn check_finite_normals(normals: &[Vector3<f64>]) -> Result<(), ConstraintError> {
    let is_bad = |n: &Vector3<f64>| !n.iter().all(|c| c.is_finite());
    match normals.iter().position(is_bad) {
        Some(i) => Err(ConstraintError::NormalNotFinite {
            vertex: VertexId::from_index(i),
        }),
        None => Ok(()),
    }
}

pub(crate) fn check_length(
    what: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), ConstraintError> {
    if expected == found {
        return Ok(());
    }
    Err(ConstraintError::WrongLength {
        what,
        expected,
        found,
    })
}

pub(crate) fn check_vertex(mesh: &TriMesh, vertex: VertexId) -> Result<(), ConstraintError> {
    if vertex.index() < mesh.vertex_count() {
        return Ok(());
    }
    Err(ConstraintError::VertexOutOfRange {
        vertex,
        count: mesh.vertex_count(),
    })
}

fn check_kernel(centre: usize, kernel: &Kernel) -> Result<(), ConstraintError> {
    if kernel.is_valid() {
        return Ok(());
    }
    Err(ConstraintError::BadKernel {
        centre,
        sigma: kernel.sigma,
        cut: kernel.cut,
    })
}

fn check_normals(
    normals: &[Vector3<f64>],
    centre: &Centre,
    number: usize,
) -> Result<(), ConstraintError> {
    let is_unit = |v: &VertexId| (normals[v.index()].norm() - 1.0).abs() < 1e-6;
    // Opposite normals at the ends of an edge leave none in between.
    let has_direction = centre.interpolate(normals).norm() > 1e-3;
    match centre.carriers().find(|v| !is_unit(v)) {
        None if has_direction => Ok(()),
        _ => Err(ConstraintError::NoNormal { centre: number }),
    }
}
