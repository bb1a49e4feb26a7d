//! Painted maps: which image paints what, numbers as stored, and what is refused.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fs;
use std::path::{Path, PathBuf};

use fixture::{Folder, SCENE, assert_says};
use ruga_io::{ExrTexels, PngTexels, read_image, write_exr, write_png};
use ruga_scene::file::{PropertyMap, Wrap};
use ruga_scene::{PropertyImages, SceneError, SceneFile, read_property_images};

fn read(map: &PropertyMap) -> Result<PropertyImages, SceneError> {
    read_property_images(map, Path::new("scene.toml"), "layers[1].map")
}

/// A map of Young's modulus alone.
fn young(path: PathBuf) -> PropertyMap {
    PropertyMap {
        young: Some([0.5, 2.0]),
        young_image: Some(path),
        ..PropertyMap::default()
    }
}

/// A packed map with a range for each channel.
fn packed(path: PathBuf) -> PropertyMap {
    PropertyMap {
        image: Some(path),
        wavelength: Some([0.5, 2.0]),
        young: Some([1.0, 3.0]),
        thickness: Some([2.0, 1.0]),
        ..PropertyMap::default()
    }
}

fn refused(map: &PropertyMap, words: &[&str]) {
    let everywhere = [words, &["layers[1].map."]].concat();
    assert_says(read(map), "scene.toml", &everywhere);
}

#[test]
fn channels_of_a_packed_image() {
    let folder = Folder::new();
    let path = folder.path("a.png");
    let texels = [[0, 65535, 13107], [26214, 1, 65534]];
    write_png(&path, 2, 1, PngTexels::Rgb16(texels.as_flattened())).unwrap();
    let found = read(&packed(path.clone())).unwrap();
    let part = |value: u16| f32::from(value) / 65535.0;
    for (plane, channel, range) in [
        (found.wavelength, 0, [0.5, 2.0]),
        (found.young, 1, [1.0, 3.0]),
        (found.thickness, 2, [2.0, 1.0]),
    ] {
        let plane = plane.unwrap();
        assert_eq!((plane.width, plane.height, plane.range), (2, 1, range));
        assert_eq!(
            plane.values,
            [part(texels[0][channel]), part(texels[1][channel])]
        );
    }
    let alone = PropertyMap {
        wavelength: None,
        thickness: None,
        ..packed(path)
    };
    let found = read(&alone).unwrap();
    assert!(found.young.is_some() && found.wavelength.is_none() && found.thickness.is_none());
}

#[test]
fn grey_images_of_their_own() {
    let folder = Folder::new();
    let (grey, colour, exr) = (
        folder.path("g.png"),
        folder.path("c.png"),
        folder.path("e.exr"),
    );
    write_png(&grey, 1, 2, PngTexels::Grey8(&[0, 51])).unwrap();
    write_png(&colour, 1, 2, PngTexels::Rgb8(&[7, 7, 7, 102, 102, 102])).unwrap();
    // A thousandth outside is rounding.
    write_exr(&exr, 2, 1, ExrTexels::Grey(&[0.125, 1.0005])).unwrap();
    let map = PropertyMap {
        wavelength: Some([1.0, 2.0]),
        wavelength_image: Some(grey),
        thickness: Some([1.0, 2.0]),
        thickness_image: Some(exr),
        ..young(colour)
    };
    let found = read(&map).unwrap();
    assert_eq!(found.wavelength.unwrap().values, [0.0, 0.2]);
    assert_eq!(found.young.unwrap().values, [7.0 / 255.0, 0.4]);
    let thickness = found.thickness.unwrap();
    assert_eq!(thickness.values, [0.125, 1.0]);
    assert_eq!((thickness.width, thickness.height), (2, 1));
}

/// A file that says it is sRGB, with a gamma, holds the same numbers.
#[test]
fn nothing_is_decoded() {
    let folder = Folder::new();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_gamma(png::ScaledFloat::from_scaled(45_455));
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[51, 102, 153]).unwrap();
    writer.finish().unwrap();
    assert!(bytes.windows(4).any(|tag| tag == b"sRGB"));
    let found = read(&young(folder.file("srgb.png", bytes))).unwrap();
    assert_eq!(found.young.unwrap().values, [0.2, 0.4, 0.6]);
}

#[test]
fn wrong_channels() {
    let folder = Folder::new();
    let grey = folder.path("grey.png");
    write_png(&grey, 2, 1, PngTexels::Grey8(&[0, 255])).unwrap();
    refused(
        &packed(grey),
        &["map.image", "grey.png", "1 channel", "red", "young_image"],
    );
    let colour = folder.path("colour.png");
    write_png(&colour, 2, 1, PngTexels::Rgb8(&[9, 9, 9, 1, 2, 3])).unwrap();
    refused(
        &young(colour),
        &[
            "map.young_image",
            "colour.png",
            "3 channels",
            "column 1, row 0",
            "grey",
        ],
    );
}

#[test]
fn missing_and_foreign_files() {
    let folder = Folder::new();
    refused(
        &young(folder.path("no.png")),
        &["map.young_image", "no.png", "no such file"],
    );
    let jpeg = folder.file("a.jpg", [0xff, 0xd8, 0xff, 0xe0]);
    refused(&packed(jpeg), &["map.image", "a.jpg", "JPEG", "PNG"]);
    refused(
        &packed(folder.file("empty.png", [])),
        &["empty.png", "PNG (8 or 16 bits), EXR"],
    );
}

/// Neither PNG nor EXR allows an image without texels; ours or theirs, the refusal names the file.
#[test]
fn zero_size() {
    let folder = Folder::new();
    let path = folder.path("a.png");
    write_png(&path, 1, 1, PngTexels::Grey8(&[0])).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // Signature, length and tag of IHDR, width; the checksum covers tag and data.
    bytes[16..20].fill(0);
    let sum = checksum(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    refused(
        &young(folder.file("zero.png", &bytes)),
        &["zero.png", "PNG"],
    );

    let path = folder.path("a.exr");
    write_exr(&path, 1, 1, ExrTexels::Grey(&[0.5])).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let name = b"dataWindow\0box2i\0";
    let start = bytes
        .windows(name.len())
        .position(|window| window == name)
        .unwrap();
    let right = start + name.len() + 4 + 8;
    bytes[right..right + 4].copy_from_slice(&(-1_i32).to_le_bytes());
    refused(
        &young(folder.file("zero.exr", &bytes)),
        &["zero.exr", "EXR"],
    );
}

/// CRC-32 of PNG chunks, bit by bit.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}

#[test]
fn numbers_that_no_painter_meant() {
    let folder = Folder::new();
    let path = folder.path("a.exr");
    for bad in [-0.01, 1.5, 1e30] {
        write_exr(&path, 2, 2, ExrTexels::Grey(&[0.0, 1.0, 0.5, bad])).unwrap();
        refused(
            &young(path.clone()),
            &[
                "map.young_image",
                "a.exr",
                "column 1, row 1",
                "0 to 1",
                &bad.to_string(),
            ],
        );
    }
    // What has no range is not looked at.
    let texels = [0.5, 7.0, 0.5];
    write_exr(&path, 1, 1, ExrTexels::Rgb(&texels)).unwrap();
    refused(&packed(path.clone()), &["map.image", "channel 1", "7"]);
    assert!(
        read(&PropertyMap {
            young: None,
            ..packed(path.clone())
        })
        .is_ok()
    );

    write_exr(&path, 2, 1, ExrTexels::Grey(&[0.5, 0.25])).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let texel = bytes
        .windows(4)
        .position(|four| four == 0.25_f32.to_le_bytes())
        .unwrap();
    for bad in [f32::NAN, f32::INFINITY] {
        bytes[texel..texel + 4].copy_from_slice(&bad.to_le_bytes());
        let file = folder.file("nan.exr", &bytes);
        assert_says(read_image(&file), "nan.exr", &["column 1, row 0", "finite"]);
        refused(
            &young(file),
            &["map.young_image", "nan.exr", &bad.to_string()],
        );
    }
}

#[test]
fn wrap_and_sharp_are_keys() {
    let parse = |map: &str| {
        let old = "thickness = [0.5, 2.0] }";
        assert!(SCENE.contains(old));
        SceneFile::from_toml(&SCENE.replacen(old, map, 1), Path::new("scene.toml"))
    };
    let map = |text: &str| parse(text).unwrap().layers[0].map.clone().unwrap();
    let plain = map("thickness = [0.5, 2.0] }");
    assert_eq!((plain.wrap, plain.sharp), (Wrap::ClampToEdge, false));
    let set = map("thickness = [0.5, 2.0], wrap = \"repeat\", sharp = true }");
    assert_eq!((set.wrap, set.sharp), (Wrap::Repeat, true));
    let scene = parse("thickness = [0.5, 2.0], wrap = \"repeat\", sharp = true }").unwrap();
    let again = SceneFile::from_toml(&scene.to_toml(), Path::new("scene.toml")).unwrap();
    assert_eq!(again, scene);
    let wrong = parse("thickness = [0.5, 2.0], wrap = \"repaet\" }");
    assert_says(
        wrong,
        "scene.toml",
        &["layers[0].map.wrap", "did you mean `repeat`"],
    );
    let wrong = parse("thickness = [0.5, 2.0], sharp = 1.5 }");
    assert_says(wrong, "scene.toml", &["layers[0].map.sharp"]);
}
