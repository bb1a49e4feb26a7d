//! What a network of creases adds to the layers of a scene.

use std::collections::BTreeSet;
use std::path::Path;

use nalgebra::Vector3;
use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, TracedLine};
use ruga_material::wrinkling;
use ruga_stepper::{CreaseSpec, FoldSense, LayerSpec};

use crate::SceneError;
use crate::creases::CreasedMesh;
use crate::file::{Crease, same_file};
use crate::kept_places::{Fit, Moved, best_fit};
use crate::network::{CreaseNetwork, KeptCrease};

/// Key of the file.
pub(crate) const NETWORK: &str = "memory.network";

/// Share of a wavelength over which a line that wrinkles have left fades towards its ends.
pub(crate) const FADE: f64 = 0.5;

/// Distance of the points of a new line from the mesh, in wavelengths, up to which they are of it.
const REACH: f64 = 0.1;

/// Share by which the length of a new line, which is rounded between its points, may differ from what it was.
const LIKE_LENGTH: f64 = 0.05;

/// Share by which the length of a line may differ from what it was.
const SAME_LENGTH: f64 = 0.01;

/// Distance, in wavelengths, up to which a crease lies where it was: valleys half of one apart are kept as two lines,
/// so this near a line is closer to where it was than to where any other may have been. An image of strokes that is
/// stored in another size moves them by less.
const SAME_PLACE: f64 = 0.25;

/// What to do about a network that does not fit.
const ANEW: &str = "let `ruga age` find anew what poses leave";

impl CreasedMesh<'_> {
    /// Gives the layers what the network of the scene keeps: memory to their creases, and new ones; returns warnings.
    ///
    /// # Errors
    /// A file that cannot be read, or is of another mesh or scene.
    pub(crate) fn add_network(&self, layers: &mut [LayerSpec]) -> Result<Vec<String>, SceneError> {
        let memory = self.scene.memory.as_ref();
        let Some(path) = memory.and_then(|memory| memory.network.as_deref()) else {
            return Ok(Vec::new());
        };
        let network = CreaseNetwork::read(path);
        let network = network.map_err(|reason| self.bad_network(path, reason))?;
        let at = |number: usize, crease: &KeptCrease, reason: String| {
            let reason = format!("`creases[{number}]`, `{}`: {reason}", crease.name);
            self.bad_network(path, reason)
        };
        let mut remembered = Vec::new();
        let mut of_wrinkles = Vec::new();
        for (number, crease) in network.creases.iter().enumerate() {
            let (layer, wavelength) = self
                .layer_of_kept(crease, layers)
                .map_err(|reason| at(number, crease, reason))?;
            let kept = Numbered {
                number,
                crease,
                layer,
                wavelength,
            };
            match crease.points_m.is_empty() {
                true => remembered.push(kept),
                false => of_wrinkles.push(kept),
            }
        }
        let mut warnings = Vec::new();
        let found = self.found(&remembered, layers);
        for (kept, found) in remembered.iter().zip(found) {
            match found.map_err(|reason| at(kept.number, kept.crease, reason))? {
                Found::Line { line, memory } => layers[kept.layer].creases[line].memory = memory,
                Found::TooShort => warnings.push(format!(
                    "{}: `{}` was a stroke of {:.2} mm and is not there any more, or too short for this mesh; what it \
                     keeps is left out",
                    path.display(),
                    kept.crease.name,
                    1e3 * kept.crease.length_m
                )),
            }
        }
        for kept in &of_wrinkles {
            let spec = self.line_of_wrinkles(kept, layers);
            let spec = spec.map_err(|reason| at(kept.number, kept.crease, reason))?;
            layers[kept.layer].creases.push(spec);
        }
        let is_without = |kept: &&Numbered<'_>| kept.crease.places_m.is_empty();
        warnings.extend(remembered.iter().find(is_without).map(|kept| {
            format!(
                "{}: an earlier version has written it, which did not note where `{}` lies; if creases of the scene \
                 have been drawn anew since, {ANEW}",
                path.display(),
                kept.crease.name
            )
        }));
        let own = &self.mesh.mesh.name;
        warnings.extend((network.mesh != *own).then(|| {
            format!(
                "{}: was made for the mesh `{}`, and this scene's is `{own}`; if that is another one, {ANEW}",
                path.display(),
                network.mesh
            )
        }));
        Ok(warnings)
    }

    fn bad_network(&self, path: &Path, reason: String) -> SceneError {
        let reason = match path.as_os_str().is_empty() {
            true => "found nothing; accepted: a file that `ruga age` has written".to_owned(),
            false => format!("{}: {reason}", path.display()),
        };
        self.fault(NETWORK.to_owned(), reason, None)
    }

    /// Number and wavelength (m) of the layer that a remembered line folds.
    fn layer_of_kept(
        &self,
        kept: &KeptCrease,
        layers: &[LayerSpec],
    ) -> Result<(usize, f64), String> {
        let index = layers.iter().position(|layer| layer.name == kept.layer);
        let Some(index) = index else {
            return Err(format!("the scene has no layer `{}`; {ANEW}", kept.layer));
        };
        if !self.scene.is_lowest(index) {
            return Err(format!(
                "layer `{}` lies on another one; accepted: the lowest layer",
                kept.layer
            ));
        }
        let layer = &layers[index];
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        let waves = waves.map_err(|error| error.to_string())?;
        Ok((index, waves.wavelength))
    }

    /// Of every remembered crease of the scene the line that has its memory. Strokes of an image and lines of a mesh
    /// are numbered in the order in which they are found, so that a new one shifts the numbers of others: they are told
    /// apart by where they lie.
    fn found(
        &self,
        remembered: &[Numbered<'_>],
        layers: &[LayerSpec],
    ) -> Vec<Result<Found, String>> {
        let mut pairs = Vec::new();
        for (rank, kept) in remembered.iter().enumerate() {
            for (line, spec) in layers[kept.layer].creases.iter().enumerate() {
                if self.is_same_table(&kept.crease.name, &spec.name)
                    && let Some(fit) = best_fit(kept.crease, &spec.line, self.driver)
                {
                    pairs.push((rank, line, fit));
                }
            }
        }
        pairs.sort_by(|a, b| a.2.off().total_cmp(&b.2.off()));
        let mut taken = BTreeSet::new();
        let mut own = vec![None; remembered.len()];
        for &(rank, line, fit) in &pairs {
            let layer = remembered[rank].layer;
            let is_there = fit.off() <= SAME_PLACE * remembered[rank].wavelength;
            if is_there && own[rank].is_none() && taken.insert((layer, line)) {
                own[rank] = Some((line, fit));
            }
        }
        let found = remembered.iter().zip(own).enumerate();
        let found = found.map(|(rank, (kept, own))| {
            let layer = &layers[kept.layer];
            let nearest = pairs.iter().find(|pair| pair.0 == rank);
            match (own, nearest) {
                (Some((line, fit)), _) => Ok(Found::Line {
                    line,
                    memory: fit.memory(kept.crease, layer.creases[line].line.is_closed()),
                }),
                _ if kept.crease.places_m.is_empty() => by_name(kept.crease, layer),
                _ if self.may_be_left_out(kept) => Ok(Found::TooShort),
                (None, Some((_, line, fit))) => {
                    Err(moved(fit, &layer.creases[*line].name, kept.wavelength))
                }
                (None, None) => Err(format!("the scene has no crease of this name; {ANEW}")),
            }
        });
        found.collect()
    }

    /// Whether two names are of lines of the same `[[creases]]`: its own, or that with the number of a stroke.
    fn is_same_table(&self, a: &str, b: &str) -> bool {
        let [a, b] = [a, b].map(|name| self.table_of(name));
        matches!((a, b), (Some(a), Some(b)) if a.name == b.name)
    }

    fn table_of(&self, line: &str) -> Option<&Crease> {
        let called = |name: &str| self.scene.creases.iter().find(|crease| crease.name == name);
        called(line).or_else(|| {
            let (name, number) = line.rsplit_once('-')?;
            number.parse::<u32>().ok().and_then(|_| called(name))
        })
    }

    /// Whether a stroke may have been left out: of those in images the ones shorter than two edges of the mesh are, and
    /// three edges to a wavelength are the fewest there can be.
    fn may_be_left_out(&self, kept: &Numbered<'_>) -> bool {
        let table = self.table_of(&kept.crease.name);
        table.is_some_and(|crease| crease.image.is_some())
            && kept.crease.length_m < 2.0 / 3.0 * kept.wavelength
    }

    /// A line that wrinkles have left: as soft and as folded as it keeps, and no more.
    fn line_of_wrinkles(
        &self,
        numbered: &Numbered<'_>,
        layers: &[LayerSpec],
    ) -> Result<CreaseSpec, String> {
        let (kept, wavelength) = (numbered.crease, numbered.wavelength);
        let others = layers.iter().flat_map(|layer| &layer.creases);
        let same = others.map(|crease| &crease.name);
        if let Some(same) = same.clone().find(|name| same_file(name, &kept.name)) {
            return Err(match *same == kept.name {
                true => "the scene has a crease of this name, too; rename that".to_owned(),
                false => format!(
                    "the scene has a crease `{same}`; accepted: names that differ in more than letter case"
                ),
            });
        }
        let layer = &layers[numbered.layer];
        let line = LineInput::Positions {
            points: kept.points_m.iter().map(|point| (*point).into()).collect(),
            is_closed: kept.closed,
            reach: REACH * wavelength,
            corners: Corners::Round,
        };
        let line: TracedLine = self
            .tracer()
            .trace(&line)
            .map_err(|error| format!("{error}; is it of another mesh?"))?;
        if (line.length() / kept.length_m - 1.0).abs() > LIKE_LENGTH {
            return Err(format!(
                "was {:.2} mm long and is {:.2} mm; is it of another mesh?",
                1e3 * kept.length_m,
                1e3 * line.length()
            ));
        }
        Ok(CreaseSpec {
            name: kept.name.clone(),
            line,
            law: LineLaw {
                width: layer.material.thickness,
                stiffness: 1.0,
                angle: 0.0,
                fade: [FADE * wavelength; 2],
            },
            is_ridge: false,
            sense: FoldSense::Valley,
            drive: Drive::Always,
            anchor: None,
            slit: None,
            absorbs: false,
            memory: kept.memory(),
        })
    }
}

/// A crease of a network, with its number there.
struct Numbered<'a> {
    number: usize,
    crease: &'a KeptCrease,
    /// Number of the layer that it folds.
    layer: usize,
    /// Wavelength of the layer, m.
    wavelength: f64,
}

/// The line that has the memory of a remembered one.
enum Found {
    /// A crease of the layer, by number, and what it keeps.
    Line { line: usize, memory: CreaseMemory },
    /// A stroke that the mesh is too coarse for.
    TooShort,
}

/// The crease of a remembered one's name, of a file that does not say where it lay.
fn by_name(kept: &KeptCrease, layer: &LayerSpec) -> Result<Found, String> {
    let mut own = layer.creases.iter();
    let Some(line) = own.position(|crease| crease.name == kept.name) else {
        return Err(format!("the scene has no crease of this name; {ANEW}"));
    };
    let length = layer.creases[line].line.length();
    if (length / kept.length_m - 1.0).abs() > SAME_LENGTH {
        return Err(format!(
            "was {:.2} mm long and is {:.2} mm; {ANEW}",
            1e3 * kept.length_m,
            1e3 * length
        ));
    }
    Ok(Found::Line {
        line,
        memory: kept.memory(),
    })
}

/// Why a remembered line has no memory: the nearest one lies elsewhere, or is another one's.
fn moved(fit: &Fit, name: &str, wavelength: f64) -> String {
    let Moved { share, was, is } = fit.farthest;
    let most = SAME_PLACE * wavelength;
    if fit.off() <= most {
        return format!(
            "lies on crease `{name}`, which another line of the file lies on; leave one out"
        );
    }
    let place = |at: Vector3<f64>| {
        let [x, y, z] = at.map(|c| 1e3 * c).into();
        format!("({x:.1}, {y:.1}, {z:.1})")
    };
    format!(
        "no crease lies where it was, at most {:.2} mm off, a quarter of a wavelength: {:.0} % along it was at {} mm, \
         where the nearest of the scene, `{name}`, is at {}; draw the line where it was, remove strokes that now \
         touch or divide it, or {ANEW}",
        1e3 * most,
        100.0 * share,
        place(was),
        place(is)
    )
}
