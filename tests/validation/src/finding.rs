//! Lines of the stability suite's table.

/// What a line of the table starts with.
const MARK: &str = "stability|";

/// How a method comes out of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// It does what it ought to.
    Holds,
    /// It does not, within limits that are stated and tested.
    Bounded,
    /// It does not, and says so, or refuses.
    Warns,
    /// It does not, and says nothing.
    Fails,
    /// It has no part that the test could be about.
    NotApplicable,
}

impl Finding {
    fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Bounded => "bounded",
            Self::Warns => "warns",
            Self::Fails => "fails",
            Self::NotApplicable => "n/a",
        }
    }
}

/// Writes one line of the table: number and name of the test, method, finding, numbers.
///
/// The line starts with a mark, by which `cargo xtask validate stability` knows it.
#[expect(
    clippy::print_stdout,
    reason = "the table of the stability suite is made of these lines"
)]
pub fn table_line(test: &str, method: &str, finding: Finding, numbers: &str) {
    let word = finding.word();
    println!("{MARK}{test}|{method}|{word}|{numbers}");
}
