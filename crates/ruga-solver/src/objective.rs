//! The interface of an energy to the solver.

use crate::kkt::check_damping;
use crate::{Kkt, LowerPattern, SolverError};

/// An energy of `n` unknowns with exact derivatives, and the scales that make tolerances
/// nondimensional; one where nothing is said.
///
/// All arrays have `n` entries unless said otherwise. Energies in J, unknowns in m.
pub trait Objective {
    /// Sparsity of the Hessian; the same at every `x`.
    fn pattern(&self) -> &LowerPattern;

    /// Energy at `x` (J). Infinite or NaN marks a state outside the domain: the line search
    /// shortens its step.
    fn value(&self, x: &[f64]) -> f64;

    /// Energy at `x` (J); writes its gradient (N).
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64;

    /// Writes the Hessian twice, in pattern order (N/m): `exact`, and `relaxed`, the same with
    /// the compressive part of the stress stiffness removed.
    ///
    /// `relaxed` need not be a projection of `exact`, only mend its inertia when mixed in; an energy
    /// without stress stiffness writes `exact` twice.
    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]);

    /// How stresses change along a step, for bodies that turn far while they hardly stretch; none by default.
    fn prediction(&self) -> Option<&dyn StressPrediction> {
        None
    }

    /// Levenberg damping (N/m), a diagonal added to both Hessians before the inertia is counted;
    /// empty for none.
    ///
    /// It keeps modes without stiffness (a pattern sliding along itself) from having a random
    /// sign; 1e-6 of a vertex's foundation stiffness does.
    fn damping(&self) -> &[f64] {
        &[]
    }

    /// Energy (J) that the Newton decrement is compared with: the gap between flat and wrinkled
    /// state, such as `C eps_c^2 area / 2`.
    fn energy_scale(&self) -> f64 {
        1.0
    }

    /// Force on one unknown (N) that the residual is compared with.
    fn force_scale(&self) -> f64 {
        1.0
    }

    /// Smallest length that matters (m), such as the thickness.
    fn length_scale(&self) -> f64 {
        1.0
    }
}

/// What lets Newton's method take steps of an [`Objective`] that turn parts of a stiff body far.
///
/// A straight step that turns something by an angle stretches it by half the square of that. With the stress of
/// that stretch in the Hessian the next step is much too stiff. Here it is the stress that the linearisation at the
/// start of the step predicts, which is Newton's method for stresses as unknowns of their own (Magisano, Leonetti
/// and Garcea 2017), while energy and gradient stay as they are.
pub trait StressPrediction {
    /// The share, at most 1, of a `step` from `x` (m) up to which nothing turns or stretches too far for a
    /// linearisation to mean anything.
    fn reach(&self, x: &[f64], step: &[f64]) -> f64;

    /// Writes both Hessians at `x` as [`Objective::hessian`] does, with the stresses predicted at `from`.
    fn hessian(&self, x: &[f64], from: &[f64], exact: &mut [f64], relaxed: &mut [f64]);
}

/// Refuses an objective of another system than `kkt` analysed, with arrays of another size or
/// scales that are not positive.
pub(crate) fn check_pattern(objective: &dyn Objective, kkt: &Kkt) -> Result<(), SolverError> {
    if objective.pattern() != kkt.pattern() {
        return Err(SolverError::PatternMismatch);
    }
    check_damping(kkt.pattern(), objective.damping())?;
    for (setting, value) in [
        ("energy_scale", objective.energy_scale()),
        ("force_scale", objective.force_scale()),
        ("length_scale", objective.length_scale()),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(SolverError::Setting { setting, value });
        }
    }
    Ok(())
}
