//! JSON objects whose values stay the text that the file has.

use std::fmt;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::{RawValue, to_raw_value};

/// The fields of a JSON object in the order of the file, each value as its text.
///
/// A value that is not set is written back byte for byte: its numbers keep their digits, its fields
/// their order, and fields that no reader here knows stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct JsonObject(Vec<(String, Box<RawValue>)>);

impl JsonObject {
    pub(crate) fn parse(text: &str) -> serde_json::Result<Self> {
        serde_json::from_str(text)
    }

    /// The fields whose names are among `names`.
    pub(crate) fn only(&self, names: &[&str]) -> Self {
        let kept = self.0.iter().filter(|(n, _)| names.contains(&n.as_str()));
        Self(kept.cloned().collect())
    }

    /// The fields whose names are not among `names`.
    pub(crate) fn without(&self, names: &[&str]) -> Self {
        let kept = self.0.iter().filter(|(n, _)| !names.contains(&n.as_str()));
        Self(kept.cloned().collect())
    }

    pub(crate) fn get(&self, name: &str) -> Option<&RawValue> {
        let found = self.0.iter().find(|(other, _)| other == name);
        found.map(|(_, value)| &**value)
    }

    /// The value as `T`, if there is one and it is such.
    pub(crate) fn read<T: for<'a> Deserialize<'a>>(&self, name: &str) -> Option<T> {
        serde_json::from_str(self.get(name)?.get()).ok()
    }

    /// The elements of an array; none where there is no array.
    pub(crate) fn array(&self, name: &str) -> Vec<Box<RawValue>> {
        self.read(name).unwrap_or_default()
    }

    /// Replaces a value in its place, or adds it at the end.
    pub(crate) fn set(&mut self, name: &str, value: &impl Serialize) -> serde_json::Result<()> {
        let value = to_raw_value(value)?;
        match self.0.iter_mut().find(|(other, _)| other == name) {
            Some((_, old)) => *old = value,
            None => self.0.push((name.to_owned(), value)),
        }
        Ok(())
    }

    pub(crate) fn remove(&mut self, name: &str) {
        self.0.retain(|(other, _)| other != name);
    }
}

impl Serialize for JsonObject {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<'de> Deserialize<'de> for JsonObject {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = JsonObject;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a JSON object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<JsonObject, A::Error> {
                let mut fields = Vec::new();
                while let Some(field) = map.next_entry()? {
                    fields.push(field);
                }
                Ok(JsonObject(fields))
            }
        }
        deserializer.deserialize_map(Fields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_set_keeps_its_text() {
        let text =
            r#"{"b":[1.50, 1e400 ,{"z":0.1,"a":-0}],"a":{ "x" : 1 },"c":12345678901234567890123}"#;
        let mut object = JsonObject::parse(text).expect("an object");
        assert_eq!(serde_json::to_string(&object).expect("text"), text);
        object.set("a", &2).expect("a number");
        object.set("d", &[1, 2]).expect("a list");
        object.remove("c");
        let expected = r#"{"b":[1.50, 1e400 ,{"z":0.1,"a":-0}],"a":2,"d":[1,2]}"#;
        assert_eq!(serde_json::to_string(&object).expect("text"), expected);
        assert!(JsonObject::parse("[1]").is_err());
    }
}
