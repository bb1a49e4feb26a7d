//! Control meshes of Loop surfaces: every kind of vertex that there is.
#![allow(dead_code, reason = "no test uses all of them")]

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{
    LoopSurface, MaterialPoint, PerVertex, SparseRows, SurfaceJet, TriMesh, VertexId, subdivide,
};

pub(crate) type Positions = Vec<Vector3<f64>>;

/// A control mesh with its corners.
#[derive(Clone)]
pub(crate) struct Control {
    pub(crate) mesh: TriMesh,
    pub(crate) corners: PerVertex<bool>,
    pub(crate) positions: Positions,
}

impl Control {
    pub(crate) fn new(faces: Vec<[u32; 3]>, positions: Positions) -> Self {
        let mesh = TriMesh::new(positions.len(), faces).expect("a valid mesh");
        let corners = PerVertex::filled(mesh.vertex_count(), false);
        Self {
            mesh,
            corners,
            positions,
        }
    }

    pub(crate) fn with_corners(mut self, corners: &[u32]) -> Self {
        for &v in corners {
            self.corners[VertexId(v)] = true;
        }
        self
    }

    pub(crate) fn surface(&self) -> LoopSurface {
        LoopSurface::new(&self.mesh, &self.corners)
    }

    pub(crate) fn refined(&self, levels: u32) -> Self {
        let fine = subdivide(&self.mesh, levels, &self.corners);
        Self {
            positions: fine.fine_from_coarse.apply(&self.positions),
            mesh: fine.mesh,
            corners: fine.corners,
        }
    }

    pub(crate) fn jets(&self, points: &[MaterialPoint]) -> Vec<SurfaceJet> {
        self.surface().jets(points, &self.positions)
    }
}

/// A vertex amid `count` faces over an angle, of uneven heights and radii, with a second ring.
pub(crate) fn fan(count: usize, angle: f64) -> Control {
    let mut rng = Pcg64Mcg::seed_from_u64(count as u64);
    let rim = if angle == TAU { count } else { count + 1 };
    let mut positions = vec![Vector3::new(0.0, 0.0, 0.1)];
    for ring in [1.0, 2.0] {
        for i in 0..rim {
            let (sin, cos) = (angle * i as f64 / count as f64).sin_cos();
            let radius = ring * rng.random_range(0.9..1.1);
            let height = 0.3 * rng.random_range(-1.0..1.0);
            positions.push(Vector3::new(radius * cos, radius * sin, height));
        }
    }
    let mut faces = Vec::new();
    for i in 0..count {
        let [a, b] = [1 + i, 1 + (i + 1) % rim].map(|k| k as u32);
        let [c, d] = [a, b].map(|k| k + rim as u32);
        faces.extend([[0, a, b], [a, c, d], [a, d, b]]);
    }
    Control::new(faces, positions)
}

/// A closed mesh: the icosahedron.
pub(crate) fn icosahedron() -> Control {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions = Vec::new();
    for axis in 0..3 {
        for (a, b) in [
            (-1.0, -golden),
            (1.0, -golden),
            (-1.0, golden),
            (1.0, golden),
        ] {
            let mut p = Vector3::zeros();
            p[(axis + 1) % 3] = a;
            p[(axis + 2) % 3] = b;
            positions.push(p);
        }
    }
    let near = |a: usize, b: usize| (positions[a] - positions[b]).norm() < 2.1;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [a, b, c].map(|i| positions[i]);
                    let outwards = (q - p).cross(&(r - p)).dot(&p) > 0.0;
                    let face = if outwards { [a, b, c] } else { [a, c, b] };
                    faces.push(face.map(|i| i as u32));
                }
            }
        }
    }
    Control::new(faces, positions)
}

/// A lattice of `columns` by `rows` cells, placed by its lattice coordinates.
pub(crate) fn lattice(
    columns: u32,
    rows: u32,
    place: impl Fn(f64, f64) -> Vector3<f64>,
) -> Control {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            positions.push(place(f64::from(i), f64::from(j)));
            if i < columns && j < rows {
                let a = j * (columns + 1) + i;
                let b = a + columns + 1;
                faces.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
            }
        }
    }
    Control::new(faces, positions)
}

/// Two tetrahedra that touch in vertex 0, and a bow tie of two triangles in vertex 7.
pub(crate) fn touching() -> Control {
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    let faces = vec![
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 1],
        [1, 3, 2],
        [0, 5, 4],
        [0, 6, 5],
        [0, 4, 6],
        [4, 5, 6],
        [7, 8, 9],
        [7, 10, 11],
    ];
    let positions = (0..12).map(|_| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)));
    Control::new(faces, positions.collect())
}

/// The smallest meshes on which controls of a face coincide: a torus of nine regular vertices and a
/// tetrahedron.
pub(crate) fn tightest() -> [Control; 2] {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let mut place = |_| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
    let vertex = |i: u32, j: u32| (j % 3) * 3 + i % 3;
    let faces = (0..9).flat_map(|k| {
        let (i, j) = (k % 3, k / 3);
        let [a, b] = [vertex(i, j), vertex(i + 1, j)];
        let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let torus = Control::new(faces.collect(), (0..9).map(&mut place).collect());
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    [torus, Control::new(faces, (0..4).map(&mut place).collect())]
}

/// Closed, open, with corners, and touching themselves: every rule that there is.
pub(crate) fn all() -> Vec<Control> {
    let mut all: Vec<Control> = (3..=12).map(|n| fan(n, TAU)).collect();
    all.extend((1..=7).map(|n| fan(n, if n < 3 { PI / 2.0 } else { PI })));
    all.push(fan(5, PI).with_corners(&[0, 2, 7, 12]));
    all.push(fan(7, TAU).with_corners(&[0, 3, 9]));
    all.push(icosahedron());
    all.push(touching());
    all.extend(tightest());
    let bumps =
        |i: f64, j: f64| Vector3::new(i + 0.2 * j, j, 0.4 * (i * 2.1).sin() * (j + i).cos());
    all.push(lattice(4, 3, bumps).with_corners(&[0, 4]));
    all
}

pub(crate) fn sums(rows: &SparseRows) -> Vec<f64> {
    (0..rows.row_count())
        .map(|i| rows.row(i).map(|term| term.1).sum())
        .collect()
}
