//! The surface that remeshed vertices live on, and the mesh that is remeshed.

use nalgebra::Vector3;
use ruga_mesh::{Id, MaterialPoint, PerEdge, PerVertex, TriMesh};

use crate::RemeshError;

/// A smooth rest surface addressed by material points.
///
/// Positions are in metres, normals are of length one and point to the side from which faces are
/// counter-clockwise.
pub trait Surface {
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

/// A mesh on a [`Surface`].
#[derive(Clone, Debug)]
pub struct SurfaceMesh {
    /// Connectivity; every vertex has one fan of faces.
    pub mesh: TriMesh,
    /// Where each vertex lies on the surface.
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
    /// [`RemeshError::Length`] unless there is one point per vertex.
    pub fn on_surface(
        mesh: TriMesh,
        points: PerVertex<MaterialPoint>,
        surface: &dyn Surface,
    ) -> Result<Self, RemeshError> {
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

    pub(crate) fn check(&self) -> Result<(), RemeshError> {
        let vertices = self.mesh.vertex_count();
        check_length("points", self.points.len(), vertices)?;
        check_length("positions", self.positions.len(), vertices)?;
        check_length("fixed", self.fixed.len(), vertices)?;
        check_length("features", self.features.len(), self.mesh.edges().len())?;
        match self
            .positions
            .iter()
            .find(|(_, p)| !p.iter().all(|c| c.is_finite()))
        {
            Some((vertex, _)) => Err(RemeshError::Position { vertex }),
            None => Ok(()),
        }
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
    /// [`RemeshError::Length`] where an array does not fit the mesh.
    pub fn new(
        mesh: &'a TriMesh,
        positions: &'a [Vector3<f64>],
        features: &'a PerEdge<bool>,
    ) -> Result<Self, RemeshError> {
        check_length("positions", positions.len(), mesh.vertex_count())?;
        check_length("features", features.len(), mesh.edges().len())?;
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
    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        at.interpolate(self.mesh, self.positions)
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        let normal = at.interpolate(self.mesh, &self.normals);
        normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    }

    fn closest(&self, near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        crate::closest::descend(self.mesh, self.positions, near.face, target)
    }

    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        target: Vector3<f64>,
    ) -> MaterialPoint {
        crate::closest::on_feature(self.mesh, self.positions, self.features, between, target)
            .unwrap_or_else(|| self.closest(between[0], target))
    }
}
