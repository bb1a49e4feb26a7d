//! Where a simulation has taken the artist's mesh, as blend shapes and animations of the GLB.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fs;
use std::path::Path;

use fixture::{Folder, glb, read, square};
use nalgebra::{Vector3, Vector4};
use ruga_io::{
    FrameMesh, GlbAdditions, LengthUnit, MeshFile, MovedMesh, ObjOptions, WrittenGlb, read_mesh,
    read_obj_positions, write_glb, write_obj_frame,
};
use serde_json::{Value, json};

/// The mesh bent up to a height (m) at a time (s) and a key of a pose.
fn bent(file: &MeshFile, pose: &str, (key, seconds): (f64, f64), height: f64) -> MovedMesh {
    let up = |x: &Vector3<f64>| x + Vector3::new(0.0, 0.0, height * x.x * x.x);
    let normal = |x: &Vector3<f64>| Vector3::new(-2.0 * height * x.x, 0.0, 1.0).normalize();
    MovedMesh {
        pose: pose.into(),
        key,
        seconds,
        positions: file.mesh.positions.iter().map(up).collect(),
        normals: file.mesh.positions.iter().map(normal).collect(),
    }
}

fn written(path: &Path, file: &MeshFile, moved: &[MovedMesh]) -> WrittenGlb {
    let vertices = file.mesh.positions.len();
    let additions = GlbAdditions {
        tangents: Some(&vec![Vector4::new(1.0, 0.0, 0.0, 1.0); vertices]),
        normals: Some(&vec![Vector3::z(); vertices]),
        maps: &[],
        moved,
    };
    write_glb(path, file, &additions).unwrap()
}

fn json_of(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Times and weights of an animation, as any reader of glTF finds them.
fn played(path: &Path, name: &str) -> (Vec<f32>, Vec<f32>) {
    let glb = gltf::Gltf::open(path).unwrap();
    let blob = glb.blob.clone().unwrap();
    let animation = glb.animations().find(|a| a.name() == Some(name)).unwrap();
    let channel = animation.channels().next().unwrap();
    let reader = channel.reader(|_| Some(blob.as_slice()));
    let times = reader.read_inputs().unwrap().collect();
    let Some(gltf::animation::util::ReadOutputs::MorphTargetWeights(weights)) =
        reader.read_outputs()
    else {
        panic!("weights are played");
    };
    (times, weights.into_f32().collect())
}

/// Whether the last shapes of the written file are these meshes.
fn assert_shapes(file: &MeshFile, moved: &[MovedMesh]) {
    let mesh = &file.mesh;
    let shapes = &mesh.shapes[mesh.shapes.len() - moved.len()..];
    for (shape, moved) in shapes.iter().zip(moved) {
        for (v, x) in mesh.positions.iter().enumerate() {
            let found = x + shape.position_deltas[v];
            assert!((found - moved.positions[v]).norm() < 1e-6, "{}", shape.name);
            let normals = mesh.normals.as_ref().unwrap();
            let found = normals[v] + shape.normal_deltas.as_ref().unwrap()[v];
            assert!((found - moved.normals[v]).norm() < 1e-6, "{}", shape.name);
        }
    }
}

#[test]
fn a_document_gets_a_shape_per_key_and_an_animation_per_pose() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["meshes"][0]["weights"] = json!([0.5]);
    json["nodes"][0]["weights"] = json!([0.25]);
    json["nodes"][0]["scale"] = json!([2.0, 2.0, 2.0]);
    let file = read(&folder.file("square.glb", glb(&json, &bin))).unwrap();
    // Keys in any order; the file has a shape of the second pose's name already.
    let moved = [
        bent(&file, "burn", (1.0, 30.0), 0.5),
        bent(&file, "burn", (0.5, 15.0), 0.2),
        bent(&file, "lift", (1.0, 1.0), -0.1),
    ];
    let path = folder.path("out.glb");
    assert_eq!(written(&path, &file, &moved).warnings, [""; 0]);
    let again = read(&path).unwrap();
    let names = again.mesh.shapes.iter().map(|shape| shape.name.as_str());
    assert_eq!(
        names.collect::<Vec<_>>(),
        ["lift", "burn_100", "burn_50", "lift_100"]
    );
    assert_shapes(&again, &moved);
    assert_eq!(
        again.mesh.shapes[0].position_deltas,
        file.mesh.shapes[0].position_deltas
    );
    let json = json_of(&path);
    assert_eq!(json["meshes"][0]["weights"], json!([0.5, 0.0, 0.0, 0.0]));
    assert_eq!(json["nodes"][0]["weights"], json!([0.25, 0.0, 0.0, 0.0]));
    let (times, weights) = played(&path, "burn");
    assert_eq!(times, [0.0, 15.0, 30.0]);
    // From what the file shows at rest.
    let expected = [
        [0.25, 0.0, 0.0, 0.0],
        [0.25, 0.0, 1.0, 0.0],
        [0.25, 1.0, 0.0, 0.0],
    ];
    assert_eq!(weights, expected.as_flattened());
    assert_eq!(played(&path, "lift").0, [0.0, 1.0]);
}

#[test]
fn a_mesh_without_a_document_gets_them_in_its_unit() {
    let folder = Folder::new();
    let obj = "o Leaf\nv 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    let options = ObjOptions {
        length_unit: LengthUnit::Centimetre,
        ..ObjOptions::default()
    };
    let file = read_mesh(&folder.file("leaf.obj", obj), None, &options).unwrap();
    let moved = [bent(&file, "dry", (1.0, 2.0), 3.0)];
    let path = folder.path("out.glb");
    written(&path, &file, &moved);
    let again = read(&path).unwrap();
    assert_eq!(again.mesh.shapes.len(), 1);
    assert_eq!(again.mesh.shapes[0].name, "dry_100");
    assert_shapes(&again, &moved);
    assert_eq!(played(&path, "dry"), (vec![0.0, 2.0], vec![0.0, 1.0]));
}

#[test]
fn a_document_that_plays_its_own_shapes_stays_as_it_is() {
    let folder = Folder::new();
    let (json, bin) = fixture::rigged::rigged();
    let text = json.to_string().replace("\"ODD\"", "0.5");
    let json: Value = serde_json::from_str(&text).unwrap();
    let path = folder.file("rigged.glb", glb(&json, &bin));
    let file = read_mesh(&path, Some("Square"), &ObjOptions::default()).unwrap();
    let out = folder.path("out.glb");
    let moved = [bent(&file, "burn", (1.0, 1.0), 0.5)];
    let written = written(&out, &file, &moved);
    assert_eq!(written.warnings.len(), 1, "{:?}", written.warnings);
    assert!(written.warnings[0].contains("drives its blend shapes"));
    let json = json_of(&out);
    assert_eq!(
        json["meshes"][0]["primitives"][0]["targets"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
    assert_eq!(json["animations"].as_array().unwrap().len(), 1);
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = Folder::new();
    let (json, bin) = square();
    let file = read(&folder.file("square.glb", glb(&json, &bin))).unwrap();
    let refused = |change: &dyn Fn(&mut MovedMesh)| {
        let mut moved = [bent(&file, "burn", (1.0, 1.0), 0.5)];
        change(&mut moved[0]);
        let additions = GlbAdditions {
            moved: &moved,
            ..GlbAdditions::default()
        };
        let written = write_glb(&folder.path("out.glb"), &file, &additions);
        written.expect_err("a refusal").to_string()
    };
    let short = refused(&|moved| moved.positions.truncate(3));
    assert!(short.contains("`burn` has 3 entries"), "{short}");
    for far in [
        refused(&|moved| moved.positions[1].x = f64::NAN),
        refused(&|moved| moved.positions[1].x = 1e300),
    ] {
        assert!(far.contains("out of reach"), "{far}");
    }
    let early = refused(&|moved| moved.seconds = 0.0);
    assert!(early.contains("a shape at 0 s"), "{early}");
}

#[test]
fn positions_of_a_frame_are_read_back() {
    let folder = Folder::new();
    let positions = [
        Vector3::new(0.1, -2.0, 1e-9),
        Vector3::zeros(),
        Vector3::x(),
    ];
    let frame = FrameMesh {
        name: "v of a pose",
        positions: &positions,
        triangles: &[[0, 1, 2]],
        uvs: &[],
        uv_triangles: &[],
    };
    let path = folder.path("frame.obj");
    write_obj_frame(&path, &frame).unwrap();
    assert_eq!(read_obj_positions(&path).unwrap(), positions);
    let damaged = folder.file("damaged.obj", "v 1 2 3\nv 1 x 3\n");
    let error = read_obj_positions(&damaged).unwrap_err().to_string();
    assert!(error.contains("line 2"), "{error}");
}
