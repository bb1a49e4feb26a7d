//! The folder that results go to.

use std::fs;
use std::path::Path;

use ruga_io::{AtomicFile, IoError};
use ruga_scene::Scene;

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::folder_lock::FolderLock;
use crate::folder_results::claim;
use crate::pose_inputs::{ScenePose, scene_poses};
use crate::scene_origin::SceneOrigin;

/// An output folder that this run alone works in.
#[derive(Debug)]
pub(crate) struct OutputFolder {
    /// The scene that its results belong to.
    pub(crate) origin: SceneOrigin,
    /// Every pose of the scene, whether this run makes it or not.
    pub(crate) poses: Vec<ScenePose>,
    _lock: FolderLock,
}

impl OutputFolder {
    /// Makes the folder and finds out, before hours of work, whether files can be written there,
    /// whether another run does so, and whether its results are another scene's.
    ///
    /// # Errors
    /// [`CliError::Output`] naming the folder and the cause, [`CliError::Busy`],
    /// [`CliError::OtherScene`].
    pub(crate) fn open(
        scene: &Scene,
        arguments: &RunArguments,
        command: &str,
    ) -> Result<Self, CliError> {
        Self::open_with(scene, arguments, |path| {
            let line = format!("ruga {command} {}", arguments.scene.display());
            FolderLock::take(path, &line)
        })
    }

    /// The folder for a task, which has the scene's wanted poses for itself and not the whole folder.
    ///
    /// # Errors
    /// Those of [`OutputFolder::open`].
    pub(crate) fn open_for_task(scene: &Scene, arguments: &RunArguments) -> Result<Self, CliError> {
        Self::open_with(scene, arguments, |path| {
            let line = format!("ruga bake --task {}", arguments.scene.display());
            let poses = scene.poses.iter().map(|pose| pose.name.clone());
            FolderLock::share(path, &poses.collect::<Vec<_>>(), &line)
        })
    }

    /// A pose of the scene.
    ///
    /// # Panics
    /// If the scene has none of this name.
    pub(crate) fn pose(&self, name: &str) -> &ScenePose {
        let mut poses = self.poses.iter();
        poses
            .find(|pose| pose.name == name)
            .expect("the poses of a run are poses of its scene")
    }

    fn open_with(
        scene: &Scene,
        arguments: &RunArguments,
        lock: impl Fn(&Path) -> Result<FolderLock, CliError>,
    ) -> Result<Self, CliError> {
        let path = arguments.output.as_path();
        prepare(path)?;
        let lock = lock(path)?;
        let origin = SceneOrigin::of(scene, path);
        let poses = scene_poses(scene)?;
        claim(path, &origin, &poses, arguments.force)?;
        Ok(Self {
            origin,
            poses,
            _lock: lock,
        })
    }
}

/// Makes the folder if it can be one that files can be written to.
///
/// # Errors
/// [`CliError::Output`] naming the folder and the cause.
pub(crate) fn prepare(path: &Path) -> Result<(), CliError> {
    let refuse = |reason: String| {
        Err(CliError::Output {
            path: path.to_owned(),
            reason,
        })
    };
    if path.as_os_str().is_empty() {
        return refuse("its name is empty".to_owned());
    }
    if path.exists() && !path.is_dir() {
        return refuse("it is a file".to_owned());
    }
    if let Err(error) = fs::create_dir_all(path) {
        return refuse(error.to_string());
    }
    // Dropped without a commit, the file leaves nothing behind.
    match AtomicFile::create(&path.join("report.json")) {
        Ok(_) => Ok(()),
        Err(IoError::Unwritable { source, .. }) => refuse(source.to_string()),
        Err(error) => Err(error.into()),
    }
}
