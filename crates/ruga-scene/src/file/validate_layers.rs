//! What `[substrate]` and `[[layers]]` must mean, beyond being well-formed.

use super::fault::{Checked, Fault, fault, names_given, of_hundred, positive, unique_name};
use super::names::same_file;
use super::{Layer, PropertyMap, SceneFile, Substrate};

/// Beyond this spread a good part of the skin would be less than half as thick as the rest.
const MOST_VARIATION: f64 = 0.5;

/// A relief several times as steep as the simulated one is no skin any more.
const MOST_STRENGTH: f64 = 4.0;

impl SceneFile {
    pub(super) fn layer_faults(&self) -> Checked {
        if self.layers.is_empty() {
            return fault("layers", "none", "at least one [[layers]] is needed");
        }
        if let Some(substrate) = &self.substrate {
            substrate.faults()?;
        }
        for (i, layer) in self.layers.iter().enumerate() {
            let key = format!("layers[{i}]");
            layer.faults(&key)?;
            if let (Some(plies), None) = (&layer.plies, &self.sheet) {
                let found = format!("{} of them", plies.len());
                let accepted = "none but with [sheet]: skin is one layer on another, as [[layers]]";
                return fault(&format!("{key}.plies"), found, accepted);
            }
            let earlier = self.layers.iter().take(i).map(|other| &other.name);
            unique_name(&format!("{key}.name"), &layer.name, earlier)?;
        }
        self.zone_faults()
    }

    /// Whether each layer has a place of its own among the others, and something below it.
    fn zone_faults(&self) -> Checked {
        self.zone_name_faults()?;
        let zones = self.zones();
        if let (Some(_), [_, _, ..]) = (&self.interior, zones.as_slice()) {
            let found = format!("{} zones", zones.len());
            return fault(
                "interior",
                found,
                "one zone on a lattice: its layers one on the other",
            );
        }
        for zone in &zones {
            let lowest = zone.layers[0];
            let layer = &self.layers[lowest];
            let whose = zone
                .name
                .map_or_else(String::new, |n| format!(" of zone `{n}`"));
            if self.substrate.is_none() && layer.preset.is_none() && self.sheet.is_none() {
                let accepted =
                    format!("a [substrate] table, unless the lowest layer{whose} is a preset");
                return fault("substrate", "none", &accepted);
            }
            if zones.len() > 1 && layer.mask.is_none() {
                let accepted = format!(
                    "a grey image that says where the lowest layer{whose} is, because there are \
                     {} zones side by side",
                    zones.len()
                );
                return fault(&format!("layers[{lowest}].mask"), "none", &accepted);
            }
        }
        Ok(())
    }

    fn zone_name_faults(&self) -> Checked {
        let names = || self.layers.iter().filter_map(|layer| layer.zone.as_ref());
        for (i, layer) in self.layers.iter().enumerate() {
            let key = format!("layers[{i}].zone");
            let Some(name) = &layer.zone else {
                let Some(other) = names().next() else {
                    continue;
                };
                let accepted =
                    format!("a zone for every layer or for none; another layer names `{other}`");
                return fault(&key, "none", &accepted);
            };
            if name.trim().is_empty() {
                return fault(&key, format!("`{name}`"), "a name, such as \"forehead\"");
            }
            if let Some(other) = names().find(|other| same_file(other, name) && *other != name) {
                let accepted = "zones that differ in more than letter case";
                return fault(&key, format!("`{other}` and `{name}`"), accepted);
            }
        }
        Ok(())
    }
}

impl Substrate {
    fn faults(&self) -> Checked {
        let numbers = [
            ("substrate.young", self.young),
            ("substrate.thickness", self.thickness),
        ];
        for (key, value) in numbers {
            value.map_or(Ok(()), |value| positive(key, value))?;
        }
        let given = self.young.or(self.poisson).or(self.thickness);
        if let (Some(preset), Some(_)) = (&self.preset, given) {
            return fault("substrate", preset, "either a preset or numbers, not both");
        }
        self.poisson
            .map_or(Ok(()), |nu| poisson("substrate.poisson", nu))
    }
}

impl Layer {
    fn faults(&self, key: &str) -> Checked {
        let numbers = [
            ("young", self.young),
            ("thickness", self.thickness),
            ("wavelength", self.wavelength),
            ("density", Some(self.density)),
        ];
        for (name, value) in numbers {
            value.map_or(Ok(()), |value| positive(&format!("{key}.{name}"), value))?;
        }
        if let Some(strain) = self.critical_strain.filter(|e| !(*e > 0.0 && *e < 1.0)) {
            return Err(Fault {
                key: format!("{key}.critical_strain"),
                reason: format!(
                    "found {strain}; accepted: a compression above 0 and below 1, such as 0.05 for 5 %"
                ),
                suggestion: of_hundred(strain),
            });
        }
        poisson(&format!("{key}.poisson"), self.poisson)?;
        if let Some(share) = self.bending_transfer.filter(|b| !(0.0..=1.0).contains(b)) {
            let accepted = "a share from 0 to 1";
            return fault(&format!("{key}.bending_transfer"), share, accepted);
        }
        self.definition_fault(key)?;
        self.ply_faults(key)?;
        self.relief_faults(key)?;
        self.map
            .as_ref()
            .map_or(Ok(()), |map| map.faults(&format!("{key}.map")))
    }

    fn relief_faults(&self, key: &str) -> Checked {
        let strength = self.strength;
        if !(strength > 0.0 && strength <= MOST_STRENGTH) {
            let accepted = format!(
                "a number above 0, up to {MOST_STRENGTH}; 1 is the relief as simulated, and a layer \
                 that shall not show is left out"
            );
            return fault(&format!("{key}.strength"), strength, &accepted);
        }
        if let Some(spread) = (self.variation).filter(|v| !(0.0..=MOST_VARIATION).contains(v)) {
            let accepted = format!(
                "a relative spread of thickness from 0 to {MOST_VARIATION}; 0.2 is that of faces"
            );
            return fault(&format!("{key}.variation"), spread, &accepted);
        }
        let size = self.variation_scale;
        if !(0.1..=10.0).contains(&size) {
            let accepted = "a size from 0.1 to 10 wavelengths";
            return fault(&format!("{key}.variation_scale"), size, accepted);
        }
        Ok(())
    }

    fn definition_fault(&self, key: &str) -> Checked {
        if self.definition().is_some() {
            return Ok(());
        }
        let given = [
            ("preset", self.preset.is_some()),
            ("young", self.young.is_some()),
            ("thickness", self.thickness.is_some()),
            ("wavelength", self.wavelength.is_some()),
            ("critical_strain", self.critical_strain.is_some()),
        ];
        if self.plies.is_some() {
            let accepted = "`plies` alone: each ply has its own `young` and `thickness`";
            let found = format!("{} beside it", names_given(&given));
            return fault(&format!("{key}.plies"), found, accepted);
        }
        let accepted = "either young and thickness, or wavelength and critical_strain, or preset";
        fault(key, names_given(&given), accepted)
    }

    fn ply_faults(&self, key: &str) -> Checked {
        let Some(plies) = &self.plies else {
            return Ok(());
        };
        if plies.is_empty() {
            let accepted = "at least one, as `{ name = \"upper\", young = 3e9, thickness = 5e-5 }`";
            return fault(&format!("{key}.plies"), "an empty list", accepted);
        }
        for (i, ply) in plies.iter().enumerate() {
            let key = format!("{key}.plies[{i}]");
            positive(&format!("{key}.young"), ply.young)?;
            positive(&format!("{key}.thickness"), ply.thickness)?;
            let density = ply.density;
            density.map_or(Ok(()), |value| positive(&format!("{key}.density"), value))?;
            let earlier = plies.iter().take(i).map(|other| &other.name);
            unique_name(&format!("{key}.name"), &ply.name, earlier)?;
        }
        Ok(())
    }
}

impl PropertyMap {
    fn faults(&self, key: &str) -> Checked {
        let properties = [
            ("wavelength", self.wavelength, &self.wavelength_image),
            ("young", self.young, &self.young_image),
            ("thickness", self.thickness, &self.thickness_image),
        ];
        for (name, range, image) in properties {
            let key = format!("{key}.{name}");
            if let Some([low, high]) = range {
                positive(&format!("{key}[0]"), low)?;
                positive(&format!("{key}[1]"), high)?;
            }
            match (range, image, &self.image) {
                (_, Some(own), Some(_)) => {
                    let accepted = "either `image` or one image per property, not both";
                    return fault(&format!("{key}_image"), own.display(), accepted);
                }
                (None, Some(own), None) => {
                    let accepted = format!("a range `{name} = [lo, hi]` beside it");
                    return fault(&format!("{key}_image"), own.display(), &accepted);
                }
                (Some(_), None, None) => {
                    let accepted = format!("`image` or `{name}_image` beside the range");
                    return fault(&key, "no image", &accepted);
                }
                _ => {}
            }
        }
        if properties.iter().all(|(_, range, _)| range.is_none()) {
            let accepted = "at least one range, such as `young = [0.5, 2.0]`";
            return fault(key, "no range", accepted);
        }
        Ok(())
    }
}

fn poisson(key: &str, value: f64) -> Checked {
    if value > -1.0 && value < 0.5 {
        return Ok(());
    }
    fault(key, value, "a number above -1 and below 0.5, such as 0.48")
}
