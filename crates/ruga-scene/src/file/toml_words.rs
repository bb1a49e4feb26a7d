//! What the TOML parser and serde say of a mistake, in words for somebody who wrote a scene.

use super::reference::{Table, reference};

/// Powers of ten of the units that people write behind a number; keys take metres and pascals.
const UNITS: [(&str, i32); 9] = [
    ("", 0),
    ("m", 0),
    ("cm", -2),
    ("mm", -3),
    ("um", -6),
    ("Pa", 0),
    ("kPa", 3),
    ("MPa", 6),
    ("GPa", 9),
];

/// Beginnings of what the parser says of a number that is none.
const NO_NUMBER: [&str; 4] = [
    "invalid ",
    "redundant ",
    "string values must be quoted",
    "unexpected ",
];

/// Beginnings of what the parser says of a word without quotes, by its first letter.
const NO_WORD: [&str; 2] = ["invalid boolean", "invalid float"];

/// Says what is wrong in the `line` that a parser's `message` is about, and what to write; `None` for
/// messages that have no better words. `key` is where serde stopped, empty where the text is no TOML.
pub(super) fn reason(message: &str, key: &str, line: &str) -> Option<String> {
    let tables = reference();
    let line = line.trim();
    let path = without_numbers(key);
    wrong_brackets(line, &tables)
        .or_else(|| missing_field(message, &path, &tables))
        .or_else(|| wrong_type(message, &path, line, &tables))
        .or_else(|| unknown_word(message))
        .or_else(|| no_word(&path, &tables))
        .or_else(|| key.is_empty().then(|| no_toml(message, line))?)
}

/// `[layers]` where scenes have `[[layers]]`, or the other way round.
fn wrong_brackets(line: &str, tables: &[Table]) -> Option<String> {
    let header = line.split('#').next()?.trim();
    let name = header.strip_prefix('[')?.strip_suffix(']')?;
    let is_list = name.starts_with('[');
    let name = name.trim_matches(['[', ']']).trim();
    let table = tables
        .iter()
        .find(|table| table.path == name && table.header.starts_with("[[") != is_list)?;
    let why = match is_list {
        true => "one bracket, because there is only one",
        false => "two brackets, because there may be several",
    };
    Some(format!(
        "found {header}; write `{}`, with {why}",
        table.header
    ))
}

fn missing_field(message: &str, path: &str, tables: &[Table]) -> Option<String> {
    let name = message.strip_prefix("missing field `")?.strip_suffix('`')?;
    Some(match (path, name) {
        ("", "version") => {
            "the key `version` is missing; write `version = 1` above the first table".to_owned()
        }
        ("", "driver") => {
            "the table `[driver]` is missing; write `[driver]` and below it `mesh = \"face.glb\"`"
                .to_owned()
        }
        ("", "layers") => {
            "there is no layer; write `[[layers]]` and below it `name = \"skin\"` and \
             `preset = \"forehead-furrow\"`"
                .to_owned()
        }
        _ => {
            let value = sample(path, name, tables);
            format!("the key `{name}` is missing; write `{name} = {value}`")
        }
    })
}

/// A value of another kind than the key takes.
fn wrong_type(message: &str, path: &str, line: &str, tables: &[Table]) -> Option<String> {
    let (found, expected) = message
        .strip_prefix("invalid type: ")
        .or_else(|| message.strip_prefix("invalid value: "))
        .or_else(|| message.strip_prefix("invalid "))?
        .split_once(", expected ")?;
    let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
    let accepted = match expected.trim_end() {
        "f64" => number_words(name, found),
        "u32" | "u64" => match sample(table, name, tables) {
            value if value == "..." => "a whole number".to_owned(),
            value => format!("a whole number, such as {value}"),
        },
        "a boolean" => "`true` or `false`".to_owned(),
        "a string" | "path string" => "text in quotes".to_owned(),
        "a map" => match name {
            "targets" => "a table `{ name = \"file.obj\" }`".to_owned(),
            _ => "a table `{ name = number }`, such as `{ smile = 1.0 }`".to_owned(),
        },
        "a sequence" => match sample(table, name, tables) {
            value if value.starts_with('[') => format!("a list in brackets, such as `{value}`"),
            _ => "a list in brackets `[...]`".to_owned(),
        },
        "an array of length 2" => list_words(2),
        "an array of length 3" => list_words(3),
        expected if expected.starts_with("struct ") => {
            let table = tables.iter().find(|table| table.path == path)?;
            match path.contains('.') {
                true => format!("a table `{name} = {{ key = value }}`"),
                false => format!("a table: the line `{}`, and its keys below", table.header),
            }
        }
        _ => return None,
    };
    Some(format!(
        "found {}; accepted: {accepted}",
        found_words(found, line)
    ))
}

/// The words that a key takes, where something else stands in the place of one. If that is a table, serde's path ends in
/// a key of it.
fn no_word(path: &str, tables: &[Table]) -> Option<String> {
    let above = path.rsplit_once('.').map_or("", |(above, _)| above);
    let key = [path, above].into_iter().find_map(|path| {
        let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
        let table = tables.iter().find(|other| other.path == table)?;
        let mut keys = table.keys.iter();
        keys.find(|key| key.name == name && !key.choices.is_empty())
    })?;
    let words = key.choices.iter().map(|(word, _)| word.as_str());
    Some(format!(
        "this is not a word in quotes; accepted: {}",
        quoted(words)
    ))
}

/// A word that is none of those that a key takes, which serde puts in backticks.
fn unknown_word(message: &str) -> Option<String> {
    let (found, accepted) = message
        .strip_prefix("unknown variant `")?
        .split_once("`, expected ")?;
    let accepted = quoted(accepted.split('`').skip(1).step_by(2));
    Some(format!("found \"{found}\"; accepted: {accepted}"))
}

fn quoted<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let words = words.map(|word| format!("\"{word}\""));
    words.collect::<Vec<_>>().join(", ")
}

/// What a key takes whose list has a length.
pub(super) fn list_words(count: u64) -> String {
    let example = match count {
        2 => ", such as `[0.25, 0.75]`",
        3 => ", such as `[0.0, 1.0, 0.0]`",
        _ => "",
    };
    format!("a list of {count} numbers{example}")
}

/// Serde's description of a value, without the name of its type.
fn found_words(found: &str, line: &str) -> String {
    if let Some(count) = found.strip_prefix("length ") {
        return format!("a list of {count}");
    }
    match found {
        "map" if line.starts_with('[') => format!("the table {line}"),
        "map" => "a table".to_owned(),
        "sequence" => "a list".to_owned(),
        _ => match (found.split_once('`'), found.split_once('"')) {
            (Some((_, value)), _) => value.split('`').next().unwrap_or(value).to_owned(),
            (None, Some((_, value))) => format!("\"{value}"),
            (None, None) => found.to_owned(),
        },
    }
}

/// The number that a key takes, with its unit; the one that was probably meant by text.
fn number_words(name: &str, found: &str) -> String {
    let text = found.strip_prefix("string \"").unwrap_or_default();
    if let Some(number) = plain_number(text.trim_end_matches('"')) {
        return format!(
            "a number without quotes and unit; write {number}{}",
            unit_words(name)
        );
    }
    match name {
        "thickness" | "wavelength" => "a number without unit, in metres: 0.7e-3".to_owned(),
        "young" => "a number without unit, in pascals: 0.8e6".to_owned(),
        _ => "a number, such as 0.5".to_owned(),
    }
}

fn unit_words(name: &str) -> &'static str {
    match name {
        "thickness" | "wavelength" | "min_edge" | "max_edge" => ", which is in metres",
        "young" => ", which is in pascals",
        _ => "",
    }
}

/// What is wrong with a line that is not TOML.
fn no_toml(message: &str, line: &str) -> Option<String> {
    let (key, value) = line.split_once('=').unwrap_or((line, ""));
    let setting = (key.trim(), value.split('#').next()?.trim());
    no_number(message, setting)
        .or_else(|| no_text(message, line, setting))
        .or_else(|| no_syntax(message, line))
}

/// A number with a comma or a unit, or a word in its place.
fn no_number(message: &str, (key, value): (&str, &str)) -> Option<String> {
    if value.starts_with('{') && has_decimal_comma(value) {
        return Some("a comma stands between two digits; write a point, as in 0.5".to_owned());
    }
    let begins_number = value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let is_number = begins_number || (!value.is_empty() && !unit_words(key).is_empty());
    if !is_number || !NO_NUMBER.iter().any(|start| message.starts_with(start)) {
        return None;
    }
    let write = match plain_number(value) {
        Some(number) => format!("write `{key} = {number}`{}", unit_words(key)),
        None => "write digits alone, with a point for a fraction, such as 6 or 0.7e-3".to_owned(),
    };
    Some(format!("`{value}` is not a number; {write}"))
}

/// A text without quotes, or a path with `\` in it.
fn no_text(message: &str, line: &str, (key, value): (&str, &str)) -> Option<String> {
    if value.contains('\\') && (message.contains("escape") || message.contains("unicode")) {
        return Some(format!(
            "`\\` has a meaning of its own between double quotes; write `/` instead, or single \
             quotes: `{key} = '{}'`",
            value.trim_matches('"')
        ));
    }
    let is_word = value.starts_with(char::is_alphabetic);
    let is_taken_for_other = is_word && NO_WORD.iter().any(|start| message.starts_with(start));
    if !message.starts_with("string values must be quoted") && !is_taken_for_other {
        return None;
    }
    let text = value.trim_matches(['“', '”', '„', '"', '\'']);
    if text.is_empty() {
        return Some(format!("`{key}` has no value"));
    }
    let written = match line.contains(['{', '[']) {
        true => "such as \"smile\"".to_owned(),
        false => format!("as in `{key} = \"{text}\"`"),
    };
    Some(format!(
        "text must stand in straight quotes, {written}; `true`, `false` and numbers stand without"
    ))
}

/// A sign too few or too many.
fn no_syntax(message: &str, line: &str) -> Option<String> {
    let what = message.lines().next()?.split(',').next()?;
    let words = match what {
        "key with no value" => return Some(no_equals_sign(line)),
        "unclosed table" | "unclosed array table" => {
            return Some(format!("the closing bracket is missing after `{line}`"));
        }
        "missing opening quote" => "the opening quote is missing",
        "invalid basic string" | "invalid literal string" => "the closing quote is missing",
        "missing comma between array elements" | "unclosed array" => {
            "a comma is missing in the list, or the `]` that closes it"
        }
        "missing comma between key-value pairs" | "unclosed inline table" => {
            "a comma is missing between two entries, or the `}` that closes them"
        }
        "extra comma in array" | "extra comma in inline table" => "there is a comma too many",
        "missing assignment between key-value pairs" => {
            "the `=` is missing between a name and its value, as in `{ smile = 1.0 }`"
        }
        "unexpected key or value" if line.starts_with('[') => {
            "there is something behind the closing bracket; a header stands alone on its line"
        }
        "unexpected key or value" => {
            "there is something behind the value; a line has one `key = value`, and may end in a \
             `# remark`"
        }
        _ => return None,
    };
    Some(words.to_owned())
}

fn no_equals_sign(line: &str) -> String {
    match line.split_once([':', ' ']) {
        Some((key, value)) => {
            format!(
                "the `=` is missing; write `{} = {}`",
                key.trim(),
                value.trim()
            )
        }
        None => format!("`{line}` has no value; write `{line} = ` and the value"),
    }
}

/// Whether a comma stands right between two digits.
fn has_decimal_comma(text: &str) -> bool {
    let bytes = text.as_bytes();
    let mut triples = bytes.windows(3);
    triples.any(|t| t[0].is_ascii_digit() && t[1] == b',' && t[2].is_ascii_digit())
}

/// The number in SI units that a text such as `0,7 mm` means; `None` where that is a guess.
fn plain_number(text: &str) -> Option<String> {
    let text = text.trim().trim_end_matches([',', ';']).trim_end();
    // Somebody may have meant thousands.
    let (_, decimals) = text.split_once(',').unwrap_or(("", ""));
    let digits = decimals.chars().take_while(char::is_ascii_digit).count();
    if digits == 3 || decimals.contains(',') {
        return None;
    }
    let point = text.replacen(',', ".", 1);
    let end = point.rfind(|c: char| c.is_ascii_digit())? + 1;
    let (number, unit) = point.split_at(end);
    let unit = unit.trim_start_matches('.');
    // TOML has neither `.7` nor `007`.
    let (sign, number) = match number.strip_prefix('-') {
        Some(number) => ("-", number),
        None => ("", number),
    };
    let number = match number.trim_start_matches('0') {
        digits if digits.starts_with(|c: char| c.is_ascii_digit()) => format!("{sign}{digits}"),
        rest => format!("{sign}0{rest}"),
    };
    number
        .parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())?;
    let (_, power) = UNITS.into_iter().find(|(name, _)| *name == unit.trim())?;
    match power {
        0 => Some(number),
        _ if number.contains(['e', 'E']) => None,
        _ => Some(format!("{number}e{power}")),
    }
}

/// A value that a key may have, as TOML: its default, or one of its kind.
fn sample(table: &str, name: &str, tables: &[Table]) -> String {
    let table = tables.iter().find(|other| other.path == table);
    let key = table.and_then(|table| table.keys.iter().find(|key| key.name == name));
    let Some(key) = key else {
        return "...".to_owned();
    };
    if let Some(default) = &key.default {
        return default.clone();
    }
    match (name, key.kind.as_str()) {
        ("version", _) => "1",
        ("mesh", _) => "\"face.glb\"",
        ("name", _) => "\"skin\"",
        (_, "text") => "\"...\"",
        (_, "number") => "0.5",
        (_, "whole number") => "6",
        (_, "list of 3 numbers") => "[0.0, 1.0, 0.0]",
        _ => "...",
    }
    .to_owned()
}

/// The path of a key without the numbers of lists.
fn without_numbers(key: &str) -> String {
    let names = key.split('.');
    let names = names.map(|name| name.split('[').next().unwrap_or(name));
    names.collect::<Vec<_>>().join(".")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_units_and_commas_are_read_where_they_are_clear() {
        for (text, number) in [
            ("0.7 mm", Some("0.7e-3")),
            ("0,7e-3", Some("0.7e-3")),
            ("0,7mm", Some("0.7e-3")),
            ("0.8 MPa", Some("0.8e6")),
            ("1;", Some("1")),
            (".7", Some("0.7")),
            ("007", Some("7")),
            ("-0,5", Some("-0.5")),
            ("7.", Some("7")),
            ("2 m", Some("2")),
            ("0.7e-3 mm", None),
            ("300,000", None),
            ("1.0.0", None),
            ("7 inches", None),
            ("seven", None),
        ] {
            assert_eq!(plain_number(text).as_deref(), number, "{text}");
        }
    }
}
