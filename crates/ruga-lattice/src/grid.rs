//! The regular grid of cells that the surface is cut along.

use nalgebra::Vector3;

/// Integer coordinates of a grid corner, or of the cell, face or edge that begins there.
pub(crate) type Index = [u32; 3];

/// Length by which the grid exceeds the surface's box, as a share of a cell.
///
/// It leaves room for moving the grid until no mesh vertex lies on a plane, and is small enough
/// that a box of whole cells still has their size to four digits.
const SLACK: f64 = 1e-4;

/// A plane between two layers of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Plane {
    pub(crate) axis: usize,
    pub(crate) index: u32,
}

/// A square between two cells: the plane's axis, and the corner where it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CellFace {
    pub(crate) at: Index,
    pub(crate) axis: usize,
}

/// A segment between two grid corners: its direction, and the corner where it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridEdge {
    pub(crate) at: Index,
    pub(crate) axis: usize,
}

/// Edges of the cells (m) that a lattice of `cells` cells along the longest side, at least one, has in a
/// box with these sides (m, finite, not all zero), to four digits.
pub fn cell_size(sides: &Vector3<f64>, cells: u32) -> Vector3<f64> {
    sides.component_div(&counts(sides, cells))
}

/// Whole numbers of cells along the sides of a box, as near to cubes as that allows.
fn counts(sides: &Vector3<f64>, cells: u32) -> Vector3<f64> {
    let cell = sides.max() / f64::from(cells);
    sides.map(|side| (side / cell).round().max(1.0))
}

#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) origin: Vector3<f64>,
    /// Edge lengths of a cell, m.
    pub(crate) size: Vector3<f64>,
    pub(crate) counts: Index,
}

impl Grid {
    /// A grid around the box from `low` to `high` with `cells` cells along its longest side.
    ///
    /// The other sides have a whole number of cells too, as near to cubes as that allows: a box
    /// is then filled exactly. Each `attempt` places the grid a little differently.
    pub(crate) fn around(
        low: &Vector3<f64>,
        high: &Vector3<f64>,
        cells: u32,
        attempt: u32,
    ) -> Self {
        let side = high - low;
        let count = counts(&side, cells);
        let slack = side.component_div(&count) * SLACK;
        // Multiples of irrational numbers, different ones per axis, never repeat a coincidence.
        let turns = Vector3::new(0.618_034, 0.414_214, 0.732_051) * f64::from(attempt + 1);
        // Between a quarter and three quarters of the slack, so that both ends of the box stay
        // clear of the outermost planes.
        let share = turns.map(|t| 0.25 + 0.5 * t.fract());
        Self {
            origin: low - slack.component_mul(&share),
            size: (side + slack).component_div(&count),
            counts: [0, 1, 2].map(|axis| count[axis] as u32),
        }
    }

    /// Coordinate of a plane along its axis, m.
    pub(crate) fn coordinate(&self, plane: Plane) -> f64 {
        self.origin[plane.axis] + self.size[plane.axis] * f64::from(plane.index)
    }

    pub(crate) fn corner(&self, at: Index) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| {
            let index = at[axis];
            self.coordinate(Plane { axis, index })
        })
    }

    /// The cell around a point, or the closest one to it.
    pub(crate) fn cell_at(&self, point: &Vector3<f64>) -> Index {
        let local = (point - self.origin).component_div(&self.size);
        // Casts saturate, so that a point far away finds an outer cell.
        [0, 1, 2].map(|axis| (local[axis].floor() as u32).min(self.counts[axis] - 1))
    }

    /// Coordinates of a point in a cell: 0 to 1 from corner to corner, beyond that outside.
    pub(crate) fn local(&self, cell: Index, point: &Vector3<f64>) -> Vector3<f64> {
        (point - self.corner(cell)).component_div(&self.size)
    }
}

/// One step down along an axis; `None` at the grid's border.
pub(crate) fn below(at: Index, axis: usize) -> Option<Index> {
    let mut lower = at;
    lower[axis] = at[axis].checked_sub(1)?;
    Some(lower)
}

/// The two axes across `axis`, so that the three are right-handed with `axis` last.
pub(crate) fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}
