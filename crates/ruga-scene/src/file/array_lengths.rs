//! Refuses lists with more numbers than their key takes: serde fills an array from the first ones and ignores the rest.

use std::ops::Range;

use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::SceneFile;
use super::reference::{given, length, whole_schema};
use super::toml_words::list_words;

/// A list that is too long.
pub(super) struct Surplus {
    pub(super) key: String,
    /// Where it stands in the file, bytes.
    pub(super) span: Range<usize>,
    found: usize,
    count: u64,
}

impl Surplus {
    /// The first one in a document that has the types of a scene.
    pub(super) fn of(document: &DeTable<'_>) -> Option<Self> {
        in_table(document, whole_schema::<SceneFile>().as_value(), "")
    }

    /// How many numbers there are, and how many there should be.
    pub(super) fn reason(&self) -> String {
        let accepted = list_words(self.count);
        format!("found a list of {}; accepted: {accepted}", self.found)
    }
}

fn in_value(value: &Spanned<DeValue<'_>>, schema: &Value, key: String) -> Option<Surplus> {
    let schema = given(schema);
    match value.get_ref() {
        DeValue::Table(table) => in_table(table, schema, &key),
        DeValue::Array(items) => {
            let count = length(schema).filter(|count| items.len() as u64 > *count);
            if let Some(count) = count {
                return Some(Surplus {
                    key,
                    span: value.span(),
                    found: items.len(),
                    count,
                });
            }
            let of_items = schema.get("items")?;
            let mut numbered = items.iter().enumerate();
            numbered.find_map(|(i, item)| in_value(item, of_items, format!("{key}[{i}]")))
        }
        _ => None,
    }
}

fn in_table(table: &DeTable<'_>, schema: &Value, path: &str) -> Option<Surplus> {
    let keys = schema.get("properties")?;
    table.iter().find_map(|(name, value)| {
        let name = name.get_ref();
        let key = match path {
            "" => name.to_string(),
            _ => format!("{path}.{name}"),
        };
        in_value(value, keys.get(name.as_ref())?, key)
    })
}
