//! Poses that are made of one simulation, because they are mirror images or the same, or of half of one.

use std::sync::Arc;

use ruga_blend::Driver;
use ruga_stepper::{KeyResult, LayerSurface, PoseResult, PoseSpec, SymmetryPlane};

use crate::Mirror;
use crate::halves::both_halves;
use crate::mirror::sorted;

/// End of a warning about a pose that is simulated as its mirror image.
const ON_THE_OTHER_SIDE: &str =
    "; that is on the other side, of which this pose is made as the mirror image";

/// End of a warning about a pose of which one half is simulated.
const OF_ONE_HALF: &str = "; one half of this pose is simulated, and the other is its mirror image";

/// Assignment of the poses of a plan to simulations.
#[derive(Default)]
pub(crate) struct PoseImages {
    mirror: Option<Arc<Mirror>>,
    names: Vec<String>,
    /// Whether a pose is simulated as its mirror image.
    is_image: Vec<bool>,
    /// Whether one half of a pose is simulated, of which the other is the mirror image.
    is_half: Vec<bool>,
    /// The first pose that is simulated in the same way.
    first_alike: Vec<usize>,
}

impl PoseImages {
    /// Chooses how `poses` are made, of which one half may be simulated where the layers allow that; returns them as
    /// they are simulated, too.
    pub(crate) fn new(
        mirror: Option<&Arc<Mirror>>,
        driver: &Driver,
        poses: &[PoseSpec],
        can_halve: bool,
    ) -> (Self, Vec<PoseSpec>) {
        let source = |pose: &PoseSpec| mirror?.source_of(&pose.weights, driver);
        let sources: Vec<_> = poses.iter().map(source).collect();
        let is_image: Vec<bool> = sources.iter().map(Option::is_some).collect();
        let mirrors = |pose: &PoseSpec| {
            can_halve && mirror.is_some_and(|mirror| mirror.is_own_image(&pose.weights))
        };
        let mut is_half: Vec<bool> = poses.iter().map(mirrors).collect();
        if is_half.contains(&true) {
            let plane = SymmetryPlane::new(driver);
            for (half, pose) in is_half.iter_mut().zip(poses) {
                *half &= plane.keeps(driver, &pose.weights);
            }
        }
        let simulated = poses.iter().zip(sources).zip(&is_half);
        let simulated = simulated.map(|((pose, source), half)| PoseSpec {
            weights: source.unwrap_or_else(|| pose.weights.clone()),
            half: *half,
            ..pose.clone()
        });
        let simulated: Vec<PoseSpec> = simulated.collect();
        let is_alike = |a: &PoseSpec, b: &PoseSpec| {
            sorted(a.weights.iter()) == sorted(b.weights.iter())
                && (&a.keys, a.steps) == (&b.keys, b.steps)
        };
        let first_alike = simulated
            .iter()
            .enumerate()
            .map(|(own, pose)| match mirror {
                Some(_) => simulated
                    .iter()
                    .position(|other| is_alike(other, pose))
                    .unwrap_or(own),
                None => own,
            });
        let images = Self {
            mirror: mirror.cloned(),
            names: poses.iter().map(|pose| pose.name.clone()).collect(),
            is_image,
            is_half,
            first_alike: first_alike.collect(),
        };
        (images, simulated)
    }

    pub(crate) fn is_image(&self, pose: usize) -> bool {
        self.is_image.get(pose).copied().unwrap_or(false)
    }

    /// Whether one half of a pose is simulated, of which the other is the mirror image.
    pub(crate) fn is_half(&self, pose: usize) -> bool {
        self.is_half.get(pose).copied().unwrap_or(false)
    }

    pub(crate) fn first_alike(&self, pose: usize) -> usize {
        self.first_alike.get(pose).copied().unwrap_or(pose)
    }

    /// Triangles of the file that the maps of a pose show, from those that are simulated.
    pub(crate) fn shown(&self, pose: usize, simulated: Vec<u32>) -> Vec<u32> {
        match &self.mirror {
            Some(mirror) if self.is_image(pose) => mirror.opposite(&simulated),
            Some(mirror) if self.is_half(pose) => {
                let mut both = mirror.opposite(&simulated);
                both.extend(simulated);
                both.sort_unstable();
                both.dedup();
                both
            }
            _ => simulated,
        }
    }

    /// Says in a plan's warnings about mirrored poses where their places are.
    pub(crate) fn reword(&self, warnings: &mut [String]) {
        for (pose, name) in self.names.iter().enumerate() {
            let start = format!("pose '{name}'");
            for warning in warnings.iter_mut().filter(|text| text.starts_with(&start)) {
                *warning = self.told(warning, [pose, pose]);
            }
        }
    }

    /// Result of `pose`, from that of its simulation.
    pub(crate) fn own(&self, pose: usize, simulated: PoseResult) -> PoseResult {
        match &self.mirror {
            Some(_) if self.is_image(pose) => self.turned(&simulated, [pose, pose]),
            Some(mirror) if self.is_half(pose) => {
                let mut both = doubled(mirror, simulated);
                for warning in &mut both.warnings {
                    *warning = self.told(warning, [pose, pose]);
                }
                both
            }
            _ => simulated,
        }
    }

    /// The result of pose number `from` as that of `to`, which is simulated in the same way.
    pub(crate) fn passed_on(&self, result: &PoseResult, [from, to]: [usize; 2]) -> PoseResult {
        if self.is_image(from) != self.is_image(to) {
            return self.turned(result, [from, to]);
        }
        let warnings = result.warnings.iter();
        PoseResult {
            warnings: warnings.map(|text| self.told(text, [from, to])).collect(),
            ..result.clone()
        }
    }

    /// The mirror image of a result.
    fn turned(&self, result: &PoseResult, poses: [usize; 2]) -> PoseResult {
        let mirror = self.mirror.as_ref().expect("images are made by a mirror");
        let mut keys: Vec<KeyResult> = Vec::new();
        for key in &result.keys {
            let layers = key.layers.iter().map(|layer| mirror.image(layer));
            let layers = sharing(keys.last(), layers);
            keys.push(KeyResult {
                load: key.load,
                layers,
                // A mesh that moves with a soft body is not mirrored.
                artist_positions: None,
            });
        }
        let warnings = result.warnings.iter();
        PoseResult {
            keys,
            layers: result.layers.clone(),
            frames: result.frames,
            converged: result.converged,
            interrupted: result.interrupted,
            warnings: warnings.map(|text| self.told(text, poses)).collect(),
        }
    }

    /// A warning about one pose as one about another.
    fn told(&self, warning: &str, [from, to]: [usize; 2]) -> String {
        let ends = [ON_THE_OTHER_SIDE, OF_ONE_HALF].into_iter();
        let text = ends.fold(warning, |text, end| text.strip_suffix(end).unwrap_or(text));
        let about = |pose: usize| format!("pose '{}'", self.names[pose]);
        let renamed = match text.strip_prefix(&about(from)) {
            Some(rest) => about(to) + rest,
            None => text.to_owned(),
        };
        match (self.is_image(to), self.is_half(to)) {
            (true, _) => renamed + ON_THE_OTHER_SIDE,
            (_, true) => renamed + OF_ONE_HALF,
            _ => renamed,
        }
    }
}

/// The layers of a key, which share lists with those of the key before.
fn sharing(
    before: Option<&KeyResult>,
    layers: impl Iterator<Item = LayerSurface>,
) -> Vec<LayerSurface> {
    let shared = layers.enumerate().map(|(i, mut layer)| {
        if let Some(before) = before.and_then(|key| key.layers.get(i)) {
            layer.share_lists(before);
        }
        layer
    });
    shared.collect()
}

/// The result of a whole pose from that of one half; energy and area become those of both.
fn doubled(mirror: &Mirror, mut half: PoseResult) -> PoseResult {
    let mut keys: Vec<KeyResult> = Vec::new();
    for key in std::mem::take(&mut half.keys) {
        let layers = key
            .layers
            .into_iter()
            .map(|layer| both_halves(mirror, layer));
        let layers = sharing(keys.last(), layers);
        keys.push(KeyResult { layers, ..key });
    }
    for layer in &mut half.layers {
        layer.energy *= 2.0;
        layer.left_out *= 2.0;
    }
    PoseResult { keys, ..half }
}
