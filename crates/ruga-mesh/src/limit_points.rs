//! Many places on a Loop limit surface.

use std::ops::Range;

use nalgebra::Vector3;

use crate::{Id, LimitPointRows, LoopSurface, MaterialPoint, SparseRows, TangentPlane};

/// Points whose rows are made between two questions whether to go on, about a tenth of a second.
const POINTS_AT_A_TIME: usize = 20_000;

/// Points up to which rows are kept: 500 bytes each, some 60 MB together. Without them the 22 frames of a smile, whose
/// output mesh has fewer points, take a tenth longer.
const MOST_KEPT: usize = 1 << 17;
/// Points for every face of the control mesh up to which rows take less memory than the surface itself.
const MOST_PER_FACE: usize = 2;

/// Material points on the Loop limit surface of a control mesh, ready to be evaluated for any control points.
#[derive(Clone, Debug)]
pub struct LimitPoints {
    points: Vec<MaterialPoint>,
    kept: Kept,
}

/// What is kept for the next evaluation.
#[derive(Clone, Debug)]
enum Kept {
    Rows(Box<LimitPointRows>),
    Surface(Box<LoopSurface>),
}

impl LimitPoints {
    /// Prepares `points` on the faces of the control mesh of `surface`; `None` as soon as `goes_on` says no. It is
    /// asked every few ten thousand points while rows are made, of which there are none for very many points.
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have.
    pub fn new(
        surface: LoopSurface,
        points: Vec<MaterialPoint>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let most = MOST_KEPT.max(MOST_PER_FACE * surface.face_count());
        Self::with_rows_up_to(most, (surface, points), goes_on)
    }

    fn with_rows_up_to(
        most: usize,
        (surface, points): (LoopSurface, Vec<MaterialPoint>),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let count = surface.face_count();
        assert!(
            points.iter().all(|point| point.face.index() < count),
            "every point lies on one of the {count} faces"
        );
        if points.len() > most {
            let kept = Kept::Surface(Box::new(surface));
            return Some(Self { points, kept });
        }
        let mut rows = LimitPointRows::default();
        for chunk in points.chunks(POINTS_AT_A_TIME) {
            surface.add_rows(chunk, &mut rows);
            if !goes_on() {
                return None;
            }
        }
        rows.shrink_to_fit();
        let kept = Kept::Rows(Box::new(rows));
        Some(Self { points, kept })
    }

    /// The points, in their order.
    pub fn points(&self) -> &[MaterialPoint] {
        &self.points
    }

    /// The surface at every point, for one set of control points (m).
    ///
    /// # Panics
    /// When there are fewer control points than the surface has vertices.
    pub fn planes(&self, control: &[Vector3<f64>]) -> Vec<TangentPlane> {
        self.some_planes(0..self.points.len(), control)
    }

    /// The surface at some of the points, by their numbers.
    ///
    /// # Panics
    /// As [`planes`](Self::planes), and when there are no such points.
    pub fn some_planes(&self, points: Range<usize>, control: &[Vector3<f64>]) -> Vec<TangentPlane> {
        match &self.kept {
            Kept::Rows(rows) => rows.apply_some(points, control),
            Kept::Surface(surface) => surface.planes(&self.points[points], control),
        }
    }

    /// How the surface changes with the two barycentric coordinates at some of the points, by their numbers, m: the
    /// derivatives of [`some_planes`](Self::some_planes) alone.
    ///
    /// # Panics
    /// As [`some_planes`](Self::some_planes).
    pub fn some_derivatives(
        &self,
        points: Range<usize>,
        control: &[Vector3<f64>],
    ) -> Vec<[Vector3<f64>; 2]> {
        match &self.kept {
            Kept::Rows(rows) => {
                let of = |rows: &SparseRows| rows.apply_some(points.clone(), control);
                let [u, v] = rows.first.each_ref().map(of);
                u.into_iter().zip(v).map(|(u, v)| [u, v]).collect()
            }
            Kept::Surface(surface) => surface.derivatives(&self.points[points], control),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceId, PerVertex, TriMesh};

    /// A tetrahedron with places all over it, with and without rows.
    #[test]
    fn few_and_many_points_lie_at_the_same_places() {
        let faces = vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
        let mesh = TriMesh::new(4, faces).expect("a tetrahedron");
        let control = [[1.0, 0.2, 0.0], [0.0, 1.0, 0.1], [0.3, 0.0, 1.0], [1.0; 3]];
        let control = control.map(Vector3::from);
        let place = |i: u32| {
            let [u, v] = [f64::from(i % 7) / 14.0, f64::from(i % 5) / 10.0];
            MaterialPoint {
                face: FaceId(i % 4),
                barycentric: [1.0 - u - v, u, v],
            }
        };
        let points: Vec<_> = (0..70).map(place).collect();
        let of = |most: usize| {
            let surface = LoopSurface::new(&mesh, &PerVertex::filled(4, false));
            let on = (surface, points.clone());
            LimitPoints::with_rows_up_to(most, on, &mut || true).expect("nothing ends it")
        };
        let [rows, none] = [70, 69].map(of);
        assert!(matches!(none.kept, Kept::Surface(_)));
        assert!(rows.planes(&control) == none.planes(&control));
        for points in [&rows, &none] {
            assert!(points.some_planes(20..50, &control) == rows.planes(&control)[20..50]);
        }
        let first = rows
            .planes(&control)
            .iter()
            .map(|plane| plane.first)
            .collect::<Vec<_>>();
        assert!(
            [&rows, &none]
                .iter()
                .all(|points| points.some_derivatives(20..50, &control) == first[20..50])
        );
        let surface = LoopSurface::new(&mesh, &PerVertex::filled(4, false));
        assert!(LimitPoints::new(surface, points, &mut || false).is_none());
    }
}
