//! What an image decodes to is what was baked.

mod patch;

use nalgebra::Vector3;
use patch::{Driver, Patch, baked, degrees, rms, waves};
use ruga_bake::{
    BakeSettings, Coverage, HEIGHT_MID, NormalY, WrinkleMap, bake, height_range, height_to_u16,
    normal_to_png8, normal_to_png16,
};

fn map() -> WrinkleMap {
    let mut patch = Patch::new(Driver::Flat, [96, 1], 0.0, waves);
    for uv in patch.uvs.iter_mut().flatten() {
        *uv *= 0.8;
    }
    let settings = BakeSettings {
        size: 256,
        ..BakeSettings::default()
    };
    bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch")
}

fn decoded(codes: &[f64], largest: f64) -> Vec<Vector3<f64>> {
    let vector = |c: &[f64]| Vector3::new(c[0], c[1], c[2]) / largest * 2.0 - Vector3::repeat(1.0);
    codes.chunks(3).map(vector).collect()
}

#[test]
fn sixteen_bits_are_exact_to_three_thousandths_of_a_degree() {
    let map = map();
    let codes: Vec<f64> = normal_to_png16(&map, NormalY::Up)
        .into_iter()
        .map(f64::from)
        .collect();
    for (texel, n) in decoded(&codes, 65535.0).iter().enumerate() {
        assert!(degrees(&n.normalize(), &baked(&map, texel)) < 0.003);
    }
}

#[test]
fn eight_bits_are_dithered_unit_and_right_on_average() {
    let map = map();
    let codes: Vec<f64> = normal_to_png8(&map, NormalY::Up)
        .into_iter()
        .map(f64::from)
        .collect();
    let normals = decoded(&codes, 255.0);
    // Half a code of Z, 0.5/127.5, is the largest deviation from unit length.
    assert!(normals.iter().all(|n| (n.norm() - 1.0).abs() < 0.004));
    let error = rms(normals
        .iter()
        .enumerate()
        .map(|(texel, n)| degrees(&n.normalize(), &baked(&map, texel))));
    assert!(error < 0.3, "{error} degrees");
    // The mean error over 8 x 8 texels is an order of magnitude below a code (0.45 degrees).
    let mut means = Vec::new();
    for block in 0..25 * 25 {
        let [x, y] = [block % 25 * 8, block / 25 * 8];
        let sum: Vector3<f64> = (0..64)
            .map(|i| (y + i / 8) * 256 + x + i % 8)
            .map(|texel| normals[texel] - baked(&map, texel))
            .sum();
        means.push((sum.xy() / 64.0).norm().to_degrees());
    }
    let mean = rms(means.into_iter());
    println!("8 bit: {error:.3} degrees per texel, {mean:.4} per block");
    assert!(mean < 0.045, "{mean} degrees");
}

#[test]
fn neutral_texels_have_the_conventional_code() {
    let map = map();
    let [eight, sixteen] = [
        normal_to_png8(&map, NormalY::Down)
            .into_iter()
            .map(u16::from)
            .collect(),
        normal_to_png16(&map, NormalY::Down),
    ];
    let outside = map
        .coverage
        .iter()
        .position(|c| *c == Coverage::Neutral)
        .unwrap();
    assert_eq!(eight[3 * outside..3 * outside + 3], [128, 128, 255]);
    assert_eq!(sixteen[3 * outside..3 * outside + 3], [32768, 32768, 65535]);
}

#[test]
fn heights_decode_within_half_a_code_and_zero_is_exact() {
    let map = map();
    let range = height_range(&map);
    let codes = height_to_u16(&map, range).unwrap();
    for (code, height) in codes.iter().zip(&map.heights) {
        let decoded = range * (f64::from(*code) / 65535.0 - HEIGHT_MID);
        assert!((decoded - f64::from(*height)).abs() <= 0.5001 * range / 65535.0);
        assert!(*height != 0.0 || decoded == 0.0);
    }
    // Beyond the range the codes stop at the ends.
    let narrow = height_to_u16(&map, range / 10.0).unwrap();
    assert!(narrow.contains(&0) && narrow.contains(&65535));
}
