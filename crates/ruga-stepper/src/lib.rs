//! Plans and runs the wrinkling of one pose: region, mesh, load steps, report.

mod error;
mod layer;
mod layer_objective;
mod low_pass_rows;
mod measure;
mod model;
mod observer;
mod plan;
mod region;
mod result;
mod simulate;

pub use error::StepperError;
pub use model::{Coupling, LayerSpec, Mask, Modelling, PoseSpec, Region};
pub use observer::{Frame, Observer, Phase, Progress, Silent};
pub use plan::{LayerPlan, Plan, PosePlan, plan};
pub use result::{KeyResult, LayerReport, LayerSurface, PoseResult};
pub use simulate::simulate;

pub use ruga_constraint::Sampling;
pub use ruga_solver::LinearSolver;
