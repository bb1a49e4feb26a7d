//! Files of creases that poses have left in the skin.

use std::collections::BTreeMap;
use std::path::Path;

use ruga_crease::{CreaseMemory, Kept, LARGEST_ANGLE};
use ruga_io::{IoError, write_atomically};
use serde::{Deserialize, Serialize};

use crate::file::file_name_fault;

/// Version of the format.
const VERSION: u32 = 1;

/// Creases that poses have left in the skin of a mesh, as `ruga age` writes them (JSON).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreaseNetwork {
    /// Version of the format: 1.
    pub version: u32,
    /// Name of the mesh.
    pub mesh: String,
    /// Poses that were held.
    pub poses: Vec<String>,
    /// The creases: those of the scene that keep something, and new ones.
    pub creases: Vec<KeptCrease>,
}

/// What a crease keeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptCrease {
    /// Name of a crease of the scene, or of a new one.
    pub name: String,
    /// Its layer.
    pub layer: String,
    /// Length of the line, m.
    pub length_m: f64,
    /// Points of a line that wrinkles have left, on the mesh at rest, m; none of a crease of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points_m: Vec<[f64; 3]>,
    /// Whether the last of the points is joined to the first.
    #[serde(default)]
    pub closed: bool,
    /// Places of a crease of the scene on the mesh at rest, m, as far from each other along the line, from its start to
    /// its end; of a ring the last is the first again. Files of earlier versions have none, and lines with `points_m`
    /// need none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places_m: Vec<[f64; 3]>,
    /// What it keeps along the line.
    pub along: Vec<KeptSample>,
}

/// What a crease keeps in a place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptSample {
    /// Share of the line's length.
    pub share: f64,
    /// Fold angle in which it has no moment, degrees, positive in a valley.
    pub angle_deg: f64,
    /// Softness that it has gained: its compliance times the bending modulus of the layer, m.
    pub softness_m: f64,
}

impl KeptCrease {
    /// What it keeps, as the stepper takes it.
    pub fn memory(&self) -> CreaseMemory {
        let samples = self.along.iter().map(|sample| {
            let kept = Kept {
                angle: sample.angle_deg.to_radians(),
                softness: sample.softness_m,
            };
            (sample.share, kept)
        });
        CreaseMemory::new(samples.collect())
    }

    /// Samples of what it keeps.
    pub(crate) fn samples(memory: &CreaseMemory) -> Vec<KeptSample> {
        let samples = memory.samples().iter().map(|(share, kept)| KeptSample {
            share: *share,
            angle_deg: kept.angle.to_degrees(),
            softness_m: kept.softness,
        });
        samples.collect()
    }

    /// What is wrong with its numbers.
    fn fault(&self) -> Option<String> {
        let is_share = |v: f64| (0.0..=1.0).contains(&v);
        let wrong = self.along.iter().find_map(|sample| {
            let KeptSample {
                share,
                angle_deg,
                softness_m,
            } = *sample;
            let checks = [
                ("share", share, is_share(share), "0 to 1"),
                (
                    "angle_deg",
                    angle_deg,
                    angle_deg.abs() <= LARGEST_ANGLE.to_degrees() + 1e-9,
                    "-150 to 150",
                ),
                (
                    "softness_m",
                    softness_m,
                    softness_m >= 0.0 && softness_m.is_finite(),
                    "a number from 0",
                ),
            ];
            let wrong = checks.into_iter().find(|check| !check.2);
            wrong.map(|(key, value, _, accepted)| {
                format!("`along.{key}`: found {value}; accepted: {accepted}")
            })
        });
        let places = [("points_m", &self.points_m), ("places_m", &self.places_m)];
        let wrong = wrong.or_else(|| {
            places.iter().find_map(|(key, places)| {
                let wrong = places.iter().flatten().find(|c| !c.is_finite());
                wrong.map(|c| format!("`{key}`: found {c}; accepted: finite numbers"))
            })
        });
        // Other names are found in the scene or not.
        let new = Some(&self.name).filter(|_| !self.points_m.is_empty());
        let wrong = wrong.or_else(|| {
            let fault = new.and_then(|name| file_name_fault(name))?;
            Some(format!(
                "`name`: accepted: a name that can be part of a file name, but {fault}"
            ))
        });
        let is_length = self.length_m > 0.0 && self.length_m.is_finite();
        let checks = [
            (
                !self.along.is_empty(),
                "`along`: found none; accepted: at least one sample".to_owned(),
            ),
            (
                is_length,
                format!(
                    "`length_m`: found {}; accepted: a length above 0",
                    self.length_m
                ),
            ),
            (
                self.points_m.len() != 1,
                "`points_m`: found 1 point; accepted: none, or at least 2".to_owned(),
            ),
            (
                self.places_m.len() != 1,
                "`places_m`: found 1 place; accepted: none, or at least 2".to_owned(),
            ),
        ];
        wrong.or_else(|| {
            let wrong = checks.into_iter().find(|(holds, _)| !holds);
            wrong.map(|(_, reason)| reason)
        })
    }
}

impl CreaseNetwork {
    /// A network of the creases that poses have left in the skin of a mesh.
    pub fn new(mesh: &str, poses: Vec<String>, creases: Vec<KeptCrease>) -> Self {
        Self {
            version: VERSION,
            mesh: mesh.to_owned(),
            poses,
            creases,
        }
    }

    /// Reads a network.
    ///
    /// # Errors
    /// What is wrong with the file, in words.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let network: Self = serde_json::from_slice(&bytes).map_err(|error| {
            format!(
                "is no network of creases, from line {} on; accepted: a file that `ruga age` has written",
                error.line().max(1)
            )
        })?;
        if network.version != VERSION {
            return Err(format!(
                "`version`: found {}; accepted: {VERSION}",
                network.version
            ));
        }
        let mut names: BTreeMap<String, &str> = BTreeMap::new();
        for crease in &network.creases {
            if let Some(fault) = crease.fault() {
                return Err(format!("crease `{}`: {fault}", crease.name));
            }
            match names.insert(crease.name.to_lowercase(), &crease.name) {
                None => {}
                Some(same) if same == crease.name => {
                    return Err(format!("crease `{same}` is there twice; leave one out"));
                }
                Some(other) => {
                    return Err(format!(
                        "creases `{other}` and `{}`: accepted: names that differ in more than letter case",
                        crease.name
                    ));
                }
            }
        }
        Ok(network)
    }

    /// Writes the network, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        let mut text = serde_json::to_vec_pretty(self)
            .expect("structs of numbers, strings and lists always serialise");
        text.push(b'\n');
        write_atomically(path, &text)
    }
}
