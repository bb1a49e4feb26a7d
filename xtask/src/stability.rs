//! `stability`: what each method does where methods fail, as a table.
//!
//! The tests of the suite write marked lines; here they are put in order.

use std::fmt::Write;
use std::process::{ExitCode, Stdio};

use crate::repository::{Outcome, cargo};

/// What a line of the table starts with.
const MARK: &str = "stability|";

/// The suite, one test after another so that lines stay whole.
const SUITE: [&str; 8] = [
    "test",
    "--quiet",
    "--package",
    "ruga-tests",
    "--test",
    "stability",
    "--",
    "--test-threads=1",
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
pub(crate) fn stability() -> Outcome {
    let mut command = cargo(&SUITE);
    command.args(["--nocapture"]).stderr(Stdio::inherit());
    let output = command.output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    print!("{}", table(&text));
    if output.status.success() {
        return Ok(ExitCode::SUCCESS);
    }
    eprint!("{text}");
    Ok(ExitCode::FAILURE)
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
