//! What can be typed after `ruga`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::templates::Template;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  ran, but a pose did not converge or the run was interrupted; results are written and marked
  2  could not run; the message says what to mend

Results go to stdout, progress and messages to stderr.";

const PLAN_COLUMNS: &str = "\
Columns:
  strain median, 99 %  how much the pose compresses the simulated skin: half, and all but the
                       worst hundredth, of its area is compressed less than this
  simulated            area that is compressed enough to wrinkle, with a margin
  beyond 15 %          its part that is compressed too much for the model, which then eases off
  points/wave          mesh points per wavelength
  texels/wave          map texels per wavelength; fewer than 4 are too few
  time                 expected on one core";

/// Simulates wrinkling skin and turns blend shapes into wrinkle maps.
#[derive(Debug, Parser)]
#[command(name = "ruga", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate every pose and bake its wrinkle maps.
    #[command(after_help = EXIT_CODES)]
    Bake(BakeArguments),
    /// Simulate every pose and write its meshes per load step, no maps.
    #[command(after_help = EXIT_CODES)]
    Simulate(RunArguments),
    /// Say what will be modelled, where, how fine and at what cost; nothing is simulated.
    #[command(after_help = format!("{PLAN_COLUMNS}\n\n{EXIT_CODES}"))]
    Plan(PlanArguments),
    /// Validate scene, mesh, texture coordinates, masks and materials.
    #[command(after_help = EXIT_CODES)]
    Check(CheckArguments),
    /// Write a starter scene that runs.
    #[command(after_help = EXIT_CODES)]
    New(NewArguments),
}

/// Options of `ruga bake` and `ruga simulate`.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The scene, a TOML file.
    #[arg(value_name = "SCENE", help_heading = "Input")]
    pub(crate) scene: PathBuf,
    /// Only this pose; may be given several times [default: every pose of the scene].
    #[arg(long = "pose", value_name = "NAME", help_heading = "Input")]
    pub(crate) poses: Vec<String>,
    /// Folder for the results; made if it does not exist.
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    pub(crate) output: PathBuf,
    /// Print the report as JSON on stdout.
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
    /// Keep poses of an earlier run in DIR whose inputs have not changed.
    #[arg(long, help_heading = "Output")]
    pub(crate) resume: bool,
    /// Mesh points per wavelength: draft 6, standard 12, fine 24 [default: the scene's].
    #[arg(long, value_enum, help_heading = "Simulation")]
    pub(crate) quality: Option<Quality>,
    /// Poses worked on at a time; the results do not depend on it [default: one per core].
    #[arg(long, value_name = "N", help_heading = "Simulation")]
    pub(crate) threads: Option<NonZeroUsize>,
}

/// Options of `ruga bake`.
#[derive(Debug, Args)]
pub(crate) struct BakeArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Write no GLB: maps, wrinkles.json and report.json alone.
    #[arg(long, help_heading = "Output")]
    pub(crate) maps_only: bool,
}

/// Options of `ruga plan`.
#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    /// The scene, a TOML file.
    #[arg(value_name = "SCENE", help_heading = "Input")]
    pub(crate) scene: PathBuf,
    /// Print the plan as JSON.
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
    /// Mesh points per wavelength: draft 6, standard 12, fine 24 [default: the scene's].
    #[arg(long, value_enum, help_heading = "Simulation")]
    pub(crate) quality: Option<Quality>,
}

/// Options of `ruga check`.
#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// The scene, a TOML file.
    #[arg(value_name = "SCENE", help_heading = "Input")]
    pub(crate) scene: PathBuf,
}

/// Options of `ruga new`.
#[derive(Debug, Args)]
pub(crate) struct NewArguments {
    /// Folder for the scene and its mesh; made if it does not exist.
    #[arg(value_name = "DIR", help_heading = "Output")]
    pub(crate) folder: PathBuf,
    /// What to start from.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value_t,
        help_heading = "Output"
    )]
    pub(crate) template: Template,
}

/// How fine the meshes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quality {
    /// 6 points per wavelength: for a first look.
    Draft,
    /// 12 points per wavelength.
    Standard,
    /// 24 points per wavelength: sixteen times the vertices of a draft.
    Fine,
}

impl Quality {
    /// Mesh edges per critical wavelength.
    pub(crate) fn points_per_wavelength(self) -> f64 {
        match self {
            Quality::Draft => 6.0,
            Quality::Standard => 12.0,
            Quality::Fine => 24.0,
        }
    }
}
