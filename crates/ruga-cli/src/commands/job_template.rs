//! A bake as a job template of the Open Job Description, version 2023-09, and its parameters.
//!
//! The specification is at <https://github.com/OpenJobDescription/openjd-specifications>. Texts of a
//! template are *format strings*: `{{Param.Scene}}` in them stands for a value.

use serde_json::{Value, json};

use crate::memory_size::MemorySize;

/// Folder of the results in that of the job.
pub(super) const OUTPUT: &str = "out";

/// Values that a parameter of a task may have, by the specification.
const TASKS_PER_STEP: usize = 1024;

/// Characters of a job's name, by the specification.
const NAME_LENGTH: usize = 128;

/// A bake that a farm is to do.
#[derive(Debug)]
pub(super) struct BakeJob<'a> {
    /// Name of the artist's mesh.
    pub(super) mesh: &'a str,
    /// Names of the poses, at least one.
    pub(super) poses: Vec<&'a str>,
    /// Whether these are not all of the scene's.
    pub(super) is_selection: bool,
    /// Whether no GLB is wanted.
    pub(super) maps_only: bool,
    /// Default of the job parameter `Quality`.
    pub(super) quality: &'a str,
    /// Default of the job parameter `Threads`.
    pub(super) threads: usize,
    /// Default of the job parameter `Memory`, which is there only with one.
    pub(super) memory: Option<&'a MemorySize>,
}

/// Why a text cannot stand in a template; `None` when it can.
pub(super) fn format_string_fault(text: &str) -> Option<&'static str> {
    let has_braces = text.contains("{{") || text.contains("}}");
    has_braces.then_some("`{{` and `}}` enclose a parameter's name there")
}

impl BakeJob<'_> {
    /// The template.
    pub(super) fn template(&self) -> Value {
        let mut steps = self.bake_steps();
        let names = steps.iter().map(|step| json!({"dependsOn": step["name"]}));
        let dependencies: Vec<Value> = names.collect();
        steps.push(json!({
            "name": "Merge",
            "description": "Writes what all poses share: GLB, preview, wrinkles.json and report.json.",
            "dependencies": dependencies,
            "script": self.script(self.merge_arguments()),
        }));
        json!({
            "specificationVersion": "jobtemplate-2023-09",
            "name": self.name(),
            "description": "Simulates and bakes wrinkle maps with ruga, one task per pose.",
            "parameterDefinitions": self.parameters(),
            "steps": steps,
        })
    }

    /// Steps whose tasks bake a pose each: one, unless there are more poses than a step may have tasks.
    fn bake_steps(&self) -> Vec<Value> {
        let arguments = ["--pose={{Task.Param.Pose}}", "--task", "--resume"];
        let arguments = arguments.map(str::to_owned).to_vec();
        let step = |(number, poses): (usize, &[&str])| {
            let name = match number {
                0 => "Bake".to_owned(),
                _ => format!("Bake {}", number + 1),
            };
            json!({
                "name": name,
                "description": "Simulates a pose and bakes its maps.",
                "parameterSpace": {"taskParameterDefinitions": [
                    {"name": "Pose", "type": "STRING", "range": poses},
                ]},
                "script": self.script(arguments.clone()),
            })
        };
        let steps = self.poses.chunks(TASKS_PER_STEP).enumerate();
        steps.map(step).collect()
    }

    fn merge_arguments(&self) -> Vec<String> {
        let mut arguments = vec!["--merge".to_owned()];
        if self.is_selection {
            arguments.extend(self.poses.iter().map(|pose| format!("--pose={pose}")));
        }
        arguments
    }

    /// Runs `ruga bake` with `arguments` and those that all tasks have.
    fn script(&self, arguments: Vec<String>) -> Value {
        let mut all = vec![
            "bake".to_owned(),
            "{{Param.Scene}}".to_owned(),
            "--output={{Param.Output}}".to_owned(),
            "--quality={{Param.Quality}}".to_owned(),
            "--threads={{Param.Threads}}".to_owned(),
        ];
        if self.memory.is_some() {
            all.push("--memory={{Param.Memory}}".to_owned());
        }
        all.extend(arguments);
        if self.maps_only {
            all.push("--maps-only".to_owned());
        }
        json!({"actions": {"onRun": {
            "command": "ruga",
            "args": all,
            // A task that is asked to stop keeps the keys that are finished.
            "cancelation": {"mode": "NOTIFY_THEN_TERMINATE"},
        }}})
    }

    fn parameters(&self) -> Value {
        let mut parameters = vec![
            json!({
                "name": "Scene",
                "type": "PATH",
                "objectType": "FILE",
                "dataFlow": "IN",
                "description": "The scene, a TOML file; the files that it names lie where it says.",
            }),
            json!({
                "name": "Output",
                "type": "PATH",
                "objectType": "DIRECTORY",
                "dataFlow": "INOUT",
                "default": OUTPUT,
                "description": "Folder for the results, the same one for all tasks. Poses in it that are \
                                finished are not made again.",
            }),
            json!({
                "name": "Quality",
                "type": "STRING",
                "allowedValues": ["scene", "draft", "standard", "fine"],
                "default": self.quality,
                "description": "Mesh points per wavelength: draft 6, standard 12, fine 24, or the scene's.",
            }),
            json!({
                "name": "Threads",
                "type": "INT",
                "minValue": 1,
                "default": self.threads,
                "description": "Threads of a task: its maps are baked on all of them, and a large pose is \
                                simulated on them. The results do not depend on it.",
            }),
        ];
        if let Some(memory) = self.memory {
            parameters.push(json!({
                "name": "Memory",
                "type": "STRING",
                "default": memory.to_string(),
                "description": "Memory that a task may need, such as 4GB or 800MB; a pose that needs more is \
                                refused.",
            }));
        }
        Value::Array(parameters)
    }

    /// Name of the job, without what a name must not have.
    fn name(&self) -> String {
        let name = format!("Wrinkle maps of {}", self.mesh);
        let is_allowed = |c: &char| !c.is_control() && !matches!(c, '{' | '}');
        name.chars().filter(is_allowed).take(NAME_LENGTH).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job<'a>(mesh: &'a str, poses: Vec<&'a str>) -> BakeJob<'a> {
        BakeJob {
            mesh,
            poses,
            is_selection: false,
            maps_only: false,
            quality: "scene",
            threads: 1,
            memory: None,
        }
    }

    #[test]
    fn more_poses_than_a_step_may_have_tasks_make_several_steps() {
        let names: Vec<String> = (0..2049).map(|i| format!("pose{i}")).collect();
        let template = job("Face", names.iter().map(String::as_str).collect()).template();
        let steps = template["steps"].as_array().expect("a list");
        let tasks = |step: &Value| {
            let parameters = &step["parameterSpace"]["taskParameterDefinitions"];
            parameters[0]["range"].as_array().map_or(0, Vec::len)
        };
        let counts: Vec<usize> = steps.iter().map(tasks).collect();
        assert_eq!(counts, [1024, 1024, 1, 0]);
        let after =
            json!([{"dependsOn": "Bake"}, {"dependsOn": "Bake 2"}, {"dependsOn": "Bake 3"}]);
        assert_eq!(steps[3]["dependencies"], after);
    }

    #[test]
    fn names_of_jobs_are_short_plain_text() {
        let name = job("{{Odd}}\tmesh", vec!["a"]).name();
        assert_eq!(name, "Wrinkle maps of Oddmesh");
        assert_eq!(job(&"x".repeat(500), vec!["a"]).name().len(), 128);
    }
}
