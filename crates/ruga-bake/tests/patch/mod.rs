//! Layers over parametric drivers whose relief has an analytic normal.

#![allow(
    dead_code,
    reason = "every test file compiles this module and uses its own part of it"
)]

use nalgebra::{Isometry3, Vector2, Vector3};
use ruga_bake::{Relief, TangentFrame, WrinkleMap, tangent_frames};

/// Side of every patch, m.
pub(crate) const SIDE: f64 = 0.1;

/// A smooth driver over `[0, SIDE]²`; the second parameter runs against V.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Driver {
    /// The plane z = 0.
    Flat,
    /// A cylinder around the y axis, with its radius (m).
    Cylinder(f64),
    /// Longitude and latitude around the equator of a sphere, with its radius (m).
    Sphere(f64),
    /// A bell 10 mm high and 20 mm wide (standard deviation): curvature of both signs, least
    /// radius 40 mm.
    Hill,
}

impl Driver {
    /// Position (m) and unit normal.
    pub(crate) fn at(&self, s: f64, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        match *self {
            Driver::Flat => (Vector3::new(s, t, 0.0), Vector3::z()),
            Driver::Cylinder(radius) => {
                let angle = (s - SIDE / 2.0) / radius;
                let normal = Vector3::new(angle.sin(), 0.0, angle.cos());
                (normal * radius + Vector3::y() * t, normal)
            }
            Driver::Sphere(radius) => {
                let longitude = (s - SIDE / 2.0) / radius;
                let latitude = (t - SIDE / 2.0) / radius;
                let normal = Vector3::new(
                    latitude.cos() * longitude.sin(),
                    latitude.sin(),
                    latitude.cos() * longitude.cos(),
                );
                (normal * radius, normal)
            }
            Driver::Hill => {
                let [x, y] = [s, t].map(|c| c - SIDE / 2.0);
                let variance = 0.02_f64.powi(2);
                let z = 0.01 * (-(x * x + y * y) / (2.0 * variance)).exp();
                let normal = Vector3::new(x * z / variance, y * z / variance, 1.0).normalize();
                (Vector3::new(s, t, z), normal)
            }
        }
    }
}

/// A layer on a grid, and the artist's coarser grid below it.
pub(crate) struct Patch {
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) driver_positions: Vec<Vector3<f64>>,
    pub(crate) driver_normals: Vec<Vector3<f64>>,
    pub(crate) offset: f64,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) uvs: Vec<[Vector2<f64>; 3]>,
    pub(crate) artist: Vec<(u32, [[f64; 3]; 3])>,
    pub(crate) frames: Vec<[TangentFrame; 3]>,
    artist_cells: usize,
}

impl Patch {
    /// `cells`² quads over an artist's mesh of `artist_cells`², `cells` a multiple of it. The layer
    /// stands `offset + height(s, t)` above the driver.
    pub(crate) fn new(
        driver: Driver,
        [cells, artist_cells]: [usize; 2],
        offset: f64,
        height: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let (driver_positions, driver_normals): (Vec<_>, Vec<_>) =
            grid_parameters(cells).map(|[s, t]| driver.at(s, t)).unzip();
        let positions = grid_parameters(cells)
            .zip(driver_positions.iter().zip(&driver_normals))
            .map(|([s, t], (p, n))| p + n * (offset + height(s, t)))
            .collect();
        let faces = grid_faces(cells);
        let corners: Vec<Vector2<f64>> = grid_parameters(cells).map(uv).collect();
        Self {
            positions,
            driver_positions,
            driver_normals,
            offset,
            uvs: faces
                .iter()
                .map(|f| f.map(|v| corners[v as usize]))
                .collect(),
            artist: artist_points(cells, artist_cells),
            frames: artist_frames(driver, artist_cells),
            faces,
            artist_cells,
        }
    }

    /// An unwrinkled layer that slid over the driver by `slide(s, t)` (m, in the parameters).
    pub(crate) fn slid(
        driver: Driver,
        cells: [usize; 2],
        offset: f64,
        slide: impl Fn(f64, f64) -> [f64; 2],
    ) -> Self {
        let mut patch = Self::new(driver, cells, offset, |_, _| 0.0);
        for (position, [s, t]) in patch.positions.iter_mut().zip(grid_parameters(cells[0])) {
            let [ds, dt] = slide(s, t);
            let (p, n) = driver.at(s + ds, t + dt);
            *position = p + n * offset;
        }
        patch
    }

    /// Everything moved rigidly, the artist's frames too.
    pub(crate) fn moved(mut self, motion: &Isometry3<f64>) -> Self {
        for p in self.positions.iter_mut().chain(&mut self.driver_positions) {
            *p = motion.rotation * *p + motion.translation.vector;
        }
        for n in &mut self.driver_normals {
            *n = motion.rotation * *n;
        }
        for frame in self.frames.iter_mut().flatten() {
            frame.normal = motion.rotation * frame.normal;
            frame.tangent = motion.rotation * frame.tangent;
        }
        self
    }

    /// The same on an irregular mesh: inner vertices are moved by up to `amount` cells along both
    /// parameters. Only for a flat driver, whose artist's frames are the same everywhere.
    pub(crate) fn scattered(cells: usize, amount: f64, height: impl Fn(f64, f64) -> f64) -> Self {
        let mut patch = Self::new(Driver::Flat, [cells, 1], 0.0, |_, _| 0.0);
        let step = amount * SIDE / cells as f64;
        let inner = |c: f64| c > 0.5 * SIDE / cells as f64 && c < SIDE - 0.5 * SIDE / cells as f64;
        let parameters: Vec<[f64; 2]> = grid_parameters(cells)
            .enumerate()
            .map(|(vertex, [s, t])| {
                if inner(s) && inner(t) {
                    [
                        s + step * scatter(2 * vertex),
                        t + step * scatter(2 * vertex + 1),
                    ]
                } else {
                    [s, t]
                }
            })
            .collect();
        for (vertex, &[s, t]) in parameters.iter().enumerate() {
            patch.driver_positions[vertex] = Vector3::new(s, t, 0.0);
            patch.positions[vertex] = Vector3::new(s, t, height(s, t));
        }
        for (uvs, face) in patch.uvs.iter_mut().zip(&patch.faces) {
            *uvs = face.map(|v| uv(parameters[v as usize]));
        }
        patch
    }

    pub(crate) fn relief(&self) -> Relief<'_> {
        Relief {
            positions: &self.positions,
            driver_positions: &self.driver_positions,
            driver_normals: &self.driver_normals,
            offset: self.offset,
            faces: &self.faces,
            uvs: &self.uvs,
            artist: &self.artist,
        }
    }

    /// The artist's unnormalised tangent and the sign at a place, as a client interpolates them.
    pub(crate) fn tangent_at(&self, s: f64, t: f64) -> (Vector3<f64>, f64) {
        let (triangle, weights) = self.artist_point(s, t);
        let frames = &self.frames[triangle];
        (blend(frames.map(|f| f.tangent), weights), frames[0].sign)
    }

    /// The artist's unnormalised normal at a place.
    pub(crate) fn normal_at(&self, s: f64, t: f64) -> Vector3<f64> {
        let (triangle, weights) = self.artist_point(s, t);
        blend(self.frames[triangle].map(|f| f.normal), weights)
    }

    fn artist_point(&self, s: f64, t: f64) -> (usize, [f64; 3]) {
        let cells = self.artist_cells as f64;
        let [x, y] = [s, t].map(|c| c / SIDE * cells);
        let [column, row] = [x, y].map(|c| c.floor().min(cells - 1.0));
        let [x, y] = [x - column, y - row];
        let quad = (row * cells + column) as usize;
        // The corners are (0, 0), (1, 0), (1, 1) below the diagonal and (0, 0), (1, 1), (0, 1)
        // above it.
        if y <= x {
            (2 * quad, [1.0 - x, x - y, y])
        } else {
            (2 * quad + 1, [1.0 - y, x, y - x])
        }
    }
}

fn blend(values: [Vector3<f64>; 3], weights: [f64; 3]) -> Vector3<f64> {
    values.iter().zip(weights).map(|(v, w)| v * w).sum()
}

fn grid_parameters(cells: usize) -> impl Iterator<Item = [f64; 2]> {
    let step = SIDE / cells as f64;
    (0..=cells)
        .flat_map(move |row| (0..=cells).map(move |column| [column, row].map(|i| i as f64 * step)))
}

/// A repeatable number in -1..1.
pub(crate) fn scatter(index: usize) -> f64 {
    let mixed = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

pub(crate) fn uv([s, t]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(s / SIDE, 1.0 - t / SIDE)
}

pub(crate) fn grid_faces(cells: usize) -> Vec<[u32; 3]> {
    let vertex = |column: usize, row: usize| (row * (cells + 1) + column) as u32;
    (0..cells * cells)
        .flat_map(|quad| {
            let [x, y] = [quad % cells, quad / cells];
            let [a, b, c, d] = [
                vertex(x, y),
                vertex(x + 1, y),
                vertex(x + 1, y + 1),
                vertex(x, y + 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn artist_frames(driver: Driver, cells: usize) -> Vec<[TangentFrame; 3]> {
    let (positions, normals): (Vec<_>, Vec<_>) =
        grid_parameters(cells).map(|[s, t]| driver.at(s, t)).unzip();
    let uvs: Vec<_> = grid_parameters(cells).map(uv).collect();
    tangent_frames(&positions, &normals, &uvs, &grid_faces(cells)).expect("a valid artist mesh")
}

/// The artist's triangle of every layer face, with the corners' barycentrics.
fn artist_points(cells: usize, artist_cells: usize) -> Vec<(u32, [[f64; 3]; 3])> {
    let ratio = cells / artist_cells;
    assert_eq!(
        ratio * artist_cells,
        cells,
        "the layer refines the artist's grid"
    );
    grid_faces(cells)
        .into_iter()
        .map(|face| {
            let grid = face.map(|v| [v as usize % (cells + 1), v as usize / (cells + 1)]);
            let column = grid.map(|g| g[0]).into_iter().min().expect("three corners") / ratio;
            let row = grid.map(|g| g[1]).into_iter().min().expect("three corners") / ratio;
            let local = grid.map(|[x, y]| {
                [x - column * ratio, y - row * ratio].map(|i| i as f64 / ratio as f64)
            });
            let quad = 2 * (row * artist_cells + column) as u32;
            if local.iter().all(|[x, y]| y <= x) {
                (quad, local.map(|[x, y]| [1.0 - x, x - y, y]))
            } else {
                (quad + 1, local.map(|[x, y]| [1.0 - y, x, y - x]))
            }
        })
        .collect()
}

/// Two plane waves: 0.6 mm at 10 mm along s, 0.15 mm at 4.5 mm turned by 30 degrees.
pub(crate) fn waves(s: f64, t: f64) -> f64 {
    WAVES
        .iter()
        .map(|[amplitude, x, y]| amplitude * (x * s + y * t).sin())
        .sum()
}

/// Amplitude (m) and wave vector (1/m).
const WAVES: [[f64; 3]; 2] = {
    const COARSE: f64 = std::f64::consts::TAU / 10e-3;
    const FINE: f64 = std::f64::consts::TAU / 4.5e-3;
    const COS_30: f64 = 0.866_025_403_784_438_6;
    [[0.6e-3, COARSE, 0.0], [0.15e-3, FINE * COS_30, FINE * 0.5]]
};

/// Parameters of a texel's centre.
pub(crate) fn texel_parameters(map: &WrinkleMap, texel: usize) -> [f64; 2] {
    let size = map.size as usize;
    let [column, row] = [texel % size, texel / size].map(|i| (i as f64 + 0.5) / size as f64);
    [column * SIDE, (1.0 - row) * SIDE]
}

pub(crate) fn baked(map: &WrinkleMap, texel: usize) -> Vector3<f64> {
    Vector3::from(map.normals[texel].map(f64::from))
}

/// Angle between unit vectors, degrees; exact for small ones.
pub(crate) fn degrees(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    (2.0 * ((a - b).norm() / 2.0).min(1.0).asin()).to_degrees()
}

/// The largest angle of the map from neutral, degrees.
pub(crate) fn largest_tilt(map: &WrinkleMap) -> f64 {
    (0..map.normals.len())
        .map(|texel| degrees(&baked(map, texel), &Vector3::z()))
        .fold(0.0, f64::max)
}

pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v * v, count + 1));
    (sum / f64::from(count)).sqrt()
}
