//! Which layers lie on each other, and which side by side.

use super::SceneFile;

/// Layers that lie on each other in one part of the skin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Zone<'a> {
    /// Its name; `None` when the scene names no zones.
    pub name: Option<&'a str>,
    /// Its layers as numbers into [`SceneFile::layers`], bottom first; at least one.
    pub layers: Vec<usize>,
}

impl SceneFile {
    /// The zones in the order of their lowest layers; a scene that names none is one zone.
    pub fn zones(&self) -> Vec<Zone<'_>> {
        let mut zones: Vec<Zone<'_>> = Vec::new();
        for (index, layer) in self.layers.iter().enumerate() {
            let name = layer.zone.as_deref();
            match zones.iter_mut().find(|zone| zone.name == name) {
                Some(zone) => zone.layers.push(index),
                None => zones.push(Zone {
                    name,
                    layers: vec![index],
                }),
            }
        }
        zones
    }
}
