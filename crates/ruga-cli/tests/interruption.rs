//! Ctrl-C, and going on afterwards.
#![cfg(unix)]

mod fixture;

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};

use fixture::Folder;

/// A second pose that takes some seconds.
const LONG: &str = "[[poses]]\nname = \"long\"\nweights = { squeeze = 1.0 }\nsteps = 400\n[remesh]";

#[test]
fn finished_poses_stay_whole_and_a_second_run_resumes() {
    let folder = Folder::with("[remesh]", LONG);
    let mut child = Command::new(env!("CARGO_BIN_EXE_ruga"))
        .args(["bake", "scene.toml", "-o", "out", "--threads", "1"])
        .current_dir(folder.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("pose `long` (2 of 2) started") {
        line.clear();
        assert_ne!(
            stderr.read_line(&mut line).unwrap(),
            0,
            "the run ended early"
        );
    }
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(rest.contains("interrupted: 1 pose left"), "{rest}");

    let files = folder.files("out");
    assert!(
        files.contains(&"maps/squeezed_100_normal.png".to_owned()),
        "{files:?}"
    );
    assert!(
        files
            .iter()
            .all(|f| !f.contains("long") && !f.ends_with(".tmp")),
        "{files:?}"
    );
    let report = folder.json("out/report.json");
    assert_eq!(report["poses"].as_array().unwrap().len(), 1);
    assert!(
        report["warnings"].to_string().contains("interrupted"),
        "{report}"
    );

    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&[
            "`squeezed` is there from an earlier run",
            "pose `long`: done",
        ]);
    assert_eq!(
        folder.json("out/report.json")["poses"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
    assert_eq!(
        folder.json("out/wrinkles.json")["maps"]
            .as_array()
            .unwrap()
            .len(),
        8
    );
}

#[test]
fn only_poses_with_the_same_inputs_and_files_are_kept() {
    let folder = Folder::new();
    let kept = |line: &str| {
        let run = folder.ruga(line).exits(0);
        run.stderr.contains("is there from an earlier run")
    };
    assert!(!kept("bake scene.toml -o out --resume"));
    let maps = folder.read("out/maps/squeezed_100_normal.png");
    assert!(kept("bake scene.toml -o out --resume"));
    assert!(!kept("bake scene.toml -o out"));
    assert!(!kept("bake scene.toml -o out --resume --quality draft"));
    assert!(!kept("bake scene.toml -o out --resume"));
    assert_eq!(folder.read("out/maps/squeezed_100_normal.png"), maps);

    std::fs::remove_file(folder.path("out/maps/squeezed_50_height.png")).unwrap();
    assert!(!kept("bake scene.toml -o out --resume"));

    folder.change("squeeze.obj", "v 0 0 0", "v 0 0 0.0001");
    assert!(!kept("bake scene.toml -o out --resume"));

    folder.change("scene.toml", "size = 64", "size = 32");
    assert!(!kept("bake scene.toml -o out --resume"));
    assert!(kept("bake scene.toml -o out --resume"));
}
