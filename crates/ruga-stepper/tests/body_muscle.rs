//! A body that blend shapes draw, and what can be wrong with a body.

mod bodies;

use std::sync::Arc;

use bodies::{free_body, layer, modelling, pose, push, slab, slice, top};
use nalgebra::Vector3;
use ruga_blend::{ArtistMesh, Driver, Smoothing};
use ruga_lattice::LatticeError;
use ruga_stepper::{
    CellShape, Dynamics, Frame, Keyframe, Modelling, Observer, Obstacle, ObstacleShape, PoseResult,
    PoseSpec, Preparation, Progress, Silent, StepperError, plan_body,
};

const LENGTH: f64 = 0.04;
const LIFT: f64 = 0.004;

/// A bar whose shape bends its end up.
fn bar() -> Arc<Driver> {
    let bent = |p: Vector3<f64>| p + Vector3::z() * (LIFT * (p.x / LENGTH).powi(2));
    slab(Vector3::new(LENGTH, 0.02, 0.02), [8, 4, 4], bent)
}

fn bend(driver: &Driver, steps: u32) -> PoseSpec {
    let mut pose = pose(Vec::new(), &[1.0], steps);
    pose.weights = driver.weights([("shape", 1.0)]).expect("its shape");
    pose
}

fn coarse() -> Modelling {
    Modelling {
        region: top(),
        ..modelling(5.0)
    }
}

fn followed(
    driver: &Arc<Driver>,
    stiffness: f64,
    steps: u32,
    modelling: &Modelling,
    observer: &mut dyn Observer,
) -> PoseResult {
    let mut body = free_body(4);
    body.follow = Some(stiffness);
    let poses = [bend(driver, steps)];
    let plan = plan_body(driver, &[layer(50.0)], &body, &poses, modelling, 1024);
    let run = plan.expect("a closed bar").simulate(0, observer);
    run.expect("a run")
}

/// Farthest of the artist's vertices from where the shape puts it, over the shape's size.
#[test]
fn stiff_muscles_follow_the_shape_and_soft_ones_give_way() {
    let driver = bar();
    let worst = |stiffness: f64| {
        let result = followed(&driver, stiffness, 2, &coarse(), &mut Silent);
        assert!(result.converged, "{:?}", result.warnings);
        let target = driver.pose(&bend(&driver, 1).weights);
        let now = result.keys[0].artist_positions.as_ref().expect("a body");
        let ways = now.iter().zip(&target).map(|(a, b)| (a - b).norm());
        ways.fold(0.0, f64::max) / LIFT
    };
    let [soft, stiff] = [worst(1e6), worst(1e8)];
    assert!(stiff < 0.02, "{stiff}");
    assert!(soft > 5.0 * stiff && soft < 0.5, "{soft}");
}

/// How far the end of the bar has come in every frame, over the shape's size.
#[derive(Default)]
struct Lift(Vec<f64>);

impl Observer for Lift {
    fn frame(&mut self, frame: &Frame<'_>) {
        let below = &frame.layers[0].driver_positions;
        let end = below.iter().filter(|x| x.x > 0.97 * LENGTH);
        let (sum, count) = end.fold((0.0, 0.0), |(sum, n), x| (sum + x.z - 0.02, n + 1.0));
        self.0.push(sum / count / LIFT);
    }
}

/// Drawn at a steady speed a body lags behind its equilibrium, overtakes it and swings ever less;
/// with much damping it only lags.
#[test]
fn muscles_swing_the_body() {
    let driver = bar();
    let (stiffness, steps) = (3e5, 40);
    let mut rest = Lift::default();
    followed(&driver, stiffness, 1, &coarse(), &mut rest);
    let ahead = |damping: f64| -> Vec<f64> {
        let modelling = Modelling {
            dynamics: Some(Dynamics {
                time_step: 5e-4,
                damping,
            }),
            ..coarse()
        };
        let mut lift = Lift::default();
        let result = followed(&driver, stiffness, steps, &modelling, &mut lift);
        assert!(result.converged && result.frames == steps as usize);
        let frames = lift.0.iter().enumerate();
        let equilibrium = |i: usize| rest.0[0] * (i + 1) as f64 / f64::from(steps);
        frames.map(|(i, lift)| lift - equilibrium(i)).collect()
    };
    let largest = |ways: &[f64]| ways.iter().copied().fold(f64::MIN, f64::max);
    let least = |ways: &[f64]| ways.iter().copied().fold(f64::MAX, f64::min);
    let free = ahead(0.0);
    let lag = -least(&free);
    assert!(lag > 0.05 && largest(&free) > 0.2 * lag, "{free:?}");
    assert!(largest(&free[30..]) - least(&free[30..]) < lag, "{free:?}");
    let damped = ahead(1000.0);
    assert!(largest(&damped) < 0.0, "{damped:?}");
}

/// A key between two steps in time divides the step: in steps of 1, 1/2 and 1/2 a body falls by 1, 7/4
/// and 11/4 of `g h^2`.
#[test]
fn a_key_between_two_steps_in_time_divides_the_step() {
    let driver = bar();
    let mut body = free_body(4);
    body.gravity = Vector3::z() * -9.81;
    let time_step = 0.01;
    let modelling = Modelling {
        dynamics: Some(Dynamics {
            time_step,
            damping: 0.0,
        }),
        ..coarse()
    };
    let poses = [pose(Vec::new(), &[0.75, 1.0], 2)];
    let plan = plan_body(&driver, &[layer(50.0)], &body, &poses, &modelling, 1024);
    let run = plan.expect("a closed bar").simulate(0, &mut Silent);
    let result = run.expect("a run");
    assert!(result.converged && result.frames == 3);
    for (key, share) in result.keys.iter().zip([1.75, 2.75]) {
        let way = Vector3::z() * (-9.81 * time_step * time_step * share);
        let artist = key.artist_positions.as_ref().expect("a body");
        for (now, rest) in artist.iter().zip(driver.rest()) {
            let off = (now - rest - way).norm();
            assert!(off < 1e-5 * way.norm(), "{}", off / way.norm());
        }
    }
}

/// What is handed out fits together, and is the same every time to the last bit.
#[test]
fn results_are_whole_and_repeatable() {
    let driver = bar();
    let run = || {
        let mut body = free_body(4);
        body.follow = Some(1e7);
        body.handles = vec![slice("foot", -1.0, 0.01)];
        let mut pose = bend(&driver, 2);
        pose.keys = vec![0.37, 1.0];
        let plan = plan_body(&driver, &[layer(50.0)], &body, &[pose], &coarse(), 1024);
        let run = plan.expect("a closed bar").simulate(0, &mut Silent);
        run.expect("a run")
    };
    let [first, again] = [run(), run()];
    assert!(first.converged && first.frames == 3);
    let loads: Vec<f64> = first.keys.iter().map(|key| key.load).collect();
    assert_eq!(loads, [0.37, 1.0]);
    for (key, other) in first.keys.iter().zip(&again.keys) {
        let surface = &key.layers[0];
        let vertices = surface.positions.len();
        assert_eq!(vertices, surface.driver_positions.len());
        assert_eq!(surface.faces.len(), surface.artist.len());
        let mut normals = surface.driver_normals.iter();
        assert!(normals.all(|n| (n.norm() - 1.0).abs() < 1e-12));
        let corners = surface.faces.iter().flatten();
        assert!(corners.copied().all(|v| (v as usize) < vertices));
        let artist = key.artist_positions.as_ref().expect("a body");
        assert_eq!(artist.len(), driver.rest().len());
        // Held vertices stay where they are to rounding.
        let pairs = artist.iter().zip(driver.rest());
        let mut held = pairs.filter(|(_, rest)| rest.x < 0.0099);
        assert!(held.all(|(now, rest)| (now - rest).norm() < 1e-15));
        assert_eq!(surface.positions, other.layers[0].positions);
        assert_eq!(key.artist_positions, other.artist_positions);
    }
}

/// Nothing holds the body, so that six of its motions cost nothing: it stays where it is, and a floor
/// that comes up takes it along as it is.
#[test]
fn a_free_body_stays_or_goes_where_it_is_pushed() {
    let driver = bar();
    let mut body = free_body(4);
    body.obstacles = vec![Obstacle {
        name: "floor".into(),
        shape: ObstacleShape::Plane {
            point: Vector3::z() * -1e-4,
            normal: Vector3::z(),
        },
    }];
    let modelling = modelling(4.0);
    let thickness = layer(50.0).material.thickness;
    let moved = |motions| {
        let poses = [pose(motions, &[1.0], 1)];
        let plan = plan_body(&driver, &[layer(50.0)], &body, &poses, &modelling, 1024);
        let run = plan.expect("a closed bar").simulate(0, &mut Silent);
        let result = run.expect("a run");
        assert!(result.converged, "{:?}", result.warnings);
        assert_eq!(result.layers[0].onset_load, None);
        result.keys[0].artist_positions.clone().expect("a body")
    };
    // All that acts is the layer's noise, a thousandth of its thickness.
    let still = moved(Vec::new());
    let ways = still.iter().zip(driver.rest());
    let farthest = ways
        .map(|(now, rest)| (now - rest).norm())
        .fold(0.0, f64::max);
    assert!(farthest < 0.05 * thickness, "{}", farthest / thickness);
    // Nothing holds it down on the floor either, so that it may end a little above.
    let height = |lifted: &[Vector3<f64>]| {
        let lowest = lifted.iter().map(|p| p.z).fold(f64::MAX, f64::min);
        (lowest - 1e-3) / thickness
    };
    let lift = push("floor", Vector3::z() * 1.1e-3);
    let lifted = moved(vec![lift.clone()]);
    assert!(
        (-0.1..3.0).contains(&height(&lifted)),
        "{}",
        height(&lifted)
    );
    // A floor that goes down again leaves it there: half way is no load step, but a keyframe.
    let mut up_and_down = lift;
    up_and_down.keyframes.push(Keyframe {
        translation: Vector3::zeros(),
        ..up_and_down.keyframes[0]
    });
    up_and_down.keyframes[0].at = 0.5;
    let left = height(&moved(vec![up_and_down]));
    assert!((-0.1..3.0).contains(&left), "{left}");
    let ends = [Vector3::zeros(), Vector3::new(LENGTH, 0.02, 0.02)];
    let strain = bodies::compression(&driver, &lifted, ends);
    assert!(strain.abs() < 2e-3, "{strain}");
}

#[test]
fn a_run_can_be_interrupted_anywhere() {
    #[derive(Default)]
    struct Stop {
        iterations: usize,
        frames: usize,
    }
    impl Observer for Stop {
        fn progress(&mut self, _: Progress) -> bool {
            self.iterations = self.iterations.saturating_sub(1);
            self.iterations > 0
        }
        fn frame(&mut self, _: &Frame<'_>) {
            self.frames += 1;
        }
    }
    let in_time = Dynamics {
        time_step: 0.01,
        damping: 0.0,
    };
    for dynamics in [None, Some(in_time)] {
        let modelling = Modelling {
            dynamics,
            ..coarse()
        };
        for iterations in 1.. {
            let mut stop = Stop {
                iterations,
                ..Stop::default()
            };
            let result = followed(&bar(), 1e6, 2, &modelling, &mut stop);
            assert!(result.warnings.is_empty(), "{:?}", result.warnings);
            assert_eq!(result.frames, stop.frames, "{iterations}");
            if !result.interrupted {
                assert!(stop.iterations > 0, "it was told to stop");
                assert!(iterations > 4 && result.converged);
                break;
            }
            assert!(result.keys.is_empty() && stop.frames < 2, "{iterations}");
        }
    }
}

#[test]
fn what_does_not_fit_is_named() {
    let driver = bar();
    let planned = |change: &dyn Fn(&mut ruga_stepper::Body)| {
        let mut body = free_body(4);
        change(&mut body);
        plan_body(&driver, &[layer(50.0)], &body, &[], &coarse(), 1024)
    };
    let empty = planned(&|body| body.handles = vec![slice("far", 1.0, 2.0)]);
    assert!(matches!(empty, Err(StepperError::EmptyHandle { handle, .. }) if handle == "far"));
    let all = planned(&|body| body.handles = vec![slice("all", -1.0, 2.0)]);
    assert!(matches!(all, Err(StepperError::HeldBody)));
    let pulled = planned(&|body| body.follow = Some(-1.0));
    assert!(matches!(pulled, Err(StepperError::Lattice(_))));
    let locking = planned(&|body| body.material.poisson = 0.48).expect("a body");
    assert!(locking.warnings.iter().any(|w| w.contains("locks")));
    let fine = planned(&|body| body.cells = Some(12)).expect("a body");
    assert!(
        fine.warnings
            .iter()
            .any(|w| w.contains("lattice wrinkles too"))
    );
    let one =
        planned(&|body| (body.cells, body.shape) = (Some(2), CellShape::Linear)).expect("a body");
    assert!(one.warnings.iter().any(|w| w.contains("thinnest side")));

    let unknown = [pose(vec![push("nobody", Vector3::x())], &[1.0], 1)];
    let plan = plan_body(
        &driver,
        &[layer(50.0)],
        &free_body(4),
        &unknown,
        &coarse(),
        1024,
    );
    assert!(matches!(plan, Err(StepperError::UnknownMover { name, .. }) if name == "nobody"));
}

#[test]
fn bodies_without_meaning_are_refused() {
    let driver = bar();
    let mut body = free_body(4);
    body.density = f64::NAN;
    let light = plan_body(&driver, &[layer(50.0)], &body, &[], &coarse(), 1024);
    let named = "density = NaN; accepted: a positive number";
    assert!(light.is_err_and(|error| error.to_string().contains(named)));
    let endless = Modelling {
        points_per_wavelength: 1e9,
        ..coarse()
    };
    let planned = |pose: PoseSpec, modelling: &Modelling| {
        plan_body(
            &driver,
            &[layer(50.0)],
            &free_body(4),
            &[pose],
            modelling,
            1024,
        )
    };
    let refused = planned(bend(&driver, 1), &endless);
    assert!(matches!(refused, Err(StepperError::Setting { .. })));
    let none = planned(pose(Vec::new(), &[], 1), &coarse());
    assert!(matches!(none, Err(StepperError::Setting { .. })));
    let plan = planned(bend(&driver, 1), &coarse()).expect("a body");
    let missing = plan.simulate(1, &mut Silent);
    assert!(matches!(
        missing,
        Err(StepperError::NoSuchPose { pose: 1, poses: 1 })
    ));
}

#[test]
fn a_body_can_be_ended_at_every_step_of_its_preparation() {
    struct Stop {
        left: usize,
        ended: bool,
    }
    impl Observer for Stop {
        fn preparing(&mut self, _: Preparation) -> bool {
            self.left -= 1;
            self.ended = self.left == 0;
            !self.ended
        }
        fn progress(&mut self, _: Progress) -> bool {
            false
        }
    }
    for steps in 1.. {
        let mut stop = Stop {
            left: steps,
            ended: false,
        };
        let result = followed(&bar(), 1e6, 1, &coarse(), &mut stop);
        assert!(result.interrupted && !result.converged && result.keys.is_empty());
        if !stop.ended {
            assert!(steps > 6, "{steps}");
            break;
        }
        assert_eq!(result.layers.len(), 1);
    }
}

/// Cubes of 2 cm, a corner of each given, after a second copy of the first corner and a triangle that is
/// none.
fn cubes(corners: &[f64]) -> ArtistMesh {
    let mut mesh = ArtistMesh {
        triangles: vec![[0, 1, 2]],
        ..ArtistMesh::default()
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    mesh.positions.push(Vector3::repeat(corners[0]));
    for corner in corners {
        let first = mesh.positions.len() as u32;
        let places =
            (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|c| 0.02 * f64::from(c) + corner));
        mesh.positions.extend(places.map(Vector3::from));
        for [a, b, c, d] in quads.map(|quad| quad.map(|v: u32| first + v)) {
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.uvs = Some(mesh.positions.iter().map(|p| p.xy() * 10.0).collect());
    mesh
}

/// The body is built of a smooth, finer surface; what is told has to be of the file all the same.
#[test]
fn what_is_wrong_with_a_surface_is_told_of_its_file() {
    let smooth = Modelling {
        smoothing: Smoothing::Loop,
        ..modelling(5.0)
    };
    let refused = |mesh: &ArtistMesh| {
        let driver = Arc::new(Driver::new(mesh).expect("a mesh"));
        plan_body(&driver, &[layer(50.0)], &free_body(4), &[], &smooth, 1024).expect_err("no body")
    };
    let mut open = cubes(&[0.0]);
    open.triangles.pop();
    let error = refused(&open);
    let StepperError::Lattice(LatticeError::OpenSurface { count, vertices }) = error else {
        panic!("{error}");
    };
    assert_eq!(count, 3);
    assert!(
        vertices.iter().all(|v| [2, 8, 6].contains(&v.0)),
        "{vertices:?}"
    );

    let error = refused(&cubes(&[0.0, 0.003]));
    let StepperError::Lattice(LatticeError::SelfIntersection { faces, .. }) = error else {
        panic!("{error}");
    };
    assert!(faces.iter().all(|f| (1..25).contains(&f.0)), "{faces:?}");

    let mut turned = cubes(&[0.0]);
    turned.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let error = refused(&turned);
    let of_file =
        matches!(error, StepperError::Lattice(LatticeError::WrongSide { face, .. }) if face.0 == 1);
    assert!(of_file, "{error}");
}
