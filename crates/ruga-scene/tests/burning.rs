//! Burning sheets of scenes: what the file says of a fire, the maps of what is left, and in which words mistakes are
//! told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{assert_says, folder_of_sheet as folder, read_scene as read};
use ruga_bake::Detail;
use ruga_stepper::Silent;

const TOP: &str = "version = 1\n[driver]\nmesh = \"paper.obj\"\nsmoothing = \"none\"\n";
const LAYER: &str = "[[layers]]\nname = \"paper\"\nyoung = 3e9\npoisson = 0.3\nthickness = 1e-4\n";
const SHEET: &str = "[sheet]\nedge = 0.01\nhandles = [{ name = \"clip\", min = [-1, -1, -1], max = [0.001, 1, 1] }]\n";
const BURN: &str =
    "[burn]\nfront_speed = 2e-3\nfront_width = 5e-3\nedges_per_width = 2\nash_share = 0.2\n";
const MATCH: &str = "[[burn.sources]]\nname = \"match\"\nsphere = { centre = [0.04, 0.02, 0.0], radius = 0.01 }\ntemperature = 1500.0\n";
const REST: &str = "[[poses]]\nname = \"burn\"\nsteps = 6\n[solver]\nmode = \"dynamic\"\ntime_step = 1.0\n[bake]\nsize = 64\nmaps = [\"normal\", \"mask\", \"char\"]\n";

fn scene() -> String {
    format!("{TOP}{LAYER}{SHEET}{BURN}{MATCH}{REST}")
}

#[test]
fn a_fire_is_in_the_maps() {
    let scene = read(&folder(), &scene()).unwrap();
    let result = scene.plan().unwrap().simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let fire = result.layers[0].fire.as_ref().unwrap();
    let key = result.keys.last().unwrap();
    let map = &scene.bake_key(&scene.poses[0], key).unwrap()[0];
    let mean = |detail| {
        let values = map.detail(detail).unwrap();
        f64::from(values.iter().sum::<f32>()) / values.len() as f64
    };
    // The texture covers the square, so that means over the map are those over the sheet.
    let burnt = mean(Detail::Char);
    assert!(
        (burnt - (1.0 - fire.fuel_left)).abs() < 0.01,
        "{burnt} {fire:?}"
    );
    let left = mean(Detail::Mask);
    assert!(
        left > fire.fuel_left && left < 1.0 - 0.7 * burnt,
        "{left} {fire:?}"
    );
    // In the corner that burnt first nothing is left; the clip holds fresh paper.
    let at = |detail, u: usize, v: usize| map.detail(detail).unwrap()[v * 64 + u];
    assert_eq!(
        [at(Detail::Mask, 63, 32), at(Detail::Char, 63, 32)],
        [0.0, 1.0]
    );
    assert_eq!(
        [at(Detail::Mask, 1, 32), at(Detail::Char, 1, 32)],
        [1.0, 0.0]
    );
}

#[test]
fn mistakes_of_a_fire_are_told() {
    let folder = folder();
    let refused = |from: &str, to: &str, key: &str, accepted: &str| {
        let text = scene().replace(from, to);
        assert_ne!(text, scene(), "{from} is in the scene");
        let refused = read(&folder, &text).and_then(|scene| scene.plan().map(|_| ()));
        assert_says(refused, "scene.toml", &[key, accepted]);
    };
    refused(
        SHEET,
        "[substrate]\npreset = \"dermis\"\n",
        "burn",
        "[sheet]",
    );
    refused(
        "\"dynamic\"",
        "\"static\"",
        "solver.mode",
        "a fire takes time",
    );
    refused("2e-3", "0.0", "burn.front_speed", "a number above 0");
    refused(
        "5e-3",
        "0.03",
        "front_width",
        "half the sheet's longest side",
    );
    refused(
        "5e-3",
        "5e-3\nloss_time = 0.1",
        "front dies",
        "loss time above",
    );
    refused(
        "ash_share = 0.2",
        "ash_range = [0.1, 0.2]",
        "burn.ash_range",
        "`ash_image`",
    );
    refused(
        "\"match\"",
        "\"clip\"",
        "burn.sources[0].name",
        "different name",
    );
    let both = "image = \"paper.png\"\nsphere";
    refused(
        "sphere",
        both,
        "burn.sources[0]",
        "exactly one of sphere, image",
    );
    let nothing = format!("{TOP}{LAYER}{SHEET}gravity = [0.0, 0.0, -9.81]\n{REST}");
    let refused = read(&folder, &nothing);
    assert_says(
        refused.map(|_| ()),
        "scene.toml",
        &["bake.maps", "mask", "[burn]"],
    );
}
