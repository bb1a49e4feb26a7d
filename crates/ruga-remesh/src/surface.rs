//! The surface that remeshed vertices live on, and the mesh that is remeshed.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint, PerEdge, PerVertex, TriMesh};

use crate::RemeshError;

/// Difference of the sum of barycentric coordinates from one that is still rounding, after it has
/// gone through files of single precision.
const SUM_TOLERANCE: f64 = 1e-4;

/// A smooth rest surface addressed by material points.
///
/// Positions are in metres, normals are of length one and point to the side from which faces are
/// counter-clockwise.
///
/// Every place that is asked about is one that [`Surface::contains`] has accepted, or one that the
/// surface itself has named. Several threads ask at once, in any order and also for vertices that are not
/// made in the end, so that the same question must have the same answer.
pub trait Surface: Sync {
    /// Says whether a material point is a place of this surface.
    ///
    /// The provided method knows no faces: it looks at the coordinates only.
    fn contains(&self, at: MaterialPoint) -> bool {
        sums_to_one(at)
    }

    /// Rest position of a place, m.
    fn position(&self, at: MaterialPoint) -> Vector3<f64>;

    /// Unit normal of the rest surface at a place.
    fn normal(&self, at: MaterialPoint) -> Vector3<f64>;

    /// The place closest to `target` (m), searched from `near` along the surface.
    ///
    /// Where two parts of the surface touch, as closed lips do, the part that `near` is on wins.
    fn closest(&self, near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint;

    /// The place closest to `target` on the feature curve (border or seam) that runs from one of
    /// the places `between` to the other.
    ///
    /// Asked for when a feature edge is split. The provided method is right where features need
    /// not be kept better than their chords, as on the pinned ring of an active region.
    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        target: Vector3<f64>,
    ) -> MaterialPoint {
        self.closest(between[0], target)
    }
}

/// Says whether barycentric coordinates are numbers of sum one.
pub(crate) fn sums_to_one(at: MaterialPoint) -> bool {
    (at.barycentric.iter().sum::<f64>() - 1.0).abs() <= SUM_TOLERANCE
}

/// A mesh on a [`Surface`].
#[derive(Clone, Debug)]
pub struct SurfaceMesh {
    /// Connectivity; every vertex has one fan of faces.
    pub mesh: TriMesh,
    /// Place of each vertex on the surface.
    pub points: PerVertex<MaterialPoint>,
    /// Rest positions, m: the surface's positions of `points`.
    pub positions: PerVertex<Vector3<f64>>,
    /// Edges that survive (UV seams, sharp material boundaries): splittable, collapsible only
    /// along themselves. Border edges are features whether marked or not.
    pub features: PerEdge<bool>,
    /// Vertices that are neither moved nor removed. Edges between them are split like others, and
    /// a vertex that is born there is free.
    pub fixed: PerVertex<bool>,
}

impl SurfaceMesh {
    /// Puts vertices at material points of a surface, with no features but the border and no
    /// fixed vertices.
    ///
    /// # Errors
    /// [`RemeshError::Length`] unless there is one point per vertex, and [`RemeshError::Point`]
    /// for a point that is no place of the surface.
    pub fn on_surface(
        mesh: TriMesh,
        points: PerVertex<MaterialPoint>,
        surface: &dyn Surface,
    ) -> Result<Self, RemeshError> {
        check_points(&points, surface)?;
        let positions = points
            .as_slice()
            .iter()
            .map(|&p| surface.position(p))
            .collect();
        let result = Self {
            features: PerEdge::filled(mesh.edges().len(), false),
            fixed: PerVertex::filled(mesh.vertex_count(), false),
            mesh,
            points,
            positions,
        };
        result.check()?;
        Ok(result)
    }

    /// Checks the arrays, and that every vertex is on the surface.
    pub(crate) fn check_on(&self, surface: &dyn Surface) -> Result<(), RemeshError> {
        self.check()?;
        check_points(&self.points, surface)
    }

    pub(crate) fn check(&self) -> Result<(), RemeshError> {
        let vertices = self.mesh.vertex_count();
        check_length("points", self.points.len(), vertices)?;
        check_length("positions", self.positions.len(), vertices)?;
        check_length("fixed", self.fixed.len(), vertices)?;
        check_length("features", self.features.len(), self.mesh.edges().len())?;
        check_finite(self.positions.as_slice())
    }
}

fn check_points(
    points: &PerVertex<MaterialPoint>,
    surface: &dyn Surface,
) -> Result<(), RemeshError> {
    let mut all = points.iter().map(|(vertex, &point)| (vertex, point));
    match all.find(|&(_, point)| !surface.contains(point)) {
        Some((vertex, point)) => Err(RemeshError::Point { vertex, point }),
        None => Ok(()),
    }
}

pub(crate) fn check_finite(positions: &[Vector3<f64>]) -> Result<(), RemeshError> {
    let is_finite = |p: &Vector3<f64>| p.iter().all(|c| c.is_finite());
    match positions.iter().position(|p| !is_finite(p)) {
        Some(i) => Err(RemeshError::Position {
            vertex: Id::from_index(i),
        }),
        None => Ok(()),
    }
}

pub(crate) fn check_length(
    what: &'static str,
    got: usize,
    expected: usize,
) -> Result<(), RemeshError> {
    if got == expected {
        Ok(())
    } else {
        Err(RemeshError::Length {
            what,
            got,
            expected,
        })
    }
}

/// The facets of a triangle mesh as a [`Surface`]; vertex normals are interpolated.
///
/// Right for flat patches and for meshes that are much finer than what is remeshed on them.
///
/// # Panics
/// The methods of [`Surface`], other than `contains`, where they are given a face that the
/// surface's mesh does not have.
#[derive(Clone, Debug)]
pub struct PolyhedralSurface<'a> {
    mesh: &'a TriMesh,
    positions: &'a [Vector3<f64>],
    normals: Vec<Vector3<f64>>,
    features: &'a PerEdge<bool>,
}

impl<'a> PolyhedralSurface<'a> {
    /// The surface of `mesh` with `positions` in metres; `features` marks seams of the base mesh.
    ///
    /// # Errors
    /// [`RemeshError::Length`] where an array does not fit the mesh, and
    /// [`RemeshError::Position`] for the first vertex that is not finite.
    pub fn new(
        mesh: &'a TriMesh,
        positions: &'a [Vector3<f64>],
        features: &'a PerEdge<bool>,
    ) -> Result<Self, RemeshError> {
        check_length("positions", positions.len(), mesh.vertex_count())?;
        check_length("features", features.len(), mesh.edges().len())?;
        check_finite(positions)?;
        Ok(Self {
            mesh,
            positions,
            normals: ruga_mesh::vertex_normals(mesh, positions),
            features,
        })
    }

    /// One material point for each vertex of the surface's own mesh.
    ///
    /// # Errors
    /// [`RemeshError::NonManifoldVertex`] for a vertex without faces.
    pub fn vertex_points(&self) -> Result<PerVertex<MaterialPoint>, RemeshError> {
        (0..self.mesh.vertex_count())
            .map(Id::from_index)
            .map(|vertex| {
                MaterialPoint::of_vertex(self.mesh, vertex)
                    .ok_or(RemeshError::NonManifoldVertex { vertex })
            })
            .collect()
    }
}

impl Surface for PolyhedralSurface<'_> {
    fn contains(&self, at: MaterialPoint) -> bool {
        at.face.index() < self.mesh.face_count() && sums_to_one(at)
    }

    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        at.interpolate(self.mesh, self.positions)
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        let normal = at.interpolate(self.mesh, &self.normals);
        // Without a normal no face counts as upright there: it is not flipped, moved or collapsed.
        normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    }

    fn closest(&self, near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        // Along the surface: the closest facet in space may belong to the other lip.
        crate::closest::descend(self.mesh, self.positions, near.face, target)
    }

    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        target: Vector3<f64>,
    ) -> MaterialPoint {
        crate::closest::on_feature(self.mesh, self.positions, self.features, between, target)
            // A feature of the remeshed mesh alone, such as the ring around a region, is no curve
            // of this surface.
            .unwrap_or_else(|| self.closest(between[0], target))
    }
}
