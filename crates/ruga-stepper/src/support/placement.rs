//! Rigid motions of handles and obstacles.

use nalgebra::{Rotation3, Vector3};

use crate::{Keyframe, Motion};

/// A rigid motion: a turn about a point, then a translation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Placement {
    /// Translation after the turn, m.
    pub(crate) translation: Vector3<f64>,
    /// Axis times angle, rad.
    pub(crate) turn: Vector3<f64>,
    /// A point of the axis at rest, m.
    pub(crate) about: Vector3<f64>,
}

impl Placement {
    /// Placement of a motion at `time`, in [0, 1]: linear between keyframes, constant after the last.
    pub(crate) fn at(motion: Option<&Motion>, time: f64) -> Self {
        let Some(frames) = motion.map(|m| &m.keyframes).filter(|f| !f.is_empty()) else {
            return Self::default();
        };
        let next = frames.partition_point(|frame| frame.at < time);
        let Some(end) = frames.get(next) else {
            return Self::of(&frames[frames.len() - 1]);
        };
        // Before the first keyframe there is the rest at time 0.
        let (at, mut start) = match next.checked_sub(1) {
            Some(last) => (frames[last].at, Self::of(&frames[last])),
            None => (0.0, Self::default()),
        };
        let mut end_about = end.about;
        // Without a turn any point is on the axis.
        if start.turn == Vector3::zeros() {
            start.about = end.about;
        } else if end.turn == Vector3::zeros() {
            end_about = start.about;
        }
        let fraction = (time - at) / (end.at - at);
        let between = |a: Vector3<f64>, b: Vector3<f64>| a + (b - a) * fraction;
        Self {
            // This is linear in the turn's vector, too: a steady turn as long as the axis stays, as
            // from rest to the first keyframe.
            translation: between(start.translation, end.translation),
            turn: between(start.turn, end.turn),
            about: between(start.about, end_about),
        }
    }

    fn of(frame: &Keyframe) -> Self {
        Self {
            translation: frame.translation,
            turn: frame.turn,
            about: frame.about,
        }
    }

    pub(crate) fn rotation(&self) -> Rotation3<f64> {
        Rotation3::from_scaled_axis(self.turn)
    }

    /// Present position of a place at rest.
    pub(crate) fn apply(&self, rest: &Vector3<f64>) -> Vector3<f64> {
        if self.turn == Vector3::zeros() {
            return rest + self.translation;
        }
        self.rotation() * (rest - self.about) + self.about + self.translation
    }

    /// Rest position of a present place.
    pub(crate) fn pull_back(&self, now: &Vector3<f64>) -> Vector3<f64> {
        if self.turn == Vector3::zeros() {
            return now - self.translation;
        }
        self.rotation().inverse() * (now - self.translation - self.about) + self.about
    }
}
