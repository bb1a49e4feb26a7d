//! `assets`: the small meshes that scenes and tests use, made from code.
//!
//! The same bytes on every run and every machine: nothing is ordered by a hash, and what
//! trigonometry gives is rounded to the file's `f32` before anything is derived from it.

mod finger;
mod forearm;
mod glb;

#[cfg(test)]
mod tests;

use std::error::Error;
use std::fs;
use std::process::ExitCode;

use nalgebra::Vector3;
use ruga_blend::{ArtistMesh, BlendError, Driver, Weights};
use ruga_mesh::vertex_normals;

use crate::repository::{Outcome, root};

/// Writes every mesh below `assets/`; the scenes beside them are edited by hand.
pub(crate) fn regenerate() -> Outcome {
    for (path, bytes) in files()? {
        let target = root().join(path);
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(&target, &bytes)?;
        println!("{path}  {} bytes", bytes.len());
    }
    Ok(ExitCode::SUCCESS)
}

/// Path from the repository's root, and content.
fn files() -> Result<Vec<(&'static str, Vec<u8>)>, Box<dyn Error>> {
    Ok(vec![
        ("assets/forearm/forearm.glb", glb::write(&forearm::mesh()?)?),
        ("assets/finger/finger.glb", glb::write(&finger::mesh()?)?),
    ])
}

/// Rounds positions and deltas to what the file holds, then adds normals.
///
/// Normals come from the rounded positions by sums, products and square roots alone, which IEEE
/// 754 makes equal everywhere. Shapes that turn no normal get none.
fn finish(mut mesh: ArtistMesh) -> Result<ArtistMesh, BlendError> {
    let shapes = mesh.shapes.iter_mut().map(|s| &mut s.position_deltas);
    for values in std::iter::once(&mut mesh.positions).chain(shapes) {
        values.iter_mut().for_each(round);
    }
    let driver = Driver::new(&mesh)?;
    let normals = |weights: &Weights| -> Vec<Vector3<f64>> {
        let welded = vertex_normals(driver.topology(), &driver.pose(weights));
        let mut normals: Vec<_> = driver
            .welded()
            .iter()
            .map(|v| welded[v.0 as usize])
            .collect();
        normals.iter_mut().for_each(round);
        normals
    };
    let rest = normals(&Weights::default());
    for (index, shape) in mesh.shapes.iter_mut().enumerate() {
        let posed = normals(&Weights(vec![(index, 1.0)]));
        let deltas: Vec<_> = posed.iter().zip(&rest).map(|(p, r)| p - r).collect();
        let turned = deltas.iter().any(|d| *d != Vector3::zeros());
        shape.normal_deltas = turned.then_some(deltas);
    }
    mesh.normals = Some(rest);
    Ok(mesh)
}

fn round(value: &mut Vector3<f64>) {
    *value = value.map(|c| f64::from(c as f32));
}
