//! Points at which an element's integrals are evaluated, and their weights.

use nalgebra::Vector3;

use crate::lattice::{Filling, VOID_STIFFNESS};
use crate::moments::Moments;
use crate::shape::ShapeValues;
use crate::{ElementId, Lattice};

/// A place in an element, and the volume that it stands for (m³).
#[derive(Clone, Debug)]
pub(crate) struct QuadraturePoint {
    pub(crate) volume: f64,
    pub(crate) shape: ShapeValues,
}

/// Quantity that is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Integrand {
    Mass,
    /// Elastic energy, in which the void takes part too.
    Stiffness,
}

/// The points of all elements; elements whose points are the same share a table.
#[derive(Clone, Debug)]
pub(crate) struct Quadrature {
    tables: Vec<Vec<QuadraturePoint>>,
    table_of: Vec<u32>,
}

/// Share of its cell from which on an element counts as full.
const FULL: f64 = 1.0 - 1e-9;

/// Share of its cell up to which an element counts as empty: rounding decides where its piece is.
const EMPTY: f64 = 1e-12;

impl Quadrature {
    pub(crate) fn new(lattice: &Lattice, integrand: Integrand) -> Self {
        let cell_volume = lattice.cell_size().product();
        let mut this = Self {
            // Full elements all have the same points, so that one table serves them, and whatever
            // is integrated over it.
            tables: vec![cell_points(lattice, cell_volume)],
            table_of: Vec::with_capacity(lattice.element_count()),
        };
        for element in lattice.elements() {
            let moments = lattice.moments(element);
            let is_whole = lattice.filling() == Filling::Whole;
            if is_whole || moments.volume >= FULL * cell_volume {
                this.table_of.push(0);
                continue;
            }
            let mut points = Vec::new();
            if moments.volume > EMPTY * cell_volume {
                points = piece_points(lattice, moments);
            }
            if integrand == Integrand::Stiffness {
                // Spread over the whole cell: where exactly the void is does not matter to a
                // stiffness that is there to reach every node.
                let void = (cell_volume - moments.volume) * VOID_STIFFNESS;
                points.extend(cell_points(lattice, void));
            }
            this.table_of.push(this.tables.len() as u32);
            this.tables.push(points);
        }
        this
    }

    pub(crate) fn tables(&self) -> &[Vec<QuadraturePoint>] {
        &self.tables
    }

    /// Index of an element's table.
    pub(crate) fn table_of(&self, element: usize) -> usize {
        self.table_of[element] as usize
    }

    pub(crate) fn points(&self, element: ElementId) -> &[QuadraturePoint] {
        &self.tables[self.table_of(element.0 as usize)]
    }
}

/// The Gauss points of the whole cell.
fn cell_points(lattice: &Lattice, volume: f64) -> Vec<QuadraturePoint> {
    let size = lattice.cell_size();
    let points = lattice.shape().gauss_points();
    points
        .map(|(local, share)| QuadraturePoint {
            volume: volume * share,
            shape: lattice.shape().evaluate(&local, &size),
        })
        .collect()
}

/// The Gauss points of the box with the same volume, centroid and covariance as a piece.
///
/// All weights are positive and every quadratic polynomial is integrated exactly. Fitting the
/// weights of the cell's points to more moments instead makes some of them negative, and with them
/// the energy unbounded from below. Of a full cell the box is the cell.
fn piece_points(lattice: &Lattice, moments: &Moments) -> Vec<QuadraturePoint> {
    let size = lattice.cell_size();
    let spread = moments.spread().symmetric_eigen();
    // The variance of a box of side a is a^2 / 12. Rounding may make that of a thin piece negative.
    let sides = spread.eigenvalues.map(|v| (12.0 * v.max(0.0)).sqrt());
    let points = lattice.shape().gauss_points().map(|(unit, share)| {
        // The eigenvectors may be mirrored and in any order: the points are symmetric, and sides go
        // with their axes.
        let offset = (unit - Vector3::repeat(0.5)).component_mul(&sides);
        let point = moments.centre() + spread.eigenvectors * offset;
        // A piece with its volume at two ends has a box longer than the cell. The polynomials
        // simply go on there.
        let local = point.component_div(&size);
        QuadraturePoint {
            volume: moments.volume * share,
            shape: lattice.shape().evaluate(&local, &size),
        }
    });
    points.collect()
}
