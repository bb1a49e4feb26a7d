//! Images that are written read back; images of others are read as they are meant, or refused.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fs;

use fixture::{Folder, assert_says};
use ruga_io::{ExrTexels, PngTexels, read_image, read_mask, write_exr, write_png};

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
}

/// An EXR is written in tiles of 64 texels; threads would leave their order to chance.
#[test]
fn the_same_texels_are_the_same_bytes() {
    let folder = Folder::new();
    let path = folder.path("a.exr");
    let values: Vec<f32> = (0..3 * 400 * 300).map(|i| (i as f32).sin()).collect();
    for texels in [
        ExrTexels::Rgb(&values),
        ExrTexels::Grey(&values[..400 * 300]),
    ] {
        let write = |_| {
            write_exr(&path, 400, 300, texels).unwrap();
            fs::read(&path).unwrap()
        };
        let files: Vec<_> = (0..8).map(write).collect();
        assert!(files.windows(2).all(|pair| pair[0] == pair[1]));
    }
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
