//! Weights that tear, fold or mean nothing.

mod fixture;

use fixture::Folder;
use ruga_io::read_image;

/// Whether every texel of a normal map is flat.
fn is_neutral(folder: &Folder, file: &str) -> bool {
    let flat = [32768.0 / 65535.0, 32768.0 / 65535.0, 1.0];
    let image = read_image(&folder.path(file)).expect("a map");
    image.values.chunks_exact(3).all(|texel| texel == flat)
}

#[test]
fn a_part_that_folds_is_left_out_with_a_warning() {
    let folder = Folder::with("squeeze = 1.0", "dent = 5.0");
    folder
        .ruga("bake scene.toml -o out")
        .exits(0)
        .says(&["warning:", "fold over or collapse"]);
    let report = folder.json("out/report.json");
    assert!(
        report["warnings"].to_string().contains("fold over"),
        "{report}"
    );
    assert!(!is_neutral(&folder, "out/maps/squeezed_100_normal.png"));
}

#[test]
fn a_pose_that_folds_everything_is_neutral_with_a_warning() {
    // At half the weight the patch is 75 % shorter, at the whole weight it is turned over.
    let folder = Folder::with("squeeze = 1.0", "squeeze = 10.0");
    folder.ruga("bake scene.toml -o out").exits(0).says(&[
        "warning:",
        "81.00 cm2 of the driver fold over or collapse",
        "pose `squeezed`: nothing to wrinkle",
    ]);
    for file in ["squeezed_50_normal.png", "squeezed_100_normal.png"] {
        assert!(is_neutral(&folder, &format!("out/maps/{file}")), "{file}");
    }
}

#[test]
fn a_pose_the_other_way_round_is_simulated() {
    // Three times the shape, backwards: the patch is stretched by 45 %.
    let folder = Folder::with("squeeze = 1.0", "squeeze = -3.0");
    folder.ruga("bake scene.toml -o out").exits(0);
    let layer = &folder.json("out/report.json")["poses"][0]["layers"][0];
    assert!(layer["wavelength_m"].is_null(), "{layer}");
    assert!(layer["vertices"].as_u64() > Some(0), "{layer}");
}

#[test]
fn weights_far_beyond_the_whole_shape_are_asked_about() {
    let said = |weight: &str, line: &str| {
        let folder = Folder::with("squeeze = 1.0", &format!("squeeze = {weight}"));
        folder.ruga(line).exits(0).stderr
    };
    for line in ["check scene.toml", "plan scene.toml"] {
        for (weight, found, times) in [
            ("3.3", "3.3", "3.3"),
            ("10.0", "10", "10"),
            ("-3.0", "-3", "3"),
        ] {
            let text = said(weight, line);
            let expected = format!(
                "warning: `poses[0].weights.squeeze`: found {found}; 1 is the whole blend shape, and \
                 this goes {times} times as far as it was drawn\n"
            );
            assert!(text.contains(&expected), "{text}");
        }
        let usual = said("2.0", line);
        assert!(!usual.contains("weights.squeeze"), "{usual}");
    }
}

#[test]
fn weights_that_are_no_numbers_are_refused() {
    for weight in ["nan", "inf", "-inf"] {
        let folder = Folder::with("squeeze = 1.0", &format!("squeeze = {weight}"));
        for line in ["check scene.toml", "bake scene.toml -o out"] {
            folder
                .ruga(line)
                .exits(2)
                .says(&["poses[0].weights.squeeze", "a finite number"]);
        }
        assert!(!folder.path("out").exists());
    }
}

/// Stretched skin has no wrinkles to simulate, and is none any more.
#[test]
fn a_pose_that_tears_the_skin_is_asked_about() {
    let folder = Folder::with("squeeze = 1.0", "stretch = 5.4");
    folder.change("scene.toml", "region = \"all\"", "region = \"auto\"");
    let run = folder.ruga("plan scene.toml").exits(0);
    run.says(&[
        "stretched by more than",
        "not skin any more",
        "did you mean a weight of",
    ]);
}
