//! What `plan` says of layers that lie on each other.

mod fixture;

use fixture::Folder;
use serde_json::Value;

/// The layers of Li 2014, 5.2, five times as thick: nothing but lengths changes, and a coarse
/// surface is enough to plan on.
const PAIR: &str = r#"[substrate]
young = 0.5e6
poisson = 0.48
thickness = 75e-3

[[layers]]
name = "dermis"
young = 4e6
poisson = 0.48
thickness = 6.5e-3

[[layers]]
name = "epidermis"
young = 600e6
poisson = 0.48
thickness = 0.6e-3

[[poses]]"#;

/// The scene with two layers in place of its one.
fn with_pair() -> Folder {
    let folder = Folder::new();
    let scene = String::from_utf8(folder.read("scene.toml")).expect("text");
    let (before, rest) = scene.split_once("[substrate]").expect("it has one");
    let (_, after) = rest.split_once("[[poses]]").expect("it has one");
    folder.write("scene.toml", format!("{before}{PAIR}{after}"));
    folder
}

fn planned_pairs(folder: &Folder) -> Value {
    let json = folder.ruga("plan scene.toml --json").exits(0).stdout;
    let plan: Value = serde_json::from_str(&json).expect("JSON");
    plan["pairs"].clone()
}

fn assert_near(value: &Value, expected: f64, tolerance: f64) {
    let found = value.as_f64().expect("a number");
    let error = (found / expected - 1.0).abs();
    assert!(error < tolerance, "{found} instead of {expected}");
}

#[test]
fn plan_says_what_two_layers_do_together() {
    let folder = with_pair();
    let run = folder.ruga("plan scene.toml").exits(0);
    for text in ["epidermis on dermis", "13.85", "large", "0.067"] {
        assert!(run.stdout.contains(text), "no `{text}` in:\n{}", run.stdout);
    }
    run.says(&["would wrinkle together every 61."]);
    let pairs = planned_pairs(&folder);
    let [pair] = pairs.as_array().unwrap().as_slice() else {
        panic!("one pair, not {pairs}");
    };
    assert_eq!([&pair["lower"], &pair["upper"]], ["dermis", "epidermis"]);
    let membrane_ratio = 600.0 * 0.12 / (4.0 * 1.3);
    assert_near(&pair["membrane_ratio"], membrane_ratio, 1e-9);
    assert_near(
        &pair["bending_transfer"],
        1.0 / (1.0 + membrane_ratio),
        1e-9,
    );
    assert_near(&pair["force_ratio"], 2.1, 0.02);
    // The exact elastic stack of three: every 12.2 mm, times five, from 1.20 % on.
    assert_near(&pair["joint_wavelength_m"], 5.0 * 12.2e-3, 0.04);
    assert_near(&pair["joint_critical_strain"], 0.012, 0.04);
    assert_eq!(pair["first_scale"], "large");
}

#[test]
fn a_thin_film_wrinkles_before_what_carries_it() {
    let folder = with_pair();
    folder.change("scene.toml", "600e6", "200e6");
    folder.change("scene.toml", "0.6e-3", "0.2e-3");
    let pair = &planned_pairs(&folder)[0];
    assert_eq!(pair["first_scale"], "fine");
    assert_near(&pair["joint_critical_strain"], 0.064, 0.04);
}

#[test]
fn layers_without_a_joint_wave_say_so() {
    // On ground that is nearly as stiff as itself, the lower layer alone would hold out to 30 %.
    let folder = with_pair();
    folder.change("scene.toml", "0.5e6", "2e6");
    let run = folder.ruga("plan scene.toml").exits(0);
    let row = run.stdout.lines().find(|line| line.contains(" on "));
    let cells: Vec<&str> = row.unwrap().split_whitespace().collect();
    assert_eq!(cells[5..8], ["-", "-", "fine"], "{}", run.stdout);
    let pair = &planned_pairs(&folder)[0];
    assert!(pair["joint_wavelength_m"].is_null() && pair["joint_critical_strain"].is_null());
}

#[test]
fn plan_prints_the_bending_transfer_that_is_used() {
    let transfer = |from: &str, to: &str| {
        let folder = with_pair();
        folder.change("scene.toml", from, to);
        planned_pairs(&folder)[0]["bending_transfer"].clone()
    };
    let composite = transfer("version = 1", "version = 1\nstack = \"composite\"");
    assert_eq!(composite, 1.0);
    let own = transfer("0.6e-3", "0.6e-3\nbending_transfer = 0.25");
    assert_eq!(own, 0.25);
}

#[test]
fn a_single_layer_has_no_pairs() {
    let folder = Folder::new();
    assert_eq!(planned_pairs(&folder), Value::Array(Vec::new()));
    let table = folder.ruga("plan scene.toml").exits(0).stdout;
    assert!(!table.contains("membrane ratio"), "{table}");
}
