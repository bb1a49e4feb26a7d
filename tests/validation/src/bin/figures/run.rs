//! The command `ruga simulate`, started as a user would, and what it leaves behind.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use ruga_scene::SceneFile;

/// How a run ended.
pub(super) enum Run {
    /// With results; poses that did not converge are marked in them.
    Done,
    /// Not begun, for this reason.
    Refused(String),
}

/// Exit codes of `ruga`: results written, though some pose may not have converged; could not run.
const INCOMPLETE: i32 = 1;
const REFUSED: i32 = 2;

/// Load steps of a quick run: each solves the upper layers anew, which is most of the work. Where
/// skin begins to wrinkle the solver adds steps of its own, so that the wavelength is no worse.
const QUICK_STEPS: u32 = 2;

/// Simulates every pose of a scene on one thread, so that times can be compared. What a quick run
/// takes instead of the scene lies beside its results.
pub(super) fn simulate(scene: &Path, results: &Path, quick: bool) -> Result<Run, Box<dyn Error>> {
    let quick_scene = results.with_extension("toml");
    let scene = if quick {
        write_quick_scene(scene, &quick_scene)?;
        &quick_scene
    } else {
        scene
    };
    // Built beside this program by whoever started it.
    let name = format!("ruga{}", std::env::consts::EXE_SUFFIX);
    let mut command = Command::new(std::env::current_exe()?.with_file_name(name));
    command.env("RAYON_NUM_THREADS", "1");
    command
        .arg("simulate")
        .arg(scene)
        .arg("--output")
        .arg(results);
    // A quick run goes where the results of the whole scene are, and the other way round.
    command.args(["--threads", "1", "--force"]);
    if quick {
        command.args(["--quality", "draft"]);
    }
    let output = command.output()?;
    let messages = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0 | INCOMPLETE) => Ok(Run::Done),
        Some(REFUSED) => Ok(Run::Refused(first_error(&messages))),
        _ => Err(format!("{}: {}\n{messages}", scene.display(), output.status).into()),
    }
}

/// The scene with fewer load steps.
fn write_quick_scene(path: &Path, quick: &Path) -> Result<(), Box<dyn Error>> {
    let mut scene = SceneFile::read(path)?;
    for pose in &mut scene.poses {
        pose.steps = pose.steps.min(QUICK_STEPS);
    }
    if let Some(folder) = quick.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(quick, scene.to_toml())?)
}

/// The line that says what is wrong, without the lines that say what to do.
fn first_error(messages: &str) -> String {
    let error = messages
        .lines()
        .find_map(|line| line.strip_prefix("error: "));
    error.unwrap_or(messages).trim_end().to_owned()
}

/// The file of a layer in the last load step of a pose.
pub(super) fn last_frame(
    results: &Path,
    pose: &str,
    layer: &str,
) -> Result<Option<PathBuf>, Box<dyn Error>> {
    let folder = results.join("frames").join(pose);
    if !folder.is_dir() {
        return Ok(None);
    }
    // `<layer>.<number>.obj`, the number of fixed width up to 9999.
    let number = |name: &str| -> Option<u32> {
        let rest = name.strip_prefix(layer)?.strip_prefix('.')?;
        rest.strip_suffix(".obj")?.parse().ok()
    };
    let mut last = None;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        last = last.max(name.and_then(number).map(|number| (number, path)));
    }
    Ok(last.map(|(_, path)| path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frame_has_the_highest_number() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("frames/frown");
        fs::create_dir_all(&frames).unwrap();
        for name in [
            "skin.9999.obj",
            "skin.10000.obj",
            "skin.two.obj",
            "skin2.20000.obj",
        ] {
            fs::write(frames.join(name), "").unwrap();
        }
        let last = |pose, layer| last_frame(folder.path(), pose, layer).unwrap();
        assert_eq!(last("frown", "skin"), Some(frames.join("skin.10000.obj")));
        assert_eq!(last("frown", "fat"), None);
        assert_eq!(last("smile", "skin"), None);
    }

    #[test]
    fn a_quick_scene_differs_in_its_steps() {
        let folder = tempfile::tempdir().unwrap();
        let quick = folder.path().join("runs/two.toml");
        let path = ruga_validation::asset("heterogeneous/two-layers.toml");
        write_quick_scene(&path, &quick).unwrap();
        let [mut full, quick] = [path, quick].map(|path| SceneFile::read(&path).unwrap());
        assert_eq!(quick.poses[0].steps, QUICK_STEPS);
        assert!(full.poses[0].steps > QUICK_STEPS);
        full.poses[0].steps = QUICK_STEPS;
        assert_eq!(quick, full);
    }

    #[test]
    fn a_refusal_is_one_line() {
        let messages = "warning: this\nerror: that\nhelp: do so\n";
        assert_eq!(first_error(messages), "that");
        assert_eq!(first_error("killed\n"), "killed");
    }
}
