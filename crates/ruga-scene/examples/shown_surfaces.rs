//! Simulates a scene and writes the top layer of every pose as its maps show it, at the last key:
//! `shown_surfaces SCENE OUT` makes `OUT/POSE.obj`, with the texture coordinates of the mesh.

#![allow(clippy::print_stdout, reason = "an example reports what it wrote")]

use std::error::Error;
use std::path::{Path, PathBuf};

use ruga_io::FrameMesh;
use ruga_scene::{Placement, Scene};
use ruga_stepper::Silent;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [scene, out] = &arguments[..] else {
        return Err("shown_surfaces SCENE OUT".into());
    };
    let scene = Scene::read(scene)?;
    let plan = scene.plan()?;
    std::fs::create_dir_all(out)?;
    for (number, pose) in scene.poses.iter().enumerate() {
        let result = plan.simulate(number, &mut Silent)?;
        let last = result.keys.last();
        let Some(layer) = last.and_then(|key| key.layers.last()) else {
            println!("{}: nothing wrinkles", pose.name);
            continue;
        };
        // Every corner has texture coordinates of its own.
        let corners: Vec<u32> = (0..3 * layer.faces.len() as u32).collect();
        let corners: Vec<[u32; 3]> = corners
            .chunks_exact(3)
            .map(|c| [c[0], c[1], c[2]])
            .collect();
        let frame = FrameMesh {
            name: &layer.name,
            positions: &layer.relief,
            triangles: &layer.faces,
            uvs: &layer.uvs.concat(),
            uv_triangles: &corners,
        };
        let path = Path::new(out).join(format!("{}.obj", pose.name));
        Placement::of(&scene.mesh).write_obj(&path, &frame)?;
        println!("{}", path.display());
    }
    Ok(())
}
