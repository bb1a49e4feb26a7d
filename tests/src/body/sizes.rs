//! A cushion as large as the papers' (RK, table 1), timed.

use std::error::Error;
use std::time::Instant;

use nalgebra::Vector3;
use ruga_lattice::{Filling, Lattice, LatticeEnergy, LatticeSpec};
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
use ruga_stepper::{Coupling, Descent, LinearSolver};

use super::{Cushion, Extent};

/// RK's cushion is 50 cm long; ours is the shipped one, larger.
const SCALE: f64 = 0.5 / 0.12;

/// RK's skin: 0.7 mm thick and 10^4 times as stiff as the inside, a wave 66 mm long.
const THICKNESS: f64 = 0.7e-3;
const RATIO: f64 = 1e4;

/// Steps in time, RK's 0.02 s long: it falls, lands, and the ball arrives.
const TIME_STEP: f64 = 0.02;
const STEPS: u32 = 12;

/// A row of RK's table 1. Left out are those whose mesh has less than three edges to a wave, and no
/// wrinkles of the skin's own.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Coordinates of the skin's vertices.
    pub unknowns: usize,
    /// Constraint rows, one per coordinate.
    pub constraints: usize,
    /// Triangles of the skin.
    pub faces: usize,
    /// Hexahedra.
    pub elements: usize,
    /// `t_q-setup` and `t_H-setup` together, s.
    pub set_up_s: f64,
    /// `t_x` and `t_q` together, s.
    pub frame_s: f64,
    /// `t_xA`, assembly of the skin in a frame, s.
    pub skin_assembly_s: f64,
    /// `t_Fx`, its forces once, s.
    pub skin_forces_s: f64,
    /// `t_qA`, assembly of the inside in a frame, s.
    pub inside_assembly_s: f64,
    /// `t_Fq`, its forces once, s.
    pub inside_forces_s: f64,
}

const PAPER: [Row; 2] = [
    Row {
        unknowns: 12534,
        constraints: 100,
        faces: 8352,
        elements: 45,
        set_up_s: 2.110,
        frame_s: 4.573,
        skin_assembly_s: 0.219,
        skin_forces_s: 0.006,
        inside_assembly_s: 0.004,
        inside_forces_s: 0.003,
    },
    Row {
        unknowns: 28194,
        constraints: 98,
        faces: 19792,
        elements: 45,
        set_up_s: 9.486,
        frame_s: 36.791,
        skin_assembly_s: 0.502,
        skin_forces_s: 0.014,
        inside_assembly_s: 0.005,
        inside_forces_s: 0.004,
    },
];

/// Edges to a wave with which our cushion has as many vertices.
const POINTS: [f64; 2] = [5.2, 7.7];

/// A row of RK's table and ours of that size.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// RK's.
    pub paper: Row,
    /// Ours; times of a frame are means over those that take more Newton steps than a free fall.
    pub own: Row,
    /// Newton steps in the dearest such frame, and in the middle one.
    pub iterations: [usize; 2],
    /// Factorisations over Newton steps.
    pub factorizations: f64,
    /// Whether every step was found.
    pub converged: bool,
}

/// Times the cushion at RK's sizes, or at the smaller one alone; `each` has them as they come.
///
/// # Errors
/// What the simulator refuses.
pub fn sizes(extent: Extent, each: &mut dyn FnMut(&Size)) -> Result<(), Box<dyn Error>> {
    let count = match extent {
        Extent::Full => PAPER.len(),
        Extent::Quick => 1,
    };
    for (paper, points) in PAPER.into_iter().zip(POINTS).take(count) {
        each(&measure(paper, points)?);
    }
    Ok(())
}

fn measure(paper: Row, points: f64) -> Result<Size, Box<dyn Error>> {
    let cushion = Cushion {
        scale: SCALE,
        thickness: THICKNESS,
        ratio: RATIO,
        cells: 6,
        points,
        coupling: Coupling::Hybrid,
        time_step: TIME_STEP,
        steps: STEPS,
        descent: Descent::Energy,
        linear: LinearSolver::Ldlt,
    };
    let thrown = cushion.throw()?;
    // A free fall takes two Newton steps and one to prove it.
    let touching = thrown.iterations.iter().zip(&thrown.frame_s);
    let touching: Vec<(usize, f64)> = touching
        .map(|(i, s)| (*i, *s))
        .filter(|(i, _)| *i > 3)
        .collect();
    let mut iterations: Vec<usize> = touching.iter().map(|frame| frame.0).collect();
    iterations.sort_unstable();
    let count = touching.len() as f64;
    let mean = iterations.iter().sum::<usize>() as f64 / count;
    let (skin_assembly, skin_forces) = skin_seconds(&cushion, &thrown.cover)?;
    let (elements, inside_assembly, inside_forces) = inside_seconds(&cushion)?;
    let report = &thrown.report;
    Ok(Size {
        paper,
        own: Row {
            unknowns: 3 * report.vertices,
            constraints: 3 * report.constraints,
            faces: report.faces,
            elements,
            set_up_s: thrown.set_up_s,
            frame_s: touching.iter().map(|frame| frame.1).sum::<f64>() / count,
            skin_assembly_s: mean * skin_assembly,
            skin_forces_s: skin_forces,
            inside_assembly_s: mean * inside_assembly,
            inside_forces_s: inside_forces,
        },
        iterations: [
            iterations.last().copied().unwrap_or_default(),
            iterations
                .get(iterations.len() / 2)
                .copied()
                .unwrap_or_default(),
        ],
        factorizations: report.factorizations as f64 / report.newton_iterations.max(1) as f64,
        converged: thrown.converged,
    })
}

/// Seconds that a piece of work takes, once it has been done.
fn seconds(mut work: impl FnMut()) -> f64 {
    const TIMES: u32 = 5;
    work();
    let start = Instant::now();
    (0..TIMES).for_each(|_| work());
    start.elapsed().as_secs_f64() / f64::from(TIMES)
}

/// Of one Hessian, exact and relaxed, and of one gradient of the cover.
fn skin_seconds(
    cushion: &Cushion,
    cover: &ruga_stepper::ComputedMesh,
) -> Result<(f64, f64), Box<dyn Error>> {
    let numbers = cushion.theory()?;
    let face = FaceParameters {
        young: cushion.young(),
        poisson: Cushion::POISSON,
        thickness: cushion.thickness,
        normal_stiffness: numbers.normal_stiffness,
        gradient_stiffness: numbers.gradient_stiffness,
    };
    let (x, faces) = (&cover.positions, &cover.faces);
    let tie = numbers.tangential_stiffness;
    let parameters = LayerParameters::uniform(face, faces.len(), tie, x.len());
    let free = vec![false; x.len()];
    let bending = ruga_stepper::Modelling::default().bending;
    let layer = LayerEnergy::with_bending(x, faces, parameters, &free, bending)?;
    let [mut exact, mut relaxed] = [0, 1].map(|_| vec![0.0; layer.pattern().1.len()]);
    let mut gradient = vec![0.0; layer.dof_count()];
    Ok((
        seconds(|| layer.hessian(x, &mut exact, Some(&mut relaxed))),
        seconds(|| layer.gradient(x, &mut gradient)),
    ))
}

/// Elements of the lattice, and seconds of one Hessian and of one gradient.
fn inside_seconds(cushion: &Cushion) -> Result<(usize, f64, f64), Box<dyn Error>> {
    let (driver, body) = (cushion.driver()?, cushion.body());
    let spec = LatticeSpec {
        cells: cushion.cells,
        shape: body.shape,
        filling: Filling::Piece,
    };
    let lattice = Lattice::build(driver.topology(), driver.rest(), &spec)?;
    let free = vec![false; lattice.node_count()];
    let energy = LatticeEnergy::new(&lattice, &body.material, &free)?;
    let q: Vec<Vector3<f64>> = lattice.rest_positions().to_vec();
    let [mut exact, mut relaxed] = [0, 1].map(|_| vec![0.0; energy.pattern().1.len()]);
    let mut gradient = vec![0.0; energy.dof_count()];
    Ok((
        lattice.element_count(),
        seconds(|| energy.hessian(&q, &mut exact, Some(&mut relaxed))),
        seconds(|| energy.gradient(&q, &mut gradient)),
    ))
}
