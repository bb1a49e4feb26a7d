//! What a painted map says at a UV, and where its sharp boundaries pass the edges of a mesh.

use nalgebra::Vector2;
use proptest::prelude::*;
use ruga_material::{
    MaterialError, PropertyImage, PropertyMap, PropertyRanges, RelativeProperties, SHARP_RATIO,
    Wrap, sharp_edges,
};

fn image(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> PropertyImage {
    PropertyImage {
        width,
        height,
        values: (0..width * height)
            .map(|i| value(i % width, i / width))
            .collect(),
        range: [0.5, 2.5],
    }
}

/// A map of the thickness alone.
fn thickness(image: PropertyImage, wrap: Wrap) -> PropertyMap {
    PropertyMap::new(None, None, Some(image), wrap).expect("a valid image")
}

fn uv(u: f64, v: f64) -> Vector2<f64> {
    Vector2::new(u, v)
}

#[test]
fn texel_centres_have_the_painted_value() {
    let painted = |x: usize, y: usize| ((3 * x + 5 * y) % 7) as f32 / 7.0;
    for wrap in [Wrap::ClampToEdge, Wrap::Repeat] {
        let map = thickness(image(5, 3, painted), wrap);
        for (x, y) in (0..5).flat_map(|x| (0..3).map(move |y| (x, y))) {
            let centre = uv((x as f64 + 0.5) / 5.0, (y as f64 + 0.5) / 3.0);
            let found = map.sample(&centre);
            let expected = 0.5 + 2.0 * f64::from(painted(x, y));
            assert!((found.thickness - expected).abs() < 1e-14, "{x}, {y}");
            assert_eq!((found.wavelength, found.young), (1.0, 1.0));
        }
    }
}

/// A bilinear field is met exactly between the outermost centres.
#[test]
fn bilinear_between_centres() {
    let field = |u: f64, v: f64| 0.1 + 0.3 * u + 0.2 * v + 0.4 * u * v;
    let centre = |x: usize, count: f64| (x as f64 + 0.5) / count;
    let map = thickness(
        image(8, 4, |x, y| field(centre(x, 8.0), centre(y, 4.0)) as f32),
        Wrap::ClampToEdge,
    );
    for i in 0..=20 {
        let t = f64::from(i) / 20.0;
        let at = uv(0.0625 + 0.875 * t, 0.875 - 0.75 * t);
        let expected = 0.5 + 2.0 * field(at.x, at.y);
        // f32 texels.
        assert!((map.sample(&at).thickness - expected).abs() < 3e-7);
    }
}

#[test]
fn borders_clamp_or_repeat() {
    let halves = |x: usize, _: usize| if x < 2 { 0.0 } else { 1.0 };
    let clamped = thickness(image(4, 4, halves), Wrap::ClampToEdge);
    let repeated = thickness(image(4, 4, halves), Wrap::Repeat);
    for (u, clamp, repeat) in [
        (0.0, 0.5, 1.5),
        (1.0, 2.5, 1.5),
        (-0.25, 0.5, 2.5),
        (1.125, 2.5, 0.5),
        (0.375, 0.5, 0.5),
        (7.375, 2.5, 0.5),
        (-1e30, 0.5, f64::NAN),
    ] {
        assert_eq!(clamped.sample(&uv(u, 0.3)).thickness, clamp, "{u}");
        if repeat.is_finite() {
            let found = repeated.sample(&uv(u, 4.3)).thickness;
            assert!((found - repeat).abs() < 1e-12, "{u}: {found}");
        }
    }
    assert_eq!(Wrap::default(), Wrap::ClampToEdge);
}

#[test]
fn packed_channels_are_wavelength_young_thickness() {
    let ranges = PropertyRanges {
        wavelength: Some([1.0, 2.0]),
        young: Some([4.0, 2.0]),
        thickness: None,
    };
    // A blue without range may hold anything.
    let map = PropertyMap::packed(1, 1, &[0.25, 0.5, f32::NAN], ranges, Wrap::Repeat);
    let found = map.expect("valid").sample(&uv(0.9, 0.1));
    let expected = RelativeProperties {
        wavelength: 1.25,
        young: 3.0,
        thickness: 1.0,
    };
    assert_eq!(found, expected);
}

#[test]
fn a_vertex_on_a_seam_takes_the_mean_of_its_corners() {
    let map = thickness(image(2, 1, |x, _| x as f32), Wrap::ClampToEdge);
    let (left, right) = (uv(0.0, 0.5), uv(1.0, 0.5));
    let mean = map.sample_corners([(left, 1.0), (right, 3.0)]);
    assert_eq!(mean.thickness, 0.25 * 0.5 + 0.75 * 2.5);
    let alone = map.sample_corners([(left, 0.3), (left, 2.0)]);
    assert_eq!(alone.thickness, 0.5);
    assert_eq!(map.sample_corners([]), RelativeProperties::default());
    let face = map.sample_face(&[left, right, right]);
    assert!((face.thickness - map.sample(&uv(2.0 / 3.0, 0.5)).thickness).abs() < 1e-15);
}

#[test]
fn bad_images_are_named() {
    let good = || image(3, 2, |_, _| 0.5);
    let refused = |image: PropertyImage| {
        let map = PropertyMap::new(None, Some(image), None, Wrap::Repeat);
        map.expect_err("a bad image").to_string()
    };
    let words = refused(PropertyImage {
        width: 0,
        values: Vec::new(),
        ..good()
    });
    assert!(
        words.contains("young") && words.contains("0 x 2"),
        "{words}"
    );
    let words = refused(PropertyImage {
        height: 3,
        ..good()
    });
    assert!(words.contains("6 values") && words.contains("9"), "{words}");
    let huge = refused(PropertyImage {
        width: usize::MAX,
        height: 2,
        ..good()
    });
    assert!(huge.contains("6 values"), "{huge}");
    for value in [f32::NAN, f32::INFINITY, -0.01, 1.01] {
        let mut bad = good();
        bad.values[4] = value;
        let words = refused(bad);
        assert!(
            words.contains("column 1, row 1") && words.contains("0 to 1"),
            "{words}"
        );
    }
    for range in [
        [0.0, 1.0],
        [1.0, -1.0],
        [f64::NAN, 1.0],
        [1.0, f64::INFINITY],
    ] {
        let words = refused(PropertyImage { range, ..good() });
        assert!(
            words.contains("young range") && words.contains("above 0"),
            "{words}"
        );
    }
    let mut rounded = good();
    rounded.values[0] = 1.0005;
    let map = thickness(rounded, Wrap::ClampToEdge);
    assert_eq!(map.sample(&uv(0.0, 0.0)).thickness, 2.5);
    let packed = PropertyMap::packed(1, 1, &[0.0; 2], PropertyRanges::default(), Wrap::Repeat);
    assert!(matches!(
        packed,
        Err(MaterialError::ImageLength {
            found: 2,
            expected: 3,
            ..
        })
    ));
}

/// Two halves; the texel boundary is the middle of the image, exactly.
#[test]
fn a_crossing_is_found_to_a_billionth() {
    let map = thickness(
        image(16, 16, |x, _| if x < 8 { 0.2 } else { 0.8 }),
        Wrap::ClampToEdge,
    );
    for (from, to) in [
        (uv(0.1, 0.2), uv(0.7, 0.9)),
        (uv(0.9, 0.5), uv(0.3, 0.5)),
        // Far shorter than a texel.
        (uv(0.499, 0.31), uv(0.502, 0.312)),
    ] {
        let found = map.crossings(&from, &to, 1.5).expect("a ratio above 1");
        assert_eq!(found.len(), 1, "{found:?}");
        let expected = (0.5 - from.x) / (to.x - from.x);
        assert!((found[0].parameter - expected).abs() < 2e-7, "{found:?}");
        assert!((found[0].ratio - 2.1 / 0.9).abs() < 1e-6);
        // The halves of the line meet the boundary at their common end alone.
        let middle = from + (to - from) * found[0].parameter;
        for half in [
            map.crossings(&from, &middle, 1.5),
            map.crossings(&middle, &to, 1.5),
        ] {
            for crossing in half.expect("a ratio above 1") {
                let end = crossing.parameter.min(1.0 - crossing.parameter);
                assert!(end < 1e-5, "{crossing:?}");
            }
        }
    }
    assert_eq!(
        map.crossings(&uv(0.1, 0.1), &uv(0.45, 0.9), 1.5),
        Ok(Vec::new())
    );
    // A jump below what is asked for is none.
    assert_eq!(
        map.crossings(&uv(0.1, 0.1), &uv(0.9, 0.9), 2.5),
        Ok(Vec::new())
    );
}

#[test]
fn smooth_paint_has_no_boundary_and_antialiased_paint_one() {
    let line = (uv(0.02, 0.4), uv(0.97, 0.6));
    let crossings = |image: PropertyImage| {
        let map = thickness(image, Wrap::ClampToEdge);
        map.crossings(&line.0, &line.1, SHARP_RATIO)
            .expect("a ratio above 1")
    };
    // From 0.5 to 2.5 over so many texels: beyond three it is a ramp, however steep.
    for (texels, expected) in [
        (1, 1),
        (2, 1),
        (3, 1),
        (4, 0),
        (5, 0),
        (9, 0),
        (16, 0),
        (63, 0),
    ] {
        let ramp = |x: usize, _: usize| (x as f32 - 0.5 * (63 - texels) as f32) / texels as f32;
        let found = crossings(image(64, 8, |x, y| ramp(x, y).clamp(0.0, 1.0)));
        assert_eq!(found.len(), expected, "{texels}: {found:?}");
        for crossing in &found {
            // The middle of the ramp is that of the image.
            let middle = (0.5 - line.0.x) / (line.1.x - line.0.x);
            let off = (crossing.parameter - middle).abs() * 0.95 * 64.0;
            assert!(off < 0.51, "{texels}: {off} texels");
        }
    }
    let soft = |x: usize, _: usize| match x {
        0..=31 => 0.0,
        32 => 0.4,
        _ => 1.0,
    };
    let found = crossings(image(64, 8, soft));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].ratio - 5.0).abs() < 1e-6);
    let thin = crossings(image(64, 8, |x, _| if x == 30 { 1.0 } else { 0.0 }));
    assert_eq!(thin.len(), 2, "{thin:?}");
    assert!(thin[0].parameter < thin[1].parameter);
}

#[test]
fn properties_that_jump_together_cross_once() {
    let halves = image(32, 32, |x, _| if x < 16 { 0.0 } else { 1.0 });
    let coarse = image(8, 8, |x, _| if x < 4 { 1.0 } else { 0.0 });
    let map = PropertyMap::new(Some(halves), Some(coarse), None, Wrap::Repeat).expect("valid");
    let found = map
        .crossings(&uv(0.3, 0.5), &uv(0.7, 0.5), 1.5)
        .expect("a ratio above 1");
    assert_eq!(found.len(), 1, "{found:?}");
    for ratio in [1.0, 0.5, f64::NAN, f64::INFINITY] {
        let error = map
            .crossings(&uv(0.0, 0.0), &uv(1.0, 1.0), ratio)
            .unwrap_err();
        assert!(matches!(error, MaterialError::JumpRatio { .. }));
    }
}

#[test]
fn edges_between_different_faces_are_marked() {
    let of = |thickness: f64, young: f64| RelativeProperties {
        wavelength: 1.0,
        young,
        thickness,
    };
    let faces = [of(1.0, 1.0), of(1.1, 1.0), of(1.1, 0.5)];
    let edges = [
        [Some(0), Some(1)],
        [Some(1), Some(2)],
        [Some(2), None],
        [Some(2), Some(0)],
    ];
    assert_eq!(
        sharp_edges(&edges, &faces, 1.5),
        Ok(vec![false, true, false, true])
    );
    assert_eq!(
        sharp_edges(&edges, &faces, 1.05),
        Ok(vec![true, true, false, true])
    );
    assert!(sharp_edges(&edges, &faces, 1.0).is_err());
    assert_eq!(faces[0].jump_to(&faces[2]), 2.0);
}

/// What the two steps give on a grid: split at the crossings of a painted disc, edges on the boundary
/// come out marked, no other.
#[test]
fn a_split_grid_follows_a_painted_boundary() {
    // A straight, slanted boundary through a fine image; the mesh is one row of squares across it.
    let slanted = |x: usize, y: usize| if 2 * x + y < 512 { 0.0 } else { 1.0 };
    let map = thickness(image(512, 512, slanted), Wrap::ClampToEdge);
    let on_boundary = |v: f64| 0.5 - 0.5 * v;
    for (low, high) in [(0.2, 0.25), (0.5, 0.55)] {
        let mut ends = Vec::new();
        for v in [low, high] {
            let found = map
                .crossings(&uv(0.1, v), &uv(0.6, v), SHARP_RATIO)
                .expect("valid");
            assert_eq!(found.len(), 1);
            let at = 0.1 + 0.5 * found[0].parameter;
            // Within a texel of the line that the staircase stands for.
            assert!((at - on_boundary(v)).abs() < 1.0 / 512.0, "{at}");
            ends.push(uv(at, v));
        }
        let faces = [
            map.sample_face(&[ends[0], ends[1], uv(0.1, low)]),
            map.sample_face(&[ends[0], ends[1], uv(0.6, high)]),
            map.sample_face(&[ends[1], uv(0.1, low), uv(0.1, high)]),
        ];
        let edges = [[Some(0), Some(1)], [Some(0), Some(2)]];
        assert_eq!(
            sharp_edges(&edges, &faces, SHARP_RATIO),
            Ok(vec![true, false])
        );
    }
}

proptest! {
    /// Sampling never leaves the range, whatever the UV, and crossings come in order inside the line.
    #[test]
    fn samples_and_crossings_stay_inside(
        values in prop::collection::vec(0.0..=1.0_f32, 30),
        coordinates in prop::array::uniform4(-3.0..3.0_f64),
        repeat in any::<bool>(),
    ) {
        let wrap = if repeat { Wrap::Repeat } else { Wrap::ClampToEdge };
        let map = thickness(PropertyImage { width: 6, height: 5, values, range: [2.0, 0.25] }, wrap);
        let [a, b, c, d] = coordinates;
        let (from, to) = (uv(a, b), uv(c, d));
        let found = map.sample(&from).thickness;
        prop_assert!((0.25 - 1e-15..=2.0 + 1e-15).contains(&found));
        let crossings = map.crossings(&from, &to, SHARP_RATIO).expect("a ratio above 1");
        prop_assert!(crossings.iter().all(|x| (0.0..=1.0).contains(&x.parameter) && x.ratio >= SHARP_RATIO));
        prop_assert!(crossings.windows(2).all(|pair| pair[0].parameter < pair[1].parameter));
    }
}
