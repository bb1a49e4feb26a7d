//! Scenes that `ruga` plans and bakes, and what it reports of their poses.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::slice;

use clap::ValueEnum;
use ruga_io::{LayerReport, PoseReport, Report};
use ruga_stepper::Modelling;
use serde::Deserialize;

use crate::process::{Process, first_error};

/// How fine the meshes are, as `ruga bake --quality` has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quality {
    Draft,
    Standard,
    Fine,
}

/// A scene, and how it is baked.
pub(crate) struct Job {
    /// Folder of the scene and of what comes of it.
    pub(crate) folder: PathBuf,
    pub(crate) quality: Quality,
    /// Threads of one process.
    pub(crate) threads: u32,
}

/// What `ruga plan --json` says of a pose.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Planned {
    pub(crate) name: String,
    pub(crate) seconds: f64,
}

/// The part of a plan that is read.
#[derive(Deserialize)]
struct PlanFile {
    poses: Vec<Planned>,
}

/// A pose that was to be baked.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    pub(crate) planned: Planned,
    /// The process that baked it, perhaps beside others.
    pub(crate) process: Process,
    report: Option<PoseReport>,
}

/// A process may take this many times the planned time, and some seconds more, before it is stopped.
const PATIENCE: f64 = 10.0;
const PATIENCE_S: f64 = 600.0;

impl Quality {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Standard => "standard",
            Self::Fine => "fine",
        }
    }

    /// Vertices per wavelength.
    pub(crate) fn points(self) -> f64 {
        let modelling = match self {
            Self::Draft => Modelling::draft(),
            Self::Standard => Modelling::standard(),
            Self::Fine => Modelling::fine(),
        };
        modelling.points_per_wavelength
    }
}

impl Job {
    /// A job with a scene of this text.
    pub(crate) fn new(
        folder: PathBuf,
        scene: &str,
        (quality, threads): (Quality, u32),
    ) -> Result<Self, Box<dyn Error>> {
        fs::create_dir_all(&folder)?;
        let job = Self {
            folder,
            quality,
            threads,
        };
        fs::write(job.scene(), scene)?;
        Ok(job)
    }

    /// The scene's file.
    pub(crate) fn scene(&self) -> PathBuf {
        self.folder.join("scene.toml")
    }

    /// Bakes every pose in a process of its own: one that fails leaves the others alone, and each has its
    /// own peak of memory.
    pub(crate) fn bake_each(&self) -> Result<Vec<Pose>, Box<dyn Error>> {
        let planned = self.plan()?;
        let mut poses = Vec::new();
        for (number, pose) in planned.iter().enumerate() {
            let place = format!("{} of {}", number + 1, planned.len());
            let out = self.folder.join(&pose.name);
            poses.extend(self.bake(&out, slice::from_ref(pose), &place)?);
        }
        Ok(poses)
    }

    /// Bakes all poses in one process.
    pub(crate) fn bake_together(&self) -> Result<Vec<Pose>, Box<dyn Error>> {
        let planned = self.plan()?;
        self.bake(&self.folder.join("together"), &planned, "all poses")
    }

    fn bake(
        &self,
        out: &Path,
        planned: &[Planned],
        place: &str,
    ) -> Result<Vec<Pose>, Box<dyn Error>> {
        fs::create_dir_all(out)?;
        let results = out.join("out");
        let mut command = self.ruga("bake")?;
        command.arg("--output").arg(&results);
        command.args(["--resume", "--maps-only", "--threads"]);
        command.arg(self.threads.to_string());
        command.args(
            planned
                .iter()
                .flat_map(|pose| ["--pose", pose.name.as_str()]),
        );
        let seconds: f64 = planned.iter().map(|pose| pose.seconds).sum();
        let title = self.title(out);
        eprintln!("{title}: {place}, planned {seconds:.0} s");
        let process = Process::run(
            &mut command,
            (&out.join("process.json"), &out.join("log.txt")),
            (&title, PATIENCE * seconds + PATIENCE_S),
        )?;
        let report = match fs::read(results.join("report.json")) {
            Ok(bytes) => serde_json::from_slice::<Report>(&bytes)?.poses,
            // A process that failed at its only pose writes none.
            Err(_) => Vec::new(),
        };
        let pose = |planned: &Planned| Pose {
            planned: planned.clone(),
            process: process.clone(),
            report: report
                .iter()
                .find(|pose| pose.name == planned.name)
                .cloned(),
        };
        let poses: Vec<Pose> = planned.iter().map(pose).collect();
        for pose in &poses {
            let failure = pose.failure().unwrap_or_default();
            eprintln!("{}: {:.1} s {failure}", pose.planned.name, pose.seconds());
        }
        Ok(poses)
    }

    /// What the planner says of every pose.
    fn plan(&self) -> Result<Vec<Planned>, Box<dyn Error>> {
        let output = self.ruga("plan")?.arg("--json").output()?;
        if !output.status.success() {
            return Err(first_error(&String::from_utf8_lossy(&output.stderr)).into());
        }
        fs::write(self.folder.join("plan.json"), &output.stdout)?;
        Ok(serde_json::from_slice::<PlanFile>(&output.stdout)?.poses)
    }

    /// The command, built beside this program by whoever started it, with the scene and its quality.
    fn ruga(&self, task: &str) -> Result<Command, Box<dyn Error>> {
        let name = format!("ruga{}", std::env::consts::EXE_SUFFIX);
        let mut command = Command::new(std::env::current_exe()?.with_file_name(name));
        command.arg(task).arg(self.scene());
        command.args(["--quality", self.quality.name()]);
        Ok(command)
    }

    /// The folder of results in a line of progress, with that of the scene.
    fn title(&self, out: &Path) -> String {
        let folder = self.folder.parent().unwrap_or(&self.folder);
        out.strip_prefix(folder)
            .unwrap_or(out)
            .display()
            .to_string()
    }
}

impl Pose {
    /// What is reported of its layers; nothing where it has no result.
    pub(crate) fn layers(&self) -> &[LayerReport] {
        self.report.as_ref().map_or(&[], |report| &report.layers)
    }

    /// Seconds of the wall clock in which it was simulated.
    pub(crate) fn seconds(&self) -> f64 {
        let Some(report) = &self.report else {
            return 0.0;
        };
        // The report has means per frame.
        let layers = report.layers.iter().filter_map(|layer| layer.seconds.total);
        layers.sum::<f64>() * f64::from(report.frames.max(1))
    }

    /// Seconds of the processor in which it was simulated on one thread: those of the wall clock without
    /// what others took of it.
    pub(crate) fn cpu_seconds(&self) -> f64 {
        self.seconds() * self.process.busy()
    }

    /// Why it has no good result.
    pub(crate) fn failure(&self) -> Option<String> {
        let Some(report) = &self.report else {
            let ending = self.process.ending.clone().unwrap_or_default();
            return Some(format!("no result: {ending}"));
        };
        if report.converged {
            return None;
        }
        let rules = report
            .layers
            .iter()
            .filter_map(|layer| layer.stop_rule.as_deref());
        let rules: Vec<&str> = rules.collect();
        Some(format!("did not converge ({})", rules.join(", ")))
    }
}

/// Processor seconds of all poses; not a number where one has no result.
pub(crate) fn cpu_seconds(poses: &[Pose]) -> f64 {
    let seconds = |pose: &Pose| {
        pose.report
            .as_ref()
            .map_or(f64::NAN, |_| pose.cpu_seconds())
    };
    poses.iter().map(seconds).sum()
}
