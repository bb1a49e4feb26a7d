//! `ruga job`, and its tasks run as a farm runs them: each command line as the template has it, in
//! processes of their own.

mod fixture;

use std::fs;
use std::process::{Child, Command, Output, Stdio};

use fixture::{Folder, Run, assert_alike, wait_for};
use serde_json::{Value, json};

/// Three poses of one key; the fixture's own is `squeezed`.
fn three_poses() -> Folder {
    let pose = |name: &str, weight: f64| {
        format!(
            "[[poses]]\nname = \"{name}\"\nweights = {{ squeeze = {weight} }}\nkeys = [1.0]\n\n"
        )
    };
    let more = format!("{}{}[remesh]", pose("some", 0.7), pose("-m 'ore", 0.9));
    Folder::with("[remesh]", &more)
}

/// A job's files, and what a farm does with them.
struct Job<'a> {
    folder: &'a Folder,
    template: Value,
    parameters: Value,
}

impl<'a> Job<'a> {
    /// Writes the job with these options, and reads it.
    fn new(folder: &'a Folder, options: &str) -> Self {
        folder
            .ruga(&format!("job scene.toml -o job{options}"))
            .exits(0);
        Self {
            folder,
            template: folder.json("job/template.json"),
            parameters: folder.json("job/parameters.json"),
        }
    }

    fn step(&self, name: &str) -> &Value {
        let mut steps = self.template["steps"].as_array().expect("a list").iter();
        steps.find(|step| step["name"] == name).expect("the step")
    }

    /// Poses of the tasks of the step `Bake`.
    fn poses(&self) -> Vec<String> {
        let parameters = &self.step("Bake")["parameterSpace"]["taskParameterDefinitions"];
        let range = parameters[0]["range"].as_array().expect("a list").iter();
        range
            .map(|name| name.as_str().expect("a name").to_owned())
            .collect()
    }

    /// The command line of a task, its parameters replaced by their values.
    fn command(&self, step: &str, pose: &str) -> Command {
        let action = &self.step(step)["script"]["actions"]["onRun"];
        assert_eq!(action["command"], "ruga");
        let mut command = Command::new(env!("CARGO_BIN_EXE_ruga"));
        for argument in action["args"].as_array().expect("a list") {
            let mut text = argument.as_str().expect("a text").to_owned();
            for (name, value) in self.parameters.as_object().expect("a table") {
                let value = value
                    .as_str()
                    .map_or_else(|| value.to_string(), str::to_owned);
                text = text.replace(&format!("{{{{Param.{name}}}}}"), &value);
            }
            command.arg(text.replace("{{Task.Param.Pose}}", pose));
        }
        // A worker runs tasks in a folder of its own.
        command.current_dir(std::env::temp_dir());
        command
    }

    fn run(&self, step: &str, pose: &str) -> Run {
        Run::from(self.command(step, pose).output().expect("it starts"))
    }

    /// All tasks at a time; every one ends well.
    fn bake(&self) {
        let start = |pose: &String| {
            let mut command = self.command("Bake", pose);
            command.stdout(Stdio::piped()).stderr(Stdio::piped());
            command.spawn().expect("it starts")
        };
        let tasks: Vec<Child> = self.poses().iter().map(start).collect();
        for task in tasks {
            let output: Output = task.wait_with_output().expect("it ends");
            Run::from(output).exits(0);
        }
    }

    fn merge(&self) -> Run {
        self.run("Merge", "")
    }

    /// Bakes the whole scene as the job does, without its tasks, into `name`.
    fn bake_without_tasks(&self, name: &str, options: &str) {
        let scene = self.parameters["Scene"].as_str().expect("a path");
        let line = format!("bake {scene} -o {name}{options}");
        self.folder.ruga(&line).exits(0);
    }
}

#[test]
fn tasks_at_a_time_and_a_merge_make_what_a_bake_makes() {
    let folder = three_poses();
    let job = Job::new(&folder, "");
    assert_eq!(job.poses(), ["squeezed", "some", "-m 'ore"]);
    job.bake();
    assert!(!folder.path("job/out/wrinkles.json").exists());
    let merge = job.merge().exits(0);
    assert!(merge.stdout.contains("squeezed"), "{}", merge.stdout);
    assert!(!merge.stderr.contains("started"), "{}", merge.stderr);
    job.bake_without_tasks("job/whole", "");
    assert_alike(&folder, "job/out", "job/whole");

    // Run again, the job makes nothing again and leaves the folder as it is.
    let before = folder.read("job/out/report.json");
    job.run("Bake", "some")
        .exits(0)
        .says(&["`some` is there from an earlier run"]);
    job.merge().exits(0);
    assert_eq!(folder.read("job/out/report.json"), before);
    assert_alike(&folder, "job/out", "job/whole");
}

#[test]
fn options_of_the_bake_are_in_the_job() {
    let folder = three_poses();
    let job = Job::new(
        &folder,
        " --pose some --quality draft --threads 2 --memory 4GB --maps-only",
    );
    assert_eq!(job.poses(), ["some"]);
    assert_eq!(job.parameters["Quality"], "draft");
    assert_eq!(job.parameters["Threads"], 2);
    assert_eq!(job.parameters["Memory"], "4GB");
    for step in ["Bake", "Merge"] {
        let arguments = &job.step(step)["script"]["actions"]["onRun"]["args"];
        let arguments = arguments.as_array().expect("a list");
        assert!(arguments.contains(&json!("--memory={{Param.Memory}}")));
    }
    let definitions = job.template["parameterDefinitions"].as_array();
    let memory = definitions.and_then(|list| list.last()).expect("a list");
    assert_eq!([&memory["name"], &memory["type"]], ["Memory", "STRING"]);
    job.bake();
    job.merge().exits(0);
    job.bake_without_tasks("job/whole", " --pose some --quality draft --maps-only");
    assert!(!folder.path("job/out/Patch.glb").exists());
    assert_alike(&folder, "job/out", "job/whole");
}

/// What the specification `jobtemplate-2023-09` asks of a template; `tests/cross_checks/farm.py` has it
/// checked by `openjd check`.
#[test]
fn a_template_defines_its_parameters_and_steps() {
    let folder = three_poses();
    let job = Job::new(&folder, "");
    let template = &job.template;
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    assert_eq!(template["name"], "Wrinkle maps of Patch");
    let parameters = template["parameterDefinitions"].as_array().expect("a list");
    let facts = |p: &Value| json!([p["name"], p["type"], p["default"]]);
    let facts: Vec<Value> = parameters.iter().map(facts).collect();
    assert_eq!(
        json!(facts),
        json!([
            ["Scene", "PATH", null],
            ["Output", "PATH", "out"],
            ["Quality", "STRING", "scene"],
            ["Threads", "INT", 1]
        ])
    );
    for parameter in parameters {
        let value = &job.parameters[parameter["name"].as_str().expect("a name")];
        assert!(!value.is_null(), "{parameter}");
        assert!(parameter["description"].is_string(), "{parameter}");
    }
    for path in ["Scene", "Output"] {
        let path = job.parameters[path].as_str().expect("a path");
        assert!(std::path::Path::new(path).is_absolute(), "{path}");
    }
    assert_eq!(
        job.step("Merge")["dependencies"],
        json!([{"dependsOn": "Bake"}])
    );
    let cancelation = &job.step("Bake")["script"]["actions"]["onRun"]["cancelation"];
    assert_eq!(cancelation["mode"], "NOTIFY_THEN_TERMINATE");
}

#[test]
fn a_job_that_exists_is_kept() {
    let folder = three_poses();
    let line = "job scene.toml -o job";
    folder.ruga(line).exits(0);
    let files = || ["template", "parameters"].map(|name| folder.read(&format!("job/{name}.json")));
    let before = files();
    folder.ruga(line).exits(0);
    folder
        .ruga(&format!("{line} --quality draft"))
        .exits(2)
        .says(&[
            "parameters.json: is there already and is another job",
            "`Quality` is \"scene\" in it and would be \"draft\"",
            "--force",
        ]);
    folder.ruga(&format!("{line} --pose some")).exits(2).says(&[
        "template.json: is there already",
        "`steps` would not be the same",
    ]);
    assert_eq!(files(), before);
    folder
        .ruga(&format!("{line} --quality draft --force"))
        .exits(0);
    assert_eq!(folder.json("job/parameters.json")["Quality"], "draft");

    folder.write("job/template.json", "mine");
    folder
        .ruga(&format!("{line} --quality draft"))
        .exits(2)
        .says(&["cannot be read as JSON"]);
    assert_eq!(folder.read("job/template.json"), b"mine");
    let left: Vec<String> = folder.files("job");
    assert_eq!(left, ["parameters.json", "template.json"]);
}

#[test]
fn a_job_that_cannot_be_is_not_written() {
    let folder = Folder::with("name = \"squeezed\"", "name = \"{{squeezed\"");
    folder.ruga("job scene.toml -o job").exits(2).says(&[
        "scene.toml: pose `{{squeezed` cannot stand in a job",
        "a parameter's name",
    ]);
    folder
        .ruga("job scene.toml -o job --pose none")
        .exits(2)
        .says(&["none"]);
    assert!(!folder.path("job").exists());
    folder.write("file", "");
    folder.change("scene.toml", "{{", "");
    folder
        .ruga("job scene.toml -o file")
        .exits(2)
        .says(&["it is a file"]);
}

#[test]
fn a_merge_names_what_is_missing_and_changes_nothing() {
    let folder = three_poses();
    let job = Job::new(&folder, "");
    job.run("Bake", "squeezed").exits(0);
    job.run("Bake", "some").exits(0);
    let files = folder.files("job/out");
    let fails = |texts: &[&str]| {
        job.merge()
            .exits(2)
            .says(texts)
            .says(&["--resume", "nothing was changed"]);
        assert!(!folder.path("job/out/wrinkles.json").exists());
    };
    fails(&[
        "out: 1 pose to be merged is not there",
        "`-m 'ore` has no record",
    ]);
    assert_eq!(folder.files("job/out").len(), files.len() - 2);

    job.run("Bake", "-m 'ore").exits(0);
    fs::remove_file(folder.path("job/out/maps/some_100_height.png")).unwrap();
    fails(&["1 pose", "`some` lacks some of its files"]);
    folder.write("job/out/poses/some.json", "{\"half\": ");
    fails(&["1 pose", "`some` has no record that can be read"]);
    job.run("Bake", "some").exits(0);

    let mut record = folder.json("job/out/poses/some.json");
    record["report"]["interrupted"] = json!(true);
    folder.write("job/out/poses/some.json", record.to_string());
    fails(&["`some` was interrupted when only its keys [1.0] were finished"]);
    job.run("Bake", "some")
        .exits(0)
        .says(&["was interrupted: it is made again"]);

    folder.change("scene.toml", "squeeze = 0.7", "squeeze = 0.6");
    fails(&[
        "1 pose",
        "`some` was made from an older version of the scene",
    ]);
    // What the message says mends it.
    job.bake();
    job.merge().exits(0);
    job.bake_without_tasks("job/whole", "");
    assert_alike(&folder, "job/out", "job/whole");

    let scene = job.parameters["Scene"].as_str().unwrap();
    let finer = format!("bake {scene} -o job/out --merge --quality draft");
    folder.ruga(&finer).exits(2).says(&[
        "3 poses",
        "has 4 vertices per wavelength, coarser than draft quality",
    ]);
    assert_alike(&folder, "job/out", "job/whole");
}

#[test]
fn another_scenes_folder_is_refused_by_tasks_and_merge() {
    let folder = three_poses();
    let text = String::from_utf8(folder.read("scene.toml")).unwrap();
    folder.write("other.toml", text.replace("0.05", "0.07"));
    folder
        .ruga("bake other.toml -o job/out --pose some")
        .exits(0);
    let before = folder.files("job/out");
    let job = Job::new(&folder, "");
    for run in [job.run("Bake", "squeezed"), job.merge()] {
        run.exits(2)
            .says(&["holds 1 pose of another scene", "other.toml"]);
    }
    assert_eq!(folder.files("job/out").len(), before.len());
    assert!(folder.path("job/out/poses/some.json").exists());
}

#[test]
fn runs_keep_out_of_the_poses_of_tasks_and_tasks_of_runs() {
    let folder = three_poses();
    let job = Job::new(&folder, "");
    let slow = |line: &str| {
        folder.change("scene.toml", "wavelength = 0.03", "wavelength = 0.005");
        let (child, mut stderr) = folder.start(line);
        wait_for(&mut stderr, "started");
        folder.change("scene.toml", "wavelength = 0.005", "wavelength = 0.03");
        (child, stderr)
    };
    let (mut task, _stderr) = slow("bake scene.toml -o job/out --pose squeezed --task");
    job.run("Bake", "squeezed").exits(2).says(&[
        "another run is working on pose `squeezed`",
        "`ruga bake --task scene.toml --pose squeezed`",
    ]);
    job.run("Bake", "some").exits(0);
    for line in [
        "bake scene.toml -o job/out",
        "simulate scene.toml -o job/out",
    ] {
        let working = "another run is working in this folder";
        folder.ruga(line).exits(2).says(&[working, "--task"]);
    }
    job.merge()
        .exits(2)
        .says(&["another run is working in this folder", "--pose squeezed"]);
    assert!(
        task.try_wait().expect("a child").is_none(),
        "the task has ended too early"
    );
    task.kill().unwrap();
    task.wait().unwrap();

    // A task that was killed keeps nobody out, nor does a run.
    let (mut run, _stderr) = slow("bake scene.toml -o job/out --pose squeezed");
    job.run("Bake", "squeezed")
        .exits(2)
        .says(&["in this folder", "`ruga bake scene.toml`"]);
    run.kill().unwrap();
    run.wait().unwrap();
    job.bake();
    job.merge().exits(0);
    assert!(!folder.path("job/out/poses/.tasks").exists());
    job.bake_without_tasks("job/whole", "");
    assert_alike(&folder, "job/out", "job/whole");
}

/// A task that fails would keep a farm from the merge, which says what is to be said.
#[test]
fn a_pose_that_did_not_converge_fails_the_merge_and_not_its_task() {
    let folder = three_poses();
    let job = Job::new(&folder, "");
    job.bake();
    let mut record = folder.json("job/out/poses/some.json");
    record["report"]["converged"] = json!(false);
    folder.write("job/out/poses/some.json", record.to_string());
    job.run("Bake", "some")
        .exits(0)
        .says(&["1 pose did not converge: `some`"]);
    job.merge()
        .exits(1)
        .says(&["1 pose did not converge: `some`"]);
    let report = folder.json("job/out/report.json");
    assert_eq!(report["poses"].as_array().expect("a list").len(), 3);
}
