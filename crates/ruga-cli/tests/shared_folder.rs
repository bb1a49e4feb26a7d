//! Results of several runs in one output folder.

mod fixture;

use fixture::Folder;
use serde_json::Value;

/// Three poses, of one key and one load step each.
fn three_poses() -> Folder {
    let pose = |name: &str, weight: f64| {
        format!(
            "[[poses]]\nname = \"{name}\"\nweights = {{ squeeze = {weight} }}\nkeys = [1.0]\nsteps = 1\n\n"
        )
    };
    let more = format!("{}{}[remesh]", pose("some", 0.7), pose("more", 0.9));
    let folder = Folder::with("keys = [0.5, 1.0]\nsteps = 2", "keys = [1.0]\nsteps = 1");
    folder.change("scene.toml", "[remesh]", &more);
    folder
}

/// The poses in the report, those with maps in the manifest, and those with weights in it.
fn listed(folder: &Folder) -> [Vec<String>; 3] {
    let text = |value: &Value| value.as_str().expect("a name").to_owned();
    let (report, manifest) = (
        folder.json("out/report.json"),
        folder.json("out/wrinkles.json"),
    );
    let reported = report["poses"].as_array().expect("a list").iter();
    let mut mapped: Vec<String> = Vec::new();
    for map in manifest["maps"].as_array().expect("a list") {
        assert!(
            folder.path("out").join(text(&map["file"])).is_file(),
            "{map}"
        );
        if mapped.last() != Some(&text(&map["pose"])) {
            mapped.push(text(&map["pose"]));
        }
    }
    let weighted = manifest["poses"].as_object().expect("a table").keys();
    [
        reported.map(|pose| text(&pose["name"])).collect(),
        mapped,
        weighted.cloned().collect(),
    ]
}

/// Report and manifest list these, in this order; the manifest's weights are by name.
#[track_caller]
fn assert_listed(folder: &Folder, poses: &[&str]) {
    let mut sorted = poses.to_vec();
    sorted.sort_unstable();
    assert_eq!(listed(folder), [poses, poses, &sorted]);
}

#[test]
fn baking_one_pose_leaves_the_others_listed() {
    let folder = three_poses();
    folder.ruga("bake scene.toml -o out --pose more").exits(0);
    let run = folder
        .ruga("bake scene.toml -o out --pose squeezed --quality draft")
        .exits(0);
    assert!(
        run.stdout
            .contains("1 pose of earlier runs is listed with these."),
        "{}",
        run.stdout
    );
    assert_listed(&folder, &["squeezed", "more"]);
    // Neither a remark nor another pose makes them older; and the other command takes nothing away.
    folder.change("scene.toml", "[substrate]", "# soft\n[substrate]");
    folder.change("scene.toml", "squeeze = 0.7", "squeeze = 0.6");
    folder
        .ruga("simulate scene.toml -o out --pose squeezed")
        .exits(0);
    folder.ruga("bake scene.toml -o out --pose some").exits(0);
    assert_listed(&folder, &["squeezed", "some", "more"]);
    let report = folder.json("out/report.json");
    let points = |pose: usize| report["poses"][pose]["points_per_wavelength"].clone();
    assert_eq!([points(0), points(1)], [6.0, 4.0]);
    let glb = folder.read("out/Patch.glb");
    let glb = String::from_utf8_lossy(&glb);
    assert!(glb.contains("more_100_normal.png") && glb.contains("some_100_normal.png"));
}

#[test]
fn simulating_one_pose_leaves_the_others_in_the_report() {
    let folder = three_poses();
    folder
        .ruga("simulate scene.toml -o out --pose some")
        .exits(0);
    folder
        .ruga("simulate scene.toml -o out --pose more")
        .exits(0);
    let report = folder.json("out/report.json");
    let names: Vec<&Value> = report["poses"].as_array().unwrap().iter().collect();
    assert_eq!([&names[0]["name"], &names[1]["name"]], ["some", "more"]);
}

#[test]
fn poses_of_an_older_version_of_the_scene_are_named_and_not_listed() {
    let folder = three_poses();
    folder.ruga("bake scene.toml -o out").exits(0);
    folder.change(
        "scene.toml",
        "critical_strain = 0.05",
        "critical_strain = 0.06",
    );
    folder
        .ruga("bake scene.toml -o out --pose more")
        .exits(0)
        .says(&["older version of the scene", "2 poses (`squeezed`, `some`)"]);
    assert_listed(&folder, &["more"]);
    assert!(
        folder.json("out/report.json")["warnings"]
            .to_string()
            .contains("older version")
    );
    assert!(folder.path("out/maps/some_100_normal.png").exists());

    // The scene as it was has its results back.
    folder.change(
        "scene.toml",
        "critical_strain = 0.06",
        "critical_strain = 0.05",
    );
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["`some` is there from an earlier run", "pose `more`: done"]);
    assert_listed(&folder, &["squeezed", "some", "more"]);

    // Poses that the scene has no more, and those whose files were deleted.
    folder.change("scene.toml", "name = \"some\"", "name = \"other\"");
    std::fs::remove_file(folder.path("out/maps/more_100_height.png")).unwrap();
    folder
        .ruga("bake scene.toml -o out --pose other")
        .exits(0)
        .says(&[
            "the scene has them no more",
            "(`some`)",
            "files are gone: 1 pose (`more`)",
        ]);
    assert_listed(&folder, &["squeezed", "other"]);
}

#[test]
fn maps_of_keys_that_are_gone_go_with_them() {
    let folder = Folder::with("steps = 2", "steps = 1");
    folder.ruga("bake scene.toml -o out").exits(0);
    folder.change("scene.toml", "keys = [0.5, 1.0]", "keys = [0.333, 1.0]");
    folder.ruga("bake scene.toml -o out").exits(0);
    assert_eq!(
        folder.files("out/maps"),
        [
            "squeezed_100_height.png",
            "squeezed_100_normal.png",
            "squeezed_33p3_height.png",
            "squeezed_33p3_normal.png",
        ]
    );
    assert_listed(&folder, &["squeezed"]);
}

#[test]
fn the_folder_of_another_scene_is_refused_unless_forced() {
    let folder = three_poses();
    folder.ruga("bake scene.toml -o out --pose some").exits(0);
    let scene = folder.read("scene.toml");
    let text = String::from_utf8(scene.clone()).unwrap();
    // The same scene by another name is no other scene.
    folder.write("renamed.toml", &scene);
    folder
        .ruga("bake renamed.toml -o out --pose some --resume")
        .exits(0)
        .says(&["`some` is there from an earlier run"]);

    folder.write("other.toml", text.replace("0.05", "0.07"));
    let before = folder.files("out");
    for command in ["bake", "simulate"] {
        folder
            .ruga(&format!("{command} other.toml -o out --pose more"))
            .exits(2)
            .says(&[
                "out: holds 1 pose of another scene: `../scene.toml` with mesh `Patch`",
                "this scene is `../other.toml`",
                "--force",
            ]);
    }
    assert_eq!(folder.files("out"), before);
    assert_listed(&folder, &["some"]);

    folder
        .ruga("bake other.toml -o out --pose more --force")
        .exits(0)
        .says(&["1 pose of the scene `../scene.toml` with mesh `Patch` left out"]);
    assert_listed(&folder, &["more"]);
    assert!(folder.path("out/maps/some_100_normal.png").exists());
    folder.ruga("bake other.toml -o out --pose some").exits(0);
    assert_listed(&folder, &["some", "more"]);
}

#[test]
fn many_warnings_of_one_kind_are_one_message_and_whole_in_the_report() {
    let folder = three_poses();
    let about = |line: &&str| line.contains("remesh.points_per_wavelength");
    for line in ["plan scene.toml", "bake scene.toml -o out"] {
        let run = folder.ruga(line).exits(0);
        let said: Vec<&str> = run.stderr.lines().filter(about).collect();
        assert_eq!(said.len(), 1, "{}", run.stderr);
        assert!(
            said[0].starts_with("warning: 3 poses, layer 'skin': ")
                && said[0].ends_with("['squeezed', 'some', 'more']"),
            "{said:?}"
        );
    }
    let report = folder.json("out/report.json");
    let warnings = report["warnings"].as_array().unwrap().iter();
    let whole = warnings.filter_map(Value::as_str).filter(about).count();
    assert_eq!(whole, 3, "{report}");
}
