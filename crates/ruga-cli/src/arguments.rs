//! What can be typed after `ruga`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use ruga_scene::SceneOptions;
use ruga_stepper::Modelling;

use crate::frame_files::FrameFormat;
use crate::memory_size::MemorySize;
use crate::templates::Template;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  ran, but a pose did not converge or the run was interrupted; results are written and marked
  2  could not run; the message says what to mend

Results go to stdout, progress and messages to stderr.";

const HELP_TOPICS: &str = "\
Reference:
  ruga help scene      every key of a scene, its default and its unit
  ruga help presets    every preset with its numbers";

const MAPS: &str = "\
Maps:
  Names are <pose>_<key%>_<kind>; a key of 0.125 is called 12p5, as a dot would begin an extension.
  Heights are 16 bit also beside 8-bit normals: 256 steps of height would show as terraces.";

const FOLDER: &str = "\
The output folder:
  Poses of earlier runs of the same scene stay in wrinkles.json and report.json unless the scene has
  changed since; changing other poses or the quality does not count. What is not listed any more is
  named, and its files stay. While one run works in a folder a second one is refused.";

const FRAMES: &str = "\
Frames:
  frames/<pose>/<layer>.<number>.obj or .vtu, and <layer>.pvd or <layer>.usda for all of a layer. VTU and USD
  hold displacement, height, normals, strain over the critical one, wavelength, thickness, stiffness and
  energies per area; docs/results.md lists them with their units. The .pvd is up to date after every load
  step, the .usda is written when its pose ends. Of sheets and soft bodies glb writes frames/<pose>/<mesh>.glb:
  the mesh of the scene as it moves, animated.";

const AGE: &str = "\
The file:
  DIR/creases.json has the creases of the scene that keep a fold, and lines that wrinkles have left. Name it in
  the scene, or in a copy of it, and bake that:
    [memory]
    network = \"DIR/creases.json\"
  `[memory]` also says what skin gives back, and which poses are held; see `ruga help scene`. Both sides of
  a mesh with `symmetry` are looked at; a scene with a network has no such key. DIR/folds has how every
  pose folds the skin. A run with `--pose` adds to what earlier runs have left in DIR.";

const FARM: &str = "\
Several machines:
  Runs with `--task` may bake different poses into one folder at a time; `--merge` then writes what all
  poses share. A task that baked its poses ends with 0 even where one did not converge: the merge says
  so. `ruga job` writes both as a job that render farms read.";

const JOB: &str = "\
The job:
  DIR/template.json is a template of the Open Job Description, version 2023-09: a step `Bake` with a task
  per pose, and a step `Merge`. DIR/parameters.json has the values of its parameters Scene, Output (DIR/out),
  Quality and Threads; change them there, or when the job is submitted. Try it here:
    openjd run DIR/template.json --job-param file://DIR/parameters.json

  Every machine needs the command `ruga` of one release, and sees the scene, the files that it names and
  Output by the same paths, or by paths that the farm maps. The folder is then what `ruga bake` fills.";

const PREVIEW: &str = "\
The page:
  DIR/preview.html holds the mesh of the GLB and the normal maps that wrinkles.json lists, and needs no
  other file and no network. `ruga bake` writes it, too; write it anew after changing files in DIR.";

const PLAN_COLUMNS: &str = "\
Columns of the layers:
  wavelength           from crest to crest, on flat skin that is compressed evenly
  critical strain      compression from which on the layer wrinkles
  model                formula that both come from: see `ruga help scene`

Columns of the pairs, each layer on the one below it:
  membrane ratio       stiffness of the upper layer over that of the lower one; from 0.3 on the
                       upper one changes when the lower one wrinkles, from 1 on it decides
  force ratio          force at which the upper layer wrinkles over that of the lower one
  joint wavelength,    what both would do as one skin; where this differs much from the layers'
  critical strain      own numbers, `stack` says which of the two is simulated
  first scale          fine: the upper layer's wrinkles come first; large: those of both together
  bending transfer     part of the lower layer's bending that compresses the upper layer

Columns of the poses:
  strain median, 99 %  how much the pose compresses the simulated skin: half, and all but the
                       worst hundredth, of its area is compressed less than this; of all skin
                       that may wrinkle, where none does
  simulated            area that is compressed enough to wrinkle, with a margin
  beyond 15 %          its part that is compressed too much for the model, which then eases off
  points/wave          mesh points per wavelength
  texels/wave          map texels per wavelength; fewer than 4 are too few
  time                 expected on one core";

/// Where the output of `ruga completions` goes.
const COMPLETIONS: &str = "Where shells look for it:
  bash        ruga completions bash > ~/.local/share/bash-completion/completions/ruga
  zsh         ruga completions zsh > _ruga, in a folder of $fpath
  fish        ruga completions fish > ~/.config/fish/completions/ruga.fish
  powershell  ruga completions powershell >> $PROFILE";

/// Simulates wrinkling skin and turns blend shapes into wrinkle maps.
#[derive(Debug, Parser)]
#[command(
    name = "ruga",
    version,
    after_help = format!("{HELP_TOPICS}\n\n{EXIT_CODES}"),
    arg_required_else_help = true,
    disable_help_subcommand = true
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate every pose and bake its wrinkle maps.
    #[command(after_help = format!("{MAPS}\n\n{FOLDER}\n\n{FARM}\n\n{EXIT_CODES}"))]
    Bake(BakeArguments),
    /// Simulate every pose and write its meshes per load step, no maps.
    #[command(after_help = format!("{FRAMES}\n\n{FOLDER}\n\n{EXIT_CODES}"))]
    Simulate(SimulateArguments),
    /// Find the creases that poses leave in the skin, for a face that has aged.
    #[command(after_help = format!("{AGE}\n\n{FOLDER}\n\n{EXIT_CODES}"))]
    Age(RunArguments),
    /// Write a bake as a job for a render farm, with one task per pose.
    #[command(after_help = format!("{JOB}\n\n{EXIT_CODES}"))]
    Job(JobArguments),
    /// Say what will be modelled, where, how fine and at what cost; nothing is simulated.
    #[command(after_help = format!("{PLAN_COLUMNS}\n\n{EXIT_CODES}"))]
    Plan(PlanArguments),
    /// Write the preview page of a folder that was baked, anew.
    #[command(after_help = format!("{PREVIEW}\n\n{EXIT_CODES}"))]
    Preview(PreviewArguments),
    /// Validate scene, mesh, texture coordinates, masks and materials.
    #[command(after_help = EXIT_CODES)]
    Check(CheckArguments),
    /// Write a starter scene that runs, or one for your own mesh.
    #[command(after_help = EXIT_CODES)]
    New(NewArguments),
    /// Explain a command, the keys of a scene, or the presets.
    Help(HelpArguments),
    /// Print what lets a shell complete the words of `ruga`.
    #[command(after_help = COMPLETIONS)]
    Completions(CompletionsArguments),
    /// Write the manual pages of `ruga` and its commands.
    Man(ManArguments),
}

/// Options of `ruga completions`.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArguments {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

/// Options of `ruga man`.
#[derive(Debug, Args)]
pub(crate) struct ManArguments {
    /// Folder for the pages; made if it does not exist.
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

/// Options of `ruga bake`, `ruga simulate` and `ruga age`.
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
    /// Say nothing of how far the poses are; warnings, errors and results are told.
    #[arg(short, long, help_heading = "Output")]
    pub(crate) quiet: bool,
    /// Keep poses of an earlier run in DIR whose inputs have not changed and that are no coarser
    /// than asked for.
    #[arg(long, help_heading = "Output")]
    pub(crate) resume: bool,
    /// Use DIR although it has results of another scene, which are then no longer listed, or a
    /// file of yours where `bake` writes its GLB, which is replaced.
    #[arg(long, help_heading = "Output")]
    pub(crate) force: bool,
    /// Mesh points per wavelength: draft 6, standard 12, fine 24, or the scene's.
    #[arg(long, value_enum, default_value_t, help_heading = "Simulation")]
    pub(crate) quality: Quality,
    /// Threads to work with: as many poses at a time, those first that are planned to take longest; fewer poses
    /// share the threads. The results do not depend on it [default: one per core].
    #[arg(long, value_name = "N", help_heading = "Simulation")]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Memory that poses worked on at a time may need together, such as 4GB or 800MB: where they would need
    /// more, fewer are worked on at a time. What each needs is that of `ruga plan`; the results do not depend
    /// on it [default: no limit].
    #[arg(long, value_name = "SIZE", help_heading = "Simulation")]
    pub(crate) memory: Option<MemorySize>,
}

impl RunArguments {
    /// What is asked of the scene beside what stands in its file.
    pub(crate) fn scene_options(&self) -> SceneOptions {
        SceneOptions {
            poses: self.poses.clone(),
            points_per_wavelength: self.quality.points_per_wavelength(),
        }
    }
}

/// Options of `ruga simulate`.
#[derive(Debug, Args)]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Format of the load steps; several with commas between them.
    #[arg(
        long = "format",
        value_enum,
        value_name = "FORMAT",
        value_delimiter = ',',
        default_value = "obj",
        help_heading = "Output"
    )]
    pub(crate) formats: Vec<FrameFormat>,
}

/// Options of `ruga bake`.
#[derive(Debug, Args)]
pub(crate) struct BakeArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Write no GLB and no preview: maps, wrinkles.json and report.json alone.
    #[arg(long, help_heading = "Output")]
    pub(crate) maps_only: bool,
    /// Work in DIR beside other runs with `--task`, which bake other poses: write maps and records,
    /// and leave all that poses share to `--merge`.
    #[arg(long, conflicts_with_all = ["json", "merge", "force"], help_heading = "Output")]
    pub(crate) task: bool,
    /// Simulate nothing: write GLB, preview, wrinkles.json and report.json of poses that are in DIR.
    #[arg(long, conflicts_with_all = ["resume", "force"], help_heading = "Output")]
    pub(crate) merge: bool,
}

/// Options of `ruga job`.
#[derive(Debug, Args)]
pub(crate) struct JobArguments {
    /// The scene, a TOML file.
    #[arg(value_name = "SCENE", help_heading = "Input")]
    pub(crate) scene: PathBuf,
    /// Only this pose; may be given several times [default: every pose of the scene].
    #[arg(long = "pose", value_name = "NAME", help_heading = "Input")]
    pub(crate) poses: Vec<String>,
    /// Folder for the job; made if it does not exist. Results go to `out` in it.
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    pub(crate) output: PathBuf,
    /// Write over another job in DIR; results stay.
    #[arg(long, help_heading = "Output")]
    pub(crate) force: bool,
    /// Write no GLB and no preview: maps, wrinkles.json and report.json alone.
    #[arg(long, help_heading = "Output")]
    pub(crate) maps_only: bool,
    /// Mesh points per wavelength: draft 6, standard 12, fine 24, or the scene's.
    #[arg(long, value_enum, default_value_t, help_heading = "Simulation")]
    pub(crate) quality: Quality,
    /// Threads of a task: its maps are baked on all of them, and a large pose is simulated on them.
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        help_heading = "Simulation"
    )]
    pub(crate) threads: NonZeroUsize,
    /// Memory that a task may need, such as 4GB or 800MB; a pose that needs more is refused
    /// [default: no limit].
    #[arg(long, value_name = "SIZE", help_heading = "Simulation")]
    pub(crate) memory: Option<MemorySize>,
}

/// Options of `ruga plan`.
#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    /// The scene, a TOML file.
    #[arg(value_name = "SCENE", help_heading = "Input")]
    pub(crate) scene: PathBuf,
    /// Only this pose; may be given several times [default: every pose of the scene].
    #[arg(long = "pose", value_name = "NAME", help_heading = "Input")]
    pub(crate) poses: Vec<String>,
    /// Print the plan as JSON.
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
    /// Write a picture of what will wrinkle where, and how, on the mesh's texture layout.
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    pub(crate) image: Option<PathBuf>,
    /// Write a page that shows the same on the mesh, with a slider per pose; it opens from disk in a browser.
    /// Not for meshes with UDIM tiles.
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub(crate) preview: Option<PathBuf>,
    /// Mesh points per wavelength: draft 6, standard 12, fine 24, or the scene's.
    #[arg(long, value_enum, default_value_t, help_heading = "Simulation")]
    pub(crate) quality: Quality,
}

/// Options of `ruga preview`.
#[derive(Debug, Args)]
pub(crate) struct PreviewArguments {
    /// Folder that `ruga bake` has written.
    #[arg(value_name = "DIR", help_heading = "Input")]
    pub(crate) folder: PathBuf,
    /// Replace a preview.html that is a file of yours.
    #[arg(long, help_heading = "Output")]
    pub(crate) force: bool,
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
    /// Folder for the scene; made if it does not exist.
    #[arg(value_name = "DIR", help_heading = "Output")]
    pub(crate) folder: PathBuf,
    /// What to start from, with a mesh of its own.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value_t,
        help_heading = "Input"
    )]
    pub(crate) template: Template,
    /// Your own mesh with blend shapes, .glb or .gltf; it stays where it is.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "template",
        help_heading = "Input"
    )]
    pub(crate) mesh: Option<PathBuf>,
}

/// Options of `ruga help`.
#[derive(Debug, Args)]
pub(crate) struct HelpArguments {
    /// What to explain [default: the commands].
    #[arg(value_enum, value_name = "TOPIC")]
    pub(crate) topic: Option<Topic>,
}

/// What `ruga help` explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Topic {
    /// Every key of a scene, its default and its unit.
    Scene,
    /// Every preset with its numbers.
    Presets,
    /// The options of `ruga bake`.
    Bake,
    /// The options of `ruga simulate`.
    Simulate,
    /// The options of `ruga age`.
    Age,
    /// The options of `ruga job`.
    Job,
    /// The options of `ruga plan`.
    Plan,
    /// The options of `ruga preview`.
    Preview,
    /// The options of `ruga check`.
    Check,
    /// The options of `ruga new`.
    New,
    /// The options of `ruga completions`.
    Completions,
    /// The options of `ruga man`.
    Man,
}

/// How fine the meshes are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Quality {
    /// What the scene says: `points_per_wavelength` under `[remesh]`.
    #[default]
    Scene,
    /// 6 points per wavelength: for a first look.
    Draft,
    /// 12 points per wavelength.
    Standard,
    /// 24 points per wavelength: about eight times the vertices of a draft.
    Fine,
}

impl Quality {
    /// Mesh edges per critical wavelength; `None` leaves them to the scene.
    pub(crate) fn points_per_wavelength(self) -> Option<f64> {
        let modelling = match self {
            Quality::Scene => return None,
            Quality::Draft => Modelling::draft(),
            Quality::Standard => Modelling::standard(),
            Quality::Fine => Modelling::fine(),
        };
        Some(modelling.points_per_wavelength)
    }
}

/// A number of vertices per wavelength in words, with the name of the quality that has it.
pub(crate) fn quality_words(points: f64) -> String {
    let named = [Quality::Draft, Quality::Standard, Quality::Fine]
        .into_iter()
        .find(|quality| quality.points_per_wavelength() == Some(points));
    let name = named.and_then(|quality| quality.to_possible_value());
    match name {
        Some(name) => format!("{} quality", name.get_name()),
        None => format!("{points} vertices per wavelength"),
    }
}
