//! What `[[creases]]` must mean, beyond being well-formed.

use ruga_blend::nearest;
use ruga_stepper::CreaseAnchor;

use super::fault::{
    Checked, Fault, fault, names_given, not_negative, positive, shortly, unique_name,
};
use super::validate::has_extension;
use super::{Anchor, Crease, Drive, SceneFile, Stack};
use crate::crease_presets::{CREASE_PRESETS, crease_preset};

/// Angle of a fold beyond which its sides touch, degrees.
const LARGEST_ANGLE: f64 = 150.0;

/// Largest texture coordinate: beyond, those of a mesh, which have seven digits, are whole texels apart.
const FARTHEST_UV: f64 = 1e6;

/// Least share of the bending stiffness: a hinge without friction.
const LEAST_STIFFNESS: f64 = 1e-6;

impl SceneFile {
    pub(super) fn crease_faults(&self) -> Checked {
        if self.creases.is_empty() {
            return Ok(());
        }
        let anchored = |(_, crease): &(usize, &Crease)| crease.anchor.is_some();
        let anchors = self.creases.iter().enumerate().find(anchored);
        if let Some((number, _)) = anchors.filter(|_| self.sheet.is_some()) {
            let accepted = "no anchor with [sheet], where nothing below holds it";
            return fault(&format!("creases[{number}].anchor"), "one", accepted);
        }
        let slit = |crease: &Crease| crease.slit.is_some();
        if let Some(number) = self.creases.iter().position(slit)
            && self.interior.is_none()
        {
            let accepted = "no slit without [interior], whose flesh it cuts";
            return fault(&format!("creases[{number}].slit"), "one", accepted);
        }
        let absorbs = self.creases.iter().position(|crease| crease.absorb);
        if let Some(number) = absorbs.filter(|_| self.sheet.is_some() || self.interior.is_some()) {
            let accepted = "no `absorb` with [sheet] or [interior]: only blend shapes say how far skin is compressed";
            return fault(&format!("creases[{number}].absorb"), "true", accepted);
        }
        if self.driver.symmetry.is_some() {
            let accepted = "no `symmetry` with [[creases]], which may differ from side to side";
            return fault("driver.symmetry", "\"x\"", accepted);
        }
        for (i, crease) in self.creases.iter().enumerate() {
            let key = format!("creases[{i}]");
            crease.faults(&key)?;
            self.vertex_faults(&key, crease)?;
            self.crease_layer_faults(&key, crease)?;
            let earlier = self.creases.iter().take(i).map(|other| &other.name);
            unique_name(&format!("{key}.name"), &crease.name, earlier)?;
        }
        Ok(())
    }

    /// Number of the layer that a crease folds, if there is one of that name.
    pub(crate) fn layer_of(&self, crease: &Crease) -> Option<usize> {
        let Some(name) = &crease.layer else {
            return Some(0);
        };
        self.layers.iter().position(|layer| layer.name == *name)
    }

    /// Number of the lowest layer of the zone that a layer is in.
    fn lowest_below(&self, layer: usize) -> usize {
        let zones = self.zones();
        let zone = zones.iter().find(|zone| zone.layers.contains(&layer));
        zone.map_or(layer, |zone| zone.layers[0])
    }

    /// Whether a layer lies on no other one.
    pub(crate) fn is_lowest(&self, layer: usize) -> bool {
        self.lowest_below(layer) == layer
    }

    /// Vertices of OBJ files are numbered anew when they are read.
    fn vertex_faults(&self, key: &str, crease: &Crease) -> Checked {
        if crease.edges.is_empty() || !has_extension(&self.driver.mesh, "obj") {
            return Ok(());
        }
        let accepted = "only with glTF meshes, whose vertices keep their numbers; with an OBJ draw the line as \
                        an object of lines, and give its name as `line_mesh`";
        fault(&format!("{key}.edges"), "an OBJ mesh", accepted)
    }

    fn crease_layer_faults(&self, key: &str, crease: &Crease) -> Checked {
        let key = format!("{key}.layer");
        let Some(layer) = self.layer_of(crease) else {
            let name = crease.layer.as_deref().unwrap_or_default();
            let names = || self.layers.iter().map(|layer| layer.name.as_str());
            let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
            return Err(Fault {
                key,
                reason: format!(
                    "there is no layer `{name}`; accepted: {}",
                    listed.join(", ")
                ),
                suggestion: nearest(name, names()),
            });
        };
        if !self.is_lowest(layer) {
            let lowest = self.lowest_below(layer);
            let found = format!("`{}`, which lies on another layer", self.layers[layer].name);
            let accepted = format!("`{}`, the lowest layer there", self.layers[lowest].name);
            return fault(&key, found, &accepted);
        }
        let mut zones = self.zones().into_iter();
        let carries = zones.any(|zone| zone.layers.len() > 1 && zone.layers[0] == layer);
        if carries && self.stack == Stack::Joint {
            let accepted =
                "\"nominal\" or \"composite\" with a crease in a layer that carries another";
            return fault("stack", "\"joint\"", accepted);
        }
        Ok(())
    }
}

impl Crease {
    fn faults(&self, key: &str) -> Checked {
        let sources = [
            ("uv", !self.uv.is_empty()),
            ("edges", !self.edges.is_empty()),
            ("line_mesh", self.line_mesh.is_some()),
            ("image", self.image.is_some()),
        ];
        if sources.iter().filter(|(_, given)| *given).count() != 1 {
            let accepted = "exactly one of uv, edges, line_mesh and image";
            return fault(key, names_given(&sources), accepted);
        }
        if self.closed && self.uv.is_empty() {
            let accepted = match (&self.image, &self.line_mesh) {
                (Some(_), _) => {
                    "only with `uv`; strokes of `image` close where they are painted closed"
                }
                (None, Some(_)) => {
                    "only with `uv`; lines of `line_mesh` close where they end where they began"
                }
                (None, None) => "only with `uv`; `edges` close by ending where they began",
            };
            return fault(&format!("{key}.closed"), "true", accepted);
        }
        self.point_faults(key)?;
        if let Some(name) = &self.preset
            && crease_preset(name).is_none()
        {
            let names = || CREASE_PRESETS.iter().map(|preset| preset.name);
            return Err(Fault {
                key: format!("{key}.preset"),
                reason: format!(
                    "there is no crease preset `{name}`; accepted: {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
                suggestion: nearest(name, names()),
            });
        }
        if let Some(reach) = self.reach {
            let key = format!("{key}.reach");
            positive(&key, reach)?;
            if self.line_mesh.is_none() {
                return fault(&key, reach, "only with `line_mesh`");
            }
        }
        if let Some(width) = self.width {
            positive(&format!("{key}.width"), width)?;
        }
        let is_share = |share: &f64| (LEAST_STIFFNESS..=1.0).contains(share);
        if let Some(share) = self.stiffness.filter(|share| !is_share(share)) {
            let accepted = "a share from 0.000001 to 1";
            return fault(&format!("{key}.stiffness"), shortly(share), accepted);
        }
        let is_angle = |angle: &f64| (0.0..=LARGEST_ANGLE).contains(angle);
        if let Some(angle) = self.angle.filter(|angle| !is_angle(angle)) {
            let accepted = "degrees from 0 to 150";
            return fault(&format!("{key}.angle"), shortly(angle), accepted);
        }
        for (i, fade) in self.fade.iter().flatten().enumerate() {
            not_negative(&format!("{key}.fade[{i}]"), *fade)?;
        }
        if let Some(Anchor { depth, stiffness }) = self.anchor {
            not_negative(&format!("{key}.anchor.depth"), depth)?;
            if !(stiffness > 0.0 && stiffness <= CreaseAnchor::MOST_STIFFNESS) {
                let accepted = "a number above 0, at most 100";
                return fault(
                    &format!("{key}.anchor.stiffness"),
                    shortly(stiffness),
                    accepted,
                );
            }
        }
        if let Some(depth) = self.slit {
            positive(&format!("{key}.slit"), depth)?;
        }
        self.drive_faults(key)
    }

    fn point_faults(&self, key: &str) -> Checked {
        let (least, accepted) = match self.closed {
            true => (3, "at least 3 points of a closed line"),
            false => (2, "at least 2 points"),
        };
        if !self.uv.is_empty() && self.uv.len() < least {
            let found = match self.uv.len() {
                1 => "1 point".to_owned(),
                count => format!("{count} points"),
            };
            return fault(&format!("{key}.uv"), found, accepted);
        }
        if self.edges.len() == 1 {
            let accepted = "at least 2 vertices, joined by an edge";
            return fault(&format!("{key}.edges"), "1 vertex", accepted);
        }
        let is_near = |uv: &[f64; 2]| uv.iter().all(|c| c.abs() <= FARTHEST_UV);
        match self.uv.iter().position(|uv| !is_near(uv)) {
            Some(i) => {
                let [u, v] = self.uv[i].map(shortly);
                let accepted = "two finite numbers from -1000000 to 1000000, a place on an island of the texture";
                fault(&format!("{key}.uv[{i}]"), format!("[{u}, {v}]"), accepted)
            }
            None => Ok(()),
        }
    }

    fn drive_faults(&self, key: &str) -> Checked {
        let by_weights = self.drive == Drive::Weights;
        if by_weights && self.weights.is_empty() {
            let accepted =
                "with drive = \"weights\" at least one blend shape, as { browDown = 1.0 }";
            return fault(&format!("{key}.weights"), "none", accepted);
        }
        if !by_weights && !self.weights.is_empty() {
            let accepted = "\"weights\", because `weights` are given; or leave them out";
            let found = match self.drive {
                Drive::Always => "\"always\"",
                Drive::Load | Drive::Weights => "\"load\"",
            };
            return fault(&format!("{key}.drive"), found, accepted);
        }
        let wrong = self.weights.iter().find(|(_, factor)| !factor.is_finite());
        match wrong {
            Some((shape, factor)) => {
                fault(&format!("{key}.weights.{shape}"), factor, "a finite number")
            }
            None => Ok(()),
        }
    }
}
