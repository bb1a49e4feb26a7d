//! Every key of a scene with its kind, default and meaning, taken from the types themselves.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::de::value::Error as NoValue;
use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde_json::{Map, Value};

use super::{
    Anchor, Bake, Burn, BurnMap, BurnSource, Char, Crease, Cylinder, Driver, Growth, Handle,
    Interior, Layer, Memory, Motion, Obstacle, Pack, Plane, Ply, Pose, PropertyMap, Remesh,
    SceneFile, Sheet, Solver, Sphere, Substrate,
};

/// One table of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Where it stands, without the numbers of lists, as `layers.map`; empty for the top of the file.
    pub path: &'static str,
    /// How it is written, as `[[layers]]`.
    pub header: &'static str,
    /// What it is.
    pub about: String,
    /// Its keys in the order of the documentation.
    pub keys: Vec<Key>,
}

/// One key of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// What kind of value it takes, in words.
    pub kind: String,
    /// Whether it must be given.
    pub is_required: bool,
    /// What it is when it is left out, as TOML; `None` where leaving it out means something else than
    /// a value.
    pub default: Option<String>,
    /// Meaning, unit and range.
    pub about: String,
    /// The words it accepts, each with its meaning; empty where it takes something else than words.
    pub choices: Vec<(String, String)>,
}

/// Every table of a scene, in the order in which scenes are usually written.
pub fn reference() -> Vec<Table> {
    vec![
        table::<SceneFile>("", "the top of the file"),
        table::<Driver>("driver", "[driver]"),
        table::<Substrate>("substrate", "[substrate]"),
        table::<Layer>("layers", "[[layers]]"),
        table::<Ply>("layers.plies", "[[layers.plies]]"),
        table::<PropertyMap>("layers.map", "[layers.map]"),
        table::<Crease>("creases", "[[creases]]"),
        table::<Anchor>("creases.anchor", "[creases.anchor]"),
        table::<Growth>("growths", "[[growths]]"),
        table::<Memory>("memory", "[memory]"),
        table::<Pose>("poses", "[[poses]]"),
        table::<Motion>("poses.motions", "[[poses.motions]]"),
        table::<Solver>("solver", "[solver]"),
        table::<Remesh>("remesh", "[remesh]"),
        table::<Bake>("bake", "[bake]"),
        table::<Pack>("pack", "[pack]"),
        table::<Interior>("interior", "[interior]"),
        table::<Handle>("interior.handles", "[[interior.handles]]"),
        table::<Obstacle>("interior.obstacles", "[[interior.obstacles]]"),
        table::<Plane>("interior.obstacles.plane", "[interior.obstacles.plane]"),
        table::<Sphere>("interior.obstacles.sphere", "[interior.obstacles.sphere]"),
        table::<Cylinder>(
            "interior.obstacles.cylinder",
            "[interior.obstacles.cylinder]",
        ),
        table::<Sheet>("sheet", "[sheet]"),
        table::<Burn>("burn", "[burn]"),
        table::<Char>("burn.char", "[burn.char]"),
        table::<BurnMap>("burn.map", "[burn.map]"),
        table::<BurnSource>("burn.sources", "[[burn.sources]]"),
    ]
}

fn table<T: JsonSchema + for<'de> Deserialize<'de>>(
    path: &'static str,
    header: &'static str,
) -> Table {
    let schema = whole_schema::<T>();
    let required: Vec<&str> = schema
        .get("required")
        .and_then(Value::as_array)
        .map(|names| names.iter().filter_map(Value::as_str).collect())
        .unwrap_or_default();
    let nothing = Map::new();
    let properties = schema.get("properties").and_then(Value::as_object);
    let properties = properties.unwrap_or(&nothing);
    let keys = field_names::<T>().iter().filter_map(|&name| {
        let property = properties.get(name)?;
        Some(Key {
            name,
            kind: kind(property),
            is_required: required.contains(&name),
            default: property.get("default").and_then(toml_text),
            about: text(property, "description"),
            choices: choices(property),
        })
    });
    Table {
        path,
        header,
        about: schema
            .get("description")
            .and_then(Value::as_str)
            .map(one_line)
            .unwrap_or_default(),
        keys: keys.collect(),
    }
}

/// The schema of a type, with those of its fields where they are used.
pub(super) fn whole_schema<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().with(|s| s.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<T>()
}

fn text(schema: &Value, name: &str) -> String {
    schema
        .get(name)
        .and_then(Value::as_str)
        .map(one_line)
        .unwrap_or_default()
}

/// The first paragraph of a comment; what follows it is for programmers.
fn first_paragraph(schema: &Value) -> String {
    let all = schema.get("description").and_then(Value::as_str);
    let first = all.and_then(|text| text.split("\n\n").next());
    first.map(one_line).unwrap_or_default()
}

/// The lines of a comment as one.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The schema of a value that may be left out, without the `null` that schemars adds to it.
pub(super) fn given(schema: &Value) -> &Value {
    let options = schema.get("anyOf").and_then(Value::as_array);
    let is_null = |option: &&Value| option.get("type").and_then(Value::as_str) == Some("null");
    options
        .and_then(|options| options.iter().find(|option| !is_null(option)))
        .unwrap_or(schema)
}

/// The words an enum accepts, or those of a list's items.
fn choices(schema: &Value) -> Vec<(String, String)> {
    let schema = given(schema);
    let schema = schema.get("items").unwrap_or(schema);
    let options = schema.get("oneOf").and_then(Value::as_array);
    let choice = |option: &Value| {
        let word = option.get("const")?.as_str()?.to_owned();
        Some((word, first_paragraph(option)))
    };
    options.into_iter().flatten().filter_map(choice).collect()
}

fn kind(schema: &Value) -> String {
    let schema = given(schema);
    if schema.get("oneOf").is_some() {
        return "one word".to_owned();
    }
    match type_name(schema) {
        "string" => "text".to_owned(),
        "integer" => "whole number".to_owned(),
        "number" => "number".to_owned(),
        "boolean" => "`true` or `false`".to_owned(),
        "array" => list(schema),
        "object" => match schema.get("additionalProperties") {
            Some(values) if values.is_object() => format!("table of {}s by name", kind(values)),
            _ => "table".to_owned(),
        },
        _ => "value".to_owned(),
    }
}

fn list(schema: &Value) -> String {
    let Some(items) = schema.get("items") else {
        return "list".to_owned();
    };
    let item = match kind(items).as_str() {
        "one word" => "words".to_owned(),
        "text" => "texts".to_owned(),
        list if list.starts_with("list of ") => list.replacen("list", "lists", 1),
        other => format!("{other}s"),
    };
    match length(schema) {
        Some(count) => format!("list of {count} {item}"),
        None => format!("list of {item}"),
    }
}

/// Items that a list must have; only arrays of a fixed length have it.
pub(super) fn length(schema: &Value) -> Option<u64> {
    schema.get("maxItems").and_then(Value::as_u64)
}

/// `type` is a name, or a list of a name and `null`.
fn type_name(schema: &Value) -> &str {
    match schema.get("type") {
        Some(Value::String(name)) => name,
        Some(Value::Array(names)) => (names.iter().filter_map(Value::as_str))
            .find(|name| *name != "null")
            .unwrap_or_default(),
        _ => "",
    }
}

/// A default as it would be written; none for `null`, empty lists and tables, whose meaning the text
/// says.
fn toml_text(value: &Value) -> Option<String> {
    match value {
        Value::Null | Value::Object(_) => None,
        Value::Array(items) if items.is_empty() => None,
        Value::Array(items) => {
            let items: Option<Vec<String>> = items.iter().map(toml_text).collect();
            Some(format!("[{}]", items?.join(", ")))
        }
        other => Some(other.to_string()),
    }
}

/// The fields of a struct in the order of its declaration, which a schema does not keep.
fn field_names<T: for<'de> Deserialize<'de>>() -> &'static [&'static str] {
    let mut names: &'static [&'static str] = &[];
    // Always ends with the error of `FieldNames`.
    let _ = T::deserialize(FieldNames(&mut names));
    names
}

/// Keeps the field names that derived code asks a deserializer for, and gives it nothing.
struct FieldNames<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for FieldNames<'_> {
    type Error = NoValue;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, NoValue> {
        *self.0 = fields;
        Err(NoValue::custom("only the names of the fields are wanted"))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, NoValue> {
        Err(NoValue::custom("not a struct"))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}
