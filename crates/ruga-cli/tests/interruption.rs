//! Ctrl-C, and going on afterwards.
#![cfg(unix)]

mod fixture;

use std::fs::File;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use fixture::{Folder, wait_for};
use serde_json::Value;

/// A second pose, which takes some seconds where waves are [`SHORT`].
const LONG: &str = "[[poses]]\nname = \"long\"\nweights = { squeeze = 1.0 }\nsteps = 2\n[remesh]";

/// A wavelength for which the mesh of the fixture takes seconds.
const SHORT: [&str; 2] = ["wavelength = 0.03", "wavelength = 0.012"];

fn interrupt(child: &Child) {
    signal(child, "-INT");
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status();
    assert!(sent.expect("there is `kill`").success());
}

#[test]
fn finished_poses_stay_whole_and_a_second_run_resumes() {
    let folder = Folder::with("[remesh]", LONG);
    folder.change("scene.toml", SHORT[0], SHORT[1]);
    let (mut child, mut stderr) = folder.start("bake scene.toml -o out --threads 1");
    wait_for(&mut stderr, "pose `long` (2 of 2) started");
    interrupt(&child);
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
fn a_pose_that_waits_for_memory_is_not_begun_after_an_interruption() {
    let folder = Folder::with("[remesh]", LONG);
    folder.change("scene.toml", SHORT[0], SHORT[1]);
    // Room for one: each needs more than the 110 MB that are counted for the program.
    let (mut child, mut stderr) = folder.start("bake scene.toml -o out --threads 2 --memory 200MB");
    wait_for(&mut stderr, "pose `squeezed` (1 of 2) started");
    interrupt(&child);
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(rest.contains("interrupted: 2 poses left"), "{rest}");
    assert!(!rest.contains("started"), "{rest}");
}

/// Before anything is written a signal ends the process at once, whatever it reads or plans.
///
/// SIGTERM, which is handled as Ctrl-C is: tests that run in the background inherit that SIGINT is
/// ignored.
#[test]
fn nothing_is_asked_to_stop_before_the_folder_is_there() {
    for command in ["bake", "simulate"] {
        let folder = Folder::new();
        std::fs::remove_file(folder.path("patch.obj")).unwrap();
        let made = Command::new("mkfifo")
            .arg(folder.path("patch.obj"))
            .status();
        assert!(made.expect("there is `mkfifo`").success());
        let (mut child, _stderr) = folder.start(&format!("{command} scene.toml -o out"));
        // Opens when the run reads the mesh, which then never comes.
        let _mesh = File::options()
            .write(true)
            .open(folder.path("patch.obj"))
            .unwrap();
        signal(&child, "-TERM");
        let ended = (0..100).find_map(|_| {
            sleep(Duration::from_millis(100));
            child.try_wait().unwrap()
        });
        if ended.is_none() {
            child.kill().unwrap();
        }
        assert_eq!(ended.and_then(|status| status.signal()), Some(15));
        assert!(!folder.path("out").exists());
    }
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
    assert!(!kept("bake scene.toml -o out"));
    assert_eq!(folder.read("out/maps/squeezed_100_normal.png"), maps);

    std::fs::remove_file(folder.path("out/maps/squeezed_50_height.png")).unwrap();
    assert!(!kept("bake scene.toml -o out --resume"));

    folder.change("squeeze.obj", "v 0 0 0", "v 0 0 0.0001");
    assert!(!kept("bake scene.toml -o out --resume"));

    folder.change("scene.toml", "size = 64", "size = 32");
    assert!(!kept("bake scene.toml -o out --resume"));
    assert!(kept("bake scene.toml -o out --resume"));
}

#[test]
fn resume_says_what_becomes_of_poses_of_another_quality() {
    let folder = Folder::with("keys = [0.5, 1.0]", "keys = [1.0]");
    let points = || folder.json("out/report.json")["poses"][0]["points_per_wavelength"].clone();
    folder.ruga("bake scene.toml -o out").exits(0);
    assert_eq!(points(), 4.0);
    folder
        .ruga("bake scene.toml -o out --resume --quality draft")
        .exits(0)
        .says(&[
            "pose `squeezed` is there at 4 vertices per wavelength: it is made again at draft quality",
        ]);
    assert_eq!(points(), 6.0);
    // Forgetting `--quality` when going on must not cost the finer results.
    let before = folder.read("out/maps/squeezed_100_normal.png");
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["`squeezed` is there from an earlier run at draft quality, finer than asked for"]);
    assert_eq!(points(), 6.0);
    assert_eq!(folder.read("out/maps/squeezed_100_normal.png"), before);
}

/// Interrupts a bake of the pose `long` once its first key is there, however fast the machine is.
fn interrupted_after_first_key(folder: &Folder) {
    let mut seconds = 0.4;
    while seconds < 30.0 {
        let (mut child, mut stderr) =
            folder.start("bake scene.toml -o out --pose long --quality standard");
        wait_for(&mut stderr, "pose `long` (1 of 1) started");
        sleep(Duration::from_secs_f64(seconds));
        // By less than the factor between the times of both keys.
        seconds *= 1.25;
        interrupt(&child);
        let mut rest = String::new();
        stderr.read_to_string(&mut rest).expect("text");
        assert_eq!(child.wait().expect("it ends").code(), Some(1), "{rest}");
        if folder.path("out/poses/long.json").exists() {
            assert!(
                rest.contains("the keys that were finished are kept"),
                "{rest}"
            );
            return;
        }
    }
    panic!("no key was reached");
}

#[test]
fn finished_keys_of_an_interrupted_pose_are_kept() {
    let two_keys = LONG.replace("steps = 2", "keys = [0.015, 1.0]");
    let folder = Folder::with("[remesh]", &two_keys);
    folder.change("scene.toml", SHORT[0], SHORT[1]);
    interrupted_after_first_key(&folder);
    let map = "maps/long_1p5_normal.png";
    let is_kept = || {
        let (manifest, report) = (
            folder.json("out/wrinkles.json"),
            folder.json("out/report.json"),
        );
        let listed: Vec<&Value> = manifest["maps"].as_array().unwrap().iter().collect();
        let pose = &report["poses"][0];
        assert_eq!(listed.len(), 2, "{manifest}");
        assert_eq!(
            [&listed[0]["file"], &pose["maps"]["1p5_normal"]],
            [map, map]
        );
        assert_eq!([&pose["interrupted"], &pose["converged"]], [true, false]);
        assert!(folder.path("out").join(map).exists());
    };
    is_kept();

    // A second run that gets less far takes nothing away.
    let (mut child, mut stderr) =
        folder.start("bake scene.toml -o out --pose long --quality standard --resume");
    wait_for(&mut stderr, "was interrupted: it is made again");
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    is_kept();

    // The finished pose takes their place.
    folder
        .ruga("bake scene.toml -o out --pose long --resume")
        .exits(0);
    let report = folder.json("out/report.json");
    assert_eq!(report["poses"][0]["interrupted"], Value::Null);
    assert_eq!(report["poses"][0]["maps"].as_object().unwrap().len(), 4);
    assert!(
        !report["warnings"].to_string().contains("interrupted"),
        "{report}"
    );
}

#[test]
fn an_interrupted_run_leaves_the_finished_pose_of_an_earlier_one() {
    let folder = Folder::new();
    folder.change("scene.toml", SHORT[0], SHORT[1]);
    folder.ruga("bake scene.toml -o out").exits(0);
    let before = folder.files("out");
    let (mut child, mut stderr) = folder.start("bake scene.toml -o out");
    wait_for(&mut stderr, "pose `squeezed` (1 of 1) started");
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(folder.files("out"), before);
    let maps = folder.json("out/wrinkles.json")["maps"].clone();
    assert_eq!(maps.as_array().unwrap().len(), 4);
    let poses = folder.json("out/report.json")["poses"].clone();
    assert_eq!(poses.as_array().unwrap().len(), 1);
}
