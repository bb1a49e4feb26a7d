//! Meshes in another unit than metres.

mod fixture;

use fixture::Folder;

/// The scene of the fixture with its mesh `factor` times as large.
fn sized(factor: f64) -> Folder {
    let folder = Folder::new();
    for name in ["patch.obj", "squeeze.obj", "stretch.obj", "dent.obj"] {
        let text = String::from_utf8(folder.read(name)).expect("an OBJ is text");
        let line = |line: &str| match line.strip_prefix("v ") {
            Some(rest) => {
                let numbers = rest.split(' ').map(|n| {
                    let number: f64 = n.parse().expect("a number");
                    format!(" {}", factor * number)
                });
                format!("v{}\n", numbers.collect::<String>())
            }
            None => format!("{line}\n"),
        };
        folder.write(name, text.lines().map(line).collect::<String>());
    }
    folder
}

#[test]
fn a_mesh_in_centimetres_is_asked_about() {
    // 9 cm, 3 waves: 21 m is 700.
    let folder = sized(21.0 / 0.09);
    for line in [
        "check scene.toml",
        "plan scene.toml",
        "bake scene.toml -o out",
    ] {
        folder.ruga(line).exits(2).says(&[
            "patch.obj: the mesh is 21 m wide; is it in centimetres?",
            "length_unit = \"cm\"",
            "scale = 1.0",
        ]);
    }
    assert!(!folder.path("out").exists());
}

#[test]
fn the_key_that_is_proposed_mends_it() {
    // 15 % would lie on the limit of what the model takes, this side or that by rounding.
    let gentle = |folder: Folder| {
        folder.change("scene.toml", "squeeze = 1.0", "squeeze = 0.8");
        folder
    };
    for key in ["length_unit = \"cm\"", "[driver]\nscale = 0.01"] {
        let folder = gentle(sized(100.0));
        let plan = folder.ruga("plan scene.toml").exits(2);
        assert!(plan.stderr.contains("9 m wide"), "{}", plan.stderr);
        match key.split_once('\n') {
            Some((table, scale)) => {
                folder.change("scene.toml", table, &format!("{table}\n{scale}"));
            }
            None => folder.change("scene.toml", "version = 1", &format!("version = 1\n{key}")),
        }
        let mended = folder.ruga("plan scene.toml").exits(0).stdout;
        let metres = gentle(sized(1.0)).ruga("plan scene.toml").exits(0).stdout;
        assert_eq!(mended, metres);
    }
}

#[test]
fn a_mesh_of_two_millimetres_is_asked_about() {
    let folder = sized(0.002 / 0.09);
    folder.ruga("check scene.toml").exits(2).says(&[
        "the mesh is 2 mm wide",
        "100 times too small",
        "scale = 100",
    ]);
}

#[test]
fn a_small_patch_passes() {
    let folder = sized(0.01 / 0.09);
    folder.change("scene.toml", "wavelength = 0.03", "wavelength = 0.002");
    let run = folder.ruga("check scene.toml").exits(0);
    assert!(!run.stderr.contains("wide"), "{}", run.stderr);
}

#[test]
fn a_layer_thicker_than_the_mesh_is_asked_about_too() {
    let layer = "young = 0.8e6\nthickness = 0.7";
    let folder = Folder::with("wavelength = 0.03\ncritical_strain = 0.05", layer);
    folder.ruga("check scene.toml").exits(0).says(&[
        "it has no room for two of them; check the unit of the file",
        "or the layer's `thickness`, which is in metres",
    ]);
}
