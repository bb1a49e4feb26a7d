//! The Loop limit surface over a face at an irregular vertex.
//!
//! Stam 1998: subdividing such a face leaves three regular faces and a smaller one of its own kind,
//! so a point is reached by powers of one small matrix and a box spline. His eigenvectors are not
//! needed; some powers are kept instead.

use std::f64::consts::{PI, TAU};

use nalgebra::{Const, DMatrix, Dyn, Matrix6xX, OMatrix, RowDVector};

use crate::box_spline::CONTROLS;
use crate::face_place::FacePlace;
use crate::vertex_fan::{VertexKind, fan_mesh, regular_controls, sector_controls};
use crate::{FaceId, Id, PerVertex, SparseRows, Subdivision, VertexId, limit_rows, subdivide};

/// The most times that a face shrinks by two towards its irregular vertex.
///
/// Further in, derivatives are those at this depth on the same ray, and positions run straight to
/// the vertex.
pub(crate) const MAX_DEPTH: usize = 32;

/// Error of the curvature by rounding at the last depth, in units of the inverse of an edge.
const CURVATURE_NOISE: f64 = 1e-4;

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
    children: [OMatrix<f64, Const<CONTROLS>, Dyn>; 3],
}

impl IrregularSector {
    /// The sectors from which a fan of this kind can be seen; a closed one looks the same from all.
    pub(crate) fn all_of(kind: VertexKind) -> Vec<Self> {
        let fan = fan_mesh(kind);
        let mut corners = PerVertex::filled(fan.vertex_count(), false);
        // A vertex of several fans follows the rule of a corner, so one mark does for both.
        corners[VertexId(0)] = kind.fixed;
        // Two levels: the first makes the neighbours new vertices, as they are in every deeper one.
        let coarse = subdivide(&fan, 1, &corners);
        let fine = subdivide(&coarse.mesh, 1, &coarse.corners);
        let sectors = if kind.closed { 1 } else { kind.faces };
        let depth = depth_of(kind);
        (0..sectors)
            .map(|sector| Self::new(&coarse, &fine, sector, depth))
            .collect()
    }

    /// One sector of a fan that was subdivided once, and once more.
    fn new(coarse: &Subdivision, fine: &Subdivision, sector: usize, depth: usize) -> Self {
        let face = FaceId::from_index(4 * sector);
        let child = |i: usize| FaceId::from_index(4 * face.index() + i);
        let controls = sector_controls(&coarse.mesh, face, 0).expect("a split fan");
        let finer = sector_controls(&fine.mesh, child(0), 0).expect("a split fan");
        let subdivision = dense(&fine.fine_from_coarse.select(&finer), &controls);
        let limit = limit_rows(&coarse.mesh, &coarse.corners).position;
        let limit = dense(&limit.select(&[VertexId(0)]), &controls);

        let count = controls.len();
        let constant = DMatrix::from_fn(count, count, |_, column| limit[column]);
        // The limit mask is the left eigenvector of eigenvalue one, and ones are the right one: the
        // powers of this difference are those of the whole less the same constant.
        let shrink = subdivision - &constant;
        let mut powers = vec![DMatrix::identity(count, count) - constant];
        for last in 0..depth {
            powers.push(&shrink * &powers[last]);
        }
        Self {
            limit: limit.row(0).into(),
            powers,
            children: [1, 2, 3].map(|i| {
                let rows = regular_controls(&fine.mesh, &fine.corners, child(i));
                let rows = rows.expect("new vertices of a subdivision are regular");
                let rows = dense(&rows.after(&fine.fine_from_coarse), &controls);
                rows.fixed_rows::<CONTROLS>(0).into()
            }),
        }
    }

    /// Weights of the controls for the value and derivatives at a place; the vertex is corner 0.
    pub(crate) fn weights(&self, mut place: FacePlace) -> Matrix6xX<f64> {
        let mut depth = 0;
        while place.distance_from_first() < 0.5 && depth + 1 < self.powers.len() {
            place = place.in_child(0);
            depth += 1;
        }
        let straight = place.push_out_of_first();
        let child = place.child();
        let basis = place.in_child(child).basis();
        let mut weights = basis * &self.children[child - 1] * &self.powers[depth];
        let mut position = weights.row_mut(0);
        // Only values: a constant such as the limit position has no derivatives.
        position *= straight;
        position += &self.limit;
        weights
    }
}

/// How deep the powers of a kind may go.
///
/// With `a >= b` the eigenvalues of the two tangents, rounding of the longer tangent enters the
/// curvature as `1e-16 (a / b^2)^depth`: across it the surface has shrunk by `b` twice.
fn depth_of(kind: VertexKind) -> usize {
    let count = kind.faces as f64;
    // Around a closed fan the eigenvectors are Fourier modes. Along a border they are those of the
    // cubic B-spline, with 1/2 and 1/4, and across it a sine over the fan.
    let around = |angle: f64| 0.375 + 0.25 * angle.cos();
    let [a, b] = match (kind.fixed, kind.closed, kind.faces) {
        (false, true, _) => [around(TAU / count); 2],
        (true, true, _) => [0.625, around(TAU / count)],
        (false, false, 1) => [0.5, 0.25],
        (false, false, _) => [0.5, around(PI / count)],
        (true, false, _) => [0.5; 2],
    };
    let growth = a.max(b) / a.min(b).powi(2);
    let depth = (CURVATURE_NOISE / f64::EPSILON).ln() / growth.ln();
    (depth as usize).min(MAX_DEPTH)
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
