//! Crease lines that can be used and may not be meant: each kind is told once, over what it is true of.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::creased_skin::{LAYER, Site, crease, says, with_line};
use ruga_scene::{Scene, SceneOptions};

const POSES: &str = "[[poses]]\nname = \"frown\"\nweights = { press = 0.1 }\n[[poses]]\nname = \"smile\"\n\
                     weights = { pull = 0.1 }\n";

/// Warnings of the plan of one pose, or of all.
fn planned(site: &Site, text: &str, pose: Option<&str>) -> Vec<String> {
    let text = format!("version = 1\n[driver]\nmesh = \"skin.gltf\"\n{LAYER}{text}{POSES}");
    let options = SceneOptions {
        poses: pose.iter().map(|&pose| pose.to_owned()).collect(),
        ..SceneOptions::default()
    };
    let scene = Scene::read_with(&site.0.file("scene.toml", text), &options).unwrap();
    let plan = scene.plan().unwrap();
    let told = plan
        .warnings()
        .filter(|text| text.contains("no pose folds"));
    told.cloned().collect()
}

#[test]
fn creases_that_no_pose_folds_are_told_of_over_all_poses() {
    let site = Site::new();
    let driven = |by: &str| {
        let more = format!("drive = \"weights\"\nweights = {{ {by} = 10.0 }}");
        // Along the pull, so that no pose folds it by itself.
        with_line(&format!("uv = [[0.1, 0.5], [0.35, 0.5]]\n{more}"))
    };
    for pose in [None, Some("frown"), Some("smile")] {
        assert_eq!(planned(&site, &driven("press"), pose), [""; 0]);
    }
    // A factor below 0 takes strength away, and this line has none to begin with.
    let never = driven("pull").replace("10.0", "-10.0");
    let told = planned(&site, &never, None);
    assert!(told[0].contains("no pose folds 'line'"), "{told:?}");
    assert_eq!(planned(&site, &never, Some("smile")), [""; 0]);
}

#[test]
fn strokes_too_close_to_each_other_are_told_of_once() {
    let site = Site::new();
    // Nearer to each other from left to right.
    let columns = [400, 416, 430, 442, 452];
    site.paint("lines.png", 2048, |x, y| {
        (600..1200).contains(&y) && columns.contains(&x)
    });
    let line = with_line("image = \"lines.png\"");
    let words = "`creases[0].image`: 6 pairs of lines, or of parts of one, come closer than two edges of the mesh, \
                 0.72 mm each; the closest: | crease `line-4` and crease `line-5` come within 0.54 mm | from the \
                 start of the first | move them apart";
    site.warns(&line, words);
}

#[test]
fn lines_beside_the_border_are_told_of() {
    let site = Site::new();
    let beside = |u: f64| with_line(&format!("uv = [[{u}, 0.2], [{u}, 0.8]]"));
    // A millimetre is 0.009 of the texture.
    let words = "crease `line` comes within 0.22 mm of the border of the surface, between 0.00 and 66.67 mm from its \
                 start | less than an edge of the mesh | inwards";
    site.warns(&beside(0.002), words);
    assert_eq!(site.lines(&beside(0.05)).len(), 1);
    let grazing = "uv = [[0.1, 0.3], [0.002, 0.5], [0.1, 0.7]]\ncorners = \"keep\"";
    site.warns(&with_line(grazing), "within 0.22 mm of the border");
    let short = "uv = [[0.002, 0.5], [0.002, 0.53]]\nfade = [0, 0]";
    site.warns(&with_line(short), "within 0.22 mm of the border");
    let flat = "uv = [[0.0, 0.3], [0.02, 0.6]]";
    site.warns(&with_line(flat), "within 0.00 mm of the border");

    // Lines that run out there.
    for end in ["[0.0, 0.5]", "[0.0, 0.4]", "[0.003, 0.5]"] {
        let line = format!("uv = [{end}, [0.2, 0.5]]");
        assert_eq!(site.lines(&with_line(&line)).len(), 1);
        let line = format!("uv = [[0.2, 0.5], {end}]");
        assert_eq!(site.lines(&with_line(&line)).len(), 1);
    }
    // The seam between the islands is no border.
    assert_eq!(site.lines(&beside(0.449)).len(), 1);

    site.paint("lines.png", 2048, |x, y| {
        (600..1200).contains(&y) && [2, 2043].contains(&x)
    });
    let strokes = with_line("image = \"lines.png\"");
    let right = "[[creases]]\nname = \"right\"\nuv = [[0.998, 0.2], [0.998, 0.8]]\n";
    site.warns(
        &[&crease("middle", ""), right].concat(),
        "crease `right` comes within 0.22 mm of the border",
    );
    let words = "`creases[0].image`: 2 lines come closer to the border of the surface than an edge of the mesh; \
                 the closest: crease `line-";
    site.warns(&strokes, words);
}

#[test]
fn memory_of_what_the_scene_does_not_have_is_refused() {
    let site = Site::new();
    let read = |memory: &str| site.read_all(&format!("{LAYER}{POSES}[memory]\n{memory}\n"));
    let words = "memory.poses[1] | no pose `smirk`; accepted: `frown`, `smile`";
    says(read("poses = [\"smile\", \"smirk\"]"), words);
    assert!(read("poses = [\"smile\"]").is_ok());
    let words = "memory.weakening | found 1e300; accepted: a number from 0 to 100";
    says(read("weakening = 1e300"), words);
    for bad in ["100.5", "-0.1", "nan", "inf"] {
        says(
            read(&format!("weakening = {bad}")),
            "memory.weakening | from 0 to 100",
        );
    }
    assert!(read("weakening = 100.0").is_ok());
}
