//! `[burn]`: fire on a sheet.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::{Checked, fault, names_given, not_negative, positive};
use super::{SceneFile, SolverMode, Sphere};

/// `[burn]`: the sheet burns where its sources set it on fire, shrinks and curls as it chars, and falls off where its
/// fuel runs out.
///
/// It needs a `[sheet]` and `mode = "dynamic"` under `[solver]`: a pose is a fire of `steps` times `time_step` seconds.
/// The numbers that stand here as defaults are nominal, not those of a measured paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Burn {
    /// Speed of the front, m/s. Flames take paper at 1 to 3 mm/s, smouldering at a tenth of that.
    pub front_speed: f64,
    /// Width that the front heats before it burns, m: the temperature falls by two thirds over it. Nominal for paper:
    /// 2 to 5 mm.
    pub front_width: f64,
    /// Edges of the mesh of temperature and fuel over that width; a third of `points_per_wavelength` if left out, which
    /// is 4, and 2 and 8 with `--quality draft` and `fine`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edges_per_width: Option<f64>,
    /// Temperature from which on it burns, K.
    #[serde(default = "ignition")]
    pub ignition: f64,
    /// Temperature of what has burnt without losing heat, K.
    #[serde(default = "burning")]
    pub burning: f64,
    /// Temperature around it, K.
    #[serde(default = "surroundings")]
    pub surroundings: f64,
    /// Time in which heat is lost to the surroundings, s; none is lost if left out. Too short a time puts the fire
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss_time: Option<f64>,
    /// Shares of length that are lost when burnt out, along and across the grain, 0 to 0.6.
    #[serde(default = "quarter")]
    pub shrink: [f64; 2],
    /// Direction of the grain in the texture, degrees counter-clockwise from its right.
    #[serde(default)]
    pub grain: f64,
    /// How much more the upper side shrinks than the lower one, as a share of their mean, -2 to 2: what makes char
    /// curl, towards the upper side where positive. Much less than 1 is a lot.
    #[serde(default)]
    pub asymmetry: f64,
    /// What has burnt out, over the fresh sheet.
    #[serde(default)]
    pub char: Char,
    /// Share of the fuel at which it falls off, from 0, at which nothing does, to below 1.
    #[serde(default = "ash_share")]
    pub ash_share: f64,
    /// Grey image over the UV square of the share at which it falls off, in place of one number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ash_image: Option<PathBuf>,
    /// Shares at which it falls off where `ash_image` is black and where it is white.
    #[serde(default = "none_to_third")]
    pub ash_range: [f64; 2],
    /// Loose pieces that are smaller vanish, m2; a square as wide as the front if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_piece: Option<f64>,
    /// Image that varies speed, asymmetry and shrinkage over the sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<BurnMap>,
    /// What sets it on fire.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<BurnSource>,
}

/// `char` of `[burn]`: shares of the fresh values that are left when all fuel has burnt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Char {
    /// Young's modulus, a share of the fresh sheet's.
    pub young: f64,
    /// Thickness, a share of the fresh sheet's.
    pub thickness: f64,
    /// Mass, a share of the fresh sheet's.
    pub mass: f64,
}

impl Default for Char {
    fn default() -> Self {
        Self {
            young: 0.1,
            thickness: 0.8,
            mass: 0.2,
        }
    }
}

/// `map` of `[burn]`: an image with red for the speed of the front, green for the asymmetry and blue for the shrinkage.
/// Each channel counts if its range is given: factors at black and at white.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnMap {
    /// The image over the UV square.
    pub image: PathBuf,
    /// Factors on `front_speed`, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<[f64; 2]>,
    /// Factors on `asymmetry`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<[f64; 2]>,
    /// Factors on `shrink`, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shrink: Option<[f64; 2]>,
}

/// One of `[[burn.sources]]`: something hot, either a ball or a painted place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnSource {
    /// Its name in motions and messages.
    pub name: String,
    /// A ball, which motions of poses can move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<Sphere>,
    /// Grey image of where the sheet is hot at the beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<PathBuf>,
    /// Its temperature, K.
    pub temperature: f64,
    /// Share of the difference to its temperature that a ball makes up per second where it touches, 1/s.
    #[serde(default = "coefficient")]
    pub coefficient: f64,
}

fn ignition() -> f64 {
    573.0
}

fn burning() -> f64 {
    1100.0
}

fn surroundings() -> f64 {
    293.0
}

fn quarter() -> [f64; 2] {
    [0.25; 2]
}

fn ash_share() -> f64 {
    0.15
}

fn none_to_third() -> [f64; 2] {
    [0.0, 0.3]
}

fn coefficient() -> f64 {
    20.0
}

impl Burn {
    /// The images that it names, with their keys.
    pub fn images(&self) -> Vec<(String, &Path)> {
        let ash = self.ash_image.as_deref();
        let ash = ash.map(|image| ("burn.ash_image".to_owned(), image));
        let map = self.map.iter();
        let map = map.map(|map| ("burn.map.image".to_owned(), map.image.as_path()));
        let sources = self.sources.iter().enumerate().filter_map(|(i, source)| {
            Some((format!("burn.sources[{i}].image"), source.image.as_deref()?))
        });
        ash.into_iter().chain(map).chain(sources).collect()
    }
}

impl SceneFile {
    pub(super) fn burn_faults(&self) -> Checked {
        let Some(burn) = &self.burn else {
            let of_fire = self.bake.maps.iter().find(|kind| kind.needs_fire());
            return of_fire.map_or(Ok(()), |kind| {
                let found = format!("\"{}\"", kind.word());
                fault("bake.maps", found, "this kind with [burn] only")
            });
        };
        let Some(sheet) = &self.sheet else {
            return fault("burn", "no [sheet]", "[burn] with [sheet], which burns");
        };
        if self.solver.mode == SolverMode::Static {
            let accepted = "\"dynamic\" with [burn]: a fire takes time";
            return fault("solver.mode", "\"static\"", accepted);
        }
        if !self.creases.is_empty() {
            return fault("creases", "some", "none with [burn]");
        }
        for (name, value) in [
            ("front_speed", burn.front_speed),
            ("front_width", burn.front_width),
        ] {
            positive(&format!("burn.{name}"), value)?;
        }
        if !burn.grain.is_finite() {
            let accepted = "degrees, counter-clockwise from the right of the texture";
            return fault("burn.grain", burn.grain, accepted);
        }
        if let Some(edges) = burn.edges_per_width {
            positive("burn.edges_per_width", edges)?;
        }
        if burn.ash_image.is_none() && burn.ash_range != none_to_third() {
            let found = format!("{:?} without `ash_image`", burn.ash_range);
            return fault("burn.ash_range", found, "a range for an `ash_image`");
        }
        if let Some(area) = burn.least_piece {
            not_negative("burn.least_piece", area)?;
        }
        for (i, source) in burn.sources.iter().enumerate() {
            let key = format!("burn.sources[{i}]");
            source.faults(&key)?;
            let others = sheet.movers().names();
            let earlier = burn.sources.iter().take(i).map(|other| other.name.as_str());
            if others.chain(earlier).any(|name| name == source.name) {
                let accepted = "a different name for each source, handle and obstacle";
                return fault(
                    &format!("{key}.name"),
                    format!("`{}` twice", source.name),
                    accepted,
                );
            }
        }
        let Some(map) = &burn.map else {
            return Ok(());
        };
        let given = [map.speed, map.asymmetry, map.shrink];
        if given.iter().all(Option::is_none) {
            let accepted =
                "at least one of `speed`, `asymmetry`, `shrink`, each a range such as `[0.5, 2.0]`";
            return fault("burn.map", "an image without a range", accepted);
        }
        Ok(())
    }
}

impl BurnSource {
    fn faults(&self, key: &str) -> Checked {
        if self.name.trim().is_empty() {
            return fault(&format!("{key}.name"), format!("`{}`", self.name), "a name");
        }
        let given = [
            ("sphere", self.sphere.is_some()),
            ("image", self.image.is_some()),
        ];
        if given[0].1 == given[1].1 {
            return fault(key, names_given(&given), "exactly one of sphere, image");
        }
        let sphere = self.sphere.as_ref();
        sphere.map_or(Ok(()), |sphere| sphere.faults(&format!("{key}.sphere")))
    }
}
