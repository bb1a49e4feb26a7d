//! How long the poses that are left will take, judged by those that are done.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::pose_queue::{Capacity, Planned, seconds_until_done};

/// Part of an average pose that counts as having taken what was planned before any pose is done.
///
/// With less, the first poses count too much, which take longer than others against their plans; with more, a busy
/// machine that is slower than planned is noticed too late.
const AS_PLANNED: f64 = 0.3;

/// Part of the work on layers that several threads share, a guess: two poses of a hand took .66 and .76 of their time
/// on two, with reading, planning and writing.
const SHARED: f64 = 0.8;

/// Clocks of the poses of a run.
pub(crate) struct TimeLeft {
    /// What the poses take, and what they may take at a time.
    planned: Vec<Planned>,
    capacity: Capacity,
    poses: Mutex<Vec<Pose>>,
}

/// Planned time of a pose, and where it is.
#[derive(Clone)]
struct Pose {
    /// Planned time of each layer on one thread, s.
    planned: Vec<f64>,
    stage: Stage,
}

#[derive(Clone)]
enum Stage {
    Waiting,
    InWork { since: Instant, threads: usize },
    Done(Taken),
}

/// Time that a pose took.
#[derive(Clone)]
struct Taken {
    /// That of each layer, as on one thread, s.
    layers: Vec<f64>,
    /// What else there was to do, such as to write files, s.
    rest: f64,
}

impl TimeLeft {
    /// Poses whose layers have these `seconds` planned on one thread, in the turns that they are `planned` to have.
    pub(crate) fn new(
        (planned, capacity): (Vec<Planned>, Capacity),
        seconds: Vec<Vec<f64>>,
    ) -> Self {
        let waiting = seconds.into_iter().map(|planned| Pose {
            planned,
            stage: Stage::Waiting,
        });
        Self {
            planned,
            capacity,
            poses: Mutex::new(waiting.collect()),
        }
    }

    /// A pose begins, on so many threads.
    pub(crate) fn begin(&self, pose: usize, threads: usize) {
        let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        poses[pose].stage = Stage::InWork {
            since: Instant::now(),
            threads,
        };
    }

    /// A pose has ended, and its layers have taken these times, s; seconds until all are done, 0 after the last.
    pub(crate) fn end(&self, pose: usize, layers: Vec<f64>) -> f64 {
        let mut poses = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        if let Stage::InWork { since, threads } = poses[pose].stage {
            let rest = since.elapsed().as_secs_f64() - layers.iter().sum::<f64>();
            let rest = rest.max(0.0);
            let on_one = layers
                .into_iter()
                .map(|seconds| seconds / share_of_time(threads));
            let layers = on_one.collect();
            poses[pose].stage = Stage::Done(Taken { layers, rest });
        }
        left(&poses, (&self.planned, self.capacity))
    }
}

/// Time that layers take on so many threads, over that on one.
fn share_of_time(threads: usize) -> f64 {
    1.0 - SHARED + SHARED / threads.max(1) as f64
}

/// Seconds until all are done, where every layer takes as many times its planned time as it did before.
fn left(poses: &[Pose], turns: (&[Planned], Capacity)) -> f64 {
    let (factors, rest) = (factors(poses), mean_rest(poses));
    let expected = |pose: &Pose, threads: usize| {
        let layers = pose.planned.iter().zip(&factors);
        let layers = layers.map(|(planned, factor)| planned * factor);
        rest + layers.sum::<f64>() * share_of_time(threads)
    };
    let (mut waiting, mut in_work) = (Vec::new(), Vec::new());
    for (number, pose) in poses.iter().enumerate() {
        match &pose.stage {
            Stage::Waiting => waiting.push(number),
            Stage::InWork { since, threads } => {
                let to_go = expected(pose, *threads) - since.elapsed().as_secs_f64();
                in_work.push((number, *threads, to_go.max(0.0)));
            }
            Stage::Done(_) => {}
        }
    }
    let seconds = |number: usize, threads| expected(&poses[number], threads);
    seconds_until_done(turns, waiting, in_work, seconds)
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

    /// What is left where so many threads have memory for all poses.
    fn left_on(poses: &[Pose], threads: usize) -> f64 {
        let capacity = Capacity {
            threads,
            memory: None,
        };
        let seconds = |pose: &Pose| pose.planned.iter().sum();
        let planned = poses.iter().map(|pose| Planned {
            bytes: 1,
            seconds: seconds(pose),
        });
        left(poses, (&planned.collect::<Vec<_>>(), capacity))
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
        assert!((left_on(&poses, 1) - 20.0 * factor).abs() < 1e-9);
        assert!((left_on(&poses, 2) - 10.0 * factor).abs() < 1e-9);
        // A long one at the end has to be waited for.
        let long = pose(&[50.0], Stage::Waiting);
        let poses = [done(&[10.0], &[10.0]), waiting, long];
        assert_eq!(left_on(&poses, 2), 50.0);
        // One that is in work has less to go.
        let poses = [
            poses[0].clone(),
            pose(
                &[50.0],
                Stage::InWork {
                    since: Instant::now(),
                    threads: 1,
                },
            ),
        ];
        assert!((left_on(&poses, 1) - 50.0).abs() < 1.0);
    }

    #[test]
    fn many_poses_outweigh_what_was_expected_before_them() {
        let mut poses = vec![done(&[2.0], &[6.0]); 100];
        poses.push(pose(&[2.0], Stage::Waiting));
        assert!((left_on(&poses, 1) - 6.0).abs() < 0.1);
    }

    #[test]
    fn every_layer_has_a_factor_of_its_own_and_the_rest_is_added() {
        let mut poses = vec![done(&[1.0, 0.0], &[4.0, 0.0]); 50];
        poses.extend(vec![done(&[0.0, 1.0], &[0.0, 1.0]); 50]);
        let at_end = |planned: [f64; 2]| {
            let mut poses = poses.clone();
            poses.push(pose(&planned, Stage::Waiting));
            left_on(&poses, 1)
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
        assert_eq!(left_on(&poses, 1), 3.0);
    }

    #[test]
    fn the_last_leaves_nothing() {
        let planned = [0.0, 3.0].map(|seconds| Planned { bytes: 1, seconds });
        let capacity = Capacity {
            threads: 1,
            memory: None,
        };
        let turns = (planned.to_vec(), capacity);
        let clocks = TimeLeft::new(turns, vec![vec![0.0], vec![3.0]]);
        clocks.begin(0, 1);
        assert!((clocks.end(0, vec![0.0]) - 3.0).abs() < 0.1);
        clocks.begin(1, 1);
        assert_eq!(clocks.end(1, vec![1.0]), 0.0);
    }
}
