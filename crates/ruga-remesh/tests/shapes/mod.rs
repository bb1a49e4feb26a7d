//! Meshes, analytic surfaces and metrics that the tests and the benchmark share.
#![allow(dead_code, reason = "no test uses every shape")]

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, TriMesh};
use ruga_remesh::{Sizing, Surface, SurfaceMesh, size_tensor};

/// How the unit square is laid into space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    /// The square itself, 1 m.
    Flat,
    /// A quarter of a cylinder of radius 2 / pi, 1 m long, so that the map keeps lengths.
    Cylinder,
    /// A piece of a sphere of radius 1 around the equator.
    Sphere,
}

impl Shape {
    pub(crate) fn point(self, [u, v]: [f64; 2]) -> Vector3<f64> {
        match self {
            Self::Flat => Vector3::new(u, v, 0.0),
            Self::Cylinder => {
                let (s, c) = (u * TAU / 4.0).sin_cos();
                Vector3::new(-c / (TAU / 4.0), v, s / (TAU / 4.0))
            }
            Self::Sphere => {
                let ((s, c), (t, r)) = (u.sin_cos(), (v - 0.5).sin_cos());
                Vector3::new(-c * r, t, s * r)
            }
        }
    }

    pub(crate) fn normal(self, [u, v]: [f64; 2]) -> Vector3<f64> {
        let h = 1e-5;
        let du = self.point([u + h, v]) - self.point([u - h, v]);
        let dv = self.point([u, v + h]) - self.point([u, v - h]);
        du.cross(&dv).normalize()
    }

    pub(crate) fn area(self) -> f64 {
        match self {
            Self::Flat | Self::Cylinder => 1.0,
            Self::Sphere => 2.0 * 0.5f64.sin(),
        }
    }

    pub(crate) fn perimeter(self) -> f64 {
        match self {
            Self::Flat | Self::Cylinder => 4.0,
            Self::Sphere => 2.0 + 2.0 * 0.5f64.cos(),
        }
    }

    fn inverse(self, p: Vector3<f64>) -> [f64; 2] {
        match self {
            Self::Flat => [p.x, p.y],
            Self::Cylinder => [p.z.atan2(-p.x) / (TAU / 4.0), p.y],
            Self::Sphere => [p.z.atan2(-p.x), p.y.atan2(p.x.hypot(p.z)) + 0.5],
        }
    }
}

/// The square's image; material points are addresses on two triangles, (0,0) (1,0) (1,1) and
/// (0,0) (1,1) (0,1).
pub(crate) struct Sheet(pub(crate) Shape);

const CORNERS: [[[f64; 2]; 3]; 2] = [
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
    [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
];

pub(crate) fn square_from_address(at: MaterialPoint) -> [f64; 2] {
    let corners = CORNERS[at.face.0 as usize];
    let sum = |axis: usize| (0..3).map(|i| corners[i][axis] * at.barycentric[i]).sum();
    [sum(0), sum(1)]
}

pub(crate) fn address_from_square([u, v]: [f64; 2]) -> MaterialPoint {
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let (face, barycentric) = if u >= v {
        (FaceId(0), [1.0 - u, u - v, v])
    } else {
        (FaceId(1), [1.0 - v, u, v - u])
    };
    MaterialPoint { face, barycentric }
}

impl Surface for Sheet {
    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        self.0.point(square_from_address(at))
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        self.0.normal(square_from_address(at))
    }

    fn closest(&self, _near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        address_from_square(self.0.inverse(target))
    }

    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        _target: Vector3<f64>,
    ) -> MaterialPoint {
        // Sides of the square are straight lines of the address.
        let [a, b] = between.map(square_from_address);
        address_from_square([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0])
    }
}

/// A grid of `n` by `n` cells, diagonals alternating, inner vertices moved by up to `jitter` cells.
pub(crate) fn grid(shape: Shape, n: usize, jitter: f64, seed: u64) -> SurfaceMesh {
    let mut random = Pcg64::seed_from_u64(seed);
    let row = n as u32 + 1;
    let mut points = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let mut inner = |k: usize| {
                let moved = if k == 0 || k == n {
                    0.0
                } else {
                    random.random_range(-jitter..=jitter)
                };
                (k as f64 + moved) / n as f64
            };
            points.push(address_from_square([inner(i), inner(j)]));
        }
    }
    let mut faces = Vec::new();
    for j in 0..n as u32 {
        for i in 0..n as u32 {
            let v = j * row + i;
            let (a, b, c, d) = (v, v + 1, v + row + 1, v + row);
            if (i + j) % 2 == 0 {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    let mesh = TriMesh::new(points.len(), faces).expect("a grid is a mesh");
    SurfaceMesh::on_surface(mesh, points.into(), &Sheet(shape)).expect("one point per vertex")
}

/// A smooth random metric: edge length and direction follow low waves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waves {
    /// Geometric mean of the shortest and longest wanted edge, m.
    pub(crate) edge: f64,
    /// Largest ratio between wanted edges at two places.
    pub(crate) range: f64,
    /// Ratio between the two directions.
    pub(crate) aspect: f64,
    pub(crate) seed: u64,
}

impl Waves {
    pub(crate) fn tensor(self, [u, v]: [f64; 2], normal: Vector3<f64>) -> Matrix3<f64> {
        let mut random = Pcg64::seed_from_u64(self.seed);
        let mut wave = |waves: f64| {
            let (a, b) = (
                random.random_range(-1.0..1.0),
                random.random_range(-1.0..1.0),
            );
            let phase = random.random_range(0.0..TAU);
            (TAU * waves * (a * u + b * v) + phase).sin()
        };
        let edge = self.edge * self.range.powf(wave(1.5) / 2.0);
        let (s, c) = (TAU / 4.0 * wave(0.8)).sin_cos();
        let (t, b) = (Vector3::y().cross(&normal).normalize(), Vector3::y());
        let half = self.aspect.sqrt();
        size_tensor(normal, t * c + b * s, edge / half, edge * half).expect("a tangent direction")
    }

    pub(crate) fn sizing(self, mesh: &SurfaceMesh) -> Sizing {
        let tensors: PerVertex<Matrix3<f64>> = mesh
            .points
            .as_slice()
            .iter()
            .zip(ruga_mesh::vertex_normals(
                &mesh.mesh,
                mesh.positions.as_slice(),
            ))
            .map(|(&p, normal)| self.tensor(square_from_address(p), normal))
            .collect();
        Sizing { tensors }
    }
}
