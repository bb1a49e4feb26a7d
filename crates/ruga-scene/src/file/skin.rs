//! `[substrate]` and `[[layers]]`: what the skin is made of.

use std::path::{Path, PathBuf};

use ruga_material::{WavelengthModel, Wrap};
use ruga_stepper::{Coupling, Sampling};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[substrate]`: what carries the lowest layer. A preset, or numbers; what is left out takes the
/// reference values of Li 2014, 5.2.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Substrate {
    /// Name of a preset whose substrate is taken; `ruga help presets` lists them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Young's modulus, Pa; 0.5 MPa if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young: Option<f64>,
    /// Poisson's ratio, in (-1, 0.5); 0.48 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson: Option<f64>,
    /// Thickness, m; 15 mm if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
}

/// The two ways to describe a substrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SubstrateDefinition<'a> {
    /// That of a preset.
    Preset(&'a str),
    /// By numbers.
    Elastic(ruga_material::Substrate),
}

impl Substrate {
    /// The preset or the numbers, reference values filled in.
    pub fn definition(&self) -> SubstrateDefinition<'_> {
        match &self.preset {
            Some(name) => SubstrateDefinition::Preset(name),
            None => SubstrateDefinition::Elastic(ruga_material::Substrate {
                young: self.young.unwrap_or(0.5e6),
                poisson: self.poisson.unwrap_or(DEFAULT_POISSON),
                thickness: self.thickness.unwrap_or(15e-3),
            }),
        }
    }
}

/// Skin hardly changes its volume (Li 2014, 5.2).
const DEFAULT_POISSON: f64 = 0.48;

/// One of `[[layers]]`. Exactly one of four descriptions is given: `young` and `thickness`;
/// `wavelength` and `critical_strain`; `preset`; or, of a `[sheet]`, `plies`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Its name, also in file names.
    pub name: String,
    /// Name of a preset; `ruga help presets` lists them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Young's modulus, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub young: Option<f64>,
    /// Thickness, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// The plies that a `[sheet]` is bonded of, lowest first, at least one; the uppermost is on the outer side of the
    /// mesh. All have the layer's `poisson`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plies: Option<Vec<Ply>>,
    /// The wavelength that is wanted, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<f64>,
    /// The compression at which wrinkles are wanted to begin, in (0, 1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_strain: Option<f64>,
    /// Poisson's ratio, in (-1, 0.5).
    #[serde(default = "default_poisson")]
    pub poisson: f64,
    /// Density, kg/m3.
    #[serde(default = "default_density")]
    pub density: f64,
    /// What holds it on the surface below.
    #[serde(default)]
    pub coupling: Coupling,
    /// How averaging constraints follow a changing mesh.
    #[serde(default)]
    pub sampling: Sampling,
    /// The formula for wavelength and critical strain.
    #[serde(default)]
    pub model: WavelengthModel,
    /// Fraction of the lower layer's bending strain that this layer feels, 0 to 1; from the layers'
    /// stiffnesses if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending_transfer: Option<f64>,
    /// Painted properties.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<PropertyMap>,
    /// Grey image over the UV square that says where this layer is: white where it is, black where
    /// it is not, grey where its wrinkles fade. The layer lies where both this mask and
    /// `driver.region` let it; without a mask, wherever `driver.region` does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<PathBuf>,
    /// What this layer's relief is multiplied by in the maps; above 0, up to 4. 1 is what was
    /// simulated.
    #[serde(default = "one")]
    pub strength: f64,
    /// Natural unevenness: relative spread of the layer's thickness from place to place, 0 to 0.5.
    /// Left out, that of the preset, and 0 for a layer given by numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variation: Option<f64>,
    /// Size of the thick and thin places of `variation`, in wavelengths of the layer; from 0.1 to 10.
    #[serde(default = "one")]
    pub variation_scale: f64,
    /// Name of the zone that this layer belongs to. Layers of one zone are a stack, bottom first;
    /// zones lie side by side: where their masks overlap, the greys add up to white at most, and blend
    /// them. Either every layer names its zone or none does. With several zones the lowest layer of each
    /// needs a `mask`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zone: Option<String>,
}

fn one() -> f64 {
    1.0
}

fn default_poisson() -> f64 {
    DEFAULT_POISSON
}

fn default_density() -> f64 {
    1100.0
}

/// One of the plies that a layer of a `[sheet]` is bonded of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ply {
    /// Its name in `[[growths]]` and messages.
    pub name: String,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Thickness, m.
    pub thickness: f64,
    /// Density, kg/m3; that of the layer if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
}

/// The four ways to describe a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerDefinition<'a> {
    /// A preset, which brings its own substrate unless the scene has one.
    Preset(&'a str),
    /// What it is made of.
    Elastic {
        /// Young's modulus, Pa.
        young: f64,
        /// Thickness, m.
        thickness: f64,
    },
    /// What plies it is bonded of, lowest first.
    Plies(&'a [Ply]),
    /// What it shall do; thickness and modulus follow (inverse design).
    Wanted {
        /// Wavelength, m.
        wavelength: f64,
        /// Compression at which wrinkles begin.
        critical_strain: f64,
    },
}

impl Layer {
    /// How the layer is described; `None` when the description is incomplete or contradicts
    /// itself, which no scene that was read does.
    pub fn definition(&self) -> Option<LayerDefinition<'_>> {
        let elastic = self.young.zip(self.thickness);
        let wanted = self.wavelength.zip(self.critical_strain);
        let lone = (self.young.is_some() || self.thickness.is_some()) && elastic.is_none()
            || (self.wavelength.is_some() || self.critical_strain.is_some()) && wanted.is_none();
        if let Some(plies) = &self.plies {
            let others = [
                self.young,
                self.thickness,
                self.wavelength,
                self.critical_strain,
            ];
            let is_alone = self.preset.is_none() && others.iter().all(Option::is_none);
            return is_alone.then_some(LayerDefinition::Plies(plies));
        }
        match (self.preset.as_deref(), elastic, wanted, lone) {
            (Some(name), None, None, false) => Some(LayerDefinition::Preset(name)),
            (None, Some((young, thickness)), None, false) => {
                Some(LayerDefinition::Elastic { young, thickness })
            }
            (None, None, Some((wavelength, critical_strain)), false) => {
                Some(LayerDefinition::Wanted {
                    wavelength,
                    critical_strain,
                })
            }
            _ => None,
        }
    }
}

/// Painted properties of a layer. Each is `lo + (hi - lo) c` times the layer's own value, `c` from
/// 0 to 1 read linearly. Either one `image` (red: wavelength, green: Young's modulus, blue:
/// thickness), or one grey image per property. A property without range keeps its value. With UDIM
/// tiles an image is one file per tile, as `"skin.<UDIM>.png"`; see `tiles` under `[driver]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PropertyMap {
    /// Image of all three properties.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<PathBuf>,
    /// Range of the relative wavelength, `[lo, hi]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<[f64; 2]>,
    /// Range of the relative Young's modulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young: Option<[f64; 2]>,
    /// Range of the relative thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<[f64; 2]>,
    /// Grey image of the wavelength alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength_image: Option<PathBuf>,
    /// Grey image of Young's modulus alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub young_image: Option<PathBuf>,
    /// Grey image of the thickness alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness_image: Option<PathBuf>,
    /// What lies beyond the border of an image.
    pub wrap: Wrap,
    /// Whether edges of the layer's mesh shall follow the places where the paint jumps.
    pub sharp: bool,
}

impl PropertyMap {
    /// The map with other image files: what `file` makes of each; one without is left out.
    pub(crate) fn with_images(&self, file: impl Fn(&Path) -> Option<PathBuf>) -> Self {
        let other = |image: &Option<PathBuf>| file(image.as_deref()?);
        Self {
            image: other(&self.image),
            wavelength_image: other(&self.wavelength_image),
            young_image: other(&self.young_image),
            thickness_image: other(&self.thickness_image),
            ..self.clone()
        }
    }

    /// The image files that are named, with the names of their keys.
    pub(crate) fn named_images(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let named = [
            ("image", &self.image),
            ("wavelength_image", &self.wavelength_image),
            ("young_image", &self.young_image),
            ("thickness_image", &self.thickness_image),
        ];
        let named = named.into_iter();
        named.filter_map(|(name, image)| Some((name, image.as_deref()?)))
    }

    /// The image files that are named; `<UDIM>` in a name stands for the number of a tile.
    pub fn images(&self) -> impl Iterator<Item = &Path> {
        self.named_images().map(|(_, image)| image)
    }
}
