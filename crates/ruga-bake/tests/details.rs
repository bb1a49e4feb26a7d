//! Details against closed forms: a sine on a plane, a turned cylinder, and what is neutral.

mod patch;

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Vector3};
use patch::{Driver, Patch, SIDE, degrees, rms, texel_parameters};
use ruga_bake::{BakeSettings, Coverage, Detail, Frame, WrinkleMap, bake_detailed};

const AMPLITUDE: f64 = 1e-3;
const WAVENUMBER: f64 = TAU / 10e-3;

/// All that is the layer's own.
const OWN: [Detail; 3] = [Detail::Occlusion, Detail::Curvature, Detail::Displacement];

fn sine(s: f64, _: f64) -> f64 {
    AMPLITUDE * (WAVENUMBER * s).cos()
}

fn detailed(patch: &Patch, frame: Frame) -> WrinkleMap {
    let settings = BakeSettings {
        size: 128,
        frame,
        ..BakeSettings::default()
    };
    bake_detailed(&patch.relief(), &patch.frames, &settings, &OWN).expect("a valid patch")
}

/// Texels of a map well inside the patch, with their parameters: beyond, half of the sky is empty and
/// fits are one-sided.
fn inner(map: &WrinkleMap) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
    let texels = (0..map.coverage.len()).map(|texel| (texel, texel_parameters(map, texel)));
    texels.filter(|(_, place)| place.iter().all(|c| (0.02..SIDE - 0.02).contains(c)))
}

fn values(map: &WrinkleMap, detail: Detail) -> &[f32] {
    map.detail(detail).expect("it was asked for")
}

#[test]
fn a_sine_has_the_curvature_of_its_graph() {
    for frame in [Frame::Driver, Frame::Mesh] {
        let patch = Patch::new(Driver::Flat, [240, 1], 1e-3, sine);
        let map = detailed(&patch, frame);
        let curvature = values(&map, Detail::Curvature);
        // 2 H = -h'' / (1 + h'²)^(3/2): positive where the relief is convex.
        let exact = |s: f64| {
            let slope = AMPLITUDE * WAVENUMBER * (WAVENUMBER * s).sin();
            sine(s, 0.0) * WAVENUMBER * WAVENUMBER / (1.0 + slope * slope).powf(1.5) / 2.0
        };
        let largest = AMPLITUDE * WAVENUMBER * WAVENUMBER / 2.0;
        let error = rms(inner(&map).map(|(texel, [s, _])| f64::from(curvature[texel]) - exact(s)));
        assert!(error < 0.02 * largest, "{error} of {largest}");
    }
}

#[test]
fn the_sky_over_a_sine_is_that_between_its_crests() {
    let patch = Patch::new(Driver::Flat, [240, 1], 1e-3, sine);
    let map = detailed(&patch, Frame::Driver);
    let sky = values(&map, Detail::Occlusion);
    // Slopes up to the horizon on either side, found on the curve itself.
    let exact = |s: f64| {
        let [left, right] = [-1.0, 1.0].map(|side: f64| {
            let to = (1..4000).map(|step| 1.5e-2 * f64::from(step) / 4000.0);
            to.map(|d| (sine(s + side * d, 0.0) - sine(s, 0.0)) / d)
                .fold(0.0, f64::max)
        });
        // Hottel's crossed strings, the zenith angles measured from the normal.
        let lean = (AMPLITUDE * WAVENUMBER * (WAVENUMBER * s).sin()).atan();
        let zenith = |slope: f64| 1.0_f64.atan2(slope);
        ((zenith(right) - lean).sin() + (zenith(left) + lean).sin()) / 2.0
    };
    let error = rms(inner(&map).map(|(texel, [s, _])| f64::from(sky[texel]) - exact(s)));
    assert!(error < 0.01, "{error}");
    // Flanks are the darkest: they look at the ground and at the next crest.
    let darkest = inner(&map).map(|(t, _)| sky[t]).fold(1.0, f32::min);
    let wave = (0..100).map(|step| exact(5e-2 + 1e-4 * f64::from(step)));
    let expected = wave.fold(1.0, f64::min);
    assert!((f64::from(darkest) - expected).abs() < 0.01, "{darkest}");
    let lightest = inner(&map).map(|(texel, _)| sky[texel]).fold(0.0, f32::max);
    assert!(lightest > 0.99, "{lightest}");
}

#[test]
fn displacement_is_the_way_from_the_driver_in_its_tangent_frame() {
    let slide = |s: f64, _: f64| [2e-4 * (WAVENUMBER * s).sin(), 1e-4];
    let mut patch = Patch::slid(Driver::Flat, [240, 4], 1e-3, slide);
    for (position, below) in patch.positions.iter_mut().zip(&patch.driver_positions) {
        position.z += sine(below.x, below.y);
    }
    let turn = Isometry3::new(Vector3::zeros(), Vector3::new(0.3, -0.8, 1.1));
    let map = detailed(&patch.moved(&turn), Frame::Driver);
    let found = values(&map, Detail::Displacement).chunks_exact(3);
    let found: Vec<_> = found.map(|c| Vector3::new(c[0], c[1], c[2])).collect();
    for (texel, [s, t]) in inner(&map) {
        // Up in the image is the second parameter.
        let [x, y] = slide(s, t);
        let exact = Vector3::new(x, y, sine(s, t));
        let error = (found[texel].map(f64::from) - exact).norm();
        assert!(error < 2e-2 * AMPLITUDE, "{error} m at {s}, {t}");
    }
}

#[test]
fn object_normals_of_a_turned_cylinder_are_those_of_the_cylinder() {
    const RADIUS: f64 = 0.05;
    let turn = Isometry3::new(Vector3::zeros(), Vector3::new(0.4, 0.9, -0.2));
    let patch = Patch::new(Driver::Cylinder(RADIUS), [96, 48], 1e-3, |_, _| 0.0).moved(&turn);
    let mut map = detailed(&patch, Frame::Driver);
    let artist = Patch::new(Driver::Cylinder(RADIUS), [48, 48], 0.0, |_, _| 0.0);
    map.paint_object_normals(&artist.uvs, &patch.frames)
        .expect("valid frames");
    let normals = values(&map, Detail::ObjectNormal).chunks_exact(3);
    for (texel, normal) in normals.enumerate() {
        let [s, t] = texel_parameters(&map, texel);
        let exact = turn.rotation * Driver::Cylinder(RADIUS).at(s, t).1;
        let found = Vector3::new(normal[0], normal[1], normal[2]).map(f64::from);
        assert!(degrees(&found, &exact) < 0.05, "{found} {exact}");
    }
}

#[test]
fn object_normals_have_the_wrinkles_in_them() {
    let patch = Patch::new(Driver::Flat, [240, 1], 1e-3, sine);
    let mut map = detailed(&patch, Frame::Mesh);
    let artist = Patch::new(Driver::Flat, [1, 1], 0.0, |_, _| 0.0);
    map.paint_object_normals(&artist.uvs, &patch.frames)
        .expect("valid frames");
    let normals = values(&map, Detail::ObjectNormal);
    for (texel, [s, _]) in inner(&map) {
        let slope = AMPLITUDE * WAVENUMBER * (WAVENUMBER * s).sin();
        let exact = Vector3::new(slope, 0.0, 1.0).normalize();
        let found = Vector3::from_column_slice(&normals[3 * texel..3 * texel + 3]);
        let error = degrees(&found.map(f64::from), &exact);
        assert!(error < 0.5, "{error} degrees at {s}");
    }
}

#[test]
fn what_does_not_wrinkle_is_neutral_on_curved_drivers() {
    for driver in [Driver::Cylinder(0.03), Driver::Sphere(0.05), Driver::Hill] {
        let patch = Patch::new(driver, [96, 12], 1e-3, |_, _| 0.0);
        let map = detailed(&patch, Frame::Mesh);
        let off = |detail: Detail, most: f64| {
            let neutral = detail.neutral().iter().cycle();
            let pairs = values(&map, detail).iter().zip(neutral);
            let worst = pairs
                .map(|(v, n)| f64::from((v - n).abs()))
                .fold(0.0, f64::max);
            assert!(worst < most, "{detail:?} is off by {worst} on {driver:?}");
        };
        off(Detail::Occlusion, 1e-3);
        off(Detail::Curvature, 1e-3);
        off(Detail::Displacement, 1e-8);
    }
}

#[test]
fn what_is_not_covered_is_neutral_and_layers_compose() {
    let whole = Patch::new(Driver::Flat, [96, 1], 0.0, sine);
    let mut part = Patch::new(Driver::Flat, [96, 1], 0.0, sine);
    let half = part.faces.len() / 2;
    part.faces.truncate(half);
    part.uvs.truncate(half);
    part.artist.truncate(half);
    let lower = detailed(&part, Frame::Driver);
    for detail in OWN {
        let channels = detail.channels();
        for (texel, values) in values(&lower, detail).chunks_exact(channels).enumerate() {
            if lower.coverage[texel] != Coverage::Covered {
                assert_eq!(values, detail.neutral());
            }
        }
    }
    let mut covered = lower.clone();
    let upper = detailed(&whole, Frame::Driver);
    covered.cover_with(&upper).expect("one size");
    assert_eq!(covered.details, upper.details);

    let mut sum = upper.clone();
    sum.add(&upper).expect("one size");
    for texel in 0..sum.coverage.len() {
        let of = |map: &WrinkleMap, detail| values(map, detail)[texel];
        let twice = 2.0 * of(&upper, Detail::Curvature);
        assert_eq!(of(&sum, Detail::Curvature), twice);
        let squared = of(&upper, Detail::Occlusion).powi(2);
        assert_eq!(of(&sum, Detail::Occlusion), squared);
    }
}

#[test]
fn compression_is_clamped_and_linear_in_between() {
    let patch = Patch::new(Driver::Flat, [24, 1], 0.0, |_, _| 0.0);
    let mut map = detailed(&patch, Frame::Driver);
    // Twice the critical compression on the right border, stretched by as much on the left.
    let ratios: Vec<[f64; 3]> = patch
        .uvs
        .iter()
        .map(|c| c.map(|uv| 4.0 * uv.x - 2.0))
        .collect();
    map.paint_compression(&patch.uvs, &ratios).expect("finite");
    for (texel, value) in values(&map, Detail::Compression).iter().enumerate() {
        let [s, _] = texel_parameters(&map, texel);
        let exact = (4.0 * s / SIDE - 2.0).clamp(0.0, 1.0);
        assert!((f64::from(*value) - exact).abs() < 1e-6, "{value} {exact}");
    }
}
