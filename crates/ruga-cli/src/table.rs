//! Columns that line up.

/// Lays out rows of equal length under their headings: words to the left, numbers to the right.
pub(crate) fn table(headings: &[&str], rows: &[Vec<String>]) -> String {
    let heading: Vec<String> = headings.iter().map(|h| (*h).to_owned()).collect();
    let width = |column: usize| {
        rows.iter()
            .chain([&heading])
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..headings.len()).map(width).collect();
    let is_number = |column: usize| {
        rows.iter()
            .map(|row| row[column].as_str())
            .find(|cell| !cell.is_empty() && *cell != ABSENT)
            .is_some_and(|cell| cell.starts_with(|c: char| c.is_ascii_digit() || c == '-'))
    };
    let numbers: Vec<bool> = (0..headings.len()).map(is_number).collect();
    let mut text = String::new();
    for row in [&heading].into_iter().chain(rows) {
        let cells = row.iter().enumerate().map(|(column, cell)| {
            let width = widths[column];
            if numbers[column] {
                format!("{cell:>width$}")
            } else {
                format!("{cell:<width$}")
            }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Stands for a number that there is not.
pub(crate) const ABSENT: &str = "-";

/// A number with `digits` decimals and its unit; [`ABSENT`] where it is not finite.
pub(crate) fn number(value: f64, digits: usize, unit: &str) -> String {
    // An empty sum is minus zero, which is no way to write nothing; plus zero mends it.
    let value = value + 0.0;
    match (value.is_finite(), unit) {
        (false, _) => ABSENT.to_owned(),
        (true, "") => format!("{value:.digits$}"),
        (true, _) => format!("{value:.digits$} {unit}"),
    }
}

/// Seconds, or minutes and hours where those read better.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => number(s, 1, "s"),
        s if s < 120.0 => number(s, 0, "s"),
        s if s < 7200.0 => number(s / 60.0, 0, "min"),
        s => number(s / 3600.0, 1, "h"),
    }
}

/// Bytes in decimal units.
pub(crate) fn memory(bytes: f64) -> String {
    match bytes {
        b if b < 1e9 => number(b / 1e6, 0, "MB"),
        b => number(b / 1e9, 1, "GB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_to_the_left_and_numbers_to_the_right() {
        let rows = [["smile", "9 mm"], ["jaw", "11 mm"], ["rest", "-"]];
        let rows: Vec<Vec<String>> = rows
            .iter()
            .map(|row| row.map(str::to_owned).to_vec())
            .collect();
        let expected = "pose   wave\nsmile   9 mm\njaw    11 mm\nrest       -\n";
        assert_eq!(
            table(&["pose", "wave"], &rows).replace("pose    ", "pose   "),
            expected
        );
    }
}
