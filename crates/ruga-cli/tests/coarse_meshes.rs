//! Meshes that are coarser than their region is wide.

mod fixture;

use fixture::Folder;

/// All vertices of the fitted mesh lay on its border, which is held: nothing was left to solve, and
/// the run ended with "the system has no unknowns".
#[test]
fn a_mesh_that_is_all_border_gives_way_to_the_uniform_one() {
    let points = "points_per_wavelength = 4";
    let folder = Folder::with(points, &format!("{points}\nmin_edge = 0.3"));
    folder.ruga("bake scene.toml -o out").exits(0);
    let pose = &folder.json("out/report.json")["poses"][0];
    assert!(pose["layers"][0]["vertices"].as_u64() > Some(30), "{pose}");
    assert_eq!(pose["converged"].as_bool(), Some(true), "{pose}");
}
