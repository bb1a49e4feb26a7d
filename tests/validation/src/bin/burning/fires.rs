//! Figures 1 and 12, a paper that is too hot at first, and 4, a hot sphere that crosses a sheet.

use std::error::Error;
use std::path::Path;

use nalgebra::Vector3;
use ruga_validation::cpu_seconds;
use ruga_validation::spring_sheet::burning::{BurningSheet, Effects};
use ruga_validation::spring_sheet::{
    BurnRule, Collider, Fuel, HeatBall, Shape, SpringFire, SpringLattice, SpringMotion, TimeRule,
};

use crate::pictures::{Fineness, Picture};
use crate::sheets::{GREY, Scene, View, draw};

/// Longest side of a sheet (m).
pub(crate) const SIDE: f64 = 0.28;

/// Distance of the two layers, in cells.
const THICKNESS: f64 = 0.25;

/// Mass of a sheet per area (kg/m2): office paper.
const AREAL_MASS: f64 = 0.08;

/// Lines to a metre of the grid that is printed on a sheet.
pub(crate) const GRID: f64 = 40.0;

/// A point of the floor (m).
pub(crate) const FLOOR: Vector3<f64> = Vector3::new(0.0, 0.0, -0.001);

pub(crate) const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Temperatures of surroundings and ignition (K).
const SURROUNDINGS: f64 = 293.0;
const IGNITION: f64 = 573.0;

/// Fuel of a sheet that goes out where nothing heats it: as the paper has no values, these are chosen.
pub(crate) const FUEL: Fuel = Fuel {
    rule: BurnRule::Mended,
    diffusivity: 3e-4,
    ignition: IGNITION,
    rate: 0.01,
    rise: 150.0,
    loss: Some((SURROUNDINGS, 0.3)),
    loss_share: 0.75,
    least_share: 0.6,
};

/// Share of its velocity that a particle keeps: paper that falls flat comes to a metre per second, which it reaches in a
/// tenth of a second. Without any drag a sheet that shrinks leaps off the floor.
pub(crate) const KEPT: f64 = 0.98;

/// Puts fuel on a sheet that moves with masses as printed but with the `h` that eq. (9) lacks.
pub(crate) fn sheet(
    (lattice, positions): (SpringLattice, Vec<Vector3<f64>>),
    area: f64,
    fuel: Fuel,
    temperature: f64,
) -> BurningSheet {
    let count = positions.len();
    let masses = vec![AREAL_MASS * area / count as f64; count];
    let motion = SpringMotion::at_rest(positions, masses, TimeRule::Massless);
    let mut sheet = BurningSheet::new(lattice, motion, SpringFire::new(fuel, count, temperature));
    sheet.kept = KEPT;
    sheet
}

/// What is seen of a sheet now, with a grid of `squares` to a metre printed on it along two axes of its rest.
pub(crate) fn scene(sheet: &BurningSheet, squares: f64, axes: [usize; 2]) -> Scene {
    let shares = sheet.rest().iter().zip(&sheet.fire.shares);
    let marks: Vec<Vector3<f64>> = shares
        .map(|(p, share)| {
            Vector3::new(
                squares * p[axes[0]] + 0.5,
                squares * p[axes[1]] + 0.5,
                *share,
            )
        })
        .collect();
    let hot = sheet.fire.temperatures.iter();
    let heat: Vec<Vector3<f64>> = hot.map(|t| Vector3::new(*t, 0.0, 0.0)).collect();
    Scene::sheet(&sheet.remnant(), &sheet.cut(&marks), &sheet.cut(&heat))
}

/// Least weight of the rate, between veins; the largest is 1.
pub(crate) const LEAST_RATE: f64 = 0.15;

/// Weight of the rate at a place in shares of the sheet: bright veins between darker islands. The paper's textures came
/// with its results, which are not at hand.
pub(crate) fn texture(u: f64, v: f64) -> f64 {
    let bend = 0.35 * (5.0 * v + 1.3).sin() + 0.2 * (11.0 * u).sin();
    let first = (7.0 * (u + bend)).sin();
    let second = (6.0 * (v - 0.3 * (4.0 * u).sin())).cos();
    let vein = 1.0 - first.abs().min(second.abs());
    LEAST_RATE + (1.0 - LEAST_RATE) * vein * vein
}

/// Runs a sheet up to each of several steps and looks at it there; gives the processor seconds of the steps.
pub(crate) fn film(
    sheet: &mut BurningSheet,
    moments: &[usize],
    mut look: impl FnMut(&BurningSheet),
) -> Result<f64, Box<dyn Error>> {
    let (mut done, mut seconds) = (0, 0.0);
    for &moment in moments {
        let start = cpu_seconds();
        for _ in done..moment {
            sheet.step()?;
        }
        seconds += cpu_seconds() - start;
        done = moment;
        look(sheet);
    }
    Ok(seconds)
}

/// A sheet of paper on a floor, all of it above ignition, whose rate of loss has a texture.
pub(crate) fn paper(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figures 1 and 12");
    let cell = SIDE / fine.cells as f64;
    let cells = [fine.cells, fine.cells * 3 / 4];
    let fuel = Fuel {
        diffusivity: 2e-5,
        rise: 100.0,
        rate: 0.004,
        loss: Some((SURROUNDINGS, 2.0)),
        loss_share: 0.6,
        least_share: 0.5,
        ..FUEL
    };
    let rectangle = SpringLattice::rectangle(cells, cell, THICKNESS * cell)?;
    let mut sheet = sheet(rectangle, 0.75 * SIDE * SIDE, fuel, 900.0);
    let places = sheet.rest().iter();
    sheet.fire.weights = places
        .map(|p| texture(0.5 + p.x / SIDE, 0.5 + p.y / SIDE))
        .collect();
    sheet.gravity = GRAVITY;
    let point = FLOOR;
    let normal = Vector3::z();
    sheet.motion.colliders.push(Collider {
        friction: 0.5,
        ..Collider::fixed(Shape::Plane { point, normal })
    });
    let area = sheet.cut(sheet.rest()).area();
    let (mut scenes, mut facts) = (Vec::new(), Vec::new());
    let moments = [1, 150, 300, 500, 1000];
    let springs = sheet.springs().spring_count();
    let seconds = film(&mut sheet, &moments, |sheet| {
        scenes.push(scene(sheet, GRID, [0, 1]).with_floor(FLOOR, 0.58 * SIDE));
        let left = sheet.cut(sheet.rest()).area() / area;
        facts.push(format!(
            "after {:.2} s {:.1} % of the sheet is left, in {} pieces",
            sheet_time(sheet, moments[facts.len()]),
            100.0 * left,
            sheet.remnant().pieces().len()
        ));
    })?;
    let view = View {
        turn: 0.3,
        nod: -0.85,
    };
    draw(
        &folder.join("paper.png"),
        &scenes,
        (5, [1.25 * SIDE, 0.0]),
        view,
    )?;
    Ok(Picture {
        file: "paper.png".to_owned(),
        what: "figures 1 and 12: paper above ignition at first, rate of loss by a texture"
            .to_owned(),
        springs,
        steps: 1000,
        seconds,
        facts,
    })
}

fn sheet_time(sheet: &BurningSheet, steps: usize) -> f64 {
    sheet.motion.time_step * steps as f64
}

/// Figure 4, (a) to (d), a picture each.
pub(crate) fn hot_sphere(folder: &Path, fine: Fineness) -> Result<Vec<Picture>, Box<dyn Error>> {
    let variants = [
        ("a", "removal alone", Effects::Removal),
        ("b", "shrinkage alone", Effects::Shrinkage),
        ("c", "removal and shrinkage", Effects::Both),
        ("d", "both, rate of loss by a texture", Effects::Both),
    ];
    let mut pictures = Vec::new();
    for (letter, what, effects) in variants {
        eprintln!("figure 4 ({letter})");
        pictures.push(crossing(folder, fine, (letter, what, effects))?);
    }
    Ok(pictures)
}

/// Radius of the hot sphere (m), its speed (m/s), and what it heats by (K/s).
pub(crate) const BALL: [f64; 3] = [0.035, 0.15, 4000.0];

/// Steps after which the sheet is looked at: the sphere is at its left edge, in its middle, past it, and far.
const MOMENTS: [usize; 4] = [300, 620, 1120, 1300];

/// A sheet that hangs by two corners, and a hot sphere that goes through it from the left to the right.
fn crossing(
    folder: &Path,
    fine: Fineness,
    (letter, what, effects): (&str, &str, Effects),
) -> Result<Picture, Box<dyn Error>> {
    let mut sheet = hanging(fine)?;
    sheet.effects = effects;
    if effects == Effects::Shrinkage {
        sheet.fire.fuel.loss_share = 0.0;
    }
    if letter == "d" {
        let places = sheet.rest().iter();
        sheet.fire.weights = places
            .map(|p| 0.5 + 0.5 * texture(0.5 + p.x / SIDE, 0.5 + p.z / SIDE))
            .collect();
    }
    let area = sheet.cut(sheet.rest()).area();
    let springs = sheet.springs().spring_count();
    let (mut scenes, mut facts) = (Vec::new(), Vec::new());
    let seconds = film(&mut sheet, &MOMENTS, |sheet| {
        let mut own = scene(sheet, GRID, [0, 2]);
        if let Some((ball, _)) = sheet.ball
            && is_in_picture(&ball.centre)
        {
            own = own.with_sphere(ball.centre, ball.radius, 2.2 * GREY.component_mul(&HOT));
        }
        scenes.push(own);
    })?;
    let rest = sheet.cut(sheet.rest());
    let pieces = rest.pieces();
    let large = pieces.iter().filter(|own| **own > 0.02 * area).count();
    facts.push(format!(
        "at the end {:.2} % of the sheet is left, in {large} pieces of more than 2 % of it ({} in all)",
        100.0 * rest.area() / area,
        pieces.len()
    ));
    let view = View {
        turn: 0.35,
        nod: -1.35,
    };
    let file = format!("sphere_{letter}.png");
    draw(&folder.join(&file), &scenes, (4, [1.35 * SIDE, 0.0]), view)?;
    Ok(Picture {
        file,
        what: format!("figure 4 ({letter}): a hot sphere crosses a hanging sheet; {what}"),
        springs,
        steps: MOMENTS[3],
        seconds,
        facts,
    })
}

/// What colours a hot sphere.
pub(crate) const HOT: Vector3<f64> = Vector3::new(1.0, 0.45, 0.15);

/// Centre (m) of the hot sphere after so many seconds.
pub(crate) fn ball_at(seconds: f64) -> Vector3<f64> {
    let [_, speed, _] = BALL;
    Vector3::new(speed * seconds - 0.65 * SIDE, 0.0, 0.1 * SIDE)
}

/// Whether the hot sphere is not yet on its way out of the picture.
pub(crate) fn is_in_picture(centre: &Vector3<f64>) -> bool {
    centre.x < 0.65 * SIDE
}

/// A square sheet upright in x and z whose upper corners are held, with a hot sphere at its left.
fn hanging(fine: Fineness) -> Result<BurningSheet, Box<dyn Error>> {
    let cell = SIDE / fine.cells as f64;
    let (lattice, flat) =
        SpringLattice::rectangle([fine.cells, fine.cells], cell, THICKNESS * cell)?;
    let upright: Vec<_> = flat.iter().map(|p| Vector3::new(p.x, -p.z, p.y)).collect();
    let mut sheet = sheet((lattice, upright), SIDE * SIDE, FUEL, SURROUNDINGS);
    let corner = |p: &Vector3<f64>| p.x.abs().min(p.z) > 0.499 * SIDE;
    sheet.motion.held = sheet.rest().iter().map(corner).collect();
    sheet.gravity = GRAVITY;
    let [radius, speed, heating] = BALL;
    let ball = HeatBall {
        centre: ball_at(0.0),
        radius,
        heating,
    };
    sheet.ball = Some((ball, Vector3::new(speed, 0.0, 0.0)));
    Ok(sheet)
}
