//! The page holds what went in, and nothing that could break it.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::{Matrix3, Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape};
use ruga_preview::{
    Atlas, Legend, MAX_SIDE, Overlay, PackedMap, PlanPreview, PlannedPose, Preview, PreviewError,
    PreviewPose,
};
use serde_json::Value;

const SIZE: u32 = 64;

/// A square whose vertices are repeated along a seam of its texture, with two shapes.
fn patch() -> ArtistMesh {
    let at = [
        [0.0, 0.0],
        [0.1, 0.0],
        [0.1, 0.1],
        [0.0, 0.1],
        [0.0, 0.0],
        [0.1, 0.1],
    ];
    let shape = |name: &str, by: fn(f64, f64) -> Vector3<f64>| BlendShape {
        name: name.into(),
        position_deltas: at.map(|[x, y]| by(x, y)).to_vec(),
        normal_deltas: None,
    };
    ArtistMesh {
        name: "</script> & \"patch\" {{mesh}}".into(),
        positions: at.map(|[x, y]| Vector3::new(x, y, 0.02)).to_vec(),
        normals: Some(vec![Vector3::z(); 6]),
        uvs: Some(
            at.map(|[x, y]| Vector2::new(10.0 * x, 1.0 - 10.0 * y))
                .to_vec(),
        ),
        triangles: vec![[0, 1, 2], [4, 5, 3]],
        shapes: vec![
            shape("squeeze", |x, _| Vector3::new(-0.2 * x, 0.0, 0.0)),
            shape("lift", |_, y| Vector3::new(0.0, 0.0, 0.1 * y)),
        ],
    }
}

/// Waves in a quarter of the map, neutral elsewhere.
fn waves(size: u32) -> Vec<[f32; 3]> {
    let texel = |index: u32| {
        let (row, column) = (index / size, index % size);
        if row < size / 2 || column < size / 2 {
            return [0.0, 0.0, 1.0];
        }
        let [x, y] = [0.6 * (row as f32).sin(), 0.3 * (column as f32).cos()];
        [x, y, (1.0 - x * x - y * y).sqrt()]
    };
    (0..size * size).map(texel).collect()
}

fn pose(name: &str, weights: &[(&str, f64)], maps: Vec<(f64, PackedMap)>) -> PreviewPose {
    let weights = weights
        .iter()
        .map(|(shape, weight)| (shape.to_string(), *weight));
    PreviewPose {
        name: name.into(),
        weights: BTreeMap::from_iter(weights),
        maps,
    }
}

fn html(mesh: &ArtistMesh, turn: Matrix3<f64>) -> String {
    let map = PackedMap::new(SIZE, &waves(SIZE)).expect("a map");
    let poses = vec![
        pose(
            "first",
            &[("squeeze", 1.0), ("lift", 0.5)],
            vec![(0.5, map.clone()), (1.0, map.clone())],
        ),
        pose("second", &[("lift", 2.0)], vec![(1.0, map)]),
    ];
    Preview { mesh, turn, poses }.to_html().expect("a page")
}

/// Text of the script element of this id.
fn element<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, rest) = page
        .split_once(&format!("id=\"{id}\">"))
        .expect("the element");
    rest.split_once("</script>").expect("its end").0
}

fn bytes(page: &str, id: &str) -> Vec<u8> {
    BASE64_STANDARD.decode(element(page, id)).expect("base64")
}

fn about(page: &str) -> Value {
    serde_json::from_str(element(page, "about")).expect("JSON")
}

fn floats(block: &[u8], section: &Value) -> Vec<f32> {
    let [start, count] = [0, 1].map(|i| section[i].as_u64().expect("a number") as usize);
    let numbers = block[start..start + 4 * count].chunks_exact(4);
    numbers
        .map(|n| f32::from_le_bytes(n.try_into().expect("four bytes")))
        .collect()
}

fn integers(block: &[u8], section: &Value) -> Vec<u32> {
    floats(block, section).iter().map(|f| f.to_bits()).collect()
}

#[test]
fn the_mesh_and_its_poses_come_back() {
    let mesh = patch();
    let page = html(&mesh, Matrix3::identity());
    let (about, block) = (about(&page), bytes(&page, "mesh"));
    let positions = floats(&block, &about["mesh"]["positions"]);
    let wanted = mesh.positions.iter().flat_map(|p| p.iter().copied());
    assert!(positions.iter().copied().eq(wanted.map(|c| c as f32)));
    assert_eq!(
        integers(&block, &about["mesh"]["triangles"]),
        [0, 1, 2, 4, 5, 3]
    );
    // Both sides of the seam share their normal.
    assert_eq!(
        integers(&block, &about["mesh"]["groups"]),
        [0, 1, 2, 3, 0, 2]
    );
    // The shapes have no changes of normals: all normals are computed, at rest, too.
    assert!(about["mesh"]["normals"].is_null());

    let first = &about["poses"][0];
    assert_eq!(first["name"], "first");
    assert_eq!(first["weights"]["lift"], 0.5);
    let moved = integers(&block, &first["moved"]);
    // The corner at the origin stays.
    assert_eq!(moved, [1, 2, 3, 5]);
    let deltas = floats(&block, &first["deltas"]);
    assert_eq!(deltas[3..6], [-0.02, 0.0, 0.005]);
    assert_eq!(about["poses"][1]["maps"][0]["map"], 2);
}

#[test]
fn a_mirrored_mesh_keeps_its_outside() {
    let mesh = patch();
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    let page = html(&mesh, mirror);
    let (about, block) = (about(&page), bytes(&page, "mesh"));
    assert_eq!(
        integers(&block, &about["mesh"]["triangles"]),
        [0, 2, 1, 4, 3, 5]
    );
    assert_eq!(floats(&block, &about["mesh"]["positions"])[3], -0.1);
    assert!(about["focus"]["direction"][2].as_f64().expect("a number") > 0.9);
}

#[test]
fn maps_decode_to_what_went_in() {
    let mesh = patch();
    let page = html(&mesh, Matrix3::identity());
    let place = &about(&page)["maps"][0];
    let [left, top, width, height] = ["left", "top", "width", "height"]
        .map(|key| place[key].as_u64().expect("a number") as usize);
    // A quarter of the map, and a margin.
    assert_eq!([left, top, width, height], [24, 24, 40, 40]);
    let file = bytes(&page, "map0");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
        .read_info()
        .expect("a PNG");
    let mut texels = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut texels).expect("texels");
    assert_eq!([info.width as usize, info.height as usize], [width, height]);
    let normals = waves(SIZE);
    for (index, texel) in texels.chunks_exact(3).enumerate() {
        let normal = normals[(top + index / width) * SIZE as usize + left + index % width];
        for c in 0..2 {
            let found = (f32::from(texel[c]) - 128.0) / 127.0;
            assert!(
                (found - normal[c]).abs() < 0.51 / 127.0,
                "{index}: {found} {normal:?}"
            );
        }
    }
}

#[test]
fn a_plan_has_pictures_in_the_place_of_maps() {
    let red = |wrinkled: [f64; 2]| {
        let texels = [200, 0, 0].repeat(64);
        Overlay::new(8, &texels, [Vector2::from(wrinkled)]).expect("a picture")
    };
    let pose = |name: &str, overlays: Vec<Option<Overlay>>| PlannedPose {
        name: name.into(),
        weights: BTreeMap::from([("lift".into(), 1.0)]),
        notes: vec!["skin: waves".into()],
        overlays,
    };
    let mesh = patch();
    let preview = PlanPreview {
        mesh: &mesh,
        turn: Matrix3::identity(),
        atlas: Atlas::new(8, &[]),
        poses: vec![
            pose("first", vec![None, Some(red([0.5, 0.5]))]),
            pose("second", vec![Some(red([0.1, 0.1])), None]),
        ],
        layers: vec!["lower".into(), "</script>".into()],
        legend: Legend {
            ramp: vec![[1, 2, 3], [4, 5, 6]],
            ends: ["little".into(), "much".into()],
            colours: vec![([9, 9, 9], "bare".into())],
            note: "lines".into(),
        },
        facts: "2 poses".into(),
    };
    let page = preview.to_html().expect("a page");
    let about = about(&page);
    assert_eq!(about["poses"][0]["plan"]["overlays"][1], 0);
    assert_eq!(about["poses"][1]["plan"]["overlays"][0], 1);
    assert!(about["poses"][1]["plan"]["overlays"][1].is_null());
    assert_eq!(about["plan"]["colours"][0][1], "bare");
    assert_eq!(about["plan"]["layers"][1], "</script>");
    assert_eq!(about["maps"], Value::Array(Vec::new()));
    let png = bytes(&page, "overlay1");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&png))
        .read_info()
        .expect("a PNG");
    let mut texels = vec![0; reader.output_buffer_size().expect("a small picture")];
    reader.next_frame(&mut texels).expect("texels");
    assert_eq!(texels, [200, 0, 0].repeat(64));
    assert_eq!(
        page.matches("<script").count(),
        page.matches("</script>").count()
    );
    assert!(page.contains("2 poses. Planned by ruga "));
    let short = Overlay::new(8, &[0; 5], []).expect_err("too few");
    assert!(matches!(short, PreviewError::TexelCount { size: 8, .. }));
}

#[test]
fn names_cannot_end_what_they_stand_in() {
    let page = html(&patch(), Matrix3::identity());
    assert!(page.contains("<title>&lt;/script> &amp; &quot;patch&quot; {{mesh}}</title>"));
    // Each element is ended once, and by itself.
    assert_eq!(
        page.matches("<script").count(),
        page.matches("</script>").count()
    );
    let generator = page.find("<meta name=\"generator\" content=\"ruga ");
    assert!(generator.is_some_and(|at| at < 1000));
}

#[test]
fn nothing_is_asked_of_a_network() {
    let page = html(&patch(), Matrix3::identity());
    assert!(page.contains("default-src 'none'"));
    for wish in ["src=\"http", "href=\"http", "@import", "url(http"] {
        assert!(!page.contains(wish), "{wish}");
    }
}

#[test]
fn the_same_input_gives_the_same_page() {
    assert!(html(&patch(), Matrix3::identity()) == html(&patch(), Matrix3::identity()));
}

/// Left and right triangle of a strip in two tiles, which share the vertices between them.
fn strip() -> ArtistMesh {
    let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0]];
    ArtistMesh {
        name: "strip".into(),
        positions: at
            .map(|[x, y]| Vector3::new(0.1 * x, 0.1 * y, 0.0))
            .to_vec(),
        uvs: Some(at.map(|[x, y]| Vector2::new(x, 1.0 - y)).to_vec()),
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        shapes: vec![BlendShape {
            name: "lift".into(),
            position_deltas: (0..4).map(|v| Vector3::z() * f64::from(v)).collect(),
            normal_deltas: None,
        }],
        ..ArtistMesh::default()
    }
}

#[test]
fn tiles_have_their_own_maps_and_places() {
    let map = PackedMap::new(SIZE, &waves(SIZE)).expect("a map");
    let maps = |squares: &[[i32; 2]]| match squares {
        [] => vec![(1.0, map.clone())],
        squares => {
            let maps = squares.iter();
            let maps = maps.map(|&square| (1.0, map.clone().in_square(square)));
            maps.collect()
        }
    };
    let mesh = strip();
    let page = |squares: &[[i32; 2]]| {
        let preview = Preview {
            mesh: &mesh,
            turn: Matrix3::identity(),
            poses: vec![pose("first", &[("lift", 1.0)], maps(squares))],
        };
        preview.to_html().expect("a page")
    };
    let both = page(&[[0, 0], [1, 0]]);
    let (found, block) = (about(&both), bytes(&both, "mesh"));
    assert_eq!(found["tiles"], 2);
    assert_eq!(
        [&found["maps"][0]["tile"], &found["maps"][1]["tile"]],
        [0, 1]
    );
    // The two shared vertices are there once more, two units to the right.
    let uvs = floats(&block, &found["mesh"]["uvs"]);
    assert_eq!(
        uvs,
        [0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 2.0, 0.0, 3.0, 1.0]
    );
    let triangles = integers(&block, &found["mesh"]["triangles"]);
    assert_eq!(triangles, [0, 1, 3, 2, 5, 4]);
    let deltas = floats(&block, &found["poses"][0]["deltas"]);
    let lifts: Vec<f32> = deltas.iter().skip(2).step_by(3).copied().collect();
    assert_eq!(lifts, [1.0, 1.0, 2.0, 2.0, 3.0]);
    // Both sides of the border are one surface.
    let groups = integers(&block, &found["mesh"]["groups"]);
    assert_eq!([groups[1], groups[3]], [groups[2], groups[4]]);

    // Skin in a tile without map lies beyond those that have one.
    let alone = page(&[[1, 0]]);
    let (found, block) = (about(&alone), bytes(&alone, "mesh"));
    assert_eq!(found["tiles"], 1);
    let uvs = floats(&block, &found["mesh"]["uvs"]);
    assert_eq!(uvs[..2], [2.0, 1.0]);
    // So it does where only the first tile has one: its map does not repeat.
    let first = page(&[[0, 0]]);
    let (found, block) = (about(&first), bytes(&first, "mesh"));
    assert_eq!(found["tiles"], 1);
    let uvs = floats(&block, &found["mesh"]["uvs"]);
    assert_eq!(uvs[uvs.len() - 2..], [3.0, 1.0]);
    assert_eq!(about(&page(&[]))["tiles"], 0);
    assert!(!map.is_neutral());
    let flat = vec![[0.0, 0.0, 1.0]; (SIZE * SIZE) as usize];
    assert!(PackedMap::new(SIZE, &flat).expect("a map").is_neutral());
}

#[test]
fn large_maps_are_made_smaller() {
    let size = 2 * MAX_SIDE;
    let map = PackedMap::new(size, &waves(size)).expect("a map");
    let preview = Preview {
        mesh: &patch(),
        turn: Matrix3::identity(),
        poses: vec![pose("first", &[("squeeze", 1.0)], vec![(1.0, map)])],
    };
    assert_eq!(about(&preview.to_html().expect("a page"))["size"], MAX_SIDE);
}

#[test]
fn what_does_not_fit_is_an_error() {
    let mesh = patch();
    let error = |poses| {
        let preview = Preview {
            mesh: &mesh,
            turn: Matrix3::identity(),
            poses,
        };
        preview.to_html().expect_err("an error")
    };
    let map = |size| PackedMap::new(size, &waves(size)).expect("a map");
    assert!(matches!(error(Vec::new()), PreviewError::NoMaps));
    let sizes = error(vec![
        pose("first", &[], vec![(1.0, map(64))]),
        pose("second", &[], vec![(0.5, map(32))]),
    ]);
    assert!(
        sizes
            .to_string()
            .contains("`second`: its map of key 0.5 has 32"),
        "{sizes}"
    );
    let shape = error(vec![pose(
        "first",
        &[("squeezes", 1.0)],
        vec![(1.0, map(64))],
    )]);
    assert!(shape.to_string().contains("`squeeze`"), "{shape}");
    let texels = PackedMap::new(8, &waves(4)).expect_err("too few");
    assert!(matches!(
        texels,
        PreviewError::TexelCount { size: 8, found: 16 }
    ));
}

#[test]
fn the_bundle_is_made_of_the_scripts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("the page's folder")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".mjs") || name == "package.json")
        .collect();
    names.sort();
    // FNV-1a, as in page/build.mjs.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for name in names {
        let text = std::fs::read_to_string(folder.join(&name)).expect("a script");
        for byte in format!("{name}\n{}", text.replace("\r\n", "\n")).bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
    let bundle = std::fs::read_to_string(folder.join("bundle.js")).expect("the bundle");
    let made_of = format!("/* sources {hash:016x};");
    assert!(
        bundle.starts_with(&made_of),
        "page/bundle.js is old; renew it with `cargo xtask page`"
    );
}
