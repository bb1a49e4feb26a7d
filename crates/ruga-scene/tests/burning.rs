//! Burning sheets of scenes: what the file says of a fire, the maps of what is left, and in which words mistakes are
//! told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{assert_says, folder_of_sheet as folder, read_scene as read};
use ruga_bake::Detail;
use ruga_scene::{Scene, SceneOptions};
use ruga_stepper::{Modelling, Silent};

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
fn steps_in_which_the_front_leaps_are_told_with_those_that_would_do() {
    let told = |time_step: &str| {
        let longer = scene().replace("time_step = 1.0", time_step);
        let plan = read(&folder(), &longer).unwrap().plan().unwrap();
        let mut warnings = plan.warnings();
        let told = warnings.find(|warning| warning.contains("goes on by"));
        told.cloned()
    };
    assert_eq!(told("time_step = 2.4"), None);
    let warning = told("time_step = 2.6").unwrap();
    assert!(
        warning.contains("`time_step` of at most 2.50 s"),
        "{warning}"
    );
}

/// The lower half of the texture burns twice as fast as the upper one, and does not curl where that does; in blue
/// half of the shrinkage is painted away on the right.
#[test]
fn what_is_painted_of_a_fire_comes_through_a_bake() {
    let folder = folder();
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 8, 8);
    encoder.set_color(png::ColorType::Rgb);
    let white = |is_white: bool| if is_white { 255 } else { 0 };
    let texel = |i: usize| [white(i >= 32), white(i < 32), white(i % 8 < 4)];
    let texels: Vec<u8> = (0..64).flat_map(texel).collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&texels).unwrap();
    writer.finish().unwrap();
    folder.file("painted.png", image);
    let map = "asymmetry = 0.02\nmap = { image = \"painted.png\", speed = [0.5, 1.0], asymmetry = [0.0, 1.0], shrink = [0.5, 1.0] }\n";
    // The whole right side is hot.
    let edge = "[[burn.sources]]\nname = \"bar\"\nsphere = { centre = [0.14, 0.02, 0.0], radius = 0.106 }\ntemperature = 1500.0\n";
    let rest = REST.replace("time_step = 1.0", "time_step = 2.0");
    let text = format!("{TOP}{LAYER}{SHEET}{BURN}{map}{edge}{rest}");
    let scene = read(&folder, &text).unwrap();
    let result = scene.plan().unwrap().simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let key = result.keys.last().unwrap();
    let finite = |x: &nalgebra::Vector3<f64>| x.iter().all(|c| c.is_finite());
    assert!(key.artist_positions.as_ref().unwrap().iter().all(finite));
    let map = &scene.bake_key(&scene.poses[0], key).unwrap()[0];
    assert!(map.normals.iter().flatten().all(|c| c.is_finite()));
    let char = map.detail(Detail::Char).unwrap();
    assert!(char.iter().all(|c| (0.0..=1.0).contains(c)));
    // Away from the border between the halves, how much of each has burnt.
    let burnt = |rows: std::ops::Range<usize>| {
        let texels = &char[64 * rows.start..64 * rows.end];
        f64::from(texels.iter().sum::<f32>()) / texels.len() as f64
    };
    let [slow, fast] = [burnt(4..20), burnt(44..60)];
    assert!(fast > slow + 0.1 && slow > 0.05, "{slow} {fast}");
}

#[test]
fn a_draft_has_a_coarser_mesh_of_temperature() {
    let folder = folder();
    let text = scene().replace("edges_per_width = 2\n", "");
    folder.file("scene.toml", text);
    let edges = |points: Option<f64>| {
        let options = SceneOptions {
            points_per_wavelength: points,
            ..SceneOptions::default()
        };
        let scene = Scene::read_with(&folder.path("scene.toml"), &options).unwrap();
        scene.sheet.unwrap().fire.unwrap().edges_per_width
    };
    let [draft, standard, fine] = [Modelling::draft(), Modelling::standard(), Modelling::fine()]
        .map(|modelling| edges(Some(modelling.points_per_wavelength)));
    assert_eq!([draft, standard, fine, edges(None)], [2.0, 4.0, 8.0, 4.0]);
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
