//! A fold, along which the mesh has a vertex on either side, is baked as a jump one texel wide.

mod patch;

use nalgebra::Vector3;
use patch::{Driver, Patch, SIDE, baked, degrees, rms, texel_parameters, waves};
use ruga_bake::{BakeSettings, WrinkleMap, bake};

/// Depth of the fold (m), and the length over which its flanks flatten: both sides fall by 45 degrees.
const DEPTH: f64 = 5e-3;

/// Distance from the line, in texels, from which on a texel sees one side alone.
const BESIDE: f64 = 1.0;

/// Height (m) of a furrow of 90 degrees in the middle with waves on it, which are even across the fold.
fn folded(s: f64, t: f64) -> f64 {
    -DEPTH * (-(s - 0.5 * SIDE).abs() / DEPTH).exp() + waves(s, t)
}

/// The patch, with the vertices on the line once for either side.
fn open(cells: usize, driver: Driver) -> Patch {
    let mut patch = Patch::new(driver, [cells, 16], 0.0, folded);
    let stride = cells + 1;
    let line = |v: u32| (v as usize) % stride == cells / 2;
    let first = patch.positions.len() as u32;
    for row in 0..=cells {
        let v = row * stride + cells / 2;
        patch.positions.push(patch.positions[v]);
        patch.driver_positions.push(patch.driver_positions[v]);
        patch.driver_normals.push(patch.driver_normals[v]);
    }
    for face in &mut patch.faces {
        if face.iter().any(|&v| v as usize % stride > cells / 2) {
            for v in face.iter_mut().filter(|v| line(**v)) {
                *v = first + *v / stride as u32;
            }
        }
    }
    patch
}

/// Normal of the folded patch in the frame of the surface below.
fn exact(driver: Driver, s: f64, t: f64) -> Vector3<f64> {
    let h = 1e-7;
    let position = |s: f64, t: f64| {
        let (p, n) = driver.at(s, t);
        p + n * folded(s, t)
    };
    let ds = position(s + h, t) - position(s - h, t);
    let dt = position(s, t + h) - position(s, t - h);
    let (relief, n) = (ds.cross(&dt).normalize(), driver.at(s, t).1);
    // Along the first parameter, as the texture runs.
    let along = driver.at(s + h, t).0 - driver.at(s - h, t).0;
    let tangent = (along - n * n.dot(&along)).normalize();
    let bitangent = n.cross(&tangent);
    Vector3::new(relief.dot(&tangent), relief.dot(&bitangent), relief.dot(&n))
}

/// RMS errors: of normals beside the line and of the jumps of the normal across it (degrees), and of heights
/// beside it (m).
fn measured(driver: Driver, map: &WrinkleMap) -> [f64; 3] {
    let texel = SIDE / f64::from(map.size);
    let off = |i: usize| (texel_parameters(map, i)[0] - 0.5 * SIDE) / texel;
    let beside = || (0..map.normals.len()).filter(|&i| off(i).abs() > BESIDE);
    let normals = beside().map(|i| {
        let [s, t] = texel_parameters(map, i);
        degrees(&baked(map, i), &exact(driver, s, t))
    });
    let heights = beside().map(|i| {
        let [s, t] = texel_parameters(map, i);
        f64::from(map.heights[i]) - folded(s, t)
    });
    let size = map.size as usize;
    let jumps = (0..size).map(|row| {
        let sides = [0, 1].map(|side| row * size + size / 2 - 1 + side);
        let found = sides.map(|i| baked(map, i));
        let wanted = sides.map(|i| {
            let [s, t] = texel_parameters(map, i);
            exact(driver, s, t)
        });
        degrees(&found[0], &found[1]) - degrees(&wanted[0], &wanted[1])
    });
    [rms(normals), rms(jumps), rms(heights)]
}

#[test]
fn a_fold_is_a_jump_within_a_texel() {
    for driver in [Driver::Flat, Driver::Cylinder(0.04)] {
        let patch = open(224, driver);
        let settings = BakeSettings {
            size: 256,
            ..BakeSettings::default()
        };
        let map = bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch");
        let [normal, jump, height] = measured(driver, &map);
        println!(
            "{driver:?}: {normal:.4}, {jump:.4} degrees, {:.3} um",
            height * 1e6
        );
        assert!(normal < 0.3, "{driver:?}: {normal} degrees");
        assert!(height < 0.3e-6, "{driver:?}: {height} m");
        assert!(jump < 0.3, "{driver:?}: {jump} degrees");
    }
}

/// Samples along a side of a texel.
const SAMPLES: u32 = 4;

/// A texel that the line goes through has the mean of what its samples see on either side, normals and heights, and so
/// have the texels beside it: the fold is antialiased, and the height goes on across it. Measured: within 0.27 degrees and
/// 0.11 micrometres.
#[test]
fn a_fold_within_a_texel_is_antialiased() {
    for driver in [Driver::Flat, Driver::Cylinder(0.04)] {
        let patch = open(224, driver);
        let settings = BakeSettings {
            // An odd number: the line runs through the middle of a column.
            size: 255,
            supersample: SAMPLES,
            ..BakeSettings::default()
        };
        let map = bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch");
        let size = map.size as usize;
        let texel = SIDE / f64::from(map.size);
        let (mut tilt, mut height) = (0.0_f64, 0.0_f64);
        // Without the rows at the border, whose samples see less of the patch.
        for i in (8..size - 8).flat_map(|row| (0..3).map(move |c| row * size + size / 2 - 1 + c)) {
            let [s, t] = texel_parameters(&map, i);
            let offset = |k: u32| ((f64::from(k) + 0.5) / f64::from(SAMPLES) - 0.5) * texel;
            let samples = (0..SAMPLES).flat_map(|k| (0..SAMPLES).map(move |l| (k, l)));
            let places = samples.map(|(k, l)| (s + offset(k), t + offset(l)));
            let (normal, mean) = places.fold((Vector3::zeros(), 0.0), |(n, h), (s, t)| {
                (n + exact(driver, s, t), h + folded(s, t))
            });
            tilt = tilt.max(degrees(&baked(&map, i), &normal.normalize()));
            let mean = mean / f64::from(SAMPLES * SAMPLES);
            height = height.max((f64::from(map.heights[i]) - mean).abs());
        }
        println!(
            "{driver:?}: off by {tilt:.3} degrees and {:.3} um at most",
            height * 1e6
        );
        assert!(tilt < 0.5, "{driver:?}: {tilt} degrees");
        // A texel is 390 micrometres wide, and the flanks fall by as much.
        assert!(height < 3e-7, "{driver:?}: {height} m");
    }
}
