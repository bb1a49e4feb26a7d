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
    let layer = &folder.json("out/report.json")["poses"][0]["layers"][0];
    assert!(layer["vertices"].as_u64() > Some(30), "{layer}");
    assert!(layer["residual"].as_f64() < Some(1e-3), "{layer}");
}
