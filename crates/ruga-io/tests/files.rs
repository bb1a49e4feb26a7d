//! Images, frames, manifests: what is written reads back, and nothing is left half-written.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;

use fixture::{Folder, SQUARE_OBJ, assert_says, floats, read, square};
use nalgebra::{Vector2, Vector3, Vector4};
use ruga_io::{
    AtomicFile, ExrTexels, GlbAdditions, LayerReport, LengthUnit, ObjFrame, ObjOptions, PngTexels,
    PoseReport, Report, WrinkleMap, Wrinkles, map_file, read_image, read_mask, read_mesh,
    write_atomically, write_exr, write_glb, write_obj_frame, write_png,
};
use ruga_io::{Frame, MapFormat, MapKind, NormalY};
use serde_json::{Value, json};

#[test]
fn png_of_both_depths() {
    let folder = Folder::new();
    let path = folder.path("a.png");
    let values16: Vec<u16> = (0..7 * 5 * 3).map(|i| (i * 613) as u16).collect();
    write_png(&path, 7, 5, PngTexels::Rgb16(&values16)).unwrap();
    let image = read_image(&path).unwrap();
    assert_eq!((image.width, image.height, image.channels), (7, 5, 3));
    let back: Vec<u16> = image
        .values
        .iter()
        .map(|v| (v * 65535.0).round() as u16)
        .collect();
    assert_eq!(back, values16);
    let values8: Vec<u8> = (0..35).map(|i| i * 7).collect();
    write_png(&path, 7, 5, PngTexels::Grey8(&values8)).unwrap();
    let mask = read_mask(&path).unwrap();
    let back: Vec<u8> = mask
        .values
        .iter()
        .map(|v| (v * 255.0).round() as u8)
        .collect();
    assert_eq!(back, values8);
    write_png(&path, 5, 7, PngTexels::Grey16(&values16[..35])).unwrap();
    assert_eq!(read_mask(&path).unwrap().width, 5);
    let rgb8: Vec<u8> = (0..105).collect();
    write_png(&path, 5, 7, PngTexels::Rgb8(&rgb8)).unwrap();
    assert_eq!(read_image(&path).unwrap().channels, 3);
}

/// Normal maps are numbers, not colours: a gamma or profile chunk would bend them.
#[test]
fn png_has_no_colour_space_chunk() {
    let folder = Folder::new();
    let path = folder.path("a.png");
    write_png(&path, 4, 4, PngTexels::Rgb16(&[32768; 48])).unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut chunks = Vec::new();
    let mut at = 8;
    while at + 8 <= bytes.len() {
        let length = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        chunks.push(String::from_utf8_lossy(&bytes[at + 4..at + 8]).into_owned());
        at += 12 + length;
    }
    chunks.dedup();
    assert_eq!(chunks, ["IHDR", "IDAT", "IEND"]);
}

#[test]
fn exr_of_one_and_three_channels() {
    let folder = Folder::new();
    let path = folder.path("a.exr");
    let grey: Vec<f32> = (0..30).map(|i| i as f32 * 1.7e-5 - 2e-4).collect();
    write_exr(&path, 6, 5, ExrTexels::Grey(&grey)).unwrap();
    let image = read_image(&path).unwrap();
    assert_eq!((image.width, image.height, image.channels), (6, 5, 1));
    assert_eq!(image.values, grey);
    assert!(
        read_mask(&path)
            .unwrap()
            .values
            .iter()
            .all(|v| (0.0..=1.0).contains(v))
    );
    let rgb: Vec<f32> = (0..90).map(|i| (i as f32).sin()).collect();
    write_exr(&path, 6, 5, ExrTexels::Rgb(&rgb)).unwrap();
    assert_eq!(read_image(&path).unwrap().values, rgb);
    let first = fs::read(&path).unwrap();
    write_exr(&path, 6, 5, ExrTexels::Rgb(&rgb)).unwrap();
    assert_eq!(
        fs::read(&path).unwrap(),
        first,
        "the same input gives the same bytes"
    );
}

#[test]
fn masks_of_every_kind() {
    let folder = Folder::new();
    let encode = |color: png::ColorType, depth: png::BitDepth, data: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(vec![0, 0, 0, 255, 255, 255]);
            encoder.set_trns(vec![0, 255]);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        read_mask(&folder.file("mask.png", bytes)).unwrap().values
    };
    use png::{BitDepth, ColorType};
    let black_white = vec![0.0, 1.0];
    assert_eq!(
        encode(ColorType::Grayscale, BitDepth::Eight, &[0, 255]),
        black_white
    );
    assert_eq!(
        encode(ColorType::Grayscale, BitDepth::One, &[0b0100_0000]),
        black_white
    );
    assert_eq!(
        encode(ColorType::Grayscale, BitDepth::Sixteen, &[0, 0, 255, 255]),
        black_white
    );
    assert_eq!(
        encode(
            ColorType::GrayscaleAlpha,
            BitDepth::Eight,
            &[0, 255, 255, 255]
        ),
        black_white
    );
    // White paint on an empty layer, whatever colour is stored where nothing is painted.
    for empty in [0, 255] {
        let rgba = [empty, empty, empty, 0, 255, 255, 255, 255];
        assert_eq!(encode(ColorType::Rgba, BitDepth::Eight, &rgba), black_white);
    }
    let half = encode(
        ColorType::GrayscaleAlpha,
        BitDepth::Eight,
        &[255, 51, 0, 255],
    );
    assert!((half[0] - 0.2).abs() < 1e-6 && half[1] == 0.0);
    assert_eq!(
        encode(ColorType::Indexed, BitDepth::Eight, &[0, 1]),
        black_white
    );
    let thirds = encode(ColorType::Rgb, BitDepth::Eight, &[255, 0, 0, 0, 255, 255]);
    assert!((thirds[0] - 1.0 / 3.0).abs() < 1e-6 && (thirds[1] - 2.0 / 3.0).abs() < 1e-6);
}

#[test]
fn bad_images() {
    let folder = Folder::new();
    assert_says(
        read_mask(&folder.path("no.png")),
        "no.png",
        &["no such file"],
    );
    assert_says(read_mask(&folder.path("")), "", &["folder"]);
    let jpeg = folder.file("a.png", [0xff, 0xd8, 0xff, 0xe0]);
    assert_says(read_mask(&jpeg), "a.png", &["JPEG", "PNG"]);
    let text = folder.file("b.png", "hello");
    assert_says(read_mask(&text), "b.png", &["PNG", "EXR"]);
    let path = folder.path("c.png");
    let noise: Vec<u16> = (0..64 * 64)
        .map(|i: u32| (i.wrapping_mul(2_654_435_761) >> 16) as u16)
        .collect();
    write_png(&path, 64, 64, PngTexels::Grey16(&noise)).unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in [
        8,
        20,
        60,
        bytes.len() / 2,
        bytes.len() - 20,
        bytes.len() - 5,
    ] {
        let cut = folder.file("cut.png", &bytes[..length]);
        assert_says(read_mask(&cut), "cut.png", &["PNG"]);
    }
    let path = folder.path("c.exr");
    write_exr(&path, 2, 2, ExrTexels::Grey(&[0.0; 4])).unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in [4, 20, bytes.len() / 2, bytes.len() - 1] {
        let cut = folder.file("cut.exr", &bytes[..length]);
        assert_says(read_mask(&cut), "cut.exr", &["EXR"]);
    }
}

#[test]
fn texels_that_do_not_fit() {
    let folder = Folder::new();
    let path = folder.path("a.png");
    assert_says(
        write_png(&path, 2, 2, PngTexels::Grey8(&[0; 3])),
        "a.png",
        &["3 values"],
    );
    assert_says(
        write_png(&path, 0, 2, PngTexels::Grey8(&[])),
        "a.png",
        &["0 x 2"],
    );
    assert_says(
        write_exr(&path, 1, 1, ExrTexels::Rgb(&[0.0])),
        "a.png",
        &["1 values"],
    );
    assert_says(
        write_exr(&path, 1, 1, ExrTexels::Grey(&[f32::NAN])),
        "a.png",
        &["NaN"],
    );
    assert_eq!(folder.names(), [""; 0]);
}

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

#[test]
fn unwritable_places() {
    let folder = Folder::new();
    folder.file("file", b"x");
    let below = folder.path("file/a.png");
    let (json, bin) = square();
    let mesh = folder.read_glb(&json, &bin).unwrap();
    let frame = ObjFrame {
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
    let frame = ObjFrame {
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
    let beyond = ObjFrame {
        triangles: &[[0, 1, 3]],
        uv_triangles: &[],
        ..frame
    };
    assert_says(write_obj_frame(&path, &beyond), "frame.obj", &["index"]);
    let short = ObjFrame {
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
        WrinkleMap::normal("a pose", 0.5, MapFormat::Png16, NormalY::Plus),
        WrinkleMap::normal("a pose", 1.0, MapFormat::Png16, NormalY::Plus),
        WrinkleMap::height("a pose", 1.0, MapFormat::Png16, 1e-3),
    ];
    let additions = GlbAdditions {
        tangents: Some(&tangents),
        normals: None,
        maps: &maps,
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
        NormalY::Plus,
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
