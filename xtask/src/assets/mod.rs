//! `assets`: the small meshes and painted images that scenes and tests use, made from code.
//!
//! The same bytes on every run and every machine: nothing is ordered by a hash, and what
//! trigonometry gives is rounded to the file's `f32` before anything is derived from it.

mod boxed;
mod face;
mod finger;
mod forearm;
mod paint;
mod paper;
mod pleats;

#[cfg(test)]
mod tests;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use nalgebra::{Matrix3, Matrix4, Vector3};
use ruga_blend::{ArtistMesh, BlendError, Driver, Weights};
use ruga_io::{GlbAdditions, Material, MeshFile, MeshPart, PngTexels, write_glb, write_png};
use ruga_mesh::vertex_normals;

use crate::repository::{Outcome, root};

/// Writes every mesh and image below `assets/`; the scenes beside them are edited by hand.
pub(crate) fn regenerate() -> Outcome {
    let folder = root().join("assets");
    for name in written(&folder)? {
        println!("assets/{name}");
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes all files below `folder`; gives their paths in it.
fn written(folder: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut names: Vec<String> = write_meshes(folder)?.map(str::to_owned).into();
    let pleats = "paper/pleats.obj";
    fs::write(in_its_folder(folder, pleats)?, pleats::file()?)?;
    names.push(pleats.to_owned());
    names.extend(write_images(folder)?.map(str::to_owned));
    names.extend(write_face(folder)?);
    Ok(names)
}

/// Writes the meshes below `folder`; gives their paths in it.
fn write_meshes(folder: &Path) -> Result<[&'static str; 6], Box<dyn Error>> {
    let names = [
        "forearm/forearm.glb",
        "finger/finger.glb",
        "pillow/pillow.glb",
        "slab/slab.glb",
        "bar/bar.glb",
        "paper/paper.glb",
    ];
    for (name, mesh) in names.into_iter().zip(meshes()?) {
        let path = in_its_folder(folder, name)?;
        write_glb(&path, &mesh_file(&path, mesh), &GlbAdditions::default())?;
    }
    Ok(names)
}

/// The meshes: two pieces of skin that blend shapes move, then three soft bodies, then a sheet.
fn meshes() -> Result<[ArtistMesh; 6], BlendError> {
    Ok([
        forearm::mesh()?,
        finger::mesh()?,
        boxed::pillow()?,
        boxed::slab()?,
        boxed::bar()?,
        paper::mesh()?,
    ])
}

/// Writes the head and its images below `folder`; gives their paths in it.
fn write_face(folder: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let head = face::head()?;
    let painted = face::paint(&head.mesh);
    let mut names = vec!["face/face.glb".to_owned()];
    let path = in_its_folder(folder, &names[0])?;
    write_glb(&path, &head_file(&path, head), &GlbAdditions::default())?;
    for (name, texels) in painted.images {
        let name = format!("face/{name}");
        let path = folder.join(&name);
        let side = face::TEXELS;
        write_png(&path, side, side, PngTexels::Grey8(&texels))?;
        names.push(name);
    }
    Ok(names)
}

/// Writes the painted properties and masks below `folder`; gives their paths in it.
fn write_images(folder: &Path) -> Result<[&'static str; 6], Box<dyn Error>> {
    let names = [
        "heterogeneous/stiffness.png",
        "heterogeneous/thickness.png",
        "slab/top.png",
        "paper/lit.png",
        "paper/ash.png",
        "paper/burn.png",
    ];
    let (packed, grey, mask) = (paint::stiffness(), paint::thickness(), paint::slab_top());
    let (lit, ash, burn) = (paint::lit_end(), paint::ash(), paint::burn());
    let images = [
        PngTexels::Rgb8(&packed),
        PngTexels::Grey8(&grey),
        PngTexels::Grey8(&mask),
        PngTexels::Grey8(&lit),
        PngTexels::Grey8(&ash),
        PngTexels::Rgb8(&burn),
    ];
    for (name, texels) in names.into_iter().zip(images) {
        let path = in_its_folder(folder, name)?;
        write_png(&path, paint::TEXELS, paint::TEXELS, texels)?;
    }
    Ok(names)
}

/// The path of a file below `folder`, its own folder made if need be.
fn in_its_folder(folder: &Path, name: &str) -> std::io::Result<PathBuf> {
    let path = folder.join(name);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent)?;
    }
    Ok(path)
}

/// The mesh in one part of plain skin, in metres, where it stands.
fn mesh_file(path: &Path, mesh: ArtistMesh) -> MeshFile {
    let skin = Material {
        name: Some("Skin".to_owned()),
        base_color: [0.8, 0.6, 0.5, 1.0],
        metallic: 0.0,
        roughness: 0.5,
        double_sided: false,
    };
    MeshFile {
        path: path.to_owned(),
        parts: vec![MeshPart {
            vertices: 0..mesh.positions.len(),
            triangles: 0..mesh.triangles.len(),
            material: Some(skin),
        }],
        default_weights: vec![0.0; mesh.shapes.len()],
        stretch: Matrix3::identity(),
        world_from_node: Matrix4::identity(),
        metres_per_unit: 1.0,
        document: None,
        warnings: Vec::new(),
        mesh,
    }
}

/// The head, its eyeballs a part of their own.
fn head_file(path: &Path, head: face::Head) -> MeshFile {
    let mut file = mesh_file(path, head.mesh);
    let (vertices, triangles) = head.skin;
    let eyes = Material {
        name: Some("Eyes".to_owned()),
        base_color: [0.9, 0.88, 0.84, 1.0],
        metallic: 0.0,
        roughness: 0.15,
        double_sided: false,
    };
    let all = &file.parts[0];
    let eyeballs = MeshPart {
        vertices: vertices.end..all.vertices.end,
        triangles: triangles.end..all.triangles.end,
        material: Some(eyes),
    };
    file.parts[0].vertices = vertices;
    file.parts[0].triangles = triangles;
    file.parts.push(eyeballs);
    file
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
    for shape in &mut mesh.shapes {
        let posed = normals(&driver.weights([(shape.name.as_str(), 1.0)])?);
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
