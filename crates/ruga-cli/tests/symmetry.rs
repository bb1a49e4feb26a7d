//! `symmetry = "x"` through the command: one of two mirror images is simulated, and both are baked.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fmt::Write;

use fixture::Folder;

/// Vertices along and across a strip of skin whose middle is at x = 0.
const COUNT: [usize; 2] = [13, 5];

/// A strip as OBJ, with the part beyond `side` squeezed towards the middle: -1 left, 1 right, 0 none.
fn strip(side: f64) -> String {
    let [columns, rows] = COUNT;
    let mut text = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let x = -0.06 + 0.01 * column as f64;
            let squeezed = if x * side > 0.0 { 0.88 * x } else { x };
            writeln!(text, "v {squeezed:.6} {:.6} 0", 0.01 * row as f64).unwrap();
            let v = 0.3 * row as f64 / (rows - 1) as f64;
            writeln!(
                text,
                "vt {:.6} {v:.6}",
                column as f64 / (columns - 1) as f64
            )
            .unwrap();
        }
    }
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let a = 1 + row * columns + column;
            let [b, c, d] = [a + 1, a + 1 + columns, a + columns];
            // The same diagonal everywhere, as exporters do: it is the other one on the other side.
            writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}").unwrap();
        }
    }
    text
}

/// A scene of a left and a right pose.
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, side) in [("strip.obj", 0.0), ("left.obj", -1.0), ("right.obj", 1.0)] {
        folder.write(name, strip(side));
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
