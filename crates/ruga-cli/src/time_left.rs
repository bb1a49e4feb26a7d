//! How long the poses that are left will take, judged by those that are done.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Clocks of the poses of a run.
pub(crate) struct TimeLeft {
    /// Poses in work at a time.
    at_a_time: usize,
    poses: Mutex<Vec<Pose>>,
}

/// Planned time of a pose, and where it is.
#[derive(Clone, Copy)]
struct Pose {
    /// Planned time, s.
    planned: f64,
    stage: Stage,
}

#[derive(Clone, Copy)]
enum Stage {
    Waiting,
    InWork(Instant),
    /// Done, after so many seconds.
    Done(f64),
}

impl TimeLeft {
    /// Poses with these planned times, s, of which so many are in work at a time.
    pub(crate) fn new(planned: &[f64], at_a_time: usize) -> Self {
        let waiting = planned.iter().map(|&planned| Pose {
            planned,
            stage: Stage::Waiting,
        });
        Self {
            at_a_time,
            poses: Mutex::new(waiting.collect()),
        }
    }

    /// A pose begins.
    pub(crate) fn begin(&self, pose: usize) {
        let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        poses[pose].stage = Stage::InWork(Instant::now());
    }

    /// A pose has ended: seconds until all are done, 0 after the last.
    pub(crate) fn end(&self, pose: usize) -> f64 {
        let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        if let Stage::InWork(since) = poses[pose].stage {
            poses[pose].stage = Stage::Done(since.elapsed().as_secs_f64());
        }
        left(&poses, self.at_a_time)
    }
}

/// Seconds until all are done, where those that are not take as many times their planned time as those that
/// are.
fn left(poses: &[Pose], at_a_time: usize) -> f64 {
    let (mut planned, mut taken) = (0.0, 0.0);
    for pose in poses {
        if let Stage::Done(seconds) = pose.stage {
            planned += pose.planned;
            taken += seconds;
        }
    }
    // Where nothing wrinkles there is no plan to compare with.
    let factor = if planned > 0.0 { taken / planned } else { 1.0 };
    let of_pose = |pose: &Pose| match pose.stage {
        Stage::Waiting => factor * pose.planned,
        Stage::InWork(since) => (factor * pose.planned - since.elapsed().as_secs_f64()).max(0.0),
        Stage::Done(_) => 0.0,
    };
    let all: f64 = poses.iter().map(of_pose).sum();
    let longest = poses.iter().map(of_pose).fold(0.0, f64::max);
    // The last one may have to be waited for.
    longest.max(all / at_a_time.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(planned: f64, stage: Stage) -> Pose {
        Pose { planned, stage }
    }

    #[test]
    fn what_is_left_takes_as_much_longer_as_what_is_done() {
        let poses = [
            pose(10.0, Stage::Done(20.0)),
            pose(5.0, Stage::Waiting),
            pose(5.0, Stage::Waiting),
        ];
        assert_eq!(left(&poses, 1), 20.0);
        assert_eq!(left(&poses, 2), 10.0);
        // A long one at the end has to be waited for.
        let poses = [poses[0], poses[1], pose(50.0, Stage::Waiting)];
        assert_eq!(left(&poses, 2), 100.0);
        // One that is in work has less to go.
        let poses = [poses[0], pose(50.0, Stage::InWork(Instant::now()))];
        assert!((left(&poses, 1) - 100.0).abs() < 1.0);
    }

    #[test]
    fn the_last_leaves_nothing() {
        let clocks = TimeLeft::new(&[0.0, 3.0], 1);
        clocks.begin(0);
        assert_eq!(clocks.end(0), 3.0);
        clocks.begin(1);
        assert_eq!(clocks.end(1), 0.0);
    }
}
