//! Minimises an energy under linear constraints: sparse KKT factorisation, Newton, MINRES.
