//! `symmetry = "x"` through the command: one of two mirror images is simulated, and both are baked.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, strip};

/// Vertices along and across a strip of skin whose middle is at x = 0.
const COUNT: [usize; 2] = [9, 4];

/// A strip with the part beyond `side` squeezed towards the middle: -1 left, 1 right, 0 none. Its diagonals are other
/// ones on the other side.
fn squeezed(side: f64) -> String {
    strip(COUNT, 0.3, |column, row| {
        let x = 0.01 * (column as f64 - 4.0);
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

/// One more pose, of both sides.
fn folder_with_both() -> Folder {
    let folder = folder();
    let both = "[[poses]]\nname = \"both\"\nweights = { left = 1.0, right = 1.0 }\nkeys = [0.7, 1.0]\n[bake]";
    folder.change("scene.toml", "[bake]", both);
    folder
}

#[test]
fn of_a_pose_that_mirrors_itself_one_half_is_simulated() {
    let folder = folder_with_both();
    let plan = folder.ruga("plan scene.toml --quality draft").exits(0);
    let line = "`both` mirrors itself: `ruga bake` simulates one half, whose numbers these are";
    assert!(plan.stdout.contains(line), "{}", plan.stdout);
    let plan = folder
        .ruga("plan scene.toml --quality draft --json")
        .exits(0);
    let plan: serde_json::Value = serde_json::from_str(&plan.stdout).unwrap();
    let halves: Vec<_> = plan["poses"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pose| pose["half"].as_bool().unwrap())
        .collect();
    assert_eq!(halves, [false, false, true]);

    // The same with one thread and two, as the task of a farm, and where a map is missing.
    let run = "bake scene.toml -o out --quality draft --maps-only --pose both";
    folder.ruga(&format!("{run} --threads 1")).exits(0);
    let map = || ["70", "100"].map(|key| folder.read(&format!("out/maps/both_{key}_normal.png")));
    let first = map();
    for more in [" --threads 2 --force", " --task", " --resume"] {
        std::fs::remove_file(folder.path("out/maps/both_100_normal.png")).unwrap();
        folder.ruga(&format!("{run}{more}")).exits(0);
        assert_eq!(map(), first, "{more}");
    }
}

/// Two layers in one system are solved whole, as is a pose whose sides are painted differently.
#[test]
fn what_cannot_be_halved_is_simulated_whole() {
    let folder = folder_with_both();
    let second = "variation = 0.0\n[[layers]]\nname = \"upper\"\npreset = \"crows-feet\"";
    folder.change("scene.toml", "variation = 0.0", second);
    let is_halved = || {
        let plan = folder.ruga("plan scene.toml --quality draft").exits(0);
        plan.stdout.contains("`both` mirrors itself")
    };
    assert!(is_halved());
    folder.change(
        "scene.toml",
        "version = 1",
        "version = 1\nstack = \"joint\"",
    );
    assert!(!is_halved());
    folder.change("scene.toml", "stack = \"joint\"", "");
    assert!(is_halved());
    write_half_mask(&folder);
    assert!(!is_halved());
}

/// Paints the first layer on one side alone.
fn write_half_mask(folder: &Folder) {
    folder.change(
        "scene.toml",
        "preset = \"forehead-furrow\"",
        "preset = \"forehead-furrow\"\nmask = \"half.png\"",
    );
    let grey: Vec<u8> = (0..16 * 16)
        .map(|i| if i % 16 < 8 { 255 } else { 0 })
        .collect();
    let texels = ruga_io::PngTexels::Grey8(&grey);
    ruga_io::write_png(&folder.path("half.png"), 16, 16, texels).unwrap();
}

#[test]
fn paint_that_differs_between_the_sides_is_told() {
    let folder = folder();
    write_half_mask(&folder);
    let run = folder.ruga("plan scene.toml --quality draft").exits(0);
    let told = "the mask of layer 'skin' differs between the sides by up to 100 %";
    assert!(run.stderr.contains(told), "{}", run.stderr);
}
