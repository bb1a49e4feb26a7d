//! Chosen places of the driver's smooth surface, in any pose.

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{
    Id, LimitPoints, LoopSurface, MaterialPoint, TriMesh, face_normals, vertex_normals,
};

use crate::base_surface::material_tangent;
use crate::{Driver, PosedSurface, Smoothing};

/// Points that a thread poses at least.
const POINTS_AT_ONCE: usize = 1024;

/// Material points of a driver, with what poses them.
///
/// The surface between the driver's vertices is linear in them, so that a pose costs a few
/// products per point.
#[derive(Clone, Debug)]
pub struct SurfacePoints {
    topology: TriMesh,
    places: Places,
}

/// The points on what is posed.
#[derive(Clone, Debug)]
enum Places {
    OnLimit(LimitPoints),
    OnFacets(Vec<MaterialPoint>),
}

impl SurfacePoints {
    /// Prepares `points` on the faces of `driver`.
    ///
    /// # Panics
    /// When a point lies on a face that the driver does not have.
    pub fn new(driver: &Driver, points: &[MaterialPoint], smoothing: Smoothing) -> Self {
        Self::new_while(driver, points, smoothing, &mut || true).expect("nothing ends it early")
    }

    /// Does what [`Self::new`] does as long as `goes_on`, which is asked every few ten thousand
    /// points, agrees; `None` when it does not.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn new_while(
        driver: &Driver,
        points: &[MaterialPoint],
        smoothing: Smoothing,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let count = driver.topology().face_count();
        assert!(
            points.iter().all(|point| point.face.index() < count),
            "every point lies on one of the driver's {count} faces"
        );
        let places = match smoothing {
            Smoothing::Loop => {
                let surface = LoopSurface::new(driver.topology(), driver.corners());
                Places::OnLimit(LimitPoints::new(surface, points.to_vec(), goes_on)?)
            }
            Smoothing::None => Places::OnFacets(points.to_vec()),
        };
        Some(Self {
            topology: driver.topology().clone(),
            places,
        })
    }

    /// Places of the points on the driver's faces.
    pub fn points(&self) -> &[MaterialPoint] {
        match &self.places {
            Places::OnLimit(points) => points.points(),
            Places::OnFacets(points) => points,
        }
    }

    /// Positions (m), unit normals and tangents from the driver's control points (m).
    ///
    /// On flat facets normals are those of the vertices, interpolated. A place without limit
    /// normal, such as a corner, has its facet's.
    ///
    /// # Panics
    /// When there is not one control point per vertex of the driver.
    pub fn pose(&self, control: &[Vector3<f64>]) -> PosedSurface {
        match &self.places {
            Places::OnLimit(points) => self.pose_limit(points, control),
            Places::OnFacets(points) => self.pose_facets(points, control),
        }
    }

    /// Two tangents at every point that move with the material, m: how the surface changes with the
    /// barycentric coordinates of its driver face.
    ///
    /// # Panics
    /// When there is not one control point per vertex of the driver.
    pub fn derivatives(&self, control: &[Vector3<f64>]) -> Vec<[Vector3<f64>; 2]> {
        assert_eq!(
            control.len(),
            self.topology.vertex_count(),
            "one control point per vertex"
        );
        match &self.places {
            Places::OnLimit(points) => points.derivatives(control),
            Places::OnFacets(points) => {
                let edges = |point: &MaterialPoint| {
                    let [a, b, c] =
                        self.topology.faces()[point.face].map(|v| control[v.0 as usize]);
                    [b - a, c - a]
                };
                points.iter().map(edges).collect()
            }
        }
    }

    fn pose_limit(&self, points: &LimitPoints, control: &[Vector3<f64>]) -> PosedSurface {
        let facets = face_normals(&self.topology, control);
        let planes = points.planes(control);
        let none = vec![Vector3::zeros(); planes.len()];
        let mut posed = PosedSurface {
            normals: none.clone(),
            tangents: none.clone(),
            positions: none,
        };
        let places = posed.positions.par_iter_mut().zip(&mut posed.normals);
        let places = places.zip(&mut posed.tangents).with_min_len(POINTS_AT_ONCE);
        let on_limit = planes.par_iter().zip(points.points());
        let on_limit = places.zip(on_limit);
        on_limit.for_each(|(((position, normal), tangent), (plane, point))| {
            let facet = || facets[point.face].try_normalize(0.0);
            // A collapsed facet has no normal either; any unit vector keeps what follows finite.
            *normal = plane.normal().or_else(facet).unwrap_or_else(Vector3::z);
            *position = plane.position;
            *tangent = self.tangent(&plane.first[0], normal, point, control);
        });
        posed
    }

    fn pose_facets(&self, points: &[MaterialPoint], control: &[Vector3<f64>]) -> PosedSurface {
        let normals = vertex_normals(&self.topology, control);
        let mut posed = PosedSurface::default();
        for point in points {
            let normal = point.interpolate(&self.topology, &normals);
            let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
            posed
                .positions
                .push(point.interpolate(&self.topology, control));
            posed.normals.push(normal);
            posed
                .tangents
                // Facets have no derivatives that are the same on both sides: zero asks for the
                // first edge.
                .push(self.tangent(&Vector3::zeros(), &normal, point, control));
        }
        posed
    }

    /// A tangent that moves with the material: along `direction`, or else along the facet's first
    /// edge.
    fn tangent(
        &self,
        direction: &Vector3<f64>,
        normal: &Vector3<f64>,
        point: &MaterialPoint,
        control: &[Vector3<f64>],
    ) -> Vector3<f64> {
        let [a, b, _] = self.topology.faces()[point.face].map(|v| control[v.0 as usize]);
        let edge = b - a;
        // At an innermost point of an irregular vertex derivatives may be tiny, never the edge.
        if direction.norm() > 1e-6 * edge.norm() {
            material_tangent(direction, normal)
        } else {
            material_tangent(&edge, normal)
        }
    }
}
