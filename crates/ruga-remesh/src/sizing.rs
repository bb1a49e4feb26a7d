//! The sizing: how long edges should be at each vertex in each direction, and its limits.

use std::ops::RangeInclusive;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_mesh::{Id, MaterialPoint, PerVertex, VertexId, tangent_frame};

use crate::grading::grade;
use crate::surface::check_length;
use crate::tensor2::Tensor2;
use crate::tensor3::Tensor3;
use crate::{RemeshError, Surface, SurfaceMesh};

/// Vertices per metric area: 1.155 for equilateral triangles with edges of length one, times the
/// excess measured on remeshed squares (1.10 to 1.18), whose mean edge is 0.93.
const VERTICES_PER_METRIC_AREA: f64 = 1.155 * 1.14;

/// A relative excess of an eigenvalue over a limit, 2 % in length, that is left alone. It lets a sizing that was limited, carried
/// to another mesh and limited again come out unchanged although interpolation over a curved surface has shortened it a little.
const LIMIT_SLACK: f64 = 0.04;

/// Sine of the angle between a direction and the normal under which the direction counts as normal.
const LEAST_TANGENT: f64 = 1e-9;

/// Vertices that a thread takes at least.
const AT_ONCE: usize = 1 << 9;

/// Lengths, m, whose square and its inverse are finite and not zero.
const SQUARABLE: RangeInclusive<f64> = 1e-150..=1e150;

/// A symmetric tensor per vertex, 1/m², tangent to the surface: an edge `e` has the metric length
/// `sqrt(eᵀ M e)`, dimensionless, wanted near one.
///
/// Between vertices tensors are interpolated linearly, as Narain et al. (2012) do.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizing {
    /// The tensors, 1/m².
    pub tensors: PerVertex<Matrix3<f64>>,
}

/// Limits that every sizing is held to before a mesh follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeLimits {
    /// Shortest wanted edge, m; not negative. Default 0. It bounds cost.
    pub min_edge: f64,
    /// Longest wanted edge, m; positive, not under `min_edge`. It says how coarse the mesh is where
    /// nothing else asks for edges. Default infinite: no edge is wanted longer than the diagonal
    /// of the box around the mesh, so that coordinates in any unit give the same mesh.
    pub max_edge: f64,
    /// Largest ratio of the wanted lengths of two directions at a place; at least 1. Default 2:
    /// hinge bending is 20 to 40 % too soft on longer triangles; up to 4 with a bending operator
    /// that bears it. A larger aspect saves vertices in proportion.
    pub aspect: f64,
    /// Growth of the wanted length per metric length, positive; infinite switches it off.
    /// Default 0.5: an edge is at most about half as long again as its neighbour. Smaller values
    /// give rounder triangles between fine and coarse parts, larger ones fewer vertices.
    pub grading: f64,
}

impl Default for SizeLimits {
    fn default() -> Self {
        Self {
            min_edge: 0.0,
            max_edge: f64::INFINITY,
            aspect: 2.0,
            grading: 0.5,
        }
    }
}

impl SizeLimits {
    /// Checks the ranges that the fields' docs state.
    ///
    /// # Errors
    /// [`RemeshError::Setting`] or [`RemeshError::EdgeRange`].
    pub fn check(&self) -> Result<(), RemeshError> {
        setting("min_edge", self.min_edge, "0 or more, finite", |v| {
            v >= 0.0 && v.is_finite()
        })?;
        setting("max_edge", self.max_edge, "positive", |v| v > 0.0)?;
        setting("aspect", self.aspect, "1 or more, finite", |v| {
            v >= 1.0 && v.is_finite()
        })?;
        setting("grading", self.grading, "positive", |v| v > 0.0)?;
        if self.min_edge > self.max_edge {
            return Err(RemeshError::EdgeRange {
                min_edge: self.min_edge,
                max_edge: self.max_edge,
            });
        }
        Ok(())
    }

    /// These limits with the longest edge held to the extent of a mesh.
    pub(crate) fn within(&self, mesh: &SurfaceMesh) -> Self {
        let max_edge = self.max_edge.min(extent(&mesh.positions));
        Self {
            max_edge: max_edge.max(self.min_edge),
            ..*self
        }
    }

    /// A tensor made tangent and held to the limits; `None` when it is no metric.
    pub(crate) fn hold(&self, tensor: &Matrix3<f64>, normal: Vector3<f64>) -> Option<Matrix3<f64>> {
        let frame = tangent_frame(normal, Vector3::zeros());
        is_metric(tensor).then(|| {
            let flat = self.clamp(Tensor2::in_frame(tensor, &frame));
            flat.in_space(&frame)
        })
    }

    /// The tensor with eigenvalues raised or lowered into the limits.
    fn clamp(&self, tensor: Tensor2) -> Tensor2 {
        let least = self.max_edge.powi(-2);
        // Infinite without a shortest edge, which then clamps nothing.
        let most = self.min_edge.powi(-2);
        let values = tensor.eigenvalues();
        // What the aspect bound raises is the coarse direction: it adds vertices, never takes any.
        let floor = least.max(values[0].clamp(least, most) / self.aspect.powi(2));
        let (low, high) = ((1.0 - LIMIT_SLACK) * floor, (1.0 + LIMIT_SLACK) * most);
        if values[1] >= low && values[0] <= high {
            return tensor;
        }
        tensor.map_eigenvalues(|value| value.clamp(floor, most))
    }
}

/// Diagonal of the box around some positions, m; one where it has none, or none that squares.
fn extent(positions: &PerVertex<Vector3<f64>>) -> f64 {
    let mut all = positions.as_slice().iter();
    let Some(&first) = all.next() else {
        return 1.0;
    };
    let (low, high) = all.fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let diagonal = (high - low).norm();
    if SQUARABLE.contains(&diagonal) {
        diagonal
    } else {
        1.0
    }
}

pub(crate) fn setting(
    name: &'static str,
    value: f64,
    accepted: &'static str,
    is_accepted: impl Fn(f64) -> bool,
) -> Result<(), RemeshError> {
    if is_accepted(value) {
        Ok(())
    } else {
        Err(RemeshError::Setting {
            name,
            value,
            accepted,
        })
    }
}

/// Wanted edges as a function of the place and its position (m): a tensor as in [`Sizing`]. Several threads
/// ask at once.
///
/// [`size_tensor`] makes such tensors.
pub type Metric<'a> = dyn Fn(MaterialPoint, Vector3<f64>) -> Matrix3<f64> + Sync + 'a;

impl Sizing {
    /// Asks for edges of the length `edge` (m, positive) everywhere and in every direction.
    ///
    /// # Errors
    /// [`RemeshError::Setting`] for a length that is not a positive number.
    pub fn uniform(vertex_count: usize, edge: f64) -> Result<Self, RemeshError> {
        wanted_length("edge", edge)?;
        let tensor = Matrix3::identity() / (edge * edge);
        Ok(Self {
            tensors: PerVertex::filled(vertex_count, tensor),
        })
    }

    /// Asks `metric` at every vertex of a mesh.
    pub fn from_metric(mesh: &SurfaceMesh, metric: &Metric<'_>) -> Self {
        let positions = mesh.positions.as_slice().par_iter().enumerate();
        let points = mesh.points.as_slice();
        let ask = |(v, &position): (usize, _)| metric(points[v], position);
        let tensors: Vec<_> = positions.with_min_len(AT_ONCE).map(ask).collect();
        Self {
            tensors: tensors.into(),
        }
    }

    /// The sizing made tangent and held to limits: edge lengths, aspect, then grading.
    ///
    /// Lengths are clamped first, so that grading sees what will be meshed; grading only refines.
    ///
    /// # Errors
    /// Limits out of range, a mesh that does not fit the surface, a sizing that does not fit the
    /// mesh, or a bad tensor.
    pub fn limited(
        &self,
        mesh: &SurfaceMesh,
        surface: &dyn Surface,
        limits: &SizeLimits,
    ) -> Result<Self, RemeshError> {
        limits.check()?;
        mesh.check_on(surface)?;
        self.check(mesh.mesh.vertex_count())?;
        let limits = limits.within(mesh);
        let frames: Vec<[Vector3<f64>; 2]> = mesh
            .points
            .as_slice()
            .par_iter()
            .with_min_len(AT_ONCE)
            .map(|&point| tangent_frame(surface.normal(point), Vector3::zeros()))
            .collect();
        let tensors = self.tensors.as_slice().par_iter().with_min_len(AT_ONCE);
        let mut flat: Vec<Tensor2> = tensors
            .zip(&frames)
            .map(|(tensor, frame)| limits.clamp(Tensor2::in_frame(tensor, frame)))
            .collect();
        grade(mesh, &frames, limits.grading, &mut flat);
        let graded = flat.par_iter().with_min_len(AT_ONCE).zip(&frames);
        // Grading refines each direction by itself, which may stretch the aspect past its limit.
        let tensors: Vec<_> = graded
            .map(|(&tensor, frame)| limits.clamp(tensor).in_space(frame))
            .collect();
        Ok(Self {
            tensors: tensors.into(),
        })
    }

    /// Number of vertices that a mesh following this sizing has, to about 20 %.
    ///
    /// # Errors
    /// Arrays that do not fit the mesh, or positions that are not finite.
    pub fn vertex_estimate(&self, mesh: &SurfaceMesh) -> Result<usize, RemeshError> {
        mesh.check()?;
        check_length("sizing", self.tensors.len(), mesh.mesh.vertex_count())?;
        let area: f64 = mesh
            .mesh
            .faces()
            .as_slice()
            .iter()
            .map(|face| {
                let [a, b, c] = face.map(|v| mesh.positions[v]);
                let sum = face
                    .iter()
                    .fold(Matrix3::zeros(), |sum, &v| sum + self.tensors[v]);
                metric_area(&[b - a, c - b, a - c], &Tensor3::from_matrix(&(sum / 3.0)))
            })
            .sum();
        Ok((VERTICES_PER_METRIC_AREA * area) as usize)
    }

    fn check(&self, vertex_count: usize) -> Result<(), RemeshError> {
        check_length("sizing", self.tensors.len(), vertex_count)?;
        let tensors = self.tensors.as_slice().par_iter().with_min_len(AT_ONCE);
        match tensors.position_first(|tensor| !is_metric(tensor)) {
            Some(vertex) => Err(RemeshError::Tensor {
                vertex: VertexId::from_index(vertex),
            }),
            None => Ok(()),
        }
    }
}

/// Says whether a tensor is finite, symmetric and not negative.
fn is_metric(tensor: &Matrix3<f64>) -> bool {
    let scale = tensor.norm();
    scale.is_finite()
        && (tensor - tensor.transpose()).norm() <= 1e-9 * scale
        // A tangent tensor has an eigenvalue of zero, which rounding may make negative.
        && tensor.symmetric_eigenvalues().min() >= -1e-9 * scale
}

/// The tensor of a place where edges should be `across` long in the direction of `direction` and
/// `along` at right angles to it, m; zero normal to the surface.
///
/// `normal` and `direction` need not be of length one; only the part of `direction` tangent to the
/// surface counts.
///
/// # Errors
/// [`RemeshError::Setting`] for a length that is not a positive number, and
/// [`RemeshError::Direction`] where the direction has no part tangent to the surface.
pub fn size_tensor(
    normal: Vector3<f64>,
    direction: Vector3<f64>,
    across: f64,
    along: f64,
) -> Result<Matrix3<f64>, RemeshError> {
    wanted_length("across", across)?;
    wanted_length("along", along)?;
    let [first, second] = tangents(normal, direction).ok_or(RemeshError::Direction {
        direction: direction.into(),
        normal: normal.into(),
    })?;
    let across = first * first.transpose() / (across * across);
    Ok(across + second * second.transpose() / (along * along))
}

/// The unit tangent along a direction and the one across it; `None` where the direction has no
/// tangent part but rounding, or is no direction.
fn tangents(normal: Vector3<f64>, direction: Vector3<f64>) -> Option<[Vector3<f64>; 2]> {
    let [normal, direction] = [normal, direction].map(|v| v.try_normalize(0.0));
    let (normal, direction) = (normal?, direction?);
    let tangent = direction - normal * normal.dot(&direction);
    // Infinite vectors have no direction: they come out of the first line as NaN, which fails here.
    let first = tangent.try_normalize(LEAST_TANGENT)?;
    first
        .iter()
        .all(|c| c.is_finite())
        .then(|| [first, normal.cross(&first)])
}

fn wanted_length(name: &'static str, value: f64) -> Result<(), RemeshError> {
    setting(name, value, "1e-150 to 1e150 m", |v| SQUARABLE.contains(&v))
}

/// `sqrt(eᵀ M e)`.
pub(crate) fn metric_length(edge: &Vector3<f64>, tensor: &Tensor3) -> f64 {
    tensor.square(edge).max(0.0).sqrt()
}

/// Metric area of a triangle with the given edge vectors, by Heron's formula.
pub(crate) fn metric_area(edges: &[Vector3<f64>; 3], tensor: &Tensor3) -> f64 {
    let [a, b, c] = edges.each_ref().map(|e| tensor.square(e));
    area_of_squares(a, b, c)
}

/// Area of the triangle whose squared side lengths are given; zero where there is none.
pub(crate) fn area_of_squares(a: f64, b: f64, c: f64) -> f64 {
    // From squares alone, so a metric area costs one root; needles may round below zero.
    let sixteen = 2.0 * (a * b + b * c + c * a) - (a * a + b * b + c * c);
    sixteen.max(0.0).sqrt() / 4.0
}
