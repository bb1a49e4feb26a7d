//! `validate`: what takes long and judges the product from outside, in `tests/validation`.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{ExitCode, Stdio};

use clap::ValueEnum;

use crate::repository::{Outcome, cargo, root, run, target_folder};

/// What can be run by itself.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Study {
    /// The long tests: films, patterns, references, the papers' methods
    Tests,
    /// What each method does where methods fail, as a table
    Stability,
    /// Labyrinths, herringbone and pulled sheet at length; many minutes
    Patterns,
    /// What skins on soft bodies must show, measured and drawn: half an hour of processor time, two
    /// minutes if quick
    Bodies,
    /// Sharp creases, ours and the paper's, measured and drawn, with pictures of folded sheets; two or three
    /// minutes
    Creases,
    /// Curl of a burning sheet by natural curvature and by the paper's springs, measured and drawn, with pictures of
    /// the paper's scenes; five minutes, two if quick
    Burning,
    /// Error against cost, measured and drawn; many minutes
    Chart,
    /// The papers' figures and their table of times, from the scenes under assets/
    Figures,
}

/// A program of `tests/validation`, without its arguments.
pub(crate) const PROGRAM: [&str; 4] = ["run", "--quiet", "--release", "--bin"];

/// Runs a study, or all of them until one fails.
pub(crate) fn validate(
    study: Option<Study>,
    folder: Option<PathBuf>,
    flags: [(&str, bool); 2],
) -> Outcome {
    let flags: Vec<&str> = flags
        .iter()
        .filter(|flag| flag.1)
        .map(|flag| flag.0)
        .collect();
    let mut failed = None;
    for own in Study::value_variants() {
        if failed.is_none() && study.is_none_or(|study| study == *own) {
            failed = own.run(folder.as_deref(), &flags)?;
        }
    }
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}

impl Study {
    /// Gives the exit code if it failed.
    fn run(
        self,
        folder: Option<&Path>,
        flags: &[&str],
    ) -> Result<Option<ExitCode>, Box<dyn Error>> {
        let name = match self {
            Self::Tests => return tests(),
            Self::Stability => return stability(),
            Self::Patterns => return run(&[], &[PROGRAM.as_slice(), &["patterns"]].concat()),
            Self::Bodies => "bodies",
            Self::Creases => "creases",
            Self::Burning => "burning",
            Self::Chart => "chart",
            Self::Figures => "figures",
        };
        if self == Self::Figures
            && let Some(code) = run(&[], &["build", "--release", "--bin", "ruga"])?
        {
            return Ok(Some(code));
        }
        let folder = match folder {
            Some(folder) => std::path::absolute(folder)?,
            None => target_folder()?.join(name),
        };
        let folder = folder.to_string_lossy();
        // On one thread each, so that times can be compared.
        let environment = [("RAYON_NUM_THREADS", "1")];
        let arguments = [PROGRAM.as_slice(), &[name, "--", &folder], flags].concat();
        run(&environment, &arguments)
    }
}

/// Runs the tests of `tests/validation` but for the stability suite, each by its name: with `--package`
/// shared crates would be built anew with fewer features.
fn tests() -> Result<Option<ExitCode>, Box<dyn Error>> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(root().join("tests/validation/tests"))? {
        let path = entry?.path();
        let is_test = path.extension().is_some() || path.join("main.rs").exists();
        names.extend(
            path.file_stem()
                .filter(|_| is_test)
                .map(|n| n.to_string_lossy().into_owned()),
        );
    }
    names.sort();
    let mut arguments = vec!["test", "--release", "--workspace", "--lib", "--bins"];
    let long = names.iter().filter(|name| *name != "stability");
    arguments.extend(long.flat_map(|name| ["--test", name.as_str()]));
    run(&[], &arguments)
}

/// Draws the README's picture from a finished bake.
pub(crate) fn picture(bake: &Path) -> Outcome {
    let bake = std::path::absolute(bake)?;
    let arguments = ["picture", "--", &bake.to_string_lossy()];
    let failed = run(&[], &[PROGRAM.as_slice(), &arguments].concat())?;
    Ok(failed.unwrap_or(ExitCode::SUCCESS))
}

/// What a line of the stability suite's table starts with.
const MARK: &str = "stability|";

/// The suite, one test after another so that lines stay whole.
const SUITE: [&str; 8] = [
    "test",
    "--quiet",
    "--release",
    "--test",
    "stability",
    "--",
    "--test-threads=1",
    "--nocapture",
];

/// One finding.
#[derive(Debug, PartialEq, Eq)]
struct Line<'a> {
    /// The number after the T.
    number: u32,
    /// Test, method, finding, numbers.
    cells: [&'a str; 4],
}

impl<'a> Line<'a> {
    /// Reads a line that the suite wrote, possibly after something of the test harness.
    fn read(text: &'a str) -> Option<Self> {
        let (_, marked) = text.split_once(MARK)?;
        let mut parts = marked.splitn(4, '|');
        let mut next = || parts.next().map(str::trim);
        let cells = [next()?, next()?, next()?, next()?];
        let name = cells[0].strip_prefix('T')?;
        let end = name.find(|c: char| !c.is_ascii_digit());
        let number = name[..end.unwrap_or(name.len())].parse().ok()?;
        Some(Self { number, cells })
    }
}

/// Runs the suite; prints its table on standard output, and all else, if a test fails, on standard
/// error.
fn stability() -> Result<Option<ExitCode>, Box<dyn Error>> {
    let output = cargo(&SUITE).stderr(Stdio::inherit()).output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    print!("{}", table(&text));
    if output.status.success() {
        return Ok(None);
    }
    eprint!("{text}");
    Ok(Some(ExitCode::FAILURE))
}

/// The findings in what the suite wrote, by number, in columns.
fn table(output: &str) -> String {
    let mut lines: Vec<Line<'_>> = output.lines().filter_map(Line::read).collect();
    // The papers' methods come first; otherwise the suite's order stays.
    let family = |line: &Line<'_>| line.cells[1].starts_with("ruga");
    lines.sort_by_key(|line| (line.number, line.cells[0], family(line)));
    let head = ["test", "method", "finding", "numbers"];
    let rows: Vec<[&str; 4]> = std::iter::once(head)
        .chain(lines.iter().map(|line| line.cells))
        .collect();
    let widths = [0, 1, 2].map(|column| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    });
    let mut table = String::new();
    for [test, method, finding, numbers] in &rows {
        let [a, b, c] = widths;
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{test:a$}  {method:b$}  {finding:c$}  {numbers}");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_and_sorted_by_number() {
        let output = "\
running 2 tests
.stability|T10 snap|ruga|holds|a | b
stability|T2 noise|ruga|holds|all
stability|T2 noise|papers|fails|none
test result: ok
stability|nonsense
";
        let table = table(output);
        let rows: Vec<&str> = table.lines().collect();
        assert_eq!(rows.len(), 4);
        assert_eq!(rows[0], "test      method  finding  numbers");
        assert_eq!(rows[1], "T2 noise  papers  fails    none");
        assert_eq!(rows[2], "T2 noise  ruga    holds    all");
        assert_eq!(rows[3], "T10 snap  ruga    holds    a | b");
    }
}
