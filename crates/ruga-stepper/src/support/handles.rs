//! What is moved from outside: parts of the body, and obstacles.

use nalgebra::Vector3;
use ruga_lattice::Lattice;
use ruga_mesh::Id;

use super::obstacle::{PlacedObstacle, check};
use super::placement::Placement;
use crate::{Body, Handle, Keyframe, Motion, Obstacle, PoseSpec, StepperError};

/// The nodes of every handle, and who holds them.
#[derive(Clone, Debug)]
pub(crate) struct HeldNodes {
    /// Per node the number of the handle that holds it.
    pub(crate) holder: Vec<Option<usize>>,
}

impl HeldNodes {
    /// Nodes of every element whose piece of the body has its centre in a handle's box; of the first
    /// such handle where there are several.
    pub(crate) fn new(lattice: &Lattice, handles: &[Handle]) -> Result<Self, StepperError> {
        let mut holder = vec![None; lattice.node_count()];
        for (number, handle) in handles.iter().enumerate() {
            let mut is_empty = true;
            let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
            for element in lattice.elements() {
                let centre = handle.turn * lattice.element_centre(element) + handle.shift;
                (low, high) = (low.inf(&centre), high.sup(&centre));
                if !handle.holds(&lattice.element_centre(element)) {
                    continue;
                }
                for node in lattice.element_nodes(element) {
                    let held = &mut holder[node.index()];
                    // A handle behind others that hold all of its nodes would move nothing, and is
                    // refused like one without cells.
                    is_empty &= held.is_some();
                    held.get_or_insert(number);
                }
            }
            if is_empty {
                return Err(StepperError::EmptyHandle {
                    handle: handle.name.clone(),
                    asked: [handle.min, handle.max],
                    found: [low, high],
                });
            }
        }
        // Nothing would be left to solve for.
        if holder.iter().all(Option::is_some) {
            return Err(StepperError::HeldBody);
        }
        Ok(Self { holder })
    }

    pub(crate) fn pinned(&self) -> Vec<bool> {
        self.holder.iter().map(Option::is_some).collect()
    }
}

/// Everything that moves in one pose.
#[derive(Clone, Debug)]
pub(crate) struct Moves<'a> {
    handles: &'a [Handle],
    obstacles: &'a [Obstacle],
    motions: &'a [Motion],
}

impl<'a> Moves<'a> {
    /// The motions of a pose, checked; `others` are names of what can be moved beside handles and obstacles.
    pub(crate) fn new(
        (handles, obstacles): (&'a [Handle], &'a [Obstacle]),
        others: &[&str],
        pose: &'a PoseSpec,
    ) -> Result<Self, StepperError> {
        obstacles.iter().try_for_each(check)?;
        for motion in &pose.motions {
            let held = handles.iter().map(|handle| handle.name.as_str());
            let in_the_way = obstacles.iter().map(|obstacle| obstacle.name.as_str());
            let mut names = held.chain(in_the_way).chain(others.iter().copied());
            if !names.any(|name| name == motion.of) {
                return Err(StepperError::UnknownMover {
                    pose: pose.name.clone(),
                    name: motion.of.clone(),
                });
            }
            let times = || motion.keyframes.iter().map(|frame| frame.at);
            let ascend = times().zip(times().skip(1)).all(|(a, b)| a < b);
            let numbers = |f: &Keyframe| [f.translation, f.turn, f.about];
            let mut places = motion.keyframes.iter().flat_map(numbers);
            let is_finite = places.all(|v| v.iter().all(|c| c.is_finite()));
            if !ascend || !is_finite || !times().all(|at| at > 0.0 && at <= 1.0) {
                return Err(StepperError::Keyframes {
                    pose: pose.name.clone(),
                    name: motion.of.clone(),
                });
            }
        }
        Ok(Self {
            handles,
            obstacles,
            motions: &pose.motions,
        })
    }

    /// What can be moved of a body.
    pub(crate) fn of_body(body: &'a Body, pose: &'a PoseSpec) -> Result<Self, StepperError> {
        Self::new((&body.handles, &body.obstacles), &[], pose)
    }

    /// Placement of handle number `handle`.
    pub(crate) fn handle(&self, handle: usize, time: f64) -> Placement {
        Placement::at(self.motion_of(&self.handles[handle].name), time)
    }

    pub(crate) fn obstacles(&self, time: f64) -> Vec<PlacedObstacle> {
        let obstacles = self.obstacles.iter();
        obstacles
            .map(|obstacle| PlacedObstacle {
                shape: obstacle.shape,
                placement: Placement::at(self.motion_of(&obstacle.name), time),
            })
            .collect()
    }

    /// Where a place of something else that moves, given at rest (m), is.
    pub(crate) fn place_of(&self, name: &str, rest: &Vector3<f64>, time: f64) -> Vector3<f64> {
        Placement::at(self.motion_of(name), time).apply(rest)
    }

    /// When a keyframe is passed, in no order.
    pub(crate) fn keyframes(&self) -> impl Iterator<Item = f64> {
        let frames = self.motions.iter().flat_map(|motion| &motion.keyframes);
        frames.map(|frame| frame.at)
    }

    fn motion_of(&self, name: &str) -> Option<&'a Motion> {
        self.motions.iter().find(|motion| motion.of == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_pass_their_keyframes_and_can_be_undone() {
        let frame = |at: f64, x: f64, turn: f64| Keyframe {
            at,
            translation: Vector3::new(x, 0.0, 0.0),
            turn: Vector3::new(0.0, 0.0, turn),
            about: Vector3::new(1.0, 2.0, 0.0),
        };
        let motion = Motion {
            of: "foot".into(),
            keyframes: vec![frame(0.5, 2.0, 1.0), frame(0.8, 4.0, 0.0)],
        };
        let at = |time: f64| Placement::at(Some(&motion), time);
        assert_eq!(at(0.25).translation.x, 1.0);
        assert_eq!(at(0.25).turn.z, 0.5);
        assert_eq!(at(0.5).translation.x, 2.0);
        assert!((at(0.65).translation.x - 3.0).abs() < 1e-12);
        assert_eq!(at(1.0).translation.x, 4.0);
        // The point that is turned about only moves along.
        assert!((at(0.5).apply(&Vector3::new(1.0, 2.0, 0.0)).x - 3.0).abs() < 1e-15);
        let place = Vector3::new(0.3, -0.4, 0.5);
        assert!((at(0.4).pull_back(&at(0.4).apply(&place)) - place).norm() < 1e-15);
    }
}
