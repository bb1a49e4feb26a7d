//! Files that a reader once panicked on, took too much memory for, or took and could not write.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, WritableImage, f16,
};
use fixture::{Folder, SQUARE_OBJ, assert_says, data_uri, read, square};
use ruga_io::{ExrTexels, GlbAdditions, read_image, read_mask, write_exr, write_glb};
use serde_json::json;

/// tobj multiplied these indices by two, unchecked.
#[test]
fn obj_indices_that_are_not_there() {
    let folder = Folder::new();
    for (face, line, words) in [
        (
            "f 1/1/1 2/-9223372036854775807/1 3/3/1",
            "line 12",
            "5 texture coordinates",
        ),
        ("f 1/1/1 2/0/1 3/3/1", "line 12", "index 0"),
        ("f 1/1/1 2/2/-2 3/3/1", "line 12", "1 normals"),
        ("f 1/1/1 2/2/1 5/3/1", "line 12", "4 vertices"),
        ("f -1 -2 -5", "line 12", "index -5"),
    ] {
        let text = SQUARE_OBJ.replace("f 1/1/1 2/2/1 3/3/1", face);
        assert_says(read(&folder.file("a.obj", text)), "a.obj", &[line, words]);
    }
    // Where there are none, such indices mean nothing.
    let bare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1/1 2/2/1 -1/3/1\n";
    assert_eq!(
        read(&folder.file("b.obj", bare))
            .unwrap()
            .mesh
            .triangles
            .len(),
        1
    );
}

/// OBJ has numbers that no GLB holds; they were found out after the simulation.
#[test]
fn coordinates_beyond_32_bits() {
    let folder = Folder::new();
    for (from, to, words) in [
        ("v 1 1 0", "v 1 1e39 0", ["vertex 2 of the mesh", "1e39"]),
        (
            "vt 1 1",
            "vt 1 -1e200",
            ["texture coordinate of vertex 2", "1e200"],
        ),
    ] {
        let text = SQUARE_OBJ.replace(from, to);
        assert_says(read(&folder.file("a.obj", text)), "a.obj", &words);
    }
    // The largest goes out and comes back, rounded up.
    let largest = folder.file("b.obj", SQUARE_OBJ.replace("v 1 1 0", "v 1 1e30 0"));
    let path = folder.path("b.glb");
    write_glb(&path, &read(&largest).unwrap(), &GlbAdditions::default()).unwrap();
    assert!(read(&path).is_ok());
    let (mut json, bin) = square();
    json["nodes"][0]["scale"] = json!([1e35, 1e35, 1e35]);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["e35", "up to 1e30"],
    );
    let mut file = read(&folder.file("a.obj", SQUARE_OBJ)).unwrap();
    file.mesh.positions[1].x = 1e39;
    let path = folder.path("c.glb");
    let written = write_glb(&path, &file, &GlbAdditions::default());
    assert_says(written, "c.glb", &["vertex 1", "32 bits"]);
    assert!(!path.exists());
}

/// Messages once held the whole of a data: URI with a slip, or named the buffer's file alone.
#[test]
fn gltf_buffers_with_a_slip_in_their_uri() {
    let folder = Folder::new();
    let (mut json, bin) = square();
    let uri = data_uri(&bin);
    for (slip, words) in [
        (uri.replacen("data", "ata", 1), "not a relative path"),
        (uri.replacen("data:", "data", 1), "cannot read"),
        ("gone.bin".to_owned(), "no such file"),
    ] {
        json["buffers"][0]["uri"] = json!(slip);
        let file = folder.file("a.gltf", json.to_string());
        let error = read(&file).expect_err("there is no buffer").to_string();
        assert!(error.len() < 400, "{error}");
        assert_says::<()>(
            read(&file).map(drop),
            "a.gltf",
            &["buffer 0", words, &slip[..8]],
        );
    }
}

/// The decoder took three bytes from a palette's last colour, whatever there was.
#[test]
fn png_palettes_of_broken_colours() {
    let folder = Folder::new();
    for (length, accepted) in [(5, false), (6, true), (7, false)] {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(vec![9; length]);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&[0, 1, 0, 1]))
            .unwrap();
        let file = folder.file("a.png", &bytes);
        match accepted {
            true => assert_eq!(read_image(&file).unwrap().channels, 3),
            false => assert_says(
                read_image(&file),
                "a.png",
                &["palette", &length.to_string()],
            ),
        }
    }
}

/// A header of a few bytes asked for gigabytes.
#[test]
fn images_that_claim_to_be_huge() {
    let folder = Folder::new();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 16_384, 16_384);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    drop(encoder.write_header().unwrap());
    // The image data begins; the rest is missing.
    bytes.truncate(33);
    bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    let words = ["16384 x 16384", "cannot hold"];
    assert_says(read_image(&folder.file("a.png", &bytes)), "a.png", &words);

    let path = folder.path("a.exr");
    write_exr(&path, 5, 4, ExrTexels::Rgb(&[0.5; 60])).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let window = b"dataWindow\0box2i\0\x10\0\0\0";
    let at = bytes
        .windows(window.len())
        .position(|w| w == window)
        .unwrap()
        + window.len();
    for side in [8, 12] {
        bytes[at + side..at + side + 4].copy_from_slice(&16_383_u32.to_le_bytes());
    }
    assert_says(read_mask(&folder.file("b.exr", &bytes)), "b.exr", &words);
}

/// The B44 decoder subtracts unchecked.
#[test]
fn exr_blocks_of_damaged_b44() {
    let folder = Folder::new();
    let samples = (0..64).map(|i| f16::from_f32(0.01 * i as f32)).collect();
    let channel = AnyChannel::new("Y", FlatSamples::F16(samples));
    let encoding = Encoding {
        compression: Compression::B44,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(std::iter::once(channel).collect());
    let layer = Layer::new((8, 8), LayerAttributes::default(), encoding, channels);
    let mut file = Cursor::new(Vec::new());
    let image = Image::from_layer(layer);
    image.write().non_parallel().to_buffered(&mut file).unwrap();
    let mut bytes = file.into_inner();
    assert_eq!(
        read_image(&folder.file("a.exr", &bytes)).unwrap().channels,
        1
    );
    let blocks = bytes.len() - 4 * 14;
    bytes[blocks..].fill(0);
    // Built without overflow checks, the decoder makes up some other number, or what is none.
    if let Err(error) = read_image(&folder.file("b.exr", &bytes)) {
        assert_says::<()>(Err(error), "b.exr", &["EXR"]);
    }
}
