//! `--memory`: what a limit refuses, and that it changes no result.

mod fixture;

use fixture::{Folder, Run};

/// The starter scene of the forearm, coarse, with one key to a pose and small maps. By their plans its poses
/// need 129, 129 and 121 MB, of which 110 are the program.
fn forearm() -> Folder {
    let folder = Folder::new();
    folder.ruga("new arm").exits(0);
    let coarse = "[remesh]\npoints_per_wavelength = 4\n\n[bake]\nsize = 64";
    folder.change("arm/scene.toml", "[bake]\nsize = 1024", coarse);
    for pose in ["compress", "twist", "pinch"] {
        let weights = format!("weights = {{ {pose} = 1.0 }}\n");
        let from = format!("{weights}keys = [0.5, 1.0]\nsteps = 6");
        folder.change(
            "arm/scene.toml",
            &from,
            &format!("{weights}keys = [1.0]\nsteps = 1"),
        );
    }
    folder
}

/// Megabytes that each pose of the forearm needs by its plan.
fn planned(folder: &Folder) -> [f64; 3] {
    let line = "plan arm/scene.toml --json";
    let plan = folder.ruga(line).exits(0).stdout;
    let plan: serde_json::Value = serde_json::from_str(&plan).expect("JSON");
    [0, 1, 2].map(|pose| {
        let bytes = plan["poses"][pose]["memory_bytes"].as_f64();
        bytes.expect("a number") / 1e6
    })
}

/// The most poses that were in work at a time, from what was said.
fn most_at_a_time(run: &Run) -> usize {
    let (mut now, mut most) = (0, 0);
    for line in run.stderr.lines().filter(|line| line.starts_with("pose `")) {
        match line.ends_with("started") {
            true => now += 1,
            false => now -= 1,
        }
        most = most.max(now);
    }
    most
}

#[test]
fn a_pose_that_needs_more_is_refused_before_anything_is_written() {
    let folder = forearm();
    for command in ["bake", "simulate", "job"] {
        let line = format!("{command} arm/scene.toml -o out --memory 50MB");
        folder.ruga(&line).exits(2).says(&[
            "arm/scene.toml: pose `twist` needs ",
            "more than `--memory 50MB` allows; so do 2 other poses",
            "nothing was written",
            "--quality draft",
        ]);
        assert!(!folder.path("out").exists());
    }
    // It names what the largest needs, and just that suffices.
    let refused = folder.ruga("job arm/scene.toml -o out --memory 1").exits(2);
    let told = refused.stderr.split("give `--memory ").nth(1);
    let told = told
        .and_then(|rest| rest.split('`').next())
        .expect("an amount");
    let line = format!("job arm/scene.toml -o out --memory {told}");
    folder.ruga(&line).exits(0);
    assert_eq!(folder.json("out/parameters.json")["Memory"], told);
}

#[test]
fn fewer_poses_at_a_time_give_the_same_bytes() {
    let folder = forearm();
    let [compress, twist, pinch] = planned(&folder);
    let bake = "bake arm/scene.toml --threads 3 -o";
    folder.ruga(&format!("{bake} all")).exits(0);
    let files = folder.files("all");
    for (name, most, megabytes) in [
        ("one", 1, twist.max(compress)),
        ("two", 2, twist + pinch.max(compress)),
    ] {
        let limit = megabytes.ceil();
        let run = folder
            .ruga(&format!("{bake} {name} --memory {limit}MB"))
            .exits(0);
        assert!(most_at_a_time(&run) <= most, "{}", run.stderr);
        assert_eq!(folder.files(name), files);
        let results = |file: &&String| !file.starts_with("poses/") && *file != "report.json";
        for file in files.iter().filter(results) {
            let [expected, found] = ["all", name].map(|out| folder.read(&format!("{out}/{file}")));
            assert!(expected == found, "{name}/{file} differs");
        }
        let poses = |out: &str| {
            let report = folder.json(&format!("{out}/report.json"));
            let poses = report["poses"].as_array().expect("a list").iter();
            poses
                .map(|pose| pose["name"].to_string())
                .collect::<Vec<_>>()
        };
        assert_eq!(poses(name), poses("all"));
    }
}

#[test]
fn finished_poses_need_nothing() {
    let folder = forearm();
    let [_, twist, pinch] = planned(&folder);
    assert!(pinch + 2.0 < twist, "{pinch} MB, {twist} MB");
    let limit = pinch.ceil();
    let bake = "bake arm/scene.toml -o out";
    folder.ruga(&format!("{bake} --pose twist")).exits(0);
    let rest = format!("--pose twist --pose pinch --memory {limit}MB");
    folder
        .ruga(&format!("bake arm/scene.toml -o out {rest} --resume"))
        .exits(0)
        .says(&["`twist` is there from an earlier run", "pose `pinch`: done"]);
    // Neither without `--resume` nor as something else are they finished; a merge needs nothing at all.
    for line in [
        format!("bake arm/scene.toml -o out {rest}"),
        format!("simulate arm/scene.toml -o out {rest} --resume"),
    ] {
        folder.ruga(&line).exits(2).says(&["pose `twist` needs"]);
    }
    folder
        .ruga(&format!("bake arm/scene.toml -o out {rest} --merge"))
        .exits(0);
}
