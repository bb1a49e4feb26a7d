//! Closed bodies on the grid of a box's surface: a cushion, a slab and a bar.
//!
//! Each body is centred at the origin. A vertex is a grid point on the surface of the box, moved
//! to where the body's surface is by sums, products, quotients and square roots alone. Each side
//! of the box is a chart of its own in the texture, not mirrored, with the true lengths of the box.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendError};

use super::finish;

/// Edge of a cell of the grid, m; two triangles each.
const CELL: f64 = 0.005;

/// Radius of the edges of slab and bar, m: one cell, about what Loop subdivision rounds anyway.
const ROUNDING: f64 = CELL;

/// Room left in the texture around all and between charts: share of the texture, m.
const MARGIN: f64 = 0.02;
const GAP: f64 = 0.003;

/// A cushion, 12 x 12 x 4 cm: `(x/a)^4 + (y/a)^4 + (z/c)^2 = 1`, flat in the middle of both faces, its
/// rim round.
pub(super) fn pillow() -> Result<ArtistMesh, BlendError> {
    /// Share of a cell by which cells in the middle of the faces are smaller, and flattening of the
    /// box: both even out edges on the cushion, to between 2.9 and 6.4 mm.
    const GATHERED: f64 = 0.3;
    const FLATTENED: f64 = 0.9;
    let grid = Grid::new("Pillow", [24, 24, 8], 2);
    let half = grid.half();
    grid.mesh(|place| {
        let share = place.component_div(&half);
        let [x, y] = [share.x, share.y].map(|t| t * (1.0 - GATHERED + GATHERED * t * t));
        let z = FLATTENED * share.z;
        // Out along the ray through that point: `quartic s^4 + square s^2 = 1`.
        let (quartic, square) = (x * x * x * x + y * y * y * y, z * z);
        let squared = 2.0 / (square + (square * square + 4.0 * quartic).sqrt());
        Vector3::new(x, y, z).component_mul(&half) * squared.sqrt()
    })
}

/// A slab, 12 x 12 x 3 cm.
pub(super) fn slab() -> Result<ArtistMesh, BlendError> {
    Grid::new("Slab", [24, 24, 6], 2).rounded_box()
}

/// A bar, 20 x 4 x 4 cm, along x.
pub(super) fn bar() -> Result<ArtistMesh, BlendError> {
    Grid::new("Bar", [40, 8, 8], 1).rounded_box()
}

/// A box of cells and where its sides lie in the texture.
struct Grid {
    name: &'static str,
    /// Cells along x, y and z, even numbers.
    cells: [u32; 3],
    /// How many times its length along x the texture is wide.
    columns: u32,
}

/// A side of the box: `across` x `up` points out of it.
#[derive(Clone, Copy)]
struct Side {
    /// Axis that runs to the right in the texture.
    across: usize,
    /// Axis that runs upwards.
    up: usize,
    /// Axis along which the side faces.
    facing: usize,
    /// Whether it faces towards the axis' end; else `across` runs backwards.
    is_end: bool,
}

impl Side {
    /// Top and bottom, then the sides along x, then those along y: pairs of the same size.
    const ALL: [Self; 6] = [
        Self::new(0, 1, 2, true),
        Self::new(0, 1, 2, false),
        Self::new(0, 2, 1, false),
        Self::new(0, 2, 1, true),
        Self::new(1, 2, 0, true),
        Self::new(1, 2, 0, false),
    ];

    const fn new(across: usize, up: usize, facing: usize, is_end: bool) -> Self {
        Self {
            across,
            up,
            facing,
            is_end,
        }
    }

    /// Whether `across` runs against its axis, so that the chart is seen from outside. `x` x `z`
    /// points against `y`, the other two pairs along the third axis.
    fn is_reversed(self) -> bool {
        self.is_end == (self.facing == 1)
    }
}

impl Grid {
    fn new(name: &'static str, cells: [u32; 3], columns: u32) -> Self {
        Self {
            name,
            cells,
            columns,
        }
    }

    /// Half the box's lengths, m.
    fn half(&self) -> Vector3<f64> {
        Vector3::from(self.cells.map(f64::from)) * (0.5 * CELL)
    }

    /// The box with edges and corners rounded off.
    fn rounded_box(&self) -> Result<ArtistMesh, BlendError> {
        let core = self.half().map(|h| h - ROUNDING);
        self.mesh(|place| {
            let inside = place.zip_map(&core, |x, limit| x.clamp(-limit, limit));
            let way = place - inside;
            inside + way * (ROUNDING / way.norm())
        })
    }

    /// The mesh whose vertices `surface` moves from the box to the body.
    fn mesh(
        &self,
        surface: impl Fn(Vector3<f64>) -> Vector3<f64>,
    ) -> Result<ArtistMesh, BlendError> {
        let (corners, scale) = self.layout();
        let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for (side, corner) in Side::ALL.into_iter().zip(corners) {
            let first = positions.len() as u32;
            let [across, up] = [side.across, side.up].map(|axis| self.cells[axis]);
            for row in 0..=up {
                for column in 0..=across {
                    positions.push(surface(self.place(side, column, row)));
                    let at = corner + CELL * Vector2::new(f64::from(column), f64::from(row));
                    // V points down.
                    let [u, v] = [at.x, at.y].map(|x| MARGIN + scale * x);
                    uvs.push(Vector2::new(u, 1.0 - v));
                }
            }
            triangles.extend(cell_triangles(first, across, up));
        }
        finish(ArtistMesh {
            name: self.name.to_owned(),
            positions,
            normals: None,
            uvs: Some(uvs),
            triangles,
            shapes: Vec::new(),
        })
    }

    /// A grid point of a side, on the box. Sides that meet have the same points to the last bit,
    /// because these are made from whole numbers.
    fn place(&self, side: Side, column: u32, row: u32) -> Vector3<f64> {
        let mut index = [0; 3];
        index[side.across] = if side.is_reversed() {
            self.cells[side.across] - column
        } else {
            column
        };
        index[side.up] = row;
        index[side.facing] = if side.is_end {
            self.cells[side.facing]
        } else {
            0
        };
        let coordinate =
            |axis: usize| 0.5 * CELL * (2.0 * f64::from(index[axis]) - f64::from(self.cells[axis]));
        Vector3::new(coordinate(0), coordinate(1), coordinate(2))
    }

    /// Lower left corner of each side's chart (m), shelf above shelf from the lower left of the
    /// texture, and the texture's size of a metre.
    fn layout(&self) -> ([Vector2<f64>; 6], f64) {
        let length = |axis: usize| CELL * f64::from(self.cells[axis]);
        let columns = f64::from(self.columns);
        let width = columns * length(0) + (columns - 1.0) * GAP;
        let (mut next, mut top) = (Vector2::zeros(), 0.0_f64);
        let corners = Side::ALL.map(|side| {
            let [across, up] = [side.across, side.up].map(length);
            // Lengths are sums of rounded numbers.
            if next.x + across > width + 0.5 * CELL {
                next = Vector2::new(0.0, top + GAP);
            }
            let corner = next;
            next.x += across + GAP;
            top = top.max(corner.y + up);
            corner
        });
        (corners, (1.0 - 2.0 * MARGIN) / width.max(top))
    }
}

/// Two triangles per cell of a grid whose vertices come row by row, cut along the diagonal that runs
/// towards the nearest corner of the grid.
///
/// Where a corner of the box is rounded off, this is the shorter one. All vertices have six
/// neighbours but the middles of sides (eight) and of the box's edges (four).
fn cell_triangles(first: u32, across: u32, up: u32) -> impl Iterator<Item = [u32; 3]> {
    let cell = move |row: u32, column: u32| {
        let a = first + row * (across + 1) + column;
        let [b, c, d] = [a + 1, a + across + 2, a + across + 1];
        if (2 * column < across) == (2 * row < up) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        }
    };
    (0..up).flat_map(move |row| (0..across).flat_map(move |column| cell(row, column)))
}
