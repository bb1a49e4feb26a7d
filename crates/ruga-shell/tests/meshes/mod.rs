//! Deterministic test meshes.
#![allow(dead_code, reason = "each test file uses its own part")]

use nalgebra::{Matrix3, Rotation3, Unit, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::TriMesh;
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};

pub(crate) struct Mesh {
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Mesh {
    pub(crate) fn topology(&self) -> TriMesh {
        TriMesh::new(self.positions.len(), self.faces.clone()).expect("a valid mesh")
    }

    /// A layer of one material on the mesh, nothing pinned.
    pub(crate) fn layer(&self, face: FaceParameters, model: BendingModel) -> LayerEnergy {
        let count = self.positions.len();
        let parameters = LayerParameters::uniform(face, self.faces.len(), 0.0, count);
        let pinned = vec![false; count];
        LayerEnergy::with_bending(
            &self.topology(),
            &self.positions,
            parameters,
            &pinned,
            model,
        )
        .expect("a valid lattice")
    }
}

pub(crate) fn rng(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

pub(crate) fn symmetric(rng: &mut Pcg64) -> f64 {
    rng.random_range(-1.0..1.0)
}

pub(crate) fn random_vector(rng: &mut Pcg64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| symmetric(rng))
}

pub(crate) fn random_rotation(rng: &mut Pcg64) -> Matrix3<f64> {
    let axis = Unit::new_normalize(random_vector(rng));
    Rotation3::from_axis_angle(&axis, 3.0 * symmetric(rng)).into_inner()
}

/// Equilateral lattice of `columns` x `rows` vertices with edge `a`, rows along x.
pub(crate) fn lattice(columns: usize, rows: usize, a: f64) -> Mesh {
    let mut positions = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let x = i as f64 + 0.5 * (j % 2) as f64;
            positions.push(Vector3::new(x * a, j as f64 * a * 0.75_f64.sqrt(), 0.0));
        }
    }
    let at = |i: usize, j: usize| (j * columns + i) as u32;
    let mut faces = Vec::new();
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            if j % 2 == 0 {
                faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            } else {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    Mesh { positions, faces }
}

/// The lattice with its inner vertices moved by up to `amount` edges in the plane.
pub(crate) fn jittered(columns: usize, rows: usize, a: f64, amount: f64, seed: u64) -> Mesh {
    let mut mesh = lattice(columns, rows, a);
    let mut rng = rng(seed);
    for (v, x) in mesh.positions.iter_mut().enumerate() {
        let (i, j) = (v % columns, v / columns);
        if i > 0 && j > 0 && i + 1 < columns && j + 1 < rows {
            let shift = Vector3::new(symmetric(&mut rng), symmetric(&mut rng), 0.0);
            *x += shift * (amount * a);
        }
    }
    mesh
}

/// Vertices on the outline of a lattice.
pub(crate) fn outline(columns: usize, rows: usize) -> Vec<bool> {
    (0..columns * rows)
        .map(|v| {
            let (i, j) = (v % columns, v / columns);
            i == 0 || j == 0 || i + 1 == columns || j + 1 == rows
        })
        .collect()
}

/// A doubly periodic plane mesh: corners are unwrapped per face.
pub(crate) struct PeriodicMesh {
    pub(crate) cell: Vector2<f64>,
    pub(crate) points: Vec<Vector2<f64>>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) corners: Vec<[Vector3<f64>; 3]>,
}

impl PeriodicMesh {
    pub(crate) fn topology(&self) -> TriMesh {
        TriMesh::new(self.points.len(), self.faces.clone()).expect("a valid mesh")
    }

    /// Equilateral, `columns` x `rows` (even) vertices of edge `a`.
    pub(crate) fn lattice(columns: usize, rows: usize, a: f64) -> Self {
        let height = a * 0.75_f64.sqrt();
        let points: Vec<_> = (0..rows * columns)
            .map(|v| {
                let (i, j) = (v % columns, v / columns);
                Vector2::new((i as f64 + 0.5 * (j % 2) as f64) * a, j as f64 * height)
            })
            .collect();
        let at = |i: usize, j: usize| ((j % rows) * columns + i % columns) as u32;
        let mut faces = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                if j % 2 == 0 {
                    faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                } else {
                    faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                    faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        let cell = Vector2::new(columns as f64 * a, rows as f64 * height);
        Self::with_faces(cell, points, faces)
    }

    /// The same faces with every vertex moved by up to `amount` in x and y.
    pub(crate) fn moved(&self, amount: f64, seed: u64) -> Self {
        let mut rng = rng(seed);
        let points = self
            .points
            .iter()
            .map(|p| p + Vector2::new(symmetric(&mut rng), symmetric(&mut rng)) * amount)
            .collect();
        Self::with_faces(self.cell, points, self.faces.clone())
    }

    /// The same faces with everything `factor` times as long along x.
    pub(crate) fn stretched(&self, factor: f64) -> Self {
        let stretch = |p: &Vector2<f64>| Vector2::new(p.x * factor, p.y);
        let points = self.points.iter().map(stretch).collect();
        let mut corners = self.corners.clone();
        corners.iter_mut().flatten().for_each(|p| p.x *= factor);
        Self {
            cell: stretch(&self.cell),
            points,
            faces: self.faces.clone(),
            corners,
        }
    }

    pub(crate) fn with_faces(
        cell: Vector2<f64>,
        points: Vec<Vector2<f64>>,
        faces: Vec<[u32; 3]>,
    ) -> Self {
        let nearest =
            |p: Vector2<f64>| Vector2::from_fn(|k, _| p[k] - cell[k] * (p[k] / cell[k]).round());
        let corners = faces
            .iter()
            .map(|face| {
                let origin = points[face[0] as usize];
                face.map(|v| {
                    let p = origin + nearest(points[v as usize] - origin);
                    Vector3::new(p.x, p.y, 0.0)
                })
            })
            .collect();
        Self {
            cell,
            points,
            faces,
            corners,
        }
    }

    /// Delaunay triangulation on the torus: of the cell and a margin of copies around it.
    pub(crate) fn delaunay(cell: Vector2<f64>, mut points: Vec<Vector2<f64>>, margin: f64) -> Self {
        for p in &mut points {
            *p = Vector2::from_fn(|k, _| p[k].rem_euclid(cell[k]));
        }
        let (mut copies, mut source) = (Vec::new(), Vec::new());
        for shift_x in -1..=1 {
            for shift_y in -1..=1 {
                let shift = Vector2::new(shift_x as f64 * cell.x, shift_y as f64 * cell.y);
                for (v, p) in points.iter().enumerate() {
                    let q = p + shift;
                    if (0..2).all(|k| q[k] > -margin && q[k] < cell[k] + margin) {
                        copies.push(delaunator::Point { x: q.x, y: q.y });
                        source.push(v as u32);
                    }
                }
            }
        }
        let triangles = delaunator::triangulate(&copies).triangles;
        let mut faces = Vec::new();
        for t in triangles.chunks_exact(3) {
            // Of the copies of a face, the one whose centroid lies in the cell. Delaunator winds
            // clockwise in a y-up plane.
            let centre = t.iter().fold(Vector2::zeros(), |sum, &k| {
                sum + Vector2::new(copies[k].x, copies[k].y) / 3.0
            });
            if (0..2).all(|k| centre[k] >= 0.0 && centre[k] < cell[k]) {
                faces.push([source[t[0]], source[t[2]], source[t[1]]]);
            }
        }
        let mesh = Self::with_faces(cell, points, faces);
        assert_eq!(
            mesh.faces.len(),
            2 * mesh.points.len(),
            "a torus has two faces per vertex"
        );
        mesh
    }

    /// Moves every vertex to the mean of its neighbours and triangulates anew, `count` times.
    pub(crate) fn smoothed(self, count: usize, margin: f64) -> Self {
        let mut mesh = self;
        for _ in 0..count {
            let mut sum = vec![Vector2::zeros(); mesh.points.len()];
            let mut neighbours = vec![0.0; mesh.points.len()];
            for (face, corners) in mesh.faces.iter().zip(&mesh.corners) {
                for k in 0..3 {
                    let step = corners[(k + 1) % 3] - corners[k];
                    sum[face[k] as usize] += step.xy();
                    neighbours[face[k] as usize] += 1.0;
                }
            }
            let points = mesh
                .points
                .iter()
                .enumerate()
                .map(|(v, p)| p + sum[v] / neighbours[v])
                .collect();
            mesh = Self::delaunay(mesh.cell, points, margin);
        }
        mesh
    }
}

/// `count` points of a periodic cell, each the best of several candidates: blue noise.
pub(crate) fn blue_noise(cell: Vector2<f64>, count: usize, seed: u64) -> Vec<Vector2<f64>> {
    let mut rng = rng(seed);
    let spacing = (cell.x * cell.y / count as f64).sqrt();
    let bins = Vector2::from_fn(|k, _| (cell[k] / spacing).floor().max(3.0) as usize);
    let bin_of = |p: &Vector2<f64>| {
        [0, 1].map(|k| ((p[k] / cell[k] * bins[k] as f64) as usize).min(bins[k] - 1))
    };
    let mut grid = vec![Vec::<Vector2<f64>>::new(); bins.x * bins.y];
    let mut points = Vec::new();
    // Dart throwing with a radius that shrinks until every dart has found a place.
    let mut radius = 0.95 * spacing;
    let mut misses = 0;
    while points.len() < count {
        let p = Vector2::from_fn(|k, _| rng.random_range(0.0..1.0) * cell[k]);
        let [bx, by] = bin_of(&p);
        let clear = (0..9).all(|n| {
            let x = (bx + bins.x + n % 3 - 1) % bins.x;
            let y = (by + bins.y + n / 3 - 1) % bins.y;
            grid[y * bins.x + x].iter().all(|q| {
                let d = p - q;
                Vector2::from_fn(|k, _| d[k] - cell[k] * (d[k] / cell[k]).round()).norm() > radius
            })
        });
        if clear {
            grid[by * bins.x + bx].push(p);
            points.push(p);
            misses = 0;
        } else {
            misses += 1;
            if misses > 300 {
                radius *= 0.98;
                misses = 0;
            }
        }
    }
    points
}
