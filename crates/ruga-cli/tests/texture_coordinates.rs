//! UVs that overlap, leave the unit square, or are harmlessly odd.

mod fixture;

use fixture::Folder;

/// The last row of triangles lies on the first in the texture.
fn folded(x: f64, y: f64) -> (f64, f64) {
    (x, if y > 0.9 { 0.0 } else { y })
}

#[test]
fn an_overlap_in_the_active_region_names_both_triangles() {
    let folder = Folder::with_uvs(folded);
    for line in [
        "plan scene.toml",
        "check scene.toml",
        "bake scene.toml -o out",
        "simulate scene.toml -o out",
    ] {
        // The last row begins with triangle 112 and lies on the seven before it.
        folder.ruga(line).exits(2).says(&[
            "patch.obj",
            "triangles 0 and 112 overlap inside the active region of pose `squeezed`",
        ]);
    }
    assert!(!folder.path("out").exists(), "no work was begun");
}

#[test]
fn an_overlap_elsewhere_is_a_warning() {
    let folder = Folder::with_uvs(folded);
    // Nothing wrinkles where skin is only stretched, so there is no active region at all.
    folder.change("scene.toml", "region = \"all\"", "region = \"auto\"");
    folder.change("scene.toml", "squeeze = 1.0", "stretch = 1.0");
    folder
        .ruga("bake scene.toml -o out")
        .exits(0)
        .says(&["warning:", "overlap others"]);
}

#[test]
fn uvs_outside_the_square_are_counted() {
    let folder = Folder::with_uvs(|x, y| (x + 0.5, y));
    let run = folder.ruga("check scene.toml").exits(0);
    let warning = run
        .stderr
        .lines()
        .find(|line| line.contains("leave the square"))
        .unwrap();
    // Half of the 128 triangles, those of the right four columns.
    assert!(
        warning.starts_with("warning:") && warning.contains(" 64 triangles"),
        "{warning}"
    );
}
