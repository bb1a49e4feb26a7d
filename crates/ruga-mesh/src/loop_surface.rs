//! The Loop limit surface at arbitrary material points of its control mesh.

use std::sync::OnceLock;

use nalgebra::{Dim, Matrix, Matrix6xX, RawStorage, U6, Vector3};

use crate::face_place::FacePlace;
use crate::irregular_sector::IrregularSector;
use crate::vertex_fan::{VertexFan, VertexKind, regular_controls, sector_controls};
use crate::{
    FaceId, Id, MaterialPoint, PerFace, PerVertex, SparseRows, Subdivision, SurfaceJet, TriMesh,
    subdivide,
};

/// The limit surface of Loop subdivision over a control mesh, ready to be evaluated anywhere.
///
/// The surface is that of [`subdivide`] and [`crate::limit_rows`], with their border and corner
/// rules. It is linear in the control points, so it is asked once for rows, and these give every
/// pose.
///
/// A face is regular when each of its vertices has six faces, or lies on a border with three and
/// is no corner. There the surface is a quartic box spline in closed form (Stam, *Evaluation of
/// Loop subdivision surfaces*, 1998). Other faces are split in four once, after which each quarter
/// has at most one irregular vertex, and then towards that vertex by precomputed powers of the
/// subdivision matrix of its kind.
///
/// # Validity
/// Exact up to rounding, to within 2^-33 of a face of an irregular vertex. Nearer, positions run
/// straight to the vertex's limit, and derivatives are those at that distance. At an irregular
/// vertex itself:
/// - the derivatives by barycentric coordinates tend to zero or infinity; only their plane means
///   something, and `normal` agrees with `limit_rows` to 1e-6 up to eight faces, 1e-2 at twelve;
/// - the curvature of a Loop surface is bounded for four and five faces, but not for three or more
///   than six: ask for it a little away from such a vertex;
/// - corners have only a one-sided normal that may differ from face to face.
///
/// At border vertices of six or more faces the scheme has no continuous tangent plane.
#[derive(Clone, Debug)]
pub struct LoopSurface {
    mesh: TriMesh,
    corners: PerVertex<bool>,
    split: Subdivision,
    kinds: Vec<(VertexKind, Vec<IrregularSector>)>,
    /// Filled when a face is first asked for, since most callers look at a part of the mesh.
    patches: PerFace<OnceLock<FacePatch>>,
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
    /// Derivatives by `uu`, `uv` and `vv`; rows sum to zero.
    pub second: [SparseRows; 3],
}

impl LimitPointRows {
    /// The surface at every point, for one set of control points (m).
    pub fn apply(&self, control: &[Vector3<f64>]) -> Vec<SurfaceJet> {
        let position = self.position.apply(control);
        let first = self.first.each_ref().map(|rows| rows.apply(control));
        let second = self.second.each_ref().map(|rows| rows.apply(control));
        (0..position.len())
            .map(|i| SurfaceJet {
                position: position[i],
                first: first.each_ref().map(|values| values[i]),
                second: second.each_ref().map(|values| values[i]),
            })
            .collect()
    }

    fn push(&mut self, vertices: &[u32], weights: &Matrix6xX<f64>, terms: &mut Vec<(u32, f64)>) {
        let [u, v] = &mut self.first;
        let [uu, uv, vv] = &mut self.second;
        for (i, rows) in [&mut self.position, u, v, uu, uv, vv]
            .into_iter()
            .enumerate()
        {
            terms.clear();
            terms.extend(vertices.iter().zip(&weights.row(i)).map(|(&c, &w)| (c, w)));
            rows.push_row(terms);
        }
    }
}

impl LoopSurface {
    /// Prepares the surface of a control mesh; `corners` marks the vertices that stay.
    pub fn new(mesh: &TriMesh, corners: &PerVertex<bool>) -> Self {
        let mut kinds: Vec<VertexKind> = mesh
            .faces()
            .ids()
            .flat_map(|face| (0..3).map(move |corner| (face, corner)))
            .map(|(face, corner)| {
                VertexKind::of(mesh, corners, &VertexFan::around(mesh, face, corner))
            })
            .filter(|kind| !kind.is_regular())
            .collect();
        kinds.sort_unstable();
        kinds.dedup();
        Self {
            mesh: mesh.clone(),
            corners: corners.clone(),
            split: subdivide(mesh, 1, corners),
            kinds: kinds
                .into_iter()
                .map(|kind| (kind, IrregularSector::all_of(kind)))
                .collect(),
            patches: PerFace::filled(mesh.face_count(), OnceLock::new()),
        }
    }

    /// Rows for the surface at `points`, in their order.
    ///
    /// Barycentric coordinates sum to one; a place outside of its face continues the face's
    /// polynomial.
    pub fn rows(&self, points: &[MaterialPoint]) -> LimitPointRows {
        let mut rows = LimitPointRows::default();
        let mut terms = Vec::new();
        for point in points {
            let (vertices, weights) = self.weights(point);
            rows.push(vertices, &weights, &mut terms);
        }
        rows
    }

    fn weights(&self, point: &MaterialPoint) -> (&[u32], Matrix6xX<f64>) {
        let place = FacePlace::new(point.barycentric);
        let patch = self.patches[point.face].get_or_init(|| self.patch(point.face));
        match patch {
            FacePatch::Regular(controls) => (&controls.vertices, controls.pull(&place.basis())),
            FacePatch::Split(children) => {
                let index = place.child();
                let child = &children[index];
                let place = place.in_child(index);
                let weights = match child.sector {
                    None => child.controls.pull(&place.basis()),
                    Some((kind, sector)) => {
                        let sector = &self.kinds[kind].1[sector];
                        child
                            .controls
                            .pull(&sector.weights(place.starting_at(index)))
                    }
                };
                (&child.controls.vertices, weights)
            }
        }
    }

    fn patch(&self, face: FaceId) -> FacePatch {
        match regular_controls(&self.mesh, &self.corners, face) {
            Some(rows) => FacePatch::Regular(Controls::new(&rows)),
            None => FacePatch::Split(Box::new(
                [0, 1, 2, 3].map(|child| self.quarter(face, child)),
            )),
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
                controls: Controls::new(&rows.after(fine_from_coarse)),
                sector: None,
            };
        }
        let fan = VertexFan::around(mesh, face, child);
        let kind = VertexKind::of(mesh, corners, &fan);
        let index = self.kinds.binary_search_by_key(&kind, |entry| entry.0);
        let index = index.expect("every kind of vertex is known from the coarse mesh");
        let mut rows = SparseRows::default();
        for vertex in sector_controls(mesh, face, child).expect("a quarter of a face") {
            let mut terms: Vec<(u32, f64)> = fine_from_coarse.row(vertex.index()).collect();
            rows.push_row(&mut terms);
        }
        Quarter {
            controls: Controls::new(&rows),
            sector: Some((index, fan.sector)),
        }
    }
}

#[derive(Clone, Debug)]
enum FacePatch {
    Regular(Controls),
    Split(Box<[Quarter; 4]>),
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
    /// Ascending.
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
        let mut local = SparseRows::default();
        for row in all() {
            let slot = |column: u32| vertices.partition_point(|&v| v < column) as u32;
            let mut terms: Vec<(u32, f64)> = row.map(|(column, w)| (slot(column), w)).collect();
            local.push_row(&mut terms);
        }
        Self {
            vertices,
            rows: local,
        }
    }

    /// Weights of the vertices from weights of the controls.
    fn pull<C: Dim, S: RawStorage<f64, U6, C>>(
        &self,
        weights: &Matrix<f64, U6, C, S>,
    ) -> Matrix6xX<f64> {
        let mut result = Matrix6xX::zeros(self.vertices.len());
        for (control, from) in weights.column_iter().enumerate() {
            for (slot, weight) in self.rows.row(control) {
                let mut to = result.column_mut(slot as usize);
                to.axpy(weight, &from, 1.0);
            }
        }
        result
    }
}
