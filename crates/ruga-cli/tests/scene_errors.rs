//! Scenes that cannot run: the message names file, key and value, and nothing is written.

mod fixture;

use fixture::Folder;
use ruga_io::{PngTexels, write_png};

/// Runs the three commands that read a scene; each must refuse it with these words.
#[track_caller]
fn refuses(folder: &Folder, texts: &[&str]) {
    for line in [
        "bake scene.toml -o out",
        "plan scene.toml",
        "check scene.toml",
    ] {
        folder.ruga(line).exits(2).says(texts);
    }
    assert!(!folder.path("out/report.json").exists());
    assert!(!folder.path("out/maps").exists());
}

#[test]
fn a_scene_that_is_not_there() {
    let folder = Folder::new();
    folder
        .ruga("bake none.toml -o out")
        .exits(2)
        .says(&["none.toml", "there is no such file"]);
}

#[test]
fn a_key_with_a_slip_of_the_hand() {
    let folder = Folder::with("wavelength = 0.03", "wavelenght = 0.03");
    refuses(
        &folder,
        &["scene.toml", "wavelenght", "did you mean `wavelength`"],
    );
}

#[test]
fn a_value_out_of_range() {
    let folder = Folder::with("poisson = 0.48", "poisson = 0.5");
    refuses(&folder, &["substrate.poisson", "0.5", "below 0.5"]);
}

#[test]
fn a_share_of_the_bending_of_no_layer() {
    let transfer = "critical_strain = 0.05\nbending_transfer = 0.5";
    let folder = Folder::with("critical_strain = 0.05", transfer);
    let key = "`layers[0].bending_transfer`";
    refuses(&folder, &["scene.toml", key, "no layer below"]);
}

#[test]
fn a_body_that_is_open() {
    let body = "[interior]\nfollow = 1e6\n[remesh]";
    let folder = Folder::with("[remesh]", body);
    refuses(&folder, &["patch.obj", "32 open edges"]);
}

#[test]
fn a_body_that_blend_shapes_would_not_move() {
    let folder = Folder::with("[remesh]", "[interior]\n[remesh]");
    refuses(&folder, &["scene.toml", "weights", "`follow`"]);
}

#[test]
fn a_preset_that_does_not_exist() {
    let wanted = "wavelength = 0.03\ncritical_strain = 0.05";
    let folder = Folder::with(wanted, "preset = \"forehead-furow\"");
    refuses(
        &folder,
        &[
            "layers[0].preset",
            "did you mean `forehead-furrow`",
            "crows-feet",
        ],
    );
}

#[test]
fn a_material_that_cannot_be() {
    let folder = Folder::with("wavelength = 0.03", "wavelength = 1e-200");
    refuses(&folder, &["scene.toml", "`layers[0]`", "units"]);
}

#[test]
fn a_blend_shape_that_does_not_exist() {
    let folder = Folder::with("{ squeeze = 1.0 }", "{ sqeeze = 1.0 }");
    refuses(
        &folder,
        &["poses[0].weights.sqeeze", "did you mean `squeeze`"],
    );
}

#[test]
fn a_pose_that_does_not_exist() {
    let folder = Folder::new();
    folder
        .ruga("bake scene.toml -o out --pose sqeezed")
        .exits(2)
        .says(&["scene.toml", "no pose `sqeezed`", "did you mean `squeezed`"]);
}

#[test]
fn a_mesh_that_is_not_there() {
    let folder = Folder::with("\"patch.obj\"", "\"path.obj\"");
    refuses(
        &folder,
        &[
            "scene.toml: `driver.mesh`: path.obj",
            "there is no such file",
        ],
    );
    let folder = Folder::with("\"dent.obj\"", "\"bent.obj\"");
    let key = "scene.toml: `driver.targets.dent`: bent.obj";
    refuses(&folder, &[key, "there is no such file"]);
}

#[test]
fn a_region_that_is_no_word_and_no_image() {
    let folder = Folder::with("region = \"all\"", "region = \"al\"");
    refuses(
        &folder,
        &[
            "`driver.region`: al",
            "accepted: \"auto\", \"all\", or the path of a grey image",
            "did you mean `all`?",
        ],
    );
}

#[test]
fn a_mesh_that_is_none() {
    let folder = Folder::new();
    folder.write("patch.obj", "v 0 0 0\nf 1 2 3\n");
    refuses(&folder, &["patch.obj"]);
}

#[test]
fn a_mesh_without_texture_coordinates() {
    let folder = Folder::new();
    for file in ["patch.obj", "squeeze.obj", "stretch.obj"] {
        let text = String::from_utf8(folder.read(file)).unwrap();
        let faces = text
            .lines()
            .filter(|line| !line.starts_with("vt"))
            .map(|line| {
                let corners = line.split(' ').map(|word| word.split('/').next().unwrap());
                corners.collect::<Vec<_>>().join(" ")
            });
        folder.write(file, faces.collect::<Vec<_>>().join("\n"));
    }
    refuses(&folder, &["patch.obj", "no texture coordinates"]);
}

#[test]
fn a_black_mask_and_a_missing_one() {
    let folder = Folder::with("region = \"all\"", "region = \"mask.png\"");
    refuses(
        &folder,
        &["driver.region", "mask.png", "there is no such file"],
    );
    write_png(&folder.path("mask.png"), 4, 4, PngTexels::Grey8(&[0; 16])).unwrap();
    refuses(
        &folder,
        &[
            "scene.toml: layer `skin`: nothing is left to simulate by `driver.region` (mask.png)",
            "paint whole faces white",
        ],
    );
    // A white speck that lies in no face's middle.
    let mut speck = vec![0; 256 * 256];
    speck[0] = 255;
    write_png(&folder.path("mask.png"), 256, 256, PngTexels::Grey8(&speck)).unwrap();
    refuses(
        &folder,
        &["no face of the mesh is white there", "a speck inside one"],
    );
}

#[test]
fn a_missing_mask_of_a_layer_is_named_with_its_key() {
    let masked = "critical_strain = 0.05\nmask = \"spot.png\"";
    let folder = Folder::with("critical_strain = 0.05", masked);
    refuses(
        &folder,
        &["layers[0].mask", "spot.png", "there is no such file"],
    );
}

#[test]
fn a_preset_on_another_substrate_is_told_apart_from_what_it_promises() {
    let said = |layer: &str| {
        let folder = Folder::with("wavelength = 0.03\ncritical_strain = 0.05", layer);
        folder.change("scene.toml", "young = 20e3", "young = 2e3");
        folder.ruga("check scene.toml").exits(0).stderr
    };
    let text = said("preset = \"forehead-furrow\"");
    for words in [
        "layer 'skin': preset `forehead-furrow` promises wrinkles of 10.2",
        "on its own substrate; on yours they are",
        "Leave `[substrate]` out to have its own",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(!said("young = 0.8e6\nthickness = 0.7e-3").contains("promises"));
    let own = Folder::with(
        "wavelength = 0.03\ncritical_strain = 0.05",
        "preset = \"forehead-furrow\"",
    );
    own.change(
        "scene.toml",
        "[substrate]\nyoung = 20e3\npoisson = 0.48\nthickness = 0.02\n",
        "",
    );
    let text = own.ruga("check scene.toml").exits(0).stderr;
    assert!(!text.contains("promises"), "{text}");
}

#[test]
fn check_names_every_problem() {
    let folder = Folder::with("\"patch.obj\"", "\"path.obj\"");
    let transfer = "critical_strain = 0.05\nbending_transfer = 0.5";
    folder.change("scene.toml", "critical_strain = 0.05", transfer);
    folder.ruga("check scene.toml").exits(2).says(&[
        "`layers[0].bending_transfer`",
        "path.obj",
        "2 problems",
    ]);
}
