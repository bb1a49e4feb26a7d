//! The reference of scene keys is complete and says what the types say.

use std::collections::BTreeMap;

use ruga_scene::SceneFile;
use ruga_scene::file::{Table, reference};
use serde_json::Value;

/// Structs of a scene by their name in the schema, with their keys.
fn structs() -> BTreeMap<String, Vec<String>> {
    let root = schemars::schema_for!(SceneFile);
    let keys = |schema: &Value| -> Option<Vec<String>> {
        Some(
            schema
                .get("properties")?
                .as_object()?
                .keys()
                .cloned()
                .collect(),
        )
    };
    let definitions = root.get("$defs").and_then(Value::as_object);
    let definitions = definitions.expect("a scene is made of several types");
    let mut found: BTreeMap<String, Vec<String>> = definitions
        .iter()
        .filter_map(|(name, schema)| Some((name.clone(), keys(schema)?)))
        .collect();
    found.insert(
        "SceneFile".to_owned(),
        keys(root.as_value()).expect("a struct"),
    );
    found
}

#[test]
fn every_key_of_every_type_is_explained() {
    let tables = reference();
    let structs = structs();
    assert_eq!(structs.len(), tables.len());
    for (name, mut keys) in structs {
        keys.sort();
        let is_of_it = |table: &&Table| {
            let mut names: Vec<_> = table.keys.iter().map(|key| key.name.to_owned()).collect();
            names.sort();
            names == keys
        };
        assert!(
            tables.iter().any(|table| is_of_it(&table)),
            "{name}: {keys:?}"
        );
    }
    for table in &tables {
        assert!(!table.about.is_empty(), "{}", table.header);
        for key in &table.keys {
            let place = format!("{} {}", table.header, key.name);
            assert!(!key.about.is_empty() && key.kind != "value", "{place}");
            assert!(!key.about.contains("[`"), "{place}: {}", key.about);
            let words_are_explained = key.choices.iter().all(|(_, about)| !about.is_empty());
            assert!(words_are_explained, "{place}");
        }
    }
}

#[test]
fn kinds_and_defaults_are_those_of_the_types() {
    let tables = reference();
    let key = |path: &str, name: &str| {
        let table = tables.iter().find(|table| table.path == path);
        let keys = &table.expect("a table").keys;
        keys.iter()
            .find(|key| key.name == name)
            .expect("a key")
            .clone()
    };
    let size = key("bake", "size");
    assert_eq!(
        (size.kind.as_str(), size.default.as_deref()),
        ("whole number", Some("2048"))
    );
    assert!(key("driver", "mesh").is_required);
    let keys = key("poses", "keys");
    assert_eq!(keys.kind, "list of numbers");
    assert_eq!(keys.default.as_deref(), Some("[0.5, 1.0]"));
    assert_eq!(key("layers", "strength").default.as_deref(), Some("1.0"));
    let range = key("layers.map", "young");
    assert_eq!(
        (range.kind.as_str(), range.default),
        ("list of 2 numbers", None)
    );
    let stack = key("", "stack");
    assert_eq!(stack.default.as_deref(), Some("\"nominal\""));
    assert_eq!(stack.choices.len(), 3);
    assert_eq!(key("poses", "weights").kind, "table of numbers by name");
    assert_eq!(key("driver", "region").default.as_deref(), Some("\"auto\""));
    assert_eq!(key("driver", "region").kind, "text");
    assert_eq!(key("bake", "maps").choices.len(), 12);
    assert_eq!(tables[3].keys[0].name, "name");
}
