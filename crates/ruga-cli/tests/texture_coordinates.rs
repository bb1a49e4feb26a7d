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

#[test]
fn uvs_on_one_spot_are_refused_as_not_unwrapped() {
    let zero = Folder::with_uvs(|_, _| (0.0, 0.0));
    for line in [
        "check scene.toml",
        "plan scene.toml",
        "bake scene.toml -o out",
    ] {
        zero.ruga(line).exits(2).says(&[
            "patch.obj",
            "the texture coordinates of `Patch` are all zero",
            "unwrap the mesh",
        ]);
    }
    let spot = Folder::with_uvs(|_, _| (0.5, 0.5));
    spot.ruga("check scene.toml")
        .exits(2)
        .says(&["all lie on one point"]);
    let line = Folder::with_uvs(|x, _| (x, 0.5));
    line.ruga("check scene.toml")
        .exits(2)
        .says(&["have no area"]);
}

#[test]
fn uvs_beside_all_tiles_are_refused_with_their_place() {
    let beside = Folder::with_uvs(|x, y| (x - 1.0, y));
    beside.ruga("bake scene.toml -o out").exits(2).says(&[
        "the texture coordinates of `Patch` all lie in the tile from (-1, 0) to (0, 1)",
        "move them to the square from 0 to 1, or to UDIM tiles",
    ]);
    // V as an editor shows it, whatever the file's way of counting.
    let below = Folder::with_uvs(|x, y| (x, y - 2.0));
    below
        .ruga("check scene.toml")
        .exits(2)
        .says(&["all lie in the tile from (0, -2) to (1, -1)"]);
    let wide = Folder::with_uvs(|x, y| (2.0 * x - 3.0, y));
    wide.ruga("check scene.toml")
        .exits(2)
        .says(&["span 2 x 1 tiles, from (-3, 0) to (-1, 1), none of it in the square"]);
    // Without UDIM another tile is none of the square, either.
    let other = Folder::with_uvs(|x, y| (x, y + 2.0));
    other.change(
        "scene.toml",
        "region = \"all\"",
        "region = \"all\"\ntiles = \"one\"",
    );
    other
        .ruga("check scene.toml")
        .exits(2)
        .says(&["all lie in the tile from (0, 2) to (1, 3)"]);
}

#[test]
fn uvs_of_three_times_the_square_are_refused() {
    for shift in [0.0, 1.0] {
        let folder = Folder::with_uvs(|x, y| (3.0 * x - shift, 3.0 * y - shift));
        let corners = match shift {
            0.0 => "from (0, 0) to (3, 3)",
            _ => "from (-1, -1) to (2, 2)",
        };
        folder.ruga("plan scene.toml").exits(2).says(&[
            "the skin of `Patch` that is simulated span 3 x 3 tiles",
            corners,
            "only 11 % of it",
            "scale them down",
        ]);
    }
}

#[test]
fn uvs_partly_outside_are_a_warning_with_their_share() {
    let shares = Folder::with_uvs(|x, y| (x + 0.5, y));
    let run = shares.ruga("check scene.toml").exits(0);
    assert!(
        run.stderr.contains("not baked, 50 % of the skin"),
        "{}",
        run.stderr
    );
}

#[test]
fn v_that_runs_the_other_way_is_a_warning() {
    let flipped = Folder::with_uvs(|x, y| (x, 1.0 - y));
    flipped.ruga("check scene.toml").exits(0).says(&[
        "warning:",
        "mirrored on 100 % of the skin",
        "flip V",
    ]);
    // One half mirrored onto its own place is how faces are laid out.
    let half = Folder::with_uvs(|x, y| (if x > 0.5 { 1.2 - 0.6 * x } else { 0.6 * x }, y));
    let run = half.ruga("check scene.toml");
    assert!(!run.stderr.contains("mirrored"), "{}", run.stderr);
    let sound = Folder::new().ruga("check scene.toml").exits(0);
    assert!(!sound.stderr.contains("mirrored"), "{}", sound.stderr);
}
