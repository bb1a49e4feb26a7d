//! Scenes through the whole program: what it may answer, and what it may leave behind.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use ruga_scene::SceneFile;

use super::results::{check_results, contents};
use super::{Chance, FuzzScene, Tried, damage_bytes, damage_text, put};

/// Time for one command; the scenes take about a second on an idle machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// What no plan can know, because it shows on the mesh that is simulated.
const FOUND_LATE: &str = "the sharp boundaries in its map cross";

/// Scenes beyond these are planned, not simulated: they are no errors, but they take their time.
const LARGEST_MAP: u32 = 128;
const MOST_STEPS: u32 = 8;

pub(super) fn scene(folder: &Path, fuzzer: &Path, chance: &mut Chance) -> Tried {
    write_scene(folder, chance);
    let ruga = Ruga { folder, fuzzer };
    let checked = ruga.run("check scene.toml")?;
    let planned = ruga.run("plan scene.toml --json")?;
    if checked != planned {
        return Err(format!(
            "`check` ends with {checked}, `plan` with {planned}"
        ));
    }
    let read = SceneFile::read(&folder.join("scene.toml"));
    let Some(read) = read.ok().filter(|scene| planned == 0 && is_small(scene)) else {
        return Ok(planned == 0);
    };
    let command = chance.pick(&["bake", "bake", "bake", "simulate"]);
    let code = ruga.run(&format!("{command} scene.toml -o out --threads 1"))?;
    if code == 2 && ruga.said().contains(FOUND_LATE) {
        return Ok(false);
    }
    if code == 2 {
        return Err(format!(
            "`plan` takes what `{command}` refuses: {}",
            ruga.said()
        ));
    }
    check_results(&folder.join("out"), &read.bake)?;
    let first = contents(&folder.join("out"));
    let again = Again {
        ruga: &ruga,
        command,
        code,
        files: &first,
    };
    match chance.below(5) {
        0 => again.compare("out2 --threads 2", "another run")?,
        1 => {
            let records = if command == "bake" {
                "out/poses"
            } else {
                "out/poses/frames"
            };
            damage_a_record(&folder.join(records), chance);
            again.compare("out --resume", "`--resume`")?;
        }
        2 => {
            ruga.kill(
                &format!("{command} scene.toml -o out2"),
                chance.between(0.0, 1.5),
            );
            again.compare("out2 --resume", "`--resume` after a kill")?;
        }
        3 => {
            let other = if command == "bake" {
                "simulate"
            } else {
                "bake"
            };
            ruga.run(&format!("{other} scene.toml -o out"))?;
            check_results(&folder.join("out"), &read.bake)?;
            again.compare("out", "a run after the other command")?;
        }
        _ => {}
    }
    Ok(true)
}

/// Writes a scene; half of them are odd or damaged.
fn write_scene(folder: &Path, chance: &mut Chance) {
    let mut scene = FuzzScene::new(chance);
    if chance.one_in(3) {
        scene.sheet_mut().make_odd(chance);
    }
    scene.write(folder);
    let other = FuzzScene::new(chance).toml().into_bytes();
    if chance.one_in(4) {
        let mut text = scene.toml().into_bytes();
        damage_text(&mut text, &other, chance);
        put(folder, "scene.toml", text);
    }
    if chance.one_in(6) {
        let files = scene.files();
        let (name, mut bytes) = files[chance.below(files.len())].clone();
        match name.ends_with(".obj") {
            true => damage_text(&mut bytes, &other, chance),
            false => damage_bytes(&mut bytes, &other, chance),
        }
        put(folder, &name, bytes);
    }
}

/// Whether a scene is worth simulating here; without poses it has the twenty steps of the default.
fn is_small(scene: &SceneFile) -> bool {
    let poses = &scene.poses;
    scene.bake.size <= LARGEST_MAP
        && !poses.is_empty()
        && poses.iter().all(|pose| pose.steps <= MOST_STEPS)
}

/// Cuts or changes one of the records that `--resume` reads: it must notice, not trust it.
fn damage_a_record(folder: &Path, chance: &mut Chance) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "json"));
    paths.sort();
    if paths.is_empty() || chance.one_in(2) {
        return;
    }
    let path = &paths[chance.below(paths.len())];
    let mut bytes = fs::read(path).expect("a record that was just written");
    let cut = chance.below(bytes.len());
    bytes.truncate(cut);
    fs::write(path, bytes).expect("a record that was just written");
}

/// What a command gave at first, and must give again.
struct Again<'a> {
    ruga: &'a Ruga<'a>,
    command: &'a str,
    code: i32,
    files: &'a BTreeMap<String, Vec<u8>>,
}

impl Again<'_> {
    /// Runs the command again: every file of the first run must be there, the same.
    fn compare(&self, output: &str, what: &str) -> Result<(), String> {
        let line = format!("{} scene.toml -o {output}", self.command);
        let code = self.ruga.run(&line)?;
        if code != self.code {
            return Err(format!(
                "the first run ends with {}, {what} with {code}",
                self.code
            ));
        }
        let folder = output.split(' ').next().unwrap_or_default();
        let files = contents(&self.ruga.folder.join(folder));
        let differing = self
            .files
            .iter()
            .find(|(name, bytes)| files.get(*name) != Some(*bytes));
        match differing {
            Some((name, _)) => Err(format!("{what} has another {name}")),
            None => Ok(()),
        }
    }
}

/// The command `ruga`, in the folder of a scene.
struct Ruga<'a> {
    folder: &'a Path,
    fuzzer: &'a Path,
}

impl Ruga<'_> {
    /// Starts a command line, whose output goes to two files.
    fn start(&self, line: &str) -> Child {
        let log =
            |name: &str| File::create(self.folder.join(name)).expect("the folder takes files");
        Command::new(self.fuzzer)
            .arg("ruga")
            .args(line.split(' '))
            .current_dir(self.folder)
            .stdin(Stdio::null())
            .stdout(log("stdout.txt"))
            .stderr(log("stderr.txt"))
            .spawn()
            .expect("the fuzzer can start itself")
    }

    /// Runs a command line for some seconds and ends it as a power cut would.
    fn kill(&self, line: &str, seconds: f64) {
        let mut child = self.start(line);
        thread::sleep(Duration::from_secs_f64(seconds));
        // It may have ended by itself; either way it is waited for.
        let _ = child.kill();
        let _ = child.wait();
    }

    /// Runs a command line and gives its exit code: 0, 1 or 2, with a message if 2.
    fn run(&self, line: &str) -> Result<i32, String> {
        let mut child = self.start(line);
        let started = Instant::now();
        let status = loop {
            match child.try_wait().expect("a child can be waited for") {
                Some(status) => break status,
                None if started.elapsed() > PATIENCE => {
                    // It may have ended by itself meanwhile; either way it is waited for.
                    let _ = child.kill();
                    let _ = child.wait();
                    return Err(format!(
                        "`{line}` has not ended after {} s",
                        PATIENCE.as_secs()
                    ));
                }
                None => thread::sleep(Duration::from_millis(5)),
            }
        };
        let said = self.said();
        let text = fs::read_to_string(self.folder.join("stdout.txt")).unwrap_or_default();
        match status.code() {
            _ if said.contains("panicked") => Err(format!("`{line}`: {said}")),
            Some(code @ 0..=2) => {
                let words = ["NaN", "inf", "-inf"];
                // A layer or pose may be called so.
                let scene = fs::read_to_string(self.folder.join("scene.toml")).unwrap_or_default();
                let printed = words.iter().find(|word| {
                    text.split_whitespace().any(|w| w == **word)
                        && !scene.contains(&format!("\"{word}\""))
                });
                if let Some(word) = printed {
                    return Err(format!("`{line}` prints {word}"));
                }
                let named = [".toml", ".obj", ".glb", ".png", ".exr", ": cannot read:"];
                if code == 2 && !named.iter().any(|name| said.contains(name)) {
                    return Err(format!("`{line}` ends with 2 and names no file: {said}"));
                }
                Ok(code)
            }
            _ => Err(format!("`{line}` ended with {status}: {said}")),
        }
    }

    /// What the last command said on stderr, from its error on, shortened.
    fn said(&self) -> String {
        let text = fs::read_to_string(self.folder.join("stderr.txt")).unwrap_or_default();
        let start = text.find("panicked").or_else(|| text.find("error: "));
        text[start.unwrap_or(0)..].chars().take(1000).collect()
    }
}
