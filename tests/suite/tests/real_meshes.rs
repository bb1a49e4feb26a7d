//! A face and odd files: wavelength, direction, border, maps, the same bytes every time.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::LazyLock;

use nalgebra::{Vector2, Vector3};
use rayon::ThreadPoolBuilder;
use ruga_bake::{Coverage, WrinkleMap};
use ruga_blend::{Driver, face_strains};
use ruga_io::{ObjOptions, read_mesh};
use ruga_mesh::triangle_frame;
use ruga_mesh::{Id, TriMesh};
use ruga_stepper::{LayerSurface, Modelling, PoseSpec, plan};
use ruga_validation::{Skin, asset, shared_data, tilts};

/// The key that shows the layer at rest.
const REST: f64 = 1e-6;

fn draft(points_per_wavelength: f64) -> Modelling {
    Modelling {
        points_per_wavelength,
        ..Modelling::default()
    }
}

/// Heights of the layer above the driver, m.
fn heights(layer: &LayerSurface) -> Vec<f64> {
    (0..layer.positions.len())
        .map(|i| layer.driver_normals[i].dot(&(layer.positions[i] - layer.driver_positions[i])))
        .collect()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// Vertices on edges that only one face has.
fn border_vertices(layer: &LayerSurface) -> Vec<usize> {
    let mut uses = BTreeMap::new();
    for &[a, b, c] in layer.faces.iter() {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            *uses.entry((i.min(j), i.max(j))).or_insert(0) += 1;
        }
    }
    let once = uses.iter().filter(|(_, count)| **count == 1);
    let mut vertices: Vec<usize> = once
        .flat_map(|((i, j), _)| [*i as usize, *j as usize])
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// Covered texels next to a neutral one.
fn outer_ring(map: &WrinkleMap) -> Vec<usize> {
    let side = map.size as usize;
    let is_neutral = |texel: usize| map.coverage[texel] == Coverage::Neutral;
    (0..side * side)
        .filter(|&texel| !is_neutral(texel))
        .filter(|&texel| {
            let (row, column) = (texel / side, texel % side);
            (row > 0 && is_neutral(texel - side))
                || (row + 1 < side && is_neutral(texel + side))
                || (column > 0 && is_neutral(texel - 1))
                || (column + 1 < side && is_neutral(texel + 1))
        })
        .collect()
}

/// Angle between the wrinkles' slope and the driver's compression, degrees: mean over the faces
/// whose demand passes `critical`, weighted by area and squared slope.
fn misalignment(rest: &LayerSurface, layer: &LayerSurface, poisson: f64, critical: f64) -> f64 {
    let mesh = TriMesh::new(layer.positions.len(), layer.faces.to_vec()).expect("the layer's mesh");
    let strains = face_strains(&mesh, &rest.driver_positions, &layer.driver_positions);
    let heights = heights(layer);
    let (mut angles, mut weights) = (0.0, 0.0);
    for (face, strain) in strains.iter() {
        if strain.effective(poisson) <= critical {
            continue;
        }
        let corners = layer.faces[face.index()].map(|v| v as usize);
        let slope = gradient(
            corners.map(|v| rest.driver_positions[v]),
            corners.map(|v| heights[v]),
        );
        let cosine = slope.0.dot(&strain.direction).abs() / slope.0.norm().max(f64::MIN_POSITIVE);
        let weight = slope.1 * slope.0.norm_squared();
        angles += weight * cosine.min(1.0).acos().to_degrees();
        weights += weight;
    }
    angles / weights
}

/// Gradient of a linear function in the triangle's rest frame, and the triangle's area.
fn gradient(corners: [Vector3<f64>; 3], values: [f64; 3]) -> (Vector2<f64>, f64) {
    let frame = triangle_frame(&corners);
    let edges = [corners[1] - corners[0], corners[2] - corners[0]];
    let [p, q] = edges.map(|e| Vector2::new(e.dot(&frame[0]), e.dot(&frame[1])));
    let twice_area = p.perp(&q);
    let (b, c) = (values[1] - values[0], values[2] - values[0]);
    let slope = Vector2::new(b * q.y - c * p.y, c * p.x - b * q.x) / twice_area;
    (slope, 0.5 * twice_area)
}

/// `tolerance` of the wavelength: where a region holds few waves, lengths come in large steps.
fn check_real(name: &str, skin: &Skin, weights: &[(&str, f64)], (steps, tolerance): (u32, f64)) {
    let mut pose = skin.pose(weights, steps);
    pose.keys = vec![REST, 1.0];
    let result = skin.simulate(&pose, &draft(6.0));
    let report = &result.layers[0];
    assert!(result.converged, "{name}: {:?}", result.warnings);
    let wavelength = report.wavelength.expect("wrinkles");
    let ratio = wavelength / report.wavelength_predicted;
    let [rest, full] = [0, 1].map(|key| &result.keys[key].layers[0]);
    let angle = misalignment(
        rest,
        full,
        skin.layer.material.poisson,
        report.critical_strain_predicted,
    );
    let map = skin.bake(&pose, &result.keys[1], 512);
    let steepest = tilts(&map).fold(0.0, f64::max);
    println!(
        "{name}: {} vertices, onset {:?}, {} factorizations, wavelength {:.2} mm = {ratio:.3} of \
         predicted, amplitude {:.3} mm, angle {angle:.1} degrees, steepest {steepest:.1} degrees, \
         {} folded samples, deepest {:.3} mm",
        report.vertices,
        report.onset_load,
        report.factorizations,
        1e3 * wavelength,
        1e3 * report.amplitude,
        map.folded_samples,
        1e3 * largest(map.heights.iter().map(|h| f64::from(*h))),
    );
    assert!(
        (ratio - 1.0).abs() < tolerance,
        "{name}: wavelength {ratio}"
    );
    assert!(angle < 25.0, "{name}: {angle} degrees");
    check_texels(&map);
}

/// Unit normals that point outwards, finite heights.
fn check_texels(map: &WrinkleMap) {
    for (n, h) in map.normals.iter().zip(&map.heights) {
        let length = n.iter().map(|c| c * c).sum::<f32>();
        assert!((length - 1.0).abs() < 1e-4, "normal {n:?}");
        assert!(n[2] > 0.0, "normal {n:?}");
        assert!(h.is_finite());
    }
    let covered = map.coverage.iter().filter(|c| **c == Coverage::Covered);
    // A fold is an exception: one sample in a thousand.
    assert!(map.folded_samples * 1000 <= covered.count());
}

#[test]
fn face_raising_its_brows() {
    let Some(path) = shared_data("ict-facekit/ict_face_arkit.glb") else {
        return;
    };
    let skin = Skin::new(&path, "forehead-furrow");
    let brows = [("browInnerUp_L", 1.0), ("browInnerUp_R", 1.0)];
    check_real("face", &skin, &brows, (2, 0.2));
}

/// Whole fingers turn on straight lines, so the strain grows instead of the weight.
#[test]
fn flexed_fingers() {
    let Some(path) = shared_data("makehuman-hand/mh_hand_forearm.glb") else {
        return;
    };
    let skin = Skin::new(&path, "reference-dermis");
    // Fingers are narrower than a wavelength.
    check_real("hand", &skin, &[("fingersFlex", 1.0)], (8, 0.3));
}

/// The joint's radius is 5.7 of an eyelid's wavelengths: from 5 on, waves are as long as on a plane.
#[test]
fn flexed_finger_with_fine_wrinkles() {
    let skin = Skin::new(&asset("finger/finger.glb"), "eyelid");
    check_real("finger", &skin, &[("flex", 1.0)], (2, 0.1));
}

#[test]
fn odd_files_are_planned_or_refused() {
    let Some(folder) = shared_data("gltf-edge-cases") else {
        return;
    };
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        let name = path.file_name().expect("a file").to_string_lossy();
        let outcome = plan_every_shape(&path);
        println!("{name}: {outcome:?}");
        match (&*name, outcome) {
            ("01_morphed_cube.gltf" | "01_morphed_triangle.gltf", outcome) => {
                assert!(outcome.is_ok(), "{name}: {outcome:?}");
            }
            (_, outcome) => {
                let refusal = outcome.expect_err("a mesh without texture coordinates");
                assert!(
                    refusal.contains("no texture coordinates"),
                    "{name}: {refusal}"
                );
            }
        }
    }
}

/// Active areas of the file's shapes at full weight, m², or why they cannot be planned.
fn plan_every_shape(path: &Path) -> Result<Vec<f64>, String> {
    let file = read_mesh(path, None, &ObjOptions::default()).map_err(|error| error.to_string())?;
    let driver = Driver::new(&file.mesh).map_err(|error| error.to_string())?;
    let poses: Vec<PoseSpec> = driver
        .shape_names()
        .map(|name| PoseSpec {
            name: name.to_owned(),
            weights: driver.weights([(name, 1.0)]).expect("its own shape"),
            keys: vec![1.0],
            steps: 1,
            motions: Vec::new(),
            growths: Vec::new(),
            half: false,
        })
        .collect();
    // The cubes are two metres wide: under thin skin their planning meshes grow to the limit.
    let mut layer = Skin::new(&asset("forearm/forearm.glb"), "forehead-furrow").layer;
    layer.material.thickness *= 20.0;
    layer.substrate.thickness *= 20.0;
    let plan = plan(
        &Arc::new(driver),
        &[layer],
        &poses,
        &Modelling::default(),
        512,
    )
    .map_err(|error| error.to_string())?;
    let areas = plan.poses.iter().map(|pose| pose.layers[0].active_area);
    Ok(areas.collect())
}

/// The pinched forearm and its map.
struct Pinched {
    layer: LayerSurface,
    map: WrinkleMap,
}

/// Simulates and bakes the pinched forearm on so many threads.
fn pinched_forearm(threads: usize) -> Pinched {
    let skin = Skin::new(&asset("forearm/forearm.glb"), "forehead-furrow");
    let pose = skin.pose(&[("pinch", 1.0)], 4);
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let result = skin.simulate(&pose, &draft(6.0));
        assert!(result.converged, "{:?}", result.warnings);
        let map = skin.bake(&pose, &result.keys[0], 512);
        let layer = result.keys[0].layers[0].clone();
        Pinched { layer, map }
    })
}

/// On one thread, for all tests.
static PINCHED: LazyLock<Pinched> = LazyLock::new(|| pinched_forearm(1));

/// The ring of texels inside the border: the neutral outside must follow without a step.
#[test]
fn border_of_the_region_shows_no_step() {
    let Pinched { layer, map } = &*PINCHED;
    let heights = heights(layer);
    let pinned = largest(border_vertices(layer).into_iter().map(|v| heights[v]));
    assert!(pinned < 1e-12, "height {pinned} m on the border");

    check_texels(map);
    let ring = outer_ring(map);
    assert!(!ring.is_empty(), "the region reaches every border");
    let all_tilts: Vec<f64> = tilts(map).collect();
    let tilt = largest(ring.iter().map(|&texel| all_tilts[texel]));
    let step = largest(ring.iter().map(|&texel| f64::from(map.heights[texel])));
    let deepest = largest(heights);
    println!(
        "border: {} texels, tilt {tilt:.3} degrees of {:.1}, height {:.3} um of {:.1}",
        ring.len(),
        largest(all_tilts),
        1e6 * step,
        1e6 * deepest,
    );
    assert!(tilt < 1.0, "tilt {tilt} degrees at the border");
    assert!(step < 0.01 * deepest, "a step of {step} m");
}

/// Every bit of a map.
fn bits(map: &WrinkleMap) -> impl Iterator<Item = u32> + '_ {
    let normals = map.normals.iter().flatten();
    normals.chain(&map.heights).map(|c| c.to_bits())
}

/// Also the same pose a second time.
#[test]
fn two_threads_give_the_bytes_of_one() {
    assert!(bits(&PINCHED.map).eq(bits(&pinched_forearm(2).map)));
}
