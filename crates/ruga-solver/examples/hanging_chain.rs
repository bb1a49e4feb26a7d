//! A chain of springs with weights, held at both ends by constraints, and drawn in characters.
//!
//! `cargo run --release -p ruga-solver --example hanging_chain`
#![allow(clippy::print_stdout, reason = "an example's output is what it shows")]

use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, SolverError, minimise,
};

/// Heights of the weights; stiffness of the springs and weights are one.
struct Chain {
    pattern: LowerPattern,
}

impl Objective for Chain {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }
    fn value(&self, x: &[f64]) -> f64 {
        let springs = x.windows(2).map(|pair| (pair[1] - pair[0]).powi(2) / 2.0);
        springs.sum::<f64>() + x.iter().sum::<f64>()
    }
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(1.0);
        for i in 1..x.len() {
            gradient[i] += x[i] - x[i - 1];
            gradient[i - 1] -= x[i] - x[i - 1];
        }
        self.value(x)
    }
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        // Column by column: the diagonal, then the entry below it.
        for (i, column) in exact.chunks_mut(2).enumerate() {
            let is_end = i == 0 || i + 1 == x.len();
            column[0] = if is_end { 1.0 } else { 2.0 };
            column[1..].fill(-1.0);
        }
        relaxed.copy_from_slice(exact);
    }
    fn force_scale(&self) -> f64 {
        1.0
    }
}

fn main() -> Result<(), SolverError> {
    const COUNT: usize = 15;
    let starts: Vec<usize> = (0..COUNT).map(|i| 2 * i).chain([2 * COUNT - 1]).collect();
    let rows: Vec<u32> = (0..).flat_map(|i| [i, i + 1]).take(2 * COUNT - 1).collect();
    let chain = Chain {
        pattern: LowerPattern::new(starts, rows)?,
    };
    let ends = ConstraintRows::new(vec![0, 1, 2], vec![0, COUNT - 1], vec![1.0, 1.0], COUNT)?;
    let mut kkt = Kkt::new(chain.pattern(), &ends, 1)?;
    let mut x = [0.0; COUNT];
    let settings = NewtonSettings::default();
    let report = minimise(
        &chain,
        &[0.0, 0.0],
        &mut x,
        &mut kkt,
        &settings,
        &mut |_| true,
    )?;
    for height in x {
        println!("{:>1$}", "o", (1.0 - 2.0 * height) as usize);
    }
    println!(
        "{} iterations, energy {:.3}",
        report.iterations,
        chain.value(&x)
    );
    Ok(())
}
