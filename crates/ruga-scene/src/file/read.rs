//! Text to scene and back, with errors that name file, key, value and remedy.

use std::path::{Path, PathBuf};

use super::array_lengths::Surplus;
use super::slips::{UnknownKey, duplicate};
use super::toml_words;
use super::{Region, SceneFile};
use crate::SceneError;
use ruga_blend::nearest;
use ruga_io::read_bytes;
use toml::de::DeTable;

impl SceneFile {
    /// Reads and checks a scene; its relative paths are resolved against the scene's folder.
    ///
    /// # Errors
    /// [`SceneError::Key`] naming the key, the value and what is accepted.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_bytes(path)?;
        if let Some(reason) = no_scene(path, &bytes) {
            return Err(scene_error(path, "", None, &reason, None));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let line = line_of(error.as_bytes(), error.utf8_error().valid_up_to());
            scene_error(path, "", Some(line), "is not UTF-8 text", None)
        })?;
        let mut scene = Self::from_toml(&text, path)?;
        scene.resolve_paths(path.parent().unwrap_or(Path::new("")));
        Ok(scene)
    }

    /// Parses and checks a scene without touching its paths; `path` is for messages.
    ///
    /// # Errors
    /// [`SceneError::Key`] naming the key, the value and what is accepted.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, SceneError> {
        let document =
            DeTable::parse(text).map_err(|error| toml_error(text, path, String::new(), &error))?;
        let deserializer = toml::Deserializer::from(document.clone());
        let scene: Self = serde_path_to_error::deserialize(deserializer).map_err(|error| {
            let key = match error.path().to_string() {
                dot if dot == "." => String::new(),
                key => key,
            };
            toml_error(text, path, key, error.inner())
        })?;
        if let Some(list) = Surplus::of(document.get_ref()) {
            let line = line_of(text.as_bytes(), list.span.start);
            let reason = list.reason();
            return Err(scene_error(path, &list.key, Some(line), &reason, None));
        }
        scene.validate(path)?;
        Ok(scene)
    }

    /// The scene as TOML text that [`SceneFile::from_toml`] reads back to an equal scene.
    pub fn to_toml(&self) -> String {
        toml::to_string(self)
            .expect("a scene is tables of numbers, strings and lists, which TOML can hold")
    }

    fn resolve_paths(&mut self, folder: &Path) {
        let resolve = |path: &mut PathBuf| *path = folder.join(&*path);
        resolve(&mut self.driver.mesh);
        self.driver.targets.values_mut().for_each(resolve);
        if let Region::Mask(mask) = &mut self.driver.region {
            resolve(mask);
        }
        for layer in &mut self.layers {
            layer.mask.iter_mut().for_each(resolve);
            let images = layer.map.iter_mut().flat_map(|map| {
                [
                    &mut map.image,
                    &mut map.wavelength_image,
                    &mut map.young_image,
                    &mut map.thickness_image,
                ]
            });
            images.flatten().for_each(resolve);
        }
        for crease in &mut self.creases {
            crease.image.iter_mut().for_each(resolve);
        }
        for growth in &mut self.growths {
            let images = [&mut growth.image, &mut growth.direction_image];
            images.into_iter().flatten().for_each(resolve);
        }
        if let Some(burn) = &mut self.burn {
            burn.ash_image.iter_mut().for_each(resolve);
            burn.map.iter_mut().for_each(|map| resolve(&mut map.image));
            let images = burn.sources.iter_mut().flat_map(|source| &mut source.image);
            images.for_each(resolve);
        }
        let network = self
            .memory
            .iter_mut()
            .flat_map(|memory| &mut memory.network);
        network.for_each(resolve);
    }
}

/// Says what a file is that is given in place of a scene by mistake.
fn no_scene(path: &Path, bytes: &[u8]) -> Option<String> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let is_mesh = matches!(extension.as_deref(), Some("glb" | "gltf" | "obj"));
    if is_mesh || bytes.starts_with(b"glTF") {
        let mesh = path.display();
        return Some(format!(
            "this is a mesh, not a scene; `ruga new --mesh {mesh} DIR` makes a scene for it"
        ));
    }
    if bytes.starts_with(b"\x89PNG") || bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Some("this is an image, not a scene; accepted: a TOML file".to_owned());
    }
    None
}

fn toml_error(text: &str, path: &Path, key: String, error: &toml::de::Error) -> SceneError {
    let line = error
        .span()
        .map(|span| line_of(text.as_bytes(), span.start));
    let message = error.message();
    if let Some(unknown) = UnknownKey::of(message, &key) {
        return scene_error(path, &key, line, &unknown.reason(), unknown.suggestion());
    }
    let whole_line = line.and_then(|line| text.lines().nth(line - 1));
    if let Some(reason) = toml_words::reason(message, &key, whole_line.unwrap_or_default()) {
        return scene_error(path, &key, line, &reason, suggestion_in(message));
    }
    if let Some(twice) = error.span().and_then(|span| duplicate(text, span, message)) {
        return scene_error(path, &key, line, &twice, None);
    }
    scene_error(path, &key, line, message, suggestion_in(message))
}

/// Serde writes ``unknown variant `x`, expected one of `a`, `b` ``: the names stand in backticks.
fn suggestion_in(message: &str) -> Option<String> {
    if !message.starts_with("unknown ") {
        return None;
    }
    let mut names = message.split('`').skip(1).step_by(2);
    let unknown = names.next()?;
    nearest(unknown, names)
}

fn line_of(text: &[u8], offset: usize) -> usize {
    1 + text.iter().take(offset).filter(|b| **b == b'\n').count()
}

pub(super) fn scene_error(
    path: &Path,
    key: &str,
    line: Option<usize>,
    reason: &str,
    suggestion: Option<String>,
) -> SceneError {
    SceneError::Key {
        path: path.to_owned(),
        key: key.to_owned(),
        line,
        reason: reason.trim_end().to_owned(),
        suggestion,
    }
}
