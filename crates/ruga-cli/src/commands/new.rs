//! `ruga new`: a starter scene that runs, or one for somebody's own mesh.

use std::path::Path;

use ruga_io::write_atomically;

use super::scene_for_mesh::OwnMesh;
use crate::arguments::NewArguments;
use crate::error::CliError;
use crate::outcome::Outcome;
use crate::{messages, output_folder};

/// Writes the files of a template, or a scene for a mesh, into a folder, over nothing.
///
/// # Errors
/// [`CliError::InTheWay`] when one of them exists, [`CliError::Output`] and [`CliError::Io`] when
/// the folder cannot be written to, and what the mesh is refused for.
pub(crate) fn run(arguments: &NewArguments) -> Result<Outcome, CliError> {
    let folder = &arguments.folder;
    match &arguments.mesh {
        Some(mesh) => for_mesh(mesh, folder)?,
        None => from_template(arguments)?,
    }
    let scene = folder.join("scene.toml");
    let output = folder.join("out");
    messages::result(&format!(
        "{} is ready. Next:\n  ruga check {}\n  ruga plan {}\n  ruga bake {} -o {}",
        scene.display(),
        scene.display(),
        scene.display(),
        scene.display(),
        output.display()
    ));
    Ok(Outcome::Done)
}

fn from_template(arguments: &NewArguments) -> Result<(), CliError> {
    let folder = &arguments.folder;
    let files = arguments.template.files();
    for (name, _) in files {
        refuse_existing(&folder.join(name))?;
    }
    output_folder::prepare(folder)?;
    for (name, content) in files {
        write_atomically(&folder.join(name), content)?;
    }
    Ok(())
}

/// The mesh is read first: nothing is written for one that is refused.
fn for_mesh(mesh: &Path, folder: &Path) -> Result<(), CliError> {
    let path = folder.join("scene.toml");
    refuse_existing(&path)?;
    let mesh = OwnMesh::read(mesh)?;
    output_folder::prepare(folder)?;
    write_atomically(&path, mesh.scene(folder)?.as_bytes())?;
    Ok(())
}

fn refuse_existing(path: &Path) -> Result<(), CliError> {
    match path.exists() {
        true => Err(CliError::InTheWay {
            path: path.to_owned(),
        }),
        false => Ok(()),
    }
}
