//! What the planner decides.

mod patch;

use nalgebra::Vector2;
use patch::{SIDE, draft, driver, pose, skin};
use ruga_stepper::{
    Coupling, Mask, Modelling, Observer, Plan, PlannedFace, PoseSpec, Progress, Region,
    StepperError, Treatment, plan,
};

#[test]
fn only_what_can_wrinkle_is_planned() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let poses = [pose(&driver, "press", 1.0), pose(&driver, "press", 0.2)];
    let plan = plan(&driver, &layers, &poses, &draft(), 1024).unwrap();
    let strong = &plan.poses[0].layers[0];
    assert!(strong.active_area > 0.3 * SIDE * SIDE);
    let strained = strong.applied.expect("a layer on a driver");
    assert!((strained.p99 - 0.12).abs() < 0.005, "{}", strained.p99);
    assert!(strong.points_per_wavelength > 5.4);
    assert!(strong.vertices > 100 && strong.seconds > 0.0 && strong.memory > 0.0);
    assert!((strong.texels_per_wavelength - 1024.0 * strong.wavelength / SIDE).abs() < 2.0);
    assert!(!plan.active_triangles(0).is_empty());
    let weak = &plan.poses[1].layers[0];
    assert_eq!((weak.active_area, weak.vertices), (0.0, 0));
    assert!(plan.active_triangles(1).is_empty());
}

#[test]
fn a_mask_limits_the_region_and_a_black_one_is_an_error() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let poses = [pose(&driver, "press", 1.0)];
    let with_mask = |values: Vec<f32>| {
        let region = Region::Mask(Mask::new(2, 1, values).expect("two pixels"));
        plan(
            &driver,
            &layers,
            &poses,
            &Modelling { region, ..draft() },
            1024,
        )
    };
    let [white, left, right] =
        [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(|values| with_mask(values.to_vec()).unwrap());
    let area = |plan: &Plan| plan.poses[0].layers[0].active_area;
    for half in [&left, &right] {
        let share = area(half) / area(&white);
        assert!((share - 0.5).abs() < 0.05, "{share}");
    }
    // Triangles are numbered as in the file, whatever part of it is looked at; 24 to a row.
    let all = white.active_triangles(0);
    let is_left = |triangle: &u32| triangle % 24 < 12;
    let (on_left, on_right): (Vec<u32>, Vec<u32>) = all.into_iter().partition(is_left);
    assert_eq!(left.active_triangles(0), on_left);
    assert_eq!(right.active_triangles(0), on_right);
    assert!(matches!(
        with_mask(vec![0.0, 0.0]),
        Err(StepperError::BlackMask { .. })
    ));
}

#[test]
fn all_takes_everything_that_is_not_folded() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let modelling = Modelling {
        region: Region::All,
        ..draft()
    };
    let poses = [pose(&driver, "press", 0.1), pose(&driver, "fold", 1.0)];
    let plan = plan(&driver, &layers, &poses, &modelling, 1024).unwrap();
    assert!((plan.poses[0].layers[0].active_area / (SIDE * SIDE) - 1.0).abs() < 1e-9);
    let folded = &plan.poses[1].layers[0];
    assert_eq!(folded.active_area, 0.0);
    let on_driver = folded.applied.expect("a layer on a driver");
    assert!((on_driver.folded_area / (SIDE * SIDE) - 1.0).abs() < 1e-9);
    assert!(
        plan.warnings.iter().any(|w| w.contains("fold over")),
        "{:?}",
        plan.warnings
    );
}

#[test]
fn the_budget_stops_refinement_and_names_remedies() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let modelling = Modelling {
        vertex_budget: 3000,
        points_per_wavelength: 24.0,
        ..draft()
    };
    let plan = plan(
        &driver,
        &layers,
        &[pose(&driver, "press", 1.0)],
        &modelling,
        1024,
    )
    .unwrap();
    assert!(plan.poses[0].layers[0].vertices <= 3000);
    let warning = plan.warnings.join("\n");
    for word in ["budget of 3000", "mask", "critical strain", "draft"] {
        assert!(warning.contains(word), "{warning}");
    }
}

/// Ends the work with the first iteration: by then the mesh is there.
struct Hasty;

impl Observer for Hasty {
    fn progress(&mut self, _: Progress) -> bool {
        false
    }
}

/// Skin that is squeezed in both directions wrinkles in both, on a mesh that is as fine in both.
#[test]
fn the_planned_mesh_is_the_one_that_is_made() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    for (points, shape) in [(12.0, "press"), (12.0, "squeeze"), (8.0, "press")] {
        let poses = [pose(&driver, shape, 1.0)];
        let modelling = Modelling {
            points_per_wavelength: points,
            ..Modelling::default()
        };
        let plan = plan(&driver, &layers, &poses, &modelling, 1024).unwrap();
        let made = plan.simulate(0, &mut Hasty).unwrap();
        let (planned, made) = (plan.poses[0].layers[0].vertices, made.layers[0].vertices);
        let ratio = made as f64 / planned as f64;
        println!("{shape} at {points} points: {made} vertices, {planned} planned");
        assert!((0.75..1.5).contains(&ratio), "{shape} at {points}: {ratio}");
    }
}

#[test]
fn few_texels_are_warned_about() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let plan = plan(
        &driver,
        &layers,
        &[pose(&driver, "press", 1.0)],
        &draft(),
        16,
    )
    .unwrap();
    assert!(
        plan.warnings
            .iter()
            .any(|w| w.contains("texels per wavelength"))
    );
}

#[test]
fn a_scene_without_layers_is_refused() {
    let driver = driver();
    let result = plan(&driver, &[], &[pose(&driver, "press", 1.0)], &draft(), 1024);
    assert!(matches!(result, Err(StepperError::NoLayer)));
    let mut bad = skin("forehead-furrow", Coupling::Hybrid);
    bad.material.thickness = -1.0;
    let result = plan(
        &driver,
        &[bad],
        &[pose(&driver, "press", 1.0)],
        &draft(),
        1024,
    );
    assert!(matches!(result, Err(StepperError::Material { .. })));
}

#[test]
fn labyrinths_under_rows_are_warned_about() {
    let driver = driver();
    for (shape, coupling, is_said) in [
        ("squeeze", Coupling::Hybrid, true),
        ("squeeze", Coupling::Elastic, false),
        ("press", Coupling::Hybrid, false),
    ] {
        let layers = [skin("forehead-furrow", coupling)];
        let poses = [pose(&driver, shape, 1.0)];
        let plan = plan(&driver, &layers, &poses, &draft(), 1024).unwrap();
        let says = |w: &String| w.contains("equally from all sides");
        assert_eq!(
            plan.warnings.iter().any(says),
            is_said,
            "{:?}",
            plan.warnings
        );
    }
}

#[test]
fn wrinkles_that_are_gone_at_the_last_key_are_told() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Elastic)];
    for (keys, is_said) in [(vec![0.5, 1.0], true), (vec![1.0], false)] {
        let poses = [PoseSpec {
            keys,
            ..pose(&driver, "turn", 1.0)
        }];
        let plan = plan(&driver, &layers, &poses, &draft(), 1024).expect("a valid scene");
        let text = plan.warnings.join("\n");
        // Half way it is 13 % smaller.
        for words in ["36.0 cm2 wrinkle at an earlier key", "with `keys = [1.0]`"] {
            assert_eq!(text.contains(words), is_said, "{text}");
        }
    }
}

#[test]
fn a_plan_shows_where_and_how_skin_will_wrinkle() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let poses = [pose(&driver, "press", 1.0), pose(&driver, "fold", 1.0)];
    let plan = plan(&driver, &layers, &poses, &draft(), 1024).expect("a valid scene");
    let surface = plan.surface().expect("a planned scene").expect("no body");
    let pressed = surface.faces(0, 0);
    let planned = &plan.poses[0].layers[0];
    // Of the whole map, the share of what is simulated.
    let area = |face: &PlannedFace| {
        let [a, b, c] = face.uvs;
        0.5 * (b - a).perp(&(c - a)).abs()
    };
    let simulated = pressed
        .iter()
        .filter(|face| face.treatment != Treatment::Smooth);
    let share: f64 = simulated.map(area).sum();
    assert!(
        (share * SIDE * SIDE / planned.active_area - 1.0).abs() < 0.01,
        "{share}"
    );
    // In the middle 12 % are taken from x: waves across x, as many to the map as fit.
    let is_in_the_middle = |face: &&PlannedFace| (face.uvs[0] - Vector2::repeat(0.5)).amax() < 0.05;
    let middle = pressed
        .iter()
        .find(is_in_the_middle)
        .expect("a face in the middle");
    let wave = planned.wavelength / SIDE;
    assert!(
        (middle.across.x.abs() / wave - 1.0).abs() < 0.02,
        "{middle:?}"
    );
    assert!(
        (middle.along.y.abs() / wave - 1.0).abs() < 0.02,
        "{middle:?}"
    );
    assert!(middle.across.y.abs() < 0.02 * wave && middle.along.x.abs() < 0.02 * wave);
    let ratio = 0.12 / planned.critical_strain;
    assert!(
        (middle.strain_ratio / ratio - 1.0).abs() < 0.05,
        "{middle:?}"
    );
    let folded = surface.faces(1, 0);
    assert!(
        folded
            .iter()
            .all(|face| face.treatment == Treatment::Folded)
    );
    assert!(surface.faces(0, 1).is_empty());
}

/// What the planner says of one pose.
fn told(shape: &str, weight: f64, layers: &[ruga_stepper::LayerSpec]) -> String {
    let driver = driver();
    let poses = [pose(&driver, shape, weight)];
    let plan = plan(&driver, layers, &poses, &draft(), 1024).expect("a valid scene");
    plan.warnings.join("\n")
}

#[test]
fn a_pose_that_is_no_skin_any_more_is_answered_with_a_weight() {
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    // 45 % shorter everywhere.
    let told = told("fold", 0.3, &layers);
    for words in [
        "compressed by more than 45 %",
        "not skin any more",
        "did you mean a weight of 0.1 instead of 0.3?",
    ] {
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn a_layer_that_no_pose_wrinkles_is_told_once_and_why() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let said = |layers: &[ruga_stepper::LayerSpec], weights: &[f64]| {
        let poses: Vec<_> = weights.iter().map(|w| pose(&driver, "press", *w)).collect();
        plan(&driver, layers, &poses, &draft(), 1024).expect("a valid scene")
    };
    let none = said(&layers, &[0.1, 0.2]);
    let text = none.warnings.join("\n");
    for words in [
        "layer 'skin' wrinkles in none of 2 poses",
        "it wrinkles from 4.5 % compression on",
        "by at most 2.3 %",
    ] {
        assert!(text.contains(words), "{text}");
    }
    let strain = none.poses[1].layers[0]
        .applied
        .expect("a layer on a driver");
    assert!((strain.p99 - 0.024).abs() < 1e-3, "{}", strain.p99);
    let one = said(&layers, &[0.1]).warnings.join("\n");
    assert!(
        one.contains("layer 'skin' does not wrinkle in pose 'press'"),
        "{one}"
    );
    // Some of the shapes of a face wrinkle nothing, as they should.
    let some = said(&layers, &[0.2, 1.0]).warnings.join("\n");
    assert!(
        !some.contains("wrinkle in") && !some.contains("wrinkles in"),
        "{some}"
    );
    let mut soft = layers[0].clone();
    soft.material.young *= 1e-6;
    let unit = said(&[soft], &[0.5, 1.0]).warnings;
    let [only] = unit.as_slice() else {
        panic!("{unit:?}");
    };
    for words in [
        "which no skin bears",
        "`young` is in pascals (0.8 MPa is 0.8e6)",
    ] {
        assert!(only.contains(words), "{only}");
    }
}

/// The patch is pressed most in its middle, all the way across; its shapes move the sides.
#[test]
fn areas_have_a_place() {
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let told = told("press", 1.6, &layers);
    let place = told.split(" at u ").nth(1).expect("a place");
    let numbers: Vec<f64> = place
        .split([' ', ','])
        .filter_map(|word| word.parse().ok())
        .take(4)
        .collect();
    let [left, right, top, bottom] = numbers[..] else {
        panic!("{told}");
    };
    assert!(
        (0.2..0.4).contains(&left) && (0.6..0.8).contains(&right),
        "{told}"
    );
    assert!((top, bottom) == (0.0, 1.0), "{told}");
    assert!(told.contains("(near where blend shape '"), "{told}");
    assert!(told.contains("The map can be used there"), "{told}");
}

#[test]
fn waves_that_no_budget_resolves_are_a_question_of_units() {
    let fine = skin("forehead-furrow", Coupling::Hybrid);
    let mut thin = fine.clone();
    thin.material.thickness *= 1e-4;
    let told = told("press", 1.0, &[thin]);
    assert!(told.contains("check the unit of the mesh"), "{told}");
    assert!(!told.contains("0.00 of the"), "{told}");
}
