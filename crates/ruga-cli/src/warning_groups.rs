//! Many warnings of the same kind as one, with a count and the worst three.
//!
//! A face has dozens of poses, and most have the same to say about each. Warnings are of one kind when
//! they are about the same layer and differ in nothing but their pose, their numbers, and the place on
//! the model that the planner names.

use std::cmp::Ordering;
use std::ops::Range;

/// Words that begin a place on the model; its square of the texture ends with [`PLACE_SQUARE`].
const PLACE: &str = "at u ";

/// The end of a place's square of the texture.
const PLACE_SQUARE: &str = " from the map's upper left";

/// Words that may follow it, before the number of the UDIM tile that the square lies in.
const PLACE_TILE: &str = " in tile ";

/// Words that may follow it: the blend shape nearest to the place, up to [`PLACE_SHAPE_END`].
const PLACE_SHAPE: &str = " (near where blend shape '";

/// The end of the blend shape's name.
const PLACE_SHAPE_END: &str = "' moves the skin)";

/// Words that follow a place that does not stand for all.
const PLACE_MORE: &str = ", and elsewhere";

/// Names that stand in a group's message.
const NAMED: usize = 3;

/// Numbers before these words are worse the smaller they are.
const LESS_IS_WORSE: [&str; 3] = [
    "points per wavelength",
    "texels per wavelength",
    "vertices per wavelength",
];

/// Whether a warning is about the pose named `pose`.
pub(crate) fn is_about(warning: &str, pose: &str) -> bool {
    Warning::of(warning).pose == Some(pose)
}

/// One line for every kind of warning, in the order of their first; what says the same twice is said
/// once. Where a line stands for more than it names, `whole` says where all of them are.
pub(crate) fn grouped<'a>(warnings: impl IntoIterator<Item = &'a str>, whole: &str) -> Vec<String> {
    let mut kinds: Vec<(String, Vec<Warning<'a>>)> = Vec::new();
    for text in warnings {
        let warning = Warning::of(text);
        let kind = warning.kind();
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, same)) if same.contains(&warning) => {}
            Some((_, same)) => same.push(warning),
            None => kinds.push((kind, vec![warning])),
        }
    }
    kinds
        .into_iter()
        .map(|(_, same)| message(same, whole))
        .collect()
}

/// Message of a group of one kind.
fn message(mut same: Vec<Warning<'_>>, whole: &str) -> String {
    if let [only] = same.as_slice() {
        return only.whole.to_owned();
    }
    let differing = differing_number(&same);
    same.sort_by(|a, b| match (a.number(differing), b.number(differing)) {
        (Some(a), Some(b)) => b.badness().total_cmp(&a.badness()),
        _ => Ordering::Equal,
    });
    let shown = same.iter().take(NAMED).enumerate().map(|(rank, warning)| {
        let pose = warning.pose.unwrap_or_default();
        match warning.number(differing) {
            // The message itself has the numbers of the worst.
            Some(_) if rank == 0 => format!("these are the numbers of the worst, '{pose}'"),
            Some(amount) => format!("'{pose}' has {}", amount.text),
            None => format!("'{pose}'"),
        }
    });
    let shown: Vec<String> = shown.collect();
    let shown = match (differing, shown.split_first()) {
        (Some(_), Some((worst, others))) => format!("{worst}; {}", others.join(", ")),
        _ => shown.join(", "),
    };
    let more = match same.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more ({whole})"),
    };
    let repeated = |(i, a): (usize, &Warning<'_>)| same[..i].iter().any(|b| b.pose == a.pose);
    let what = match same.iter().enumerate().any(repeated) {
        true => "times",
        false => "poses",
    };
    let layer = same[0]
        .layer
        .map_or_else(String::new, |layer| format!(", layer '{layer}'"));
    format!(
        "{} {what}{layer}: {} [{}{more}]",
        same.len(),
        same[0].text,
        shown,
    )
}

/// The first of their numbers in which warnings of one kind differ.
fn differing_number(same: &[Warning<'_>]) -> Option<usize> {
    let count = same[0].numbers().len();
    (0..count).find(|&i| {
        let value = |warning: &Warning<'_>| warning.number(Some(i)).map(|n| n.value);
        same.iter().any(|warning| value(warning) != value(&same[0]))
    })
}

/// A warning taken apart: `pose 'smile', layer 'skin': text`, the first two where it has them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Warning<'a> {
    whole: &'a str,
    pose: Option<&'a str>,
    layer: Option<&'a str>,
    text: &'a str,
}

/// A number in a warning.
#[derive(Clone, Debug, PartialEq)]
struct Number<'a> {
    value: f64,
    /// With its unit, where it has one.
    text: &'a str,
    less_is_worse: bool,
}

impl Number<'_> {
    fn badness(&self) -> f64 {
        match self.less_is_worse {
            true => -self.value,
            false => self.value,
        }
    }
}

impl<'a> Warning<'a> {
    fn of(whole: &'a str) -> Self {
        let plain = Self {
            whole,
            pose: None,
            layer: None,
            text: whole,
        };
        let Some(rest) = whole.strip_prefix("pose '") else {
            return plain;
        };
        let Some((names, text)) = rest.split_once("': ") else {
            return plain;
        };
        let (pose, layer) = match names.split_once("', layer '") {
            Some((pose, layer)) => (pose, Some(layer)),
            None => (names, None),
        };
        Self {
            whole,
            pose: Some(pose),
            layer,
            text,
        }
    }

    /// The layer and the text without its place and numbers. Warnings without a pose stay by
    /// themselves.
    fn kind(&self) -> String {
        if self.pose.is_none() {
            return self.whole.to_owned();
        }
        let mut left_out = self.number_ranges();
        left_out.extend(place_range(self.text));
        left_out.sort_by_key(|range| range.start);
        let mut kind = format!("{}: ", self.layer.unwrap_or_default());
        let mut end = 0;
        for range in left_out {
            kind.push_str(&self.text[end..range.start]);
            kind.push('#');
            end = range.end;
        }
        kind + &self.text[end..]
    }

    /// Ranges of its numbers, those of a place left out.
    fn number_ranges(&self) -> Vec<Range<usize>> {
        let place = place_range(self.text).unwrap_or_default();
        let mut ranges = number_ranges(self.text);
        ranges.retain(|range| !place.contains(&range.start));
        ranges
    }

    fn numbers(&self) -> Vec<Number<'a>> {
        let ranges = self.number_ranges().into_iter();
        ranges
            .filter_map(|range| {
                let value = self.text[range.clone()].parse().ok()?;
                let after = &self.text[range.end..];
                let unit = after.split([',', ';', ' ', ')']).nth(1).unwrap_or_default();
                let with_unit = match after.starts_with(' ') && UNITS.contains(&unit) {
                    true => range.end + 1 + unit.len(),
                    false => range.end,
                };
                let is_next = |words: &str| after.trim_start().starts_with(words);
                Some(Number {
                    value,
                    text: &self.text[range.start..with_unit],
                    less_is_worse: LESS_IS_WORSE.into_iter().any(is_next),
                })
            })
            .collect()
    }

    fn number(&self, index: Option<usize>) -> Option<Number<'a>> {
        self.numbers().into_iter().nth(index?)
    }
}

/// Words that are shown with their number.
const UNITS: [&str; 7] = ["cm2", "mm", "%", "texels", "points", "vertices", "m"];

/// Range in which a text names a place on the model, if it does: its square of the texture, with
/// the blend shape nearest to it and with what says that there are others.
fn place_range(text: &str) -> Option<Range<usize>> {
    let start = text.find(PLACE)?;
    let square = text[start..].find(PLACE_SQUARE)?;
    let mut end = start + square + PLACE_SQUARE.len();
    if let Some(tile) = text[end..].strip_prefix(PLACE_TILE) {
        let number = tile.bytes().take_while(u8::is_ascii_digit).count();
        end += PLACE_TILE.len() + number;
    }
    if let Some(shape) = text[end..].strip_prefix(PLACE_SHAPE)
        && let Some(length) = shape.find(PLACE_SHAPE_END)
    {
        end += PLACE_SHAPE.len() + length + PLACE_SHAPE_END.len();
    }
    if text[end..].starts_with(PLACE_MORE) {
        end += PLACE_MORE.len();
    }
    Some(start..end)
}

/// Ranges of the numbers in a text: digits with at most one dot among them.
fn number_ranges(text: &str) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (at, character) in text.char_indices() {
        if !character.is_ascii_digit() {
            continue;
        }
        match ranges.last_mut() {
            Some(last) if last.end == at => last.end += 1,
            Some(last) if &text[last.end..at] == "." && !text[last.clone()].contains('.') => {
                last.end = at + 1;
            }
            _ => ranges.push(at..at + 1),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capped(pose: &str, area: f64) -> String {
        format!(
            "pose '{pose}', layer 'skin': {area:.2} cm2 are compressed beyond 15 %; it is capped"
        )
    }

    fn lines(warnings: &[String]) -> Vec<String> {
        grouped(warnings.iter().map(String::as_str), "all in report.json")
    }

    #[test]
    fn one_kind_is_one_line_with_a_count_and_the_worst_three() {
        let areas = [3.0, 12.0, 0.5, 7.25, 7.0];
        let warnings: Vec<String> = (0..5).map(|i| capped(&format!("p{i}"), areas[i])).collect();
        assert_eq!(
            lines(&warnings),
            [
                "5 poses, layer 'skin': 12.00 cm2 are compressed beyond 15 %; it is capped [these are \
                 the numbers of the worst, 'p1'; 'p3' has 7.25 cm2, 'p4' has 7.00 cm2 and 2 more (all in report.json)]"
            ]
        );
    }

    #[test]
    fn places_keep_no_warnings_apart() {
        let capped = |pose: &str, area: f64, place: &str| {
            format!(
                "pose '{pose}', layer 'skin': {area:.2} cm2 are compressed by more than 15 %, at u 0.{area:02.0} to 0.65, v 0.09 to 0.18 from the map's upper left{place}, where real skin folds, doubles its wrinkles or creases"
            )
        };
        let warnings = [
            capped(
                "a",
                3.0,
                " (near where blend shape 'browInnerUp_L' moves the skin)",
            ),
            capped(
                "b",
                12.0,
                " (near where blend shape 'd'oh 2' moves the skin), and elsewhere",
            ),
            capped("c", 7.0, ", and elsewhere"),
            capped("d", 5.0, " in tile 1012"),
        ];
        assert_eq!(
            lines(&warnings),
            [
                "4 poses, layer 'skin': 12.00 cm2 are compressed by more than 15 %, at u 0.12 to 0.65, v \
                 0.09 to 0.18 from the map's upper left (near where blend shape 'd'oh 2' moves the skin), \
                 and elsewhere, where real skin folds, doubles its wrinkles or creases [these are the \
                 numbers of the worst, 'b'; 'c' has 7.00 cm2, 'd' has 5.00 cm2 and 1 more (all in report.json)]"
            ]
        );
    }

    #[test]
    fn places_do_not_order_what_is_equally_bad() {
        let detour = |pose: &str, u: f64| {
            format!(
                "pose '{pose}': between rest and its keys 1.5 cm2 are squeezed, at u {u:.2} to 0.90, v 0.10 to 0.20 from the map's upper left, because a part turns"
            )
        };
        let line = &lines(&[detour("a", 0.2), detour("b", 0.7)])[0];
        assert!(
            line.starts_with("2 poses: between rest")
                && line.ends_with("because a part turns ['a', 'b']"),
            "{line}"
        );
    }

    #[test]
    fn every_layer_has_a_line_of_its_own() {
        let labyrinth = |pose: &str, layer: &str| {
            format!("pose '{pose}', layer '{layer}': set `coupling = \"elastic\"` for this layer")
        };
        let warnings = [
            labyrinth("a", "skin"),
            labyrinth("a", "fat"),
            labyrinth("b", "skin"),
            labyrinth("b", "fat"),
        ];
        let line = |layer: &str| {
            format!(
                "2 poses, layer '{layer}': set `coupling = \"elastic\"` for this layer ['a', 'b']"
            )
        };
        assert_eq!(lines(&warnings), [line("skin"), line("fat")]);
    }

    #[test]
    fn few_points_are_worse_than_many() {
        let budget = |pose: &str, points: f64| {
            format!(
                "pose '{pose}', layer 'skin': the budget of 300 leaves {points:.1} points per wavelength"
            )
        };
        let line = &lines(&[budget("a", 8.0), budget("b", 3.5)])[0];
        assert!(
            line.starts_with("2 poses, layer 'skin': the budget of 300 leaves 3.5 points")
                && line.ends_with("[these are the numbers of the worst, 'b'; 'a' has 8.0 points]"),
            "{line}"
        );
    }

    #[test]
    fn what_stands_alone_is_left_as_it_is_and_nothing_is_said_twice() {
        let alone = [
            "face.glb: 3 triangles left out".to_owned(),
            capped("a", 1.0),
        ];
        assert_eq!(lines(&[alone.as_slice(), &alone].concat()), alone);
        // Other words make another kind, and so do files that differ in a number.
        let other = ["part 1 has no UVs", "part 2 has no UVs"].map(str::to_owned);
        assert_eq!(lines(&other), other);
    }

    #[test]
    fn names_with_apostrophes_and_numbers_keep_their_warnings_apart() {
        let odd = capped("d'oh", 2.0);
        assert!(is_about(&odd, "d'oh") && !is_about(&odd, "d"));
        assert!(is_about("pose 'a': it turns", "a"));
        assert!(!is_about("layers 'a' and 'b'", "a"));
        let line = &lines(&[odd, capped("p1", 3.0)])[0];
        assert!(
            line.contains("the worst, 'p1'; 'd'oh' has 2.00 cm2"),
            "{line}"
        );
    }

    #[test]
    fn numbers_end_where_a_sentence_does() {
        let text = "at 0.350 (1.2e-3), 15 %. Then 7.";
        let found: Vec<&str> = number_ranges(text).into_iter().map(|r| &text[r]).collect();
        assert_eq!(found, ["0.350", "1.2", "3", "15", "7"]);
    }
}
