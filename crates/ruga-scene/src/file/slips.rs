//! What was probably meant by a key that is unknown or given twice.

use std::ops::Range;

use super::reference::{Table, reference};
use ruga_blend::nearest;

/// Keys that scenes had in earlier versions: table, key, and what holds now.
const GONE: [(&str, &str, &str); 1] = [(
    "solver",
    "linear",
    "linear systems are always solved by direct LDL^T factorisation; leave the key out",
)];

/// A key that its table does not have.
pub(super) struct UnknownKey {
    key: String,
    tables: Vec<Table>,
    /// The table with its keys, as a number into `tables`: that of a body for handles and obstacles of a sheet.
    place: usize,
    /// Whether it stands in `[sheet]` or below.
    is_of_sheet: bool,
}

impl UnknownKey {
    /// From serde's message about a field and the path at which it stopped; `None` for other
    /// messages.
    pub(super) fn of(message: &str, path: &str) -> Option<Self> {
        let key = message
            .strip_prefix("unknown field `")?
            .split_once('`')?
            .0
            .to_owned();
        // A quoted key may have dots of its own.
        let table_path = path.strip_suffix(&key).unwrap_or(path);
        let numbered = table_path.trim_end_matches('.').split('.');
        let parts: Vec<&str> = numbered
            .map(|part| part.split('[').next().unwrap_or(part))
            .collect();
        let table_path = parts.join(".");
        let tables = reference();
        let at = |path: &str| tables.iter().position(|table| table.path == path);
        // Handles and obstacles of a sheet have the keys of those of a body.
        let of_body = table_path.strip_prefix("sheet.");
        let of_body = of_body.map(|rest| format!("interior.{rest}"));
        let place = at(&table_path).or_else(|| at(&of_body?))?;
        Some(Self {
            key,
            tables,
            place,
            is_of_sheet: parts[0] == "sheet",
        })
    }

    /// Where the key belongs, or which keys its table has.
    pub(super) fn reason(&self) -> String {
        let table = &self.tables[self.place];
        let header = self.quoted(table);
        if let Some(now) = self.gone() {
            return format!("`{}` is no longer a key of {header}: {now}", self.key);
        }
        let headers: Vec<String> = self.homes().map(|home| self.quoted(home)).collect();
        let known = format!("`{}` is not a key of {header}", self.key);
        if !headers.is_empty() {
            return format!("{known}; it belongs in {}", headers.join(" or "));
        }
        let names: Vec<String> = table.keys.iter().map(|k| format!("`{}`", k.name)).collect();
        format!("{known}, which has {}", names.join(", "))
    }

    /// The key with nearly this name, here or else with its table elsewhere.
    pub(super) fn suggestion(&self) -> Option<String> {
        if self.gone().is_some() || self.homes().next().is_some() {
            return None;
        }
        let names = |table: &Table| table.keys.iter().map(|k| k.name).collect::<Vec<_>>();
        nearest(&self.key, names(&self.tables[self.place])).or_else(|| {
            let elsewhere = self.tables.iter().flat_map(names);
            let name = nearest(&self.key, elsewhere)?;
            let home = self.tables.iter().find(|table| has(table, &name))?;
            // The message puts backticks around the whole.
            Some(format!("{name}` in `{}", self.header(home)))
        })
    }

    /// What holds instead of a key of an earlier version.
    fn gone(&self) -> Option<&'static str> {
        let path = self.tables[self.place].path;
        let mut keys = GONE.iter();
        let found = keys.find(|(table, key, _)| *table == path && *key == self.key);
        found.map(|(_, _, now)| *now)
    }

    /// The header of a table; for a key of a sheet, that of the sheet's handles and obstacles.
    fn header(&self, table: &Table) -> String {
        match self.is_of_sheet && table.path.starts_with("interior.") {
            true => table.header.replacen("interior", "sheet", 1),
            false => table.header.to_owned(),
        }
    }

    fn quoted(&self, table: &Table) -> String {
        let header = self.header(table);
        match table.path {
            "" => header,
            _ => format!("`{header}`"),
        }
    }

    fn homes(&self) -> impl Iterator<Item = &Table> {
        self.tables.iter().filter(|table| has(table, &self.key))
    }
}

fn has(table: &Table, key: &str) -> bool {
    table.keys.iter().any(|other| other.name == key)
}

/// Names a key or table that is given twice, with the line of the first; `None` for other messages
/// than TOML's about duplicates.
pub(super) fn duplicate(text: &str, second: Range<usize>, message: &str) -> Option<String> {
    if !message.contains("duplicate key") {
        return None;
    }
    let key = text.get(second.clone())?.trim();
    let before = text.get(..second.start)?;
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    let second_line = text.get(line_start..)?.lines().next()?.trim();
    let is_table = second_line.starts_with('[');
    let (what, first) = if is_table {
        let header = second_line.split('#').next()?.trim();
        (
            header.to_owned(),
            line_with(before, |line| line.starts_with(header)),
        )
    } else {
        let name = format!("`{key}`");
        (name, line_in_same_table(text, line_start, key))
    };
    let first = first.map_or_else(String::new, |line| format!("; first in line {line}"));
    Some(format!("{what} is given twice{first}; accepted: once"))
}

fn line_with(text: &str, is_it: impl Fn(&str) -> bool) -> Option<usize> {
    text.lines()
        .position(|line| is_it(line.trim()))
        .map(|index| index + 1)
}

/// The last line before `end`, or the one that begins there, that sets `key` in the table that is
/// open there.
fn line_in_same_table(text: &str, end: usize, key: &str) -> Option<usize> {
    let sets = |line: &str| {
        let name = line.split('=').next().unwrap_or_default().trim();
        name.trim_matches(['"', '\'']) == key.trim_matches(['"', '\''])
    };
    let earlier: Vec<&str> = text.get(..end)?.lines().collect();
    let open = earlier
        .iter()
        .rposition(|line| line.trim_start().starts_with('['));
    let from = open.map_or(0, |header| header + 1);
    let found = earlier[from..].iter().rposition(|line| sets(line));
    // Without one the keys stand in one pair of braces.
    Some(found.map_or(earlier.len(), |index| from + index) + 1)
}
