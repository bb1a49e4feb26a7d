//! What will be modelled: the stacks of a scene's zones, on a driver or on a soft body.

use ruga_stepper::{
    Frame, InteriorPlan, KeyResult, LayerPlan, Observer, Phase, Plan, PoseResult, Preparation,
    Progress, Sheet, StepperError,
};

use crate::symmetry::PoseImages;

/// Words of the planner's warning of creases that none of the planned poses folds: of a crease of the frown nobody
/// needs to hear that the smile does not fold it.
const NEVER_FOLDED: &str = "': no pose folds '";

/// The plan of a scene.
pub struct ScenePlan {
    /// Stacks side by side, at least one: that of a scene without zones.
    pub zones: Vec<ZonePlan>,
    /// Bytes of the maps of further UDIM tiles, for each pose.
    pub(crate) map_bytes: Vec<f64>,
    images: PoseImages,
}

/// The stack of one zone.
pub struct ZonePlan {
    /// Its layers as numbers into the scene's, bottom first.
    pub layers: Vec<usize>,
    /// Plan of what will be modelled of it.
    pub plan: Plan,
}

impl ScenePlan {
    /// The plan of a mesh without UDIM tiles.
    pub(crate) fn new(mut zones: Vec<ZonePlan>, images: PoseImages) -> Self {
        for zone in &mut zones {
            images.reword(&mut zone.plan.warnings);
        }
        Self {
            zones,
            images,
            map_bytes: Vec::new(),
        }
    }

    /// The layers of pose number `pose` over all zones, in the order of the scene.
    ///
    /// # Panics
    /// When there is no pose of that number.
    pub fn pose_layers(&self, pose: usize) -> Vec<&LayerPlan> {
        let mut layers = Vec::new();
        for zone in &self.zones {
            layers.extend(zone.layers.iter().zip(&zone.plan.poses[pose].layers));
        }
        layers.sort_by_key(|(number, _)| **number);
        layers.into_iter().map(|(_, layer)| layer).collect()
    }

    /// Expected memory of pose number `pose` while it is simulated and baked, bytes: that of the layer which
    /// takes most, as layers come and go, with the maps of all UDIM tiles, and 0 where nothing wrinkles.
    ///
    /// # Panics
    /// When there is no pose of that number.
    pub fn pose_memory(&self, pose: usize) -> f64 {
        let layers = self.pose_layers(pose).into_iter();
        let simulated = layers.filter(|layer| layer.vertices > 0);
        let largest = simulated.map(|layer| layer.memory).fold(0.0, f64::max);
        let maps = self.map_bytes.get(pose).copied().unwrap_or(0.0);
        if largest > 0.0 { largest + maps } else { 0.0 }
    }

    /// The lattice of the body that carries the layer, if there is one.
    pub fn interior(&self) -> Option<&InteriorPlan> {
        self.zones
            .iter()
            .find_map(|zone| zone.plan.interior.as_ref())
    }

    /// What acts on the layer, if it is a free sheet.
    pub fn sheet(&self) -> Option<&Sheet> {
        self.zones.iter().find_map(|zone| zone.plan.sheet())
    }

    /// Warnings for the user before anything is simulated.
    pub fn warnings(&self) -> impl Iterator<Item = &String> {
        self.zones.iter().flat_map(|zone| &zone.plan.warnings)
    }

    /// The first pose that is made of the same simulation as pose number `pose`: itself, or its mirror image.
    pub fn first_alike(&self, pose: usize) -> usize {
        self.images.first_alike(pose)
    }

    /// Whether pose number `pose` is simulated as its mirror image.
    pub fn is_image(&self, pose: usize) -> bool {
        self.images.is_image(pose)
    }

    /// Whether one half of pose number `pose` is simulated, because it is its own mirror image; what the plan tells of
    /// it is of that half.
    pub fn is_half(&self, pose: usize) -> bool {
        self.images.is_half(pose)
    }

    /// The `result` of pose number `from` as that of `to`, which is made of the same simulation
    /// ([`Self::first_alike`]); a mirror image has no [`ComputedMesh`](ruga_stepper::ComputedMesh).
    ///
    /// # Panics
    /// When there is no pose of one of the numbers.
    pub fn passed_on(&self, result: &PoseResult, [from, to]: [usize; 2]) -> PoseResult {
        self.images.passed_on(result, [from, to])
    }

    /// Triangles of the file that maps of pose number `pose` show, ascending.
    pub(crate) fn shown_triangles(&self, pose: usize) -> Vec<u32> {
        self.images.shown(pose, self.active_triangles(pose))
    }

    /// Adds what the plan itself cannot know.
    pub(crate) fn warn(&mut self, warnings: Vec<String>) {
        self.zones[0].plan.warnings.extend(warnings);
    }

    /// Leaves out the warnings that are true of all poses of a scene only, of a plan of some of them.
    pub(crate) fn drop_of_all_poses(&mut self) {
        for zone in &mut self.zones {
            let warnings = &mut zone.plan.warnings;
            warnings.retain(|warning| !warning.contains(NEVER_FOLDED));
        }
    }

    /// The file's triangles that have a simulated part in pose number `pose`, ascending.
    pub fn active_triangles(&self, pose: usize) -> Vec<u32> {
        let of_zones = self.zones.iter();
        let mut triangles: Vec<u32> = of_zones
            .flat_map(|zone| zone.plan.active_triangles(pose))
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }

    /// Simulates pose number `pose`, one zone after the other; a mirror image, and a pose of which one half is
    /// simulated, have no [`ComputedMesh`](ruga_stepper::ComputedMesh), and frames of what is simulated.
    ///
    /// # Errors
    /// Those of [`Plan::simulate`], such as a number that no pose has.
    pub fn simulate(
        &self,
        pose: usize,
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        let mut results = Vec::new();
        for zone in &self.zones {
            let mut observer = ZoneObserver {
                layers: &zone.layers,
                observer,
            };
            let result = zone.plan.simulate(pose, &mut observer)?;
            let is_interrupted = result.interrupted;
            results.push(result);
            if is_interrupted {
                break;
            }
        }
        let zones: Vec<&[usize]> = self.zones.iter().map(|z| z.layers.as_slice()).collect();
        let layers = zones.iter().map(|layers| layers.len()).sum();
        Ok(self.images.own(pose, merged(layers, &zones, results)))
    }
}

/// The results of the zones of a scene with `count` layers as one; `zones` has for each zone the
/// numbers of its layers in the scene.
///
/// A key is finished when every zone has reached it. After an interruption `results` has fewer
/// entries than there are zones, and no key is finished.
fn merged(count: usize, zones: &[&[usize]], results: Vec<PoseResult>) -> PoseResult {
    let mut whole = PoseResult {
        keys: finished_keys(zones.len(), &results),
        layers: vec![Default::default(); count],
        converged: true,
        ..PoseResult::default()
    };
    for (layers, result) in zones.iter().zip(results) {
        add(&mut whole, result, layers);
    }
    whole
}

/// The keys, still without layers, that the results of all `zones` have.
fn finished_keys(zones: usize, results: &[PoseResult]) -> Vec<KeyResult> {
    let has = |result: &PoseResult, load: f64| result.keys.iter().any(|key| key.load == load);
    let is_finished = |key: &&KeyResult| {
        results.len() == zones && results.iter().all(|result| has(result, key.load))
    };
    let first = results.first().into_iter().flat_map(|result| &result.keys);
    let finished = first.filter(is_finished);
    finished
        .map(|key| KeyResult {
            load: key.load,
            layers: Vec::new(),
            // Where a body moves the mesh, its layer is the only zone.
            artist_positions: key.artist_positions.clone(),
        })
        .collect()
}

/// Adds the result of a zone, whose layers have these numbers in the scene; keys that are not
/// finished everywhere are left out.
fn add(whole: &mut PoseResult, zone: PoseResult, layers: &[usize]) {
    for key in zone.keys {
        if let Some(finished) = whole.keys.iter_mut().find(|other| other.load == key.load) {
            finished.layers.extend(key.layers);
        }
    }
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

    fn wants_face_states(&self) -> bool {
        self.observer.wants_face_states()
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        self.observer.frame(frame);
    }
}

#[cfg(test)]
mod tests {
    use ruga_stepper::{LayerReport, LayerSurface};

    use super::*;

    /// A zone of one layer that has reached some keys; where it wrinkles, its layer is in them.
    fn zone(name: &str, loads: &[f64], wrinkles: bool, interrupted: bool) -> PoseResult {
        let surface = LayerSurface {
            name: name.to_owned(),
            ..LayerSurface::default()
        };
        let key = |&load: &f64| KeyResult {
            load,
            layers: vec![surface.clone(); usize::from(wrinkles)],
            ..KeyResult::default()
        };
        PoseResult {
            keys: loads.iter().map(key).collect(),
            layers: vec![LayerReport {
                name: name.to_owned(),
                ..LayerReport::default()
            }],
            converged: true,
            interrupted,
            ..PoseResult::default()
        }
    }

    /// The keys of a result, each with the names of its layers.
    fn keys(result: &PoseResult) -> Vec<(f64, Vec<&str>)> {
        let named = result.keys.iter().map(|key| {
            let layers = key.layers.iter();
            (key.load, layers.map(|layer| layer.name.as_str()).collect())
        });
        named.collect()
    }

    #[test]
    fn a_key_is_finished_when_every_zone_has_it() {
        let zones: [&[usize]; 2] = [&[1], &[0]];
        let whole = zone("a", &[0.5, 1.0], true, false);
        let early = zone("b", &[0.5], true, true);
        let found = merged(2, &zones, vec![whole.clone(), early]);
        assert_eq!(keys(&found), [(0.5, vec!["a", "b"])]);
        assert!(found.interrupted);
        assert_eq!([&found.layers[0].name, &found.layers[1].name], ["b", "a"]);

        // Interrupted in the first zone: the second one has nothing yet.
        let found = merged(2, &zones, vec![zone("a", &[0.5], true, true)]);
        assert_eq!(keys(&found), []);
        // A zone in which nothing wrinkles has all keys, and no layers in them.
        let flat = zone("b", &[0.5, 1.0], false, false);
        let found = merged(2, &zones, vec![flat, whole]);
        assert_eq!(keys(&found), [(0.5, vec!["a"]), (1.0, vec!["a"])]);
    }
}
