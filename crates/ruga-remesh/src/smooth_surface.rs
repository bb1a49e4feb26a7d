//! The Loop limit surface of a triangle mesh, as a surface that meshes live on.

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_mesh::{
    LoopSurface, MaterialPoint, PerEdge, PerVertex, SurfaceJet, TriMesh, limit_rows,
    sharp_border_corners, vertex_normals,
};

use crate::surface::{check_finite, check_length, sums_to_one};
use crate::{PolyhedralSurface, RemeshError, Surface, SurfaceMesh};

/// Steps of the search for a closest place, which ends before when none of them leads closer.
const STEPS: usize = 12;

/// A triangle mesh made smooth: the Loop limit surface of its vertices as control points.
///
/// Corners of the border that turn by more than 60 degrees stay sharp.
///
/// ```
/// use nalgebra::Vector3;
/// use ruga_mesh::{FaceId, MaterialPoint};
/// use ruga_remesh::{Surface, SmoothSurface};
///
/// // An octahedron becomes a ball.
/// let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
/// let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let ball = SmoothSurface::new(&[x, -x, y, -y, z, -z], &faces)?;
/// let middle = MaterialPoint { face: FaceId(0), barycentric: [1.0 / 3.0; 3] };
/// assert!((ball.normal(middle) - (x + y + z).normalize()).norm() < 1e-12);
/// # Ok::<(), ruga_remesh::RemeshError>(())
/// ```
///
/// # Panics
/// The methods of [`Surface`], other than `contains`, where they are given a face that the
/// surface's mesh does not have.
#[derive(Clone, Debug)]
pub struct SmoothSurface {
    mesh: TriMesh,
    control: Vec<Vector3<f64>>,
    surface: LoopSurface,
    /// Limit positions of the vertices and their normals: the facets on which searches start.
    facets: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    seams: PerEdge<bool>,
}

impl SmoothSurface {
    /// Makes the surface of some positions (m) and triangles.
    ///
    /// # Errors
    /// [`RemeshError::Mesh`] for triangles that are no mesh, [`RemeshError::Position`] for the first
    /// position that is not finite.
    pub fn new(positions: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<Self, RemeshError> {
        let mesh = TriMesh::new(positions.len(), triangles.to_vec())?;
        let corners = sharp_border_corners(&mesh, positions);
        Self::of_mesh(mesh, positions, &corners)
    }

    /// Makes the surface of a mesh; `corners` marks the vertices that stay sharp.
    ///
    /// # Errors
    /// [`RemeshError::Length`] where an array does not fit the mesh, [`RemeshError::Position`] for
    /// the first position that is not finite.
    pub fn of_mesh(
        mesh: TriMesh,
        positions: &[Vector3<f64>],
        corners: &PerVertex<bool>,
    ) -> Result<Self, RemeshError> {
        check_length("positions", positions.len(), mesh.vertex_count())?;
        check_length("corners", corners.len(), mesh.vertex_count())?;
        check_finite(positions)?;
        let facets = limit_rows(&mesh, corners).position.apply(positions);
        Ok(Self {
            surface: LoopSurface::new(&mesh, corners),
            control: positions.to_vec(),
            normals: vertex_normals(&mesh, &facets),
            facets,
            seams: PerEdge::filled(mesh.edges().len(), false),
            mesh,
        })
    }

    /// Connectivity of the control mesh, which addresses places of the surface.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Position and derivatives at a place.
    ///
    /// # Panics
    /// When the mesh does not have the place's face.
    pub fn jet(&self, at: MaterialPoint) -> SurfaceJet {
        self.surface.jets(&[at], &self.control)[0]
    }

    /// The mesh with a vertex at the limit of each control point, ready for
    /// [`remesh`](crate::remesh).
    ///
    /// # Errors
    /// [`RemeshError::NonManifoldVertex`] for a vertex without faces.
    pub fn vertex_mesh(&self) -> Result<SurfaceMesh, RemeshError> {
        let points = self.facets()?.vertex_points()?;
        SurfaceMesh::on_surface(self.mesh.clone(), points, self)
    }

    fn facets(&self) -> Result<PolyhedralSurface<'_>, RemeshError> {
        PolyhedralSurface::new(&self.mesh, &self.facets, &self.seams)
    }

    fn facet(&self, at: MaterialPoint) -> Vector3<f64> {
        at.interpolate(&self.mesh, &self.facets)
    }
}

impl Surface for SmoothSurface {
    fn contains(&self, at: MaterialPoint) -> bool {
        (at.face.0 as usize) < self.mesh.face_count() && sums_to_one(at)
    }

    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        let rows = self.surface.position_rows(&[at]);
        rows.apply(&self.control)[0]
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        // At irregular vertices the derivatives may span no plane.
        self.jet(at).normal().unwrap_or_else(|| {
            let normal = at.interpolate(&self.mesh, &self.normals);
            normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        })
    }

    /// Newton steps along the tangent plane, from the closest place of the facets; a step that
    /// leaves the face goes on in the next one.
    fn closest(&self, near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        let descend =
            |face, target| crate::closest::descend(&self.mesh, &self.facets, face, target);
        // Facets know their neighbours, so the search for the face is done on them; Newton's method
        // then starts close by.
        let mut place = descend(near.face, target);
        let mut jet = self.jet(place);
        for _ in 0..STEPS {
            let off = target - jet.position;
            let [u, v] = jet.first;
            // Without the curvature a step towards a distant target is too long on a convex side. Where
            // with it the distance is no convex function, the bare metric still leads downhill.
            let metric = Matrix2::new(u.dot(&u), u.dot(&v), u.dot(&v), v.dot(&v));
            let [uu, uv, vv] = jet.second.map(|second| off.dot(&second));
            let newton = (metric - Matrix2::new(uu, uv, uv, vv)).cholesky();
            let Some(factor) = newton.or_else(|| metric.cholesky()) else {
                break;
            };
            let step = factor.solve(&Vector2::new(u.dot(&off), v.dot(&off)));
            // In space, because beside irregular vertices the parameters run ever slower or faster.
            let along = u * step.x + v * step.y;
            // Halved until closer, since distance is all that counts: a full step may pass the
            // place where the surface bends away.
            let closer = [1.0, 0.5, 0.25, 0.125].into_iter().find_map(|part| {
                // From the facet's place, not the surface's: the search goes over facets, and the
                // offset between the two would be added with each step.
                let there = descend(place.face, self.facet(place) + along * part);
                let jet = self.jet(there);
                let is_closer = (target - jet.position).norm_squared() < off.norm_squared();
                is_closer.then_some((there, jet))
            });
            match closer {
                Some(found) => (place, jet) = found,
                None => break,
            }
        }
        place
    }

    /// On the border, so that what is split there stays there.
    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        target: Vector3<f64>,
    ) -> MaterialPoint {
        let on_facets = |target| {
            crate::closest::on_feature(&self.mesh, &self.facets, &self.seams, between, target)
        };
        let Some(mut place) = on_facets(target) else {
            return self.closest(between[0], target);
        };
        // The facets' border is moved onto the surface's, which leaves a fraction of the distance
        // between the two each time.
        for _ in 0..2 {
            let off = self.position(place) - self.facet(place);
            place = on_facets(target - off).unwrap_or(place);
        }
        place
    }
}
