//! The creases in a plan: when and how far they fold by the theory of one straight line.

use ruga_material::{CreaseLoad, Wrinkling, crease_depth};
use ruga_scene::Scene;
use ruga_stepper::CreaseSpec;
use serde::Serialize;

use crate::table::{ABSENT, number, table};

/// A crease by the linear theory. What does not exist is `null`.
#[derive(Serialize)]
pub(super) struct CreaseJson<'a> {
    name: &'a str,
    layer: &'a str,
    length_m: f64,
    /// Stiffness of the line over that of the layer: 0 for a hinge without friction.
    kappa: f64,
    /// Compression at which the line folds by itself.
    critical_strain: f64,
    /// Depth in skin that is not compressed, drawn at full strength; where it is compressed the line is deeper.
    depth_m: Option<f64>,
}

/// Every crease of a scene whose layers wrinkle like this.
pub(super) fn creases<'a>(scene: &'a Scene, waves: &[Wrinkling]) -> Vec<CreaseJson<'a>> {
    let layers = scene.layers.iter().zip(waves);
    let of_layers = layers.flat_map(|(layer, waves)| {
        let creases = layer.creases.iter();
        creases.map(|crease| CreaseJson::new(&layer.name, crease, waves))
    });
    of_layers.collect()
}

impl<'a> CreaseJson<'a> {
    fn new(layer: &'a str, crease: &'a CreaseSpec, waves: &Wrinkling) -> Self {
        let kappa = waves.crease_stiffness(crease.softness());
        let depth = crease_depth(&CreaseLoad {
            load: waves.reduced_load(0.0),
            // Without softness it is as any other line, and folds with the layer.
            stiffness: kappa.min(1e6),
            rest_angle: {
                let kept = crease.memory.largest_angle();
                crease.law.angle + if crease.is_ridge { -kept } else { kept }
            },
            anchor: crease.anchor.map_or(0.0, |anchor| anchor.stiffness),
            anchor_depth: crease
                .anchor
                .map_or(0.0, |anchor| anchor.depth * waves.wave_number),
        });
        Self {
            name: &crease.name,
            layer,
            length_m: crease.line.length(),
            kappa,
            critical_strain: waves.crease_strain(kappa),
            depth_m: depth.map(|depth| depth / waves.wave_number),
        }
    }
}

/// Table of the creases of a scene; empty without any.
pub(super) fn creases_table(scene: &Scene, waves: &[Wrinkling]) -> String {
    let creases = creases(scene, waves);
    if creases.is_empty() {
        return String::new();
    }
    let row = |crease: &CreaseJson<'_>| {
        vec![
            crease.name.to_owned(),
            crease.layer.to_owned(),
            number(1e3 * crease.length_m, 1, "mm"),
            number(1e2 * crease.critical_strain, 2, "%"),
            crease
                .depth_m
                .map_or(ABSENT.to_owned(), |depth| number(1e3 * depth, 2, "mm")),
        ]
    };
    let rows: Vec<_> = creases.iter().map(row).collect();
    let headings = ["crease", "layer", "length", "folds from", "drawn depth"];
    table(&headings, &rows)
}
