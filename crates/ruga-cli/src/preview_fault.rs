//! Why a folder cannot be previewed.

use std::path::PathBuf;

use miette::Diagnostic;
use ruga_io::IoError;
use ruga_preview::PreviewError;
use thiserror::Error;

/// Errors of `ruga preview`; nothing is written when one comes up.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum PreviewFault {
    /// The folder is not there, or no run of `bake` has finished a pose in it.
    #[error("{}: there is no wrinkles.json, so no pose was baked here", folder.display())]
    #[diagnostic(help("give the folder that was `--output` of `ruga bake`"))]
    NotBaked { folder: PathBuf },
    /// `wrinkles.json` is no manifest of this version.
    #[error("{}: {reason}", path.display())]
    #[diagnostic(help("bake again; `--resume` keeps what is finished"))]
    Manifest { path: PathBuf, reason: String },
    /// The folder has no normal map.
    #[error("{}: lists no normal map, and normal maps are what a preview shows", path.display())]
    #[diagnostic(help(
        "name them under [bake], `maps = [\"normal\", \"height\"]`, and bake again"
    ))]
    NoMaps { path: PathBuf },
    /// The folder was baked with `--maps-only`.
    #[error("{}: lists no GLB, so there is no mesh to show the maps on", path.display())]
    #[diagnostic(help("bake without `--maps-only`; `--resume` keeps the maps that are there"))]
    NoMesh { path: PathBuf },
    /// A file that the manifest lists is gone.
    #[error("{}: wrinkles.json lists it, but there is no such file", path.display())]
    #[diagnostic(help("put it back, or make it again: bake with `--resume`"))]
    Missing { path: PathBuf },
    /// Files of the folder come from different runs.
    #[error("{}: belongs to another run than wrinkles.json: {reason}", path.display())]
    #[diagnostic(help(
        "bake with `--resume`, which lists what is there and makes the rest again; after tasks, with `--merge`"
    ))]
    AnotherRun { path: PathBuf, reason: String },
    /// A file of the user's is in the way.
    #[error("{}: is no preview that ruga has made; nothing was written", path.display())]
    #[diagnostic(help("move the file away, or replace it with `ruga preview --force`"))]
    InTheWay { path: PathBuf },
    /// Mesh, poses and maps do not fit each other.
    #[error("{}: {source}", folder.display())]
    Page {
        folder: PathBuf,
        source: PreviewError,
    },
    /// A file cannot be read, means something impossible, or cannot be written.
    #[error(transparent)]
    Io(#[from] IoError),
}
