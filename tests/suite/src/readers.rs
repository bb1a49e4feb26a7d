//! Files for the readers.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use ruga_blend::Driver;
use ruga_io::{
    GlbAdditions, LengthUnit, MeshFile, ObjOptions, read_image, read_mask, read_mesh, write_glb,
};
use ruga_scene::SceneFile;

use super::{
    Chance, EXR_CHANNELS, FuzzScene, FuzzSheet, GltfParts, PNG_COLOURS, PngChunks, Tried,
    damage_bytes, damage_exr, damage_json, damage_text, put, sound_exr,
};

/// Longest message that a person would read.
const LONGEST_MESSAGE: usize = 2000;

pub(super) fn scene(folder: &Path, chance: &mut Chance) -> Tried {
    let mut text = FuzzScene::new(chance).toml().into_bytes();
    let other = FuzzScene::new(chance).toml().into_bytes();
    for _ in 0..chance.below(4) {
        damage_text(&mut text, &other, chance);
    }
    let path = put(folder, "scene.toml", &text);
    let scene = match SceneFile::read(&path) {
        Ok(scene) => scene,
        Err(error) => return refused(&error, "scene.toml"),
    };
    let again = SceneFile::from_toml(&scene.to_toml(), &path)
        .map_err(|error| format!("what was written is refused: {error}"))?;
    if again != scene {
        return Err("a scene changes when it is written and read".to_owned());
    }
    Ok(true)
}

pub(super) fn gltf(folder: &Path, chance: &mut Chance) -> Tried {
    let mut sheet = FuzzSheet::sound(0.1, chance);
    if chance.one_in(4) {
        sheet.make_odd(chance);
    }
    let mut parts = GltfParts::plain(&sheet);
    if chance.one_in(2) {
        parts.enrich(chance);
    }
    for _ in 0..chance.below(4) {
        if chance.one_in(5) {
            let other = parts.binary.clone();
            damage_bytes(&mut parts.binary, &other, chance);
        } else {
            damage_json(&mut parts.json, chance);
        }
    }
    let (name, mut bytes) = if chance.one_in(3) {
        ("mesh.gltf", parts.to_gltf())
    } else {
        ("mesh.glb", parts.to_glb())
    };
    if chance.one_in(6) {
        let other = parts.to_glb();
        damage_bytes(&mut bytes, &other, chance);
    }
    let path = put(folder, name, bytes);
    let mesh_name = chance.one_in(4).then_some("Sheet");
    match read_mesh(&path, mesh_name, &ObjOptions::default()) {
        Ok(file) => sound_mesh(folder, &file),
        Err(error) => refused(&error, name),
    }
}

pub(super) fn obj(folder: &Path, chance: &mut Chance) -> Tried {
    let mut sheet = FuzzSheet::sound(0.1, chance);
    if chance.one_in(4) {
        sheet.make_odd(chance);
    }
    let mut targets = BTreeMap::new();
    let rest = sheet.obj(&sheet.positions).into_bytes();
    let damaged = |text: &[u8], chance: &mut Chance| {
        let mut text = text.to_vec();
        for _ in 0..chance.below(4) {
            damage_text(&mut text, &rest, chance);
        }
        text
    };
    let path = put(folder, "rest.obj", damaged(&rest, chance));
    for (name, positions) in &sheet.shapes {
        let text = sheet.obj(positions).into_bytes();
        let text = if chance.one_in(2) {
            damaged(&text, chance)
        } else {
            text
        };
        targets.insert(name.clone(), put(folder, &format!("{name}.obj"), text));
    }
    if chance.one_in(8) {
        targets.insert("none".to_owned(), folder.join("none.obj"));
    }
    let options = ObjOptions {
        targets,
        length_unit: [LengthUnit::Metre, LengthUnit::Millimetre][chance.below(2)],
    };
    match read_mesh(&path, None, &options) {
        Ok(file) => sound_mesh(folder, &file),
        Err(error) => refused(&error, ".obj"),
    }
}

pub(super) fn png(folder: &Path, chance: &mut Chance) -> Tried {
    let mut chunks = PngChunks::sound(&PNG_COLOURS, chance);
    let other = PngChunks::sound(&PNG_COLOURS, chance);
    for _ in 0..chance.below(4) {
        chunks.damage(&other, chance);
    }
    let mut bytes = chunks.to_bytes();
    if chance.one_in(5) {
        damage_bytes(&mut bytes, &other.to_bytes(), chance);
    }
    sound_image(&put(folder, "image.png", bytes), "image.png")
}

pub(super) fn exr(folder: &Path, chance: &mut Chance) -> Tried {
    let mut bytes = sound_exr(&EXR_CHANNELS, chance);
    let other = sound_exr(&EXR_CHANNELS, chance);
    for _ in 0..chance.below(4) {
        damage_exr(&mut bytes, &other, chance);
    }
    sound_image(&put(folder, "image.exr", bytes), "image.exr")
}

/// A refusal must name the file and be readable.
pub(super) fn refused(error: &dyn Error, file: &str) -> Tried {
    let message = error.to_string();
    if !message.contains(file) {
        return Err(format!("the message does not name {file}: {message}"));
    }
    if message.len() > LONGEST_MESSAGE {
        let start: String = message.chars().take(200).collect();
        return Err(format!("a message of {} bytes: {start}", message.len()));
    }
    Ok(false)
}

fn sound_image(path: &Path, name: &str) -> Tried {
    let mask = read_mask(path);
    let image = match read_image(path) {
        Ok(image) => image,
        Err(error) => return refused(&error, name),
    };
    let mask = mask.map_err(|error| format!("read as an image, refused as a mask: {error}"))?;
    let texels = image.width * image.height;
    if image.values.len() != texels * image.channels || mask.values.len() != texels || texels == 0 {
        return Err(format!(
            "{} x {} with {} values",
            image.width,
            image.height,
            image.values.len()
        ));
    }
    let finite = image.values.iter().all(|value| value.is_finite());
    let unit = mask.values.iter().all(|value| (0.0..=1.0).contains(value));
    if !finite || !unit {
        return Err("texels that are no numbers, or a mask outside 0 to 1".to_owned());
    }
    Ok(true)
}

/// What holds of every mesh that is read, and of what is made of it: a driver, and the file that
/// goes back to the artist.
fn sound_mesh(folder: &Path, file: &MeshFile) -> Tried {
    let mesh = &file.mesh;
    let vertices = mesh.positions.len();
    let arrays = [Some(&mesh.positions), mesh.normals.as_ref()];
    let deltas = mesh
        .shapes
        .iter()
        .flat_map(|shape| [Some(&shape.position_deltas), shape.normal_deltas.as_ref()]);
    for array in arrays.into_iter().chain(deltas).flatten() {
        if array.len() != vertices {
            return Err(format!("{} vectors for {vertices} vertices", array.len()));
        }
        if array.iter().flatten().any(|c| !c.is_finite()) {
            return Err("a vector that is not finite".to_owned());
        }
    }
    let uvs = mesh.uvs.iter().flatten();
    if uvs.clone().flatten().any(|c| !c.is_finite())
        || mesh.uvs.as_ref().is_some_and(|uvs| uvs.len() != vertices)
    {
        return Err("texture coordinates that are no numbers, or too few".to_owned());
    }
    if mesh
        .triangles
        .iter()
        .flatten()
        .any(|v| *v as usize >= vertices)
    {
        return Err("a triangle with a vertex that is not there".to_owned());
    }
    let numbers = file.stretch.iter().chain(file.world_from_node.iter());
    if numbers.chain(&file.default_weights).any(|n| !n.is_finite()) {
        return Err("a placement or weight that is not finite".to_owned());
    }
    written_and_read(folder, file)?;
    match Driver::new(mesh) {
        Ok(driver) => {
            let weights = driver
                .shape_names()
                .map(|name| (name, 0.5))
                .collect::<Vec<_>>();
            let weights = driver.weights(weights).map_err(|e| e.to_string())?;
            match driver
                .pose(&weights)
                .iter()
                .flatten()
                .all(|c| c.is_finite())
            {
                true => Ok(true),
                false => Err("half of every shape is not finite".to_owned()),
            }
        }
        Err(error) if error.to_string().is_empty() => Err("no message".to_owned()),
        Err(_) => Ok(false),
    }
}

fn written_and_read(folder: &Path, file: &MeshFile) -> Result<(), String> {
    let path = folder.join("written.glb");
    if let Err(error) = write_glb(&path, file, &GlbAdditions::default()) {
        return match path.exists() {
            true => Err(format!("half a file: {error}")),
            false => refused(&error, "written.glb").map(drop),
        };
    }
    // What came from glTF goes back with all its meshes.
    let again = read_mesh(&path, Some(&file.mesh.name), &ObjOptions::default())
        .map_err(|error| format!("what was written is refused: {error}"))?;
    if again.mesh.triangles.len() != file.mesh.triangles.len() {
        return Err("triangles are lost when the mesh is written and read".to_owned());
    }
    Ok(())
}
