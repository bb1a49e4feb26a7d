//! Frames with fields, as VTU and USD: arrays read back by their declared names and lengths.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fs;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use fixture::{Folder, assert_says};
use nalgebra::{Vector2, Vector3};
use ruga_io::{Field, FieldValues, FrameMesh, LayerFrame, UsdSeries, write_pvd, write_vtu};

const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];

/// Two triangles over the unit square, raised by `height`.
fn positions(height: f64) -> Vec<Vector3<f64>> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    corners.map(|[x, y]| Vector3::new(x, y, height)).to_vec()
}

fn uvs() -> Vec<Vector2<f64>> {
    [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.25]]
        .map(Vector2::from)
        .to_vec()
}

const UP: [Vector3<f64>; 4] = [Vector3::new(0.0, 0.0, 1.0); 4];

fn fields<'a>(heights: &'a [f64], ratios: &'a [f64]) -> [Field<'a>; 3] {
    let field = |name, unit, values| Field { name, unit, values };
    [
        field("displacement", "m", FieldValues::VertexVectors(&UP)),
        field("height", "m", FieldValues::Vertices(heights)),
        field("strain_ratio", "1", FieldValues::Faces(ratios)),
    ]
}

fn frame<'a>(
    number: usize,
    positions: &'a [Vector3<f64>],
    uvs: &'a [Vector2<f64>],
    fields: &'a [Field<'a>],
) -> LayerFrame<'a> {
    LayerFrame {
        mesh: FrameMesh {
            name: "fine lines",
            positions,
            triangles: &TRIANGLES,
            uvs,
            uv_triangles: &TRIANGLES,
        },
        normals: &UP[..positions.len()],
        number,
        load: 0.25 * (number + 1) as f64,
        fields,
    }
}

/// The bytes of an array of a VTU file, whose length stands before them.
fn array(text: &str, kind: &str, name: &str) -> Vec<u8> {
    let start = format!("<DataArray type=\"{kind}\" Name=\"{name}\"");
    let (_, rest) = text
        .split_once(&start)
        .unwrap_or_else(|| panic!("no `{start}`"));
    let (head, rest) = rest.split_once(">\n").unwrap();
    assert!(head.ends_with("format=\"binary\""), "{head}");
    let line = rest.lines().next().unwrap();
    let bytes = BASE64_STANDARD.decode(line).unwrap();
    let (length, data) = bytes.split_at(8);
    let length = u64::from_le_bytes(length.try_into().unwrap());
    assert_eq!(length as usize, data.len(), "{name}");
    data.to_vec()
}

fn singles(bytes: &[u8]) -> Vec<f32> {
    let numbers = bytes.chunks_exact(4);
    numbers
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

#[test]
fn vtu_holds_every_array_under_its_name() {
    let folder = Folder::new();
    let (positions, uvs) = (positions(0.125), uvs());
    let fields = fields(&[0.5, 0.25, -0.5, 1.0], &[0.75, 1.5]);
    let path = folder.path("skin.0000.vtu");
    write_vtu(&path, &frame(3, &positions, &uvs, &fields)).unwrap();
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains("<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">"));
    let points = array(&text, "Float64", "Points");
    let points = points
        .chunks_exact(8)
        .map(|b| f64::from_le_bytes(b.try_into().unwrap()));
    assert!(points.eq(positions.iter().flatten().copied()));
    let corners = array(&text, "Int64", "connectivity");
    let corners = corners
        .chunks_exact(8)
        .map(|b| i64::from_le_bytes(b.try_into().unwrap()));
    assert!(corners.eq(TRIANGLES.as_flattened().iter().map(|&v| i64::from(v))));
    assert_eq!(array(&text, "UInt8", "types"), [5, 5]);
    assert_eq!(
        singles(&array(&text, "Float32", "height")),
        [0.5, 0.25, -0.5, 1.0]
    );
    assert_eq!(singles(&array(&text, "Float32", "normals")).len(), 12);
    assert_eq!(array(&text, "Float64", "load"), 1.0_f64.to_le_bytes());
    // What is known of triangles stands with the cells.
    let (points, cells) = text.split_once("<CellData>").unwrap();
    assert_eq!(
        singles(&array(cells, "Float32", "strain_ratio")),
        [0.75, 1.5]
    );
    assert!(!points.contains("strain_ratio") && !cells.contains("height"));
    // Every element that is opened is closed.
    for name in [
        "VTKFile",
        "UnstructuredGrid",
        "Piece",
        "DataArray",
        "InformationKey",
    ] {
        let opened =
            text.matches(&format!("<{name} ")).count() + text.matches(&format!("<{name}>")).count();
        assert_eq!(
            opened,
            text.matches(&format!("</{name}>")).count(),
            "{name}"
        );
    }
}

#[test]
fn pvd_lists_times_and_files() {
    let folder = Folder::new();
    let path = folder.path("a.pvd");
    let frames = [
        (0.05, "a & b.0000.vtu".to_owned()),
        (1.0, "a.0001.vtu".to_owned()),
    ];
    write_pvd(&path, &frames).unwrap();
    let text = fs::read_to_string(path).unwrap();
    let entries: Vec<_> = text
        .lines()
        .filter(|line| line.starts_with("<DataSet"))
        .collect();
    assert_eq!(
        entries,
        [
            "<DataSet timestep=\"0.05\" part=\"0\" file=\"a &amp; b.0000.vtu\"/>",
            "<DataSet timestep=\"1\" part=\"0\" file=\"a.0001.vtu\"/>",
        ]
    );
}

/// The samples of an attribute of a USD file.
fn samples<'a>(text: &'a str, declaration: &str) -> Vec<&'a str> {
    let start = format!("    {declaration}.timeSamples = {{\n");
    let (_, rest) = text
        .split_once(&start)
        .unwrap_or_else(|| panic!("no `{start}`"));
    let (samples, _) = rest.split_once("    }").unwrap();
    samples.lines().map(str::trim).collect()
}

#[test]
fn usd_has_a_sample_per_frame_and_topology_where_it_changes() {
    let folder = Folder::new();
    let path = folder.path("deep/skin.usda");
    let mut series = UsdSeries::new(&path, "fine lines");
    let uvs = uvs();
    for number in [0, 1, 4] {
        let positions = positions(number as f64);
        let heights = [number as f64; 4];
        let fields = fields(&heights, &[0.75, 1.5]);
        series
            .add(&frame(number, &positions, &uvs, &fields))
            .unwrap();
        assert!(!path.exists(), "nothing is in place before the end");
    }
    let (last, heights) = (positions(9.0), [0.0; 3]);
    let coarser = fields(&heights, &[2.0]);
    let coarser = coarser.map(|field| match field.values {
        FieldValues::VertexVectors(values) => Field {
            values: FieldValues::VertexVectors(&values[..3]),
            ..field
        },
        _ => field,
    });
    let mut other = frame(5, &last[..3], &uvs, &coarser);
    other.mesh.triangles = &TRIANGLES[..1];
    other.mesh.uv_triangles = &TRIANGLES[..1];
    series.add(&other).unwrap();
    series.finish().unwrap();

    let text = fs::read_to_string(&path).unwrap();
    for line in [
        "#usda 1.0",
        "    defaultPrim = \"fine_lines\"",
        "    endTimeCode = 5",
        "    metersPerUnit = 1",
        "    upAxis = \"Y\"",
        "def Mesh \"fine_lines\" (",
        "    displayName = \"fine lines\"",
        "        doc = \"unit: m\"",
    ] {
        assert!(text.lines().any(|found| found == line), "no `{line}`");
    }
    assert_eq!(
        samples(&text, "int[] faceVertexIndices"),
        ["0: [0, 1, 2, 2, 1, 3],", "5: [0, 1, 2],"]
    );
    assert_eq!(
        samples(&text, "float[] primvars:height"),
        [
            "0: [0, 0, 0, 0],",
            "1: [1, 1, 1, 1],",
            "4: [4, 4, 4, 4],",
            "5: [0, 0, 0],"
        ]
    );
    let points = samples(&text, "point3f[] points");
    assert_eq!(
        points[2],
        "4: [(0, 0, 4), (1, 0, 4), (0, 1, 4), (1, 1, 4)],"
    );
    // V is up.
    assert_eq!(
        samples(&text, "texCoord2f[] primvars:st"),
        ["0: [(0, 0), (1, 0), (0, 1), (1, 0.75)],"]
    );
    assert_eq!(samples(&text, "custom double ruga:load")[1], "1: 0.5,");
    let left: Vec<_> = fs::read_dir(folder.path("deep")).unwrap().collect();
    assert_eq!(left.len(), 1, "no temporary is left");
}

#[test]
fn frames_that_contradict_themselves_are_refused() {
    let folder = Folder::new();
    let (positions, uvs) = (positions(0.0), uvs());
    let path = folder.path("a.vtu");
    let refused = |fields: &[Field<'_>], words: &[&str]| {
        let frame = frame(0, &positions, &uvs, fields);
        assert_says(write_vtu(&path, &frame), "a.vtu", words);
        assert!(!path.exists());
    };
    refused(
        &fields(&[0.0; 3], &[0.0; 2]),
        &["`height` has 3 values for 4"],
    );
    let infinite = [0.0, f64::INFINITY];
    refused(
        &fields(&[0.0; 4], &infinite),
        &["`strain_ratio`", "not finite"],
    );
    let named = Field {
        name: "a b",
        unit: "1",
        values: FieldValues::Faces(&[0.0; 2]),
    };
    refused(&[named], &["`a b`"]);

    let fields = fields(&[0.0; 4], &[0.0; 2]);
    let mut series = UsdSeries::new(&folder.path("a.usda"), "a");
    series.add(&frame(1, &positions, &uvs, &fields)).unwrap();
    let again = series.add(&frame(1, &positions, &uvs, &fields));
    assert_says(again, "a.usda", &["frame 1"]);
    let fewer = series.add(&frame(2, &positions, &uvs, &fields[..1]));
    assert_says(fewer, "a.usda", &["last"]);
    // No frame, no file.
    let empty = UsdSeries::new(&folder.path("b.usda"), "b");
    empty.finish().unwrap();
    assert!(!folder.path("b.usda").exists());
}
