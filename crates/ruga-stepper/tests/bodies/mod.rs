//! Bodies that tests press, pull and let go.

#![allow(dead_code, reason = "no test needs all of it")]

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver, Smoothing};
use ruga_lattice::{Shape, SolidMaterial};
use ruga_material::{LayerMaterial, Substrate, WavelengthModel};
use ruga_stepper::{
    Body, Coupling, Handle, Keyframe, LayerSpec, Mask, Modelling, Motion, PoseSpec, Presence,
    Region, Sampling,
};

/// Interior of all bodies.
pub(crate) const INTERIOR: SolidMaterial = SolidMaterial {
    young: 5e4,
    poisson: 0.4,
};

/// A layer `ratio` times as stiff as the interior, so thin that its waves are a centimetre long.
pub(crate) fn layer(ratio: f64) -> LayerSpec {
    // lambda = 2 pi h (ratio / 3)^(1/3) with plane-strain moduli (RK 3).
    let thickness = 0.01 / (std::f64::consts::TAU * (ratio / 3.0).cbrt());
    LayerSpec {
        name: "skin".into(),
        material: LayerMaterial {
            young: ratio * INTERIOR.young,
            poisson: INTERIOR.poisson,
            thickness,
            density: 1000.0,
        },
        laminate: None,
        substrate: Substrate {
            young: INTERIOR.young,
            poisson: INTERIOR.poisson,
            thickness: 0.1,
        },
        model: WavelengthModel::HalfSpace,
        coupling: Coupling::Hybrid,
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

/// A body without anything that holds or pushes it.
pub(crate) fn free_body(cells: u32) -> Body {
    Body {
        cells: Some(cells),
        shape: Shape::Quadratic,
        material: INTERIOR,
        density: 1000.0,
        gravity: Vector3::zeros(),
        handles: Vec::new(),
        obstacles: Vec::new(),
        follow: None,
    }
}

/// A box from the origin to `size` (m), every side of `cells` squares along each axis, with the
/// blend shape `shape`. The top (largest z) has the left half of the texture, all else the right.
pub(crate) fn slab(
    size: Vector3<f64>,
    cells: [usize; 3],
    shape: impl Fn(Vector3<f64>) -> Vector3<f64>,
) -> Arc<Driver> {
    let mut mesh = ArtistMesh::default();
    let mut uvs = Vec::new();
    for axis in 0..3 {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        for is_high in [false, true] {
            let first = mesh.positions.len() as u32;
            let is_top = axis == 2 && is_high;
            for j in 0..=cells[b] {
                for i in 0..=cells[a] {
                    let [u, v] = [i as f64 / cells[a] as f64, j as f64 / cells[b] as f64];
                    let mut place = Vector3::zeros();
                    place[axis] = if is_high { size[axis] } else { 0.0 };
                    place[a] = u * size[a];
                    place[b] = v * size[b];
                    mesh.positions.push(place);
                    uvs.push(Vector2::new(0.5 * u + if is_top { 0.0 } else { 0.5 }, v));
                }
            }
            let at = |i: usize, j: usize| first + (j * (cells[a] + 1) + i) as u32;
            for j in 0..cells[b] {
                for i in 0..cells[a] {
                    let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    let quad = match is_high {
                        true => [[p, q, r], [p, r, s]],
                        false => [[p, r, q], [p, s, r]],
                    };
                    mesh.triangles.extend(quad);
                }
            }
        }
    }
    mesh.shapes = vec![BlendShape {
        name: "shape".into(),
        position_deltas: mesh.positions.iter().map(|p| shape(*p) - p).collect(),
        normal_deltas: None,
    }];
    mesh.uvs = Some(uvs);
    Arc::new(Driver::new(&mesh).expect("a closed box"))
}

/// The top of a slab.
pub(crate) fn top() -> Region {
    Region::Mask(Mask::new(2, 1, vec![1.0, 0.0]).expect("two pixels"))
}

/// The faces of a body as they are, so many edges per wavelength.
pub(crate) fn modelling(points: f64) -> Modelling {
    Modelling {
        points_per_wavelength: points,
        smoothing: Smoothing::None,
        ..Modelling::default()
    }
}

/// Everything between two planes across x.
pub(crate) fn slice(name: &str, from: f64, to: f64) -> Handle {
    let corners = [[from, -1.0, -1.0], [to, 1.0, 1.0]];
    Handle::new(name, corners.map(Vector3::from))
}

/// Straight to `way` at full load.
pub(crate) fn push(of: &str, way: Vector3<f64>) -> Motion {
    Motion {
        of: of.into(),
        keyframes: vec![Keyframe {
            at: 1.0,
            translation: way,
            turn: Vector3::zeros(),
            about: Vector3::zeros(),
        }],
    }
}

/// A pose whose blend shapes stand still.
pub(crate) fn pose(motions: Vec<Motion>, keys: &[f64], steps: u32) -> PoseSpec {
    PoseSpec {
        name: "pose".into(),
        weights: Default::default(),
        keys: keys.to_vec(),
        steps,
        motions,
        growths: Vec::new(),
        half: false,
    }
}

/// Compression of the line between the two of the driver's vertices that are closest to two places.
pub(crate) fn compression(driver: &Driver, now: &[Vector3<f64>], ends: [Vector3<f64>; 2]) -> f64 {
    let rest = driver.rest();
    let [a, b] = ends.map(|end| {
        let distance = |&i: &usize| (rest[i] - end).norm();
        let nearest = (0..rest.len()).min_by(|i, j| distance(i).total_cmp(&distance(j)));
        nearest.expect("a driver has vertices")
    });
    1.0 - (now[b] - now[a]).norm() / (rest[b] - rest[a]).norm()
}
