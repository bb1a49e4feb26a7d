//! Unit squares of texture space that have images of their own: UDIM tiles.

use nalgebra::Vector2;

/// Columns of tiles: numbers count ten along U before they go up a row.
const COLUMNS: i32 = 10;

/// The largest number of a tile.
const LAST: i32 = 9999;

/// Distance by which 32-bit texture coordinates miss the border of their tile.
const ROUNDING: f64 = 1e-5;

/// Distance from its tile's border that a coordinate keeps: far below a texel, and far above what
/// rounding moves a place between three such corners. Two tiles' corners on one border are further apart
/// than what counts as one coordinate, so that a border between tiles is a seam.
const MARGIN: f64 = 1e-8;

/// A UDIM tile: a unit square of texture space, numbered `1001 + column + 10 row`.
///
/// Columns run along U from 0 to 9, rows *up*: with V pointing down, as everywhere here, row `j` has V from
/// `-j` to `1 - j`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct UvTile {
    // First, so that the order of tiles is that of their numbers.
    row: i32,
    column: i32,
}

impl UvTile {
    /// Tile 1001, the square from 0 to 1: the only one of a mesh without UDIM.
    pub const FIRST: Self = Self { row: 0, column: 0 };

    /// The tile of a number, 1001 to 9999.
    pub fn from_number(number: u32) -> Option<Self> {
        let number = i32::try_from(number).ok()?;
        let index = number.checked_sub(1001).filter(|index| *index >= 0)?;
        (number <= LAST).then_some(Self {
            row: index / COLUMNS,
            column: index % COLUMNS,
        })
    }

    /// The tile with this lowest U and V, as [`Self::origin`] gives it.
    pub fn from_origin([u, v]: [i32; 2]) -> Option<Self> {
        let row = v.checked_neg()?;
        let is_column = (0..COLUMNS).contains(&u);
        let last_row = (LAST - 1001) / COLUMNS;
        (is_column && (0..=last_row).contains(&row)).then_some(Self { row, column: u })
    }

    /// The tile of a place, V down; `None` left of U 0, from U 10 on, below V's first tile (V from 1 on), or
    /// where a coordinate is not a number.
    ///
    /// A place on the border of two tiles is the right or, V down, the lower one's; [`Self::inside`] keeps
    /// the corners of a face from being so.
    pub fn at(uv: &Vector2<f64>) -> Option<Self> {
        // A conversion saturates; what is not a number would become tile 1001.
        let is_number = uv.iter().all(|c| c.is_finite());
        let [u, v] = [uv.x, uv.y].map(|c| c.floor() as i32);
        Self::from_origin([u, v]).filter(|_| is_number)
    }

    /// The tile that a triangle lies in, but for what 32-bit coordinates miss a border by; `None` if it
    /// spans several, or lies where there are no tiles.
    pub fn of_triangle(corners: &[Vector2<f64>; 3]) -> Option<Self> {
        let tile = Self::at(&((corners[0] + corners[1] + corners[2]) / 3.0))?;
        let within = -ROUNDING..=1.0 + ROUNDING;
        let mut local = corners.iter().map(|uv| tile.local(uv));
        local
            .all(|uv| uv.iter().all(|c| within.contains(c)))
            .then_some(tile)
    }

    /// Its number, `1001 + column + 10 row`.
    pub fn number(self) -> u32 {
        (1001 + self.column + COLUMNS * self.row) as u32
    }

    /// Its lowest U and V, V down: the place of its image's upper left corner.
    pub fn origin(self) -> [i32; 2] {
        [self.column, -self.row]
    }

    /// A place relative to the tile: from 0 to 1 inside it, V down.
    pub fn local(self, uv: &Vector2<f64>) -> Vector2<f64> {
        uv - Vector2::from(self.origin().map(f64::from))
    }

    /// The place in the layout of a place in this tile, the inverse of [`Self::local`].
    pub fn place(self, local: &Vector2<f64>) -> Vector2<f64> {
        local + Vector2::from(self.origin().map(f64::from))
    }

    /// The coordinates moved just inside the tile, so that [`Self::at`] finds it for every place between
    /// them.
    pub fn inside(self, corners: &[Vector2<f64>; 3]) -> [Vector2<f64>; 3] {
        let origin = Vector2::from(self.origin().map(f64::from));
        corners.map(|uv| (uv - origin).map(|c| c.clamp(MARGIN, 1.0 - MARGIN)) + origin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(u: f64, v: f64) -> Option<u32> {
        UvTile::at(&Vector2::new(u, v)).map(UvTile::number)
    }

    #[test]
    fn numbers_count_columns_and_then_rows_up() {
        assert_eq!(at(0.5, 0.5), Some(1001));
        assert_eq!(at(1.5, 0.5), Some(1002));
        assert_eq!(at(9.5, 0.5), Some(1010));
        // V points down: half a tile above the first one is at -0.5.
        assert_eq!(at(0.5, -0.5), Some(1011));
        assert_eq!(at(3.25, -1.5), Some(1024));
        for (u, v) in [(-0.1, 0.5), (10.0, 0.5), (0.5, 1.0), (f64::NAN, 0.5)] {
            assert_eq!(at(u, v), None, "{u} {v}");
        }
        assert_eq!(at(0.5, f64::NEG_INFINITY), None);
        assert_eq!(at(0.5, -1e300), None);
    }

    #[test]
    fn number_and_origin_lead_back_to_the_tile() {
        for number in [1001, 1002, 1010, 1011, 1999, 9999] {
            let tile = UvTile::from_number(number).expect("a tile");
            assert_eq!(tile.number(), number);
            assert_eq!(UvTile::from_origin(tile.origin()), Some(tile));
        }
        for number in [0, 1000, 10_000, u32::MAX] {
            assert_eq!(UvTile::from_number(number), None);
        }
        assert_eq!(UvTile::from_origin([0, i32::MIN]), None);
        let tiles = [1009, 1011, 1012].map(|n| UvTile::from_number(n).expect("a tile"));
        assert!(tiles.is_sorted());
    }

    #[test]
    fn a_triangle_is_in_one_tile_or_in_none() {
        let triangle = |corners: [[f64; 2]; 3]| {
            UvTile::of_triangle(&corners.map(Vector2::from)).map(UvTile::number)
        };
        // Border to border, and a rounding beyond.
        assert_eq!(
            triangle([[1.0, 0.0], [2.000_000_1, 0.0], [1.0, -1.0]]),
            Some(1012)
        );
        assert_eq!(triangle([[0.9, 0.5], [1.1, 0.5], [0.9, 0.6]]), None);
        assert_eq!(triangle([[-0.5, 0.5], [-0.1, 0.5], [-0.2, 0.6]]), None);
    }

    #[test]
    fn corners_that_were_moved_inside_have_no_two_tiles() {
        let corners = [[1.0, 0.0], [2.0, 0.0], [1.0, -1.0]].map(Vector2::from);
        let tile = UvTile::of_triangle(&corners).expect("a tile");
        for corner in tile.inside(&corners) {
            assert_eq!(UvTile::at(&corner), Some(tile));
        }
        let middle = [[1.25, -0.5]; 3].map(Vector2::from);
        assert_eq!(tile.inside(&middle), middle);
    }
}
