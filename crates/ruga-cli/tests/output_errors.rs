//! Output folders that cannot be written to.

mod fixture;

use fixture::Folder;
#[cfg(unix)]
use fixture::Run;

#[test]
fn a_file_where_the_folder_should_be() {
    let folder = Folder::new();
    folder.write("out", "in the way");
    for command in ["bake", "simulate"] {
        folder
            .ruga(&format!("{command} scene.toml -o out"))
            .exits(2)
            .says(&["out: cannot be the output folder", "it is a file"]);
    }
    assert_eq!(folder.read("out"), b"in the way");
}

#[test]
fn a_file_above_the_folder() {
    let folder = Folder::new();
    folder.write("out", "in the way");
    let run = folder.ruga("bake scene.toml -o out/maps").exits(2);
    assert!(run.stderr.contains("out/maps"), "{}", run.stderr);
}

#[test]
fn a_file_of_the_run_that_is_a_folder_leaves_nothing_half_written() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("out/maps/squeezed_100_normal.png")).unwrap();
    folder
        .ruga("bake scene.toml -o out --threads 1")
        .exits(2)
        .says(&["squeezed_100_normal.png", "cannot write"]);
    let files = folder.files("out");
    assert!(
        files.iter().all(|file| !file.ends_with(".tmp")),
        "{files:?}"
    );
    assert!(
        !files.contains(&"poses/squeezed.json".to_owned()),
        "{files:?}"
    );
    assert!(!files.contains(&"report.json".to_owned()), "{files:?}");
}

#[test]
fn a_starter_scene_overwrites_nothing() {
    let folder = Folder::new();
    let before = folder.files("");
    folder
        .ruga("new .")
        .exits(2)
        .says(&["scene.toml", "exists already"]);
    assert_eq!(folder.files(""), before);
}

/// Manifest and report describe the maps of poses that were finished before the error, not those that
/// they have replaced.
#[test]
fn an_error_in_one_pose_leaves_manifest_and_report_true() {
    let long = "[[poses]]\nname = \"other\"\nweights = { squeeze = 0.9 }\nkeys = [1.0]\nsteps = 1\n\n[remesh]";
    let folder = Folder::with("keys = [0.5, 1.0]\nsteps = 2", "keys = [1.0]\nsteps = 1");
    folder.change("scene.toml", "[remesh]", long);
    let bake = "bake scene.toml -o out --threads 1";
    folder.ruga(bake).exits(0);
    let scale = || {
        let record = folder.json("out/poses/squeezed.json");
        let manifest = folder.json("out/wrinkles.json");
        assert_eq!(manifest["maps"][1], record["maps"][1]);
        record["maps"][1]["scale"].as_f64().unwrap()
    };
    let before = scale();

    folder.change(
        "scene.toml",
        "critical_strain = 0.05",
        "critical_strain = 0.06",
    );
    std::fs::remove_file(folder.path("out/maps/other_100_normal.png")).unwrap();
    std::fs::create_dir(folder.path("out/maps/other_100_normal.png")).unwrap();
    folder.ruga(bake).exits(2).says(&["other_100_normal.png"]);
    assert_ne!(scale(), before);
    assert_eq!(
        folder.json("out/wrinkles.json")["maps"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
    let report = folder.json("out/report.json");
    assert_eq!(report["poses"].as_array().unwrap().len(), 1);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("ended by an error"), "{warnings}");
}

/// Files may grow to 32 kB, after which writing fails as on a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_names_the_file_and_leaves_finished_poses_whole() {
    let folder = Folder::with("size = 64", "size = 256");
    // Nothing wrinkles in the first pose: its maps are one colour and small.
    let first = "[[poses]]\nname = \"first\"\nweights = { stretch = 1.0 }\nsteps = 1\n\n[[poses]]";
    folder.change("scene.toml", "[[poses]]", first);
    folder.change("scene.toml", "region = \"all\"", "region = \"auto\"");
    let limited = "trap '' XFSZ; ulimit -f 64; exec \"$0\" bake scene.toml -o out --threads 1";
    let output = std::process::Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_ruga")])
        .current_dir(folder.path(""))
        .output();
    Run::from(output.expect("there is a shell"))
        .exits(2)
        .says(&["squeezed_50_normal.png", "cannot write"]);
    assert_eq!(
        folder.files("out"),
        [
            "Patch.glb",
            "maps/first_100_height.png",
            "maps/first_100_normal.png",
            "maps/first_50_height.png",
            "maps/first_50_normal.png",
            "poses/first.json",
            "report.json",
            "wrinkles.json",
        ]
    );

    // With room on the disk the run goes on after them.
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["`first` is there from an earlier run"]);
    assert_eq!(folder.files("out/maps").len(), 8);
}
