//! Heat, fire and collisions of the springs of Jeong, Kim and Kim 2011: what the paper prints, and what was mended.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]
#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use nalgebra::Vector3;
use ruga_validation::spring_sheet::burning::{BurningSheet, Effects};
use ruga_validation::spring_sheet::{
    BurnRule, Collider, Conduction, Fuel, HeatBall, Projection, Shape, SpringFire, SpringLattice,
    SpringMotion, SpringState, TimeRule,
};

/// Eq. (3) at the middle of a star of a field at its points and 0 in the middle.
fn operator(star: &[[f64; 2]], field: impl Fn(f64, f64) -> f64) -> f64 {
    let place = |own: &[f64; 2]| Vector3::new(own[0], own[1], 0.0);
    let middle = std::iter::once(Vector3::zeros());
    let points: Vec<_> = middle.chain(star.iter().map(place)).collect();
    let ends = (1..=star.len() as u32).map(|end| [0, end]);
    let values: Vec<f64> = points.iter().map(|p| field(p.x, p.y)).collect();
    Conduction::new(ends, &points).laplacian(&values)[0]
}

/// The Laplacian of `x^2 + y^2` is 4, that of a linear field 0.
#[test]
fn the_umbrella_operator_is_half_the_laplacian_at_best() {
    let ring = |count: usize| -> Vec<[f64; 2]> {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        (0..count)
            .map(|k| [angle(k).cos(), angle(k).sin()])
            .collect()
    };
    let mut with_diagonals = ring(4);
    with_diagonals.extend([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]);
    for star in [ring(4), ring(6), with_diagonals] {
        let found = operator(&star, |x, y| x * x + y * y);
        assert!((found - 2.0).abs() < 1e-14, "{found}");
        let linear = operator(&star, |x, _| x);
        assert!(linear.abs() < 1e-14, "{linear}");
    }
    // The six points of a regular star, moved by up to a third.
    let star = [
        [1.2, 0.1],
        [0.4, 0.9],
        [-0.3, 0.7],
        [-1.1, 0.2],
        [-0.6, -0.9],
        [0.8, -1.0],
    ];
    let [x, y] = [operator(&star, |x, _| x), operator(&star, |_, y| y)];
    let error = x.hypot(y);
    println!("gradient 1 on an irregular star: {error:.3} instead of 0");
    assert!((error - 0.153).abs() < 1e-3, "{error}");
}

/// The implicit step solves its equation, spreads heat, and does not keep it.
#[test]
fn an_implicit_step_solves_the_printed_equation() {
    let (lattice, positions) = SpringLattice::rectangle([9, 6], 0.01, 0.002).unwrap();
    let springs = ruga_validation::spring_sheet::SpringColour::ALL
        .map(|colour| lattice.set(colour).ends().to_vec());
    let conduction = Conduction::new(springs.into_iter().flatten(), &positions);
    let before: Vec<f64> = positions
        .iter()
        .map(|p| 300.0 + 1e5 * p.x * p.x + 4000.0 * p.x)
        .collect();
    let reach = 3e-3;
    let mut after = before.clone();
    let iterations = conduction.step(reach, &mut after);
    let laplacian = conduction.laplacian(&after);
    let residual = after.iter().zip(&before).zip(&laplacian);
    let worst = residual
        .map(|((after, before), own)| (after - reach * own - before).abs())
        .fold(0.0, f64::max);
    assert!(iterations > 0 && worst < 1e-3, "{worst} K");
    // Corners and centres at the border have other stars than those inside.
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let drift = (mean(&after) - mean(&before)).abs();
    println!("{iterations} iterations, mean temperature moves by {drift:.2e} K");
    let spread = |values: &[f64]| {
        let most = values.iter().copied().fold(f64::MIN, f64::max);
        most - values.iter().copied().fold(f64::MAX, f64::min)
    };
    assert!(drift > 1.0, "{drift}");
    assert!(spread(&after) < 0.5 * spread(&before));
}

/// Fuel whose burning changes its temperature by 500 K, and which ignites at 500 K.
fn fuel(rule: BurnRule) -> Fuel {
    Fuel {
        rule,
        diffusivity: 0.0,
        ignition: 500.0,
        rate: 0.01,
        rise: 500.0,
        loss: None,
        loss_share: 0.5,
        least_share: 0.0,
    }
}

/// One cell of a sheet at 600 K that burns for a while: temperature (K) and share of mass.
fn burnt(fuel: Fuel, seconds: f64) -> [f64; 2] {
    let (lattice, positions) = SpringLattice::rectangle([1, 1], 0.01, 0.002).unwrap();
    let mut fire = SpringFire::new(fuel, positions.len(), 600.0);
    let heating = vec![0.0; positions.len()];
    for _ in 0..(seconds / 0.002).round() as usize {
        fire.step(&lattice, &positions, &heating, 0.002);
    }
    [fire.temperatures[0], fire.shares[0]]
}

/// The paper's sign cools; with the sign alone mended nothing ends it; mended, all fuel burns and heats.
#[test]
fn burning_as_printed_cools() {
    let [temperature, share] = burnt(fuel(BurnRule::Printed), 4.0);
    println!("printed: {temperature:.2} K, {share:.4} of the mass");
    assert!((temperature - 500.0).abs() < 0.01, "{temperature}");
    assert!((share - 0.80).abs() < 1e-4, "{share}");
    let sign_alone = Fuel {
        rise: -500.0,
        ..fuel(BurnRule::Printed)
    };
    let [temperature, share] = burnt(sign_alone, 2.0);
    println!("sign mended: {temperature:.1e} K, {share:.1e} masses");
    assert!(temperature > 1e6 && share < -1e3);
    let [temperature, share] = burnt(fuel(BurnRule::Mended), 4.0);
    assert!((temperature - 1100.0).abs() < 1e-6, "{temperature}");
    assert_eq!(share, 0.0);
    let cooling = Fuel {
        loss: Some((300.0, 0.5)),
        least_share: 0.1,
        ..fuel(BurnRule::Mended)
    };
    let [temperature, share] = burnt(cooling, 10.0);
    assert!((temperature - 300.0).abs() < 0.01, "{temperature}");
    assert!((0.1..1.0).contains(&share), "{share}");
}

/// Speed of a straight front over that of the closed form for the diffusivity that was asked for.
///
/// `c = 2 g sqrt(a dT mu)` with `p - 1 = 2 g exp(g (pi - acos g)/sqrt(1 - g^2))` and `p` the rise over ignition less
/// surroundings: here 3.43, so that `g` is 0.4440. For half the diffusivity it is the root of a half.
fn front_speed() -> f64 {
    let (theta, g, speed) = (280.0, 0.4440_f64, 1e-3);
    // Four cells in the width a/c that the front heats.
    let width = 4.0 * CELL;
    let fuel = Fuel {
        rule: BurnRule::Mended,
        diffusivity: speed * width,
        ignition: 573.0,
        rate: speed / (4.0 * g * g * width * 3.43 * theta),
        rise: 3.43 * theta,
        loss: None,
        loss_share: 0.5,
        least_share: 0.0,
    };
    let (lattice, positions) = SpringLattice::rectangle([72, 8], CELL, 0.25 * CELL).unwrap();
    let mut fire = SpringFire::new(fuel, positions.len(), 293.0);
    let start = positions[0].x;
    for (temperature, position) in fire.temperatures.iter_mut().zip(&positions) {
        if position.x < start + 12.0 * CELL {
            *temperature = 1253.0;
        }
    }
    let heating = vec![0.0; positions.len()];
    let step = 0.1 * CELL / speed;
    // Corners in the middle line, 24 and 54 cells along, nine a column. Along a border the operator is more than half
    // the Laplacian, and a strip of one cell has nothing but borders: there the front has 0.754 of its speed.
    let mut times = [24, 54].map(|column| (9 * column + 4, f64::NAN));
    for n in 0..700 {
        fire.step(&lattice, &positions, &heating, step);
        for (corner, time) in &mut times {
            if time.is_nan() && fire.shares[*corner] < 0.5 {
                *time = step * n as f64;
            }
        }
    }
    30.0 * CELL / ((times[1].1 - times[0].1) * speed)
}

/// Side of a cell of the strip along which the front runs (m).
const CELL: f64 = 2.5e-4;

#[test]
fn a_mended_front_is_as_slow_as_half_the_diffusivity_makes_it() {
    let found = front_speed();
    println!("front: {found:.3} of the closed form, which for half the diffusivity is 0.707");
    assert!((found - 0.5_f64.sqrt()).abs() < 0.03, "{found}");
}

#[test]
fn springs_are_shrunk_partly_burnt_or_burnt() {
    use SpringState::{Burnt, PartlyBurnt, Shrunk};
    let found = [
        [0.4, 0.1],
        [0.0, 0.0],
        [0.1, -0.1],
        [-0.3, 0.2],
        [-0.1, -0.1],
    ];
    let found = found.map(SpringState::of);
    assert_eq!(found, [Shrunk, Shrunk, PartlyBurnt, PartlyBurnt, Burnt]);
    // The relative masses at both ends as a burning sheet has them, from the paper's m_loss.
    let mut fire = SpringFire::new(fuel(BurnRule::Mended), 2, 300.0);
    fire.shares = vec![0.75, 0.25];
    assert_eq!(fire.relative_masses(), [0.25, -0.25]);
}

/// Drops a sheet on to something, and says how deep in it a particle ever is at the end of a step (m).
fn deepest(shape: Shape, velocity: Vector3<f64>, rule: TimeRule) -> f64 {
    let (lattice, positions) = SpringLattice::rectangle([8, 8], 0.025, 0.005).unwrap();
    let masses = vec![1e-3; positions.len()];
    let weight = vec![Vector3::new(0.0, 0.0, -9.81e-3); positions.len()];
    let mut motion = SpringMotion::at_rest(positions, masses, rule);
    motion.colliders.push(Collider {
        velocity,
        ..Collider::fixed(shape)
    });
    let mut deepest = f64::MIN;
    let mut touched = false;
    for _ in 0..100 {
        motion.step(&lattice, &Projection::default(), &weight);
        for (position, velocity) in motion.positions.iter().zip(&motion.velocities) {
            let (normal, depth) = motion.colliders[0].depth(position);
            deepest = deepest.max(depth);
            if depth > -1e-9 {
                touched = true;
                let inward = (motion.colliders[0].velocity - velocity).dot(&normal);
                assert!(inward < 1e-9, "{inward} m/s");
            }
        }
    }
    assert!(touched, "nothing was met");
    deepest
}

#[test]
fn a_falling_sheet_stays_out_of_what_it_falls_on() {
    let sphere = Shape::Sphere {
        centre: Vector3::new(0.01, 0.0, -0.09),
        radius: 0.08,
    };
    let slope = Vector3::new(0.3, 0.0, 1.0).normalize();
    let plane = Shape::Plane {
        point: Vector3::new(0.0, 0.0, -0.06),
        normal: slope,
    };
    for rule in [TimeRule::Massless, TimeRule::Mended] {
        for shape in [sphere, plane] {
            let depth = deepest(shape, Vector3::zeros(), rule);
            assert!(depth < 1e-15, "{depth}");
        }
        let depth = deepest(sphere, Vector3::new(0.0, 0.2, 0.4), rule);
        assert!(depth < 1e-15, "{depth}");
    }
}

/// Friction slows what slides, and stops it if it is strong enough.
#[test]
fn friction_stops_a_sheet_on_a_slope() {
    let slide = |friction: f64| {
        let (lattice, positions) = SpringLattice::rectangle([2, 2], 0.025, 0.005).unwrap();
        let masses = vec![1e-3; positions.len()];
        let weight = vec![Vector3::new(5e-3, 0.0, -8.4e-3); positions.len()];
        let mut motion = SpringMotion::at_rest(positions, masses, TimeRule::Mended);
        let (point, normal) = (Vector3::zeros(), Vector3::z());
        motion.colliders.push(Collider {
            friction,
            ..Collider::fixed(Shape::Plane { point, normal })
        });
        for _ in 0..50 {
            motion.step(&lattice, &Projection::default(), &weight);
        }
        motion.velocities[4].x
    };
    let [smooth, rough] = [0.0, 1.0].map(slide);
    assert!(
        smooth > 0.4 && rough.abs() < 0.05 * smooth,
        "{smooth} {rough}"
    );
}

/// Momentum that projection gives to a free sheet which burns from a corner, over its mass and the speed of its fire.
fn drift(rule: TimeRule) -> f64 {
    let (lattice, positions) = SpringLattice::rectangle([10, 10], 0.01, 0.0025).unwrap();
    let masses = vec![1e-5; positions.len()];
    let mass: f64 = masses.iter().sum();
    let motion = SpringMotion::at_rest(positions, masses, rule);
    let fuel = Fuel {
        diffusivity: 1e-3,
        rate: 0.02,
        least_share: 0.3,
        loss_share: 0.2,
        ..fuel(BurnRule::Mended)
    };
    let fire = SpringFire::new(fuel, motion.positions.len(), 300.0);
    let mut sheet = BurningSheet::new(lattice, motion, fire);
    let ball = HeatBall {
        centre: Vector3::new(-0.05, -0.05, 0.0),
        radius: 0.03,
        heating: 5e3,
    };
    sheet.ball = Some((ball, Vector3::zeros()));
    let mut given = Vector3::zeros();
    for _ in 0..150 {
        let before = sheet.motion.velocities.clone();
        sheet.step().unwrap();
        // What is lost goes with the velocity that it had; the rest is what the step has given.
        let moved = sheet.motion.velocities.iter().zip(&before);
        let all = moved.zip(&sheet.motion.masses);
        given += all
            .map(|((after, before), mass)| (after - before) * *mass)
            .sum::<Vector3<f64>>();
    }
    assert!(sheet.fire.shares.iter().any(|share| *share < 0.5));
    assert!(sheet.fire.shares.iter().any(|share| *share > 0.9));
    assert_eq!(sheet.effects, Effects::Both);
    // 2 g sqrt(a dT mu) with p = 2.5, half the diffusivity.
    let front = 2.0 * 0.35 * (0.5 * 1e-3 * 500.0 * 0.02_f64).sqrt();
    given.norm() / (mass * front)
}

#[test]
fn a_free_burning_sheet_drives_itself_without_masses() {
    let [printed, mended] = [TimeRule::Massless, TimeRule::Mended].map(drift);
    println!(
        "momentum over mass and speed of the front: {printed:.2e} without masses, {mended:.2e} by mass"
    );
    assert!(printed > 1e-3, "{printed}");
    assert!(mended < 1e-9, "{mended}");
}
