//! How a run asks the product.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_solver::{Iteration, Kkt, NewtonSettings, Objective, SolveReport, SolverError};
use ruga_stepper::{EdgeLimits, Modelling, Observer, Progress};
use ruga_validation::baselines::by_minres;
use ruga_validation::cpu_seconds;

use crate::setting::Run;

/// The choices of a run.
pub(crate) fn modelling(request: &Run) -> Modelling {
    let method = request.setting.method;
    Modelling {
        points_per_wavelength: f64::from(request.setting.points),
        remesh: method.aspect().map(|aspect| EdgeLimits {
            aspect,
            ..EdgeLimits::default()
        }),
        bending: method.bending.model(),
        minimise: method.solver.minimise(),
        seed: request.seed,
        ..Modelling::default()
    }
}

/// Stops a run that takes too long.
pub(crate) struct Watch {
    /// Second of the processor at which it ends.
    end: f64,
}

impl Watch {
    /// Gives a run, from now on, the time that it may take.
    pub(crate) fn new(request: &Run) -> Self {
        Self {
            end: cpu_seconds() + request.limit_s,
        }
    }
}

impl Observer for Watch {
    fn progress(&mut self, _: Progress) -> bool {
        cpu_seconds() < self.end
    }

    fn wants_frames(&self) -> bool {
        false
    }
}

/// MINRES on a layer over the plane `z = 0` that is pushed off the flat saddle before every solve: the
/// method cannot tell that state from a minimum, and would stay there.
///
/// A flat layer gets heights up to a thickness, with which averages alone begin to wrinkle, another one
/// up to a hundredth of that.
pub(crate) fn pushed_minres(
    objective: &dyn Objective,
    rhs: &[f64],
    x: &mut [f64],
    kkt: &mut Kkt,
    settings: &NewtonSettings,
    keep_going: &mut dyn FnMut(&Iteration) -> bool,
) -> Result<SolveReport, SolverError> {
    let thickness = objective.length_scale();
    let mut random = Pcg64Mcg::seed_from_u64(settings.seed);
    let heights = x.iter().skip(2).step_by(3);
    let is_flat = heights.fold(0.0_f64, |most, z| most.max(z.abs())) < 0.1 * thickness;
    let noise = if is_flat { thickness } else { 1e-2 * thickness };
    for height in x.iter_mut().skip(2).step_by(3) {
        *height += noise * random.random_range(-1.0..1.0);
    }
    by_minres(objective, rhs, x, kkt, settings, keep_going)
}
