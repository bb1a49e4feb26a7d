//! Sheets that burn: what is left, how fast it goes, how it shrinks, and into what it falls.

mod fires;
mod flat_sheet;

use fires::{PAPER, ball, burnt, fire, pose, run, run_pose, sheet};
use flat_sheet::{clamp, rectangle};
use nalgebra::Vector3;
use ruga_stepper::{Fire, Keyframe, Motion, PoseResult, PoseSpec, Sheet};

/// Area of what is left at the last key, m².
fn area_left(result: &PoseResult) -> f64 {
    let surface = &result.keys.last().expect("a key").layers[0];
    let areas = surface.faces.iter().map(|corners| {
        let [a, b, c] = corners.map(|v| surface.positions[v as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    });
    areas.sum()
}

#[test]
fn a_strip_burns_at_the_speed_that_is_asked_for_and_keeps_the_mass_of_its_char() {
    let (length, width) = (0.09, 0.008);
    let driver = rectangle([length, width], [45, 4]);
    let end = ball(length, 0.5 * width, 0.008);
    let mut standard = fire(vec![end]);
    standard.edges_per_width = 4.0;
    let result = run(&driver, &sheet(standard), (25, 1.0)).expect("it burns");
    let report = burnt(&result);
    // In the last two fifths of the time it is past what the ember has heated.
    let mean = |fields: &[f64]| fields.iter().sum::<f64>() / fields.len() as f64;
    let [before, after] = [0, 1].map(|key: usize| {
        let burnt = result.keys[key].layers[0].burnt.as_ref();
        mean(&burnt.expect("fields").fuel)
    });
    let speed = (before - after) * length / 10.0;
    assert!((speed / 2e-3 - 1.0).abs() < 0.01, "{speed} m/s");
    let median = report.front_speed.expect("a front");
    assert!((median / 2e-3 - 1.0).abs() < 0.06, "{median} m/s");
    assert_eq!((report.pieces, report.vanished), (1, 0));
    // Nothing falls off, so that a fifth of what has burnt is there.
    let left = 0.2 + 0.8 * report.fuel_left;
    let expected = PAPER * length * width * left;
    assert!(
        (report.mass / expected - 1.0).abs() < 1e-9,
        "{}",
        report.mass
    );
    assert!((area_left(&result) / (length * width) - 1.0).abs() < 1e-9);
    // Nothing has fallen off: the matrix of the heat is the same all the way.
    assert_eq!(report.factorisations, 1);
}

#[test]
fn what_has_burnt_out_is_as_much_shorter_as_it_shrinks() {
    let (length, width) = (0.03, 0.006);
    let driver = rectangle([length, width], [15, 3]);
    let all = ball(0.5 * length, 0.5 * width, length);
    let mut shrinking = fire(vec![all]);
    shrinking.shrink.along = 0.25;
    shrinking.shrink.across = 0.1;
    let mut held = sheet(shrinking);
    // Held at one edge of vertices along x, which keeps its size.
    held.handles = vec![clamp(1e-4)];
    let result = run(&driver, &held, (4, 1.0)).expect("it burns");
    let report = burnt(&result);
    assert!(report.fuel_left < 1e-9, "{}", report.fuel_left);
    let surface = &result.keys[1].layers[0];
    let far = surface.positions.iter().map(|x| x.x).fold(0.0, f64::max);
    assert!((far / (0.75 * length) - 1.0).abs() < 0.02, "{far} m");
    let burnt = surface.burnt.as_ref().expect("fields");
    assert!(burnt.fuel.iter().all(|fuel| *fuel <= 0.0));
    assert!(
        burnt.level.iter().all(|level| *level > 0.0),
        "nothing falls off"
    );
}

/// A mesh that is fine only where it burns against one that is so everywhere.
#[test]
fn a_mesh_that_follows_the_fire_burns_and_curls_as_a_fine_one() {
    let (length, width) = (0.06, 0.002);
    let driver = rectangle([length, width], [30, 1]);
    let mut narrow = fire(vec![ball(length, 0.5 * width, 0.004)]);
    narrow.front.width = 0.7e-3;
    narrow.shrink.along = 0.2;
    narrow.shrink.asymmetry = 0.01;
    let burn = |edge| {
        let sheet = Sheet {
            edge,
            ..sheet(narrow.clone())
        };
        run(&driver, &sheet, (10, 0.25)).expect("it burns")
    };
    let [even, fitted] = [Some(0.35e-3), None].map(burn);
    let reports = [&even, &fitted].map(burnt);
    // The ember stands where the curling end was, and touches it as it curls.
    let [fuel, other] = reports.map(|report| report.fuel_left);
    assert!((fuel - other).abs() < 1e-3, "{reports:?}");
    assert!(fuel < 0.9, "{reports:?}");
    for report in reports {
        let left = PAPER * length * width * (0.2 + 0.8 * report.fuel_left);
        assert!((report.mass / left - 1.0).abs() < 1e-9, "{report:?}");
    }
    assert_eq!(reports[0].remeshed, 0);
    assert!(reports[1].remeshed > 1, "{reports:?}");
    let [many, few] = [&even, &fitted].map(|result| result.layers[0].vertices);
    assert!(3 * few < many, "{few} of {many}");
    let [even, fitted] = [&even, &fitted].map(|result| &result.keys[1].layers[0]);
    assert_eq!(even.positions.len(), fitted.positions.len());
    let pairs = even.positions.iter().zip(&fitted.positions);
    let away = pairs.clone().map(|(a, b)| (a - b).norm());
    let away = away.fold(0.0, f64::max);
    let high = even.positions.iter().map(|x| x.z.abs()).fold(0.0, f64::max);
    assert!(high > 0.5e-3, "{high} m");
    assert!(away < 0.04 * high, "{away} of {high} m");
    let again = burn(None);
    assert_eq!(fitted.positions, again.keys[1].layers[0].positions);
}

/// A ball that crosses a strip cuts its end off, which falls, on a mesh that follows both.
#[test]
fn a_mesh_that_follows_a_ball_falls_into_pieces() {
    let (length, width) = (0.06, 0.002);
    let driver = rectangle([length, width], [30, 1]);
    let mut narrow = fire(vec![ball(0.04, -0.004, 0.002)]);
    narrow.front.width = 0.7e-3;
    narrow.ash_share = 0.2;
    let falling = Sheet {
        edge: None,
        gravity: Vector3::new(9.81, 0.0, 0.0),
        ..sheet(narrow)
    };
    let crossing = PoseSpec {
        motions: vec![Motion {
            of: falling.fire.as_ref().expect("a fire").sources[0]
                .name
                .clone(),
            keyframes: vec![Keyframe {
                at: 1.0,
                translation: Vector3::new(0.0, 0.01, 0.0),
                turn: Vector3::zeros(),
                about: Vector3::zeros(),
            }],
        }],
        ..pose(10)
    };
    let result = run_pose(&driver, &falling, crossing, 0.05).expect("it burns");
    let report = burnt(&result);
    assert!((1..8).contains(&report.remeshed), "{report:?}");
    assert_eq!((report.pieces, report.vanished), (2, 0), "{report:?}");
    let surface = &result.keys[1].layers[0];
    assert!(surface.positions.iter().flatten().all(|c| c.is_finite()));
    let far = surface.positions.iter().map(|x| x.x).fold(0.0, f64::max);
    assert!(far > length + 0.02, "{far} m");
    // Nothing of what is seen spans the gap.
    let longest = surface.faces.iter().flat_map(|corners| {
        let [a, b, c] = corners.map(|v| surface.positions[v as usize]);
        [(b - a).norm(), (c - b).norm(), (a - c).norm()]
    });
    let longest = longest.fold(0.0, f64::max);
    assert!(longest < 1e-3, "{longest} m");
}

/// Where the fire comes to a handle that has moved, what it holds is where the handle has taken it, on every mesh.
#[test]
fn a_new_mesh_beside_a_handle_moves_with_it() {
    let (length, width) = (0.06, 0.002);
    let driver = rectangle([length, width], [30, 1]);
    let mut narrow = fire(vec![ball(0.006, 0.5 * width, 0.002)]);
    narrow.front.width = 0.7e-3;
    let mut held = Sheet {
        edge: None,
        ..sheet(narrow)
    };
    held.handles = vec![clamp(2e-3)];
    let raise = Vector3::new(0.0, 0.0, 2e-3);
    let lifted = PoseSpec {
        motions: vec![Motion {
            of: held.handles[0].name.clone(),
            keyframes: vec![Keyframe {
                at: 1.0,
                translation: raise,
                turn: Vector3::zeros(),
                about: Vector3::zeros(),
            }],
        }],
        ..pose(10)
    };
    let result = run_pose(&driver, &held, lifted, 0.2).expect("it burns");
    let report = burnt(&result);
    assert!(report.remeshed > 0, "{report:?}");
    let surface = &result.keys[1].layers[0];
    let held: Vec<_> = surface.positions.iter().filter(|x| x.x < 1e-3).collect();
    assert!(held.len() > 10);
    for x in held {
        assert!((x.z - raise.z).abs() < 2e-5, "{x:?}");
    }
}

#[test]
fn a_hole_is_cut_where_fuel_has_run_out() {
    let driver = rectangle([0.04, 0.04], [20, 20]);
    let middle = ball(0.02, 0.02, 0.008);
    let mut falling = fire(vec![middle]);
    falling.ash_share = 0.2;
    let result = run(&driver, &sheet(falling), (4, 1.0)).expect("it burns");
    let report = burnt(&result);
    assert_eq!((report.pieces, report.vanished), (1, 0));
    let surface = &result.keys[1].layers[0];
    let fields = surface.burnt.as_ref().expect("fields");
    let hole = 0.04 * 0.04 - area_left(&result);
    let radius = (hole / std::f64::consts::PI).sqrt();
    assert!((0.008..0.016).contains(&radius), "a hole of {radius} m");
    // Nothing of the part that is left is where the level says that it fell off.
    let is_gone = |v: &u32| fields.level[*v as usize] <= 0.0;
    let gone = fields.faces.iter().filter(|face| face.iter().all(is_gone));
    assert!(gone.count() > 50);
    let rim = |x: &Vector3<f64>| (x - Vector3::new(0.02, 0.02, x.z)).norm();
    let inner = surface.positions.iter().map(rim).fold(f64::MAX, f64::min);
    assert!((inner / radius - 1.0).abs() < 0.15, "{inner} {radius}");
    let mut edges = std::collections::BTreeMap::new();
    for [a, b, c] in surface.faces.iter() {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            *edges.entry([p.min(q), p.max(q)]).or_insert(0) += 1;
        }
    }
    // A ring has as many vertices and faces together as edges.
    let counts = surface.positions.len() + surface.faces.len();
    assert_eq!(counts, edges.len());
}

#[test]
fn a_piece_that_is_burnt_off_falls() {
    let (length, width) = (0.04, 0.008);
    let driver = rectangle([length, width], [20, 4]);
    let across = ball(0.5 * length, 0.5 * width, 0.006);
    let mut falling = fire(vec![across]);
    falling.ash_share = 0.2;
    let mut hanging = sheet(falling);
    hanging.gravity = Vector3::new(9.81, 0.0, 0.0);
    let result = run(&driver, &hanging, (20, 0.1)).expect("it burns");
    let report = burnt(&result);
    let surface = &result.keys[1].layers[0];
    let lowest = surface.positions.iter().map(|x| x.x).fold(0.0, f64::max);
    // Two seconds of falling are ten lengths, where it has vanished.
    assert!(lowest < 0.5 * length, "{lowest} m");
    assert_eq!((report.pieces, report.vanished), (1, 1));
    assert!(
        surface.positions.iter().any(|x| x.x < 1e-6),
        "the clamp holds the rest"
    );
    // A fifth of the mass is in the char, the rest in the fuel; some of that is in what is about to fall off.
    let fuel = report.fuel_left * length * width;
    let mass = PAPER * (0.2 * area_left(&result) + 0.8 * fuel);
    assert!(
        (report.mass / mass - 1.0).abs() < 0.03,
        "{} {mass}",
        report.mass
    );
}

#[test]
fn small_loose_pieces_vanish_and_are_counted() {
    let (length, width) = (0.04, 0.008);
    let driver = rectangle([length, width], [20, 4]);
    let across = ball(0.7 * length, 0.5 * width, 0.006);
    let mut falling = fire(vec![across]);
    falling.ash_share = 0.2;
    falling.least_piece = 1e-3;
    let result = run(&driver, &sheet(falling), (4, 0.5)).expect("it burns");
    let report = burnt(&result);
    assert_eq!((report.pieces, report.vanished), (1, 1));
    assert!(
        (1e-6..0.3 * length * width).contains(&report.vanished_area),
        "{report:?}"
    );
}

#[test]
fn char_curls_towards_the_side_that_shrinks_more() {
    let (length, width) = (0.03, 0.006);
    let driver = rectangle([length, width], [15, 3]);
    let mut curling = fire(vec![ball(0.5 * length, 0.5 * width, length)]);
    curling.shrink.along = 0.25;
    curling.shrink.asymmetry = 0.02;
    let mut held = sheet(curling);
    held.handles = vec![clamp(1e-4)];
    let result = run(&driver, &held, (10, 1.0)).expect("it burns");
    assert!(burnt(&result).fuel_left < 1e-9);
    // Faces whose lengths differ by 0.02 x 0.25/0.75 of the middle's, 0.08 mm apart.
    let radius = 8e-5 / (0.02 * 0.25 / 0.75);
    let turn = 0.75 * length / radius;
    // One row of vertices is held, about which the strip may turn: an arc's chord is the same all the same.
    let chord = 2.0 * radius * (0.5 * turn).sin();
    let surface = &result.keys[1].layers[0];
    let corners = || {
        surface
            .faces
            .iter()
            .flatten()
            .zip(surface.uvs.iter().flatten())
    };
    let at = |u: f64| {
        let there = corners().filter(|(_, uv)| (uv.x - u).abs() < 1e-9);
        let there: Vec<_> = there.map(|(v, _)| surface.positions[*v as usize]).collect();
        there.iter().sum::<Vector3<f64>>() / there.len() as f64
    };
    let (end, middle) = (at(1.0), at(7.0 / 15.0));
    let [reached, across] = [end.x.hypot(end.z), end.x * middle.z - end.z * middle.x];
    assert!(
        (reached / chord - 1.0).abs() < 0.02,
        "{reached} instead of {chord}"
    );
    // The ends turn up, to the upper side, and leave the middle below.
    assert!(across < 0.0, "{end} {middle}");
}

#[test]
fn a_ball_that_flies_past_burns_all_along_its_way() {
    let (length, width) = (0.06, 0.01);
    let driver = rectangle([length, width], [30, 5]);
    let flying = ball(-0.02, 0.5 * width, 0.006);
    let name = flying.name.clone();
    let burning = sheet(fire(vec![flying]));
    let way = Motion {
        of: name,
        keyframes: vec![Keyframe {
            at: 1.0,
            translation: Vector3::new(0.1, 0.0, 0.0),
            turn: Vector3::zeros(),
            about: Vector3::zeros(),
        }],
    };
    let mut pose = pose(2);
    pose.motions = vec![way];
    // In two steps it is nowhere near the middle at the end of one.
    let result = run_pose(&driver, &burning, pose, 1.0).expect("it burns");
    assert!(result.converged, "{:?}", result.warnings);
    let surface = &result.keys[1].layers[0];
    let fields = surface.burnt.as_ref().expect("fields");
    let faces = fields.faces.iter().zip(&fields.uvs);
    let middle = faces.filter(|(_, uvs)| uvs.iter().all(|uv| (uv.y - 0.5).abs() < 0.3));
    let hottest = |(face, _): (&[u32; 3], _)| {
        let hot = face.iter().map(|v| fields.temperature[*v as usize]);
        hot.fold(0.0, f64::max)
    };
    let coldest = middle.map(hottest).fold(f64::MAX, f64::min);
    assert!(coldest > 400.0, "{coldest} K");
}

#[test]
fn a_small_sheet_stays_until_it_has_burnt() {
    let driver = rectangle([0.02, 0.004], [10, 2]);
    let mut free = sheet(fire(vec![ball(0.5, 0.0, 0.01)]));
    free.handles.clear();
    if let Some(fire) = &mut free.fire {
        fire.least_piece = 1.0;
    }
    let result = run(&driver, &free, (2, 0.5)).expect("it stays");
    let report = burnt(&result);
    assert_eq!((report.pieces, report.vanished), (1, 0));
}

#[test]
fn a_sheet_that_nothing_sets_on_fire_stays_as_it_is() {
    let driver = rectangle([0.03, 0.01], [15, 5]);
    let far = ball(0.5, 0.5, 0.01);
    let result = run(&driver, &sheet(fire(vec![far])), (3, 1.0)).expect("it may");
    let report = burnt(&result);
    assert!((report.fuel_left - 1.0).abs() < 1e-12);
    assert!(
        result
            .warnings
            .iter()
            .any(|w| w.contains("nothing has burnt"))
    );
    let surface = &result.keys[1].layers[0];
    let moved = surface.positions.iter().zip(&surface.driver_positions);
    assert!(moved.clone().all(|(x, y)| (x - y).norm() < 1e-12));
    assert!((area_left(&result) / 3e-4 - 1.0).abs() < 1e-12);
}

#[test]
fn a_sheet_may_burn_away_whole() {
    let driver = rectangle([0.02, 0.01], [10, 5]);
    let all = ball(0.01, 0.005, 0.03);
    let mut falling = fire(vec![all]);
    falling.ash_share = 0.2;
    let result = run(&driver, &sheet(falling), (4, 1.0)).expect("it burns");
    let report = burnt(&result);
    assert_eq!((report.mass, report.pieces), (0.0, 0));
    assert!(result.keys[1].layers[0].faces.is_empty());
    assert!(
        result
            .warnings
            .iter()
            .any(|w| w.contains("all of it has burnt"))
    );
}

#[test]
fn a_handle_whose_place_has_burnt_is_told() {
    let (length, width) = (0.04, 0.008);
    let driver = rectangle([length, width], [20, 4]);
    let mut falling = fire(vec![ball(0.0, 0.5 * width, 0.006)]);
    falling.ash_share = 0.2;
    let held = sheet(falling);
    let result = run(&driver, &held, (4, 0.5)).expect("it burns");
    assert!(burnt(&result).pieces == 1 && area_left(&result) > 0.5 * length * width);
    let told = format!("all that handle '{}' held has burnt", held.handles[0].name);
    let warnings = &result.warnings;
    assert!(warnings.iter().any(|w| w.contains(&told)), "{warnings:?}");
}

#[test]
fn fires_that_cannot_burn_are_refused() {
    let driver = rectangle([0.03, 0.01], [15, 5]);
    let refused = |change: &dyn Fn(&mut Fire)| {
        let mut fire = fire(vec![ball(0.0, 0.0, 0.01)]);
        change(&mut fire);
        let error = run(&driver, &sheet(fire), (1, 1.0)).expect_err("a refusal");
        error.to_string()
    };
    let dying = refused(&|fire| fire.front.loss_time = Some(1.0));
    assert!(
        dying.contains("the front dies") && dying.contains("loss time above"),
        "{dying}"
    );
    let cold = refused(&|fire| fire.front.burning = 500.0);
    assert!(cold.contains("not above ignition"), "{cold}");
    let below_zero = refused(&|fire| fire.sources[0].temperature = -1.0);
    assert!(below_zero.contains("a number from 0, in K"), "{below_zero}");
    let below_zero = refused(&|fire| fire.front.surroundings = -1.0);
    assert!(below_zero.contains("surroundings"), "{below_zero}");
    let wide = refused(&|fire| fire.front.width = 0.02);
    assert!(wide.contains("half the sheet's longest side"), "{wide}");
    let crumbling = refused(&|fire| fire.ash_share = 1.0);
    assert!(crumbling.contains("ash_share"), "{crumbling}");
    let shrunk = refused(&|fire| fire.shrink.along = 0.7);
    assert!(shrunk.contains("between 0 and 0.6"), "{shrunk}");
    let fine = refused(&|fire| fire.edges_per_width = 4000.0);
    assert!(fine.contains("vertex budget"), "{fine}");
}
