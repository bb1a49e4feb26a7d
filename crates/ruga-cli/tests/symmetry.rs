//! `symmetry = "x"` through the command: one of two mirror images is simulated, and both are baked.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, strip};

/// Vertices along and across a strip of skin whose middle is at x = 0.
const COUNT: [usize; 2] = [13, 5];

/// A strip with the part beyond `side` squeezed towards the middle: -1 left, 1 right, 0 none. Its diagonals are other
/// ones on the other side.
fn squeezed(side: f64) -> String {
    strip(COUNT, 0.3, |column, row| {
        let x = -0.06 + 0.01 * column as f64;
        let x = if x * side > 0.0 { 0.88 * x } else { x };
        [x, 0.01 * row as f64]
    })
}

/// A scene of a left and a right pose.
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, side) in [("strip.obj", 0.0), ("left.obj", -1.0), ("right.obj", 1.0)] {
        folder.write(name, squeezed(side));
    }
    let scene = "version = 1\n[driver]\nmesh = \"strip.obj\"\nsymmetry = \"x\"\n\
                 targets = { left = \"left.obj\", right = \"right.obj\" }\n\
                 [[layers]]\nname = \"skin\"\npreset = \"forehead-furrow\"\nvariation = 0.0\n\
                 [[poses]]\nname = \"b-right\"\nweights = { right = 1.0 }\nkeys = [1.0]\n\
                 [[poses]]\nname = \"a-left\"\nweights = { left = 1.0 }\nkeys = [1.0]\n\
                 [bake]\nsize = 64\nmaps = [\"normal\"]\nformat = \"png8\"\npadding = 0\n";
    folder.write("scene.toml", scene);
    folder
}

#[test]
fn two_mirror_images_take_one_simulation() {
    let folder = folder();
    let plan = folder.ruga("plan scene.toml --quality draft").exits(0);
    let line = "`a-left` and `b-right` are mirror images: `ruga bake` makes both of one simulation";
    assert!(plan.stdout.contains(line), "{}", plan.stdout);

    let run = "bake scene.toml -o out --quality draft --maps-only";
    folder.ruga(run).exits(0);
    let report = folder.json("out/report.json");
    let poses = report["poses"].as_array().unwrap();
    let energies: Vec<f64> = poses
        .iter()
        .map(|pose| pose["layers"][0]["energy_j"].as_f64().unwrap())
        .collect();
    assert_eq!(energies[0], energies[1]);
    assert_eq!(poses[1]["layers"][0]["seconds"]["total"].as_f64(), None);
    let map = |pose| folder.read(&format!("out/maps/{pose}_100_normal.png"));
    let together = ["a-left", "b-right"].map(map);
    assert_ne!(together[0], together[1]);

    // Alone, with what is missing, or as a task of a farm, the right pose is made of the same simulation.
    for more in [" --pose b-right", " --resume", " --pose b-right --task"] {
        std::fs::remove_file(folder.path("out/maps/b-right_100_normal.png")).unwrap();
        folder.ruga(&format!("{run}{more}")).exits(0);
        assert_eq!(map("b-right"), together[1], "{more}");
    }
}

#[test]
fn paint_that_differs_between_the_sides_is_told() {
    let folder = folder();
    folder.change(
        "scene.toml",
        "variation = 0.0",
        "variation = 0.0\nmask = \"half.png\"",
    );
    let grey: Vec<u8> = (0..16 * 16)
        .map(|i| if i % 16 < 8 { 255 } else { 0 })
        .collect();
    let texels = ruga_io::PngTexels::Grey8(&grey);
    ruga_io::write_png(&folder.path("half.png"), 16, 16, texels).unwrap();
    let run = folder.ruga("plan scene.toml --quality draft").exits(0);
    let told = "the mask of layer 'skin' differs between the sides by up to 100 %";
    assert!(run.stderr.contains(told), "{}", run.stderr);
}
