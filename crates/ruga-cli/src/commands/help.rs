//! `ruga help`: commands, and a reference of scenes and presets made from the types themselves.

use std::fmt::Write as _;

use clap::{Parser, ValueEnum};
use ruga_material::{PRESETS, Preset, Variation, WavelengthModel, wrinkling};
use ruga_scene::file::{Key, Table, reference};
use ruga_scene::{CREASE_PRESETS, CreasePreset, GROWTH_PRESETS, GrowthPreset};

use crate::arguments::{Arguments, HelpArguments, Topic};
use crate::messages;
use crate::outcome::Outcome;

/// Columns of a line of text.
const COLUMNS: usize = 96;

/// A short scene with what most scenes have.
const EXAMPLE: &str = r#"version = 1

[driver]
mesh = "face.glb"             # beside this file; with blend shapes

[[layers]]
name = "skin"
preset = "forehead-furrow"    # `ruga help presets` lists them

[[poses]]                     # left out: a pose for every blend shape
name = "frown"
weights = { browDown_L = 1.0, browDown_R = 1.0 }

[bake]
size = 2048
"#;

/// Prints what was asked for, on stdout.
pub(crate) fn run(arguments: &HelpArguments) -> Outcome {
    messages::result(&match arguments.topic {
        None => of_command(None),
        Some(Topic::Scene) => scene_page(),
        Some(Topic::Presets) => presets_page(),
        Some(command) => of_command(Some(command)),
    });
    Outcome::Done
}

/// Text that `ruga --help`, or `--help` of one of its commands, prints.
fn of_command(topic: Option<Topic>) -> String {
    let topic = topic.and_then(|topic| topic.to_possible_value());
    let mut words = vec!["ruga"];
    words.extend(topic.as_ref().map(|value| value.get_name()));
    words.push("--help");
    // Clap gives help as what keeps it from parsing the rest.
    match Arguments::try_parse_from(words) {
        Err(help) => help.to_string(),
        Ok(_) => String::new(),
    }
}

/// Every table and key of a scene, as Markdown that reads well in a terminal, too.
fn scene_page() -> String {
    let mut page = format!(
        "# Scenes\n\nA scene is a TOML file, version 1, such as:\n\n```toml\n{EXAMPLE}```\n\n\
         Every key, with the kind of its value and its default:\n"
    );
    for table in reference() {
        write_table(&mut page, &table);
    }
    page
}

fn write_table(page: &mut String, table: &Table) {
    let title = match table.path {
        "" => "The top of the file".to_owned(),
        _ => format!("`{}`", table.header),
    };
    let _ = write!(page, "\n## {title}\n\n");
    wrap(page, "", "", &table.about);
    page.push('\n');
    for key in &table.keys {
        wrap(
            page,
            "- ",
            "  ",
            &format!("`{}` ({}): {}", key.name, facts(key), key.about),
        );
        for (word, about) in &key.choices {
            wrap(page, "  - ", "    ", &format!("`\"{word}\"`: {about}"));
        }
    }
}

/// Kind and default of a key.
fn facts(key: &Key) -> String {
    match (&key.default, key.is_required) {
        (_, true) => format!("{}, needed", key.kind),
        (Some(default), false) => format!("{}, default `{default}`", key.kind),
        (None, false) => format!("{}, optional", key.kind),
    }
}

/// Every preset with what it does and what it is made of.
fn presets_page() -> String {
    let mut page = String::new();
    page.push_str("# Presets\n\n");
    wrap(
        &mut page,
        "",
        "",
        "`preset = \"NAME\"` in `[[layers]]` takes a layer of skin and, unless the scene has its own \
         `[substrate]`, what carries it. The values are nominal: chosen so that wavelength and \
         critical strain look right, not measured. Wavelength and critical strain are those of a \
         flat, evenly compressed skin.",
    );
    for preset in &PRESETS {
        write_preset(&mut page, preset);
    }
    page.push_str("\n# Presets of creases\n\n");
    wrap(
        &mut page,
        "",
        "",
        "`preset = \"NAME\"` in `[[creases]]` fills in what is left out. The values are nominal, too.",
    );
    for preset in &CREASE_PRESETS {
        write_crease(&mut page, preset);
    }
    page.push_str("\n# Presets of growths\n\n");
    wrap(
        &mut page,
        "",
        "",
        "`preset = \"NAME\"` in `[[growths]]` fills in what is left out. The amounts are chosen so that maps look \
         right.",
    );
    for preset in &GROWTH_PRESETS {
        write_growth(&mut page, preset);
    }
    page
}

fn write_growth(page: &mut String, preset: &GrowthPreset) {
    let _ = write!(page, "\n## `{}`\n\n", preset.name);
    wrap(page, "", "", &format!("{}.", preset.description));
    let layer = match preset.is_below {
        true => "`layer = \"substrate\"`",
        false => "the first layer",
    };
    let _ = writeln!(
        page,
        "\n- {layer}, `along = {}`, `across = {}`",
        preset.along, preset.across
    );
}

fn write_crease(page: &mut String, preset: &CreasePreset) {
    let _ = write!(page, "\n## `{}`\n\n", preset.name);
    wrap(page, "", "", &format!("{}.", preset.description));
    page.push('\n');
    let _ = writeln!(
        page,
        "- `width = {:e}`, `stiffness = {}`, `angle = {}`",
        preset.width, preset.stiffness, preset.angle
    );
    if let Some(depth) = preset.depth {
        let _ = writeln!(page, "- `anchor = {{ depth = {depth:e} }}`");
    }
}

fn write_preset(page: &mut String, preset: &Preset) {
    let _ = write!(page, "\n## `{}`\n\n", preset.name);
    wrap(page, "", "", &format!("{}.", preset.description));
    page.push('\n');
    let (layer, below) = (&preset.layer, &preset.substrate);
    if let Ok(wave) = wrinkling(layer, below, WavelengthModel::default()) {
        let _ = writeln!(
            page,
            "- wrinkles: {:.2} mm long, from {:.1} % compression on",
            1e3 * wave.wavelength,
            100.0 * wave.critical_strain
        );
    }
    let _ = writeln!(
        page,
        "- layer: `young = {:e}`, `thickness = {:e}`, `poisson = {}`, `density = {}`",
        layer.young, layer.thickness, layer.poisson, layer.density
    );
    let _ = writeln!(
        page,
        "- substrate: `young = {:e}`, `thickness = {:e}`, `poisson = {}`",
        below.young, below.thickness, below.poisson
    );
    if let Some(Variation { spread, scale }) = preset.variation {
        let _ = writeln!(
            page,
            "- uneven: `variation = {spread}`, `variation_scale = {scale}`"
        );
    }
}

/// Adds a paragraph, its first line after `first` and the others after `others`.
fn wrap(page: &mut String, first: &str, others: &str, text: &str) {
    let mut line = first.to_owned();
    let mut is_empty = true;
    for word in text.split(' ') {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > COLUMNS {
            page.push_str(&line);
            page.push('\n');
            line = others.to_owned();
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(word);
        is_empty = false;
    }
    page.push_str(&line);
    page.push('\n');
}
