//! Whatever happens to a file's bytes, reading it gives a result or an error, never a panic.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::path::Path;

use fixture::{Folder, SQUARE_OBJ, add_view, floats, glb, gltf, read, square};
use nalgebra::{Vector3, Vector4};
use proptest::prelude::*;
use ruga_io::{
    ExrTexels, GlbAdditions, ObjOptions, PngTexels, read_image, read_mask, read_mesh, write_exr,
    write_glb, write_png,
};
use serde_json::json;

/// Bytes to overwrite, and where to cut.
fn damage() -> impl Strategy<Value = (Vec<(usize, u8)>, Option<usize>)> {
    (
        prop::collection::vec((any::<usize>(), any::<u8>()), 1..6),
        prop::option::weighted(0.2, any::<usize>()),
    )
}

fn apply(bytes: &[u8], (writes, cut): &(Vec<(usize, u8)>, Option<usize>)) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, value) in writes {
        let at = at % bytes.len();
        bytes[at] = *value;
    }
    if let Some(cut) = cut {
        bytes.truncate(cut % (bytes.len() + 1));
    }
    bytes
}

/// The square with a sparse target, a skin and a transformed texture: more to damage.
fn rich_square() -> (serde_json::Value, Vec<u8>) {
    let (mut json, mut bin) = square();
    let index_view = add_view(&mut json, &mut bin, &[0, 0, 3, 0]);
    let value_view = add_view(&mut json, &mut bin, &floats(&[1.0; 6]));
    json["accessors"][4]["sparse"] = json!({
        "count": 2,
        "indices": {"bufferView": index_view, "componentType": 5123},
        "values": {"bufferView": value_view},
    });
    json["nodes"] = json!([
        {"mesh": 0, "rotation": [0, 0, 0.6, 0.8], "scale": [2, 2, 2], "children": [1]},
        {"translation": [1, 2, 3]},
    ]);
    json["textures"] = json!([{}]);
    json["materials"] = json!([{"normalTexture": {"index": 0, "extensions":
        {"KHR_texture_transform": {"rotation": 1.5, "scale": [2, 3]}}}}]);
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    (json, bin)
}

/// What reads must also be free of numbers that spread, and what is written of it must read.
fn check_mesh(path: &Path) {
    if let Ok(file) = read(path) {
        let vertices = file.mesh.positions.len();
        assert!(file.mesh.positions.iter().flatten().all(|x| x.is_finite()));
        assert!(
            file.mesh
                .triangles
                .iter()
                .flatten()
                .all(|i| (*i as usize) < vertices)
        );
        for shape in &file.mesh.shapes {
            assert_eq!(shape.position_deltas.len(), vertices);
        }
        let additions = GlbAdditions {
            tangents: Some(&vec![Vector4::x(); vertices]),
            normals: Some(&vec![Vector3::z(); vertices]),
            maps: &[],
            moved: &[],
        };
        let out = path.with_file_name("out.glb");
        if write_glb(&out, &file, &additions).is_ok() {
            let again = read_mesh(&out, Some(&file.mesh.name), &ObjOptions::default()).unwrap();
            assert_eq!(again.mesh.positions.len(), vertices);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_glb(damage in damage()) {
        let (json, bin) = rich_square();
        let folder = Folder::new();
        check_mesh(&folder.file("a.glb", apply(&glb(&json, &bin), &damage)));
    }

    #[test]
    fn damaged_gltf(damage in damage()) {
        let (json, bin) = rich_square();
        let folder = Folder::new();
        check_mesh(&folder.file("a.gltf", apply(&gltf(&json, &bin), &damage)));
    }

    #[test]
    fn wild_numbers_in_gltf(place in 0..18_usize, value in prop_oneof![
        Just(0_u64), Just(1), Just(3), Just(7), Just(u64::from(u32::MAX)), Just(u64::MAX), any::<u64>(),
    ]) {
        let (mut json, bin) = rich_square();
        let pointer = [
            "/accessors/0/count", "/accessors/0/byteOffset", "/accessors/0/bufferView",
            "/accessors/3/componentType", "/accessors/4/sparse/count",
            "/accessors/4/sparse/indices/bufferView", "/accessors/4/sparse/indices/byteOffset",
            "/accessors/4/sparse/values/byteOffset", "/bufferViews/0/byteOffset",
            "/bufferViews/0/byteLength", "/bufferViews/0/byteStride", "/bufferViews/0/buffer",
            "/buffers/0/byteLength", "/meshes/0/primitives/0/indices",
            "/meshes/0/primitives/0/attributes/POSITION", "/meshes/0/primitives/0/material",
            "/nodes/0/children/0", "/nodes/0/mesh",
        ][place];
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = json.pointer_mut(parent).unwrap();
        match key.parse::<usize>() {
            Ok(index) if parent.is_array() => parent[index] = json!(value),
            _ => parent[key] = json!(value),
        }
        let folder = Folder::new();
        check_mesh(&folder.file("a.glb", glb(&json, &bin)));
    }

    #[test]
    fn damaged_obj(damage in damage()) {
        let folder = Folder::new();
        check_mesh(&folder.file("a.obj", apply(SQUARE_OBJ.as_bytes(), &damage)));
    }

    #[test]
    fn damaged_png(damage in damage()) {
        let folder = Folder::new();
        let path = folder.path("a.png");
        write_png(&path, 5, 4, PngTexels::Rgb16(&[1000; 60])).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let _ = read_mask(&folder.file("b.png", apply(&bytes, &damage)));
    }

    #[test]
    fn damaged_exr(damage in damage()) {
        let folder = Folder::new();
        let path = folder.path("a.exr");
        write_exr(&path, 5, 4, ExrTexels::Rgb(&[0.5; 60])).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let _ = read_image(&folder.file("b.exr", apply(&bytes, &damage)));
    }
}
