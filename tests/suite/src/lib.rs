//! Random input for everything that reads, and what must hold whatever the input is: no panic, no
//! number that is not finite in what comes out, and an error that names its file.
//!
//! A [`Target`] makes an input from a number, always the same one, tries it and says what
//! happened: a [`Verdict`]. `cargo xtask fuzz` tries as many as time allows, each target in a
//! process of its own; the test suite tries a few.

mod bytes;
mod chance;
mod gltf;
mod images;
mod program;
mod readers;
mod remesher;
mod results;
mod scenes;
mod sheet;

use std::path::Path;

pub use bytes::{damage_bytes, damage_text};
pub use chance::Chance;
pub use gltf::{GltfParts, damage_json};
pub use images::{EXR_CHANNELS, PNG_COLOURS, PngChunks, damage_exr, sound_exr};
pub use scenes::FuzzScene;
pub use sheet::FuzzSheet;

/// What is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// `scene.toml`.
    Scene,
    /// glTF, text and binary.
    Gltf,
    /// OBJ with a file per blend shape.
    Obj,
    /// PNG.
    Png,
    /// EXR.
    Exr,
    /// Meshes and metrics for the remesher.
    Remesh,
    /// Scenes through the whole program.
    Program,
}

/// What came of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Refused as it should be.
    Rejected,
    /// Taken, and what came out is sound.
    Accepted,
    /// Something that must not be.
    Find(String),
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Scene,
        Self::Gltf,
        Self::Obj,
        Self::Png,
        Self::Exr,
        Self::Remesh,
        Self::Program,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Gltf => "gltf",
            Self::Obj => "obj",
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Remesh => "remesh",
            Self::Program => "program",
        }
    }

    /// The target of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }

    /// Seconds of computing after which an input counts as too slow; the commands that scenes go
    /// through are watched on their own.
    pub fn patience(self) -> f64 {
        match self {
            Self::Program => 60.0,
            Self::Remesh => 5.0,
            _ => 2.0,
        }
    }

    /// Makes input `number` in an empty folder and tries it. `fuzzer` is the program `fuzz` itself,
    /// which also knows the commands of `ruga`.
    ///
    /// # Panics
    /// What is tried may panic: a find.
    pub fn try_input(self, number: u64, folder: &Path, fuzzer: &Path) -> Verdict {
        let mut chance = Chance::new(number);
        let tried = match self {
            Self::Scene => readers::scene(folder, &mut chance),
            Self::Gltf => readers::gltf(folder, &mut chance),
            Self::Obj => readers::obj(folder, &mut chance),
            Self::Png => readers::png(folder, &mut chance),
            Self::Exr => readers::exr(folder, &mut chance),
            Self::Remesh => remesher::remeshed(folder, &mut chance),
            Self::Program => program::scene(folder, fuzzer, &mut chance),
        };
        match tried {
            Ok(true) => Verdict::Accepted,
            Ok(false) => Verdict::Rejected,
            Err(find) => Verdict::Find(find),
        }
    }
}

/// Whether an input was accepted, or what must not be.
pub(crate) type Tried = Result<bool, String>;

/// Writes a file of an input. The folder is the fuzzer's own, so this only fails on a full disk.
pub(crate) fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("the fuzzer's folder takes files");
    path
}
