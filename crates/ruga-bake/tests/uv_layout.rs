//! Where UVs lie: shares of the square, islands over several tiles, orientation.

mod patch;

use nalgebra::Vector2;
use patch::{SIDE, grid_faces, uv};
use ruga_bake::{UvLayout, uv_layout};

const CELLS: usize = 12;

/// A grid that fills the square, its UVs changed by `place`.
fn grid(place: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Vec<[Vector2<f64>; 3]> {
    let at = |v: u32| {
        let [column, row] = [v as usize % (CELLS + 1), v as usize / (CELLS + 1)];
        place(uv([column, row].map(|i| i as f64 * SIDE / CELLS as f64)))
    };
    grid_faces(CELLS).into_iter().map(|f| f.map(at)).collect()
}

fn layout(uvs: &[[Vector2<f64>; 3]]) -> UvLayout {
    uv_layout(uvs, &vec![1.0; uvs.len()]).expect("UVs with an area")
}

#[track_caller]
fn assert_near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-9, "{found}, not {wanted}");
}

#[test]
fn a_sound_layout_is_inside_and_unmirrored() {
    let found = layout(&grid(|uv| uv));
    assert_near(found.inside, 1.0);
    assert_near(found.astride, 0.0);
    assert_near(found.mirrored, 0.0);
    assert_near(found.low.norm(), 0.0);
    assert_near((found.high - Vector2::repeat(1.0)).norm(), 0.0);
}

#[test]
fn a_shifted_layout_is_outside_but_not_astride() {
    let found = layout(&grid(|uv| uv + Vector2::new(1.0, -2.0)));
    assert_near(found.inside, 0.0);
    assert_near(found.astride, 0.0);
    assert_near((found.low - Vector2::new(1.0, -2.0)).norm(), 0.0);
    assert_near((found.high - Vector2::new(2.0, -1.0)).norm(), 0.0);
}

#[test]
fn a_layout_of_three_times_the_square_is_astride() {
    for origin in [0.0, 1.0] {
        let found = layout(&grid(|uv| 3.0 * uv - Vector2::repeat(origin)));
        assert_near(found.inside, 1.0 / 9.0);
        assert_near(found.astride, 1.0);
    }
    // Faces that the square's border cuts count by what is inside.
    assert_near(layout(&grid(|uv| uv + Vector2::repeat(0.3))).inside, 0.49);
}

#[test]
fn whole_islands_in_several_tiles_are_not_astride() {
    let mut uvs = grid(|uv| uv);
    uvs.extend(grid(|uv| 0.9 * uv + Vector2::new(1.05, 0.05)));
    uvs.extend(grid(|uv| 0.9 * uv + Vector2::new(2.05, 1.05)));
    let found = layout(&uvs);
    assert_near(found.inside, 1.0 / 3.0);
    assert_near(found.astride, 0.0);
    // A margin that is a little too small is no second tile.
    assert_near(layout(&grid(|uv| 1.01 * uv)).astride, 0.0);
}

#[test]
fn a_flipped_layout_is_mirrored_by_the_weights_of_its_faces() {
    let flip = |uv: Vector2<f64>| Vector2::new(uv.x, 1.0 - uv.y);
    assert_near(layout(&grid(flip)).mirrored, 1.0);
    let both: Vec<_> = grid(|uv| uv).into_iter().chain(grid(flip)).collect();
    let weights: Vec<f64> = (0..both.len())
        .map(|i| if i < both.len() / 2 { 3.0 } else { 1.0 })
        .collect();
    let found = uv_layout(&both, &weights).expect("UVs with an area");
    assert_near(found.mirrored, 0.25);
}

#[test]
fn without_area_or_numbers_there_is_no_layout() {
    assert_eq!(uv_layout(&[], &[]), None);
    assert_eq!(
        uv_layout(&grid(|_| Vector2::zeros()), &vec![1.0; 2 * CELLS * CELLS]),
        None
    );
    let wrong = [[Vector2::repeat(f64::NAN); 3]];
    assert_eq!(uv_layout(&wrong, &[1.0]), None);
    assert_eq!(uv_layout(&grid(|uv| uv)[..1], &[f64::INFINITY]), None);
}
