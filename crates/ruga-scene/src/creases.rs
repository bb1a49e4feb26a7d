//! The creases of a scene on its mesh.

use std::cell::OnceCell;
use std::path::Path;

use nalgebra::Vector3;
use ruga_blend::{Driver, nearest};
use ruga_crease::{CreaseMemory, LineLaw, LineTracer, TracedLine};
use ruga_io::MeshFile;
use ruga_material::{UvTile, Wrinkling, wrinkling};
use ruga_stepper::{CreaseAnchor, CreaseSpec, FoldSense, LayerSpec, SHEET_EDGES};

use crate::crease_lines::source_of;
use crate::crease_presets::{CreasePreset, crease_preset};
use crate::file::{Crease, Drive, Fold, SceneFile};
use crate::network_creases::NETWORK;
use crate::{SceneError, mesh_size};

/// Width in thicknesses of the layer, share of its stiffness and angle (degrees) of a crease that says
/// nothing of them.
const WIDTH: f64 = 1.0;
const STIFFNESS: f64 = 0.1;
const ANGLE: f64 = 15.0;

/// Stiffness of an anchor that a preset has.
const ANCHOR_STIFFNESS: f64 = 20.0;

/// Share of its strength that a line should have somewhere.
const LEAST_STRENGTH: f64 = 0.5;

/// Widths over which a crease fades towards its ends.
const FADE: f64 = 3.0;

/// The mesh that creases lie on, and the file that names them.
pub(crate) struct CreasedMesh<'a> {
    pub(crate) scene: &'a SceneFile,
    pub(crate) path: &'a Path,
    pub(crate) mesh: &'a MeshFile,
    pub(crate) driver: &'a Driver,
    pub(crate) tiles: &'a [UvTile],
    /// Made for the first line: finding places takes a search structure of the whole mesh.
    pub(crate) tracer: OnceCell<LineTracer<'a>>,
}

/// Adds the creases of a scene to its layers, whose meshes have `points` vertices per wavelength; returns
/// warnings.
///
/// # Errors
/// What is wrong with a line, its properties or its image, naming the key.
pub(crate) fn add_creases(
    on: &CreasedMesh<'_>,
    points: f64,
    layers: &mut [LayerSpec],
) -> Result<Vec<String>, SceneError> {
    let mut warnings = Vec::new();
    // Of each crease of each layer, the key that says where it lies.
    let mut keys = vec![Vec::new(); layers.len()];
    for (number, crease) in on.scene.creases.iter().enumerate() {
        let index = on.scene.layer_of(crease);
        let index = index.expect("a scene that was read has the layer");
        let layer = &layers[index];
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        let waves = waves.map_err(|source| SceneError::Material {
            scene: on.path.to_owned(),
            key: format!("creases[{number}]"),
            source,
        })?;
        let spec = on.kind((number, crease), layer)?;
        // A free sheet has no wave that a band could be too wide for.
        let carried = on.scene.sheet.is_none().then_some(&waves);
        warnings.extend(carried.and_then(|waves| band_warning(crease, &spec, waves)));
        warnings.extend(on.anchor_warning(crease));
        let wavelength = on.wavelength(&waves, points);
        let sizes = [wavelength, wavelength / points];
        let (lines, left_out) = on.lines((number, crease), sizes)?;
        warnings.extend(left_out);
        warnings.extend(fade_warning(crease, &spec.law, &lines));
        let joined = on.joined_ends(&lines, wavelength / points);
        let names = on.names((number, crease), lines.len(), layers)?;
        let key = source_of(crease);
        keys[index].resize(
            layers[index].creases.len() + lines.len(),
            format!("creases[{number}].{key}"),
        );
        let named = names.into_iter().zip(lines).zip(joined);
        layers[index]
            .creases
            .extend(named.map(|((name, line), joined)| {
                let mut spec = CreaseSpec {
                    name,
                    line,
                    ..spec.clone()
                };
                // A stroke that another one goes on does not fade there.
                for (fade, _) in spec.law.fade.iter_mut().zip(joined).filter(|end| end.1) {
                    *fade = 0.0;
                }
                spec
            }));
    }
    warnings.extend(on.add_network(layers)?);
    for (layer, keys) in layers.iter().zip(&mut keys) {
        keys.resize(layer.creases.len(), NETWORK.to_owned());
    }
    for (layer, keys) in layers.iter().zip(&keys) {
        if !layer.creases.is_empty() {
            warnings.extend(on.check_together((layer, keys), points)?);
        }
    }
    Ok(warnings)
}

/// Warning of a crease wider than it can stand for.
fn band_warning(crease: &Crease, spec: &CreaseSpec, waves: &Wrinkling) -> Option<String> {
    let bending_length = 1.0 / waves.wave_number;
    (spec.law.width > bending_length).then(|| {
        format!(
            "crease `{}`: a line {:.2} mm wide is a band beside folds that are {:.2} mm wide; paint it soft in the layer's `map`, or give it less `width`",
            crease.name,
            1e3 * spec.law.width,
            1e3 * bending_length
        )
    })
}

/// Warning of a crease that is faded out before it is faded in; of several lines about the weakest.
fn fade_warning(crease: &Crease, law: &LineLaw, lines: &[TracedLine]) -> Option<String> {
    let strongest = |line: &TracedLine| {
        let [start, end] = law.fade;
        let length = line.length();
        // Where both fades leave the same.
        let at = match start + end > 0.0 {
            true => length * start / (start + end),
            false => 0.5 * length,
        };
        law.taper(at, length, line.is_closed())
    };
    let weakest = lines.iter().map(|line| (strongest(line), line.length()));
    let (strength, length) = weakest.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (strength < LEAST_STRENGTH).then(|| {
        let [start, end] = law.fade.map(|fade| 1e3 * fade);
        format!(
            "crease `{}`: a line of {:.2} mm fades in over {start:.2} mm and out over {end:.2} mm and so \
             never has more than {:.0} % of its strength; shorten `fade`, or lengthen the line",
            crease.name,
            1e3 * length,
            100.0 * strength
        )
    })
}

/// Texels that a flank of a fold, a wavelength over pi, takes at least to be seen as one.
const LEAST_TEXELS: f64 = 4.0;

/// Warning of maps too small for the folds of a layer with so many `texels` to a wavelength, in maps of a `size`.
pub(crate) fn texel_warning(layer: &LayerSpec, texels: f64, size: u32) -> Option<String> {
    let flank = texels / std::f64::consts::PI;
    if layer.creases.is_empty() || flank.is_nan() || flank >= LEAST_TEXELS {
        return None;
    }
    let needed = f64::from(size) * LEAST_TEXELS / flank;
    let enough = (needed as u32).checked_next_power_of_two();
    Some(format!(
        "layer '{}': either side of a crease is {flank:.1} texels wide in the maps; {LEAST_TEXELS} show it, with `bake.size = {}`",
        layer.name,
        enough.unwrap_or(size)
    ))
}

impl CreasedMesh<'_> {
    /// Of every line, whether its start and its end are within a distance (m) of an end of another one.
    fn joined_ends(&self, lines: &[TracedLine], within: f64) -> Vec<[bool; 2]> {
        let (mesh, rest) = (self.driver.topology(), self.driver.rest());
        let ends = lines.iter().map(|line| {
            let ends = [0.0, line.length()].map(|at| line.place(at));
            ends.map(|place| place.map(|place| place.interpolate(mesh, rest)))
        });
        let ends: Vec<[Option<Vector3<f64>>; 2]> = ends.collect();
        let is_joined = |line: usize, end: &Option<Vector3<f64>>| {
            let others = ends.iter().enumerate().filter(|(i, _)| *i != line);
            let mut others = others.flat_map(|(_, ends)| ends.iter().flatten());
            end.is_some_and(|end| others.any(|other| (other - end).norm() < within))
        };
        let numbered = ends.iter().enumerate();
        numbered
            .map(|(line, own)| own.each_ref().map(|end| is_joined(line, end)))
            .collect()
    }

    pub(crate) fn fault(
        &self,
        key: String,
        reason: impl std::fmt::Display,
        suggestion: Option<String>,
    ) -> SceneError {
        SceneError::Key {
            path: self.path.to_owned(),
            key,
            line: None,
            reason: reason.to_string(),
            suggestion,
        }
    }

    /// Wavelength of a layer; of a free sheet the length of so many `points` edges.
    pub(crate) fn wavelength(&self, waves: &Wrinkling, points: f64) -> f64 {
        let of_sheet = self.scene.sheet.as_ref().map(|sheet| {
            let edge = sheet
                .edge
                .unwrap_or(mesh_size::width(self.mesh) / SHEET_EDGES);
            points * edge
        });
        of_sheet.unwrap_or(waves.wavelength)
    }

    /// Warning of a preset's anchor, which has nothing to hold to on a sheet or in a slit.
    fn anchor_warning(&self, crease: &Crease) -> Option<String> {
        let preset = crease.preset.as_deref().and_then(crease_preset)?;
        preset.depth?;
        (!self.may_hold(crease)).then(|| {
            format!(
                "crease `{}`: the anchor of its preset is left out, because nothing below holds it",
                crease.name
            )
        })
    }

    /// Whether there is something right below a crease that the anchor of a preset could hold to.
    fn may_hold(&self, crease: &Crease) -> bool {
        self.scene.sheet.is_none() && crease.slit.is_none()
    }

    /// Everything about a crease of `layer` but its line.
    fn kind(
        &self,
        (number, crease): (usize, &Crease),
        layer: &LayerSpec,
    ) -> Result<CreaseSpec, SceneError> {
        let preset = crease.preset.as_deref().and_then(crease_preset);
        let of_preset = |value: fn(&CreasePreset) -> f64| preset.map(value);
        let width = crease.width.or(of_preset(|preset| preset.width));
        let width = width.unwrap_or(WIDTH * layer.material.thickness);
        let widest = mesh_size::width(self.mesh);
        if let Some(own) = crease.width.filter(|width| *width > widest) {
            let reason = format!(
                "found {own:?} m; accepted: up to {:.2} mm, the size of the mesh",
                1e3 * widest
            );
            return Err(self.fault(format!("creases[{number}].width"), reason, None));
        }
        let stiffness = crease.stiffness.or(of_preset(|preset| preset.stiffness));
        let angle = crease.angle.or(of_preset(|preset| preset.angle));
        let own = crease.anchor.map(|anchor| CreaseAnchor {
            depth: anchor.depth,
            stiffness: anchor.stiffness,
        });
        let usual = preset.and_then(|preset| preset.depth);
        let usual = usual.filter(|_| self.may_hold(crease));
        let anchor = own.or(usual.map(|depth| CreaseAnchor {
            depth,
            stiffness: ANCHOR_STIFFNESS,
        }));
        // How deep a soft body is below a line, its plan finds out.
        let below = match &self.scene.interior {
            Some(_) => f64::INFINITY,
            None => layer.substrate.thickness,
        };
        if let Some(deep) = anchor.filter(|anchor| anchor.depth >= below) {
            let depth = 1e3 * deep.depth;
            let (key, found) = match (own, &crease.preset) {
                (None, Some(preset)) => (
                    format!("creases[{number}].preset"),
                    format!("preset `{preset}` anchors lines {depth:.2} mm deep"),
                ),
                _ => (
                    format!("creases[{number}].anchor.depth"),
                    format!("found {} m, which is {depth:.2} mm", deep.depth),
                ),
            };
            let reason = format!(
                "{found}; accepted: less than {:.2} mm, the thickness of what carries layer `{}`",
                1e3 * below,
                layer.name
            );
            return Err(self.fault(key, reason, None));
        }
        let sense = match (crease.fold, crease.one_sided) {
            (Fold::Valley, true) => FoldSense::Valley,
            (Fold::Mountain, true) => FoldSense::Mountain,
            (_, false) => FoldSense::Both,
        };
        // A fold to either side takes the sign of its angle from the side it is drawn to.
        Ok(CreaseSpec {
            name: crease.name.clone(),
            line: TracedLine::default(),
            law: LineLaw {
                width,
                stiffness: stiffness.unwrap_or(STIFFNESS),
                angle: angle.unwrap_or(ANGLE).to_radians(),
                fade: crease.fade.unwrap_or([FADE * width; 2]),
            },
            is_ridge: crease.fold == Fold::Mountain,
            sense,
            drive: self.drive((number, crease))?,
            anchor,
            slit: crease.slit,
            absorbs: crease.absorb,
            memory: CreaseMemory::default(),
        })
    }

    fn drive(&self, (number, crease): (usize, &Crease)) -> Result<ruga_crease::Drive, SceneError> {
        let shapes: Vec<&str> = self.driver.shape_names().collect();
        let term = |(name, factor): (&String, &f64)| {
            let shape = shapes.iter().position(|shape| shape == name);
            let unknown = || {
                let reason = format!("the mesh has no blend shape `{name}`");
                let key = format!("creases[{number}].weights.{name}");
                self.fault(key, reason, nearest(name, shapes.iter().copied()))
            };
            Ok((shape.ok_or_else(unknown)?, *factor))
        };
        Ok(match crease.drive {
            Drive::Load => ruga_crease::Drive::Load,
            Drive::Always => ruga_crease::Drive::Always,
            Drive::Weights => {
                let terms = crease.weights.iter().map(term);
                ruga_crease::Drive::Weights(terms.collect::<Result<_, SceneError>>()?)
            }
        })
    }

    /// Names of the lines of a crease: its own, or for several strokes numbered ones.
    fn names(
        &self,
        (number, crease): (usize, &Crease),
        count: usize,
        layers: &[LayerSpec],
    ) -> Result<Vec<String>, SceneError> {
        let names: Vec<String> = match count {
            1 => vec![crease.name.clone()],
            _ => (1..=count)
                .map(|i| format!("{}-{i}", crease.name))
                .collect(),
        };
        let others = layers.iter().flat_map(|layer| &layer.creases);
        let taken: Vec<String> = others.map(|spec| spec.name.to_lowercase()).collect();
        match names
            .iter()
            .find(|name| taken.contains(&name.to_lowercase()))
        {
            None => Ok(names),
            Some(name) => {
                let reason = format!(
                    "found `{}`, by which two lines would be called `{name}`: the strokes of an image are \
                     numbered; accepted: another name",
                    crease.name
                );
                Err(self.fault(format!("creases[{number}].name"), reason, None))
            }
        }
    }
}
