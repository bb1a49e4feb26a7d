//! What a glTF document has around its mesh comes through a GLB of ruga's as it was.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod carried;
mod fixture;

use std::fs;
use std::path::{Path, PathBuf};

use carried::assert_carried;
use fixture::rigged::{ODD, rigged};
use fixture::{Folder, add_accessor, add_view, data_uri, floats, glb, read, square};
use nalgebra::{Vector3, Vector4};
use ruga_io::{
    GlbAdditions, MapCoordinates, MeshFile, ObjOptions, WrinkleMap, WrittenGlb, read_mesh,
    write_glb,
};
use ruga_io::{MapFormat, NormalY};
use serde_json::{Value, json};

/// Writes a mesh with tangents along x and two maps.
fn written(path: &Path, file: &MeshFile) -> WrittenGlb {
    let vertices = file.mesh.positions.len();
    let additions = GlbAdditions {
        tangents: Some(&vec![Vector4::new(1.0, 0.0, 0.0, 1.0); vertices]),
        normals: Some(&vec![Vector3::z(); vertices]),
        maps: &[
            WrinkleMap::normal("smile", 1.0, MapFormat::Png16, NormalY::Up),
            WrinkleMap::height("smile", 1.0, MapFormat::Png16, 1e-3),
        ],
        moved: &[],
    };
    write_glb(path, file, &additions).unwrap()
}

fn json_of(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// The file with numbers in it that JSON parsers change.
fn odd_glb(folder: &Folder, json: &Value, bin: &[u8]) -> PathBuf {
    let text = json.to_string().replace("\"ODD\"", ODD);
    assert!(text.matches(ODD).count() > 5);
    let mut padded = text.into_bytes();
    padded.resize(padded.len().next_multiple_of(4), b' ');
    let whole = glb(&json!({}), bin);
    let binary = &whole[24..];
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((20 + padded.len() + binary.len()) as u32).to_le_bytes());
    file.extend((padded.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(padded);
    file.extend(binary);
    folder.file("rigged.glb", file)
}

fn read_body(path: &Path) -> MeshFile {
    read_mesh(path, Some("Square"), &ObjOptions::default()).unwrap()
}

#[test]
fn rig_textures_animations_and_notes_stay() {
    let folder = Folder::new();
    let (json, bin) = rigged();
    let path = odd_glb(&folder, &json, &bin);
    let file = read_body(&path);
    assert!(
        file.warnings.iter().all(|w| w.contains("armature")),
        "{:?}",
        file.warnings
    );
    let out = folder.path("out.glb");
    let glb = written(&out, &file);
    assert_eq!(glb.warnings, [""; 0]);
    assert_carried(&path, &out, 0);

    let json = json_of(&out);
    let tangents = |i: usize| json["meshes"][0]["primitives"][i]["attributes"]["TANGENT"].clone();
    assert!(
        tangents(0).is_u64() && tangents(0) == tangents(1),
        "shared vertices, shared tangents"
    );
    assert!(json["meshes"][1]["primitives"][0]["attributes"]["TANGENT"].is_null());
    let maps = json
        .pointer(glb.reference.maps.as_deref().unwrap())
        .unwrap();
    assert_eq!(maps[0]["normal"], "maps/smile_100_normal.png");
    assert_eq!(maps[0]["height"], "maps/smile_100_height.png");
    assert_eq!(json["meshes"][0]["extras"]["targetNames"][0], "lift");
    assert_eq!(glb.reference.coordinates.len(), 2);

    // Written once more the list is replaced, and the tangents that are there are taken.
    let again = folder.path("again.glb");
    let copy = read_body(&out);
    assert_eq!(copy.mesh.positions, file.mesh.positions);
    assert_eq!(written(&again, &copy).warnings, [""; 0]);
    assert!(fs::read(&again).unwrap() == fs::read(&out).unwrap());
}

#[test]
fn files_of_buffers_and_images_are_copied_in() {
    let folder = Folder::new();
    let (mut json, mut bin) = rigged();
    folder.file(
        "skin colour.png",
        b"\x89PNG colour, which nobody can decode",
    );
    folder.file("height.ktx2", b"\xabKTX 20\xbb not decodable either");
    let images = json["images"].as_array_mut().unwrap();
    images.push(json!({"uri": "skin%20colour.png", "name": "colour"}));
    images.push(json!({"uri": "height.ktx2"}));
    images.push(json!({"uri": "gone.webp", "mimeType": "image/webp"}));
    images.push(json!({"uri": "https://example.org/a.png"}));
    // Positions in a buffer of their own.
    let moved = bin[..48].to_vec();
    bin[..48].fill(0);
    json["buffers"] = json!([
        {"byteLength": bin.len(), "uri": "a.bin", "name": "first"},
        {"byteLength": moved.len(), "uri": "b.bin", "extras": 3},
        {"byteLength": 4, "uri": data_uri(&[1, 2, 3, 4])},
    ]);
    json["bufferViews"][0]["buffer"] = json!(1);
    folder.file("a.bin", &bin);
    folder.file("b.bin", &moved);
    let text = json.to_string().replace("\"ODD\"", ODD);
    let path = folder.file("rigged.gltf", text);
    let file = read_body(&path);
    let says = |words: [&str; 2]| {
        let about = |w: &&String| words.iter().all(|word| w.contains(word));
        assert_eq!(
            file.warnings.iter().filter(about).count(),
            1,
            "{words:?}: {:?}",
            file.warnings
        );
    };
    says(["image 6", "`gone.webp`"]);
    says(["image 7", "https://example.org/a.png"]);
    let out = folder.path("elsewhere/out.glb");
    let glb = written(&out, &file);
    assert_eq!(glb.warnings, [""; 0], "said when it was read");
    let json = json_of(&out);
    assert_eq!(json["images"][4]["mimeType"], "image/png");
    assert_eq!(json["images"][5]["mimeType"], "image/ktx2");
    assert_eq!(json["images"][6]["uri"], "gone.webp");
    assert_eq!(json["buffers"][1]["uri"], data_uri(&moved));
    let copy = read_body(&out);
    assert_eq!(copy.mesh.positions, file.mesh.positions);
    assert_eq!(
        copy.mesh.shapes[0].position_deltas,
        file.mesh.shapes[0].position_deltas
    );
    fs::copy(
        folder.path("skin colour.png"),
        folder.path("skin%20colour.png"),
    )
    .unwrap();
    assert_carried(&path, &out, 0);
}

#[test]
fn tangents_of_the_file_stay() {
    let folder = Folder::new();
    for (x, w, differs) in [(1.0, 1.0, false), (0.9, 1.0, true), (1.0, -1.0, true)] {
        let (mut json, mut bin) = square();
        let rows = [x, f32::sqrt(1.0 - x * x), 0.0, w].repeat(4);
        let view = add_view(&mut json, &mut bin, &floats(&rows));
        let tangents = add_accessor(
            &mut json,
            json!({"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC4"}),
        );
        json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(tangents);
        let path = folder.file("a.glb", glb(&json, &bin));
        let out = folder.path("out.glb");
        let warnings = written(&out, &read(&path).unwrap()).warnings;
        assert_carried(&path, &out, 0);
        assert_eq!(
            json_of(&out)["meshes"][0]["primitives"],
            json["meshes"][0]["primitives"]
        );
        let says = warnings
            .iter()
            .any(|w| w.contains("4 of 4") && w.contains("MikkTSpace"));
        assert_eq!(says, differs, "{warnings:?}");
    }
}

#[test]
fn what_cannot_have_tangents_is_named() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    let primitive = &mut json["meshes"][0]["primitives"][0];
    primitive["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    json["meshes"][0]["extras"] = json!("a note");
    let path = folder.file("a.glb", glb(&json, &bin));
    let out = folder.path("out.glb");
    let glb_of_draco = written(&out, &read(&path).unwrap());
    for words in ["Draco", "`extras`"] {
        assert!(
            glb_of_draco.warnings.iter().any(|w| w.contains(words)),
            "{glb_of_draco:?}"
        );
    }
    assert_eq!(glb_of_draco.reference.maps, None);
    assert_carried(&path, &out, 0);
    assert_eq!(json_of(&out)["meshes"], json["meshes"]);

    let (mut json, bin) = square();
    let attributes = json["meshes"][0]["primitives"][0]["attributes"]
        .as_object_mut()
        .unwrap();
    attributes.remove("NORMAL");
    let mut bytes = glb(&json, &bin);
    bytes.extend([8, 0, 0, 0, b'X', b'T', b'R', b'A', 1, 2, 3, 4, 5, 6, 7, 8]);
    let length = (bytes.len() as u32).to_le_bytes();
    bytes[8..12].copy_from_slice(&length);
    let path = folder.file("b.glb", bytes);
    let file = read(&path).unwrap();
    assert!(
        file.warnings.iter().any(|w| w.contains("16 bytes")),
        "{:?}",
        file.warnings
    );
    let warnings = written(&out, &file).warnings;
    assert!(
        warnings.iter().any(|w| w.contains("no normals")),
        "{warnings:?}"
    );
    let json = json_of(&out);
    assert!(json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"].is_u64());
    assert_eq!(read(&out).unwrap().mesh.normals.unwrap()[3], Vector3::z());
}

#[test]
fn the_manifest_can_say_which_coordinates_the_maps_have() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    json["textures"] = json!([{}]);
    json["materials"] = json!([{"normalTexture": {"index": 0, "extensions":
        {"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 0.5, "scale": [1, 0.5]}}}}]);
    let file = folder.read_glb(&json, &bin).unwrap();
    let coordinates = written(&folder.path("out.glb"), &file)
        .reference
        .coordinates;
    let expected = MapCoordinates {
        primitive: 0,
        set: 0,
        offset: Some([0.5, 0.25]),
        rotation: Some(0.5),
        scale: Some([1.0, 0.5]),
    };
    assert_eq!(coordinates, [expected]);
}
