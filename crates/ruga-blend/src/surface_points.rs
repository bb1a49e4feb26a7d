//! Chosen places of the driver's smooth surface, in any pose.

use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{Id, LimitPoints, LoopSurface, MaterialPoint, TriMesh, vertex_normals};

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
    pub fn new(driver: &Driver, points: Vec<MaterialPoint>, smoothing: Smoothing) -> Self {
        Self::new_while(driver, points, smoothing, &mut || true).expect("nothing ends it early")
    }

    /// Does what [`Self::new`] does as long as `goes_on`, which is asked every few ten thousand
    /// points, agrees; `None` when it does not.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn new_while(
        driver: &Driver,
        points: Vec<MaterialPoint>,
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
                Places::OnLimit(LimitPoints::new(surface, points, goes_on)?)
            }
            Smoothing::None => Places::OnFacets(points),
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
        self.pose_some(0..self.points().len(), control)
    }

    /// Positions (m), unit normals and tangents of [`pose`](Self::pose) at the points with these numbers.
    ///
    /// # Panics
    /// As [`pose`](Self::pose), and when there are no such points.
    pub fn pose_some(&self, points: Range<usize>, control: &[Vector3<f64>]) -> PosedSurface {
        self.check(control);
        match &self.places {
            Places::OnLimit(limit) => self.pose_limit((limit, points), control),
            Places::OnFacets(places) => self.pose_facets(&places[points], control),
        }
    }

    /// Two tangents at some of the points, by their numbers, that move with the material, m: how the surface changes
    /// with the barycentric coordinates of the driver's face there.
    ///
    /// # Panics
    /// When there is not one control point per vertex of the driver, or there are no such points.
    pub fn some_derivatives(
        &self,
        points: Range<usize>,
        control: &[Vector3<f64>],
    ) -> Vec<[Vector3<f64>; 2]> {
        self.check(control);
        match &self.places {
            Places::OnLimit(limit) => limit.some_derivatives(points, control),
            Places::OnFacets(places) => {
                let edges = |point: &MaterialPoint| {
                    let [a, b, c] =
                        self.topology.faces()[point.face].map(|v| control[v.0 as usize]);
                    [b - a, c - a]
                };
                places[points].iter().map(edges).collect()
            }
        }
    }

    fn check(&self, control: &[Vector3<f64>]) {
        assert_eq!(
            control.len(),
            self.topology.vertex_count(),
            "one control point per vertex"
        );
    }

    fn pose_limit(
        &self,
        (limit, points): (&LimitPoints, Range<usize>),
        control: &[Vector3<f64>],
    ) -> PosedSurface {
        let planes = limit.some_planes(points.clone(), control);
        let none = vec![Vector3::zeros(); planes.len()];
        let mut posed = PosedSurface {
            normals: none.clone(),
            tangents: none.clone(),
            positions: none,
        };
        let places = posed.positions.par_iter_mut().zip(&mut posed.normals);
        let places = places.zip(&mut posed.tangents).with_min_len(POINTS_AT_ONCE);
        let on_limit = planes.par_iter().zip(&limit.points()[points]);
        let on_limit = places.zip(on_limit);
        on_limit.for_each(|(((position, normal), tangent), (plane, point))| {
            let facet = || {
                let [a, b, c] = self.topology.faces()[point.face].map(|v| control[v.0 as usize]);
                (b - a).cross(&(c - a)).try_normalize(0.0)
            };
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
