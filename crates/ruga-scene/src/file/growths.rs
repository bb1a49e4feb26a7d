//! `[[growths]]`: layers whose rest lengths change, as skin does that ages or dries.

use std::path::PathBuf;

use ruga_blend::nearest;
use ruga_stepper::GROWTH_RANGE;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::{Checked, Fault, fault, unique_name};
use super::{Ply, SceneFile, Stack};
use crate::growth_presets::{GROWTH_PRESETS, growth_preset};

/// What a growth may name in place of a layer.
pub(crate) const SUBSTRATE: &str = "substrate";

/// Largest strength of a growth in a pose, as of a blend shape's weight.
const STRONGEST: f64 = 10.0;

/// Changes of length of what lies below, at which layers are from 0.6 shorter than it to twice as long.
const BELOW: std::ops::RangeInclusive<f64> = -0.5..=1.5;

/// One of `[[growths]]`: a change of the size that a layer would have by itself, which poses switch on like a blend
/// shape, by `growths` with a strength from -10 to 10. What carries the layer keeps the shape of the posed mesh, so
/// that a layer that grows is squeezed and wrinkles, and one that shrinks is stretched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Growth {
    /// Its name in poses and messages.
    pub name: String,
    /// What changes its size: the name of a layer, or `"substrate"` for all that lies below the layers: where that
    /// shrinks, every layer is squeezed. If left out, what the preset is for, and without one the first layer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer: Option<String>,
    /// The one of the layer's `plies` that changes its size; all of them alike if left out. The others hold it back, and
    /// the sheet bends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ply: Option<String>,
    /// `"ageing"` or `"drying"`: the layer, `along` and `across` of such a change; `ruga help presets` lists them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Change of length at strength 1, from -0.6 to 1: 0.05 makes the layer 5 % longer, -0.05 shorter. Needed
    /// without a preset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<f64>,
    /// The same across the direction of `along`; equal to it if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub across: Option<f64>,
    /// Curvature of a `[sheet]` along that direction and across it at strength 1, 1/m: 50 makes an arc of 20 mm
    /// radius, positive where the outer side bulges.
    #[serde(default, skip_serializing_if = "is_flat")]
    pub curl: [f64; 2],
    /// Direction of `along` in the texture, degrees counter-clockwise from its right.
    #[serde(default)]
    pub direction: f64,
    /// Image of the direction in place of one number: red is its part to the right and green its part up, from
    /// -1 (black) to 1 (white), as in anisotropy textures of glTF.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_image: Option<PathBuf>,
    /// Grey image over the UV square that says how much of it there is where.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<PathBuf>,
    /// Shares of it where `image` is black and where it is white, from -1 to 1.
    #[serde(default = "none_to_all")]
    pub range: [f64; 2],
}

fn is_flat(curl: &[f64; 2]) -> bool {
    *curl == [0.0; 2]
}

fn none_to_all() -> [f64; 2] {
    [0.0, 1.0]
}

impl Growth {
    /// Changes of length along its direction and across it, those of a preset filled in.
    pub(crate) fn changes(&self) -> [f64; 2] {
        let preset = self.preset.as_deref().and_then(growth_preset);
        let along = self.along.or(preset.map(|preset| preset.along));
        let along = along.unwrap_or_default();
        // A preset's own ratio holds only with its own length.
        let of_preset = preset.filter(|_| self.along.is_none());
        let across = self.across.or(of_preset.map(|preset| preset.across));
        [along, across.unwrap_or(along)]
    }

    fn faults(&self, key: &str) -> Checked {
        if let Some(name) = &self.preset
            && growth_preset(name).is_none()
        {
            let names = || GROWTH_PRESETS.iter().map(|preset| preset.name);
            let listed: Vec<String> = names().map(|name| format!("\"{name}\"")).collect();
            return Err(Fault {
                key: format!("{key}.preset"),
                reason: format!("found \"{name}\"; accepted: {}", listed.join(", ")),
                suggestion: nearest(name, names()),
            });
        }
        if self.along.is_none() && self.preset.is_none() && self.curl == [0.0; 2] {
            let accepted = "a change of length, such as `along = 0.05`, or a `preset`";
            return fault(&format!("{key}.along"), "nothing", accepted);
        }
        let [least, most] = GROWTH_RANGE;
        for (name, change) in ["along", "across"].into_iter().zip(self.changes()) {
            if !(least..=most).contains(&change) {
                let accepted = format!("from {least} to {most}; 0.05 makes it 5 % longer");
                return fault(&format!("{key}.{name}"), change, &accepted);
            }
        }
        if !self.curl.iter().all(|curl| curl.is_finite()) {
            return fault(
                &format!("{key}.curl"),
                format!("{:?}", self.curl),
                "two curvatures, 1/m",
            );
        }
        if !self.direction.is_finite() {
            let accepted = "degrees, counter-clockwise from the right of the texture";
            return fault(&format!("{key}.direction"), self.direction, accepted);
        }
        if self.direction != 0.0 && self.direction_image.is_some() {
            let found = format!("{} beside `direction_image`", self.direction);
            return fault(&format!("{key}.direction"), found, "one of the two");
        }
        let is_share = |share: &f64| (-1.0..=1.0).contains(share);
        if !self.range.iter().all(is_share) {
            let found = format!("{:?}", self.range);
            let accepted = "shares from -1 to 1 for black and white, such as `[0.0, 1.0]`";
            return fault(&format!("{key}.range"), found, accepted);
        }
        if self.range != none_to_all() && self.image.is_none() {
            let found = format!("{:?} without `image`", self.range);
            return fault(&format!("{key}.range"), found, "a range for an `image`");
        }
        Ok(())
    }
}

impl SceneFile {
    /// Number of the layer that a growth changes; `None` for what lies below all of them, and for a layer that is
    /// not there.
    pub(crate) fn grown_layer(&self, growth: &Growth) -> Option<usize> {
        let preset = growth.preset.as_deref().and_then(growth_preset);
        match (&growth.layer, preset) {
            (Some(name), _) => self.layers.iter().position(|layer| layer.name == *name),
            (None, Some(preset)) if preset.is_below => None,
            (None, _) => Some(0),
        }
    }

    pub(super) fn growth_faults(&self) -> Checked {
        if self.growths.is_empty() {
            return Ok(());
        }
        if self.driver.symmetry.is_some() {
            let accepted = "no `symmetry` with [[growths]], which may differ from side to side";
            return fault("driver.symmetry", "\"x\"", accepted);
        }
        if self.stack == Stack::Joint {
            let accepted = "\"nominal\" or \"composite\" with [[growths]]";
            return fault("stack", "\"joint\"", accepted);
        }
        for (i, growth) in self.growths.iter().enumerate() {
            let key = format!("growths[{i}]");
            growth.faults(&key)?;
            self.grown_layer_faults(&key, growth)?;
            if growth.curl != [0.0; 2] && self.sheet.is_none() {
                let accepted = "none without [sheet]: what carries a layer holds it flat";
                return fault(
                    &format!("{key}.curl"),
                    format!("{:?}", growth.curl),
                    accepted,
                );
            }
            self.ply_faults(&key, growth)?;
            let earlier = self.growths.iter().take(i).map(|other| &other.name);
            unique_name(&format!("{key}.name"), &growth.name, earlier)?;
        }
        Ok(())
    }

    fn grown_layer_faults(&self, key: &str, growth: &Growth) -> Checked {
        let key = format!("{key}.layer");
        let is_layer = |name: &str| self.layers.iter().any(|layer| layer.name == name);
        let is_below = match growth.layer.as_deref() {
            Some(SUBSTRATE) if is_layer(SUBSTRATE) => {
                let found = format!("\"{SUBSTRATE}\", which also is the name of a layer");
                return fault(&key, found, "it when that layer has another name");
            }
            Some(name) => name == SUBSTRATE,
            None => self.grown_layer(growth).is_none(),
        };
        if is_below && (self.interior.is_some() || self.sheet.is_some()) {
            let found = match growth.layer {
                Some(_) => format!("\"{SUBSTRATE}\""),
                None => format!("\"{SUBSTRATE}\", for which the preset is"),
            };
            let accepted = "a layer: a soft body keeps its size, and a sheet lies on nothing";
            return fault(&key, found, accepted);
        }
        let shrinks = |change: &f64| !BELOW.contains(change);
        if let Some(change) = growth
            .changes()
            .into_iter()
            .find(shrinks)
            .filter(|_| is_below)
        {
            let accepted = format!(
                "from {} to {} of what lies below",
                BELOW.start(),
                BELOW.end()
            );
            return fault(&key.replace(".layer", ".along"), change, &accepted);
        }
        let unknown = |name: &&String| !is_below && !is_layer(name);
        let Some(name) = growth.layer.as_ref().filter(unknown) else {
            return Ok(());
        };
        let names = || self.layers.iter().map(|layer| layer.name.as_str());
        let names = || names().chain([SUBSTRATE]);
        let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
        let listed = listed.join(", ");
        Err(Fault {
            key,
            reason: format!("there is no layer `{name}`; accepted: {listed}"),
            suggestion: nearest(name, names()),
        })
    }

    /// The plies of the layer that a growth changes; none of a layer that is no laminate.
    fn plies_of(&self, growth: &Growth) -> &[Ply] {
        let layer = self.grown_layer(growth).map(|layer| &self.layers[layer]);
        let plies = layer.and_then(|layer| layer.plies.as_deref());
        plies.unwrap_or_default()
    }

    /// Number of the ply that a growth changes, from the lowest one up; `None` for all of them, and for one that is
    /// not there.
    pub(crate) fn grown_ply(&self, growth: &Growth) -> Option<usize> {
        let name = growth.ply.as_ref()?;
        let mut plies = self.plies_of(growth).iter();
        plies.position(|ply| ply.name == *name)
    }

    fn ply_faults(&self, key: &str, growth: &Growth) -> Checked {
        let Some(name) = &growth.ply else {
            return Ok(());
        };
        if growth.curl != [0.0; 2] {
            let found = format!("{:?} beside `ply`", growth.curl);
            let accepted =
                "one of the two: how much a ply that grows bends the sheet follows from the plies";
            return fault(&format!("{key}.curl"), found, accepted);
        }
        if self.grown_ply(growth).is_some() {
            return Ok(());
        }
        let names = || self.plies_of(growth).iter().map(|ply| ply.name.as_str());
        let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
        let listed = match listed.is_empty() {
            true => "none, as the layer has no `plies`".to_owned(),
            false => listed.join(", "),
        };
        Err(Fault {
            key: format!("{key}.ply"),
            reason: format!("there is no ply `{name}`; accepted: {listed}"),
            suggestion: nearest(name, names()),
        })
    }

    /// Refuses growths of a pose that the scene does not have, and strengths that are no numbers.
    pub(super) fn pose_growth_faults(&self, key: &str, pose: &super::Pose) -> Checked {
        for (name, strength) in &pose.growths {
            let key = format!("{key}.growths.{name}");
            let names = || self.growths.iter().map(|growth| growth.name.as_str());
            if !names().any(|other| other == name) {
                let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
                let listed = match listed.is_empty() {
                    true => "none, as there are no [[growths]]".to_owned(),
                    false => listed.join(", "),
                };
                return Err(Fault {
                    key,
                    reason: format!("there is no growth `{name}`; accepted: {listed}"),
                    suggestion: nearest(name, names()),
                });
            }
            if !(-STRONGEST..=STRONGEST).contains(strength) {
                let accepted =
                    format!("a number from -{STRONGEST} to {STRONGEST}; 1 is the whole growth");
                return fault(&key, format!("{strength:?}"), &accepted);
            }
        }
        Ok(())
    }
}
