//! `ruga plan --image`.

mod fixture;

use fixture::Folder;

/// Width and height of a PNG.
fn size(png: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(std::array::from_fn(|i| png[at + i])))
}

fn forearm() -> Folder {
    let folder = Folder::new();
    folder.ruga("new arm").exits(0);
    folder
}

#[test]
fn a_picture_has_a_panel_for_every_pose_that_is_asked_for() {
    let folder = forearm();
    let all = folder.ruga("plan arm/scene.toml --image all.png").exits(0);
    assert!(
        all.stdout.contains("3 of 3 poses wrinkle"),
        "{}",
        all.stdout
    );
    let picture = folder.read("all.png");
    // Two panels beside each other, and two rows of them.
    assert_eq!(size(&picture), [1248, 1404]);
    folder
        .ruga("plan arm/scene.toml --pose twist --image one.png --json")
        .exits(0);
    let [width, height] = size(&folder.read("one.png"));
    assert!(width > 1000 && height < 800, "{width} x {height}");
    folder
        .ruga("plan arm/scene.toml --image again.png")
        .exits(0);
    assert!(folder.read("again.png") == picture);
}

#[test]
fn what_cannot_be_drawn_is_told_and_nothing_is_written() {
    let folder = forearm();
    folder
        .ruga("plan arm/scene.toml --image plan.jpg")
        .exits(2)
        .says(&["plan.jpg", "PNG", "`.png`"]);
    folder
        .ruga("plan arm/scene.toml --pose nod --image plan.png")
        .exits(2)
        .says(&["nod"]);
    for pose in ["compress", "twist", "pinch"] {
        let (from, to) = (
            format!("{{ {pose} = 1.0 }}"),
            format!("{{ {pose} = 0.01 }}"),
        );
        folder.change("arm/scene.toml", &from, &to);
    }
    folder
        .ruga("plan arm/scene.toml --image plan.png")
        .exits(2)
        .says(&["nothing wrinkles"]);
    let files = folder.files(".");
    assert!(!files.iter().any(|file| file.contains("plan")), "{files:?}");
}
