//! Free sheets: held, falling, growing, curling, on obstacles.

mod flat_sheet;

use std::f64::consts::PI;
use std::sync::Arc;

use flat_sheet::{clamp, laid, paper, rectangle};
use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, Driver, Smoothing};
use ruga_material::{LaminatedSheet, SheetPly};
use ruga_shell::BendingModel;
use ruga_stepper::{
    Dynamics, Grows, GrowthDirection, GrowthSpec, Handle, Keyframe, LayerSpec, Modelling, Motion,
    Obstacle, ObstacleShape, PoseResult, PoseSpec, Sheet, Silent, StepperError, plan, plan_sheet,
};

fn growth(along: f64, across: f64, curl: [f64; 2]) -> GrowthSpec {
    GrowthSpec {
        name: "grow".into(),
        grows: Grows::Layer,
        along,
        across,
        curl,
        direction: GrowthDirection::Angle(0.0),
        paint: None,
    }
}

fn pose(steps: u32) -> PoseSpec {
    PoseSpec {
        name: "pose".into(),
        weights: Default::default(),
        keys: vec![1.0],
        steps,
        motions: Vec::new(),
        growths: vec![("grow".into(), 1.0)],
        half: false,
    }
}

fn free() -> Sheet {
    Sheet {
        gravity: Vector3::zeros(),
        handles: Vec::new(),
        obstacles: Vec::new(),
        edge: Some(1.0),
        fire: None,
    }
}

fn modelling(dynamics: Option<Dynamics>) -> Modelling {
    Modelling {
        dynamics,
        smoothing: Smoothing::None,
        ..Modelling::default()
    }
}

fn run(
    driver: &Arc<Driver>,
    layer: &LayerSpec,
    sheet: &Sheet,
    pose: PoseSpec,
    modelling: &Modelling,
) -> Result<PoseResult, StepperError> {
    plan_sheet(driver, layer, sheet, &[pose], modelling, 512)?.simulate(0, &mut Silent)
}

/// Positions of the artist's vertices at the last key, which has to be reached.
fn end(result: PoseResult) -> Vec<Vector3<f64>> {
    assert!(result.converged, "{:?}", result.warnings);
    let key = result.keys.last().expect("a key");
    key.artist_positions.clone().expect("a sheet carries them")
}

#[test]
fn a_strip_sags_as_a_beam_under_its_weight() {
    let length = 0.05;
    let driver = rectangle([length, 0.01], [40, 8]);
    let layer = paper(Vec::new());
    let gravity = 0.5;
    let sheet = Sheet {
        gravity: Vector3::new(0.0, 0.0, -gravity),
        handles: vec![clamp(0.0026)],
        ..free()
    };
    let places = end(run(&driver, &layer, &sheet, pose(2), &modelling(None)).expect("a run"));
    let tip = places
        .iter()
        .zip(driver.rest())
        .filter(|(_, rest)| rest.x > 0.999 * length);
    let sag: Vec<f64> = tip.map(|(x, _)| -x.z).collect();
    let sag = sag.iter().sum::<f64>() / sag.len() as f64;
    // Held up to the second row of vertices, it bends from there on; nearly half a face beyond that is held, too.
    let material = layer.material;
    let modulus = material.young * material.thickness.powi(3) / 12.0;
    let load = material.density * material.thickness * gravity;
    let beam = |free: f64| load * free.powi(4) / (8.0 * modulus);
    let expected = [beam(length - 0.0025), beam(length - 0.00125)];
    assert!(
        expected[0] * 0.98 < sag && sag < expected[1],
        "{sag} of {expected:?}"
    );
}

#[test]
fn curl_bends_a_strip_into_an_arc() {
    let length = 0.04;
    let driver = rectangle([length, 0.008], [40, 8]);
    let curl = 40.0;
    let layer = paper(vec![growth(0.0, 0.0, [curl, 0.0])]);
    let sheet = Sheet {
        handles: vec![clamp(0.0011)],
        ..free()
    };
    let places = end(run(&driver, &layer, &sheet, pose(4), &modelling(None)).expect("a run"));
    let tip = places
        .iter()
        .zip(driver.rest())
        .find(|(_, rest)| rest.x > 0.999 * length);
    let (tip, _) = tip.expect("an end");
    // The outer side, up, bulges: the strip bends down.
    let arc = curl * (length - 0.0005);
    let expected = [0.0005 + arc.sin() / curl, -(1.0 - arc.cos()) / curl];
    let error = ((tip.x - expected[0]).hypot(tip.z - expected[1])) / length;
    assert!(error < 0.02, "{tip:?} of {expected:?}");
}

/// Paper of two unlike plies, of which one grows.
fn plies(grows: Grows) -> LayerSpec {
    let ply = |young: f64, thickness: f64| SheetPly {
        young,
        thickness,
        density: 800.0,
    };
    let laminate = LaminatedSheet::new(&[ply(3e9, 4e-5), ply(1e9, 8e-5)], 0.0).expect("plies");
    let growth = GrowthSpec {
        grows,
        ..growth(2e-3, 0.0, [0.0; 2])
    };
    LayerSpec {
        material: *laminate.material(),
        laminate: Some(laminate),
        ..paper(vec![growth])
    }
}

#[test]
fn a_ply_that_grows_bends_to_its_side_or_the_other() {
    let driver = rectangle([0.04, 0.008], [40, 8]);
    let tip = |layer: &LayerSpec| {
        let sheet = Sheet {
            handles: vec![clamp(0.0011)],
            ..free()
        };
        let places = end(run(&driver, layer, &sheet, pose(4), &modelling(None)).expect("a run"));
        let mut pairs = places.iter().zip(driver.rest());
        let tip = pairs.find(|(_, rest)| rest.x > 0.0399).expect("an end");
        tip.0.z
    };
    let [lower, upper] = [0, 1].map(|ply| tip(&plies(Grows::Ply(ply))));
    assert!(upper < -5e-3, "{upper}");
    // Both plies bend it alike against each other, but for the mean length.
    assert!((lower / upper + 1.0).abs() < 0.01, "{lower} {upper}");
    assert!(tip(&plies(Grows::Layer)).abs() < 1e-9);
}

#[test]
fn plies_that_cannot_be_are_refused() {
    let driver = rectangle([0.02, 0.02], [8, 8]);
    let refuses = |layer: &LayerSpec, modelling: &Modelling, words: [&str; 3]| {
        let planned = plan_sheet(&driver, layer, &free(), &[pose(1)], modelling, 512);
        let text = planned.map(|_| ()).expect_err("a refusal").to_string();
        for word in words {
            assert!(text.contains(word), "{text}");
        }
    };
    let equilibria = modelling(None);
    let words = ["growth 'grow'", "Ply(2)", "a number below 2"];
    refuses(&plies(Grows::Ply(2)), &equilibria, words);
    let mut layer = plies(Grows::Ply(1));
    layer.material.young *= 2.0;
    let words = ["layer 'paper'", "`material`", "that of its laminate"];
    refuses(&layer, &equilibria, words);
    layer.laminate = None;
    let words = ["growth 'grow'", "Ply(1)", "which is no laminate"];
    refuses(&layer, &equilibria, words);
    let hinges = Modelling {
        bending: BendingModel::Hinge,
        ..modelling(None)
    };
    let words = ["pose 'pose'", "`growths`", "hinges, which cannot curl"];
    refuses(&plies(Grows::Ply(1)), &hinges, words);
    // Skin has no plies.
    let layers = [plies(Grows::Layer)];
    let planned = plan(&driver, &layers, &[pose(1)], &equilibria, 512);
    let text = planned.map(|_| ()).expect_err("a refusal").to_string();
    assert!(
        text.contains("2 plies") && text.contains("none but in a free sheet"),
        "{text}"
    );
}

#[test]
fn a_loose_sheet_grows_in_place_without_stress() {
    let driver = rectangle([0.02, 0.02], [8, 8]);
    let layer = paper(vec![growth(0.2, -0.1, [0.0; 2])]);
    let result = run(&driver, &layer, &free(), pose(2), &modelling(None)).expect("a run");
    let energy = result.layers[0].energy;
    let places = end(result);
    let [low, high] = [f64::min, f64::max].map(|pick| {
        let bound = |axis: usize| places.iter().map(|x| x[axis]).reduce(pick).expect("some");
        [bound(0), bound(1)]
    });
    let sides = [0, 1].map(|axis| (high[axis] - low[axis]) / 0.02);
    assert!(
        (sides[0] - 1.2).abs() < 1e-6 && (sides[1] - 0.9).abs() < 1e-6,
        "{sides:?}"
    );
    assert!(energy < 1e-9 * 3e9 * 1e-4 * 4e-4, "{energy}");
}

#[test]
fn what_nothing_holds_falls_as_implicit_euler_does() {
    let driver = rectangle([0.02, 0.02], [4, 4]);
    let time_step = 0.01;
    let sheet = Sheet {
        gravity: Vector3::new(0.0, -9.81, 0.0),
        ..free()
    };
    let dynamics = Dynamics {
        time_step,
        damping: 0.0,
    };
    let how = modelling(Some(dynamics));
    let places = end(run(&driver, &paper(Vec::new()), &sheet, pose(10), &how).expect("a run"));
    let expected = -9.81 * time_step * time_step * 55.0;
    for (x, rest) in places.iter().zip(driver.rest()) {
        let way = x - rest;
        assert!(
            (way.y / expected - 1.0).abs() < 1e-6,
            "{way:?} of {expected}"
        );
        assert!(way.x.abs() < 1e-9 && way.z.abs() < 1e-9);
    }
}

#[test]
fn a_sheet_that_falls_onto_a_ball_lies_on_it() {
    let driver = rectangle([0.03, 0.03], [12, 12]);
    let ball = ObstacleShape::Sphere {
        centre: Vector3::new(0.015, 0.015, -0.012),
        radius: 0.01,
    };
    let floor = ObstacleShape::Plane {
        point: Vector3::new(0.0, 0.0, -0.013),
        normal: Vector3::z(),
    };
    let obstacle = |name: &str, shape| Obstacle {
        name: name.into(),
        shape,
    };
    let sheet = Sheet {
        gravity: Vector3::new(0.0, 0.0, -9.81),
        obstacles: vec![obstacle("ball", ball), obstacle("floor", floor)],
        ..free()
    };
    let how = modelling(Some(Dynamics {
        time_step: 5e-3,
        damping: 2.0,
    }));
    // Cloth: a thousandth of paper's modulus.
    let mut layer = paper(Vec::new());
    layer.material.young = 3e6;
    let result = run(&driver, &layer, &sheet, pose(40), &how).expect("a run");
    let places = end(result);
    let lowest = places.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    let highest = places.iter().map(|x| x.z).fold(f64::NEG_INFINITY, f64::max);
    let centre = Vector3::new(0.015, 0.015, -0.012);
    let closest = places
        .iter()
        .map(|x| (x - centre).norm())
        .fold(f64::INFINITY, f64::min);
    assert!((-0.0021..-0.0015).contains(&highest), "{highest}");
    assert!(closest > 0.0099, "{closest}");
    assert!((-0.0131..-0.004).contains(&lowest), "{lowest}");
}

/// Ends moved towards each other within one step: the step is divided where it has to be, the held vertices are where
/// the motion puts them, and what is between bulges by the length that is left over.
#[test]
fn handles_take_their_vertices_along() {
    let driver = rectangle([0.04, 0.01], [24, 6]);
    let ends = |x: f64| {
        [
            Vector3::new(x - 1e-4, -1.0, -1.0),
            Vector3::new(x + 1e-4, 1.0, 1.0),
        ]
    };
    // A little curl says to which side.
    let layer = paper(vec![growth(0.0, 0.0, [1.0, 0.0])]);
    let sheet = Sheet {
        handles: vec![
            Handle::new("left", ends(0.0)),
            Handle::new("right", ends(0.04)),
        ],
        ..free()
    };
    let shift = Vector3::new(-0.004, 0.0, 0.0);
    let keyframe = |at: f64, translation| Keyframe {
        at,
        translation,
        turn: Vector3::zeros(),
        about: Vector3::zeros(),
    };
    let motion = Motion {
        of: "right".into(),
        keyframes: vec![keyframe(0.3, 0.2 * shift), keyframe(1.0, shift)],
    };
    let pose = PoseSpec {
        motions: vec![motion],
        ..pose(1)
    };
    let places = end(run(&driver, &layer, &sheet, pose, &modelling(None)).expect("a run"));
    let pairs = || places.iter().zip(driver.rest());
    for (x, rest) in pairs().filter(|(_, rest)| rest.x > 0.0399) {
        assert!((x - rest - shift).norm() < 1e-12);
    }
    let height = pairs().map(|(x, _)| x.z).fold(0.0, f64::max);
    // Of a sine of length L shortened by d: (2/pi) sqrt(L d), here by a tenth.
    let expected = 2.0 / std::f64::consts::PI * (0.04f64 * 0.004).sqrt();
    assert!(
        (height / expected - 1.0).abs() < 0.1,
        "{height} of {expected}"
    );
}

/// One island of the texture lies turned by a right angle: its direction to the right is up on the sheet. Away from
/// the seam, which this says nothing about, each half grows its own way.
#[test]
fn directions_are_those_of_the_island() {
    let cells = 8;
    let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for half in 0..2u32 {
        let first = positions.len() as u32;
        for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
            let [x, y] = [i, j].map(|c| f64::from(c) / f64::from(cells));
            positions.push(0.02 * Vector3::new(x + f64::from(half), y, 0.0));
            uvs.push(match half {
                0 => Vector2::new(0.4 * x, 1.0 - 0.4 * y),
                _ => Vector2::new(0.5 + 0.4 * y, 1.0 - 0.4 * (1.0 - x)),
            });
        }
        for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
            let a = first + j * (cells + 1) + i;
            let [b, c, d] = [a + 1, a + cells + 2, a + cells + 1];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mesh = ArtistMesh {
        name: "islands".into(),
        positions,
        uvs: Some(uvs),
        triangles,
        ..ArtistMesh::default()
    };
    let driver = Arc::new(Driver::new(&mesh).expect("two squares"));
    // Nothing is held: each half grows its own way, and only along the seam do they differ.
    let layer = paper(vec![growth(0.002, 0.0, [0.0; 2])]);
    let places = end(run(&driver, &layer, &free(), pose(1), &modelling(None)).expect("a run"));
    let size = |rest: &dyn Fn(&Vector3<f64>) -> bool, axis: usize| {
        let inside = places.iter().zip(driver.rest()).filter(|(_, x)| rest(x));
        let values: Vec<f64> = inside.map(|(x, _)| x[axis]).collect();
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most - values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let at = |wanted: f64| move |x: &Vector3<f64>| (x.x - wanted).abs() < 1e-6;
    // The left border keeps its length, the right one grows along y.
    let [left, right] = [size(&at(0.0), 1), size(&at(0.04), 1)].map(|side| side / 0.02 - 1.0);
    assert!(
        left.abs() < 3e-4 && (right - 0.002).abs() < 3e-4,
        "{left} {right}"
    );
}

#[test]
fn a_roll_whose_turns_cross_is_told() {
    let rolled = |radius: &dyn Fn(f64) -> f64| {
        laid([60, 2], |u, v| {
            let angle = 4.0 * PI * u;
            let radius = 0.01 * radius(angle);
            Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.004 * v)
        })
    };
    let layer = paper(vec![growth(1e-3, 0.0, [0.0; 2])]);
    let run = |driver| {
        let result = run(&driver, &layer, &free(), pose(1), &modelling(None)).expect("a run");
        assert!(result.converged, "{:?}", result.warnings);
        let is_about = |warning: &&String| warning.contains("passes through itself");
        let warning = result.warnings.iter().find(is_about).cloned();
        (result.layers[0].intersections, warning)
    };
    let spiral = rolled(&|angle| 1.0 + 0.05 * angle);
    assert_eq!(run(spiral), (Some(0), None));
    let (count, warning) = run(rolled(&|angle| 1.0 + 0.2 * (0.5 * angle).cos()));
    // Each of the two cells across it crosses with both triangles, in both turns.
    let count = count.expect("a count");
    assert!((4..=16).contains(&count), "{count}");
    let warning = warning.expect("a warning");
    let told = format!("{count} triangles at 100.0 % of the pose");
    assert!(warning.contains(&told), "{warning}");
}

#[test]
fn what_a_sheet_cannot_be_is_refused() {
    let driver = rectangle([0.02, 0.02], [4, 4]);
    let weight = Vector3::new(0.0, 0.0, -9.81);
    let told = |layer: &LayerSpec, sheet: &Sheet| match run(
        &driver,
        layer,
        sheet,
        pose(1),
        &modelling(None),
    ) {
        Ok(_) => panic!("{sheet:?} was accepted"),
        Err(error) => error.to_string(),
    };
    let plain = paper(Vec::new());
    let falling = Sheet {
        gravity: weight,
        ..free()
    };
    let missed = Sheet {
        handles: vec![Handle::new(
            "pin",
            [Vector3::repeat(1.0), Vector3::repeat(2.0)],
        )],
        ..free()
    };
    let fine = Sheet {
        edge: Some(1e-6),
        ..free()
    };
    let huge = Sheet {
        edge: Some(f64::NAN),
        ..free()
    };
    for (layer, sheet, words) in [
        (&plain, falling, "holds 0 of 1 parts"),
        (&plain, missed, "handle 'pin'"),
        (&plain, fine, "vertex budget"),
        (&plain, huge, "`edge` is NaN"),
        (
            &paper(vec![growth(0.0, 0.0, [f64::INFINITY, 0.0])]),
            free(),
            "`curl` is [inf, 0.0]",
        ),
        (&paper(vec![growth(-0.7, 0.0, [0.0; 2])]), free(), "-0.7"),
    ] {
        let told = told(layer, &sheet);
        assert!(told.contains(words), "{told}");
    }
}

/// It hangs from a clip and curls both ways, so that it buckles before it rolls up.
#[test]
fn paper_that_curls_in_drying_rolls_up_from_equilibrium_to_equilibrium() {
    let [length, width] = [0.1, 0.07];
    let driver = rectangle([length, width], [20, 14]);
    let layer = paper(vec![growth(-0.02, -0.04, [10.0, 40.0])]);
    let sheet = Sheet {
        gravity: Vector3::new(0.0, 0.0, -9.81),
        handles: vec![clamp(1e-3)],
        ..free()
    };
    let places = end(run(&driver, &layer, &sheet, pose(10), &modelling(None)).expect("a run"));
    // At the free end the width lies on an arc of 1/40 m, which is no wider than two of its radii.
    let end = places.iter().zip(driver.rest());
    let end = end.filter(|(_, rest)| rest.x > 0.999 * length);
    let across = end.map(|(x, _)| x.y);
    let [low, high] = [
        across.clone().fold(f64::MAX, f64::min),
        across.fold(f64::MIN, f64::max),
    ];
    assert!(high - low < 0.055, "{}", high - low);
}
