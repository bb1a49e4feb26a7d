//! A body and its layer against what mechanics says of any such thing.

mod anchors;

use std::sync::Arc;

use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_blend::{Driver, Smoothing};
use ruga_lattice::{Shape, SolidMaterial};
use ruga_material::{LayerMaterial, Substrate, WavelengthModel, capped_strain};
use ruga_solver::{Kkt, NewtonSettings, Objective, minimise};

use super::Layer;
use crate::run::layer_objective::gather;
use crate::run::layer_setup::OutputEdges;
use crate::run::stack_run::StackRun;
use crate::support::{Interior, Moves, Solid};
use crate::test_drivers::{SIDES, block};
use crate::{
    Body, Coupling, Dynamics, Handle, Keyframe, LayerSpec, Modelling, Motion, Obstacle,
    ObstacleShape, Plan, PoseSpec, Presence, Sampling, Silent, Stack, plan_body,
};

fn skin(coupling: Coupling) -> LayerSpec {
    LayerSpec {
        name: "skin".into(),
        material: LayerMaterial {
            young: 5e6,
            poisson: 0.4,
            thickness: 5e-4,
            density: 1100.0,
        },
        laminate: None,
        substrate: Substrate {
            young: 5e4,
            poisson: 0.4,
            thickness: 0.1,
        },
        model: WavelengthModel::HalfSpace,
        coupling,
        sampling: Sampling::Quadrature,
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
        creases: Vec::new(),
        growths: Vec::new(),
    }
}

fn body() -> Body {
    Body {
        cells: Some(3),
        shape: Shape::Quadratic,
        material: SolidMaterial {
            young: 5e4,
            poisson: 0.4,
        },
        density: 900.0,
        gravity: Vector3::zeros(),
        handles: Vec::new(),
        obstacles: Vec::new(),
        follow: None,
    }
}

fn modelling() -> Modelling {
    Modelling {
        points_per_wavelength: 5.0,
        smoothing: Smoothing::None,
        ..Modelling::default()
    }
}

fn still(driver: &Driver) -> PoseSpec {
    PoseSpec {
        name: "pose".into(),
        weights: driver.weights([("shear", 1.0)]).expect("its shape"),
        keys: vec![1.0],
        steps: 1,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }
}

fn planned(driver: &Arc<Driver>, spec: &LayerSpec, body: &Body) -> Plan {
    let poses = [still(driver)];
    plan_body(
        driver,
        std::slice::from_ref(spec),
        body,
        &poses,
        &modelling(),
        1024,
    )
    .expect("a body")
}

fn interior(plan: &Plan) -> &Interior {
    plan.body.as_ref().expect("a body")
}

/// At rest without noise.
fn at_rest(plan: &Plan) -> Layer {
    let stack = StackRun::new(plan, 0).expect("fitting motions");
    let run = stack
        .build(0, &[], OutputEdges::AsPlanned, &mut Silent)
        .expect("a layer");
    let mut layer = run.layer;
    layer.positions.clone_from(&layer.base);
    layer
}

fn solid(layer: &mut Layer) -> &mut Solid {
    layer.solid.as_mut().expect("a body")
}

fn random_vectors(random: &mut Pcg64Mcg, count: usize, size: f64) -> Vec<Vector3<f64>> {
    let mut number = || random.random_range(-size..size);
    (0..count)
        .map(|_| Vector3::new(number(), number(), number()))
        .collect()
}

/// A state far from any equilibrium, with everything that can act.
fn crumpled(plan: &Plan) -> Layer {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut layer = at_rest(plan);
    let (interior, pose) = (interior(plan), &plan.specs[0]);
    let moves = Moves::of_body(&interior.body, pose).expect("fitting motions");
    layer
        .place_solid((&moves, &pose.weights), 0.5, None)
        .expect("a placed body");
    let cell = interior.embedding_lattice.lattice.cell_size().min();
    let (nodes, vertices) = (solid(&mut layer).state.q.len(), layer.vertex_count());
    let held = interior.held.pinned();
    let moved = random_vectors(&mut random, nodes, 0.1 * cell);
    for (i, displacement) in moved.iter().enumerate() {
        if !held[i] {
            solid(&mut layer).state.q[i] += displacement;
        }
    }
    solid(&mut layer).state.velocities = random_vectors(&mut random, nodes, 0.5);
    follow(&mut layer);
    let noise = random_vectors(&mut random, vertices, 0.2 * layer.spec.material.thickness);
    layer.positions.clone_from(&layer.base);
    for (x, displacement) in layer.positions.iter_mut().zip(noise) {
        *x += displacement;
    }
    layer
}

/// Takes over where the nodes are.
fn follow(layer: &mut Layer) {
    let unknowns = layer.unknowns();
    layer.set_unknowns(&unknowns);
    layer.hold().expect("a surface below");
}

fn everything() -> Body {
    Body {
        gravity: Vector3::new(1.0, -2.0, -9.81),
        handles: vec![Handle::new(
            "foot",
            [
                Vector3::repeat(-1.0),
                Vector3::new(SIDES[0] / 3.0, 1.0, 1.0),
            ],
        )],
        obstacles: vec![Obstacle {
            // Flat: of a curved one the Hessian leaves something out.
            name: "lid".into(),
            shape: ObstacleShape::Plane {
                point: Vector3::new(0.015, 0.0075, 0.0095),
                normal: Vector3::new(0.1, 0.2, -1.0),
            },
        }],
        follow: Some(1e6),
        ..body()
    }
}

/// Energy, gradient and Hessian of everything at once, against differences in random directions.
#[test]
fn the_whole_objective_has_its_derivatives() {
    let driver = block();
    let pose = still(&driver);
    let mut fine = skin(Coupling::Hybrid);
    fine.name = "fine".into();
    fine.material.thickness *= 0.3;
    let alone = [Coupling::Hybrid, Coupling::Constraint];
    let alone = alone.map(|coupling| vec![skin(coupling)]);
    let pair = vec![skin(Coupling::Hybrid), fine];
    for layers in alone.into_iter().chain([pair]) {
        let coupling = (layers[0].coupling, layers.len());
        let stack = match layers.len() {
            1 => Stack::Nominal,
            _ => Stack::Joint,
        };
        let modelling = Modelling {
            stack,
            ..modelling()
        };
        let poses = [still(&driver)];
        let plan = plan_body(&driver, &layers, &everything(), &poses, &modelling, 1024);
        let plan = plan.expect("a body");
        let mut layer = crumpled(&plan);
        let thickness = layer.spec.material.thickness;
        assert!(layer.penetration() > 0.1 * thickness, "no contact");
        let step = layer.time_step(Dynamics {
            time_step: 0.01,
            damping: 3.0,
        });
        let moves = Moves::of_body(&interior(&plan).body, &pose).expect("fitting motions");
        let before = layer.positions.clone();
        let q = solid(&mut layer).state.q.clone();
        let around = (&moves, &pose.weights);
        let placed = layer.place_solid(around, 0.7, Some(&step.inertia));
        placed.expect("a placed body");
        // Placing has set up obstacles and targets, and moved everything as well. The crumpled
        // state tests more.
        solid(&mut layer).state.q = q;
        layer.positions = before;
        follow(&mut layer);
        let base = gather(&layer.free, &layer.base);
        let objective = layer.objective(&base, Some(&step.inertia));
        let x = layer.unknowns();
        let mut gradient = vec![0.0; x.len()];
        let energy = objective.gradient(&x, &mut gradient);
        assert!((energy - objective.value(&x)).abs() < 1e-12 * energy.abs());
        let entries = objective.pattern().entries();
        let [mut exact, mut relaxed] = [vec![0.0; entries], vec![0.0; entries]];
        objective.hessian(&x, &mut exact, &mut relaxed);

        let blocks = layer.solid.as_ref().expect("a body").blocks();
        let mut random = Pcg64Mcg::seed_from_u64(11);
        let layer_part = layer.positions.len();
        for part in [0..layer_part, layer_part..x.len() / 3, 0..x.len() / 3] {
            let mut displacement = random_vectors(&mut random, x.len() / 3, 1.0);
            for (i, displacement) in displacement.iter_mut().enumerate() {
                if !part.contains(&i) {
                    *displacement = Vector3::zeros();
                }
            }
            let flat: Vec<f64> = displacement.iter().flat_map(|w| [w.x, w.y, w.z]).collect();
            // This is small against the thickness, over which energies curve, and far above the
            // rounding of differences.
            let step = 1e-4 * thickness;
            let beside = |s: f64| -> Vec<f64> {
                x.iter().zip(&flat).map(|(x, w)| x + s * step * w).collect()
            };
            let [up, down] = [beside(1.0), beside(-1.0)];
            let slope = (objective.value(&up) - objective.value(&down)) / (2.0 * step);
            let expected: f64 = gradient.iter().zip(&flat).map(|(g, w)| g * w).sum();
            assert!(
                (slope - expected).abs() < 1e-5 * expected.abs(),
                "{coupling:?} {part:?}: {slope} {expected}"
            );
            let [mut high, mut low] = [gradient.clone(), gradient.clone()];
            objective.gradient(&up, &mut high);
            objective.gradient(&down, &mut low);
            let bend = blocks.product(&exact, &displacement);
            let (mut error, mut size) = (0.0, 0.0);
            for (i, bend) in bend.iter().enumerate() {
                for c in 0..3 {
                    let k = 3 * i + c;
                    error += ((high[k] - low[k]) / (2.0 * step) - bend[c]).powi(2);
                    size += bend[c].powi(2);
                }
            }
            assert!(
                error < 1e-10 * size,
                "{coupling:?} {part:?}: {}",
                error / size
            );
            let of = |values: &[f64]| -> f64 {
                let bend = blocks.product(values, &displacement);
                bend.iter().zip(&displacement).map(|(b, w)| b.dot(w)).sum()
            };
            // What is left out in relaxing is compression, which only takes stiffness away.
            assert!(of(&relaxed) > 0.0 && of(&relaxed) >= of(&exact));
        }
    }
}

/// Forces in units of what strains the layer by one, on one vertex.
fn largest_force(layer: &Layer, plan: &Plan) -> f64 {
    let base = gather(&layer.free, &layer.base);
    let objective = layer.objective(&base, None);
    let x = layer.unknowns();
    let mut gradient = vec![0.0; x.len()];
    objective.gradient(&x, &mut gradient);
    let largest = gradient.iter().fold(0.0, |m: f64, g| m.max(g.abs()));
    let wrinkling = &plan.wrinkling()[0];
    let edge = wrinkling.wavelength / plan.poses[0].layers[0].points_per_wavelength;
    largest / (wrinkling.membrane_stiffness * edge)
}

#[test]
fn rest_and_every_rigid_motion_of_it_are_without_forces() {
    let driver = block();
    let plan = planned(&driver, &skin(Coupling::Hybrid), &body());
    let mut layer = at_rest(&plan);
    assert!(largest_force(&layer, &plan) < 1e-10);
    let unit = layer.strain_ratios().energy_scale();
    assert!(layer.energy().abs() < 1e-10 * unit);
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -1.1, 0.7));
    let moved = |p: &Vector3<f64>| turn * p + Vector3::new(0.1, 0.05, -0.2);
    layer.positions = layer.positions.iter().map(moved).collect();
    let q = &mut solid(&mut layer).state.q;
    *q = q.iter().map(moved).collect();
    let unknowns = layer.unknowns();
    layer.set_unknowns(&unknowns);
    assert!(layer.lag() > 1.0);
    layer.hold().expect("a surface below");
    assert!(largest_force(&layer, &plan) < 1e-10);
    assert!(layer.energy().abs() < 1e-10 * unit);
}

/// Squeezed to 70 % along x, the faces along x store what 15 to 25 % would: `A r C/2 E^2`, with the
/// capped Green strain `E` in rest lengths shrunk by `r`; those across nothing.
#[test]
fn a_layer_on_a_body_feels_its_strain_capped() {
    let driver = block();
    // A mesh whose faces do not cut the block's edges.
    let whole = Modelling {
        remesh: None,
        ..modelling()
    };
    let layers = [skin(Coupling::Hybrid)];
    let poses = [still(&driver)];
    let plan = plan_body(&driver, &layers, &body(), &poses, &whole, 1024).expect("a body");
    let mut layer = at_rest(&plan);
    let squeezed = 0.7;
    for q in &mut solid(&mut layer).state.q {
        q.x *= squeezed;
    }
    follow(&mut layer);
    layer.positions.clone_from(&layer.base);
    let effective = 1.0 - capped_strain(1.0 - squeezed);
    let green = 0.5 * (effective * effective - 1.0);
    let area = 2.0 * SIDES[0] * (SIDES[1] + SIDES[2]) * squeezed / effective;
    let stiffness = plan.wrinkling()[0].membrane_stiffness;
    let expected = 0.5 * area * stiffness * green * green;
    let found = layer.energy() - layer.solid().expect("a body").elastic_energy();
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    assert!(layer.capped_fraction() > 0.5);
}

/// One step in time, to convergence.
fn step(layer: &mut Layer, driver: &Driver, dynamics: Dynamics) {
    let pose = still(driver);
    let free = body();
    let moves = Moves::of_body(&free, &pose).expect("nothing moves");
    let step = layer.time_step(dynamics);
    let placed = layer.place_solid((&moves, &pose.weights), 1.0, Some(&step.inertia));
    placed.expect("a placed body");
    let settings = NewtonSettings {
        energy_tolerance: 1e-12,
        ..NewtonSettings::default()
    };
    let (pattern, rows) = layer.system();
    let mut kkt = Kkt::new(pattern, rows, 3).expect("a pattern");
    let how = (minimise as _, &settings);
    let solve = layer.minimise(Some(&step.inertia), how, &mut kkt, &mut |_| true);
    assert!(solve.expect("a solvable step").converged);
    layer.end_step(&step);
}

/// Momentum, and angular momentum about the origin.
fn momenta(layer: &Layer) -> [Vector3<f64>; 2] {
    let solid = layer.solid().expect("a body");
    let p = solid.momentum();
    let angular = solid.state.q.iter().zip(&p).map(|(q, p)| q.cross(p));
    [p.iter().sum(), angular.sum()]
}

fn kinetic(layer: &Layer) -> f64 {
    let solid = layer.solid().expect("a body");
    let momentum = solid.momentum();
    let pairs = solid.state.velocities.iter().zip(&momentum);
    pairs.map(|(v, p)| 0.5 * v.dot(p)).sum()
}

/// A body that falls without anything around it: `x = g h^2 n (n + 1) / 2` after `n` steps.
#[test]
fn a_falling_body_falls_as_implicit_euler_does() {
    let driver = block();
    let gravity = Vector3::new(0.0, 1.0, -9.81);
    let plan = planned(
        &driver,
        &skin(Coupling::Hybrid),
        &Body { gravity, ..body() },
    );
    let mut layer = at_rest(&plan);
    let dynamics = Dynamics {
        time_step: 0.02,
        damping: 0.0,
    };
    for _ in 0..4 {
        step(&mut layer, &driver, dynamics);
    }
    let displacement = gravity * (0.02 * 0.02 * 10.0);
    for (x, rest) in layer.positions.iter().zip(&layer.skin.rest.positions) {
        assert!((x - rest - displacement).norm() < 1e-8 * displacement.norm());
    }
}

/// A body that turns, flies and quivers keeps its momentum; energy never grows. Without a torque
/// implicit Euler changes the angular momentum by `h sum v' x m v` of the new and old velocities,
/// a fraction of some `(w h)^2`, and by nothing else but what the foundation's fixed normals add.
#[test]
fn a_free_body_keeps_its_momentum_and_gains_no_energy() {
    let driver = block();
    let plan = planned(&driver, &skin(Coupling::Hybrid), &body());
    let mut layer = at_rest(&plan);
    let (speed, rate) = (Vector3::new(0.3, -0.1, 0.2), Vector3::new(1.0, 2.0, -2.0));
    let centre = 0.5 * Vector3::from(SIDES);
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let nodes = solid(&mut layer).state.q.len();
    let quiver = random_vectors(&mut random, nodes, 0.02);
    for (i, v) in quiver.iter().enumerate() {
        let state = &mut solid(&mut layer).state;
        state.velocities[i] = speed + rate.cross(&(state.q[i] - centre)) + v;
    }
    let dynamics = Dynamics {
        time_step: 0.005,
        damping: 0.0,
    };
    let (mut before, mut energy) = (momenta(&layer), kinetic(&layer));
    for _ in 0..6 {
        let old = solid(&mut layer).momentum();
        step(&mut layer, &driver, dynamics);
        let now = momenta(&layer);
        assert!((now[0] - before[0]).norm() < 1e-9 * before[0].norm());
        let pairs = solid(&mut layer).state.velocities.iter().zip(&old);
        let lost = pairs.map(|(v, p)| v.cross(p)).sum::<Vector3<f64>>() * dynamics.time_step;
        let torque = (now[1] - before[1] - lost).norm();
        assert!(
            torque < 1e-7 * before[1].norm(),
            "{}",
            torque / before[1].norm()
        );
        let total = kinetic(&layer) + layer.energy();
        assert!(total < energy, "{total} after {energy}");
        (before, energy) = (now, total);
    }
}

#[test]
fn what_passes_through_in_the_first_step_is_seen() {
    let driver = block();
    let radius = 0.002;
    let [start, end] = [SIDES[2] + 2.0 * radius, -2.0 * radius];
    let body = Body {
        obstacles: vec![Obstacle {
            name: "ball".into(),
            shape: ObstacleShape::Sphere {
                centre: Vector3::new(0.5 * SIDES[0], 0.5 * SIDES[1], start),
                radius,
            },
        }],
        ..body()
    };
    let mut pose = still(&driver);
    pose.motions = vec![Motion {
        of: "ball".into(),
        keyframes: vec![Keyframe {
            at: 1.0,
            translation: Vector3::z() * (end - start),
            turn: Vector3::zeros(),
            about: Vector3::zeros(),
        }],
    }];
    let poses = std::slice::from_ref(&pose);
    let spec = skin(Coupling::Hybrid);
    let plan = plan_body(
        &driver,
        std::slice::from_ref(&spec),
        &body,
        poses,
        &modelling(),
        1024,
    )
    .expect("a body");
    let mut layer = at_rest(&plan);
    let before = layer.state();
    let moves = Moves::of_body(&interior(&plan).body, &pose).expect("fitting motions");
    let around = (&moves, &pose.weights);
    layer.place_solid(around, 1.0, None).expect("a placed body");
    assert!(layer.has_passed(&before));
    assert_eq!(layer.penetration(), 0.0);
}
