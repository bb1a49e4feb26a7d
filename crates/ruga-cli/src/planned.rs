//! What will be modelled: skin on a driver, or a layer on a soft body.

use ruga_stepper::{
    BodyPlan, BodyPose, Observer, Plan, PoseResult, StepperError, simulate, simulate_body,
};

use crate::project::Project;

/// The plan of a scene.
pub(crate) enum Planned {
    /// Layers on the posed mesh.
    Skin(Box<Plan>),
    /// One layer on an embedded lattice.
    Body(Box<BodyPlan>),
}

impl Planned {
    /// What the user should know before anything is simulated.
    pub(crate) fn warnings(&self) -> &[String] {
        match self {
            Self::Skin(plan) => &plan.warnings,
            Self::Body(plan) => &plan.warnings,
        }
    }

    /// Adds what the plan itself cannot know.
    pub(crate) fn warn(&mut self, warnings: Vec<String>) {
        match self {
            Self::Skin(plan) => plan.warnings.extend(warnings),
            Self::Body(plan) => plan.warnings.extend(warnings),
        }
    }

    /// The file's triangles that have a simulated part in pose number `pose`, ascending.
    pub(crate) fn active_triangles(&self, project: &Project, pose: usize) -> Vec<u32> {
        match self {
            Self::Skin(plan) => plan.active_triangles(&project.driver, pose),
            Self::Body(plan) => plan.covered_triangles(&project.driver),
        }
    }

    /// Simulates pose number `pose` of the project.
    ///
    /// # Errors
    /// Those of [`simulate`] and [`simulate_body`].
    pub(crate) fn simulate(
        &self,
        project: &Project,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        let (driver, spec) = (&project.driver, &project.poses[pose]);
        match self {
            Self::Skin(plan) => simulate(driver, plan, pose, spec, &project.modelling, observer),
            Self::Body(plan) => {
                let pose = BodyPose {
                    pose: spec.clone(),
                    motions: project.motions[pose].clone(),
                };
                simulate_body(driver, plan, &pose, &project.modelling, observer)
            }
        }
    }
}
