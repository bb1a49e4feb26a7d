//! `ruga job`: a bake as a job for a render farm.

use std::fs;
use std::path::{Path, PathBuf, absolute};

use clap::ValueEnum;
use ruga_io::write_atomically;
use ruga_scene::{Scene, SceneOptions, counted};
use serde_json::{Value, json};

use super::job_template::{BakeJob, OUTPUT, format_string_fault};
use crate::arguments::JobArguments;
use crate::error::CliError;
use crate::memory_limit::refuse_too_little;
use crate::outcome::Outcome;
use crate::pose_record::Records;
use crate::{messages, output_folder};

/// Writes the template of a job and the values of its parameters; nothing is simulated.
///
/// # Errors
/// Whatever keeps the scene from being read or planned; [`CliError::OtherJob`], [`CliError::JobText`],
/// [`CliError::TooLittleMemory`], [`CliError::Output`].
pub(crate) fn run(arguments: &JobArguments) -> Result<Outcome, CliError> {
    let options = SceneOptions {
        poses: arguments.poses.clone(),
        points_per_wavelength: arguments.quality.points_per_wavelength(),
    };
    let scene = Scene::read_with(&arguments.scene, &options)?;
    // What is wrong is said here, and not by every task.
    let plan = scene.plan()?;
    // Its tasks go on with what is in the folder.
    let earlier = Records::of_bake(&arguments.output.join(OUTPUT));
    refuse_too_little(arguments.memory.as_ref(), &scene, &plan, Some(&earlier))?;
    let warnings = scene.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, "`ruga plan --json` lists all");
    // The template comes last: where it is, the job is whole.
    let files = [
        ("parameters.json", parameters(arguments)?),
        ("template.json", template(arguments, &scene)?),
    ];
    let files = files.map(|(name, content)| (arguments.output.join(name), content));
    output_folder::prepare(&arguments.output)?;
    if !arguments.force {
        for (path, content) in &files {
            refuse_other(path, content)?;
        }
    }
    for (path, content) in &files {
        let text = format!("{content:#}\n");
        write_atomically(path, text.as_bytes())?;
    }
    let [(parameters, _), (template, _)] = &files;
    messages::result(&format!(
        "{} is ready: {} and a merge. Try it here:\n  openjd run {} --job-param file://{}",
        template.display(),
        counted(scene.poses.len(), "task"),
        template.display(),
        parameters.display()
    ));
    Ok(Outcome::Done)
}

/// Values of the job's parameters.
fn parameters(arguments: &JobArguments) -> Result<Value, CliError> {
    let mut values = json!({
        "Scene": whole(&arguments.scene, arguments)?,
        "Output": whole(&arguments.output.join(OUTPUT), arguments)?,
        "Quality": quality(arguments),
        "Threads": arguments.threads,
    });
    if let Some(memory) = &arguments.memory {
        values["Memory"] = json!(memory.to_string());
    }
    Ok(values)
}

fn template(arguments: &JobArguments, scene: &Scene) -> Result<Value, CliError> {
    let poses: Vec<&str> = scene.poses.iter().map(|pose| pose.name.as_str()).collect();
    for pose in &poses {
        if let Some(reason) = format_string_fault(pose) {
            return Err(CliError::JobText {
                scene: scene.path.clone(),
                what: "pose",
                text: (*pose).to_owned(),
                reason,
            });
        }
    }
    let job = BakeJob {
        mesh: &scene.mesh.mesh.name,
        poses,
        is_selection: !arguments.poses.is_empty(),
        maps_only: arguments.maps_only,
        quality: &quality(arguments),
        threads: arguments.threads.get(),
        memory: arguments.memory.as_ref(),
    };
    Ok(job.template())
}

/// The quality by its name on the command line.
fn quality(arguments: &JobArguments) -> String {
    let value = arguments.quality.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}

/// A path that does not depend on where the command is run, as text.
fn whole(path: &Path, arguments: &JobArguments) -> Result<String, CliError> {
    let whole: PathBuf = absolute(path).unwrap_or_else(|_| path.to_owned());
    whole
        .into_os_string()
        .into_string()
        .map_err(|path| CliError::JobText {
            scene: arguments.scene.clone(),
            what: "path",
            text: path.to_string_lossy().into_owned(),
            reason: "it is not Unicode",
        })
}

/// Refuses to write over a file that says something else.
fn refuse_other(path: &Path, content: &Value) -> Result<(), CliError> {
    let refuse = |difference: String| {
        Err(CliError::OtherJob {
            path: path.to_owned(),
            difference,
        })
    };
    if !path.exists() {
        return Ok(());
    }
    let found = fs::read(path).unwrap_or_default();
    let Ok(found) = serde_json::from_slice::<Value>(&found) else {
        return refuse("it cannot be read as JSON".to_owned());
    };
    if found == *content {
        return Ok(());
    }
    let mut keys = content.as_object().into_iter().flatten();
    refuse(match keys.find(|(key, own)| found[*key] != **own) {
        Some((key, own)) if own.is_string() || own.is_number() => {
            format!("`{key}` is {} in it and would be {own}", found[key])
        }
        Some((key, _)) => format!("`{key}` would not be the same"),
        None => "it has further keys".to_owned(),
    })
}
