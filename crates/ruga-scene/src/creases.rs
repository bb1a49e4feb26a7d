//! The creases of a scene on its mesh.

use std::path::Path;

use nalgebra::Vector2;
use ruga_blend::{Driver, nearest};
use ruga_crease::{
    CreaseError, GreyImage, LineInput, LineLaw, LineTracer, SkeletonLine, SkeletonSettings,
    TracedLine, check_lines, skeleton_lines,
};
use ruga_io::read_mask;
use ruga_material::{UvTile, Wrinkling, wrinkling};
use ruga_mesh::VertexId;
use ruga_stepper::{CreaseAnchor, CreaseSpec, FoldSense, LayerSpec};

use crate::SceneError;
use crate::crease_presets::crease_preset;
use crate::file::{Crease, Drive, Fold, SceneFile};
use crate::painted_files::tile_files;

/// Width in thicknesses of the layer, share of its stiffness and angle (degrees) of a crease that says
/// nothing of them.
const WIDTH: f64 = 1.0;
const STIFFNESS: f64 = 0.1;
const ANGLE: f64 = 15.0;

/// Stiffness of an anchor that a preset has.
const ANCHOR_STIFFNESS: f64 = 20.0;

/// Widths over which a crease fades towards its ends.
const FADE: f64 = 3.0;

/// The mesh that creases lie on, and the file that names them.
#[derive(Clone, Copy)]
pub(crate) struct CreasedMesh<'a> {
    pub(crate) scene: &'a SceneFile,
    pub(crate) path: &'a Path,
    pub(crate) driver: &'a Driver,
    pub(crate) tiles: &'a [UvTile],
}

/// Adds the creases of a scene to its layers, whose meshes have `points` vertices per wavelength; returns
/// warnings.
///
/// # Errors
/// What is wrong with a line, its properties or its image, naming the key.
pub(crate) fn add_creases(
    on: CreasedMesh<'_>,
    points: f64,
    layers: &mut [LayerSpec],
) -> Result<Vec<String>, SceneError> {
    let mut warnings = Vec::new();
    for (number, crease) in on.scene.creases.iter().enumerate() {
        let layer = on.scene.layer_of(crease);
        let layer = &mut layers[layer.expect("a scene that was read has the layer")];
        let key = format!("creases[{number}]");
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        let waves = waves.map_err(|source| SceneError::Material {
            scene: on.path.to_owned(),
            key: key.clone(),
            source,
        })?;
        let spec = on.kind((number, crease), layer)?;
        warnings.extend(band_warning(crease, &spec, &waves));
        let lines = on.lines((number, crease))?;
        let is_one = lines.len() == 1;
        for (i, line) in lines.into_iter().enumerate() {
            layer.creases.push(CreaseSpec {
                name: match is_one {
                    true => crease.name.clone(),
                    false => format!("{}-{}", crease.name, i + 1),
                },
                line,
                ..spec.clone()
            });
        }
    }
    for layer in layers.iter().filter(|layer| !layer.creases.is_empty()) {
        let found = on.check_together(layer, points)?;
        warnings.extend(found);
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

impl CreasedMesh<'_> {
    fn fault(
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

    /// Everything about a crease of `layer` but its line.
    fn kind(
        &self,
        (number, crease): (usize, &Crease),
        layer: &LayerSpec,
    ) -> Result<CreaseSpec, SceneError> {
        let preset = crease.preset.as_deref().and_then(crease_preset);
        let of_preset = |value: fn(&crate::crease_presets::CreasePreset) -> f64| preset.map(value);
        let width = crease.width.or(of_preset(|preset| preset.width));
        let width = width.unwrap_or(WIDTH * layer.material.thickness);
        let stiffness = crease.stiffness.or(of_preset(|preset| preset.stiffness));
        let angle = crease.angle.or(of_preset(|preset| preset.angle));
        let own = crease.anchor.map(|anchor| CreaseAnchor {
            depth: anchor.depth,
            stiffness: anchor.stiffness,
        });
        let usual = preset.and_then(|preset| preset.depth);
        let anchor = own.or(usual.map(|depth| CreaseAnchor {
            depth,
            stiffness: ANCHOR_STIFFNESS,
        }));
        let below = layer.substrate.thickness;
        if let Some(deep) = anchor.filter(|anchor| anchor.depth >= below) {
            let reason = format!(
                "found {}; accepted: less than {below}, the thickness of what carries layer `{}`",
                deep.depth, layer.name
            );
            return Err(self.fault(format!("creases[{number}].anchor.depth"), reason, None));
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
        })
    }

    fn drive(
        &self,
        (number, crease): (usize, &Crease),
    ) -> Result<ruga_crease::Drive, SceneError> {
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

    /// The lines of a crease on the mesh: one, or those of its image.
    fn lines(&self, (number, crease): (usize, &Crease)) -> Result<Vec<TracedLine>, SceneError> {
        let driver = self.driver;
        let tracer = LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs());
        let key = |source: &str| format!("creases[{number}].{source}");
        let trace = |source: &str, line: LineInput| {
            let traced = tracer.trace(&line);
            traced.map_err(|error| self.fault(key(source), error, None))
        };
        let corners = match crease.corners {
            crate::file::Corners::Round => ruga_crease::Corners::Round,
            crate::file::Corners::Keep => ruga_crease::Corners::Keep,
        };
        if let Some(image) = &crease.image {
            let mut lines = Vec::new();
            for (tile, file) in tile_files(image, self.tiles) {
                for drawn in self.drawn((&key("image"), &file))? {
                    let points = drawn.points.iter().map(|uv| tile.place(uv));
                    let line = LineInput::Uv {
                        points: points.collect(),
                        is_closed: drawn.is_closed,
                        corners,
                    };
                    lines.push(trace("image", line)?);
                }
            }
            return Ok(lines);
        }
        let (source, line) = match crease.edges.is_empty() {
            true => {
                let points = crease.uv.iter().map(|&[u, v]| Vector2::new(u, v));
                let line = LineInput::Uv {
                    points: points.collect(),
                    is_closed: crease.closed,
                    corners,
                };
                ("uv", line)
            }
            false => {
                let vertices = self.welded(&key("edges"), &crease.edges)?;
                ("edges", LineInput::Edges { vertices })
            }
        };
        Ok(vec![trace(source, line)?])
    }

    /// The welded vertices of some of the file's.
    fn welded(&self, key: &str, vertices: &[u32]) -> Result<Vec<VertexId>, SceneError> {
        let welded = self.driver.welded();
        let vertex = |v: &u32| {
            let found = welded.get(*v as usize).copied();
            found.ok_or_else(|| {
                let reason = format!(
                    "found vertex {v}; accepted: 0 to {}, the vertices of the mesh file",
                    welded.len().saturating_sub(1)
                );
                self.fault(key.to_owned(), reason, None)
            })
        };
        let found: Vec<VertexId> = vertices.iter().map(vertex).collect::<Result<_, _>>()?;
        // The file may have a vertex twice, on both sides of a seam.
        let mut path = found;
        path.dedup();
        Ok(path)
    }

    /// The middle lines of what is painted in an image.
    fn drawn(&self, (key, file): (&str, &Path)) -> Result<Vec<SkeletonLine>, SceneError> {
        let image = read_mask(file).map_err(|source| SceneError::NamedFile {
            scene: self.path.to_owned(),
            key: key.to_owned(),
            source: Box::new(source),
        })?;
        let grey = GreyImage {
            width: image.width,
            height: image.height,
            values: &image.values,
        };
        let lines = skeleton_lines(&grey, &SkeletonSettings::default());
        lines.map_err(|error| {
            let reason = format!("{}: {error}", file.display());
            self.fault(key.to_owned(), reason, None)
        })
    }

    /// What is wrong with the lines of a layer together.
    fn check_together(&self, layer: &LayerSpec, points: f64) -> Result<Vec<String>, SceneError> {
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        // A layer that cannot be has been refused.
        let Ok(waves) = waves else {
            return Ok(Vec::new());
        };
        let lines: Vec<TracedLine> = layer.creases.iter().map(|spec| spec.line.clone()).collect();
        let name = |line: usize| format!("crease `{}`", layer.creases[line].name);
        let on = (self.driver.topology(), self.driver.rest());
        let found = check_lines(&lines, on, waves.wavelength / points);
        let found = found.map_err(|error| {
            let reason = match &error {
                CreaseError::TooShort { line, length, edge } => format!(
                    "{} is {:.2} mm long, less than two edges of the mesh, which are {:.2} mm; lengthen it, or leave it out",
                    name(*line),
                    1e3 * length,
                    1e3 * edge
                ),
                CreaseError::IdenticalLines { lines: [a, b] } => {
                    format!("{} and {} lie on each other; leave one out", name(*a), name(*b))
                }
                other => other.to_string(),
            };
            self.fault("creases".to_owned(), reason, None)
        })?;
        Ok(found.iter().map(|warning| warning.told(&name)).collect())
    }
}
