//! `bench`: criterion's benchmarks on one thread, and how they compare; then whole faces and a hand.
//!
//! Times depend on the machine and on what else it does; ratios between benchmarks of one group,
//! measured minutes apart, hardly do. So each group is listed from its fastest member, with every
//! other as a multiple of it.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Subcommand;
use serde_json::Value;

use crate::repository::{Outcome, run, target_folder};
use crate::validate::PROGRAM;

/// Package and bench target, in the order they run.
const BENCHES: &[(&str, &str)] = &[
    ("ruga-remesh", "remesh"),
    ("ruga-solver", "kkt"),
    ("ruga-shell", "assembly"),
    ("ruga-stepper", "frame"),
    ("ruga-bake", "bake"),
];

/// Criterion itself and the solver stay on one thread; rayon is told.
const ONE_THREAD: &[(&str, &str)] = &[("RAYON_NUM_THREADS", "1")];

/// The part that can be run by itself.
#[derive(Subcommand)]
pub(crate) enum Part {
    /// Bakes faces, a hand and patches of skin, and compares what that took with goals: hours. What is in
    /// target/faces is not measured again; remove it to measure changed code
    Faces {
        /// Rows of the table: smile, shapes, brows, hand, area, mixtures, mirror, retouching, creases [default: all]
        #[arg(value_name = "ROW")]
        rows: Vec<String>,
        /// draft, standard or fine [default: draft for the mixtures, standard for all others]
        #[arg(long)]
        quality: Option<String>,
    },
}

/// One benchmark's result.
#[derive(Debug)]
struct Measured {
    group: String,
    function: String,
    value: String,
    /// Median time of one iteration, s.
    seconds: f64,
}

impl Measured {
    /// Named in full: groups by their package, and benchmarks that stand alone, whose own name
    /// criterion gives to the group, together under their bench target.
    fn in_group(self, package: &str, bench: &str) -> Self {
        if self.function.is_empty() {
            Self {
                group: format!("{package}, {bench}"),
                function: self.group,
                ..self
            }
        } else {
            Self {
                group: format!("{package}, {}", self.group),
                ..self
            }
        }
    }
}

/// Runs a part, or all of them until one fails.
pub(crate) fn bench(part: Option<Part>) -> Outcome {
    match part {
        Some(Part::Faces { rows, quality }) => faces(&rows, quality.as_deref()),
        None => match criterion()? {
            Some(code) => Ok(code),
            None => faces(&[], None),
        },
    }
}

/// Measures the rows of the table of faces, or all of them.
fn faces(rows: &[String], quality: Option<&str>) -> Outcome {
    if let Some(code) = run(&[], &["build", "--release", "--bin", "ruga"])? {
        return Ok(code);
    }
    let folder = target_folder()?.join("faces");
    let folder = folder.to_string_lossy();
    let mut arguments = [PROGRAM.as_slice(), &["faces", "--", &folder]].concat();
    arguments.extend(rows.iter().map(String::as_str));
    arguments.extend(quality.iter().flat_map(|quality| ["--quality", quality]));
    Ok(run(&[], &arguments)?.unwrap_or(ExitCode::SUCCESS))
}

/// Runs criterion's benchmarks; prints the comparison on standard output. Gives the exit code if one
/// failed.
fn criterion() -> Result<Option<ExitCode>, Box<dyn Error>> {
    let results = target_folder()?.join("criterion");
    let mut measured = Vec::new();
    for (package, bench) in BENCHES {
        let start = SystemTime::now();
        let arguments = ["bench", "--package", package, "--bench", bench];
        if let Some(code) = run(ONE_THREAD, &arguments)? {
            return Ok(Some(code));
        }
        let mut own = Vec::new();
        collect(&results, start, &mut own)?;
        measured.extend(own.into_iter().map(|m| m.in_group(package, bench)));
    }
    print!("{}", comparison(&measured));
    Ok(None)
}

/// Reads every result under `folder` that is not older than `start`.
fn collect(
    folder: &Path,
    start: SystemTime,
    measured: &mut Vec<Measured>,
) -> Result<(), Box<dyn Error>> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(());
    };
    let mut paths = entries
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<Vec<_>, _>>()?;
    paths.sort();
    for path in paths.iter().filter(|path| path.is_dir()) {
        let estimates = path.join("estimates.json");
        if !path.ends_with("new") {
            collect(path, start, measured)?;
        } else if fs::metadata(&estimates)?.modified()? >= start {
            measured.push(read(&path.join("benchmark.json"), &estimates)?);
        }
    }
    Ok(())
}

fn read(benchmark: &Path, estimates: &Path) -> Result<Measured, Box<dyn Error>> {
    let benchmark: Value = serde_json::from_slice(&fs::read(benchmark)?)?;
    let estimates: Value = serde_json::from_slice(&fs::read(estimates)?)?;
    let text = |key: &str| benchmark[key].as_str().unwrap_or_default().to_owned();
    let median = estimates["median"]["point_estimate"].as_f64();
    Ok(Measured {
        group: text("group_id"),
        function: text("function_id"),
        value: text("value_str"),
        seconds: median.ok_or("criterion left no median")? * 1e-9,
    })
}

/// The table: what is alike together, fastest first.
fn comparison(measured: &[Measured]) -> String {
    let mut functions: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for m in measured {
        functions.entry(&m.group).or_default().insert(&m.function);
    }
    let mut alike: BTreeMap<(&str, &str), Vec<&Measured>> = BTreeMap::new();
    for m in measured {
        // Several functions are compared at the same value; a lone one with itself at others.
        let several = functions[m.group.as_str()].len() > 1;
        let value = if several { m.value.as_str() } else { "" };
        alike.entry((&m.group, value)).or_default().push(m);
    }
    let mut table = String::new();
    for ((group, value), members) in &mut alike {
        members.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let title = format!("{group} {value}");
        table.push_str(&format!("\n{}\n", title.trim_end()));
        for m in members.iter() {
            let name = if value.is_empty() {
                format!("{} {}", m.function, m.value)
            } else {
                m.function.clone()
            };
            let ratio = m.seconds / members[0].seconds;
            table.push_str(&format!(
                "  {:<40} {:>12}  {ratio:>9.2} x\n",
                name.trim(),
                in_units(m.seconds)
            ));
        }
    }
    table
}

fn in_units(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")];
    let fitting = units.iter().find(|(unit, _)| seconds >= *unit);
    let (unit, name) = fitting.unwrap_or(&units[3]);
    format!("{:.2} {name}", seconds / unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(group: &str, function: &str, value: &str, seconds: f64) -> Measured {
        Measured {
            group: group.into(),
            function: function.into(),
            value: value.into(),
            seconds,
        }
    }

    #[test]
    fn functions_are_compared_at_equal_values() {
        let table = comparison(&[
            measured("solve", "slow", "100", 6e-3),
            measured("solve", "fast", "100", 2e-3),
            measured("solve", "slow", "200", 9e-3),
            measured("solve", "fast", "200", 9e-3),
        ]);
        let lines: Vec<Vec<&str>> = table
            .lines()
            .map(|l| l.split_whitespace().collect())
            .collect();
        assert_eq!(lines[1], ["solve", "100"]);
        assert_eq!(lines[2], ["fast", "2.00", "ms", "1.00", "x"]);
        assert_eq!(lines[3], ["slow", "6.00", "ms", "3.00", "x"]);
        assert_eq!(lines[5], ["solve", "200"]);
    }

    #[test]
    fn benchmarks_without_group_are_compared_within_their_target() {
        let alone = |name, seconds| measured(name, "", "", seconds).in_group("ruga-solver", "kkt");
        let table = comparison(&[alone("LLT", 1e-3), alone("KKT, nested", 2e-3)]);
        let lines: Vec<&str> = table.lines().map(str::trim).collect();
        assert_eq!(lines[1], "ruga-solver, kkt");
        assert!(lines[2].starts_with("LLT") && lines[2].ends_with("1.00 x"));
        assert!(lines[3].starts_with("KKT, nested") && lines[3].ends_with("2.00 x"));
    }

    #[test]
    fn a_lone_function_is_compared_with_itself() {
        let table = comparison(&[
            measured("bake", "map", "2048", 4.0),
            measured("bake", "map", "1024", 1.0),
        ]);
        let last: Vec<&str> = table.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(last, ["map", "2048", "4.00", "s", "4.00", "x"]);
    }
}
