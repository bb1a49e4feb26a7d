//! What `ruga new` writes, runs.

mod fixture;

use fixture::Folder;

#[test]
fn the_forearm_bakes() {
    let folder = Folder::new();
    let run = folder.ruga("new arm").exits(0);
    assert!(run.stdout.contains("ruga bake"), "{}", run.stdout);
    assert_eq!(folder.files("arm"), ["forearm.glb", "scene.toml"]);
    folder.ruga("check arm/scene.toml").exits(0);
    folder.change("arm/scene.toml", "steps = 6", "steps = 2");
    folder.change("arm/scene.toml", "size = 1024", "size = 256");
    folder
        .ruga("bake arm/scene.toml -o arm/out --pose pinch --quality draft")
        .exits(0);
    assert!(folder.path("arm/out/maps/pinch_100_normal.png").is_file());
}

#[test]
fn the_finger_can_be_planned() {
    let folder = Folder::new();
    folder.ruga("new finger --template finger").exits(0);
    let plan = folder.ruga("plan finger/scene.toml").exits(0).stdout;
    assert!(plan.contains("total: 1 of 1 poses wrinkle"), "{plan}");
}

#[test]
fn the_face_has_its_masks_and_wrinkles_in_every_pose() {
    let folder = Folder::new();
    folder.ruga("new face --template face").exits(0);
    let files = folder.files("face");
    let images = ["cheeks.png", "eyes.png", "forehead.png", "thickness.png"];
    assert!(
        images.iter().all(|i| files.iter().any(|f| f == i)),
        "{files:?}"
    );
    let plan = folder.ruga("plan face/scene.toml --quality draft").exits(0);
    assert!(
        plan.stdout.contains("total: 8 of 8 poses wrinkle"),
        "{}",
        plan.stdout
    );
    assert!(!plan.stderr.contains("warning"), "{}", plan.stderr);
}

#[test]
fn the_creases_are_planned_with_their_lines() {
    let folder = Folder::new();
    folder.ruga("new head --template creases").exits(0);
    let plan = folder.ruga("plan head/scene.toml --quality draft --pose smile");
    let plan = plan.exits(0);
    assert!(plan.stdout.contains("nasolabial-left"), "{}", plan.stdout);
    let total = "total: 1 of 1 poses wrinkle";
    assert!(plan.stdout.contains(total), "{}", plan.stdout);
    // That the others are for other poses is as it should be.
    assert!(!plan.stderr.contains("no pose folds"), "{}", plan.stderr);
}

#[test]
fn the_cushion_passes_its_check() {
    let folder = Folder::new();
    folder.ruga("new cushion --template cushion").exits(0);
    folder.ruga("check cushion/scene.toml").exits(0);
}
