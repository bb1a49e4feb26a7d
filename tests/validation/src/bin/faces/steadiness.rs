//! Every shape and random mixtures with three presets: what converged, and what took longer than planned.

use std::error::Error;
use std::path::Path;

use ruga_io::{PngTexels, write_png};

use crate::baking::{Pose, Quality};
use crate::mixtures::{described, mixtures};
use crate::rows::{Bench, Lines};
use crate::scenes::{Model, ScenePose, preset_layer};
use crate::table::{Goal, Line};

/// Presets, and whether they lie around the eyes alone.
const PRESETS: [(&str, bool); 3] = [
    ("forehead-furrow", false),
    ("crows-feet", true),
    ("cheek", false),
];

/// Mixtures of the face's shapes.
const MIXTURES: usize = 50;

/// Poses that are named.
const WORST: usize = 10;

/// Seconds below which a pose is as quick as planned, whatever was planned: reading a clock and starting
/// threads are no part of a plan.
const SHORTEST_S: f64 = 1.0;

/// A pose, what it is, and its time over the planned one.
struct Judged {
    what: String,
    ratio: f64,
    pose: Pose,
}

impl Bench {
    /// Bakes all poses of face and hand with each preset.
    pub(crate) fn mixtures(&self) -> Lines {
        let mut sets = Vec::new();
        if let Some(face) = Model::face() {
            let mut poses = face.shapes()?;
            poses.extend(mixtures(&poses, MIXTURES));
            sets.push(("face", face, poses));
        }
        if let Some(hand) = Model::hand() {
            let poses = hand.shapes()?;
            sets.push(("hand", hand, poses));
        }
        if sets.is_empty() {
            return Ok(vec![Line::note("skipped: the shared data are not there")]);
        }
        let (mut lines, mut all) = (Vec::new(), Vec::new());
        for (model_name, model, poses) in &sets {
            for (preset, around_eyes) in PRESETS {
                let around_eyes = around_eyes && *model_name == "face";
                let judged = self.judged((*model_name, model), poses, (preset, around_eyes))?;
                lines.extend(summary(&format!("{preset}, {model_name}"), &judged));
                all.extend(judged);
            }
        }
        all.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        let worst = all.iter().take(WORST).map(|judged| {
            let what = format!("{}: {:.2} times planned", judged.what, judged.ratio);
            Line::note(what).with(std::slice::from_ref(&judged.pose))
        });
        lines.extend(worst);
        Ok(lines)
    }

    /// Bakes these poses with one preset.
    fn judged(
        &self,
        (model_name, model): (&str, &Model),
        poses: &[ScenePose],
        (preset, around_eyes): (&str, bool),
    ) -> Result<Vec<Judged>, Box<dyn Error>> {
        let mut layer = preset_layer(preset);
        if around_eyes {
            layer.push_str("mask = \"eyes.png\"\n");
        }
        let scene = model.scene("", &[layer], (poses, &[1.0]))?;
        let folder = format!("mixtures-{model_name}-{preset}");
        let job = self.job(&folder, &scene, (Quality::Draft, 1))?;
        if around_eyes {
            paint_eyes(model, &job.folder.join("eyes.png"))?;
        }
        let baked = job.bake_each()?;
        let judged = baked.into_iter().zip(poses).map(|(pose, spec)| {
            let [took, planned] = [pose.cpu_seconds(), pose.planned.seconds];
            Judged {
                what: format!("{preset}, {model_name}, {}", described(spec)),
                ratio: took.max(SHORTEST_S) / planned.max(SHORTEST_S),
                pose,
            }
        });
        Ok(judged.collect())
    }
}

/// How many did not converge, how late the latest is, and every failure.
fn summary(what: &str, judged: &[Judged]) -> Vec<Line> {
    let poses: Vec<Pose> = judged.iter().map(|judged| judged.pose.clone()).collect();
    let failures = Line::failures(&poses);
    let worst = judged.iter().map(|judged| judged.ratio).fold(0.0, f64::max);
    let goals = [(Goal::AtMost(0.0), "poses"), (Goal::AtMost(3.0), "times")];
    let converged = format!("{what}, not converged of {}", poses.len());
    let late = format!("{what}, seconds over planned, worst");
    let mut lines = vec![
        Line::judged(converged, goals[0], failures.len() as f64).with(&poses),
        Line::judged(late, goals[1], worst),
    ];
    lines.extend(failures);
    lines
}

/// Texels of the mask along each side.
const MASK: usize = 256;

/// Way that a squint has to move a vertex for it to be beside the eye, as a fraction of the longest, and the
/// radius that is painted around it, in texture coordinates.
const MOVED: f64 = 0.1;
const BRUSH: f64 = 0.012;

/// Paints white where squints move the face: lids and what lies beside the eyes.
fn paint_eyes(face: &Model, file: &Path) -> Result<(), Box<dyn Error>> {
    let mesh = face.read()?;
    let uvs = mesh
        .uvs
        .as_ref()
        .ok_or("a face without texture coordinates")?;
    let squints = mesh
        .shapes
        .iter()
        .filter(|shape| shape.name.starts_with("eyeSquint"));
    let mut moved = Vec::new();
    for shape in squints {
        let ways: Vec<f64> = shape
            .position_deltas
            .iter()
            .map(|delta| delta.norm())
            .collect();
        let longest = ways.iter().copied().fold(0.0, f64::max);
        let far = ways
            .iter()
            .zip(uvs)
            .filter(|(way, _)| **way > MOVED * longest);
        moved.extend(far.map(|(_, uv)| *uv));
    }
    let grey = |texel: usize| {
        let place = [texel % MASK, texel / MASK].map(|i| (i as f64 + 0.5) / MASK as f64);
        let is_near =
            |uv: &nalgebra::Vector2<f64>| (uv.x - place[0]).hypot(uv.y - place[1]) < BRUSH;
        if moved.iter().any(is_near) { 255 } else { 0 }
    };
    let texels: Vec<u8> = (0..MASK * MASK).map(grey).collect();
    Ok(write_png(file, MASK, MASK, PngTexels::Grey8(&texels))?)
}
