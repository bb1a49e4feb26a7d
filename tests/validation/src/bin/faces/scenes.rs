//! Scenes as text, and the meshes that they are about.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use ruga_blend::ArtistMesh;
use ruga_io::{ObjOptions, read_mesh};
use ruga_validation::{asset, shared_data};

/// A mesh in a file.
pub(crate) struct Model {
    path: PathBuf,
    mesh_name: &'static str,
}

/// A pose: its name and the weights of its shapes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScenePose {
    pub(crate) name: String,
    pub(crate) weights: Vec<(String, f64)>,
}

/// The layer of a preset, as it stands in a scene.
pub(crate) fn preset_layer(preset: &str) -> String {
    format!("[[layers]]\nname = \"{preset}\"\npreset = \"{preset}\"\n")
}

impl Model {
    /// The face of the shared data, where that is.
    pub(crate) fn face() -> Option<Self> {
        let path = shared_data("ict-facekit/ict_face_arkit.glb")?;
        Some(Self {
            path,
            mesh_name: "ICTFace",
        })
    }

    /// The hand of the shared data, where that is.
    pub(crate) fn hand() -> Option<Self> {
        let path = shared_data("makehuman-hand/mh_hand_forearm.glb")?;
        Some(Self {
            path,
            mesh_name: "MHHandForearm",
        })
    }

    /// A flat square of skin, 10 cm wide.
    pub(crate) fn forearm() -> Self {
        Self {
            path: asset("forearm/forearm.glb"),
            mesh_name: "Forearm",
        }
    }

    pub(crate) fn read(&self) -> Result<ArtistMesh, Box<dyn Error>> {
        Ok(read_mesh(&self.path, Some(self.mesh_name), &ObjOptions::default())?.mesh)
    }

    /// Every shape by itself at full weight.
    pub(crate) fn shapes(&self) -> Result<Vec<ScenePose>, Box<dyn Error>> {
        let pose = |name: String| ScenePose {
            weights: vec![(name.clone(), 1.0)],
            name,
        };
        let mesh = self.read()?;
        Ok(mesh
            .shapes
            .into_iter()
            .map(|shape| pose(shape.name))
            .collect())
    }

    /// A scene: `options` are further keys of `[driver]`, `layers` whole tables; maps are baked at these
    /// keys of every pose.
    pub(crate) fn scene(
        &self,
        options: &str,
        layers: &[String],
        (poses, keys): (&[ScenePose], &[f64]),
    ) -> Result<String, Box<dyn Error>> {
        let path = literal(&std::path::absolute(&self.path)?)?;
        let mut text = format!(
            "version = 1\n\n[driver]\nmesh = {path}\nmesh_name = \"{}\"\n{options}\n\n{}",
            self.mesh_name,
            layers.join("\n")
        );
        for pose in poses {
            let weights = pose.weights.iter();
            let weights: Vec<String> = weights
                .map(|(shape, w)| format!("\"{shape}\" = {w:?}"))
                .collect();
            write!(
                text,
                "\n[[poses]]\nname = \"{}\"\nweights = {{ {} }}\nkeys = {keys:?}\n",
                pose.name,
                weights.join(", ")
            )?;
        }
        Ok(text)
    }
}

/// A path as a literal string of TOML.
fn literal(path: &Path) -> Result<String, Box<dyn Error>> {
    let text = path.to_str().filter(|text| !text.contains('\''));
    let text = text.ok_or_else(|| format!("no scene can name {}", path.display()))?;
    Ok(format!("'{text}'"))
}
