//! Deterministic surfaces to draw lines on.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{PerFace, PerVertex, TriMesh, subdivide};

pub(crate) struct Sheet {
    pub(crate) mesh: TriMesh,
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Texture coordinates: x and y themselves, unless charts are moved apart.
    pub(crate) uvs: PerFace<[Vector2<f64>; 3]>,
}

/// A unit square of `n` x `n` squares, each cut in two; inner vertices are moved by up to `jitter` squares.
pub(crate) fn square(n: usize, jitter: f64, seed: u64) -> Sheet {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let is_inner = i > 0 && j > 0 && i < n && j < n;
            let mut shift = || {
                if is_inner {
                    jitter * rng.random_range(-1.0..1.0)
                } else {
                    0.0
                }
            };
            let place = [i as f64 + shift(), j as f64 + shift()].map(|c| c / n as f64);
            positions.push(Vector3::new(place[0], place[1], 0.0));
        }
    }
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let mut faces = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            match rng.random_range(0..2) {
                0 => faces.extend([[a, b, c], [a, c, d]]),
                _ => faces.extend([[a, b, d], [b, c, d]]),
            }
        }
    }
    sheet(positions, faces)
}

fn sheet(positions: Vec<Vector3<f64>>, faces: Vec<[u32; 3]>) -> Sheet {
    let uvs = faces
        .iter()
        .map(|face| face.map(|v| positions[v as usize].xy()));
    Sheet {
        uvs: uvs.collect(),
        mesh: TriMesh::new(positions.len(), faces).expect("a valid sheet"),
        positions,
    }
}

/// A tube of `n` flat sides, one high and one around, unrolled to the unit square with its seam at `u` = 0 and 1.
pub(crate) fn tube(n: usize) -> Sheet {
    let radius = 0.5 / (n as f64 * (PI / n as f64).sin());
    let vertex = |j: usize, i: usize| (j * n + i % n) as u32;
    let positions = (0..=n).flat_map(|j| {
        (0..n).map(move |i| {
            let (sin, cos) = (2.0 * PI * i as f64 / n as f64).sin_cos();
            Vector3::new(radius * cos, radius * sin, j as f64 / n as f64)
        })
    });
    let positions: Vec<_> = positions.collect();
    let uv = |j: usize, i: usize| Vector2::new(i as f64, j as f64) / n as f64;
    let (mut faces, mut uvs) = (Vec::new(), Vec::new());
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let corners = [(j, i), (j, i + 1), (j + 1, i + 1), (j + 1, i)];
        for face in [[0, 1, 2], [0, 2, 3]] {
            let of_face = face.map(|at: usize| corners[at]);
            faces.push(of_face.map(|(j, i)| vertex(j, i)));
            uvs.push(of_face.map(|(j, i)| uv(j, i)));
        }
    }
    Sheet {
        mesh: TriMesh::new(positions.len(), faces).expect("a valid tube"),
        positions,
        uvs: uvs.into(),
    }
}

/// A unit sphere without texture coordinates that mean anything.
pub(crate) fn sphere(levels: u32) -> Sheet {
    let corners = [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ];
    let corners = corners.map(|c| Vector3::from(c.map(f64::from)));
    let faces = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    let mesh = TriMesh::new(6, faces.to_vec()).expect("an octahedron");
    let fine = subdivide(&mesh, levels, &PerVertex::filled(6, false));
    let positions = fine.fine_from_coarse.apply(&corners);
    let positions: Vec<_> = positions.iter().map(|p| p.normalize()).collect();
    let faces = fine.mesh.faces().as_slice().iter();
    let faces = faces.map(|face| face.map(|v| v.0)).collect();
    sheet(positions, faces)
}

/// Moves the charts of all faces to the right of `x` by `by` in texture space: a seam near `x`.
pub(crate) fn torn(mut sheet: Sheet, x: f64, by: Vector2<f64>) -> Sheet {
    let moved = sheet.uvs.as_slice().iter().map(|uvs| {
        let centre = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
        uvs.map(|uv| if centre.x > x { uv + by } else { uv })
    });
    let moved: Vec<_> = moved.collect();
    sheet.uvs = moved.into();
    sheet
}
