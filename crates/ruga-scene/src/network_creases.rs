//! What a network of creases adds to the layers of a scene.

use std::path::Path;

use ruga_crease::{Corners, Drive, LineInput, LineLaw, TracedLine};
use ruga_material::wrinkling;
use ruga_stepper::{CreaseSpec, FoldSense, LayerSpec};

use crate::SceneError;
use crate::creases::CreasedMesh;
use crate::network::{CreaseNetwork, KeptCrease};

/// Key of the file.
pub(crate) const NETWORK: &str = "memory.network";

/// Share of a wavelength over which a line that wrinkles have left fades towards its ends.
const FADE: f64 = 0.5;

/// Distance of the points of a new line from the mesh, in wavelengths, up to which they are of it.
const REACH: f64 = 0.1;

/// Share by which the length of a new line, which is rounded between its points, may differ from what it was.
const LIKE_LENGTH: f64 = 0.05;

/// Share by which the length of a line may differ from what it was.
const SAME_LENGTH: f64 = 0.01;

impl CreasedMesh<'_> {
    /// Gives the layers what the network of the scene keeps: memory to their creases, and new ones.
    ///
    /// # Errors
    /// A file that cannot be read, or is of another mesh or scene.
    pub(crate) fn add_network(
        &self,
        layers: &mut [LayerSpec],
    ) -> Result<Option<String>, SceneError> {
        let memory = self.scene.memory.as_ref();
        let Some(path) = memory.and_then(|memory| memory.network.as_deref()) else {
            return Ok(None);
        };
        let network = CreaseNetwork::read(path);
        let network = network.map_err(|reason| self.bad_network(path, reason))?;
        for (number, crease) in network.creases.iter().enumerate() {
            let added = self.add_kept(crease, layers);
            added.map_err(|reason| {
                let reason = format!("`creases[{number}]`, `{}`: {reason}", crease.name);
                self.bad_network(path, reason)
            })?;
        }
        let own = &self.mesh.mesh.name;
        Ok((network.mesh != *own).then(|| {
            format!(
                "{}: was made for the mesh `{}`, and this scene's is `{own}`; if that is another one, let `ruga age` \
                 find anew what poses leave",
                path.display(),
                network.mesh
            )
        }))
    }

    fn bad_network(&self, path: &Path, reason: String) -> SceneError {
        let reason = match path.as_os_str().is_empty() {
            true => "found nothing; accepted: a file that `ruga age` has written".to_owned(),
            false => format!("{}: {reason}", path.display()),
        };
        self.fault(NETWORK.to_owned(), reason, None)
    }

    fn add_kept(&self, kept: &KeptCrease, layers: &mut [LayerSpec]) -> Result<(), String> {
        let anew = "let `ruga age` find anew what poses leave";
        let index = layers.iter().position(|layer| layer.name == kept.layer);
        let Some(index) = index else {
            return Err(format!("the scene has no layer `{}`; {anew}", kept.layer));
        };
        if !self.scene.is_lowest(index) {
            return Err(format!(
                "layer `{}` lies on another one; accepted: the lowest layer",
                kept.layer
            ));
        }
        let layer = &mut layers[index];
        let mut own = layer.creases.iter_mut();
        let found = own.find(|crease| crease.name == kept.name);
        match (found, kept.points_m.is_empty()) {
            (Some(crease), true) => {
                let length = crease.line.length();
                if (length / kept.length_m - 1.0).abs() > SAME_LENGTH {
                    return Err(format!(
                        "was {:.2} mm long and is {:.2} mm; {anew}",
                        1e3 * kept.length_m,
                        1e3 * length
                    ));
                }
                crease.memory = kept.memory();
            }
            (Some(_), false) => {
                return Err("the scene has a crease of this name, too; rename that".to_owned());
            }
            (None, true) => {
                return Err(format!("the scene has no crease of this name; {anew}"));
            }
            (None, false) => {
                let spec = self.of_wrinkles(kept, layer)?;
                layer.creases.push(spec);
            }
        }
        Ok(())
    }

    /// A line that wrinkles have left: as soft and as folded as it keeps, and no more.
    fn of_wrinkles(&self, kept: &KeptCrease, layer: &LayerSpec) -> Result<CreaseSpec, String> {
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        let wavelength = waves.map_err(|error| error.to_string())?.wavelength;
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
