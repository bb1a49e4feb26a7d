//! A small patch of skin for the tests.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_material::preset;
use ruga_stepper::{Coupling, LayerSpec, Modelling, PoseSpec, Presence, Sampling};

/// Side of the patch, m: six wavelengths.
pub(crate) const SIDE: f64 = 0.06;

/// A flat square; `press` shortens its middle by 12 % in x, fading towards the border, `squeeze` in
/// x and y; `turn` turns all of it by 60 degrees in its plane.
pub(crate) fn driver() -> Arc<Driver> {
    let cells = 12;
    let mut mesh = ArtistMesh {
        name: "patch".into(),
        ..ArtistMesh::default()
    };
    let mut uvs = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let [x, y] = [i, j].map(|c| f64::from(c) / f64::from(cells));
            mesh.positions.push(Vector3::new(SIDE * x, SIDE * y, 0.0));
            uvs.push(Vector2::new(x, 1.0 - y));
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = j * (cells + 1) + i;
            let [b, c, d] = [a + 1, a + cells + 2, a + cells + 1];
            mesh.triangles
                .extend([[a, b, c], [a, c, d]].map(|t| t.map(|v: i32| v as u32)));
        }
    }
    mesh.uvs = Some(uvs);
    let wave = std::f64::consts::TAU / SIDE;
    let press = |p: &Vector3<f64>| Vector3::new(0.06 * ((wave * p.x).sin() / wave - p.x), 0.0, 0.0);
    let squeeze = |p: &Vector3<f64>| {
        let along = |c: f64| 0.06 * ((wave * c).sin() / wave - c);
        Vector3::new(along(p.x), along(p.y), 0.0)
    };
    let (sin, cos) = std::f64::consts::FRAC_PI_3.sin_cos();
    let turn =
        |p: &Vector3<f64>| Vector3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, 0.0) - p;
    mesh.shapes = vec![
        BlendShape {
            name: "squeeze".into(),
            position_deltas: mesh.positions.iter().map(squeeze).collect(),
            normal_deltas: None,
        },
        BlendShape {
            name: "press".into(),
            position_deltas: mesh.positions.iter().map(press).collect(),
            normal_deltas: None,
        },
        BlendShape {
            name: "turn".into(),
            position_deltas: mesh.positions.iter().map(turn).collect(),
            normal_deltas: None,
        },
        BlendShape {
            name: "fold".into(),
            position_deltas: mesh
                .positions
                .iter()
                .map(|p| Vector3::new(-1.5 * p.x, 0.0, 0.0))
                .collect(),
            normal_deltas: None,
        },
    ];
    Arc::new(Driver::new(&mesh).expect("a valid mesh"))
}

/// Skin of a preset.
pub(crate) fn skin(name: &str, coupling: Coupling) -> LayerSpec {
    let preset = preset(name).expect("a known preset");
    LayerSpec {
        name: "skin".into(),
        material: preset.layer,
        laminate: None,
        substrate: preset.substrate,
        model: Default::default(),
        coupling,
        sampling: Sampling::Quadrature,
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
        creases: Vec::new(),
        growths: Vec::new(),
    }
}

/// A pose of one shape.
pub(crate) fn pose(driver: &Driver, shape: &str, weight: f64) -> PoseSpec {
    PoseSpec {
        name: shape.into(),
        weights: driver.weights([(shape, weight)]).expect("a known shape"),
        keys: vec![0.5, 1.0],
        steps: 4,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }
}

/// Draft quality.
pub(crate) fn draft() -> Modelling {
    Modelling {
        points_per_wavelength: 6.0,
        ..Modelling::default()
    }
}
