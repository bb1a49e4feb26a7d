//! Newton's method as the papers have it: on the forces, whatever the energy does.

use ruga_solver::{Inertia, Kkt, Objective};

/// Iterations granted.
const ITERATIONS: usize = 60;
/// Residual at which the forces count as balanced, over the scales of the objective.
const BALANCED: f64 = 1e-7;
/// Share by which a step has to lower the residual, per unit of its length (Armijo).
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a step.
const HALVINGS: usize = 30;

/// How a solve went.
#[derive(Clone, Copy, Debug)]
pub struct ResidualSolve {
    /// Whether the forces are balanced.
    pub converged: bool,
    /// Newton steps.
    pub iterations: usize,
    /// Norm of the forces at the end, over the scale of the objective.
    pub residual: f64,
    /// Signs of the last Hessian's pivots, which the method itself does not look at.
    pub inertia: Option<Inertia>,
}

/// Solves `g + H' y = 0`, `H x = rhs` by Newton steps that are halved until the norm of both falls:
/// Rémillard and Kry 2013, section 6.1.
///
/// # Panics
/// When the system cannot be factorised.
pub(crate) fn descend_residual(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut Vec<f64>,
    kkt: &mut Kkt,
) -> ResidualSolve {
    let (size, rows) = (x.len(), rhs.len());
    let mut values = vec![0.0; objective.pattern().entries()];
    let mut relaxed = values.clone();
    let mut multipliers = vec![0.0; rows];
    let mut solve = ResidualSolve {
        converged: false,
        iterations: 0,
        residual: f64::INFINITY,
        inertia: None,
    };
    for iteration in 0..ITERATIONS {
        let here = Forces::new(objective, kkt, rhs, x, &multipliers);
        (solve.iterations, solve.residual) = (iteration, here.norm);
        objective.hessian(x, &mut values, &mut relaxed);
        let inertia = kkt.factorize(&values, objective.floor());
        solve.inertia = Some(inertia.expect("a matrix that can be factorised"));
        solve.converged = here.norm < BALANCED;
        if solve.converged {
            break;
        }
        let (mut step, mut wanted) = (vec![0.0; size], vec![0.0; rows]);
        let downhill: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
        kkt.solve(&downhill, &here.offset, &mut step, &mut wanted)
            .expect("finite forces");
        let trial = |length: f64| {
            let x: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + length * s).collect();
            let towards = multipliers.iter().zip(&wanted);
            let multipliers = towards.map(|(y, w)| y + length * (w - y));
            (x, multipliers.collect::<Vec<f64>>())
        };
        let lengths = (0..HALVINGS).map(|n| 0.5f64.powi(n as i32));
        let mut tried = lengths.map(|length| (length, trial(length)));
        let falls = |(length, (x, y)): &(f64, (Vec<f64>, Vec<f64>))| {
            Forces::new(objective, kkt, rhs, x, y).norm < (1.0 - SUFFICIENT * length) * here.norm
        };
        let Some((_, taken)) = tried.find(falls) else {
            break;
        };
        (*x, multipliers) = taken;
    }
    solve
}

/// What is out of balance.
struct Forces {
    /// Gradient of the energy, N.
    gradient: Vec<f64>,
    /// `rhs - H x`.
    offset: Vec<f64>,
    /// Root mean square of forces and offsets over their scales.
    norm: f64,
}

impl Forces {
    fn new(objective: &dyn Objective, kkt: &Kkt, rhs: &[f64], x: &[f64], y: &[f64]) -> Self {
        let mut gradient = vec![0.0; x.len()];
        objective.gradient(x, &mut gradient);
        let (mut reaction, mut offset) = (vec![0.0; x.len()], vec![0.0; rhs.len()]);
        let rows = kkt.rows();
        rows.mul_transposed(y, &mut reaction).expect("sizes match");
        rows.mul(x, &mut offset).expect("sizes match");
        for (offset, rhs) in offset.iter_mut().zip(rhs) {
            *offset = rhs - *offset;
        }
        let forces = gradient.iter().zip(&reaction);
        let forces = forces.map(|(g, r)| (g + r) / objective.force_scale());
        let offsets = offset.iter().map(|o| o / objective.length_scale());
        let squares: f64 = forces.chain(offsets).map(|f| f * f).sum();
        Self {
            norm: (squares / x.len() as f64).sqrt(),
            gradient,
            offset,
        }
    }
}
