//! Lines of a scene that have aged: each has the memory of the line that lay where it lies.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::creased_skin::{LAYER, Site, says, with_line};
use ruga_scene::{CreaseFolds, LayerFolds, PoseFolds, Scene};
use ruga_stepper::CreaseSpec;
use serde_json::Value;

const MEMORY: &str = "[memory]\nnetwork = \"aged.json\"\n";

/// Angle that creases give back by default, rad.
const YIELD: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Ages a scene of these creases by a pose that folds a line at a share of its length by `fold` (rad) beyond what it
/// gives back, and writes what it keeps.
fn age(site: &Site, creases: &str, fold: impl Fn(&CreaseSpec, f64) -> f64) {
    let scene = site.read(creases).unwrap();
    let folds = scene.layers[0].creases.iter().map(|crease| CreaseFolds {
        name: crease.name.clone(),
        along: (0..=40)
            .map(|i| f64::from(i) / 40.0)
            .map(|share| [share, YIELD + fold(crease, share), 0.0, 1e-3])
            .collect(),
    });
    let pose = PoseFolds {
        pose: "frown".to_owned(),
        layers: vec![LayerFolds {
            layer: "skin".to_owned(),
            creases: folds.collect(),
            valleys: Vec::new(),
        }],
    };
    let path = site.0.path("aged.json");
    scene.network(&[pose]).write(&path).unwrap();
}

/// Changes the creases of the network's file.
fn edit(site: &Site, change: impl FnOnce(&mut Vec<Value>)) {
    let path = site.0.path("aged.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut network: Value = serde_json::from_str(&text).unwrap();
    change(network["creases"].as_array_mut().unwrap());
    std::fs::write(&path, network.to_string()).unwrap();
}

/// A scene of these creases that has aged.
fn aged(site: &Site, creases: &str) -> Scene {
    site.read_all(&format!("{LAYER}{creases}{MEMORY}")).unwrap()
}

fn refuses(site: &Site, creases: &str, words: &str) {
    let read = site.read_all(&format!("{LAYER}{creases}{MEMORY}"));
    says(read, &format!("memory.network | aged.json | {words}"));
}

/// U (m) of the middle of a line on the left island, and the angle that it keeps there, by line.
fn kept(scene: &Scene) -> Vec<(f64, f64)> {
    let driver = &scene.driver;
    let lines = scene.layers[0].creases.iter().map(|crease| {
        let place = crease.line.place(0.5 * crease.line.length()).unwrap();
        let place = place.interpolate(driver.topology(), driver.rest());
        (place.x, crease.memory.at(0.5).angle)
    });
    lines.collect()
}

/// Paints upright strokes of the same length.
fn paint(site: &Site, columns: &[u32]) {
    site.paint("lines.png", 2048, |x, y| {
        (600..1200).contains(&y) && columns.contains(&x)
    });
}

#[test]
fn a_new_stroke_takes_no_other_ones_memory() {
    let site = Site::new();
    let strokes = with_line("image = \"lines.png\"");
    paint(&site, &[400, 700]);
    age(&site, &strokes, |crease, _| {
        if crease.name == "line-1" { 0.4 } else { 0.8 }
    });
    let [left, right] = [0, 1].map(|i| kept(&aged(&site, &strokes))[i]);
    assert!(left.0 < right.0 && (left.1 - 0.4).abs() < 1e-9 && (right.1 - 0.8).abs() < 1e-9);

    // The first of three by number.
    paint(&site, &[100, 400, 700]);
    let scene = aged(&site, &strokes);
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(kept(&scene)[1..], [left, right]);
    assert_eq!(kept(&scene)[0].1, 0.0);

    // One alone has no number.
    paint(&site, &[700]);
    refuses(
        &site,
        &strokes,
        "`creases[0]`, `line-1` | no crease lies where it was | the nearest of the scene, `line`",
    );
    age(&site, &strokes, |_, _| 0.8);
    paint(&site, &[400, 700]);
    let found = kept(&aged(&site, &strokes));
    assert_eq!(found[0].1, 0.0);
    assert!((found[1].1 - 0.8).abs() < 1e-9);
}

#[test]
fn a_stroke_too_short_for_a_coarser_mesh_is_left_out() {
    let site = Site::new();
    let strokes = with_line("image = \"lines.png\"");
    let paint = |short: bool| {
        site.paint("lines.png", 2048, |x, y| {
            let long = (600..1200).contains(&y) && x == 400;
            long || (short && (600..660).contains(&y) && x == 700)
        });
    };
    paint(true);
    age(&site, &strokes, |_, _| 0.5);
    paint(false);
    let told = aged(&site, &strokes).warnings;
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].contains("not there any more, or too short for this mesh"),
        "{told:?}"
    );
}

#[test]
fn a_line_that_was_moved_is_refused() {
    let site = Site::new();
    let line = |u: f64| with_line(&format!("uv = [[{u}, 0.2], [{u}, 0.8]]"));
    age(&site, &line(0.2), |_, _| 0.5);
    // A quarter of a wavelength of 8.6 mm is 0.019 of the texture.
    assert_eq!(aged(&site, &line(0.21)).warnings, [""; 0]);
    let words = "`creases[0]`, `line` | no crease lies where it was | a quarter of a wavelength | along it was at \
                 (22.2, | the nearest of the scene, `line`, is at (26.7, | `ruga age`";
    refuses(&site, &line(0.24), words);
    // As long, and a piece further on.
    refuses(
        &site,
        &with_line("uv = [[0.2, 0.25], [0.2, 0.85]]"),
        "no crease lies where it was",
    );
}

#[test]
fn a_line_drawn_the_other_way_round_has_its_memory_turned() {
    let site = Site::new();
    let line =
        |ends: [f64; 2]| with_line(&format!("uv = [[0.2, {}], [0.2, {}]]", ends[0], ends[1]));
    age(&site, &line([0.2, 0.8]), |_, share| share);
    let at = |scene: &Scene, share: f64| scene.layers[0].creases[0].memory.at(share).angle;
    let [there, back] = [[0.2, 0.8], [0.8, 0.2]].map(|ends| aged(&site, &line(ends)));
    for share in [0.25, 0.4, 0.75] {
        assert!((at(&there, share) - share).abs() < 1e-9);
        assert!((at(&back, share) - (1.0 - share)).abs() < 1e-9);
    }
}

#[test]
fn a_ring_may_begin_elsewhere_and_run_the_other_way_round() {
    let site = Site::new();
    let corners = ["[0.1, 0.4]", "[0.3, 0.4]", "[0.3, 0.6]", "[0.1, 0.6]"];
    let ring = |order: [usize; 4]| {
        let points = order.map(|i| corners[i]).join(", ");
        with_line(&format!(
            "uv = [{points}]\nclosed = true\ncorners = \"keep\""
        ))
    };
    // Farther from the first corner, more.
    age(&site, &ring([0, 1, 2, 3]), |_, share| {
        2.0 * share.min(1.0 - share)
    });
    let at = |order: [usize; 4], share: f64| {
        aged(&site, &ring(order)).layers[0].creases[0]
            .memory
            .at(share)
            .angle
    };
    for share in [0.1_f64, 0.3, 0.8] {
        let is = |found: f64, from_first: f64| {
            let right = 2.0 * from_first.min(1.0 - from_first);
            assert!((found - right).abs() < 0.02, "{share}: {found} for {right}");
        };
        is(at([0, 1, 2, 3], share), share);
        is(at([2, 3, 0, 1], share), (share + 0.5).rem_euclid(1.0));
        is(at([0, 3, 2, 1], share), 1.0 - share);
        is(at([2, 1, 0, 3], share), (0.5 - share).rem_euclid(1.0));
    }
}

#[test]
fn a_network_without_places_goes_by_names_and_is_told_of() {
    let site = Site::new();
    let line = with_line("uv = [[0.2, 0.2], [0.2, 0.8]]");
    age(&site, &line, |_, _| 0.5);
    edit(&site, |creases| {
        let crease = creases[0].as_object_mut().unwrap();
        crease.remove("places_m").unwrap();
    });
    let scene = aged(&site, &line);
    assert!((kept(&scene)[0].1 - 0.5).abs() < 1e-9);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("did not note where `line` lies"));
}

#[test]
fn names_of_new_lines_are_as_those_of_creases() {
    let site = Site::new();
    let line = with_line("uv = [[0.2, 0.2], [0.2, 0.8]]");
    let with_new = |names: [&str; 2]| {
        age(&site, &line, |_, _| 0.5);
        edit(&site, |creases| {
            for (name, x) in names.into_iter().zip([0.06, 0.08]) {
                let mut new = creases[0].clone();
                new["name"] = name.into();
                new["places_m"] = serde_json::json!([]);
                new["length_m"] = 0.04.into();
                new["points_m"] = serde_json::json!([[x, -0.03, 0.0], [x, -0.07, 0.0]]);
                creases.push(new);
            }
        });
    };
    with_new(["one", "two"]);
    assert_eq!(aged(&site, &line).layers[0].creases.len(), 3);
    for (names, words) in [
        (
            ["a/b", "two"],
            "`a/b` | part of a file name | it has one of",
        ),
        (["con", "two"], "`con` | Windows reserves"),
        (["", "two"], "`name` | it is empty"),
        (["Line", "two"], "`line` and `Line` | letter case"),
        (["one", "One"], "`one` and `One` | letter case"),
        (["one", "one"], "`one` is there twice"),
        (["line", "two"], "`line` is there twice"),
    ] {
        with_new(names);
        refuses(&site, &line, words);
    }
}
