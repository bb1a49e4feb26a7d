//! The Loop limit surface at arbitrary material points of its control mesh.

use std::ops::Range;
use std::sync::OnceLock;

use nalgebra::{Dim, Matrix, RawStorage, U6, Vector3};
use rayon::prelude::*;

use crate::face_place::FacePlace;
use crate::irregular_sector::IrregularSector;
use crate::vertex_fan::{VertexFan, VertexKind, regular_controls, sector_controls};
use crate::{
    FaceId, Id, MaterialPoint, PerFace, PerVertex, SparseRows, Subdivision, SurfaceJet,
    TangentPlane, TriMesh, VertexId, subdivide,
};

/// Points that a thread makes rows for at a time: enough to be worth handing over, few enough to share them out.
const POINTS_AT_ONCE: usize = 512;

/// Points of a face at which what was prepared for it takes little memory beside them.
const WORTH_KEEPING: usize = 64;

/// Parts of many points, each on one face, that are evaluated before what was found is put in its place.
const PARTS_AT_A_TIME: usize = 512;

/// The limit surface of Loop subdivision over a control mesh, ready to be evaluated anywhere.
///
/// The surface is that of [`subdivide`] and [`crate::limit_rows`], with their border and corner
/// rules. It is linear in the control points: [`rows`](Self::rows) are asked for once and
/// give every pose, [`planes`](Self::planes) give one and keep little.
///
/// A face is regular when each of its vertices has six faces, or lies on a border with three and
/// is no corner. There the surface is a quartic box spline in closed form (Stam, *Evaluation of
/// Loop subdivision surfaces*, 1998). Other faces are split in four once, after which each quarter
/// has at most one irregular vertex, and then towards that vertex by precomputed powers of the
/// subdivision matrix of its kind.
///
/// # Validity
/// Exact up to rounding, except very close to an irregular vertex. Within 2^-33 of a face of it
/// (2^-12 for the worst kinds, such as a border vertex of one face) positions run straight to the
/// vertex's limit and derivatives are those at that distance, lest the curvature drown in rounding.
///
/// At an irregular vertex the derivatives by barycentric coordinates tend to zero or infinity, so
/// only their plane and the shape operator mean something there:
/// - The normal agrees with that of [`crate::limit_rows`] to 1e-5 up to eight faces, 1e-3 at
///   twelve; on borders to 1e-4 up to four faces, 1e-2 at five. From six faces on, a border vertex
///   has no tangent plane under these rules.
/// - The curvature is bounded at vertices of four to six faces, and of two and three on borders,
///   where it need not be that of the surface which the control mesh samples: on a finely sampled
///   sphere it is 30 % off next to a vertex of five faces. At others it grows towards the vertex
///   without bound, so ask for it some way off.
/// - A corner has at most a one-sided normal, which may differ from face to face.
#[derive(Clone, Debug)]
pub struct LoopSurface {
    mesh: TriMesh,
    corners: PerVertex<bool>,
    split: Subdivision,
    kinds: Vec<(VertexKind, Vec<IrregularSector>)>,
    /// Filled when a face is first asked for, since most callers look at a part of the mesh.
    patches: PerFace<OnceLock<FacePatch>>,
    /// Points of a face from which on what was prepared for it is kept.
    worth_keeping: usize,
}

/// Rows that give a limit surface at material points from its control points.
///
/// The parameters are `u, v`, the barycentric coordinates of corners 1 and 2 of the point's face.
#[derive(Clone, Debug, Default)]
pub struct LimitPointRows {
    /// Positions; rows sum to one.
    pub position: SparseRows,
    /// Derivatives by `u` and `v`; rows sum to zero, first cross second points outwards.
    pub first: [SparseRows; 2],
}

impl LimitPointRows {
    /// Gives back the memory that was reserved for further points.
    pub fn shrink_to_fit(&mut self) {
        self.position.shrink_to_fit();
        self.first.iter_mut().for_each(SparseRows::shrink_to_fit);
    }

    /// The surface at every point, for one set of control points (m).
    ///
    /// # Panics
    /// When there are fewer control points than the surface has vertices.
    pub fn apply(&self, control: &[Vector3<f64>]) -> Vec<TangentPlane> {
        self.apply_some(0..self.position.row_count(), control)
    }

    /// The surface at some of the `points`.
    pub(crate) fn apply_some(
        &self,
        points: Range<usize>,
        control: &[Vector3<f64>],
    ) -> Vec<TangentPlane> {
        let position = self.position.apply_some(points.clone(), control);
        let first = self.first.each_ref();
        let [u, v] = first.map(|rows| rows.apply_some(points.clone(), control));
        let planes = position.into_iter().zip(u).zip(v);
        planes
            .map(|((position, u), v)| TangentPlane {
                position,
                first: [u, v],
            })
            .collect()
    }
}

impl LoopSurface {
    /// Prepares the surface of a control mesh; `corners` marks the vertices that stay.
    ///
    /// # Panics
    /// As [`subdivide`] for one level.
    pub fn new(mesh: &TriMesh, corners: &PerVertex<bool>) -> Self {
        // First, because it checks the length of `corners`.
        let split = subdivide(mesh, 1, corners);
        // Matrices are made per kind of vertex, of which a mesh has few, and found by bisection.
        let mut kinds: Vec<VertexKind> = VertexFan::all(mesh)
            .iter()
            .map(|fan| VertexKind::of(mesh, corners, fan))
            .filter(|kind| !kind.is_regular())
            .collect();
        kinds.sort_unstable();
        kinds.dedup();
        Self {
            mesh: mesh.clone(),
            corners: corners.clone(),
            split,
            kinds: kinds
                .into_iter()
                .map(|kind| (kind, IrregularSector::all_of(kind)))
                .collect(),
            patches: PerFace::filled(mesh.face_count(), OnceLock::new()),
            worth_keeping: WORTH_KEEPING,
        }
    }

    /// Keeps what is prepared for a face, 2 kB, however few points it has: for surfaces that are asked again.
    pub fn keep_patches(&mut self) {
        self.worth_keeping = 0;
    }

    /// Number of faces of the control mesh.
    pub(crate) fn face_count(&self) -> usize {
        self.mesh.face_count()
    }

    /// Rows for the surface at `points`, in their order.
    ///
    /// Barycentric coordinates sum to one; a place outside of its face continues the face's
    /// polynomial.
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have.
    pub fn rows(&self, points: &[MaterialPoint]) -> LimitPointRows {
        let mut rows = LimitPointRows::default();
        self.add_rows(points, &mut rows);
        rows
    }

    /// Appends the rows of further points to those of others.
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have.
    pub fn add_rows(&self, points: &[MaterialPoint], rows: &mut LimitPointRows) {
        let [u, v] = &mut rows.first;
        self.push_weights(points, [&mut rows.position, u, v]);
    }

    /// The surface with its second derivatives at `points`, for one set of control points (m).
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have, or there are fewer control points than
    /// vertices.
    pub fn jets(&self, points: &[MaterialPoint], control: &[Vector3<f64>]) -> Vec<SurfaceJet> {
        let mut weights: Vec<[f64; 6]> = Vec::new();
        let jet = |point| {
            let vertices = self.weights(point, &mut weights);
            let mut sums = [Vector3::zeros(); 6];
            for (&vertex, weights) in vertices.iter().zip(&weights) {
                for (sum, &weight) in sums.iter_mut().zip(weights) {
                    *sum += control[vertex as usize] * weight;
                }
            }
            let [position, u, v, uu, uv, vv] = sums;
            SurfaceJet {
                position,
                first: [u, v],
                second: [uu, uv, vv],
            }
        };
        points.iter().map(jet).collect()
    }

    /// The surface at many `points`, for one set of control points (m), by all threads: the same bits as from
    /// [`rows`](Self::rows), which take some 500 bytes a point. Of a face with many of them is kept what was prepared
    /// for it.
    ///
    /// # Panics
    /// As [`jets`](Self::jets).
    pub fn planes(&self, points: &[MaterialPoint], control: &[Vector3<f64>]) -> Vec<TangentPlane> {
        self.at_each(points, |vertices, weights: &[[f64; 3]]| {
            let mut sums = [Vector3::zeros(); 3];
            for (&vertex, weights) in vertices.iter().zip(weights) {
                for (sum, &weight) in sums.iter_mut().zip(weights) {
                    *sum += control[vertex as usize] * weight;
                }
            }
            let [position, u, v] = sums;
            TangentPlane {
                position,
                first: [u, v],
            }
        })
    }

    /// The derivatives of [`planes`](Self::planes) alone.
    ///
    /// # Panics
    /// As [`jets`](Self::jets).
    pub(crate) fn derivatives(
        &self,
        points: &[MaterialPoint],
        control: &[Vector3<f64>],
    ) -> Vec<[Vector3<f64>; 2]> {
        self.at_each(points, |vertices, weights: &[[f64; 3]]| {
            let mut sums = [Vector3::zeros(); 2];
            for (&vertex, [_, weights @ ..]) in vertices.iter().zip(weights) {
                for (sum, &weight) in sums.iter_mut().zip(weights) {
                    *sum += control[vertex as usize] * weight;
                }
            }
            sums
        })
    }

    /// The positions of [`planes`](Self::planes) alone, for several sets of control points (m) at once.
    ///
    /// # Panics
    /// As [`jets`](Self::jets).
    pub fn positions<const K: usize>(
        &self,
        points: &[MaterialPoint],
        controls: [&[Vector3<f64>]; K],
    ) -> [Vec<Vector3<f64>>; K] {
        let found = self.at_each(points, |vertices, weights: &[[f64; 1]]| {
            controls.map(|control| {
                let terms = vertices.iter().zip(weights);
                terms
                    .map(|(&v, [weight])| control[v as usize] * *weight)
                    .sum()
            })
        });
        std::array::from_fn(|k| found.iter().map(|values: &[_; K]| values[k]).collect())
    }

    /// Evaluates `of` at many points, by all threads: it is given the vertices that a point depends on, and the first
    /// `N` of their weights.
    fn at_each<const N: usize, R: Copy + Send>(
        &self,
        points: &[MaterialPoint],
        of: impl Fn(&[u32], &[[f64; N]]) -> R + Sync,
    ) -> Vec<R> {
        // Face by face: what is prepared for a face serves all of its points.
        let mut by_face: Vec<u32> = (0..points.len() as u32).collect();
        by_face.sort_unstable_by_key(|&i| (points[i as usize].face, i));
        let of_faces =
            by_face.chunk_by(|&i, &j| points[i as usize].face == points[j as usize].face);
        let parts: Vec<&[u32]> = of_faces
            .flat_map(|ranks| ranks.chunks(POINTS_AT_ONCE))
            .collect();
        let of_part = |ranks: &&[u32]| {
            let face = points[ranks[0] as usize].face;
            let passing;
            let patch = match ranks.len() < self.worth_keeping {
                true => {
                    passing = self.patch(face);
                    &passing
                }
                false => self.patches[face].get_or_init(|| self.patch(face)),
            };
            let mut weights: Vec<[f64; N]> = Vec::new();
            let result = |&i: &u32| {
                let vertices = self.weights_in(patch, &points[i as usize], &mut weights);
                of(vertices, &weights)
            };
            ranks.iter().map(result).collect::<Vec<_>>()
        };
        let mut results: Vec<R> = Vec::new();
        for parts in parts.chunks(PARTS_AT_A_TIME) {
            let found: Vec<_> = parts.par_iter().map(of_part).collect();
            let found = parts.iter().copied().flatten().zip(found.iter().flatten());
            for (&i, found) in found {
                if results.is_empty() {
                    // Every point is in a part, so that all of these are replaced.
                    results.resize(points.len(), *found);
                }
                results[i as usize] = *found;
            }
        }
        results
    }

    /// Forgets what was prepared for the faces asked for so far, 2 kB each.
    pub fn forget(&mut self) {
        self.patches = PerFace::filled(self.mesh.face_count(), OnceLock::new());
    }

    /// The positions of [`rows`](Self::rows) alone, a third of the result.
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have.
    pub fn position_rows(&self, points: &[MaterialPoint]) -> SparseRows {
        let mut rows = SparseRows::default();
        self.add_position_rows(points, &mut rows);
        rows
    }

    /// Appends the positions' rows of further points to those of others.
    ///
    /// # Panics
    /// When a point lies on a face that the mesh does not have.
    pub fn add_position_rows(&self, points: &[MaterialPoint], rows: &mut SparseRows) {
        self.push_weights(points, [rows]);
    }

    /// Appends to each of `rows` its part of the weights at `points`, by all threads: values come first, then
    /// derivatives.
    fn push_weights<const N: usize>(&self, points: &[MaterialPoint], rows: [&mut SparseRows; N]) {
        if points.len() <= POINTS_AT_ONCE {
            return self.push_weights_of(points, rows);
        }
        let of_some = |points: &[MaterialPoint]| {
            let mut rows: [SparseRows; N] = std::array::from_fn(|_| SparseRows::default());
            self.push_weights_of(points, rows.each_mut());
            rows
        };
        let parts: Vec<_> = points.par_chunks(POINTS_AT_ONCE).map(of_some).collect();
        for (i, rows) in rows.into_iter().enumerate() {
            rows.append(parts.iter().map(|part| &part[i]));
        }
    }

    fn push_weights_of<const N: usize>(
        &self,
        points: &[MaterialPoint],
        mut rows: [&mut SparseRows; N],
    ) {
        let mut weights = Vec::new();
        for point in points {
            let vertices = self.weights(point, &mut weights);
            for (i, rows) in rows.iter_mut().enumerate() {
                rows.push_ascending(vertices, weights.iter().map(|weight: &[f64; N]| weight[i]));
            }
        }
    }

    /// The vertices that a place depends on, and the first `N` of their weights.
    fn weights<const N: usize>(
        &self,
        point: &MaterialPoint,
        weights: &mut Vec<[f64; N]>,
    ) -> &[u32] {
        let patch = self.patches[point.face].get_or_init(|| self.patch(point.face));
        self.weights_in(patch, point, weights)
    }

    fn weights_in<'p, const N: usize>(
        &self,
        patch: &'p FacePatch,
        point: &MaterialPoint,
        weights: &mut Vec<[f64; N]>,
    ) -> &'p [u32] {
        let place = FacePlace::new(point.barycentric);
        match patch {
            FacePatch::Regular(controls) => controls.pull(&place.basis(), weights),
            FacePatch::Split(quarters) => {
                let index = place.child();
                let child = quarters[index].get_or_init(|| self.quarter(point.face, index));
                let place = place.in_child(index);
                match child.sector {
                    None => child.controls.pull(&place.basis(), weights),
                    Some((kind, sector)) => {
                        let sector = &self.kinds[kind].1[sector];
                        let of_controls = sector.weights(place.starting_at(index));
                        child.controls.pull(&of_controls, weights)
                    }
                }
            }
        }
    }

    fn patch(&self, face: FaceId) -> FacePatch {
        match regular_controls(&self.mesh, &self.corners, face) {
            Some(rows) => FacePatch::Regular(Controls::new(&rows)),
            None => FacePatch::Split(Box::default()),
        }
    }

    /// A quarter of a face; its one vertex of the coarse mesh, if any, is at corner `child`.
    fn quarter(&self, face: FaceId, child: usize) -> Quarter {
        let Subdivision {
            mesh,
            corners,
            fine_from_coarse,
            ..
        } = &self.split;
        let face = FaceId::from_index(4 * face.index() + child);
        if let Some(rows) = regular_controls(mesh, corners, face) {
            return Quarter {
                controls: Controls::new(&rows).after(fine_from_coarse),
                sector: None,
            };
        }
        let fan = VertexFan::around(mesh, face, child);
        let kind = VertexKind::of(mesh, corners, &fan);
        let index = self.kinds.binary_search_by_key(&kind, |entry| entry.0);
        let index = index.expect("every kind of vertex is known from the coarse mesh");
        let controls = sector_controls(mesh, face, child).expect("a quarter of a face");
        let rows = fine_from_coarse.select(&controls);
        Quarter {
            controls: Controls::new(&rows),
            sector: Some((index, fan.sector)),
        }
    }
}

#[derive(Clone, Debug)]
enum FacePatch {
    Regular(Controls),
    Split(Box<[OnceLock<Quarter>; 4]>),
}

#[derive(Clone, Debug)]
struct Quarter {
    controls: Controls,
    /// Kind and sector, where one of the vertices is irregular.
    sector: Option<(usize, usize)>,
}

/// The controls of a patch from vertices of the coarse mesh.
#[derive(Clone, Debug)]
struct Controls {
    /// Vertices of the coarse mesh, ascending.
    vertices: Vec<u32>,
    /// Columns are positions in `vertices`.
    rows: SparseRows,
}

impl Controls {
    fn new(rows: &SparseRows) -> Self {
        let all = || (0..rows.row_count()).map(|i| rows.row(i));
        let mut vertices: Vec<u32> = all().flatten().map(|term| term.0).collect();
        vertices.sort_unstable();
        vertices.dedup();
        // Slots in place of vertices let `pull` add up in a small dense matrix.
        let slot = |column: u32| vertices.partition_point(|&v| v < column) as u32;
        let mut local = SparseRows::default();
        let mut terms = Vec::new();
        for row in all() {
            terms.clear();
            terms.extend(row.map(|(column, weight)| (slot(column), weight)));
            local.push_row(&mut terms);
        }
        Self {
            vertices,
            rows: local,
        }
    }

    /// The same controls from the vertices that those of their mesh are made of by `inner`.
    fn after(&self, inner: &SparseRows) -> Self {
        let vertices: Vec<VertexId> = self.vertices.iter().copied().map(VertexId).collect();
        // The product of whole maps would look at all of the mesh for a dozen rows.
        let inner = Self::new(&inner.select(&vertices));
        Self {
            rows: self.rows.after(&inner.rows),
            vertices: inner.vertices,
        }
    }

    /// The vertices, and the first `N` of their weights from those of the controls.
    fn pull<const N: usize, C: Dim, S: RawStorage<f64, U6, C>>(
        &self,
        of_controls: &Matrix<f64, U6, C, S>,
        weights: &mut Vec<[f64; N]>,
    ) -> &[u32] {
        weights.clear();
        weights.resize(self.vertices.len(), [0.0; N]);
        for (control, from) in of_controls.column_iter().enumerate() {
            for (slot, weight) in self.rows.row(control) {
                for (to, from) in weights[slot as usize].iter_mut().zip(&from) {
                    *to += weight * from;
                }
            }
        }
        &self.vertices
    }
}
