//! Lines that are drawn in a mesh file: joined, placed beside the mesh, refused in words.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{
    Folder, SQUARE_OBJ, add_accessor, add_view, assert_says, floats, glb, gltf, read, square,
};
use nalgebra::{UnitQuaternion, Vector3};
use ruga_io::{IoError, LengthUnit, LineCurve, MeshFile, ObjOptions, read_line_curves, read_mesh};
use serde_json::{Value, json};

const LINES: u32 = 1;
const LINE_LOOP: u32 = 2;
const LINE_STRIP: u32 = 3;

/// Vertex `i` stands at `(i, i², 0)`.
fn at(vertex: u16) -> Vector3<f64> {
    let x = f64::from(vertex);
    Vector3::new(x, x * x, 0.0)
}

fn push(array: &mut Value, value: Value) {
    array.as_array_mut().unwrap().push(value);
}

fn add_numbers(json: &mut Value, bin: &mut Vec<u8>, bytes: &[u8], mut accessor: Value) -> usize {
    accessor["bufferView"] = json!(add_view(json, bin, bytes));
    add_accessor(json, accessor)
}

fn add_positions(json: &mut Value, bin: &mut Vec<u8>, points: &[Vector3<f64>]) -> usize {
    let numbers: Vec<f32> = points.iter().flatten().map(|c| *c as f32).collect();
    let accessor = json!({"componentType": 5126, "count": points.len(), "type": "VEC3"});
    add_numbers(json, bin, &floats(&numbers), accessor)
}

fn add_indices(json: &mut Value, bin: &mut Vec<u8>, indices: &[u16]) -> usize {
    let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let accessor = json!({"componentType": 5123, "count": indices.len(), "type": "SCALAR"});
    add_numbers(json, bin, &bytes, accessor)
}

/// The square, and a mesh `Crease` on node 1, with a primitive for each mode and its indices.
fn square_and_lines(primitives: &[(u32, &[u16])]) -> (Value, Vec<u8>) {
    let (mut json, mut bin) = square();
    let points: Vec<_> = (0..10).map(at).collect();
    let position = add_positions(&mut json, &mut bin, &points);
    let mut list = Vec::new();
    for (mode, indices) in primitives {
        let indices = add_indices(&mut json, &mut bin, indices);
        list.push(json!({"mode": mode, "attributes": {"POSITION": position}, "indices": indices}));
    }
    let crease = json!({"name": "Crease", "primitives": list});
    push(&mut json["meshes"], crease);
    push(&mut json["nodes"], json!({"name": "Line", "mesh": 1}));
    (json, bin)
}

fn square_file(folder: &Folder, json: &Value, bin: &[u8]) -> MeshFile {
    let path = folder.file("mesh.glb", glb(json, bin));
    read_mesh(&path, Some("Square"), &ObjOptions::default()).unwrap()
}

fn lines(json: &Value, bin: &[u8], name: &str) -> Result<Vec<LineCurve>, IoError> {
    let folder = Folder::new();
    let file = square_file(&folder, json, bin);
    read_line_curves(&file, name, &ObjOptions::default())
}

fn joined(primitives: &[(u32, &[u16])]) -> Vec<LineCurve> {
    let (json, bin) = square_and_lines(primitives);
    lines(&json, &bin, "Crease").unwrap()
}

fn curve(vertices: &[u16], is_closed: bool) -> LineCurve {
    let points = vertices.iter().map(|v| at(*v)).collect();
    LineCurve { points, is_closed }
}

fn open(vertices: &[u16]) -> LineCurve {
    curve(vertices, false)
}

fn closed(vertices: &[u16]) -> LineCurve {
    curve(vertices, true)
}

#[test]
fn strips_and_loops() {
    let found = joined(&[
        (LINE_STRIP, &[3, 1, 1, 2]),
        (LINE_LOOP, &[4, 5, 6]),
        (LINE_STRIP, &[7, 8, 9, 7]),
        (LINE_LOOP, &[0, 1]),
        (LINE_STRIP, &[5, 5]),
    ]);
    let closed = [closed(&[4, 5, 6]), closed(&[7, 8, 9])];
    assert_eq!(found[1..3], closed);
    let open = [open(&[3, 1, 2]), open(&[0, 1])];
    assert_eq!([&found[0], &found[3]], [&open[0], &open[1]]);
    assert_eq!(found.len(), 4);
}

#[test]
fn pairs_are_joined_in_the_direction_of_the_first() {
    let shuffled = [(LINES, &[3, 2, 8, 9, 0, 1, 1, 2, 2, 1, 7, 7, 4, 3][..])];
    assert_eq!(joined(&shuffled), [open(&[4, 3, 2, 1, 0]), open(&[8, 9])]);
    let ring = [(LINES, &[1, 2, 0, 3, 3, 2, 1, 0][..])];
    assert_eq!(joined(&ring), [closed(&[1, 2, 3, 0])]);
}

#[test]
fn polylines_end_where_edges_branch() {
    let fork = [(LINES, &[0, 1, 1, 2, 5, 1, 2, 3][..])];
    assert_eq!(
        joined(&fork),
        [open(&[0, 1]), open(&[1, 2, 3]), open(&[5, 1])]
    );
    let ring_with_tail = [(LINES, &[1, 2, 2, 3, 3, 1, 1, 0][..])];
    assert_eq!(joined(&ring_with_tail), [closed(&[1, 2, 3]), open(&[1, 0])]);
}

#[test]
fn equal_positions_and_primitives_are_joined_in_file_order() {
    let (mut json, mut bin) = square_and_lines(&[(LINES, &[4, 3]), (LINE_STRIP, &[7, 8, 9])]);
    let apart = [at(0), at(1), at(2), at(1), at(2), at(3)];
    let position = add_positions(&mut json, &mut bin, &apart);
    let primitive = json!({"mode": LINES, "attributes": {"POSITION": position}});
    push(&mut json["meshes"][1]["primitives"], primitive);
    let expected = [open(&[4, 3, 2, 1, 0]), open(&[7, 8, 9])];
    assert_eq!(lines(&json, &bin, "Crease").unwrap(), expected);
    assert_eq!(lines(&json, &bin, "Line").unwrap(), expected);
    let folder = Folder::new();
    let path = folder.file("mesh.gltf", gltf(&json, &bin));
    let file = read_mesh(&path, Some("Square"), &ObjOptions::default()).unwrap();
    let found = read_line_curves(&file, "Crease", &ObjOptions::default()).unwrap();
    assert_eq!(found, expected);
}

/// Checks points 1 and 2 of a line (m) in the space of the square, both under a scaled root.
fn assert_places(square_node: Value, line_node: Value, expected: [Vector3<f64>; 2]) {
    let (mut json, bin) = square_and_lines(&[(LINE_STRIP, &[1, 2])]);
    let root = json!({"children": [1, 2], "scale": [0.1, 0.1, 0.1], "translation": [3, 4, 5]});
    json["nodes"] = json!([root, square_node, line_node]);
    json["nodes"][1]["mesh"] = json!(0);
    json["nodes"][2]["mesh"] = json!(1);
    let folder = Folder::new();
    let file = square_file(&folder, &json, &bin);
    for scale in [1.0, 0.0254] {
        let file = file.clone().scaled(scale);
        let found = read_line_curves(&file, "Crease", &ObjOptions::default()).unwrap();
        for (point, expected) in found[0].points.iter().zip(expected) {
            let error = (point / scale - expected).norm();
            assert!(error < 1e-6, "{point} {expected} {scale}");
        }
    }
}

#[test]
fn lines_stand_where_they_are_beside_the_mesh() {
    // In the space of the mesh the scale of the root counts, its translation does not.
    let still = json!({});
    assert_places(still.clone(), still.clone(), [at(1) * 0.1, at(2) * 0.1]);
    let turned = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
    let rotation = turned.coords.as_slice();
    let shift = Vector3::new(1.0, -2.0, 0.5);
    let line = json!({"rotation": rotation, "scale": [2, 3, 4], "translation": shift.as_slice()});
    let in_root = |p: Vector3<f64>| turned * p.component_mul(&Vector3::new(2.0, 3.0, 4.0)) + shift;
    let places = [1, 2].map(|v| in_root(at(v)));
    assert_places(still.clone(), line.clone(), places.map(|p| p * 0.1));
    // A mesh with the same node as the line sees it unturned, but stretched: here R S = R diag.
    let stretched = [1, 2].map(|v| at(v).component_mul(&Vector3::new(0.2, 0.3, 0.4)));
    assert_places(line.clone(), line.clone(), stretched);
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let mesh = json!({"rotation": quarter.coords.as_slice(), "scale": [5, 5, 5], "translation": [7, 0, 0]});
    let seen = |p: Vector3<f64>| quarter.inverse() * (p - Vector3::new(7.0, 0.0, 0.0)) * 0.1;
    assert_places(mesh.clone(), still, [seen(at(1)), seen(at(2))]);
    assert_places(mesh, line, places.map(seen));
}

#[test]
fn the_named_node_places_a_mesh_that_several_carry() {
    let (mut json, bin) = square_and_lines(&[(LINE_STRIP, &[1, 2])]);
    let copy = json!({"name": "Copy", "mesh": 1, "translation": [0, 0, 9]});
    push(&mut json["nodes"], copy);
    let z = |name| lines(&json, &bin, name).unwrap()[0].points[0].z;
    assert_eq!([z("Crease"), z("Line"), z("Copy")], [0.0, 0.0, 9.0]);
}

#[test]
fn meshes_without_lines_are_explained() {
    let (json, bin) = square_and_lines(&[(0, &[1, 2])]);
    let says = |name, words: &[&str]| assert_says(lines(&json, &bin, name), "mesh.glb", words);
    let words = ["no mesh named `Creese`", "mean `Crease`", "`Square`"];
    says("Creese", &words);
    for name in ["Square", "Node"] {
        let mesh = format!("mesh `{name}`");
        says(name, &[&mesh, "faces and no lines", "Loose Edges"]);
    }
    says("Crease", &["mesh `Crease`", "has no lines", "Loose Edges"]);
    let (mut empty, bin) = square_and_lines(&[(LINES, &[1, 1])]);
    assert_says(lines(&empty, &bin, "Crease"), "mesh.glb", &["no length"]);
    push(&mut empty["nodes"], json!({"name": "Fold"}));
    let words = ["node `Fold`", "has no mesh", "Loose Edges"];
    assert_says(lines(&empty, &bin, "Fold"), "mesh.glb", &words);
}

#[test]
fn damaged_lines_are_refused() {
    let refused = |primitive: (u32, &[u16]), words: &[&str]| {
        let (json, bin) = square_and_lines(&[primitive]);
        assert_says(lines(&json, &bin, "Crease"), "mesh.glb", words);
    };
    refused((LINES, &[0, 1, 2]), &["primitive 0 of mesh 1", "3 corners"]);
    refused((LINE_STRIP, &[4]), &["primitive 0 of mesh 1", "1 corner"]);
    refused((LINE_LOOP, &[0, 10, 1]), &["accessor 6", "index 1 is 10"]);
    refused((9, &[0, 1]), &["primitive 0 of mesh 1", "mode"]);
    let (mut json, mut bin) = square_and_lines(&[(LINES, &[0, 1])]);
    let infinite = [at(0), Vector3::new(1.0, f64::NAN, 0.0)];
    let position = add_positions(&mut json, &mut bin, &infinite);
    json["meshes"][1]["primitives"][0]["attributes"]["POSITION"] = json!(position);
    assert_says(lines(&json, &bin, "Crease"), "mesh.glb", &["finite"]);
    json["meshes"][1]["primitives"][0]["attributes"] = json!({});
    assert_says(lines(&json, &bin, "Crease"), "mesh.glb", &["POSITION"]);
    let (mut json, bin) = square_and_lines(&[(LINES, &[0, 1])]);
    json["nodes"][1]["scale"] = json!([1e35, 1, 1]);
    assert_says(lines(&json, &bin, "Crease"), "mesh.glb", &["1e30"]);
    json["nodes"][1]["children"] = json!([1]);
    assert_says(lines(&json, &bin, "Crease"), "mesh.glb", &["ancestor"]);
}

fn obj_lines(added: &str, name: &str) -> Result<Vec<LineCurve>, IoError> {
    let folder = Folder::new();
    let file = read(&folder.file("mesh.obj", format!("{SQUARE_OBJ}{added}")))?.scaled(2.0);
    let options = ObjOptions {
        length_unit: LengthUnit::Centimetre,
        ..ObjOptions::default()
    };
    read_line_curves(&file, name, &options)
}

/// The curve as [`obj_lines`] reads it: in centimetres, made twice as large.
fn scaled(mut curve: LineCurve) -> LineCurve {
    curve.points.iter_mut().for_each(|p| *p *= 0.01 * 2.0);
    curve
}

fn assert_close(found: &[LineCurve], expected: &[LineCurve]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.is_closed, expected.is_closed);
        assert_eq!(found.points.len(), expected.points.len());
        let mut pairs = found.points.iter().zip(&expected.points);
        assert!(pairs.all(|(a, b)| (a - b).norm() < 1e-15), "{found:?}");
    }
}

const OBJ_POINTS: &str = "v 1 1 0 1\nv 2 4 0\nv 3 9 0\n";

#[test]
fn obj_lines_are_joined_and_scaled() {
    let (chain, rim) = (scaled(open(&[1, 2, 3])), scaled(closed(&[1, 2, 3])));
    let text = format!("o Crease\n{OBJ_POINTS}l 6 7\nl 5 6\ng Rim\nl -3/1 -2/1 -1/2 -3/1 # all\n");
    let both = [chain.clone(), rim.clone()];
    assert_close(&obj_lines(&text, "Crease").unwrap(), &both);
    assert_close(&obj_lines(&text, "Rim").unwrap(), &[rim]);
    let text = format!("g a Fold b\n{OBJ_POINTS}l 5 6 7");
    assert_close(&obj_lines(&text, "Fold").unwrap(), &[chain]);
}

#[test]
fn obj_lines_make_no_triangles() {
    let text = format!("{SQUARE_OBJ}{OBJ_POINTS}l 5 6 7\n");
    let mesh = read(&Folder::new().file("mesh.obj", text)).unwrap().mesh;
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2, 5));
}

#[test]
fn obj_lines_are_refused_in_words() {
    let refused = |text: &str, name, words: &[&str]| {
        assert_says(obj_lines(text, name), "mesh.obj", words);
    };
    let words = ["no mesh named `Creas`", "mean `Crease`", "`Square`"];
    refused("o Crease\nl 1 2\n", "Creas", &words);
    refused("", "Square", &["object `Square`", "faces and no lines"]);
    let crease = |text: &str, words| refused(&format!("o Crease\n{text}"), "Crease", words);
    crease("", &["object `Crease`", "has no lines", "`l`"]);
    crease("l 1 5", &["line 15", "index 5", "4 vertices"]);
    crease("l -5 1", &["line 15", "index -5"]);
    crease("l 0 1", &["line 15", "index 0"]);
    crease("l 1 x", &["line 15", "`x`"]);
    crease("l 1", &["line 15", "1 of at least 2"]);
    crease("v nan 0 0\nl 5 1", &["line 16", "finite"]);
    crease("v 1e200 0 0\nl 5 1", &["object `Crease`", "1e30"]);
    let elsewhere = obj_lines("o Other\nl 1 x\no Crease\nl 1 2\n", "Crease");
    assert_eq!(elsewhere.unwrap().len(), 1);
}
