//! The rows of the table, but for the mixtures.

use std::error::Error;
use std::path::PathBuf;

use crate::baking::{Job, Pose, Quality, cpu_seconds};
use crate::factorisation::Factorisation;
use crate::scenes::{Model, ScenePose, preset_layer};
use crate::table::{Goal, Line, peak};

/// Where to measure, and how finely.
pub(crate) struct Bench {
    pub(crate) folder: PathBuf,
    /// Quality of every row, when it is not each row's own.
    pub(crate) quality: Option<Quality>,
}

/// The lines of a row.
pub(crate) type Lines = Result<Vec<Line>, Box<dyn Error>>;

/// Bytes of a process, at most.
const MEMORY: (Goal, &str) = (Goal::AtMost(4.0), "GB");

/// Minutes of the hand, at most: a tenth of what was planned when the goal was set.
const HAND_MIN: f64 = 21.0;

/// Scales of the patch, 10 cm wide at 1, with one layer and with two: 5 to 8 thousand vertices at
/// standard quality, and four times the area.
const ONE_LAYER: [f64; 2] = [1.0, 2.0];
const TWO_LAYERS: [f64; 2] = [0.5, 1.0];

/// Runs of a patch, of which the median counts.
const RUNS: usize = 3;

/// The upper of two layers: half the wavelength of the lower one.
const FINE_LAYER: &str = "\
[[layers]]
name = \"fine\"
wavelength = 5e-3
critical_strain = 0.03
";

fn pose(name: &str, shapes: &[&str]) -> ScenePose {
    let weights = shapes.iter().map(|shape| ((*shape).to_owned(), 1.0));
    ScenePose {
        name: name.to_owned(),
        weights: weights.collect(),
    }
}

/// What a row says when its model is not there.
fn skipped() -> Vec<Line> {
    vec![Line::note("skipped: the shared data are not there")]
}

impl Bench {
    /// A job whose scene and results lie in a folder of this name.
    pub(crate) fn job(
        &self,
        name: &str,
        scene: &str,
        (quality, threads): (Quality, u32),
    ) -> Result<Job, Box<dyn Error>> {
        let quality = self.quality.unwrap_or(quality);
        let folder = self.folder.join(quality.name()).join(name);
        Job::new(folder, scene, (quality, threads))
    }

    /// A smile on both sides, one thread.
    pub(crate) fn smile(&self) -> Lines {
        let Some(face) = Model::face() else {
            return Ok(skipped());
        };
        let (smile, unit) = self.timed_smile(&face)?;
        let ratio = cpu_seconds(&smile) / unit.seconds;
        let goal = (Goal::AtMost(40.0), "F");
        let mut lines = vec![
            Line::judged("both sides, keys .5 and 1", goal, ratio).with(&smile),
            Line::note(format!(
                "F = {:.4} s, {} unknowns and {} rows",
                unit.seconds, unit.size[0], unit.size[1]
            )),
        ];
        lines.extend(Line::failures(&smile));
        Ok(lines)
    }

    /// The smile, and a factorisation of its whole KKT matrix.
    fn timed_smile(&self, face: &Model) -> Result<(Vec<Pose>, Factorisation), Box<dyn Error>> {
        let poses = [pose("smile", &["mouthSmile_L", "mouthSmile_R"])];
        let layers = [preset_layer("forehead-furrow")];
        let scene = face.scene("", &layers, (&poses, &[0.5, 1.0]))?;
        let job = self.job("smile", &scene, (Quality::Standard, 1))?;
        let smile = job.bake_each()?;
        let file = job.folder.join("factorisation.json");
        let unit = Factorisation::of(&job.scene(), job.quality.points(), &file)?;
        Ok((smile, unit))
    }

    /// Every shape of the face by itself, one thread.
    pub(crate) fn shapes(&self) -> Lines {
        let Some(face) = Model::face() else {
            return Ok(skipped());
        };
        let (_, unit) = self.timed_smile(&face)?;
        let layers = [preset_layer("forehead-furrow")];
        let scene = face.scene("", &layers, (&face.shapes()?, &[1.0]))?;
        let job = self.job("shapes", &scene, (Quality::Standard, 1))?;
        let poses = job.bake_each()?;
        let ratio = cpu_seconds(&poses) / unit.seconds;
        let what = format!("{} shapes, one by one", poses.len());
        let goal = (Goal::AtMost(1500.0), "F of the smile");
        let mut lines = vec![Line::judged(what, goal, ratio).with(&poses)];
        lines.extend(Line::failures(&poses));
        Ok(lines)
    }

    /// Raised brows under two layers, on one thread and on two.
    pub(crate) fn brows(&self) -> Lines {
        let Some(face) = Model::face() else {
            return Ok(skipped());
        };
        let raised = |shape: &ScenePose| {
            let starts = ["browInnerUp", "browOuterUp"];
            starts.iter().any(|start| shape.name.starts_with(start))
        };
        let shapes = face.shapes()?.into_iter().filter(raised);
        let poses = [ScenePose {
            name: "brows".to_owned(),
            weights: shapes.flat_map(|shape| shape.weights).collect(),
        }];
        let layers = ["face2-dermis", "face2-epidermis"].map(preset_layer);
        // No budget of vertices.
        let scene = face.scene("vertex_budget = 100000000", &layers, (&poses, &[1.0]))?;
        let scene = scene.replacen("version = 1\n", "version = 1\nstack = \"composite\"\n", 1);
        let [one, two] = [1, 2].map(|threads| {
            let folder = format!("brows-{threads}");
            self.job(&folder, &scene, (Quality::Standard, threads))?
                .bake_each()
        });
        let (one, two) = (one?, two?);
        let speed = one[0].seconds() / two[0].seconds();
        let goal = (Goal::AtLeast(1.8), "times as fast");
        let mut lines = vec![
            Line::judged("two layers, two threads against one", goal, speed),
            Line::judged("one thread, peak", MEMORY, 1e-9 * peak(&one)).with(&one),
            Line::judged("two threads, peak", MEMORY, 1e-9 * peak(&two)).with(&two),
        ];
        lines.extend([one, two].iter().flat_map(|poses| Line::failures(poses)));
        Ok(lines)
    }

    /// Every shape of the hand, two threads.
    pub(crate) fn hand(&self) -> Lines {
        let Some(hand) = Model::hand() else {
            return Ok(skipped());
        };
        let layers = [preset_layer("knuckle")];
        let scene = hand.scene("", &layers, (&hand.shapes()?, &[0.5, 1.0]))?;
        let job = self.job("hand", &scene, (Quality::Standard, 2))?;
        let poses = job.bake_together()?;
        let minutes = poses[0].process.wall_s / 60.0;
        let what = format!("{} shapes, two threads, whole command", poses.len());
        let goal = (Goal::AtMost(HAND_MIN), "min");
        let mut lines = vec![
            Line::judged(what, goal, minutes).with(&poses),
            Line::judged("peak", MEMORY, 1e-9 * peak(&poses)),
        ];
        lines.extend(Line::failures(&poses));
        Ok(lines)
    }

    /// A patch and one of four times its area, with one layer and with two.
    pub(crate) fn area(&self) -> Lines {
        let skin = preset_layer("forehead-furrow");
        let stacks = [
            ("one layer", vec![skin.clone()], ONE_LAYER),
            ("two layers", vec![skin, FINE_LAYER.to_owned()], TWO_LAYERS),
        ];
        let mut lines = Vec::new();
        for (name, layers, scales) in stacks {
            let poses = [pose("compress", &["compress"])];
            let [small, large] = scales.map(|scale| {
                let options = format!("scale = {scale:?}");
                let scene = Model::forearm().scene(&options, &layers, (&poses, &[1.0]))?;
                let mut runs = Vec::new();
                for run in 1..=RUNS {
                    let folder = format!("area, {name}, {} cm, {run}", 10.0 * scale);
                    let job = self.job(&folder, &scene, (Quality::Standard, 1))?;
                    runs.push(job.bake_each()?);
                }
                runs.sort_by(|a, b| cpu_seconds(a).total_cmp(&cpu_seconds(b)));
                Ok::<_, Box<dyn Error>>(runs.swap_remove(RUNS / 2))
            });
            let (small, large) = (small?, large?);
            let ratio = cpu_seconds(&large) / cpu_seconds(&small);
            let goal = (Goal::AtMost(4.4), "times the time");
            lines.push(
                Line::judged(format!("{name}, four times the area"), goal, ratio).with(&large),
            );
            lines.push(Line::note(format!("{name}, once the area")).with(&small));
            lines.extend(
                [small, large]
                    .iter()
                    .flat_map(|poses| Line::failures(poses)),
            );
        }
        Ok(lines)
    }

    /// The left and the right smile, which are to have like wrinkles: of even skin, as thick and thin places
    /// of a preset do not mirror.
    pub(crate) fn mirror(&self) -> Lines {
        let Some(face) = Model::face() else {
            return Ok(skipped());
        };
        let poses = [
            pose("left", &["mouthSmile_L"]),
            pose("right", &["mouthSmile_R"]),
        ];
        let layers = [preset_layer("forehead-furrow") + "variation = 0.0\n"];
        let scene = face.scene("", &layers, (&poses, &[1.0]))?;
        let job = self.job("mirror", &scene, (Quality::Standard, 1))?;
        let poses = job.bake_each()?;
        let value = |pose: &Pose| {
            let layer = pose.layers().first()?;
            Some([layer.wavelength_m?, layer.amplitude_m?])
        };
        let values: Vec<[f64; 2]> = poses.iter().filter_map(value).collect();
        let percent = |number: usize| match values.as_slice() {
            [left, right] => 100.0 * (left[number] / right[number] - 1.0).abs(),
            _ => f64::NAN,
        };
        let mut lines = vec![
            Line::judged("wavelength", (Goal::AtMost(3.0), "%"), percent(0)).with(&poses),
            Line::judged("amplitude", (Goal::AtMost(5.0), "%"), percent(1)),
        ];
        lines.extend(Line::failures(&poses));
        Ok(lines)
    }
}
