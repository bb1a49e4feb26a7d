//! Figures 7 (c, d), a sheet of which one layer shrinks, and 10, sheets of several thicknesses.

use std::error::Error;
use std::path::Path;

use nalgebra::Vector3;
use ruga_validation::cpu_seconds;
use ruga_validation::spring_sheet::{
    MassSpring, Projection, Remnant, SpringLattice, SpringMotion, TIME_STEP, TimeRule,
};

use crate::fires::{GRAVITY, KEPT, SIDE};
use crate::pictures::{Fineness, Picture};
use crate::sheets::{Scene, View, draw};

/// What the corner layer is shorter by in the end, and the steps in which it gets so; the paper gives no amount.
const SHRINKAGE: f64 = 0.2;
const SHRINKING: usize = 100;

/// Steps after which sheets are at rest, or as near to it as they get.
const STEPS: usize = 600;

/// Mass of a particle (kg). Nothing here depends on it.
const MASS: f64 = 1e-5;

/// A free sheet of which one layer shrinks evenly: by projection, and as a mass-spring system.
pub(crate) fn one_layer(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 7 (c, d)");
    let cell = SIDE / fine.cells as f64;
    let (mut lattice, rest) =
        SpringLattice::rectangle([fine.cells, fine.cells], cell, 0.25 * cell)?;
    let mut held = SpringMotion::at_rest(rest.clone(), vec![MASS; rest.len()], TimeRule::Massless);
    let mut hooke = MassSpring::at_rest(rest.clone(), MASS);
    let weightless = vec![Vector3::zeros(); rest.len()];
    let projection = Projection::default();
    let mut shares = vec![1.0; rest.len()];
    let mut seconds = [0.0; 2];
    for step in 0..STEPS {
        let done = (step as f64 / SHRINKING as f64).min(1.0);
        shares[..lattice.corner_count()].fill(1.0 - SHRINKAGE * done);
        lattice.set_volume_shares(&shares)?;
        let start = cpu_seconds();
        held.step(&lattice, &projection, &weightless);
        let middle = cpu_seconds();
        hooke.step(&lattice, Vector3::zeros());
        held.velocities.iter_mut().for_each(|own| *own *= KEPT);
        hooke.velocities.iter_mut().for_each(|own| *own *= KEPT);
        seconds[0] += middle - start;
        seconds[1] += cpu_seconds() - middle;
    }
    let results = [
        ("projection", &held.positions, seconds[0]),
        ("mass-spring", &hooke.positions, seconds[1]),
    ];
    let facts = results.map(|(name, positions, seconds)| {
        format!(
            "{name}: neighbouring cells lean {:.1} degrees against each other, root mean square, blue springs are off by \
             {:.2} %; {seconds:.2} s of processor",
            roughness(&lattice, positions),
            100.0 * strain(&lattice, positions)
        )
    });
    let scenes = results.map(|(_, positions, _)| seen(&lattice, positions, &rest));
    let view = View {
        turn: 0.3,
        nod: -0.7,
    };
    draw(
        &folder.join("one_layer.png"),
        &scenes,
        (2, [1.2 * SIDE, 0.0]),
        view,
    )?;
    Ok(Picture {
        file: "one_layer.png".to_owned(),
        what:
            "figure 7 (c, d): one layer shrinks by 20 %; by projection, and as a mass-spring system"
                .to_owned(),
        springs: lattice.spring_count(),
        steps: 2 * STEPS,
        seconds: seconds.iter().sum(),
        facts: facts.to_vec(),
    })
}

/// Root mean square of the angle between the normals of cells that share a green spring (degrees).
fn roughness(lattice: &SpringLattice, positions: &[Vector3<f64>]) -> f64 {
    use ruga_validation::spring_sheet::SpringColour::Green;
    let normal = |cell: &[u32; 4]| {
        let [a, b, c, d] = cell.map(|p| positions[p as usize]);
        (c - a).cross(&(d - b))
    };
    let normals: Vec<_> = lattice.cells().iter().map(normal).collect();
    let corners = lattice.corner_count();
    let ends = lattice.set(Green).ends().iter();
    let squares: Vec<f64> = ends
        .map(|ends| {
            let [a, b] = ends.map(|p| &normals[p as usize - corners]);
            a.angle(b).powi(2)
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64)
        .sqrt()
        .to_degrees()
}

/// Root of the mean square of blue springs' length over target, less one.
pub(crate) fn strain(lattice: &SpringLattice, positions: &[Vector3<f64>]) -> f64 {
    use ruga_validation::spring_sheet::SpringColour::Blue;
    lattice.set(Blue).strain(positions)
}

/// All of a sheet that does not burn.
fn seen(lattice: &SpringLattice, positions: &[Vector3<f64>], rest: &[Vector3<f64>]) -> Scene {
    let whole = vec![1.0; positions.len()];
    let cut = |at: &[Vector3<f64>]| Remnant::new(lattice, at, &whole);
    let marks = rest
        .iter()
        .map(|p| Vector3::new(40.0 * p.x + 0.5, 40.0 * p.y + 0.5, 1.0));
    let marks: Vec<_> = marks.collect();
    let cold = vec![Vector3::zeros(); positions.len()];
    Scene::sheet(&cut(positions), &cut(&marks), &cut(&cold))
}

/// Thickness over longest side, and weight of blue and yellow springs, of figure 10 (a) to (d).
const KINDS: [(f64, f64); 4] = [(20.0, 1.0), (80.0, 1.0), (400.0, 1.0), (400.0, 0.1)];

/// Sheets that are held at their left end and sag.
pub(crate) fn thicknesses(folder: &Path, fine: Fineness) -> Result<Picture, Box<dyn Error>> {
    eprintln!("figure 10");
    let cell = SIDE / fine.cells as f64;
    let (mut scenes, mut facts) = (Vec::new(), Vec::new());
    let (mut seconds, mut springs) = (0.0, 0);
    for (ratio, weight) in KINDS {
        let cells = [fine.cells, fine.cells / 2];
        let (lattice, rest) = SpringLattice::rectangle(cells, cell, SIDE / ratio)?;
        let mut motion =
            SpringMotion::at_rest(rest.clone(), vec![MASS; rest.len()], TimeRule::Massless);
        motion.held = rest
            .iter()
            .map(|p| p.x < -0.5 * SIDE + 1.1 * cell)
            .collect();
        let projection = Projection {
            weight,
            ..Projection::default()
        };
        let forces = vec![GRAVITY * MASS; rest.len()];
        let tip = |positions: &[Vector3<f64>]| {
            let end = rest.iter().zip(positions);
            let end: Vec<f64> = end
                .filter(|(rest, _)| rest.x > 0.499 * SIDE)
                .map(|(rest, now)| rest.z - now.z)
                .collect();
            end.iter().sum::<f64>() / end.len() as f64
        };
        let mut sags = Vec::new();
        for _ in 0..STEPS {
            let start = cpu_seconds();
            motion.step(&lattice, &projection, &forces);
            motion.velocities.iter_mut().for_each(|own| *own *= KEPT);
            seconds += cpu_seconds() - start;
            sags.push(tip(&motion.positions) / SIDE);
        }
        let late = &sags[STEPS / 2..];
        facts.push(format!(
            "1 : {ratio:.0}, weight {weight}: the free end sags by {:.3} of the length (mean from {:.1} to {:.1} s; {:.3} to {:.3})",
            late.iter().sum::<f64>() / late.len() as f64,
            TIME_STEP * (STEPS / 2) as f64,
            TIME_STEP * STEPS as f64,
            late.iter().copied().fold(f64::MAX, f64::min),
            late.iter().copied().fold(f64::MIN, f64::max),
        ));
        scenes.push(seen(&lattice, &motion.positions, &rest));
        springs = lattice.spring_count();
    }
    let view = View {
        turn: 0.35,
        nod: -1.2,
    };
    draw(
        &folder.join("thickness.png"),
        &scenes,
        (4, [1.2 * SIDE, 0.0]),
        view,
    )?;
    Ok(Picture {
        file: "thickness.png".to_owned(),
        what: "figure 10: sheets held at the left; thickness over length and weight 1:20 and 1, 1:80 and 1, 1:400 and 1, \
               1:400 and 0.1"
            .to_owned(),
        springs,
        steps: KINDS.len() * STEPS,
        seconds,
        facts,
    })
}
