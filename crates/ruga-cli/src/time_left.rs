//! How long the poses that are left will take, judged by those that are done.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Part of an average pose that counts as having taken what was planned before any pose is done.
///
/// With less, the first poses count too much, which take longer than others against their plans; with more, a busy
/// machine that is slower than planned is noticed too late.
const AS_PLANNED: f64 = 0.3;

/// Clocks of the poses of a run.
pub(crate) struct TimeLeft {
    /// Poses in work at a time.
    at_a_time: usize,
    poses: Mutex<Vec<Pose>>,
}

/// Planned time of a pose, and where it is.
#[derive(Clone)]
struct Pose {
    /// Planned time of each layer, s.
    planned: Vec<f64>,
    stage: Stage,
}

#[derive(Clone)]
enum Stage {
    Waiting,
    InWork(Instant),
    Done(Taken),
}

/// Time that a pose took.
#[derive(Clone)]
struct Taken {
    /// That of each layer, s.
    layers: Vec<f64>,
    /// What else there was to do, such as to write files, s.
    rest: f64,
}

impl TimeLeft {
    /// Poses with these planned times of their layers, s, of which so many poses are in work at a time.
    pub(crate) fn new(planned: Vec<Vec<f64>>, at_a_time: usize) -> Self {
        let waiting = planned.into_iter().map(|planned| Pose {
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

    /// A pose has ended, and its layers have taken these times, s; seconds until all are done, 0 after the last.
    pub(crate) fn end(&self, pose: usize, layers: Vec<f64>) -> f64 {
        let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        if let Stage::InWork(since) = poses[pose].stage {
            let rest = since.elapsed().as_secs_f64() - layers.iter().sum::<f64>();
            let rest = rest.max(0.0);
            poses[pose].stage = Stage::Done(Taken { layers, rest });
        }
        left(&poses, self.at_a_time)
    }
}

/// Seconds until all are done, where every layer takes as many times its planned time as it did before.
fn left(poses: &[Pose], at_a_time: usize) -> f64 {
    let (factors, rest) = (factors(poses), mean_rest(poses));
    let expected = |pose: &Pose| {
        let layers = pose.planned.iter().zip(&factors);
        rest + layers
            .map(|(planned, factor)| planned * factor)
            .sum::<f64>()
    };
    let of_pose = |pose: &Pose| match &pose.stage {
        Stage::Waiting => expected(pose),
        Stage::InWork(since) => (expected(pose) - since.elapsed().as_secs_f64()).max(0.0),
        Stage::Done(_) => 0.0,
    };
    let all: f64 = poses.iter().map(of_pose).sum();
    let longest = poses.iter().map(of_pose).fold(0.0, f64::max);
    // The last one may have to be waited for.
    longest.max(all / at_a_time.max(1) as f64)
}

/// Time taken over time planned, for each layer.
///
/// One pose says little of others: on a face, poses take from a third of what is planned to three times as much, and
/// layers differ more than poses. So a layer's factor is that of all layers until poses with it are done: it
/// counts as if one average pose of it had taken its time by that factor before.
fn factors(poses: &[Pose]) -> Vec<f64> {
    let layers = poses.iter().map(|pose| pose.planned.len()).max();
    let layers = 0..layers.unwrap_or(0);
    let planned_of = |pose: &Pose, layer: usize| pose.planned.get(layer).copied().unwrap_or(0.0);
    let taken_of = |taken: &Taken, layer: usize| taken.layers.get(layer).copied().unwrap_or(0.0);
    // Planned and taken times of poses that are done, and an average of what is planned.
    let sums = |planned_time: &dyn Fn(&Pose) -> f64, taken_time: &dyn Fn(&Taken) -> f64| {
        let (mut planned, mut taken) = (0.0, 0.0);
        for pose in poses {
            if let Stage::Done(time) = &pose.stage {
                planned += planned_time(pose);
                taken += taken_time(time);
            }
        }
        let wrinkling = poses.iter().map(planned_time).filter(|time| *time > 0.0);
        let count = wrinkling.clone().count().max(1);
        [planned, taken, wrinkling.sum::<f64>() / count as f64]
    };
    let factor = |[planned, taken, known]: [f64; 3], before: f64| match known > 0.0 {
        true => (taken + before * known) / (planned + known),
        // Where nothing wrinkles there is no plan to compare with.
        false => before,
    };
    let all = sums(&|pose| pose.planned.iter().sum(), &|taken| {
        taken.layers.iter().sum()
    });
    let [planned, taken, average] = all;
    let all = factor([planned, taken, AS_PLANNED * average], 1.0);
    let of_layer = |layer: usize| {
        let sums = sums(&|pose| planned_of(pose, layer), &|taken| {
            taken_of(taken, layer)
        });
        factor(sums, all)
    };
    layers.map(of_layer).collect()
}

/// Mean of the time that poses took beside their layers, s.
fn mean_rest(poses: &[Pose]) -> f64 {
    let done = poses.iter().filter_map(|pose| match &pose.stage {
        Stage::Done(taken) => Some(taken.rest),
        _ => None,
    });
    let count = done.clone().count().max(1);
    done.sum::<f64>() / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(planned: &[f64], stage: Stage) -> Pose {
        Pose {
            planned: planned.to_vec(),
            stage,
        }
    }

    fn done(planned: &[f64], taken: &[f64]) -> Pose {
        let layers = taken.to_vec();
        pose(planned, Stage::Done(Taken { layers, rest: 0.0 }))
    }

    #[test]
    fn what_is_left_takes_longer_as_what_is_done_did() {
        let waiting = pose(&[10.0], Stage::Waiting);
        let poses = [done(&[10.0], &[30.0]), waiting.clone(), waiting.clone()];
        // One pose of three times as planned, and a part of one as planned before it.
        let all = (30.0 + AS_PLANNED * 10.0) / (10.0 + AS_PLANNED * 10.0);
        let factor = (30.0 + all * 10.0) / 20.0;
        assert!((left(&poses, 1) - 20.0 * factor).abs() < 1e-9);
        assert!((left(&poses, 2) - 10.0 * factor).abs() < 1e-9);
        // A long one at the end has to be waited for.
        let long = pose(&[50.0], Stage::Waiting);
        let poses = [done(&[10.0], &[10.0]), waiting, long];
        assert_eq!(left(&poses, 2), 50.0);
        // One that is in work has less to go.
        let poses = [
            poses[0].clone(),
            pose(&[50.0], Stage::InWork(Instant::now())),
        ];
        assert!((left(&poses, 1) - 50.0).abs() < 1.0);
    }

    #[test]
    fn many_poses_outweigh_what_was_expected_before_them() {
        let mut poses = vec![done(&[2.0], &[6.0]); 100];
        poses.push(pose(&[2.0], Stage::Waiting));
        assert!((left(&poses, 1) - 6.0).abs() < 0.1);
    }

    #[test]
    fn every_layer_has_a_factor_of_its_own_and_the_rest_is_added() {
        let mut poses = vec![done(&[1.0, 0.0], &[4.0, 0.0]); 50];
        poses.extend(vec![done(&[0.0, 1.0], &[0.0, 1.0]); 50]);
        let at_end = |planned: [f64; 2]| {
            let mut poses = poses.clone();
            poses.push(pose(&planned, Stage::Waiting));
            left(&poses, 1)
        };
        assert!((at_end([1.0, 0.0]) - 4.0).abs() < 0.1);
        assert!((at_end([0.0, 1.0]) - 1.0).abs() < 0.1);
        let taken = Taken {
            layers: vec![0.0],
            rest: 3.0,
        };
        let poses = [
            pose(&[0.0], Stage::Done(taken)),
            pose(&[0.0], Stage::Waiting),
        ];
        assert_eq!(left(&poses, 1), 3.0);
    }

    #[test]
    fn the_last_leaves_nothing() {
        let clocks = TimeLeft::new(vec![vec![0.0], vec![3.0]], 1);
        clocks.begin(0);
        assert!((clocks.end(0, vec![0.0]) - 3.0).abs() < 0.1);
        clocks.begin(1);
        assert_eq!(clocks.end(1, vec![1.0]), 0.0);
    }
}
