//! The table: rows, goals, measured ratios and the numbers behind them.

use crate::baking::Pose;

/// What a ratio has to be.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Goal {
    AtMost(f64),
    AtLeast(f64),
}

/// Columns: of a line's words, of its judgement, of its numbers.
const HEAD: [&str; 11] = [
    "row",
    "what",
    "goal",
    "measured",
    "met",
    "vertices",
    "seconds",
    "of processor",
    "planned",
    "peak MB",
    "iterations",
];

/// What the words of the table mean.
const FOOT: &str = "
F: processor seconds of one numeric factorisation of the smile's whole KKT matrix; median of nine.
Seconds: wall clock of simulating, without reading, planning and writing of maps; of processor: without
what other programs took. Ratios on one thread are of the processor's; those on two want a quiet machine.
Peak: largest resident memory of a process, all of its poses and maps together.
";

/// A line of the table, without the name of its row; empty where there is nothing to say.
#[derive(Clone, Debug, Default)]
pub(crate) struct Line {
    what: String,
    judgement: [String; 3],
    numbers: [String; 6],
}

impl Line {
    /// A measured ratio beside its goal, both in `unit`; NaN where there is no result, which misses it.
    pub(crate) fn judged(
        what: impl Into<String>,
        (goal, unit): (Goal, &str),
        measured: f64,
    ) -> Self {
        let (words, is_met) = match goal {
            Goal::AtMost(limit) => (format!("at most {limit}"), measured <= limit),
            Goal::AtLeast(limit) => (format!("at least {limit}"), measured >= limit),
        };
        let met = if is_met { "yes" } else { "NO" };
        let judgement = [
            format!("{words} {unit}"),
            format!("{measured:.2}"),
            met.to_owned(),
        ];
        Self {
            judgement,
            ..Self::note(what)
        }
    }

    /// A line without goal.
    pub(crate) fn note(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            ..Self::default()
        }
    }

    /// The line with sums over what these poses took.
    pub(crate) fn with(mut self, poses: &[Pose]) -> Self {
        let seconds = |of: fn(&Pose) -> f64| format!("{:.1}", poses.iter().map(of).sum::<f64>());
        let layers = || poses.iter().flat_map(Pose::layers);
        let vertices: u64 = layers().filter_map(|layer| layer.vertices).sum();
        let iterations = layers().filter_map(|layer| layer.newton_iterations);
        self.numbers = [
            vertices.to_string(),
            seconds(Pose::seconds),
            seconds(Pose::cpu_seconds),
            seconds(|pose| pose.planned.seconds),
            format!("{:.0}", peak(poses) / 1e6),
            iterations.sum::<u64>().to_string(),
        ];
        self
    }

    /// A line for every pose without a good result.
    pub(crate) fn failures(poses: &[Pose]) -> Vec<Self> {
        let failure = |pose: &Pose| {
            let line = Self::note(format!("{}: {}", pose.planned.name, pose.failure()?));
            Some(line.with(std::slice::from_ref(pose)))
        };
        poses.iter().filter_map(failure).collect()
    }
}

/// Largest resident memory of the processes that baked these poses, bytes; not a number where the system
/// does not tell.
pub(crate) fn peak(poses: &[Pose]) -> f64 {
    let peaks = poses.iter().map(|pose| pose.process.peak as f64);
    peaks.filter(|bytes| *bytes > 0.0).fold(f64::NAN, f64::max)
}

/// The table for people; every line with the name of its row.
pub(crate) fn text(lines: &[(&str, Line)]) -> String {
    let mut rows = vec![HEAD.map(str::to_owned).to_vec()];
    for (row, line) in lines {
        let words = [(*row).to_owned(), line.what.clone()];
        rows.push([&words[..], &line.judgement, &line.numbers].concat());
    }
    // A note may be long, and where nothing stands beside it nothing has to make room.
    let is_short = |row: &&Vec<String>| row[2..].iter().any(|cell| !cell.is_empty());
    let width = |column: usize| {
        let cells = rows.iter().filter(is_short);
        cells.map(|row| row[column].chars().count()).max()
    };
    let widths: Vec<usize> = (0..HEAD.len()).filter_map(width).collect();
    let mut text = String::new();
    for row in &rows {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match column {
            0..=2 | 4 => format!("{cell:width$}"),
            _ => format!("{cell:>width$}"),
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text + FOOT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_below_each_other_and_goals_are_judged() {
        let lines = [
            Line::judged("both sides", (Goal::AtMost(40.0), "F"), 75.5),
            Line::judged("two threads", (Goal::AtLeast(1.8), "times as fast"), 1.9),
            Line::judged("without a result", (Goal::AtMost(3.0), "%"), f64::NAN),
            Line::note("left: did not converge, and why that may be"),
        ];
        let text = text(&lines.map(|line| ("row", line)));
        let rows: Vec<&str> = text.lines().collect();
        let columns = [
            "goal",
            "at most 40 F",
            "at least 1.8 times as fast",
            "at most 3 %",
        ];
        let starts = [0, 1, 2, 3].map(|row| rows[row].find(columns[row]));
        assert_eq!(starts, [starts[0]; 4]);
        for (row, end) in [(1, "75.50  NO"), (2, "1.90  yes"), (3, "NaN  NO")] {
            assert!(rows[row].ends_with(end), "{}", rows[row]);
        }
        assert!(rows[4].ends_with("why that may be"));
    }
}
