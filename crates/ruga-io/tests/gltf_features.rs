//! What glTF files may look like: sparse, strided, shared, transformed.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, add_accessor, add_view, floats, gltf, read, square};
use nalgebra::{Vector2, Vector3};
use ruga_io::{GlbAdditions, ObjOptions, read_mesh, write_glb};
use serde_json::json;

#[test]
fn the_square_reads() {
    let folder = Folder::new();
    let (json, bin) = square();
    let file = folder.read_glb(&json, &bin).unwrap();
    assert_eq!(file.mesh.name, "Square");
    assert_eq!(file.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(file.mesh.uvs.as_ref().unwrap()[1], Vector2::new(1.0, 1.0));
    assert_eq!(file.mesh.shapes[0].name, "lift");
    assert_eq!(
        file.mesh.shapes[0].position_deltas[2],
        Vector3::new(0.0, 0.0, 0.5)
    );
    assert_eq!(file.mesh.shapes[0].normal_deltas, None);
    assert_eq!(file.default_weights, [0.0]);
    let text = read(&folder.file("mesh.gltf", gltf(&json, &bin))).unwrap();
    assert_eq!(text.mesh.positions, file.mesh.positions);
}

#[test]
fn sparse_with_and_without_base() {
    let folder = Folder::new();
    for base in [true, false] {
        let (mut json, mut bin) = square();
        let index_view = add_view(&mut json, &mut bin, &[0, 3]);
        let value_view = add_view(
            &mut json,
            &mut bin,
            &floats(&[7.0, 8.0, 9.0, 1.0, 2.0, 3.0]),
        );
        let mut accessor = json["accessors"][4].clone();
        accessor["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": index_view, "componentType": 5121},
            "values": {"bufferView": value_view},
        });
        if !base {
            accessor.as_object_mut().unwrap().remove("bufferView");
        }
        json["accessors"][4] = accessor;
        let file = folder.read_glb(&json, &bin).unwrap();
        let deltas = &file.mesh.shapes[0].position_deltas;
        assert_eq!(deltas[0], Vector3::new(7.0, 8.0, 9.0));
        assert_eq!(deltas[3], Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(deltas[2].z, if base { 0.5 } else { 0.0 });
    }
}

#[test]
fn interleaved_attributes_and_no_indices() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    let mut rows = Vec::new();
    for vertex in 0..3 {
        rows.extend(floats(&[vertex as f32, 2.0, 3.0, 0.0, 0.0, 1.0]));
    }
    let view = add_view(&mut json, &mut bin, &rows);
    json["bufferViews"][view]["byteStride"] = json!(24);
    let vectors = |offset: usize| json!({"bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 3, "type": "VEC3"});
    let position = add_accessor(&mut json, vectors(0));
    let normal = add_accessor(&mut json, vectors(12));
    json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": position, "NORMAL": normal}}]);
    let mesh = folder.read_glb(&json, &bin).unwrap().mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(mesh.positions[2], Vector3::new(2.0, 2.0, 3.0));
    assert_eq!(mesh.normals.unwrap()[2], Vector3::z());
    assert_eq!(mesh.uvs, None);
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["accessors"][3]["count"] = json!(4);
    let mut bin_strip = bin.clone();
    bin_strip[128..136].copy_from_slice(&[0, 0, 1, 0, 3, 0, 2, 0]);
    json["meshes"][0]["primitives"][0]["mode"] = json!(5);
    let strip = folder.read_glb(&json, &bin_strip).unwrap().mesh;
    assert_eq!(strip.triangles, [[0, 1, 3], [1, 2, 3]]);
    let mut bin_fan = bin;
    bin_fan[128..136].copy_from_slice(&[0, 0, 1, 0, 2, 0, 3, 0]);
    json["meshes"][0]["primitives"][0]["mode"] = json!(6);
    let fan = folder.read_glb(&json, &bin_fan).unwrap().mesh;
    assert_eq!(fan.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn primitives_are_joined_and_shared_vertices_stay_shared() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    json["materials"] = json!([{"name": "A"}, {"name": "B", "doubleSided": true}]);
    let mut second = json["meshes"][0]["primitives"][0].clone();
    second["material"] = json!(1);
    json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(second.clone());
    let shared = folder.read_glb(&json, &bin).unwrap();
    assert_eq!(shared.mesh.positions.len(), 4);
    assert_eq!(shared.mesh.triangles.len(), 4);
    assert!(shared.parts[1].material.as_ref().unwrap().double_sided);
    let moved: Vec<u8> = floats(&[5.0; 12]);
    let view = add_view(&mut json, &mut bin, &moved);
    let position = add_accessor(
        &mut json,
        json!({"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"}),
    );
    json["meshes"][0]["primitives"][1]["attributes"] = json!({"POSITION": position, "NORMAL": 1});
    let joined = folder.read_glb(&json, &bin).unwrap();
    assert_eq!(joined.mesh.positions.len(), 8);
    assert_eq!(joined.mesh.triangles[2], [4, 5, 6]);
    assert_eq!(
        joined.mesh.shapes[0].position_deltas[6],
        Vector3::new(0.0, 0.0, 0.5)
    );
    assert_eq!(joined.mesh.uvs.unwrap()[4], Vector2::zeros());
    assert!(
        joined
            .warnings
            .iter()
            .any(|w| w.contains("texture coordinates"))
    );
}

#[test]
fn zero_normal_deltas_count_as_missing() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    let accessor =
        |view| json!({"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"});
    let zeros = add_view(&mut json, &mut bin, &floats(&[0.0; 12]));
    let zeros = add_accessor(&mut json, accessor(zeros));
    json["meshes"][0]["primitives"][0]["targets"][0]["NORMAL"] = json!(zeros);
    let mesh = folder.read_glb(&json, &bin).unwrap().mesh;
    assert_eq!(mesh.shapes[0].normal_deltas, None);
    let some = add_view(&mut json, &mut bin, &floats(&[0.1; 12]));
    let some = add_accessor(&mut json, accessor(some));
    json["meshes"][0]["primitives"][0]["targets"][0]["NORMAL"] = json!(some);
    let mesh = folder.read_glb(&json, &bin).unwrap().mesh;
    assert!(mesh.shapes[0].normal_deltas.is_some());
}

#[test]
fn repeated_and_missing_target_names() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": 4}, {"POSITION": 4}, {"POSITION": 4}]);
    json["meshes"][0]["extras"]["targetNames"] = json!(["a", "a"]);
    let file = folder.read_glb(&json, &bin).unwrap();
    let names: Vec<_> = file.mesh.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a", "a_2", "shape_2"]);
    assert!(file.warnings.iter().any(|w| w.contains("`a`")));
}

#[test]
fn the_normal_textures_coordinates_are_used() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    let second = add_view(&mut json, &mut bin, &floats(&[0.25; 8]));
    let second = add_accessor(
        &mut json,
        json!({"bufferView": second, "componentType": 5126, "count": 4, "type": "VEC2"}),
    );
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(second);
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    json["textures"] = json!([{}]);
    let uv = |json: &serde_json::Value| folder.read_glb(json, &bin).unwrap().mesh.uvs.unwrap()[0];
    json["materials"] =
        json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}]);
    assert_eq!(uv(&json), Vector2::new(0.25, 0.25));
    json["materials"][0]["normalTexture"] = json!({"index": 0, "texCoord": 0});
    assert_eq!(uv(&json), Vector2::new(0.0, 1.0));
    let transform = json!({"KHR_texture_transform": {"texCoord": 1, "scale": [2, 4]}});
    json["materials"][0]["normalTexture"]["extensions"] = transform;
    assert_eq!(uv(&json), Vector2::new(0.5, 1.0));
    json["materials"][0]["normalTexture"] = json!({"index": 0, "texCoord": 5});
    assert_eq!(
        uv(&json),
        Vector2::new(0.25, 0.25),
        "a set that is missing is passed over"
    );
}

/// The extension's worked example: "only the lower left quadrant, rotated clockwise 90 degrees".
#[test]
fn texture_transforms_turn_the_right_way() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    json["textures"] = json!([{}]);
    json["materials"] = json!([{"normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
        "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5]}}}}]);
    let uvs = folder.read_glb(&json, &bin).unwrap().mesh.uvs.unwrap();
    for uv in &uvs {
        assert!(
            uv.x > -1e-6 && uv.x < 0.5 + 1e-6 && uv.y > 0.5 - 1e-6 && uv.y < 1.0 + 1e-6,
            "{uv}"
        );
    }
    // The corner (1, 0), right of the origin, turns up, which is towards smaller V.
    assert!(
        (uvs[2] - Vector2::new(0.0, 0.5)).norm() < 1e-6,
        "{}",
        uvs[2]
    );
}

#[test]
fn quantized_positions() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mut bytes = Vec::new();
    for value in [
        [0, 0, 0, 0],
        [32767, 0, 0, 0],
        [0, -32767, 0, 0],
        [-32768, 0, 16384, 0],
    ] {
        bytes.extend(value.iter().flat_map(|v: &i16| v.to_le_bytes()));
    }
    let view = add_view(&mut json, &mut bin, &bytes);
    json["bufferViews"][view]["byteStride"] = json!(8);
    let accessor = json!({"bufferView": view, "componentType": 5122, "normalized": true, "count": 4, "type": "VEC3"});
    let position = add_accessor(&mut json, accessor);
    json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(position);
    json["nodes"][0]["scale"] = json!([0.5, 0.5, 0.5]);
    let positions = folder.read_glb(&json, &bin).unwrap().mesh.positions;
    assert_eq!(positions[1], Vector3::new(0.5, 0.0, 0.0));
    assert_eq!(positions[2], Vector3::new(0.0, -0.5, 0.0));
    assert_eq!(positions[3].x, -0.5);
    json["accessors"][position]["normalized"] = json!(false);
    json["nodes"][0]["scale"] = json!([1, 1, 1]);
    let positions = folder.read_glb(&json, &bin).unwrap().mesh.positions;
    assert_eq!(positions[1].x, 32767.0);
}

#[test]
fn node_scale_makes_metres_and_rotation_does_nothing() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["nodes"] = json!([
        {"name": "Root", "scale": [0.01, 0.01, 0.01], "children": [1]},
        {"mesh": 0, "rotation": [0.6, 0, 0, 0.8], "translation": [5, 6, 7]},
    ]);
    let file = folder.read_glb(&json, &bin).unwrap();
    assert!((file.mesh.positions[2] - Vector3::new(0.01, 0.01, 0.0)).norm() < 1e-8);
    assert!((file.mesh.shapes[0].position_deltas[2].z - 0.005).abs() < 1e-8);
    assert!((file.stretch[(0, 0)] - 0.01).abs() < 1e-8);
    json["nodes"] = json!([{"mesh": 0, "scale": [-2, 2, 2]}]);
    let mirrored = folder.read_glb(&json, &bin).unwrap();
    assert!((mirrored.mesh.positions[1] - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-12);
    assert_eq!(mirrored.mesh.triangles[0], [0, 1, 2]);
    json["nodes"] = json!([{"mesh": 0, "scale": [2, 1, 3]}]);
    let stretched = folder.read_glb(&json, &bin).unwrap();
    assert!((stretched.mesh.positions[2] - Vector3::new(2.0, 1.0, 0.0)).norm() < 1e-12);
    assert!((stretched.mesh.shapes[0].position_deltas[2].z - 1.5).abs() < 1e-12);
    assert!((stretched.mesh.normals.unwrap()[0] - Vector3::z()).norm() < 1e-12);
}

/// `[driver] scale`: metres inside, the file's own unit in what is written.
#[test]
fn a_scaled_mesh_is_written_back_in_its_own_unit() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    let node = json!({"mesh": 0, "scale": [3, 3, 3], "rotation": [0.6, 0, 0, 0.8], "translation": [5, 6, 7]});
    json["nodes"] = json!([node]);
    let file = folder.read_glb(&json, &bin).unwrap();
    let scaled = file.clone().scaled(0.0254);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    close(scaled.mesh.positions[1].x, 3.0 * 0.0254);
    close(scaled.mesh.shapes[0].position_deltas[2].z, 1.5 * 0.0254);
    close(scaled.world_from_node[(2, 3)], 7.0 * 0.0254);
    close(scaled.metres_per_unit, 0.0254);
    let copy = folder.path("copy.glb");
    write_glb(&copy, &scaled, &GlbAdditions::default()).unwrap();
    let again = read_mesh(&copy, None, &ObjOptions::default()).unwrap();
    assert!((again.world_from_node - file.world_from_node).norm() < 1e-6);
    for (a, b) in again.mesh.positions.iter().zip(&file.mesh.positions) {
        assert!((a - b).norm() <= 1e-6, "{a} {b}");
    }
}

/// Mixamo and the like: joints in centimetres under a scaled armature.
#[test]
fn a_skin_takes_its_scale_from_its_first_joint() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    let mut bind = [0.0; 16];
    for i in 0..4 {
        bind[5 * i] = 1.0;
    }
    let view = add_view(&mut json, &mut bin, &floats(&bind));
    let bind = add_accessor(
        &mut json,
        json!({"bufferView": view, "componentType": 5126, "count": 1, "type": "MAT4"}),
    );
    json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "scale": [9, 9, 9]},
        {"name": "Armature", "scale": [0.01, 0.01, 0.01], "children": [2]},
        {"name": "Hips"},
    ]);
    json["skins"] = json!([{"joints": [2], "inverseBindMatrices": bind}]);
    let file = folder.read_glb(&json, &bin).unwrap();
    assert!((file.mesh.positions[1].x - 0.01).abs() < 1e-8);
    let says_armature = |w: &String| w.contains("armature") && !w.contains("skin ");
    assert!(file.warnings.iter().any(says_armature));
}

#[test]
fn instances_of_different_size_are_told() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [2, 2, 2]}]);
    let file = folder.read_glb(&json, &bin).unwrap();
    assert_eq!(file.mesh.positions[1].x, 1.0);
    assert!(file.warnings.iter().any(|w| w.contains("different scales")));
}
