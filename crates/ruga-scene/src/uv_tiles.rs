//! The UDIM tiles that the texture coordinates of a mesh lie in.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use ruga_bake::island_boxes;
use ruga_blend::Driver;
use ruga_material::UvTile;

use crate::file::Tiles;

/// Part of a tile by which an island may reach over its border: a margin that was left too small.
const OVERHANG: f64 = 0.02;

/// Share of the skin in whole islands below which a layout is one that repeats, or has another scale.
const LEAST_WHOLE: f64 = 0.5;

/// Share of the skin in other tiles than the first below which nothing is meant by it.
const LEAST_ELSEWHERE: f64 = 1e-4;

/// The tiles of a mesh, ascending: of each, an image is read and maps are written. One that has no UDIM tiles
/// has the first one.
///
/// `uvs` (V down) and `areas` are of the corners and triangles of the file.
pub(crate) fn tiles_of(uvs: &[[Vector2<f64>; 3]], areas: &[f64], wanted: Tiles) -> Vec<UvTile> {
    let is_udim = match wanted {
        Tiles::One => false,
        Tiles::Udim => true,
        Tiles::Auto => are_udim(uvs, areas),
    };
    let boxes = island_boxes(uvs);
    let with_area = uvs
        .iter()
        .zip(&boxes)
        .filter(|(_, island)| island.is_some());
    let found = with_area.filter_map(|(uvs, _)| UvTile::of_triangle(uvs));
    let tiles: BTreeSet<UvTile> = found.filter(|_| is_udim).collect();
    match tiles.is_empty() {
        true => vec![UvTile::FIRST],
        false => tiles.into_iter().collect(),
    }
}

/// Whether these are the tiles of a mesh with UDIM tiles: any but the first one alone.
pub fn are_tiled(tiles: &[UvTile]) -> bool {
    tiles != [UvTile::FIRST]
}

/// Whether islands are spread over tiles: most of them lie whole in one, and some in others than the first.
///
/// An island that was shifted over a border, or a texture that repeats, lies in several tiles at once. So do
/// islands that fill two tiles and touch at the border between them, which nothing tells from one.
fn are_udim(uvs: &[[Vector2<f64>; 3]], areas: &[f64]) -> bool {
    let [mut all, mut whole, mut elsewhere] = [0.0; 3];
    for (island, area) in island_boxes(uvs).iter().zip(areas) {
        let Some(island) = island else { continue };
        all += area;
        if let Some(tile) = tile_of_island(island) {
            whole += area;
            elsewhere += if tile == UvTile::FIRST { 0.0 } else { *area };
        }
    }
    whole >= LEAST_WHOLE * all && elsewhere > LEAST_ELSEWHERE * all
}

fn tile_of_island([low, high]: &[Vector2<f64>; 2]) -> Option<UvTile> {
    let tile = UvTile::at(&((low + high) / 2.0))?;
    let within = -OVERHANG..=1.0 + OVERHANG;
    let mut ends = [low, high].into_iter().map(|end| tile.local(end));
    ends.all(|end| end.iter().all(|c| within.contains(c)))
        .then_some(tile)
}

/// The driver of a mesh with UDIM tiles: each place of a face is clearly in the face's own tile, where
/// coordinates on the border of two could be in either.
pub(crate) fn driver_in_tiles(driver: Driver) -> Driver {
    driver.with_uvs(|uvs| match UvTile::of_triangle(uvs) {
        Some(tile) => tile.inside(uvs),
        None => *uvs,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles with its lowest corner here, V down.
    fn square(u: f64, v: f64, side: f64) -> Vec<[Vector2<f64>; 3]> {
        let at = |x: f64, y: f64| Vector2::new(u + side * x, v + side * y);
        vec![
            [at(0.0, 0.0), at(1.0, 1.0), at(1.0, 0.0)],
            [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)],
        ]
    }

    fn numbers(squares: &[Vec<[Vector2<f64>; 3]>], wanted: Tiles) -> Vec<u32> {
        let uvs = squares.concat();
        let tiles = tiles_of(&uvs, &vec![1.0; uvs.len()], wanted);
        tiles.into_iter().map(UvTile::number).collect()
    }

    #[test]
    fn whole_islands_elsewhere_make_tiles() {
        let first = square(0.01, 0.01, 0.98);
        let auto = |other| numbers(&[first.clone(), other], Tiles::Auto);
        assert_eq!(auto(square(1.0, 0.0, 1.0)), [1001, 1002]);
        assert_eq!(auto(square(2.1, -0.9, 0.5)), [1001, 1013]);
        assert_eq!(numbers(&[square(0.0, -1.0, 1.0)], Tiles::Auto), [1011]);
        let both = [first, square(1.0, 0.0, 1.0)];
        assert_eq!(numbers(&both, Tiles::One), [1001]);
    }

    #[test]
    fn what_is_shifted_repeats_or_lies_beside_the_tiles_makes_none() {
        let first = square(0.0, 0.0, 1.0);
        for other in [
            square(0.5, 0.0, 1.0),
            square(0.0, 0.0, 3.0),
            square(-1.0, 0.0, 1.0),
            square(0.0, 1.0, 1.0),
            square(10.0, 0.0, 1.0),
        ] {
            let both = [first.clone(), other];
            assert_eq!(numbers(&both[1..], Tiles::Auto), [1001]);
            assert_eq!(numbers(&both, Tiles::Auto), [1001]);
        }
    }

    #[test]
    fn an_island_over_several_tiles_can_be_meant() {
        let wide: Vec<_> = [0.0, 1.0].map(|u| square(u, 0.0, 1.0)).concat();
        let wide = [wide];
        assert_eq!(numbers(&wide, Tiles::Auto), [1001]);
        assert_eq!(numbers(&wide, Tiles::Udim), [1001, 1002]);
    }
}
