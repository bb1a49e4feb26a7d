//! Newton's method for the small systems of chains.

use nalgebra::{DMatrix, DVector};

/// Value, gradient and Hessian.
pub(super) type Derivatives = (f64, DVector<f64>, DMatrix<f64>);

const MAX_ITERATIONS: usize = 100;

/// Length of a Newton step, over the length of the chain, that ends the solve.
const STEP_TOLERANCE: f64 = 1e-11;

/// Newton's method with a shift where the Hessian is indefinite; how many steps, and whether the
/// last one was short.
pub(super) fn newton(
    length: f64,
    value_at: &dyn Fn(&DVector<f64>) -> f64,
    derivatives_at: &dyn Fn(&DVector<f64>) -> Derivatives,
    state: &mut DVector<f64>,
) -> (usize, bool) {
    for iteration in 0..MAX_ITERATIONS {
        let (value, gradient, hessian) = derivatives_at(state);
        let step = descent(hessian, &gradient);
        let slope = gradient.dot(&step);
        let mut share = 1.0;
        // Rounding hides the last decrease.
        let rounding = 1e-14 * value.abs();
        while value_at(&(&*state + &step * share)) > value + 1e-4 * share * slope + rounding
            && share > 1e-10
        {
            share *= 0.5;
        }
        *state += &step * share;
        if step.amax() <= STEP_TOLERANCE * length {
            return (iteration + 1, true);
        }
    }
    (MAX_ITERATIONS, false)
}

/// `-H^-1 g`, with the smallest of a row of shifts that makes the matrix positive definite.
fn descent(hessian: DMatrix<f64>, gradient: &DVector<f64>) -> DVector<f64> {
    let scale = hessian.diagonal().amax();
    let mut shift = 0.0;
    loop {
        let mut shifted = hessian.clone();
        for i in 0..gradient.len() {
            shifted[(i, i)] += shift;
        }
        if let Some(factor) = shifted.cholesky() {
            return -factor.solve(gradient);
        }
        shift = (10.0 * shift).max(1e-8 * scale);
    }
}
