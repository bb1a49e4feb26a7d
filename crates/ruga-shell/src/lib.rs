//! Membrane, bending and foundation energies of a thin layer: value, gradient, Hessian.
