//! How a pose folds the skin, and what many poses leave in it.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use ruga_crease::{
    CreaseMemory, FoldedLine, Kept, LARGEST_ANGLE, NewLines, Relief, YieldLaw, valleys,
};
use ruga_material::{Wrinkling, wrinkling};
use ruga_mesh::{FaceId, TriMesh, vertex_means};
use ruga_stepper::{
    CreaseSpec, FoldSample, FoldSense, LayerSpec, LayerSurface, PoseResult, PoseSpec,
};
use serde::{Deserialize, Serialize};

use crate::Scene;
use crate::fading_memory::{full_strength, levelled, levelled_new};
use crate::file::Memory;
use crate::network::{CreaseNetwork, KeptCrease};

/// Distance of new lines from each other and from creases, in wavelengths: valleys of one pose are a whole one
/// apart, and what is nearer is the same valley in another pose.
const APART: f64 = 0.5;

/// Length of a new line, in wavelengths, from which on it is kept.
const SHORTEST: f64 = 2.0;

/// Samples of a crease per wavelength.
const SAMPLES: f64 = 8.0;

/// Distance of the places by which a crease of the scene is found again, in wavelengths.
const PLACES: f64 = 0.25;

/// Angle from flank to flank of the flattest valleys that are kept of a pose (rad): `wrinkle_yield` can ask for no
/// less.
const FLATTEST: f64 = 7.5 * std::f64::consts::PI / 180.0;

/// How a pose folds the layers that can have creases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseFolds {
    /// Name of the pose.
    pub pose: String,
    /// The layers.
    pub layers: Vec<LayerFolds>,
}

/// How a pose folds a layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerFolds {
    /// Name of the layer.
    pub layer: String,
    /// Creases that are simulated in the pose.
    pub creases: Vec<CreaseFolds>,
    /// Valleys of wrinkles.
    pub valleys: Vec<ValleyFold>,
}

/// How a pose folds a crease.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CreaseFolds {
    /// Name of the crease.
    pub name: String,
    /// Share of the line's length, fold angle and angle without moment (rad), and softness without memory (m).
    pub along: Vec<[f64; 4]>,
}

/// A valley between wrinkles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValleyFold {
    /// Its points, on the mesh at rest, m.
    pub points_m: Vec<[f64; 3]>,
    /// Angle from flank to flank at every point, rad.
    pub turns: Vec<f64>,
    /// Whether the last of the points is joined to the first.
    pub closed: bool,
}

impl Scene {
    /// How a simulated pose folds the skin at its last key; the states of the layers' faces are used where they are
    /// there.
    ///
    /// # Panics
    /// When a layer cannot be, which planning refuses.
    pub fn folds(&self, pose: &PoseSpec, result: &PoseResult) -> PoseFolds {
        let surfaces = result.keys.last().map_or(&[][..], |key| &key.layers[..]);
        let reports = result.layers.iter();
        let mut layers = Vec::new();
        for layer in self
            .layers
            .iter()
            .filter(|layer| self.can_be_creased(layer))
        {
            let of_layer = |name: &String| *name == layer.name;
            let report = reports.clone().find(|report| of_layer(&report.name));
            let surface = surfaces.iter().find(|surface| of_layer(&surface.name));
            let creases = report.iter().flat_map(|report| &report.creases);
            let creases = creases.map(|crease| CreaseFolds {
                name: crease.name.clone(),
                along: crease.along.iter().map(in_numbers).collect(),
            });
            layers.push(LayerFolds {
                layer: layer.name.clone(),
                creases: creases.collect(),
                valleys: surface.map_or(Vec::new(), |surface| self.valleys(layer, surface)),
            });
        }
        PoseFolds {
            pose: pose.name.clone(),
            layers,
        }
    }

    /// Whether a layer lies on no other one, as creases need it.
    fn can_be_creased(&self, layer: &LayerSpec) -> bool {
        let mut layers = self.layers.iter();
        let index = layers.position(|own| own.name == layer.name);
        index.is_some_and(|index| self.file.is_lowest(index))
    }

    /// What `[memory]` says, or its defaults.
    fn memory(&self) -> Memory {
        self.file.memory.clone().unwrap_or_default()
    }

    fn valleys(&self, layer: &LayerSpec, surface: &LayerSurface) -> Vec<ValleyFold> {
        let count = surface.positions.len();
        let Ok(mesh) = TriMesh::new(count, surface.faces.to_vec()) else {
            return Vec::new();
        };
        let nominal = waves(layer).wavelength;
        let wavelength = |face: FaceId| {
            let states = surface.face_states.as_ref();
            let state = states.and_then(|states| states.get(face.0 as usize));
            state.map_or(nominal, |state| state.wavelength)
        };
        // A sine of wave number k that is bent by c at its bottom turns by 2 atan(c/k) from flank to flank.
        let wave_number = vertex_means(&mesh, |face| std::f64::consts::TAU / wavelength(face));
        let wave_number = wave_number.as_slice();
        let slope = (0.5 * FLATTEST).tan();
        let least: Vec<f64> = wave_number.iter().map(|k| slope * k).collect();
        let base = surface.driver_positions.iter().zip(&surface.driver_normals);
        let base: Vec<Vector3<f64>> = base.map(|(p, n)| p + n * surface.offset).collect();
        let heights = surface
            .relief
            .iter()
            .zip(&base)
            .zip(&surface.driver_normals);
        let heights: Vec<f64> = heights.map(|((x, p), n)| (x - p).dot(n)).collect();
        let relief = Relief {
            mesh: &mesh,
            positions: &base,
            heights: &heights,
        };
        let rest = self.rest_places(surface);
        let found = valleys(&relief, &least).into_iter().map(|valley| {
            let points = valley.points.iter().map(|point| {
                let [a, b] = point.vertices.map(|v| v.0 as usize);
                let between = |a: f64, b: f64| a + (b - a) * point.fraction;
                let place = rest[a] + (rest[b] - rest[a]) * point.fraction;
                let turn = 2.0 * (point.curvature / between(wave_number[a], wave_number[b])).atan();
                (<[f64; 3]>::from(place), turn)
            });
            let (points_m, turns) = points.unzip();
            ValleyFold {
                points_m,
                turns,
                closed: valley.is_closed,
            }
        });
        found.collect()
    }

    /// Where the vertices of a surface lie on the mesh at rest.
    fn rest_places(&self, surface: &LayerSurface) -> Vec<Vector3<f64>> {
        let driver = &self.driver;
        let triangles = driver.triangles().iter();
        let faces: BTreeMap<u32, FaceId> = triangles.map(|(face, &file)| (file, face)).collect();
        let mut places = vec![Vector3::zeros(); surface.positions.len()];
        for (corners, (triangle, weights)) in surface.faces.iter().zip(surface.artist.iter()) {
            let Some(&face) = faces.get(triangle) else {
                continue;
            };
            let ends = driver.topology().faces()[face].map(|v| driver.rest()[v.0 as usize]);
            for (&vertex, weights) in corners.iter().zip(weights) {
                let terms = ends.iter().zip(weights);
                places[vertex as usize] = terms.map(|(end, weight)| end * *weight).sum();
            }
        }
        places
    }

    /// The creases that poses leave in the skin. Their order does not matter: of several poses the one that folds a
    /// place most decides.
    ///
    /// # Panics
    /// When a layer cannot be, which planning refuses.
    pub fn network(&self, poses: &[PoseFolds]) -> CreaseNetwork {
        let mut poses: Vec<&PoseFolds> = poses.iter().collect();
        poses.sort_by(|a, b| a.pose.cmp(&b.pose));
        let old = self.lines_of_wrinkles();
        let mut creases = Vec::new();
        let drawn = self.layers.iter().flat_map(|layer| &layer.creases);
        let mut taken = drawn.map(|crease| crease.name.to_lowercase()).collect();
        for layer in self
            .layers
            .iter()
            .filter(|layer| self.can_be_creased(layer))
        {
            let of_layer = poses.iter().flat_map(|pose| &pose.layers);
            let folds = of_layer.filter(|folds| folds.layer == layer.name);
            let folds: Vec<&LayerFolds> = folds.collect();
            let layer = (layer, waves(layer).wavelength);
            creases.extend(self.kept_of_creases(layer, &folds, &old));
            creases.extend(self.new_creases(layer, &folds, &mut taken));
        }
        let names = poses.iter().map(|pose| pose.pose.clone());
        CreaseNetwork::new(&self.mesh.mesh.name, names.collect(), creases)
    }

    /// What the creases of a layer keep.
    fn kept_of_creases(
        &self,
        (layer, wavelength): (&LayerSpec, f64),
        folds: &[&LayerFolds],
        old: &BTreeMap<String, KeptCrease>,
    ) -> Vec<KeptCrease> {
        let memory = self.memory();
        let law = YieldLaw {
            limit: memory.yield_angle.to_radians(),
            weakening: memory.weakening,
        };
        let mut by_name: BTreeMap<&str, Vec<&CreaseFolds>> = BTreeMap::new();
        for folds in folds.iter().flat_map(|folds| &folds.creases) {
            by_name.entry(&folds.name).or_default().push(folds);
        }
        let kept = layer.creases.iter().filter_map(|crease| {
            let length = crease.line.length();
            let steps = (SAMPLES * length / wavelength).ceil().max(2.0) as u32;
            let own = by_name.get(crease.name.as_str());
            let own = own.map_or(&[][..], |own| &own[..]);
            let full = full_strength(&crease.law, &crease.line, own);
            let is_closed = crease.line.is_closed();
            let held = own
                .iter()
                .map(|folds| kept_by(&law, folds, crease.sense, is_closed));
            let held: Vec<CreaseMemory> = held.collect();
            let samples = (0..=steps).map(|step| {
                let share = f64::from(step) / f64::from(steps);
                let before = crease.memory.at(share);
                let added = held.iter().filter_map(|held| within(held, share));
                let most = added.fold(Kept::default(), |a, b| Kept {
                    angle: if b.angle.abs() > a.angle.abs() {
                        b.angle
                    } else {
                        a.angle
                    },
                    softness: a.softness.max(b.softness),
                });
                let kept = Kept {
                    angle: before.angle + most.angle,
                    softness: before.softness + most.softness,
                };
                (share, not_shut(kept))
            });
            let memory = levelled(samples.collect(), full, &crease.memory);
            let old = old.get(&crease.name);
            if old.is_none() && !memory.is_folded() && memory.largest_softness() == 0.0 {
                return None;
            }
            Some(KeptCrease {
                name: crease.name.clone(),
                layer: layer.name.clone(),
                length_m: length,
                points_m: old.map_or(Vec::new(), |old| old.points_m.clone()),
                closed: old.is_some_and(|old| old.closed),
                // A line of wrinkles is where its points are.
                places_m: match old {
                    None => self.places(crease, PLACES * wavelength),
                    Some(_) => Vec::new(),
                },
                along: KeptCrease::samples(&memory),
            })
        });
        kept.collect()
    }

    /// The lines of the present network that wrinkles have left, by name.
    fn lines_of_wrinkles(&self) -> BTreeMap<String, KeptCrease> {
        let path = self.memory().network;
        // A file that could not be read has been refused with the scene.
        let network = path.and_then(|path| CreaseNetwork::read(&path).ok());
        let creases = network.into_iter().flat_map(|network| network.creases);
        let of_wrinkles = creases.filter(|crease| !crease.points_m.is_empty());
        of_wrinkles
            .map(|crease| (crease.name.clone(), crease))
            .collect()
    }

    /// The lines that wrinkles of a layer leave, by names that are not `taken`, in small letters, and are then.
    fn new_creases(
        &self,
        (layer, wavelength): (&LayerSpec, f64),
        folds: &[&LayerFolds],
        taken: &mut BTreeSet<String>,
    ) -> Vec<KeptCrease> {
        let memory = self.memory();
        let law = YieldLaw {
            limit: memory.wrinkle_yield.to_radians(),
            weakening: memory.weakening,
        };
        let there = layer
            .creases
            .iter()
            .flat_map(|crease| self.places(crease, 0.5 * APART * wavelength))
            .map(Vector3::from);
        let mut lines = NewLines::new(APART * wavelength, SHORTEST * wavelength, law.limit, there);
        let found = folds.iter().flat_map(|folds| &folds.valleys);
        let found: Vec<FoldedLine> = found
            .map(|valley| FoldedLine {
                points: valley
                    .points_m
                    .iter()
                    .map(|point| (*point).into())
                    .collect(),
                turns: valley.turns.clone(),
                is_closed: valley.closed,
            })
            .collect();
        let stem = shortened(&layer.name);
        let names = (1_u64..).map(|number| format!("{stem}-line-{number}"));
        let names = names.filter(|name| taken.insert(name.to_lowercase()));
        let kept = names.zip(lines.choose(&found)).map(|(name, line)| {
            let shares = line.shares();
            let samples = shares
                .iter()
                .zip(&line.turns)
                .map(|(&share, &turn)| (share, not_shut(law.kept(turn, layer.material.thickness))));
            let mut samples: Vec<(f64, Kept)> = samples.collect();
            if let (true, Some(&(_, first))) = (line.is_closed, samples.first()) {
                samples.push((1.0, first));
            }
            KeptCrease {
                name,
                layer: layer.name.clone(),
                length_m: line.length(),
                points_m: line.points.iter().map(|point| (*point).into()).collect(),
                closed: line.is_closed,
                places_m: Vec::new(),
                along: KeptCrease::samples(&levelled_new(samples, &line, wavelength)),
            }
        });
        kept.collect()
    }

    /// Places of a crease at rest, evenly from its start to its end and at most `spacing` (m) apart; at least both ends
    /// and the middle.
    fn places(&self, crease: &CreaseSpec, spacing: f64) -> Vec<[f64; 3]> {
        let (mesh, rest) = (self.driver.topology(), self.driver.rest());
        let length = crease.line.length();
        let steps = (length / spacing).ceil().max(2.0) as u32;
        let places = (0..=steps).filter_map(|step| {
            crease
                .line
                .place(length * f64::from(step) / f64::from(steps))
        });
        places
            .map(|place| place.interpolate(mesh, rest).into())
            .collect()
    }
}

/// The beginning of a layer's name that leaves room for a number in the name of a line.
fn shortened(name: &str) -> &str {
    const LONGEST: usize = 80;
    let ends = name.char_indices().map(|(at, c)| at + c.len_utf8());
    let end = ends.take_while(|end| *end <= LONGEST).last();
    &name[..end.unwrap_or(0)]
}

/// How a layer wrinkles by its own numbers.
fn waves(layer: &LayerSpec) -> Wrinkling {
    let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
    waves.expect("planning refuses a layer that cannot be")
}

fn in_numbers(sample: &FoldSample) -> [f64; 4] {
    [sample.share, sample.fold, sample.rest, sample.softness]
}

/// What is kept, but for angles at which the sides would touch.
fn not_shut(kept: Kept) -> Kept {
    Kept {
        angle: kept.angle.clamp(-LARGEST_ANGLE, LARGEST_ANGLE),
        ..kept
    }
}

/// What a crease keeps of one pose.
fn kept_by(law: &YieldLaw, folds: &CreaseFolds, sense: FoldSense, is_closed: bool) -> CreaseMemory {
    let samples = folds.along.iter().map(|&[share, fold, rest, softness]| {
        (share, law.kept(beyond_rest(fold, rest, sense), softness))
    });
    match is_closed {
        true => CreaseMemory::around(samples.collect()),
        false => CreaseMemory::new(samples.collect()),
    }
}

/// How far a fold is turned (rad) beyond the angle `rest` at which it has no moment, to a side to which it may fold; 0
/// of one that is held short of it. What holds a fold open is the skin beside it, in every pose, and wears nothing.
fn beyond_rest(fold: f64, rest: f64, sense: FoldSense) -> f64 {
    match sense {
        FoldSense::Valley => (fold - rest).max(0.0),
        FoldSense::Mountain => (fold - rest).min(0.0),
        // On the side to which nothing draws it, it has no moment where it is flat.
        FoldSense::Both => fold - fold.clamp(rest.min(0.0), rest.max(0.0)),
    }
}

/// What is kept at a share of the line that was simulated: from the beginning of the first edge, of which the sample is
/// the middle, to the end of the last.
fn within(memory: &CreaseMemory, share: f64) -> Option<Kept> {
    let samples = memory.samples();
    let half = |pair: &[(f64, Kept)]| 0.5 * (pair[1].0 - pair[0].0);
    let first = samples.first()?.0 - samples.windows(2).next().map_or(0.0, half);
    let last = samples.last()?.0 + samples.windows(2).last().map_or(0.0, half);
    (first..=last).contains(&share).then(|| memory.at(share))
}

impl PoseFolds {
    /// Whether it can have been written by [`Scene::folds`]: every place of a valley has its angle, and all numbers
    /// are finite.
    pub fn is_whole(&self) -> bool {
        let valleys = self.layers.iter().flat_map(|layer| &layer.valleys);
        let mut creases = self.layers.iter().flat_map(|layer| &layer.creases);
        let is_valley = |valley: &ValleyFold| {
            let count = valley.points_m.len();
            let mut numbers = valley.points_m.iter().flatten().chain(&valley.turns);
            count > 1 && count == valley.turns.len() && numbers.all(|number| number.is_finite())
        };
        valleys.clone().all(is_valley)
            && creases.all(|crease| {
                crease
                    .along
                    .iter()
                    .flatten()
                    .all(|number| number.is_finite())
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: YieldLaw = YieldLaw {
        limit: 0.3,
        weakening: 0.5,
    };

    /// What a place keeps that a pose holds at the angle `fold`, of a line that has no moment at `rest` (rad).
    fn kept(fold: f64, rest: f64, sense: FoldSense) -> Kept {
        let folds = CreaseFolds {
            name: "line".to_owned(),
            along: vec![[0.5, fold, rest, 1e-3]],
        };
        kept_by(&LAW, &folds, sense, false).at(0.5)
    }

    #[test]
    fn a_fold_short_of_its_rest_angle_keeps_nothing() {
        for fold in [0.9, 0.4, 0.0, -0.1] {
            assert_eq!(kept(fold, 1.0, FoldSense::Valley), Kept::default());
            assert_eq!(kept(-fold, -1.0, FoldSense::Mountain), Kept::default());
        }
        for fold in [0.9, 0.4, 0.0] {
            assert_eq!(kept(fold, 1.0, FoldSense::Both), Kept::default());
            assert_eq!(kept(-fold, -1.0, FoldSense::Both), Kept::default());
        }
    }

    #[test]
    fn a_fold_beyond_its_rest_angle_keeps_what_it_does_not_give_back() {
        let is = |found: Kept, angle: f64| {
            assert!((found.angle - angle).abs() < 1e-12, "{found:?}");
            // Twice the limit gains half of the softness.
            assert!((found.softness - 0.5e-3).abs() < 1e-12, "{found:?}");
        };
        is(kept(1.6, 1.0, FoldSense::Valley), 0.3);
        is(kept(-1.6, -1.0, FoldSense::Mountain), -0.3);
        for side in [1.0, -1.0] {
            is(kept(side * 0.6, 0.0, FoldSense::Both), side * 0.3);
            is(kept(side * 1.6, side, FoldSense::Both), side * 0.3);
            // On the other side it is folded from flat.
            is(kept(side * -0.6, side, FoldSense::Both), side * -0.3);
        }
    }
}
