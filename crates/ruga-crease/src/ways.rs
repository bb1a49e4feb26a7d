//! Straight ways over a surface: in its texture layout, and in a plane through space.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{FaceId, MaterialPoint, PerFace, TriMesh};

use crate::LineTracer;
use crate::layout_places::{SAME_UV, hangs_together, uv_at};
use crate::walk::{End, Straight};

/// Straight in the texture layout, as far as charts go.
pub(crate) struct UvWay<'a> {
    uvs: &'a PerFace<[Vector2<f64>; 3]>,
    mesh: &'a TriMesh,
    from: Vector2<f64>,
    to: Vector2<f64>,
}

impl<'a> UvWay<'a> {
    pub(crate) fn new(
        uvs: &'a PerFace<[Vector2<f64>; 3]>,
        mesh: &'a TriMesh,
        [from, to]: [Vector2<f64>; 2],
    ) -> Self {
        Self {
            uvs,
            mesh,
            from,
            to: to - from,
        }
    }
}

impl Straight for UvWay<'_> {
    fn side(&self, face: FaceId) -> [f64; 3] {
        self.uvs[face].map(|uv| self.to.perp(&(uv - self.from)))
    }

    fn along(&self, face: FaceId) -> [f64; 3] {
        let square = self.to.norm_squared();
        self.uvs[face].map(|uv| self.to.dot(&(uv - self.from)) / square)
    }

    fn is_at(&self, end: End, face: FaceId, barycentric: [f64; 3]) -> bool {
        let here = uv_at(self.uvs, &MaterialPoint { face, barycentric });
        let end = match end {
            End::Start => self.from,
            End::Goal => self.from + self.to,
        };
        (here - end).amax() < SAME_UV
    }

    fn goes_on(&self, face: FaceId, corner: usize, next: FaceId) -> bool {
        hangs_together(self.mesh, self.uvs, [face, next], corner)
    }
}

/// Straight in space, in a plane across the surface.
pub(crate) struct SpaceWay<'a> {
    pub(crate) tracer: &'a LineTracer<'a>,
    pub(crate) from: Vector3<f64>,
    /// The way over its length squared.
    pub(crate) to: Vector3<f64>,
    pub(crate) across: Vector3<f64>,
}

impl Straight for SpaceWay<'_> {
    fn side(&self, face: FaceId) -> [f64; 3] {
        let corners = self.tracer.corners(face);
        corners.map(|p| self.across.dot(&(p - self.from)))
    }

    fn along(&self, face: FaceId) -> [f64; 3] {
        let corners = self.tracer.corners(face);
        corners.map(|p| self.to.dot(&(p - self.from)))
    }

    fn is_at(&self, _: End, _: FaceId, _: [f64; 3]) -> bool {
        true
    }

    fn goes_on(&self, _: FaceId, _: usize, _: FaceId) -> bool {
        true
    }
}
