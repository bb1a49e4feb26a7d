//! What will be modelled: skin on a driver, zone by zone, or a layer on a soft body.

use ruga_stepper::{
    BodyPlan, BodyPose, Frame, LayerPlan, Observer, Phase, Plan, PoseResult, Preparation, Progress,
    StepperError, simulate, simulate_body,
};

use crate::project::Project;

/// The plan of a scene.
pub(crate) enum Planned {
    /// Layers on the posed mesh: stacks side by side, one for a scene without zones.
    Skin(Vec<ZonePlan>),
    /// One layer on an embedded lattice.
    Body(Box<BodyPlan>),
}

/// The stack of one zone.
pub(crate) struct ZonePlan {
    /// Its layers as numbers into the scene's, bottom first.
    pub(crate) layers: Vec<usize>,
    pub(crate) plan: Plan,
}

/// The layers of one pose over all `zones`, in the order of the scene.
pub(crate) fn pose_layers(zones: &[ZonePlan], pose: usize) -> Vec<&LayerPlan> {
    let mut layers = Vec::new();
    for zone in zones {
        layers.extend(zone.layers.iter().zip(&zone.plan.poses[pose].layers));
    }
    layers.sort_by_key(|(number, _)| **number);
    layers.into_iter().map(|(_, layer)| layer).collect()
}

impl Planned {
    /// What the user should know before anything is simulated.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = &String> {
        let (zones, body) = match self {
            Self::Skin(zones) => (zones.as_slice(), None),
            Self::Body(plan) => (&[][..], Some(plan)),
        };
        let of_skin = zones.iter().flat_map(|zone| &zone.plan.warnings);
        of_skin.chain(body.into_iter().flat_map(|plan| &plan.warnings))
    }

    /// Adds what the plan itself cannot know.
    pub(crate) fn warn(&mut self, warnings: Vec<String>) {
        match self {
            Self::Skin(zones) => zones[0].plan.warnings.extend(warnings),
            Self::Body(plan) => plan.warnings.extend(warnings),
        }
    }

    /// The file's triangles that have a simulated part in pose number `pose`, ascending.
    pub(crate) fn active_triangles(&self, project: &Project, pose: usize) -> Vec<u32> {
        match self {
            Self::Skin(zones) => {
                let of_zones = zones.iter();
                let mut triangles: Vec<u32> = of_zones
                    .flat_map(|zone| zone.plan.active_triangles(&project.driver, pose))
                    .collect();
                triangles.sort_unstable();
                triangles.dedup();
                triangles
            }
            Self::Body(plan) => plan.covered_triangles(&project.driver),
        }
    }

    /// Simulates pose number `pose` of the project, one zone after the other.
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
            Self::Skin(zones) => simulate_zones(project, zones, pose, observer),
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

fn simulate_zones(
    project: &Project,
    zones: &[ZonePlan],
    pose: usize,
    observer: &mut dyn Observer,
) -> Result<PoseResult, StepperError> {
    let mut whole = PoseResult {
        layers: vec![Default::default(); project.layers.len()],
        converged: true,
        ..PoseResult::default()
    };
    for zone in zones {
        let mut observer = ZoneObserver {
            layers: &zone.layers,
            observer,
        };
        let (driver, spec) = (&project.driver, &project.poses[pose]);
        let modelling = &project.modelling;
        let result = simulate(driver, &zone.plan, pose, spec, modelling, &mut observer)?;
        add(&mut whole, result, &zone.layers);
        if whole.interrupted {
            break;
        }
    }
    Ok(whole)
}

/// Adds the result of a zone, whose layers have these numbers in the scene.
fn add(whole: &mut PoseResult, zone: PoseResult, layers: &[usize]) {
    for key in zone.keys {
        match whole.keys.iter_mut().find(|other| other.load == key.load) {
            Some(other) => other.layers.extend(key.layers),
            None => whole.keys.push(key),
        }
    }
    whole.keys.sort_by(|a, b| a.load.total_cmp(&b.load));
    for (number, report) in layers.iter().zip(zone.layers) {
        whole.layers[*number] = report;
    }
    whole.frames = whole.frames.max(zone.frames);
    whole.converged &= zone.converged;
    whole.interrupted |= zone.interrupted;
    whole.warnings.extend(zone.warnings);
}

/// Tells an observer of the layers of one zone by their numbers in the scene.
struct ZoneObserver<'a> {
    layers: &'a [usize],
    observer: &'a mut dyn Observer,
}

impl Observer for ZoneObserver<'_> {
    fn phase(&mut self, layer: usize, phase: Phase) {
        self.observer.phase(self.layers[layer], phase);
    }

    fn preparing(&mut self, preparation: Preparation) -> bool {
        self.observer.preparing(Preparation {
            layer: self.layers[preparation.layer],
            ..preparation
        })
    }

    fn progress(&mut self, progress: Progress) -> bool {
        self.observer.progress(progress)
    }

    fn wants_frames(&self) -> bool {
        self.observer.wants_frames()
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        self.observer.frame(frame);
    }
}
