//! `ruga plan --image` and `--preview`.

mod fixture;

use fixture::Folder;
use serde_json::Value;

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
fn a_page_has_an_overlay_for_every_pose_and_no_map() {
    let folder = forearm();
    let line = "plan arm/scene.toml --pose twist --pose pinch --preview out/plan.html";
    let run = folder.ruga(line).exits(0);
    let page = String::from_utf8(folder.read("out/plan.html")).expect("text");
    let element = |id: &str| {
        let (_, rest) = page.split_once(&format!("id=\"{id}\">"))?;
        Some(rest.split_once("</script>")?.0)
    };
    let about: Value = serde_json::from_str(element("about").expect("it")).expect("JSON");
    let poses = about["poses"].as_array().expect("a list");
    assert_eq!(poses.len(), 2);
    assert_eq!(poses[0]["name"], "twist");
    assert_eq!(poses[1]["plan"]["overlays"], serde_json::json!([1]));
    let note = poses[0]["plan"]["notes"][0].as_str().expect("a note");
    assert!(note.starts_with("skin: waves of 10.3 mm on "), "{note}");
    assert_eq!(about["plan"]["layers"], serde_json::json!(["skin"]));
    assert_eq!(about["plan"]["ramp"].as_array().expect("a ramp").len(), 4);
    assert_eq!(about["maps"], serde_json::json!([]));
    assert!(element("overlay1").is_some() && element("overlay2").is_none());
    // The page says in words what the table says.
    let total = run.stdout.lines().last().expect("a line");
    assert!(page.contains(total), "no `{total}`");
}

#[test]
fn what_cannot_be_drawn_is_told_and_nothing_is_written() {
    let folder = forearm();
    folder
        .ruga("plan arm/scene.toml --image plan.jpg")
        .exits(2)
        .says(&["plan.jpg", "PNG", "`.png`"]);
    folder
        .ruga("plan arm/scene.toml --preview plan.htm")
        .exits(2)
        .says(&["plan.htm", "HTML", "`.html`"]);
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
    for option in ["--image plan.png", "--preview plan.html"] {
        folder
            .ruga(&format!("plan arm/scene.toml {option}"))
            .exits(2)
            .says(&["nothing wrinkles"]);
    }
    let files = folder.files(".");
    assert!(!files.iter().any(|file| file.contains("plan")), "{files:?}");
}
