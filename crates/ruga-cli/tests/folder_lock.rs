//! Two runs in one output folder.

mod fixture;

use fixture::{Folder, wait_for};

#[test]
fn a_second_run_is_refused_while_the_first_works_and_welcome_when_it_was_killed() {
    let folder = Folder::with("steps = 2", "steps = 4000");
    let (mut first, mut stderr) = folder.start("simulate scene.toml -o out --threads 1");
    wait_for(&mut stderr, "started");
    folder.change("scene.toml", "steps = 4000", "steps = 2");
    for command in ["bake", "simulate"] {
        folder
            .ruga(&format!("{command} scene.toml -o out --force"))
            .exits(2)
            .says(&[
                "out: another run is working in this folder",
                &format!("process {} on `", first.id()),
                "`ruga simulate scene.toml`, started ",
                "--output",
            ]);
    }
    assert!(!folder.path("out/report.json").exists());
    folder.ruga("bake scene.toml -o another").exits(0);

    // Killed, it cannot clean up: its name stays behind, its lock does not.
    first.kill().expect("it is still at work");
    first.wait().expect("it was killed");
    assert!(folder.path("out/poses/.run.json").exists());
    folder.ruga("bake scene.toml -o out").exits(0);
    assert!(!folder.path("out/poses/.run.json").exists());
}
