//! Poses that are their own mirror images, of which one half is simulated.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

#[allow(dead_code, reason = "a square around the origin is wanted here")]
mod patch;

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use patch::{SIDE, draft, pose, skin};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_stepper::{
    Coupling, LayerReport, LayerSpec, LayerSurface, Modelling, PoseResult, PoseSpec, Silent, Stack,
    StepperError, SymmetryPlane, plan,
};

/// A square around the origin; `across` shortens its middle by 12 % in y, so that wrinkles cross the plane x = 0,
/// `along` in x, so that one runs along it, both fading towards the border, and `aside` moves it off the plane.
fn driver_of(cells: i32) -> Arc<Driver> {
    driver_with(cells, |_| false)
}

/// The same with the other diagonal in some rows.
fn driver_with(cells: i32, is_turned: impl Fn(i32) -> bool) -> Arc<Driver> {
    let mut mesh = ArtistMesh::default();
    let mut uvs = Vec::new();
    for (i, j) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j))) {
        let [u, v] = [i, j].map(|c| f64::from(c) / f64::from(cells));
        let bump = 0.1 * SIDE * (1.0 - 4.0 * (u - 0.5).powi(2)) * v;
        mesh.positions
            .push(Vector3::new(SIDE * (u - 0.5), SIDE * (v - 0.5), bump));
        uvs.push(Vector2::new(u, 1.0 - v));
    }
    for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
        let a = j * (cells + 1) + i;
        let [b, c, d] = [a + 1, a + cells + 2, a + cells + 1];
        let halves = match is_turned(j) {
            false => [[a, b, c], [a, c, d]],
            true => [[a, b, d], [b, c, d]],
        };
        mesh.triangles.extend(halves.map(|t| t.map(|v| v as u32)));
    }
    let wave = std::f64::consts::TAU / SIDE;
    let pressed = |c: f64| -0.06 * ((wave * c).sin() / wave + c);
    let shape = |name: &str, delta: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| BlendShape {
        name: name.into(),
        position_deltas: mesh.positions.iter().map(delta).collect(),
        normal_deltas: None,
    };
    let shapes = vec![
        shape("across", &|p| Vector3::y() * pressed(p.y)),
        shape("along", &|p| Vector3::x() * pressed(p.x)),
        shape("aside", &|_| Vector3::x() * 0.01),
    ];
    (mesh.shapes, mesh.uvs) = (shapes, Some(uvs));
    Arc::new(Driver::new(&mesh).unwrap())
}

fn driver() -> Arc<Driver> {
    driver_of(12)
}

fn half(driver: &Driver, shape: &str) -> PoseSpec {
    PoseSpec {
        keys: vec![1.0],
        half: true,
        ..pose(driver, shape, 1.0)
    }
}

fn simulated(driver: &Arc<Driver>, layers: &[LayerSpec], pose: PoseSpec) -> PoseResult {
    let plan = plan(driver, layers, &[pose], &draft(), 256).unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    result
}

/// Twice the energy, the wavelength, the amplitude and twice the vertices of a half, over those of the whole.
fn ratios(half: &LayerReport, whole: &LayerReport) -> [f64; 4] {
    [
        2.0 * half.energy / whole.energy,
        half.wavelength.unwrap() / whole.wavelength.unwrap(),
        half.amplitude / whole.amplitude,
        2.0 * half.vertices as f64 / whole.vertices as f64,
    ]
}

/// The largest slope of the relief, and the largest across the plane of the faces beside it.
fn slopes(surface: &LayerSurface) -> [f64; 2] {
    let ways = surface.displacements();
    let mut most = [0.0_f64; 2];
    for face in surface.faces.iter() {
        let corners = face.map(|v| v as usize);
        let [a, b, c] = corners.map(|v| surface.driver_positions[v].xy());
        let heights = corners.map(|v| ways[v].z);
        let (u, v) = (b - a, c - a);
        let [du, dv] = [heights[1] - heights[0], heights[2] - heights[0]];
        let area = u.perp(&v);
        let slope = Vector2::new(du * v.y - dv * u.y, dv * u.x - du * v.x) / area;
        most[0] = most[0].max(slope.norm());
        let beside = corners.iter().filter(|v| surface.on_plane[**v]).count();
        if beside == 2 && a.y.abs() < 0.3 * SIDE {
            // Of an even function it is half of an edge's curvature away from nothing.
            most[1] = most[1].max(slope.x.abs());
        }
    }
    most
}

fn whole(half: &PoseSpec) -> PoseSpec {
    PoseSpec {
        half: false,
        ..half.clone()
    }
}

/// Wavelength, amplitude and energy are those of the whole, and wrinkles pass the plane without a kink.
#[test]
fn a_half_is_half_of_the_whole() {
    // Of an odd number of columns the plane cuts the middle one.
    let cases = [
        (12, Coupling::Elastic),
        (12, Coupling::Hybrid),
        (11, Coupling::Hybrid),
    ];
    for (cells, coupling) in cases {
        let driver = driver_of(cells);
        let layers = [skin("forehead-furrow", coupling)];
        let pose = half(&driver, "across");
        let all = simulated(&driver, &layers, whole(&pose));
        let own = simulated(&driver, &layers, pose);
        let found = ratios(&own.layers[0], &all.layers[0]);
        let pairs = found.iter().zip([0.01, 0.02, 0.02, 0.1]);
        let is_near = |(ratio, most): (&f64, f64)| (ratio - 1.0).abs() < most;
        assert!(
            pairs.clone().all(|(r, m)| is_near((r, m))),
            "{cells} {coupling:?} {found:?}"
        );
        let surface = &own.keys[0].layers[0];
        let pairs = surface.positions.iter().zip(surface.on_plane.iter());
        let on_plane: Vec<_> = pairs.filter(|(_, on)| **on).collect();
        assert!(on_plane.len() > 12, "{} vertices", on_plane.len());
        assert!(on_plane.iter().all(|(x, _)| x.x.abs() < 1e-9));
        let [most, across] = slopes(surface);
        assert!(across < 0.1 * most, "{across} of {most}");
    }
}

/// A wrinkle along the plane is even: a crest or a valley lies on it.
#[test]
fn a_wrinkle_along_the_plane_has_no_slope_there() {
    let driver = driver();
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let own = simulated(&driver, &layers, half(&driver, "along"));
    let surface = &own.keys[0].layers[0];
    let [most, across] = slopes(surface);
    // A face beside the plane has the slope of its middle, a twelfth of a wave away: half of the largest.
    assert!(across < 0.5 * most && most > 0.3, "{across} of {most}");
    let ways = surface.displacements();
    let near = surface
        .driver_positions
        .iter()
        .zip(ways.iter().zip(surface.on_plane.iter()));
    let on_plane = near.filter(|(x, (_, on))| **on && x.y.abs() < 0.2 * SIDE);
    let heights: Vec<f64> = on_plane.map(|(_, (way, _))| way.z.abs()).collect();
    let amplitude = own.layers[0].amplitude;
    assert!(
        heights.iter().all(|h| *h > 0.5 * amplitude),
        "{heights:?} {amplitude}"
    );
}

/// The upper of two layers lies on the lower one and on its mirror image.
#[test]
fn layers_on_each_other_are_halved_alike() {
    let driver = driver();
    let upper = LayerSpec {
        name: "upper".into(),
        ..skin("crows-feet", Coupling::Hybrid)
    };
    let layers = [skin("forehead-furrow", Coupling::Hybrid), upper];
    let pose = half(&driver, "across");
    let all = simulated(&driver, &layers, whole(&pose));
    let own = simulated(&driver, &layers, pose);
    for (own, all) in own.layers.iter().zip(&all.layers) {
        let found = ratios(own, all);
        let pairs = found.iter().zip([0.02, 0.02, 0.03, 0.1]);
        let is_near = |(ratio, most): (&f64, f64)| (ratio - 1.0).abs() < most;
        assert!(pairs.clone().all(|(r, m)| is_near((r, m))), "{found:?}");
    }
    let [most, across] = slopes(&own.keys[0].layers[1]);
    assert!(across < 0.1 * most, "{across} of {most}");
}

#[test]
fn what_cannot_be_halved_is_refused() {
    let layers = [skin("forehead-furrow", Coupling::Hybrid)];
    let refusal = |driver: &Arc<Driver>, shape: &str, modelling: &Modelling| {
        let poses = [half(driver, shape)];
        let layers = match modelling.stack {
            Stack::Joint => [layers.as_slice(), layers.as_slice()].concat(),
            _ => layers.to_vec(),
        };
        let refused = plan(driver, &layers, &poses, modelling, 256).map(|_| ());
        match refused.unwrap_err() {
            StepperError::Setting {
                field, accepted, ..
            } => (field, accepted),
            other => panic!("{other}"),
        }
    };
    let driver = driver();
    let weights = |shape: &str| driver.weights([(shape, 1.0)]).unwrap();
    let plane = SymmetryPlane::new(&driver);
    assert!(plane.keeps(&driver, &weights("across")));
    assert!(!plane.keeps(&driver, &weights("aside")));
    // Diagonals that lean to one side in every other row draw the smooth surface half a millimetre beside the plane.
    let leaning = driver_with(12, |j| j % 2 == 0);
    assert!(!SymmetryPlane::new(&leaning).keeps(&leaning, &weights("across")));
    let (name, accepted) = refusal(&driver, "aside", &draft());
    assert_eq!(name, "half");
    assert!(accepted.contains("lies on the plane x = 0"), "{accepted}");
    let joint = Modelling {
        stack: Stack::Joint,
        ..draft()
    };
    let (_, accepted) = refusal(&driver, "across", &joint);
    assert!(accepted.contains("one on the other"), "{accepted}");
}
