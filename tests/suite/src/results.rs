//! What a run leaves in its folder: whole files, finite numbers, and maps that can be decoded.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use ruga_io::{ObjOptions, read_image, read_mesh};
use ruga_scene::file::Bake;
use serde_json::Value;

/// Numbers of a layer's report that are always there: `null` would be one that is not finite.
const ALWAYS: [&str; 5] = [
    "wavelength_predicted_m",
    "critical_strain_predicted",
    "amplitude_m",
    "energy_j",
    "residual",
];

/// Checks every file of a folder; says which is not as it should be.
pub(super) fn check_results(folder: &Path, bake: &Bake) -> Result<(), String> {
    let files = raw_contents(folder);
    let mesh = mesh_of_maps(&files);
    for (name, bytes) in &files {
        let path = folder.join(name);
        let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
        match extension.as_deref() {
            Some("json") => check_json(name, bytes)?,
            Some("png" | "exr") => check_map(&path, name, bake)?,
            Some("glb") => {
                read_mesh(&path, mesh.as_deref(), &ObjOptions::default())
                    .map_err(|e| format!("{name}: {e}"))?;
            }
            Some("obj") => check_obj(name, bytes)?,
            Some("html") if name == "preview.html" => check_page(bytes)?,
            // The lock of the folder stays, so that two runs can never lock two files of that name.
            None if name == "poses/.lock" => {}
            _ => return Err(format!("{name} is left behind")),
        }
    }
    let report = files.get("report.json").ok_or("there is no report.json")?;
    let report: Value = serde_json::from_slice(report).map_err(|e| e.to_string())?;
    for pose in report["poses"].as_array().into_iter().flatten() {
        check_pose(pose)?;
        let maps = pose["maps"].as_object().into_iter().flatten();
        for (_, file) in maps {
            let file = file.as_str().unwrap_or_default();
            if !files.contains_key(file) {
                return Err(format!("report.json names {file}, which is not there"));
            }
        }
    }
    Ok(())
}

/// The mesh that `wrinkles.json` is about, where there is one: a GLB may hold others.
fn mesh_of_maps(files: &BTreeMap<String, Vec<u8>>) -> Option<String> {
    let manifest: Value = serde_json::from_slice(files.get("wrinkles.json")?).ok()?;
    manifest["mesh"].as_str().map(str::to_owned)
}

fn check_page(bytes: &[u8]) -> Result<(), String> {
    let is_whole = bytes.starts_with(b"<!doctype html>") && bytes.ends_with(b"</html>\n");
    match is_whole {
        true => Ok(()),
        false => Err("preview.html is not whole".to_owned()),
    }
}

fn check_json(name: &str, bytes: &[u8]) -> Result<(), String> {
    let value: Value = serde_json::from_slice(bytes).map_err(|e| format!("{name}: {e}"))?;
    match value.is_object() {
        true => Ok(()),
        false => Err(format!("{name} is no object")),
    }
}

fn check_pose(pose: &Value) -> Result<(), String> {
    for layer in pose["layers"].as_array().into_iter().flatten() {
        if let Some(key) = ALWAYS.iter().find(|key| layer[**key].as_f64().is_none()) {
            return Err(format!(
                "report.json: {key} is {} in {}",
                layer[*key], pose["name"]
            ));
        }
        let seconds = layer["seconds"].as_object().into_iter().flatten();
        for (key, value) in seconds {
            if value.as_f64().is_some_and(|s| s < 0.0) {
                return Err(format!("report.json: seconds.{key} is {value}"));
            }
        }
    }
    Ok(())
}

fn check_map(path: &Path, name: &str, bake: &Bake) -> Result<(), String> {
    let image = read_image(path).map_err(|error| format!("{name}: {error}"))?;
    let side = bake.size as usize;
    let channels = if name.contains("_normal") { 3 } else { 1 };
    if [image.width, image.height, image.channels] != [side, side, channels] {
        return Err(format!(
            "{name} is {} x {} x {}",
            image.width, image.height, image.channels
        ));
    }
    if channels == 1 {
        return Ok(());
    }
    let signed = |c: f32| {
        if name.ends_with("png") {
            2.0 * c - 1.0
        } else {
            c
        }
    };
    for texel in image.values.chunks_exact(3) {
        let [x, y, z] = [0, 1, 2].map(|i| signed(texel[i]));
        let length = (x * x + y * y + z * z).sqrt();
        if (length - 1.0).abs() > 0.02 || z < -0.01 {
            return Err(format!("{name} has the normal ({x}, {y}, {z})"));
        }
    }
    Ok(())
}

fn check_obj(name: &str, bytes: &[u8]) -> Result<(), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| format!("{name} is no text"))?;
    for line in text.lines().filter(|line| line.starts_with('v')) {
        let numbers = line.split(' ').skip(1).map(str::parse::<f64>);
        if !numbers
            .into_iter()
            .all(|number| number.is_ok_and(f64::is_finite))
        {
            return Err(format!("{name} has the line `{line}`"));
        }
    }
    Ok(())
}

/// Every file below a folder by its relative name, times left out: what two runs have in common.
pub(super) fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = raw_contents(folder);
    for (name, bytes) in &mut files {
        if name.ends_with(".json")
            && let Ok(mut value) = serde_json::from_slice::<Value>(bytes)
        {
            forget_seconds(&mut value);
            *bytes = value.to_string().into_bytes();
        }
    }
    files
}

fn forget_seconds(value: &mut Value) {
    match value {
        Value::Object(entries) => {
            entries.remove("seconds");
            entries.values_mut().for_each(forget_seconds);
        }
        Value::Array(items) => items.iter_mut().for_each(forget_seconds),
        _ => {}
    }
}

fn raw_contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn walk(folder: &Path, prefix: &str, files: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                walk(&entry.path(), &format!("{name}/"), files);
            } else if let Ok(bytes) = fs::read(entry.path()) {
                files.insert(name, bytes);
            }
        }
    }
    let mut files = BTreeMap::new();
    walk(folder, "", &mut files);
    files
}
