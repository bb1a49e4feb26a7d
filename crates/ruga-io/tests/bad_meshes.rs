//! Every way to give a bad mesh is refused with words that help.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::collections::BTreeMap;

use fixture::{Folder, SQUARE_OBJ, add_accessor, add_view, assert_says, glb, gltf, read, square};
use ruga_io::{ObjOptions, read_mesh};
use serde_json::json;

#[test]
fn not_a_file() {
    let folder = Folder::new();
    assert_says(
        read(&folder.path("no.glb")),
        "no.glb",
        &["cannot read", "no such file"],
    );
    std::fs::create_dir(folder.path("folder.glb")).unwrap();
    assert_says(read(&folder.path("folder.glb")), "folder.glb", &["folder"]);
    assert_says(
        read(&folder.file("mesh.fbx", b"x")),
        "mesh.fbx",
        &[".glb, .gltf, .obj"],
    );
}

#[test]
fn not_gltf() {
    let folder = Folder::new();
    let (json, bin) = square();
    let mut bytes = glb(&json, &bin);
    bytes[3] = b'G';
    assert_says(
        read(&folder.file("magic.glb", &bytes)),
        "magic.glb",
        &["glTF"],
    );
    bytes[3] = b'F';
    bytes[4] = 1;
    assert_says(
        read(&folder.file("old.glb", &bytes)),
        "old.glb",
        &["version"],
    );
    bytes[4] = 2;
    for length in [0, 3, 11, 19, 40, bytes.len() - 1] {
        let path = folder.file("cut.glb", &bytes[..length]);
        assert!(read(&path).is_err(), "cut at {length}");
    }
    bytes[8..12].copy_from_slice(&5_u32.to_le_bytes());
    assert_says(
        read(&folder.file("short.glb", &bytes)),
        "short.glb",
        &["5 bytes"],
    );
    let broken = folder.file("broken.gltf", b"{\"asset\": ");
    assert_says(read(&broken), "broken.gltf", &["JSON", "line 1"]);
    let wrong = folder.file(
        "wrong.gltf",
        b"{\"asset\": {\"version\": \"2.0\"}, \"meshes\": 3}",
    );
    assert_says(read(&wrong), "wrong.gltf", &["JSON"]);
}

#[test]
fn accessor_out_of_range() {
    let folder = Folder::new();
    let (json, bin) = square();
    let mut count = json.clone();
    count["accessors"][0]["count"] = json!(5);
    assert_says(
        folder.read_glb(&count, &bin),
        "mesh.glb",
        &["accessor 0", "60 bytes", "48"],
    );
    let mut huge = json.clone();
    huge["accessors"][0]["count"] = json!(u64::MAX);
    assert_says(
        folder.read_glb(&huge, &bin),
        "mesh.glb",
        &["accessor 0", "count"],
    );
    let mut offset = json.clone();
    offset["accessors"][0]["byteOffset"] = json!(u64::MAX);
    assert_says(
        folder.read_glb(&offset, &bin),
        "mesh.glb",
        &["accessor 0", "offset"],
    );
    let mut view = json.clone();
    view["bufferViews"][0]["byteLength"] = json!(u64::MAX);
    assert_says(
        folder.read_glb(&view, &bin),
        "mesh.glb",
        &["bufferView 0", "buffer 0"],
    );
    let mut missing = json.clone();
    missing["accessors"][0]["bufferView"] = json!(99);
    assert_says(
        folder.read_glb(&missing, &bin),
        "mesh.glb",
        &["bufferView 99"],
    );
    let mut attribute = json.clone();
    attribute["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77);
    assert_says(
        folder.read_glb(&attribute, &bin),
        "mesh.glb",
        &["accessor 77", "5 accessors"],
    );
    let mut stride = json.clone();
    stride["bufferViews"][0]["byteStride"] = json!(8);
    assert_says(
        folder.read_glb(&stride, &bin),
        "mesh.glb",
        &["byteStride 8"],
    );
    let mut kind = json.clone();
    kind["accessors"][0]["type"] = json!("VEC2");
    assert_says(
        folder.read_glb(&kind, &bin),
        "mesh.glb",
        &["POSITION", "Vec2", "Vec3"],
    );
    let mut counts = json;
    counts["accessors"][1]["count"] = json!(3);
    assert_says(
        folder.read_glb(&counts, &bin),
        "mesh.glb",
        &["NORMAL", "3 elements", "4"],
    );
}

#[test]
fn index_out_of_range() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    bin[128] = 9;
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["index 0 is 9", "4 vertices"],
    );
    bin[128] = 0;
    json["accessors"][3]["count"] = json!(5);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["5 corners", "multiple of 3"],
    );
    json["accessors"][3] =
        json!({"bufferView": 0, "componentType": 5126, "count": 6, "type": "SCALAR"});
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["unsigned integers"],
    );
}

#[test]
fn numbers_that_are_not_finite() {
    let folder = Folder::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (offset, role) in [(16, "POSITION"), (144, "target 0"), (100, "TEXCOORD_0")] {
            let (json, mut bin) = square();
            bin[offset..offset + 4].copy_from_slice(&bad.to_le_bytes());
            assert_says(folder.read_glb(&json, &bin), "mesh.glb", &[role, "finite"]);
        }
    }
    let (mut json, bin) = square();
    json["nodes"][0]["scale"] = json!([1e300, 1.0, 1.0]);
    assert!(folder.read_glb(&json, &bin).is_err());
    json["nodes"][0]["scale"] = json!([1.0, 0.0, 1.0]);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["node 0", "scale is zero"],
    );
}

#[test]
fn sparse_accessors_that_lie() {
    let folder = Folder::new();
    let sparse = |indices: &[u16], count: usize| {
        let (mut json, mut bin) = square();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let index_view = add_view(&mut json, &mut bin, &bytes);
        let value_view = add_view(&mut json, &mut bin, &[0; 24]);
        json["accessors"][4]["sparse"] = json!({
            "count": count,
            "indices": {"bufferView": index_view, "componentType": 5123},
            "values": {"bufferView": value_view},
        });
        (json, bin)
    };
    let refused = |indices: &[u16], count: usize, words: &[&str]| {
        let (json, bin) = sparse(indices, count);
        assert_says(folder.read_glb(&json, &bin), "mesh.glb", words);
    };
    refused(&[2, 1], 2, &["strictly increase"]);
    refused(&[1, 1], 2, &["strictly increase"]);
    refused(&[1, 4], 2, &["sparse index 4", "count is 4"]);
    refused(&[0, 1], 3, &["needs"]);
    let (mut json, bin) = sparse(&[0, 1], 2);
    json["accessors"][4]["bufferView"].take();
    json["accessors"][4]["count"] = json!(u32::MAX);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["without a bufferView"],
    );
}

#[test]
fn buffers_that_are_not_there() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["buffers"][0]["uri"] = json!("mesh%20data.bin");
    let path = folder.file("outside.gltf", json.to_string());
    assert_says(read(&path), "mesh data.bin", &["cannot read"]);
    folder.file("mesh data.bin", &bin[..100]);
    assert_says(
        read(&path),
        "outside.gltf",
        &["buffer 0", "byteLength is 188", "found 100"],
    );
    folder.file("mesh data.bin", &bin);
    assert!(read(&path).is_ok());
    json["buffers"][0]["uri"] = json!("https://example.com/mesh.bin");
    assert_says(
        read(&folder.file("web.gltf", json.to_string())),
        "web.gltf",
        &["buffer 0", "relative"],
    );
    for bad in [
        "data:;base64,AA*A",
        "data:;base64,A",
        "data:text/plain,hello",
    ] {
        json["buffers"][0]["uri"] = json!(bad);
        let path = folder.file("base64.gltf", json.to_string());
        assert_says(read(&path), "base64.gltf", &["buffer 0", "base64"]);
    }
    json["buffers"][0]["uri"].take();
    assert_says(
        read(&folder.file("none.gltf", json.to_string())),
        "none.gltf",
        &["buffer 0"],
    );
}

#[test]
fn meshes_that_cannot_be_used() {
    let folder = Folder::new();
    let (json, bin) = square();
    let mut points = json.clone();
    points["meshes"][0]["primitives"][0]["mode"] = json!(0);
    assert_says(
        folder.read_glb(&points, &bin),
        "mesh.glb",
        &["Square", "no triangles"],
    );
    let mut none = json.clone();
    none["meshes"] = json!([]);
    none["nodes"] = json!([]);
    assert_says(folder.read_glb(&none, &bin), "mesh.glb", &["has none"]);
    let mut bare = json.clone();
    bare["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 1});
    assert_says(folder.read_glb(&bare, &bin), "mesh.glb", &["no POSITION"]);
    let mut two = json.clone();
    let mut second = two["meshes"][0].clone();
    second["name"] = json!("Sphere");
    two["meshes"].as_array_mut().unwrap().push(second);
    assert_says(
        folder.read_glb(&two, &bin),
        "mesh.glb",
        &["mesh_name", "`Square`, `Sphere`"],
    );
    let path = folder.file("two.glb", glb(&two, &bin));
    let named = |name: &str| read_mesh(&path, Some(name), &ObjOptions::default());
    assert_says(
        named("Sqare"),
        "two.glb",
        &["`Sqare`", "did you mean `Square`"],
    );
    assert_eq!(named("Sphere").unwrap().mesh.name, "Sphere");
    assert_eq!(
        named("Node").unwrap().mesh.name,
        "Square",
        "an object's name will do"
    );
    let mut targets = json.clone();
    let mut other = targets["meshes"][0]["primitives"][0].clone();
    other["targets"] = json!([]);
    targets["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(other);
    assert_says(
        folder.read_glb(&targets, &bin),
        "mesh.glb",
        &["primitive 1", "0 morph targets"],
    );
    let mut draco = json;
    draco["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_says(
        folder.read_glb(&draco, &bin),
        "mesh.glb",
        &["without mesh compression"],
    );
}

#[test]
fn nodes_in_a_circle() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [0]}]);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["node 0", "ancestor"],
    );
    let skin = add_accessor(
        &mut json,
        json!({"bufferView": 0, "componentType": 5126, "count": 1, "type": "MAT4"}),
    );
    json["nodes"] = json!([{"mesh": 0, "skin": 0}]);
    json["skins"] = json!([{"joints": [7], "inverseBindMatrices": skin}]);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["skin 0", "joint"],
    );
    let text = gltf(&json, &bin);
    assert_says(
        read(&folder.file("skin.gltf", text)),
        "skin.gltf",
        &["skin 0"],
    );
}

#[test]
fn obj_files() {
    let folder = Folder::new();
    assert_says(
        read(&folder.file("empty.obj", "")),
        "empty.obj",
        &["no triangles"],
    );
    let bad = folder.file("face.obj", "v 0 0 0\nf 1 2 3\n");
    assert_says(read(&bad), "face.obj", &["line 2", "index 2", "1 vertices"]);
    let bad = folder.file("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_says(read(&bad), "nan.obj", &["finite"]);
    let good = folder.file("good.obj", SQUARE_OBJ);
    let wrong = read_mesh(&good, Some("Squre"), &ObjOptions::default());
    assert_says(wrong, "good.obj", &["did you mean `Square`"]);
}

#[test]
fn obj_targets_that_do_not_fit() {
    let folder = Folder::new();
    let rest = folder.file("rest.obj", SQUARE_OBJ);
    let refused = |text: &str, words: &[&str]| {
        let file = folder.file("smile.obj", text);
        let options = ObjOptions {
            targets: BTreeMap::from([("smile".to_owned(), file)]),
            ..ObjOptions::default()
        };
        assert_says(read_mesh(&rest, None, &options), "smile.obj", words);
    };
    refused(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
        &["`smile`", "3 positions", "4"],
    );
    refused(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 3\n",
        &["3 triangles", "2"],
    );
    refused(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 4 3\n",
        &["triangle 1"],
    );
    refused("v 0 0 x\n", &["OBJ"]);
}
