//! Poses that are made as mirror images of others.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::path::{Path, PathBuf};

use ruga_bake::{Coverage, WrinkleMap};
use ruga_scene::{Scene, SceneError, ScenePlan};
use ruga_stepper::{PoseResult, Silent};

/// The cheeks of the face alone, with two poses of the left side and one of the right.
fn scene(folder: &Path, poses: &str) -> Result<Scene, SceneError> {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/face");
    let asset = |name: &str| assets.join(name).display().to_string().replace('\\', "/");
    let text = format!(
        "version = 1\n[driver]\nmesh = '{}'\nsymmetry = \"x\"\n[[layers]]\nname = \"cheeks\"\n\
         preset = \"cheek\"\nmask = '{}'\n{poses}\n[remesh]\npoints_per_wavelength = 6.0\n\
         [bake]\nsize = 256\n",
        asset("face.glb"),
        asset("cheeks.png"),
    );
    let path: PathBuf = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::read(&path)
}

fn pose(name: &str, weights: &str) -> String {
    format!("[[poses]]\nname = \"{name}\"\nweights = {{ {weights} }}\nkeys = [1.0]\n")
}

/// Sum of squared slopes in one map, and the largest difference of its normals from the mirror image of another's.
fn difference(left: &WrinkleMap, right: &WrinkleMap) -> (f64, f64) {
    let size = left.size as usize;
    let covered = |map: &WrinkleMap, texel: usize| map.coverage[texel] == Coverage::Covered;
    let (mut squares, mut worst) = (0.0, 0.0_f64);
    for texel in 0..size * size {
        let opposite = texel / size * size + (size - 1 - texel % size);
        if !covered(left, texel) || !covered(right, opposite) {
            continue;
        }
        let [x, y, z] = left.normals[texel].map(f64::from);
        let [u, v, w] = right.normals[opposite].map(f64::from);
        let difference = (x + u).powi(2) + (y - v).powi(2) + (z - w).powi(2);
        squares += x * x + y * y;
        worst = worst.max(difference.sqrt());
    }
    (squares, worst)
}

/// The right smile is made of the left one, its map is the left one's mirror image, and it costs nothing.
#[test]
fn a_right_pose_is_the_mirror_image_of_the_left() {
    let folder = tempfile::tempdir().unwrap();
    let poses = [
        pose("right", "mouthSmileRight = 0.8"),
        pose("weaker", "mouthSmileLeft = 0.5"),
        pose("left", "mouthSmileLeft = 0.8"),
        pose("both", "mouthSmileLeft = 0.8, mouthSmileRight = 0.8"),
    ];
    let scene = scene(folder.path(), &poses.concat()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let plan = scene.plan().unwrap();
    assert_eq!(
        [0, 1, 2, 3].map(|pose| plan.first_alike(pose)),
        [0, 1, 0, 3]
    );
    // One of the two is an image, whichever side is simulated.
    assert!(plan.is_image(0) != plan.is_image(2));

    let mut result = plan.simulate(0, &mut Silent).unwrap();
    let about_image = "pose 'right', layer 'cheeks': it is flat";
    result.warnings = vec![about_image.to_owned()];
    let other = plan.passed_on(&result, [0, 2]);
    let end = "; that is on the other side, of which this pose is made as the mirror image";
    let expected = match plan.is_image(2) {
        true => format!("pose 'left', layer 'cheeks': it is flat{end}"),
        false => "pose 'left', layer 'cheeks': it is flat".to_owned(),
    };
    assert_eq!(other.warnings, [expected]);
    let baked = |pose: usize, result: &PoseResult| {
        let mut tiles = scene.bake_key(&scene.poses[pose], &result.keys[0]).unwrap();
        tiles.swap_remove(0)
    };
    let (right, left) = (baked(0, &result), baked(2, &other));
    let (squares, worst) = difference(&left, &right);
    // Where the map is only padded, ties go to the first neighbour, which is another one on the other side.
    assert!(squares > 1.0, "{squares}");
    assert!(worst < 1e-4, "{worst}");
}

/// Of a pose that mirrors itself one half is simulated, and its map is its own mirror image; lips part at the plane.
#[test]
fn a_pose_that_mirrors_itself_is_made_of_one_half() {
    let folder = tempfile::tempdir().unwrap();
    let weights = "mouthSmileLeft = 0.8, mouthSmileRight = 0.8, mouthPucker = 0.3";
    let poses = [pose("both", weights), pose("left", "mouthSmileLeft = 0.8")];
    let scene = scene(folder.path(), &poses.concat()).unwrap();
    let plan = scene.plan().unwrap();
    assert_eq!([0, 1].map(|pose| plan.is_half(pose)), [true, false]);
    let as_posed = Scene {
        mirror: None,
        ..scene.clone()
    };
    let whole = as_posed.plan().unwrap();
    let planned = |plan: &ScenePlan| plan.pose_layers(0)[0].vertices as f64;
    let ratio = planned(&plan) / planned(&whole);
    assert!((ratio - 0.5).abs() < 0.1, "{ratio}");

    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let surface = &result.keys[0].layers[0];
    let right = surface.positions.iter().filter(|x| x.x > 0.0).count();
    let left = surface.positions.iter().filter(|x| x.x < 0.0).count();
    assert!(left == right && left > 100, "{left} {right}");
    assert!(surface.on_plane.is_empty());
    let mut tiles = scene.bake_key(&scene.poses[0], &result.keys[0]).unwrap();
    let map = tiles.swap_remove(0);
    let (squares, worst) = difference(&map, &map);
    assert!(squares > 1.0, "{squares}");
    assert!(worst < 1e-4, "{worst}");
}

/// What has no partner on the other side is named, with its place.
#[test]
fn a_mesh_that_does_not_mirror_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = |x: f64| {
        format!("v -0.05 0 0\nv {x} 0 0\nv 0.04 0.1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n")
    };
    for (file, x) in [("mesh.obj", 0.04), ("shape.obj", 0.03)] {
        std::fs::write(folder.path().join(file), mesh(x)).unwrap();
    }
    let path = folder.path().join("scene.toml");
    let text = "version = 1\n[driver]\nmesh = \"mesh.obj\"\ntargets = { press = \"shape.obj\" }\n\
                symmetry = \"x\"\n[[layers]]\nname = \"skin\"\npreset = \"cheek\"\n";
    std::fs::write(&path, text).unwrap();
    let refused = Scene::read(&path).map(|_| ()).unwrap_err().to_string();
    for part in [
        "`driver.symmetry`",
        "mesh.obj does not mirror itself at x = 0",
        "vertex 0 at (-0.0500, 0.0000, 0.0000) m has no partner",
    ] {
        assert!(refused.contains(part), "{part}: {refused}");
    }
}
