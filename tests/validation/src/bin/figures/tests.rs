//! Figures from a layer that was written by hand.

use nalgebra::Vector2;
use ruga_io::{FrameMesh, write_obj_frame};

use super::*;

#[test]
fn every_scene_and_every_row_of_the_thesis_has_its_place() {
    for scene in SCENES {
        let path = asset(scene);
        let poses = ruga_scene::SceneFile::read(&path).unwrap().poses;
        let name = name_of(scene);
        let known = poses.iter().filter(|p| reference(&name, &p.name).is_some());
        let expected = match name.as_str() {
            "forearm-two-layers" => 3,
            "layers-two" | "heterogeneous-stiffness" | "heterogeneous-thickness" => 1,
            _ => 0,
        };
        assert_eq!(known.count(), expected, "{name}");
    }
    assert_eq!(name_of("finger/scene.toml"), "finger");
}

/// The forearm's patch as two triangles, shortened by 4 % along x and lengthened by 1 % along y.
fn strained_patch(path: &Path) {
    let uvs = [[0.02, 0.98], [0.98, 0.98], [0.98, 0.02], [0.02, 0.02]].map(Vector2::from);
    let positions = uvs.map(|uv| {
        let at = (uv - Vector2::repeat(0.5)) * (0.1 / 0.96);
        nalgebra::Vector3::new(0.96 * at.x, -1.01 * at.y, 0.0)
    });
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let frame = FrameMesh {
        name: "skin",
        positions: &positions,
        triangles: &triangles,
        uvs: &uvs,
        uv_triangles: &triangles,
    };
    write_obj_frame(path, &frame).unwrap();
}

#[test]
fn strain_is_measured_against_the_artists_mesh_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("skin.obj");
    strained_patch(&file);
    let layer = Surface::read(&file).unwrap();
    let material = Material::read(&asset("forearm/scene.toml")).unwrap();
    let strains = material.strains(&layer).unwrap();
    for (_, strain) in strains.iter() {
        // Corners of a Loop surface are kept, and files round to a nanometre.
        assert!((strain.first - 0.04).abs() < 1e-6, "{strain:?}");
        assert!((strain.second + 0.01).abs() < 1e-6, "{strain:?}");
    }
    for (name, picture) in [
        (
            "skin.png",
            skin_picture::draw(&layer, &material.rest(&layer).unwrap()).unwrap(),
        ),
        (
            "mesh.png",
            mesh_picture::draw(&layer, &strains, 0.04).unwrap(),
        ),
    ] {
        let path = folder.path().join(name);
        picture.write(&path).unwrap();
        let image = ruga_io::read_image(&path).unwrap();
        let middle = 3 * (image.width * (image.height / 2) + image.width / 3);
        // Neither white nor grey: skin and compression are both reddish.
        assert!(
            image.values[middle] > 1.2 * image.values[middle + 2],
            "{name}"
        );
    }
}
