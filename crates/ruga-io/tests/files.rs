//! Meshes, frames, manifests: what is written reads back, and nothing is left half-written.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;

use fixture::{Folder, SQUARE_OBJ, assert_says, floats, read, square};
use nalgebra::{Vector2, Vector3, Vector4};
use ruga_bake::{Detail, Encoding};
use ruga_io::{
    AtomicFile, ExrTexels, FrameMesh, GlbAdditions, LayerReport, LengthUnit, ObjOptions, PngTexels,
    PoseReport, Report, WrinkleMap, Wrinkles, map_file, read_mesh, write_atomically, write_exr,
    write_glb, write_obj_frame, write_png,
};
use ruga_io::{Frame, MapFormat, MapKind, NormalY};
use serde_json::{Value, json};

#[test]
fn files_are_whole_or_absent() {
    let folder = Folder::new();
    let path = folder.path("deep/down/a.txt");
    write_atomically(&path, b"old").unwrap();
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"half").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    drop(file);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    let mut file = AtomicFile::create(&path).unwrap();
    file.write_all(b"new").unwrap();
    file.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    let left: Vec<_> = fs::read_dir(folder.path("deep/down")).unwrap().collect();
    assert_eq!(left.len(), 1, "no temporary is left");
}

/// Temporary files are their owner's alone; what is finished is for everybody whom the umask lets.
#[cfg(unix)]
#[test]
fn finished_files_are_like_any_other() {
    use std::os::unix::fs::MetadataExt;

    let folder = Folder::new();
    let path = folder.path("a.txt");
    write_atomically(&path, b"x").unwrap();
    let mode = |path| fs::metadata(path).unwrap().mode();
    assert_eq!(mode(path), mode(folder.file("b.txt", b"x")));
}

#[test]
fn unwritable_places() {
    let folder = Folder::new();
    folder.file("file", b"x");
    let below = folder.path("file/a.png");
    let (json, bin) = square();
    let mesh = folder.read_glb(&json, &bin).unwrap();
    let frame = FrameMesh {
        name: "a",
        positions: &[],
        triangles: &[],
        uvs: &[],
        uv_triangles: &[],
    };
    let words = ["cannot write"];
    assert_says(
        write_png(&below, 1, 1, PngTexels::Grey8(&[0])),
        "file/a.png",
        &words,
    );
    assert_says(
        write_exr(&below, 1, 1, ExrTexels::Grey(&[0.0])),
        "file/a.png",
        &words,
    );
    assert_says(
        write_glb(&below, &mesh, &GlbAdditions::default()),
        "file/a.png",
        &words,
    );
    assert_says(write_obj_frame(&below, &frame), "file/a.png", &words);
    assert_says(Report::new("1", "s").write(&below), "file/a.png", &words);
    assert_says(
        Wrinkles::new("m", Frame::Driver, 16).write(&below),
        "file/a.png",
        &words,
    );
    fs::create_dir(folder.path("folder.png")).unwrap();
    let onto = write_atomically(&folder.path("folder.png"), b"x");
    assert_says(onto, "folder.png", &["cannot write", "folder"]);
    assert_eq!(folder.names(), ["file", "folder.png", "mesh.glb"]);
}

#[test]
fn obj_frames() {
    let folder = Folder::new();
    let positions = [
        [0.1, 0.2, 0.3],
        [1.0 / 3.0, -2e-7, 0.0],
        [0.0, 1.0, 0.123_456_789_4],
    ];
    let positions = positions.map(Vector3::from);
    let uvs = [[0.0, 0.0], [1.0, 0.25], [0.5, 1.0], [0.75, 0.75]].map(Vector2::from);
    let frame = FrameMesh {
        name: "dermis",
        positions: &positions,
        triangles: &[[0, 1, 2], [2, 1, 0]],
        uvs: &uvs,
        uv_triangles: &[[0, 1, 2], [3, 1, 0]],
    };
    let path = folder.path("frame.obj");
    write_obj_frame(&path, &frame).unwrap();
    let mesh = read(&path).unwrap().mesh;
    assert_eq!(mesh.name, "dermis");
    assert_eq!(
        mesh.positions.len(),
        4,
        "a vertex with two UVs is two vertices"
    );
    for (corner, expected) in mesh.triangles.as_flattened().iter().zip([0, 1, 2, 2, 1, 0]) {
        let error = (mesh.positions[*corner as usize] - positions[expected]).norm();
        assert!(error < 1e-9, "{error} m");
    }
    for (corner, expected) in mesh.triangles.as_flattened().iter().zip([0, 1, 2, 3, 1, 0]) {
        let error = (mesh.uvs.as_ref().unwrap()[*corner as usize] - uvs[expected]).norm();
        assert!(error < 2e-9, "{error}");
    }
    let beyond = FrameMesh {
        triangles: &[[0, 1, 3]],
        uv_triangles: &[],
        ..frame
    };
    assert_says(write_obj_frame(&path, &beyond), "frame.obj", &["index"]);
    let short = FrameMesh {
        uv_triangles: &[[0, 1, 2]],
        ..frame
    };
    assert_says(
        write_obj_frame(&path, &short),
        "frame.obj",
        &["1 UV triangles"],
    );
}

#[test]
fn obj_with_targets() {
    let folder = Folder::new();
    let rest = folder.file("rest.obj", SQUARE_OBJ);
    // Another object name, other normals, no UVs: only positions and faces count.
    let target = "o smile\nv 0 0 0\nv 1 0 0\nv 1 1 2\nv 0 1 0\nvn 0 1 0\nvn 1 0 0\nf 1//1 2//2 3//1\nf 1//2 3//1 4//2\n";
    let options = ObjOptions {
        targets: BTreeMap::from([("smile".to_owned(), folder.file("smile.obj", target))]),
        length_unit: LengthUnit::Centimetre,
    };
    let mesh = read_mesh(&rest, Some("Square"), &options).unwrap().mesh;
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.positions[1], Vector3::new(0.01, 0.0, 0.0));
    assert_eq!(
        mesh.uvs.as_ref().unwrap()[0],
        Vector2::new(0.0, 1.0),
        "V points down"
    );
    let moved: Vec<f64> = mesh.shapes[0].position_deltas.iter().map(|d| d.z).collect();
    assert_eq!(moved, [0.0, 0.0, 0.02, 0.0, 0.0]);
    assert_eq!(mesh.shapes[0].normal_deltas, None);
    let quad = folder.file(
        "quad.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
    );
    let file = read(&quad).unwrap();
    assert_eq!(file.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(file.mesh.name, "quad");
    let copy = folder.path("copy.glb");
    write_glb(&copy, &file, &GlbAdditions::default()).unwrap();
    assert_eq!(read(&copy).unwrap().mesh.positions, file.mesh.positions);
}

#[test]
fn glb_with_scale_and_parts_returns() {
    let folder = Folder::new();
    let (mut json, mut bin) = square();
    let view = fixture::add_view(&mut json, &mut bin, &floats(&[0.1; 12]));
    let other = fixture::add_accessor(
        &mut json,
        json!({"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"}),
    );
    let mut second = json["meshes"][0]["primitives"][0].clone();
    second["attributes"]["POSITION"] = json!(other);
    json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(second);
    json["meshes"][0]["weights"] = json!([0.25]);
    json["materials"] = json!([{"name": "Skin", "pbrMetallicRoughness": {"metallicFactor": 0}}]);
    json["meshes"][0]["primitives"][0]["material"] = json!(0);
    for node in [
        json!({"mesh": 0, "scale": [0.01, 0.01, 0.01], "rotation": [0.6, 0, 0, 0.8], "translation": [1, 2, 3]}),
        json!({"mesh": 0, "scale": [-3, 3, 3]}),
        json!({"mesh": 0}),
    ] {
        json["nodes"][0] = node;
        let mut original = folder.read_glb(&json, &bin).unwrap();
        original.document = None;
        let copy = folder.path("copy.glb");
        write_glb(&copy, &original, &GlbAdditions::default()).unwrap();
        let again = read(&copy).unwrap();
        assert_eq!(again.parts, original.parts);
        assert_eq!(again.default_weights, [0.25]);
        assert!((again.world_from_node - original.world_from_node).norm() < 1e-6);
        for (a, b) in again.mesh.positions.iter().zip(&original.mesh.positions) {
            assert!((a - b).norm() <= 1e-6 * b.norm(), "{a} {b}");
        }
    }
}

#[test]
fn glb_carries_tangents_and_maps() {
    let folder = Folder::new();
    let (json, bin) = square();
    let mut file = folder.read_glb(&json, &bin).unwrap();
    // As if it had been made by code.
    file.document = None;
    let tangents = [
        Vector4::new(1.0, 0.0, 0.0, -1.0),
        Vector4::new(2.0, 0.0, 1.0, 1.0),
        Vector4::new(0.0, 0.0, 0.0, 0.0),
        Vector4::new(f64::NAN, 0.0, 0.0, -1.0),
    ];
    let maps = [
        WrinkleMap::normal("a pose", 0.5, MapFormat::Png16, NormalY::Up),
        WrinkleMap::normal("a pose", 1.0, MapFormat::Png16, NormalY::Up),
        WrinkleMap::height("a pose", 1.0, MapFormat::Png16, 1e-3),
    ];
    let additions = GlbAdditions {
        tangents: Some(&tangents),
        normals: None,
        maps: &maps,
        moved: &[],
    };
    let path = folder.path("out.glb");
    let reference = write_glb(&path, &file, &additions).unwrap().reference;
    assert_eq!(reference.file, "out.glb");
    assert_eq!(
        reference.maps.as_deref(),
        Some("/meshes/0/extras/wrinkleMaps")
    );
    assert_eq!(
        (reference.coordinates.len(), reference.coordinates[0].set),
        (1, 0)
    );
    let bytes = fs::read(&path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let written: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    for key in ["images", "textures", "materials"] {
        assert!(written[key].is_null(), "the mesh at rest has no wrinkles");
    }
    let listed = &written["meshes"][0]["extras"]["wrinkleMaps"];
    assert_eq!(
        listed[0],
        json!({"pose": "a pose", "key": 0.5, "normal": "maps/a pose_50_normal.png"})
    );
    assert_eq!(listed[1]["height"], "maps/a pose_100_height.png");
    let accessor = written["meshes"][0]["primitives"][0]["attributes"]["TANGENT"]
        .as_u64()
        .unwrap();
    let view = written["accessors"][accessor as usize]["bufferView"]
        .as_u64()
        .unwrap();
    let start = 28
        + length
        + written["bufferViews"][view as usize]["byteOffset"]
            .as_u64()
            .unwrap() as usize;
    for (vertex, sign) in [-1.0, 1.0, 1.0, -1.0].into_iter().enumerate() {
        let number = |i: usize| {
            let at = start + 16 * vertex + 4 * i;
            f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
        };
        let norm = (0..3).map(|i| number(i).powi(2)).sum::<f32>().sqrt();
        assert!(
            (norm - 1.0).abs() < 1e-6 && number(2).abs() < 1e-6,
            "vertex {vertex}"
        );
        assert_eq!(number(3), sign);
    }
    let short = GlbAdditions {
        tangents: Some(&tangents[..3]),
        ..additions
    };
    assert_says(
        write_glb(&path, &file, &short),
        "out.glb",
        &["tangents", "3 entries", "4 vertices"],
    );
}

#[test]
fn a_map_over_tiles_names_a_file_for_each() {
    let plain = WrinkleMap::normal("a", 1.0, MapFormat::Png16, NormalY::Up);
    assert_eq!(plain.files(), ["maps/a_100_normal.png"]);
    assert_eq!(plain.clone().over_tiles(&[]), plain);
    let tiled = plain.over_tiles(&[1001, 1012]);
    assert_eq!(tiled.file, "maps/a_100_normal.<UDIM>.png");
    let files = ["maps/a_100_normal.1001.png", "maps/a_100_normal.1012.png"];
    assert_eq!(tiled.files(), files);
    let listed = serde_json::to_value(&tiled).unwrap();
    assert_eq!(listed["tiles"], json!([1001, 1012]));
}

#[test]
fn wrinkle_manifest() {
    assert_eq!(
        map_file("smile", 0.5, MapKind::Height, MapFormat::Exr),
        "maps/smile_50_height.exr"
    );
    assert_eq!(
        map_file("smile", 0.125, MapKind::Normal, MapFormat::Png8),
        "maps/smile_12p5_normal.png"
    );
    let mut wrinkles = Wrinkles::new("Face", Frame::Driver, 1024);
    wrinkles.poses.insert(
        "smile".to_owned(),
        BTreeMap::from([("mouthSmile_L".to_owned(), 1.0)]),
    );
    wrinkles.maps.push(WrinkleMap::normal(
        "smile",
        1.0,
        MapFormat::Png16,
        NormalY::Up,
    ));
    wrinkles
        .maps
        .push(WrinkleMap::height("smile", 1.0, MapFormat::Png16, 2e-3));
    wrinkles
        .maps
        .push(WrinkleMap::height("smile", 1.0, MapFormat::Exr, 2e-3));
    let json: Value = serde_json::from_str(&wrinkles.to_json()).unwrap();
    assert_eq!(json["version"], 1);
    assert!(json.get("glb").is_none(), "there is none");
    assert_eq!(json["frame"], "driver");
    assert_eq!(json["blend"]["normal"], "reoriented-normal-mapping");
    assert_eq!(json["poses"]["smile"]["mouthSmile_L"], 1.0);
    let normal = json!({
        "pose": "smile", "key": 1.0, "kind": "normal", "file": "maps/smile_100_normal.png",
        "format": "png16", "green": "+", "neutral": [0.5, 0.5, 1.0],
    });
    assert_eq!(json["maps"][0], normal);
    let height = json!({
        "pose": "smile", "key": 1.0, "kind": "height", "file": "maps/smile_100_height.png",
        "format": "png16", "unit": "m", "mid": 0.5, "scale": 2e-3, "neutral": [0.5],
    });
    assert_eq!(json["maps"][1], height);
    assert_eq!(json["maps"][2]["mid"], 0.0);
    assert_eq!(json["maps"][2]["scale"], 1.0);
    assert_eq!(serde_json::from_value::<Wrinkles>(json).unwrap(), wrinkles);
}

#[test]
fn maps_of_a_fire_say_how_to_read_them() {
    const FIRE: [MapKind; 5] = [
        MapKind::Mask,
        MapKind::Char,
        MapKind::Ash,
        MapKind::Temperature,
        MapKind::Thickness,
    ];
    let mut neutral = Vec::new();
    for kind in FIRE {
        assert!(kind.needs_fire() && !kind.is_packed());
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.word());
        let read: MapKind = serde_json::from_value(json!(kind.word())).unwrap();
        assert_eq!(read, kind);
        let detail = kind.detail().unwrap();
        let share = Encoding::SHARE;
        let entry = WrinkleMap::detail("burn", 0.5, (kind, detail), MapFormat::Exr, share);
        neutral.extend(entry.neutral);
    }
    for (value, expected) in neutral.into_iter().zip([1.0, 0.0, 0.0, 293.15, 1.0]) {
        assert!((value - expected).abs() < 1e-4, "{value} {expected}");
    }
    assert!(!MapKind::Compression.needs_fire() && MapKind::Height.is_packed());
    let kelvin = Encoding::temperature(1250.0);
    let (kind, detail) = (MapKind::Temperature, Detail::Temperature);
    let entry = WrinkleMap::detail("burn", 0.5, (kind, detail), MapFormat::Png16, kelvin);
    let mut json = serde_json::to_value(&entry).unwrap();
    assert_eq!(
        serde_json::from_value::<WrinkleMap>(json.clone()).unwrap(),
        entry
    );
    let stored = json["neutral"].take()[0].as_f64().unwrap();
    assert!((stored * 2000.0 - 293.15).abs() < 1e-4, "{stored}");
    let expected = json!({
        "pose": "burn", "key": 0.5, "kind": "temperature", "file": "maps/burn_50_temperature.png",
        "format": "png16", "unit": "K", "mid": 0.0, "scale": 2000.0, "neutral": null,
    });
    assert_eq!(json, expected);
}

#[test]
fn report_has_every_key() {
    let mut report = Report::new("0.1.0", "scene.toml");
    report.poses.push(PoseReport {
        name: "smile".to_owned(),
        layers: vec![LayerReport {
            wavelength_m: Some(f64::NAN),
            ..LayerReport::default()
        }],
        ..PoseReport::default()
    });
    let json: Value = serde_json::from_str(&report.to_json()).unwrap();
    let keys = |value: &Value| -> Vec<String> {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    assert_eq!(
        keys(&json),
        ["poses", "ruga", "scene", "version", "warnings"]
    );
    let pose = &json["poses"][0];
    assert_eq!(
        keys(pose),
        ["converged", "frames", "layers", "maps", "name"]
    );
    let layer = &pose["layers"][0];
    assert_eq!(
        keys(layer),
        [
            "amplitude_m",
            "bending_ratio",
            "constraints",
            "critical_strain_predicted",
            "energy_j",
            "faces",
            "factorizations",
            "name",
            "newton_iterations",
            "residual",
            "seconds",
            "stop_rule",
            "vertices",
            "wavelength_m",
            "wavelength_predicted_m",
        ]
    );
    assert_eq!(
        keys(&layer["seconds"]),
        [
            "constraints",
            "integration",
            "remeshing",
            "sampling",
            "total"
        ]
    );
    assert!(layer["wavelength_m"].is_null() && layer["energy_j"].is_null());
}
