//! The artist's glTF file goes through `ruga bake` as it came.

#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod fixture;

use fixture::Folder;
use ruga_io::{GlbAdditions, ObjOptions, read_mesh, write_glb};
use serde_json::{Value, json};

/// The JSON and the binary chunk of a GLB.
fn chunks(bytes: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    (json, bytes[28 + length..].to_vec())
}

/// A scene whose mesh is `patch.gltf` with a texture in WebP and one that is not there; returns it.
fn textured(folder: &Folder) -> Value {
    let options = ObjOptions {
        targets: [("squeeze".to_owned(), folder.path("squeeze.obj"))].into(),
        ..ObjOptions::default()
    };
    let mesh = read_mesh(&folder.path("patch.obj"), None, &options).unwrap();
    let normals = vec![nalgebra::Vector3::z(); mesh.mesh.positions.len()];
    let additions = GlbAdditions {
        normals: Some(&normals),
        ..GlbAdditions::default()
    };
    write_glb(&folder.path("plain.glb"), &mesh, &additions).unwrap();
    let (mut json, binary) = chunks(&folder.read("plain.glb"));
    folder.write("patch.bin", &binary);
    folder.write("pores.webp", b"RIFF\x0c\0\0\0WEBPVP8 ");
    json["buffers"][0]["uri"] = json!("patch.bin");
    json["images"] = json!([{"uri": "pores.webp"}, {"uri": "colour.ktx2"}]);
    json["textures"] = json!([{"source": 0}, {"source": 1}]);
    json["materials"] = json!([{
        "name": "Skin",
        "normalTexture": {"index": 0},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}},
    }]);
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    folder.write("patch.gltf", json.to_string());
    let targets =
        "targets = { squeeze = \"squeeze.obj\", stretch = \"stretch.obj\", dent = \"dent.obj\" }\n";
    folder.change("scene.toml", targets, "");
    folder.change("scene.toml", "patch.obj", "patch.gltf");
    folder.change("scene.toml", "keys = [0.5, 1.0]", "keys = [1.0]");
    json
}

#[test]
fn the_artists_file_is_carried_and_says_where_the_maps_are() {
    let folder = Folder::new();
    let from = textured(&folder);
    folder
        .ruga("bake scene.toml -o out")
        .exits(0)
        .says(&["image 1", "colour.ktx2"]);
    let (written, binary) = chunks(&folder.read("out/Patch.glb"));
    for name in ["materials", "textures", "nodes", "scenes", "asset"] {
        assert_eq!(written[name], from[name], "{name}");
    }
    assert!(binary.starts_with(&folder.read("patch.bin")));
    assert_eq!(written["images"][0]["mimeType"], "image/webp");
    assert_eq!(written["images"][1], from["images"][1]);
    let attributes = &written["meshes"][0]["primitives"][0]["attributes"];
    assert!(attributes["TANGENT"].is_u64(), "{attributes}");

    let manifest = folder.json("out/wrinkles.json");
    assert_eq!(manifest["glb"]["file"], "Patch.glb");
    assert_eq!(manifest["glb"]["coordinates"][0]["set"], 0);
    let pointer = manifest["glb"]["maps"].as_str().unwrap();
    let maps = written.pointer(pointer).unwrap();
    assert_eq!(maps[0]["normal"], manifest["maps"][0]["file"]);
    let warnings = folder.json("out/report.json")["warnings"].to_string();
    assert!(warnings.contains("colour.ktx2"), "{warnings}");
}

#[test]
fn maps_only_writes_no_mesh() {
    let folder = Folder::with("keys = [0.5, 1.0]", "keys = [1.0]");
    folder.ruga("bake scene.toml -o out --maps-only").exits(0);
    let files = folder.files("out");
    assert!(
        files.iter().all(|file| !file.ends_with(".glb")),
        "{files:?}"
    );
    let manifest = folder.json("out/wrinkles.json");
    assert!(manifest.get("glb").is_none());
    assert_eq!(manifest["maps"].as_array().unwrap().len(), 2);
    folder
        .ruga("simulate scene.toml -o frames --maps-only")
        .exits(2);
}

#[test]
fn a_file_of_the_artists_is_not_replaced() {
    let folder = Folder::with("keys = [0.5, 1.0]\nsteps = 2", "keys = [1.0]\nsteps = 1");
    std::fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/Patch.glb", "mine");
    let refused = || {
        folder.ruga("bake scene.toml -o out").exits(2).says(&[
            "Patch.glb",
            "another folder",
            "--maps-only",
            "--force",
        ]);
        assert_eq!(folder.read("out/Patch.glb"), b"mine");
    };
    refused();
    assert_eq!(folder.files("out"), ["Patch.glb"]);
    assert!(!folder.path("out/.lock").exists());
    // Following the advice makes the file no one else's.
    folder.ruga("bake scene.toml -o out --maps-only").exits(0);
    refused();
    folder
        .ruga("bake scene.toml -o out --force --resume")
        .exits(0);
    assert_ne!(folder.read("out/Patch.glb"), b"mine");
    // From now on it is ruga's, whatever becomes of the manifest.
    folder.ruga("bake scene.toml -o out --resume").exits(0);
    folder
        .ruga("bake scene.toml -o out --maps-only --resume")
        .exits(0);
    folder.ruga("bake scene.toml -o out --resume").exits(0);
}

#[test]
fn the_scenes_own_mesh_is_not_replaced() {
    let folder = Folder::new();
    textured(&folder);
    folder.write("Patch.glb", folder.read("plain.glb"));
    folder.change("scene.toml", "patch.gltf", "Patch.glb");
    folder
        .ruga("bake scene.toml -o .")
        .exits(2)
        .says(&["Patch.glb", "--maps-only"]);
    assert_eq!(folder.read("Patch.glb"), folder.read("plain.glb"));
}
