//! `[pack]`: all poses in a few maps, for engines that blend them by masks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::{Checked, fault, within};
use super::names::file_name_fault;

/// `[pack]`: the last key of every pose, packed into a few maps that poses share where they do not
/// overlap, with a mask for each pose; written to `packed/` beside the maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Pack {
    /// Largest number of maps of each kind, 1 to 1000. Poses that overlap take different maps.
    pub maps: u32,
    /// Names that the engine knows poses by; left out, those of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub names: Option<PoseNames>,
    /// File names, without extension: `{mesh}` is the mesh, `{map}` the number of the map from 1,
    /// `{kind}` the kind of map or `mask1` and so on, `{y}` is `gl` where green points up and `dx`
    /// where it points down, and vanishes with the `_` before it where there is no green.
    pub pattern: String,
}

impl Default for Pack {
    fn default() -> Self {
        Self {
            maps: 3,
            names: None,
            pattern: "{mesh}_wm{map}_{kind}_{y}".to_owned(),
        }
    }
}

/// Names that engines know poses by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PoseNames {
    /// The 52 blend shapes of ARKit, such as `browDownLeft`.
    Arkit,
    /// Regions of MetaHuman's wrinkle maps, such as `head_wm1_browsRaiseInner_L`;
    /// a pose of both sides is none and keeps its name.
    Metahuman,
    /// Expressions of VRM 1.0, such as `blinkLeft`.
    Vrm,
}

impl Pack {
    pub(super) fn faults(&self) -> Checked {
        within("pack.maps", u64::from(self.maps), 1, 1000)?;
        let key = "pack.pattern";
        let found = format!("`{}`", self.pattern);
        let mut plain = self.pattern.clone();
        for word in ["{mesh}", "{map}", "{kind}", "{y}"] {
            plain = plain.replace(word, "x");
        }
        if plain.contains(['{', '}']) {
            return fault(key, found, "{mesh}, {map}, {kind} and {y} in braces");
        }
        if let Some(reason) = file_name_fault(&plain) {
            let accepted = format!("a pattern of file names, but {reason}");
            return fault(key, found, &accepted);
        }
        for (word, of) in [("{map}", "maps"), ("{kind}", "kinds")] {
            if !self.pattern.contains(word) {
                let accepted =
                    format!("a pattern with {word}, without which {of} would have one name");
                return fault(key, found, &accepted);
            }
        }
        Ok(())
    }

    /// File name, without extension, of the images of a kind; `y` is `gl`, `dx` or nothing.
    pub fn file_name(&self, mesh: &str, map: usize, kind: &str, y: Option<&str>) -> String {
        let pattern = match y {
            Some(y) => self.pattern.replace("{y}", y),
            None => self.pattern.replace("_{y}", "").replace("{y}", ""),
        };
        pattern
            .replace("{map}", &(map + 1).to_string())
            .replace("{kind}", kind)
            .replace("{mesh}", mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_name_every_image_once() {
        let pack = Pack::default();
        assert!(pack.faults().is_ok());
        let name = |kind, y| pack.file_name("Face", 1, kind, y);
        assert_eq!(name("normal", Some("dx")), "Face_wm2_normal_dx");
        assert_eq!(name("height", None), "Face_wm2_height");
        for (pattern, wanted) in [
            ("{mesh}_{kind}", "without which maps"),
            ("{mesh}_{map}", "without which kinds"),
            ("{map}{kind}{side}", "in braces"),
            ("a/{map}{kind}", "it has one of /"),
        ] {
            let pack = Pack {
                pattern: pattern.to_owned(),
                ..Pack::default()
            };
            let fault = pack.faults().expect_err(pattern);
            assert!(fault.reason.contains(wanted), "{}", fault.reason);
        }
    }
}
