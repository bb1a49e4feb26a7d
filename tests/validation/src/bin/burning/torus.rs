//! Figure 7 (a, b), a torus that falls on a sphere, and 11, a torus that burns.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use nalgebra::Vector3;
use ruga_validation::cpu_seconds;
use ruga_validation::spring_sheet::{
    Collider, Fuel, HeatBall, MassSpring, Projection, Remnant, Shape, SpringError, SpringLattice,
    SpringMotion, TIME_STEP, TimeRule,
};

use crate::fires::{FUEL, GRAVITY, film, scene, sheet};
use crate::pictures::{Fineness, Picture};
use crate::sheets::{GREY, Scene, View, draw};
use crate::stiffness::strain;

/// Radii of the ring and of its tube (m).
pub(crate) const RING: f64 = 0.1;
pub(crate) const TUBE: f64 = 0.04;

/// Radius of the sphere over that of the hole.
pub(crate) const SPHERE: f64 = 1.2;

/// Height of the ring above the sphere's centre at first, and of the floor (m).
pub(crate) const START: f64 = 0.08;
pub(crate) const FLOOR: f64 = -0.16;

/// Mass of the one that falls (kg).
pub(crate) const MASS: f64 = 0.1;

/// A place (m) on a torus at the origin, by the angles (rad) round the ring and round the tube.
pub(crate) fn place([ring, own]: [f64; 2]) -> Vector3<f64> {
    let from = RING + TUBE * own.cos();
    Vector3::new(from * ring.cos(), from * ring.sin(), TUBE * own.sin())
}

/// A torus of quadrilaterals, so many round the ring and a third of that round the tube, centres outside.
fn torus(around: usize) -> Result<(SpringLattice, Vec<Vector3<f64>>), SpringError> {
    let tube = around / 3;
    let angles =
        |i: usize, j: usize| [(i, around), (j, tube)].map(|(k, n)| TAU * k as f64 / n as f64);
    let positions = (0..around).flat_map(|i| (0..tube).map(move |j| place(angles(i, j))));
    let at = |i: usize, j: usize| (i % around * tube + j % tube) as u32;
    let square = |i, j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    let cells = (0..around).flat_map(|i| (0..tube).map(move |j| square(i, j)));
    let thickness = 0.25 * TAU * TUBE / tube as f64;
    SpringLattice::new(positions.collect(), cells.collect(), thickness)
}

/// Steps after which the falling torus is looked at.
const MOMENTS: [usize; 4] = [1, 60, 150, 500];

/// A torus falls on a sphere that is wider than its hole: above by projection, below as a mass-spring system.
pub(crate) fn falling(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 7 (a, b)");
    let (lattice, mut positions) = torus(fine.around)?;
    let radius = SPHERE * (RING - TUBE);
    positions.iter_mut().for_each(|p| p.z += START);
    let mass = MASS / positions.len() as f64;
    let centre = Vector3::zeros();
    let shapes = [
        Shape::Sphere { centre, radius },
        Shape::Plane {
            point: Vector3::new(0.0, 0.0, FLOOR),
            normal: Vector3::z(),
        },
    ];
    let colliders = shapes.map(|shape| Collider {
        friction: 0.3,
        ..Collider::fixed(shape)
    });
    let mut held = SpringMotion::at_rest(
        positions.clone(),
        vec![mass; positions.len()],
        TimeRule::Massless,
    );
    held.colliders = colliders.to_vec();
    let mut hooke = MassSpring::at_rest(positions.clone(), mass);
    hooke.colliders = colliders.to_vec();
    let weight = vec![GRAVITY * mass; positions.len()];
    let projection = Projection::default();
    let mut facts = Vec::new();
    let mut rows = [Vec::new(), Vec::new()];
    let (mut done, mut seconds) = (0, [0.0; 2]);
    for moment in MOMENTS {
        let start = cpu_seconds();
        for _ in done..moment {
            held.step(&lattice, &projection, &weight);
        }
        let middle = cpu_seconds();
        for _ in done..moment {
            hooke.step(&lattice, GRAVITY);
        }
        seconds[0] += middle - start;
        seconds[1] += cpu_seconds() - middle;
        done = moment;
        for (row, positions) in rows.iter_mut().zip([&held.positions, &hooke.positions]) {
            row.push(seen(&lattice, positions).with_sphere(centre, radius, GREY));
        }
    }
    for (name, positions, seconds) in [
        ("projection", &held.positions, seconds[0]),
        ("mass-spring", &hooke.positions, seconds[1]),
    ] {
        let heights = positions.iter().map(|p| p.z);
        let mean = heights.clone().sum::<f64>() / positions.len() as f64;
        facts.push(format!(
            "{name}: mean height {:.0} mm above the sphere's centre, lowest point {:.0} mm, after {:.1} s; {seconds:.2} s \
             of processor",
            1e3 * mean,
            1e3 * heights.fold(f64::MAX, f64::min),
            TIME_STEP * done as f64
        ));
    }
    facts.push(format!(
        "blue springs are longer by {:.2} % (projection) and {:.1} % (mass-spring), root mean square",
        100.0 * strain(&lattice, &held.positions),
        100.0 * strain(&lattice, &hooke.positions)
    ));
    let view = View {
        turn: 0.0,
        nod: -1.25,
    };
    let scenes: Vec<Scene> = rows.concat();
    draw(&folder.join("torus.png"), &scenes, (4, [0.34, 0.36]), view)?;
    Ok(Picture {
        file: "torus.png".to_owned(),
        what: "figure 7 (a, b): a torus falls on a sphere of 1.2 times the radius of its hole; four moments by \
               projection, the same by a mass-spring system"
            .to_owned(),
        springs: lattice.spring_count(),
        steps: 2 * done,
        seconds: seconds.iter().sum(),
        facts,
    })
}

/// All of a torus that does not burn.
fn seen(lattice: &SpringLattice, positions: &[Vector3<f64>]) -> Scene {
    let whole = vec![1.0; positions.len()];
    let cut = |at: &[Vector3<f64>]| Remnant::new(lattice, at, &whole);
    // A mark in the middle of a square everywhere: no grid, all of the mass.
    let marks = vec![Vector3::new(0.5, 0.5, 1.0); positions.len()];
    let cold = vec![Vector3::zeros(); positions.len()];
    Scene::sheet(&cut(positions), &cut(&marks), &cut(&cold))
}

/// A torus without weight that a hot sphere sets on fire at its left.
pub(crate) fn burning(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 11");
    let area = TAU * TAU * RING * TUBE;
    let fuel = Fuel {
        diffusivity: 3e-3,
        rate: 0.03,
        rise: 1400.0,
        loss_share: 0.6,
        least_share: 0.5,
        loss: Some((293.0, 2.0)),
        ..FUEL
    };
    let mut sheet = sheet(torus(fine.around)?, area, fuel, 293.0);
    let ball = HeatBall {
        centre: Vector3::new(-RING - TUBE, 0.0, 0.0),
        radius: 0.05,
        heating: 9000.0,
    };
    sheet.ball = Some((ball, Vector3::zeros()));
    let springs = sheet.springs().spring_count();
    let whole = sheet.cut(sheet.rest()).area();
    let mut scenes = Vec::new();
    let moments = [150, 350, 550, 750];
    let seconds = film(&mut sheet, &moments, |sheet| {
        scenes.push(scene(sheet, 0.0, [0, 1]));
    })?;
    let left = sheet.cut(sheet.rest()).area() / whole;
    let view = View {
        turn: -0.5,
        nod: -0.8,
    };
    draw(
        &folder.join("burning_torus.png"),
        &scenes,
        (4, [0.34, 0.0]),
        view,
    )?;
    Ok(Picture {
        file: "burning_torus.png".to_owned(),
        what: "figure 11: a torus that a hot sphere sets on fire".to_owned(),
        springs,
        steps: moments[3],
        seconds,
        facts: vec![format!(
            "after {:.2} s {:.1} % of the torus is left",
            TIME_STEP * moments[3] as f64,
            100.0 * left
        )],
    })
}
