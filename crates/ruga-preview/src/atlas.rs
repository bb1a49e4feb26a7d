//! One picture of all tiles of a texture layout.

use std::borrow::Cow;

use nalgebra::Vector2;
use ruga_blend::ArtistMesh;

use crate::tile_split::laid_out;

/// Longest side of a picture of several tiles, texels: any graphics card takes it.
const MOST: u32 = 4096;

/// Room around every one of several tiles, texels: smaller copies of the picture do not mix them.
const MARGIN: u32 = 8;

/// The place of every tile of a texture layout in one square picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// Lowest U and V of the unit square of every tile, V down; empty for a mesh without, whose picture repeats.
    squares: Vec<[i32; 2]>,
    /// Tiles beside each other, and below each other.
    columns: u32,
    /// Side of a tile, texels.
    side: u32,
    margin: u32,
}

impl Atlas {
    /// Places for tiles by the lowest U and V of their unit squares, V down, each at most `side` texels wide and
    /// high, at least one; without tiles for the one picture of a mesh, which repeats.
    ///
    /// There is room for a few thousand tiles.
    pub fn new(side: u32, squares: &[[i32; 2]]) -> Self {
        let columns = (squares.len() as f64).sqrt().ceil().max(1.0) as u32;
        let (margin, most) = match squares {
            [] => (0, side),
            _ => (MARGIN, (MOST / columns).saturating_sub(2 * MARGIN)),
        };
        Self {
            squares: squares.to_vec(),
            columns,
            side: side.min(most).max(1),
            margin,
        }
    }

    /// Texels per side of a tile.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Texels per side of the picture.
    pub fn size(&self) -> u32 {
        self.columns * self.pitch()
    }

    /// Column and row of the first texel of tile `number`.
    pub fn origin(&self, number: usize) -> [u32; 2] {
        let number = number as u32;
        [number % self.columns, number / self.columns].map(|cell| cell * self.pitch() + self.margin)
    }

    /// Where in the picture a place of tile `number` is: 0 to 1, V down, both in the tile and in the picture.
    pub fn place(&self, number: usize, place: Vector2<f64>) -> Vector2<f64> {
        let origin = Vector2::from(self.origin(number).map(f64::from));
        (origin + place * f64::from(self.side)) / f64::from(self.size())
    }

    fn pitch(&self) -> u32 {
        self.side + 2 * self.margin
    }

    /// The mesh with the texture coordinates of the picture; triangles in no tile are at its corner.
    pub(crate) fn laid_out<'m>(&self, mesh: &'m ArtistMesh) -> Cow<'m, ArtistMesh> {
        if self.squares.is_empty() {
            return Cow::Borrowed(mesh);
        }
        let place = |number, place| match number < self.squares.len() {
            true => self.place(number, place),
            false => Vector2::zeros(),
        };
        Cow::Owned(laid_out(mesh, &self.squares, place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_picture_of_a_mesh_without_tiles_is_all_of_it() {
        let atlas = Atlas::new(1024, &[]);
        assert_eq!([atlas.size(), atlas.side()], [1024, 1024]);
        assert_eq!(atlas.origin(0), [0, 0]);
        let place = Vector2::new(0.25, 0.75);
        assert_eq!(atlas.place(0, place), place);
    }

    #[test]
    fn tiles_lie_beside_and_below_each_other_with_room_between() {
        let squares = [[0, 0], [1, 0], [0, -1]];
        let atlas = Atlas::new(100, &squares);
        assert_eq!([atlas.size(), atlas.side()], [232, 100]);
        assert_eq!(
            [0, 1, 2].map(|n| atlas.origin(n)),
            [[8, 8], [124, 8], [8, 124]]
        );
        let corner = atlas.place(1, Vector2::new(1.0, 1.0)) * 232.0;
        assert!((corner - Vector2::new(224.0, 108.0)).norm() < 1e-9);
    }

    #[test]
    fn pictures_of_many_tiles_stay_small() {
        for count in [1, 2, 17, 100, 4000] {
            let squares: Vec<[i32; 2]> = (0..count).map(|i| [i % 10, -i / 10]).collect();
            let atlas = Atlas::new(1024, &squares);
            assert!(atlas.size() <= MOST && atlas.side() > 0, "{atlas:?}");
        }
    }
}
