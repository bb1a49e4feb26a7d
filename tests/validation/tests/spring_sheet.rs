//! Springs and projection of Jeong, Kim and Kim 2011: what the paper prints, what it does, and what it does not.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]
#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use nalgebra::Vector3;
use ruga_validation::curling_strip::curling_strip;
use ruga_validation::spring_sheet::curl::CurlStrip;
use ruga_validation::spring_sheet::{
    Mobility, Projection, ProjectionReport, Solver, SpringColour, SpringError, SpringLattice,
    SpringMotion, SpringSet, TimeRule, fast_projection,
};

/// Two springs of the paper's figure 9, from held points at -1 and 1 to a point at 0: positions after each
/// projection on to one and on to the other.
fn two_springs(mobility: &Mobility, steps: usize) -> Vec<[f64; 2]> {
    let set = |end: u32, target: f64| {
        let mut set = SpringSet::new(vec![[2, end]], vec![1.0], 3).unwrap();
        set.set_target_lengths(&[target]).unwrap();
        set
    };
    let (green, blue) = (set(0, 1.65), set(1, 0.55));
    let mut points = [-1.0, 1.0, 0.0].map(|x| Vector3::new(x, 0.0, 0.0));
    let mut solver = Solver::default();
    let mut project = |set: &SpringSet| {
        set.project(&mut points, mobility, 1.0, &mut solver);
        points[2].x
    };
    (0..steps)
        .map(|_| [project(&green), project(&blue)])
        .collect()
}

/// Table 1, in which digits are cut off and not rounded. What the paper calls convergence is a cycle of two states.
#[test]
fn table_one_comes_out_when_held_ends_count_as_movable() {
    let printed = [
        [0.4306, 0.4401],
        [0.5527, 0.4954],
        [0.5767, 0.5038],
        [0.5804, 0.5050],
        [0.5810, 0.5052],
    ];
    let held = [true, true, false];
    let found = two_springs(&Mobility::printed(&held), 200);
    for (found, printed) in found.iter().zip(printed) {
        for (found, printed) in found.iter().zip(printed) {
            assert!((found - printed).abs() < 1.5e-4, "{found} {printed}");
        }
    }
    let [green, blue] = found[199];
    assert!((green - 0.5811).abs() < 1e-4, "{green}");
    assert!((blue - 0.5053).abs() < 1e-4, "{blue}");

    // With the matrix that the paper's equation has, each projection is a Newton step. Within the paper's seven
    // steps the point leaves the figure on both sides; from the 25th on it is in another cycle of two states.
    let right = two_springs(&Mobility::without_held(&held), 200);
    println!("held ends left out: {:.4?}", &right[..7]);
    let early = right[..7].iter().flatten();
    let (least, most) = early.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
    assert!(least < -5.0 && most > 4.0, "{least} {most}");
    let [green, blue] = right[199];
    assert!((green - 0.6790).abs() < 1e-4, "{green}");
    assert!((blue - 0.3683).abs() < 1e-4, "{blue}");
}

/// The curl (share of that wanted) of a strip of 4 cells across after numbers of projections, with the corner layer
/// 2 % shorter.
fn curls(along: usize, thickness: f64, steps: &[usize]) -> Vec<f64> {
    let mut strip = CurlStrip::new([along, 4], 1.0, thickness, 0.02).unwrap();
    let mut done = 0;
    let mut after = |&steps: &usize| {
        let own = steps - done;
        done = steps;
        strip.project(&Projection {
            steps: own,
            threshold: 0.0,
            ..Projection::default()
        });
        strip.curl()
    };
    let curls = steps.iter().map(&mut after).collect();
    println!("{along} cells, {thickness} of one thick: {curls:.3?} after {steps:?}");
    curls
}

/// No definite curl comes out: it depends on how often is projected, on thickness, and on the number of cells.
#[test]
fn a_strip_curls_as_far_as_it_is_projected() {
    let steps = [1, 7, 1000];
    let [first, seven, all] = curls(20, 0.25, &steps)[..] else {
        unreachable!("three numbers of steps")
    };
    assert!(first < 0.01, "{first}");
    assert!((seven - 0.16).abs() < 0.02, "{seven}");
    assert!((all - 0.45).abs() < 0.1, "{all}");
    let [_, seven, all] = curls(20, 0.0625, &steps)[..] else {
        unreachable!("three numbers of steps")
    };
    assert!((seven - 0.029).abs() < 0.005, "{seven}");
    assert!((all - 0.08).abs() < 0.02, "{all}");
    let [_, seven, all] = curls(40, 0.25, &steps)[..] else {
        unreachable!("three numbers of steps")
    };
    assert!((seven - 0.14).abs() < 0.02, "{seven}");
    assert!((all - 0.25).abs() < 0.06, "{all}");
}

/// A strip ten times as long as wide, in which the product's coarsest mesh is what springs would be if they could.
#[test]
fn the_product_bends_as_far_as_springs_want() {
    let springs = CurlStrip::new([40, 4], 0.025, 0.25 * 0.025, 0.02).unwrap();
    let found = curling_strip(2, springs.wanted, 0.25 * 0.025).unwrap();
    println!(
        "2 triangles across: {:.4} of what is wanted in {} Newton steps",
        found.curl(),
        found.steps
    );
    assert!(found.converged && found.capped == 0);
    assert!((found.curl() - 1.0).abs() < 0.01, "{}", found.curl());
    assert!(curling_strip(2, 0.0, 1e-3).is_err());
    assert!(curling_strip(2, f64::NAN, 1e-3).is_err());
    assert!(curling_strip(2, 1.0, -1e-3).is_err());
}

/// Strain (%) of red, green, blue and yellow springs of a sheet after many projections.
fn strains(order: [SpringColour; 4]) -> [f64; 4] {
    let mut strip = CurlStrip::new([20, 4], 1.0, 0.25, 0.02).unwrap();
    strip.project(&Projection {
        steps: 200,
        threshold: 0.0,
        order,
        ..Projection::default()
    });
    let strains =
        SpringColour::ALL.map(|colour| 100.0 * strip.lattice.set(colour).strain(&strip.positions));
    println!("strain in R, G, B, Y, order {order:?}: {strains:.3?} %");
    strains
}

#[test]
fn the_last_set_is_right_and_the_others_carry_the_error() {
    use SpringColour::{Blue, Green, Red, Yellow};
    let [red, green, blue, yellow] = strains([Red, Green, Blue, Yellow]);
    assert!(yellow < 0.01, "{yellow}");
    assert!(red > 100.0 * yellow && green > yellow && blue > yellow);
    let [red, green, blue, yellow] = strains([Yellow, Blue, Green, Red]);
    assert!(red < green.min(blue).min(yellow), "{red}");
    assert!(blue > 1.0, "{blue}");
}

/// The paper's figure 8 is said to show that the sum always falls.
#[test]
fn the_sum_of_the_errors_rises_in_some_steps() {
    let mut strip = CurlStrip::new([20, 4], 1.0, 0.25, 0.1).unwrap();
    let report = strip.project(&Projection {
        steps: 39,
        threshold: 0.0,
        ..Projection::default()
    });
    println!("{} of 39 steps rose", report.rises());
    assert!(report.rises() > 0);
    assert!(!report.converged);
}

/// Momentum of a free sheet, over its mass and its fastest particle: its particles weigh differently, as they do
/// while it burns, and its springs shrink by what their ends have lost.
fn momentum_of_free_sheet(rule: TimeRule) -> f64 {
    let (mut lattice, positions) = SpringLattice::rectangle([8, 8], 1.0, 0.25).unwrap();
    let shares: Vec<f64> = positions.iter().map(|p| 0.9 + 0.02 * p.x).collect();
    lattice.set_volume_shares(&shares).unwrap();
    let forces = vec![Vector3::zeros(); positions.len()];
    let total: f64 = shares.iter().sum();
    let mut motion = SpringMotion::at_rest(positions, shares, rule);
    for _ in 0..10 {
        motion.step(&lattice, &Projection::default(), &forces);
    }
    let speeds = motion.velocities.iter().map(|v| v.norm());
    motion.momentum().norm() / (total * speeds.fold(0.0, f64::max))
}

#[test]
fn projection_without_masses_drives_a_free_sheet() {
    let [printed, mended] = [TimeRule::Printed, TimeRule::Mended].map(momentum_of_free_sheet);
    println!(
        "momentum over mass and fastest particle: {printed:.2e} printed, {mended:.2e} by mass"
    );
    assert!(printed > 1e-4, "{printed}");
    assert!(mended < 1e-12, "{mended}");
}

/// Eq. (8) and (9) as printed: no mass, and a velocity that is a displacement.
#[test]
fn time_steps_as_printed_and_mended() {
    let (lattice, positions) = SpringLattice::rectangle([2, 1], 1.0, 0.25).unwrap();
    let masses = vec![4.0; positions.len()];
    let weight = vec![Vector3::new(0.0, 0.0, -8.0); positions.len()];
    let fall = |rule: TimeRule| {
        let mut motion = SpringMotion::at_rest(positions.clone(), masses.clone(), rule);
        let report = motion.step(&lattice, &Projection::default(), &weight);
        assert!(report.converged && report.iterations == 0);
        [motion.positions[0].z, motion.velocities[0].z]
    };
    assert_eq!(fall(TimeRule::Printed), [-0.016, -0.016]);
    let [z, velocity] = fall(TimeRule::Mended);
    assert!((velocity + 0.004).abs() < 1e-15 && (z + 8e-6).abs() < 1e-15);
    // Held particles stay.
    let mut motion = SpringMotion::at_rest(positions.clone(), masses.clone(), TimeRule::Mended);
    motion.held[0] = true;
    for _ in 0..20 {
        motion.step(&lattice, &Projection::default(), &weight);
    }
    assert_eq!(motion.positions[0], positions[0]);
    assert!(motion.positions[1..].iter().any(|p| p.z < -1e-4));
}

/// Figure 10: smaller weights slow the projection of blue and yellow springs, which makes a sheet soft.
#[test]
fn weights_leave_springs_longer() {
    let strain = |weight: f64| {
        let mut strip = CurlStrip::new([8, 4], 1.0, 0.25, 0.1).unwrap();
        strip.project(&Projection {
            weight,
            ..Projection::default()
        });
        strip
            .lattice
            .set(SpringColour::Blue)
            .strain(&strip.positions)
    };
    let [stiff, soft] = [1.0, 0.1].map(strain);
    assert!(soft > 3.0 * stiff, "{soft} {stiff}");
}

#[test]
fn a_lattice_has_ten_springs_a_cell_but_at_its_border() {
    let (lattice, positions) = SpringLattice::rectangle([10, 7], 0.1, 0.02).unwrap();
    let counts = SpringColour::ALL.map(|colour| lattice.set(colour).ends().len());
    assert_eq!(counts, [280, 9 * 7 + 10 * 6, 10 * 8 + 11 * 7, 140]);
    assert_eq!(positions.len(), 11 * 8 + 70);
    let report = CurlStrip::new([10, 7], 0.1, 0.02, 0.0)
        .unwrap()
        .project(&Projection::default());
    assert!(report.converged && report.errors.len() == 1, "at rest");
}

#[test]
fn what_is_no_lattice_is_refused() {
    let points: Vec<Vector3<f64>> = (0..12)
        .map(|i| Vector3::new(f64::from(i), f64::from(i * i), 0.0))
        .collect();
    let of = |cells: &[[u32; 4]]| SpringLattice::new(points.clone(), cells.to_vec(), 0.1).err();
    let (element, particles) = (0, 12);
    assert_eq!(
        of(&[[0, 1, 2, 12]]),
        Some(SpringError::Ends { element, particles })
    );
    assert_eq!(
        of(&[[0, 1, 1, 2]]),
        Some(SpringError::Ends { element, particles })
    );
    let edge = [0, 1];
    assert_eq!(
        of(&[[0, 1, 2, 3], [0, 1, 4, 5], [1, 0, 6, 7]]),
        Some(SpringError::Edge { edge })
    );
    // Five cells around one corner.
    let fan: Vec<[u32; 4]> = (0..5)
        .map(|i| [0, 2 * i + 1, 2 * i + 2, (2 * i + 2) % 10 + 1])
        .collect();
    assert_eq!(of(&fan), Some(SpringError::Star { particle: 0 }));
    assert!(SpringLattice::rectangle([2, 2], 0.0, 0.1).is_err());
    assert!(SpringLattice::rectangle([2, 2], f64::NAN, 0.1).is_err());
    let (mut lattice, _) = SpringLattice::rectangle([2, 2], 1.0, 0.1).unwrap();
    assert!(lattice.set_volume_shares(&[1.0]).is_err());
    assert!(lattice.set_volume_shares(&[f64::NAN; 13]).is_err());
    let nothing = &Mobility::printed(&[]);
    let settings = Projection::default();
    let report = fast_projection(
        &lattice,
        nothing,
        &settings,
        &mut [],
        &mut Solver::default(),
    );
    assert_eq!(report, ProjectionReport::default());
    // Shares of nothing are held above zero.
    lattice.set_volume_shares(&[0.0; 13]).unwrap();
    assert!(
        lattice
            .set(SpringColour::Blue)
            .target_lengths()
            .iter()
            .all(|l| *l > 0.0)
    );
}
