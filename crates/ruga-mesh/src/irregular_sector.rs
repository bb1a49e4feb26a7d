//! The Loop limit surface over a face at an irregular vertex.
//!
//! Stam 1998: subdividing such a face leaves three regular faces and a smaller one of its own kind,
//! so a point is reached by powers of one small matrix and a box spline. His eigenvectors are not
//! needed; powers up to [`MAX_DEPTH`] are kept instead.

use nalgebra::{DMatrix, Matrix6xX, OMatrix, RowDVector};

use crate::box_spline::CONTROLS;
use crate::face_place::FacePlace;
use crate::vertex_fan::{VertexKind, fan_mesh, regular_controls, sector_controls};
use crate::{FaceId, Id, PerVertex, SparseRows, VertexId, limit_rows, subdivide};

/// How many times a face shrinks by two towards its irregular vertex.
///
/// Further in, at under 2.3e-10 of a face, derivatives are those at this depth on the same ray, and
/// positions run straight to the vertex. More depth would lose the curvature in rounding at
/// vertices of four faces (`0.375^-32 * 1e-16` is 4e-3 of the inverse of an edge).
pub(crate) const MAX_DEPTH: usize = 32;

/// One sector of the fan around a vertex of a given kind.
///
/// The controls are those of [`sector_controls`].
#[derive(Clone, Debug)]
pub(crate) struct IrregularSector {
    /// The vertex's limit position from the controls.
    limit: RowDVector<f64>,
    /// Powers of the subdivision matrix without its eigenvalue one.
    ///
    /// With the limit position taken out, what is left shrinks to zero and so keeps its digits;
    /// in the plain powers the tangents would drown in the rounding of the positions.
    powers: Vec<DMatrix<f64>>,
    /// Box spline controls of the three regular children, numbered as subdivision does, less one.
    children: [OMatrix<f64, nalgebra::Const<CONTROLS>, nalgebra::Dyn>; 3],
}

impl IrregularSector {
    /// The sectors from which a fan of this kind can be seen; a closed one looks the same from all.
    pub(crate) fn all_of(kind: VertexKind) -> Vec<Self> {
        let fan = fan_mesh(kind);
        let mut corners = PerVertex::filled(fan.vertex_count(), false);
        corners[VertexId(0)] = kind.fixed;
        // Two levels: the first makes the neighbours new vertices, as they are in every deeper one.
        let coarse = subdivide(&fan, 1, &corners);
        let fine = subdivide(&coarse.mesh, 1, &coarse.corners);
        let limit = limit_rows(&coarse.mesh, &coarse.corners).position;
        let sectors = if kind.closed { 1 } else { kind.faces };
        (0..sectors)
            .map(|sector| {
                let face = FaceId::from_index(4 * sector);
                let controls = sector_controls(&coarse.mesh, face, 0).expect("a split fan");
                let child = |i: usize| FaceId::from_index(16 * sector + i);
                let own = sector_controls(&fine.mesh, child(0), 0).expect("a split fan");
                let own = select(&fine.fine_from_coarse, &own);
                let children = [1, 2, 3].map(|i| {
                    let rows = regular_controls(&fine.mesh, &fine.corners, child(i));
                    let rows = rows.expect("new vertices of a subdivision are regular");
                    dense(&rows.after(&fine.fine_from_coarse), &controls)
                });
                Self::new(
                    dense(&select(&limit, &[VertexId(0)]), &controls)
                        .row(0)
                        .into(),
                    &dense(&own, &controls),
                    children.map(|c| c.fixed_rows::<CONTROLS>(0).into()),
                )
            })
            .collect()
    }

    fn new(
        limit: RowDVector<f64>,
        subdivision: &DMatrix<f64>,
        children: [OMatrix<f64, nalgebra::Const<CONTROLS>, nalgebra::Dyn>; 3],
    ) -> Self {
        let count = limit.len();
        let constant = DMatrix::from_fn(count, count, |_, column| limit[column]);
        let shrink = subdivision - &constant;
        let mut powers = vec![DMatrix::identity(count, count) - constant];
        for depth in 0..MAX_DEPTH {
            powers.push(&shrink * &powers[depth]);
        }
        Self {
            limit,
            powers,
            children,
        }
    }

    /// Weights of the controls for the value and derivatives at a place; the vertex is corner 0.
    pub(crate) fn weights(&self, mut place: FacePlace) -> Matrix6xX<f64> {
        let mut depth = 0;
        while place.distance_from_first() < 0.5 && depth < MAX_DEPTH {
            place = place.in_child(0);
            depth += 1;
        }
        let straight = place.push_out_of_first();
        let child = place.child();
        let basis = place.in_child(child).basis();
        let mut weights = basis * &self.children[child - 1] * &self.powers[depth];
        let mut position = weights.row_mut(0);
        position *= straight;
        position += &self.limit;
        weights
    }
}

fn select(rows: &SparseRows, chosen: &[VertexId]) -> SparseRows {
    let mut selected = SparseRows::default();
    for vertex in chosen {
        let mut terms: Vec<(u32, f64)> = rows.row(vertex.index()).collect();
        selected.push_row(&mut terms);
    }
    selected
}

fn dense(rows: &SparseRows, columns: &[VertexId]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(rows.row_count(), columns.len());
    for row in 0..rows.row_count() {
        for (column, weight) in rows.row(row) {
            let at = columns.iter().position(|v| v.0 == column);
            matrix[(row, at.expect("the controls of a sector span it"))] += weight;
        }
    }
    matrix
}
