//! Nominal skins to start from.

use crate::{LayerMaterial, Substrate, Variation};

/// A named layer with the substrate that it was meant for.
///
/// The values are nominal: chosen so that wavelength and critical strain look right, not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name in scenes, in kebab case.
    pub name: &'static str,
    /// Description in one line, with wavelength and critical strain.
    pub description: &'static str,
    /// The layer.
    pub layer: LayerMaterial,
    /// Substrate that carries the layer.
    pub substrate: Substrate,
    /// Natural unevenness of thickness. `None` for the published reference materials, which are even.
    pub variation: Option<Variation>,
}

/// The preset of that name, if there is one.
pub fn preset(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// Every preset, the published reference materials first.
pub static PRESETS: [Preset; 11] = [
    Preset {
        name: "reference-dermis",
        description: "Dermis on fat, Li 2014: 11.3 mm at 13 %",
        layer: skin(4e6, 1.3e-3),
        substrate: below(0.5e6, 15e-3),
        variation: None,
    },
    Preset {
        name: "reference-epidermis",
        description: "Epidermis on dermis, Li 2014: 2.5 mm at 2.0 %",
        layer: skin(600e6, 0.12e-3),
        substrate: below(4e6, 1.3e-3),
        variation: None,
    },
    Preset {
        // Presets from here on wrinkle at 4 to 10 %. The reference epidermis, at 2 %, would wrinkle
        // half a face in almost every expression, and the reference dermis, at 13 %, only in small
        // areas.
        name: "forehead-furrow",
        description: "Horizontal furrows of the forehead: 10 mm at 4.5 %",
        layer: skin(0.8e6, 0.7e-3),
        substrate: below(0.02e6, 8e-3),
        variation: FURROWED,
    },
    Preset {
        name: "cheek",
        description: "Cheek and nasolabial folds: 8 mm at 5.4 %",
        layer: skin(0.6e6, 0.6e-3),
        substrate: below(0.02e6, 10e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "neck",
        description: "Folds of the neck: 12 mm at 4.2 %",
        layer: skin(1.0e6, 0.9e-3),
        substrate: below(0.02e6, 6e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "crows-feet",
        description: "Crow's feet beside the eye: 2.9 mm at 4.7 %",
        layer: skin(2.0e6, 0.22e-3),
        substrate: below(0.05e6, 1.5e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "knuckle",
        description: "Knuckles and back of the hand: 4.7 mm at 5.1 %",
        layer: skin(2.0e6, 0.35e-3),
        substrate: below(0.06e6, 3e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "eyelid",
        description: "Upper eyelid: 1.4 mm at 4.6 %",
        layer: skin(0.8e6, 0.10e-3),
        substrate: below(0.02e6, 0.8e-3),
        variation: UNEVEN,
    },
    Preset {
        // Waves this short take some twenty-five thousand vertices per square centimetre, which
        // only a painted region can afford.
        name: "fine-lines",
        description: "Fine lines, for painted regions only: 0.8 mm at 3.8 %",
        layer: skin(30e6, 0.05e-3),
        substrate: below(0.6e6, 1e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "face2-dermis",
        description: "Two-layer face, lower layer: 10 mm at 9.7 %",
        layer: skin(0.3e6, 1e-3),
        substrate: below(0.024e6, 8e-3),
        variation: UNEVEN,
    },
    Preset {
        name: "face2-epidermis",
        description: "Two-layer face, upper layer: 0.8 mm at 4.0 %",
        layer: skin(14e6, 0.05e-3),
        substrate: below(0.3e6, 1e-3),
        variation: UNEVEN,
    },
];

/// Unevenness of the presets for faces and hands: a relative spread of a fifth, which makes furrows
/// differ in depth, bend, join and fade, with features one wavelength wide.
const UNEVEN: Option<Variation> = Some(Variation {
    spread: 0.2,
    scale: 1.0,
});

/// Unevenness of the forehead. Raised brows compress it by eight times its critical strain over a
/// band that is hardly curved, which orders furrows more than any other pose: with a fifth they still
/// run in parallel to the temples, with 0.35 they bend, join and end.
const FURROWED: Option<Variation> = Some(Variation {
    spread: 0.35,
    scale: 1.0,
});

/// Poisson ratio of every preset (Li 2014, 5.2).
const POISSON: f64 = 0.48;

/// Density of every preset (kg/m³; Li 2014, 5.2).
const DENSITY: f64 = 1100.0;

const fn skin(young: f64, thickness: f64) -> LayerMaterial {
    LayerMaterial {
        young,
        poisson: POISSON,
        thickness,
        density: DENSITY,
    }
}

const fn below(young: f64, thickness: f64) -> Substrate {
    Substrate {
        young,
        poisson: POISSON,
        thickness,
    }
}
