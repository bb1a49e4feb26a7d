//! Where nothing wrinkles, nothing shows: facets, offset, curvature, sliding, the region's border.

mod patch;

use nalgebra::{Isometry3, Vector3};
use patch::{Driver, Patch, SIDE, baked, degrees, largest_tilt};
use ruga_bake::{BakeSettings, Coverage, WrinkleMap, bake};

const OFFSET: f64 = 1.4e-3;

fn map(patch: &Patch) -> WrinkleMap {
    let settings = BakeSettings {
        size: 256,
        ..BakeSettings::default()
    };
    bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch")
}

fn largest_height(map: &WrinkleMap) -> f64 {
    map.heights
        .iter()
        .fold(0.0, |largest, &h| f64::from(h).abs().max(largest))
}

fn a_motion() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.3, -1.2, 0.7), Vector3::new(1.1, -0.4, 2.0))
}

#[test]
fn a_layer_at_rest_distance_is_neutral_to_rounding_on_coarse_facets() {
    // Twelve facets across 143 degrees of a cylinder: 12 degrees from one to the next.
    for driver in [Driver::Cylinder(0.04), Driver::Sphere(0.06)] {
        let patch = Patch::new(driver, [12, 4], OFFSET, |_, _| 0.0).moved(&a_motion());
        let map = map(&patch);
        assert!(map.coverage.iter().all(|&c| c == Coverage::Covered));
        assert!(largest_tilt(&map) < 1e-5, "{} degrees", largest_tilt(&map));
        assert!(largest_height(&map) < 1e-9 * OFFSET);
    }
}

/// In a valley narrower than the layer's distance from it a layer without wrinkles goes through itself and faces
/// down, and shows nothing of that.
#[test]
fn a_layer_beyond_the_centre_of_a_valley_is_neutral() {
    for offset in [-0.03, -0.037, -0.05] {
        let patch = Patch::new(Driver::Cylinder(0.04), [24, 4], offset, |_, _| 0.0);
        let map = map(&patch.moved(&a_motion()));
        assert!(largest_tilt(&map) < 1e-5, "{} degrees", largest_tilt(&map));
        assert!(largest_height(&map) < 1e-9 * offset.abs());
    }
}

/// A coarse driver with interpolated normals (Phong), below a fine layer that follows its facets.
#[test]
fn facets_of_the_driver_do_not_show_through_a_fine_layer() {
    let (coarse, fine) = (12, 96);
    let driver = Driver::Cylinder(0.04);
    let mut patch = Patch::new(driver, [fine, 4], OFFSET, |_, _| 0.0);
    let facet = SIDE / coarse as f64;
    for vertex in 0..patch.positions.len() {
        let [s, t] =
            [vertex % (fine + 1), vertex / (fine + 1)].map(|i| i as f64 * SIDE / fine as f64);
        let left = (s / facet).floor().min(coarse as f64 - 1.0) * facet;
        let along = (s - left) / facet;
        let [(p0, n0), (p1, n1)] = [driver.at(left, t), driver.at(left + facet, t)];
        patch.driver_positions[vertex] = p0.lerp(&p1, along);
        patch.driver_normals[vertex] = n0.lerp(&n1, along).normalize();
        patch.positions[vertex] =
            patch.driver_positions[vertex] + patch.driver_normals[vertex] * OFFSET;
    }
    let map = map(&patch.moved(&a_motion()));
    assert!(largest_tilt(&map) < 1e-5, "{} degrees", largest_tilt(&map));
}

#[test]
fn rigid_sliding_on_a_sphere_and_around_a_cylinder_is_neutral() {
    // Five per cent of the radius around the axis.
    for (driver, slide) in [(Driver::Cylinder(0.04), 2e-3), (Driver::Sphere(0.06), 3e-3)] {
        let patch = Patch::slid(driver, [48, 8], OFFSET, |_, _| [slide, 0.0]).moved(&a_motion());
        let map = map(&patch);
        println!(
            "{driver:?}: {} degrees, {} m",
            largest_tilt(&map),
            largest_height(&map)
        );
        assert!(largest_tilt(&map) < 0.01, "{} degrees", largest_tilt(&map));
        assert!(largest_height(&map) < 1e-6);
    }
}

#[test]
fn sliding_that_stretches_the_layer_is_neutral() {
    // Up to three per cent of the radius with eleven per cent of strain, both ways.
    for (driver, radius) in [
        (Driver::Cylinder(0.04), 0.04),
        (Driver::Sphere(0.06), 0.06),
        (Driver::Hill, 0.04),
    ] {
        let slide = |s: f64, t: f64| {
            let k = 3.6 / radius;
            [
                0.03 * radius * (k * s).sin() * (k * t).cos(),
                0.03 * radius * (k * t + 0.4).sin(),
            ]
        };
        let map = map(&Patch::slid(driver, [96, 8], OFFSET, slide));
        println!(
            "{driver:?}: {} degrees, {} m",
            largest_tilt(&map),
            largest_height(&map)
        );
        assert!(largest_tilt(&map) < 0.1, "{} degrees", largest_tilt(&map));
        assert!(largest_height(&map) < 5e-6);
    }
}

/// A bump of compact support, and the patch cropped to the support's bounding square: the border
/// must not step.
#[test]
fn the_border_of_the_region_does_not_show() {
    let bump = |s: f64, t: f64| {
        let r2 = ((s - 0.05).powi(2) + (t - 0.05).powi(2)) / 0.025_f64.powi(2);
        0.5e-3 * (1.0 - r2).max(0.0).powi(3)
    };
    let driver = Driver::Cylinder(0.04);
    let whole = Patch::new(driver, [96, 8], OFFSET, bump);
    let mut cropped = Patch::new(driver, [96, 8], OFFSET, bump);
    crop(&mut cropped, 24..72);
    let [whole, cropped] = [map(&whole), map(&cropped)];
    let step = (0..whole.normals.len())
        .map(|texel| degrees(&baked(&whole, texel), &baked(&cropped, texel)))
        .fold(0.0, f64::max);
    println!("border: {step} degrees of {}", largest_tilt(&whole));
    assert!(largest_tilt(&whole) > 1.0);
    assert!(cropped.coverage.contains(&Coverage::Neutral));
    assert!(step < 0.1, "{step} degrees");
}

/// Keeps the faces of a square range of the 96 x 96 cells. Unused vertices stay.
fn crop(patch: &mut Patch, range: std::ops::Range<usize>) {
    let kept = |face: usize| {
        let quad = face / 2;
        range.contains(&(quad % 96)) && range.contains(&(quad / 96))
    };
    keep(&mut patch.faces, kept);
    keep(&mut patch.uvs, kept);
    keep(&mut patch.artist, kept);
}

fn keep<T: Copy>(elements: &mut Vec<T>, kept: impl Fn(usize) -> bool) {
    let all = std::mem::take(elements).into_iter().enumerate();
    *elements = all
        .filter(|(face, _)| kept(*face))
        .map(|(_, element)| element)
        .collect();
}
