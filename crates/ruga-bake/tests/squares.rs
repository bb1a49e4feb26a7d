//! Several squares of texture space: each is baked, padded and detailed as if it were alone.

mod patch;

use nalgebra::Vector2;
use patch::{Driver, Patch, waves};
use ruga_bake::{BakeSettings, Coverage, Detail, WrinkleMap, bake_detailed, bake_squares};

const DETAILS: [Detail; 3] = [Detail::Occlusion, Detail::Curvature, Detail::Displacement];

/// Cells of the artist's mesh along each side.
const CELLS: usize = 8;

fn settings() -> BakeSettings {
    BakeSettings {
        size: 64,
        supersample: 2,
        ..BakeSettings::default()
    }
}

/// A wrinkled patch with its left half in the left part of one square and its right half in the right part
/// of another, `move_to` being the lowest U and V of both.
fn halves(move_to: [[f64; 2]; 2]) -> (Patch, Vec<[Vector2<f64>; 3]>) {
    let mut patch = Patch::new(Driver::Hill, [48, CELLS], 1e-3, waves);
    let place = |triangle: u32, uv: Vector2<f64>| {
        let is_right = (triangle as usize / 2) % CELLS >= CELLS / 2;
        0.9 * uv + Vector2::repeat(0.05) + Vector2::from(move_to[usize::from(is_right)])
    };
    for (uvs, (triangle, _)) in patch.uvs.iter_mut().zip(&patch.artist) {
        *uvs = uvs.map(|uv| place(*triangle, uv));
    }
    let coarse = Patch::new(Driver::Hill, [CELLS, 1], 0.0, |_, _| 0.0);
    let numbered = (0..).zip(&coarse.uvs);
    let islands = numbered.map(|(triangle, uvs)| uvs.map(|uv| place(triangle, uv)));
    let islands = islands.collect();
    (patch, islands)
}

/// The map of one square of such a patch, padded and with details of the artist's mesh.
fn baked(move_to: [[f64; 2]; 2], squares: &[[i32; 2]]) -> Vec<WrinkleMap> {
    let (patch, islands) = halves(move_to);
    let maps = bake_squares(
        &patch.relief(),
        &patch.frames,
        &settings(),
        &DETAILS,
        squares,
    );
    let mut maps = maps.expect("a patch");
    let ratios: Vec<[f64; 3]> = (0..islands.len()).map(|i| [i as f64 / 128.0; 3]).collect();
    for map in &mut maps {
        map.paint_compression(&islands, &ratios).expect("finite");
        map.paint_object_normals(&islands, &patch.frames)
            .expect("finite");
        map.pad(&islands, 16).expect("finite");
    }
    maps
}

/// The map as if it were that of the first square.
fn at_origin(map: &WrinkleMap) -> WrinkleMap {
    WrinkleMap {
        square: [0, 0],
        ..map.clone()
    }
}

#[test]
fn a_square_is_the_map_of_its_half_alone_texel_for_texel() {
    let far = [40.0, 40.0];
    let alone = [[[0.0; 2], far], [far, [0.0; 2]]].map(|at| baked(at, &[[0, 0]]).remove(0));
    let both = baked([[0.0, 0.0], [3.0, -2.0]], &[[0, 0], [3, -2]]);
    assert_eq!(at_origin(&both[0]), alone[0]);
    // Moved by whole numbers, coordinates lose a bit or two.
    let [moved, wanted] = [&both[1], &alone[1]];
    assert_eq!(moved.coverage, wanted.coverage);
    for (a, b) in moved.heights.iter().zip(&wanted.heights) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    for (a, b) in moved.normals.iter().zip(&wanted.normals) {
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-5), "{a:?} {b:?}");
    }
    let covered = |map: &WrinkleMap| {
        let texels = map.coverage.iter();
        texels.filter(|&&texel| texel == Coverage::Covered).count()
    };
    assert!(covered(moved) > 500 && covered(&both[0]) > 500);
}

#[test]
fn a_square_without_skin_is_neutral() {
    let maps = baked([[0.0, 0.0], [1.0, 0.0]], &[[2, 0], [0, -1], [-1, 0]]);
    for map in maps {
        let mut neutral = WrinkleMap::neutral(64, map.square);
        neutral.add_neutral(&DETAILS);
        neutral.add_neutral(&[Detail::Compression, Detail::ObjectNormal]);
        assert_eq!(map, neutral);
    }
}

#[test]
fn the_first_square_is_what_one_bake_gives() {
    let (patch, _) = halves([[0.0; 2]; 2]);
    let relief = patch.relief();
    let one = bake_detailed(&relief, &patch.frames, &settings(), &DETAILS).expect("a patch");
    let squares = [[0, 0], [1, 0]];
    let several = bake_squares(&relief, &patch.frames, &settings(), &DETAILS, &squares);
    assert_eq!(several.expect("a patch")[0], one);
}
