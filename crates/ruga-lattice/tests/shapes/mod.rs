//! Closed surfaces to build lattices of.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_lattice::{Lattice, LatticeError, LatticeSpec};
use ruga_mesh::TriMesh;

#[derive(Clone, Default)]
pub(crate) struct Surface {
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Surface {
    pub(crate) fn mesh(&self) -> TriMesh {
        TriMesh::new(self.positions.len(), self.faces.clone()).expect("a valid mesh")
    }

    pub(crate) fn try_lattice(&self, spec: LatticeSpec) -> Result<Lattice, LatticeError> {
        Lattice::build(&self.mesh(), &self.positions, &spec)
    }

    pub(crate) fn lattice(&self, spec: LatticeSpec) -> Lattice {
        self.try_lattice(spec).expect("a closed surface")
    }

    pub(crate) fn and(mut self, other: Self) -> Self {
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        let moved = other.faces.iter().map(|f| f.map(|v| v + offset));
        self.faces.extend(moved);
        self
    }

    pub(crate) fn inside_out(mut self) -> Self {
        self.faces.iter_mut().for_each(|face| face.swap(1, 2));
        self
    }

    pub(crate) fn map(mut self, f: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> Self {
        self.positions.iter_mut().for_each(|p| *p = f(p));
        self
    }

    pub(crate) fn shifted(self, x: f64, y: f64, z: f64) -> Self {
        self.map(|p| p + Vector3::new(x, y, z))
    }

    pub(crate) fn rotated(self, axis: [f64; 3], angle: f64) -> Self {
        let axis = Unit::new_normalize(Vector3::from(axis));
        let turn = Rotation3::from_axis_angle(&axis, angle);
        self.map(|p| turn * p)
    }

    pub(crate) fn volume(&self) -> f64 {
        let corners = self
            .faces
            .iter()
            .map(|f| f.map(|v| self.positions[v as usize]));
        corners.map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }
}

pub(crate) fn spec(cells: u32) -> LatticeSpec {
    LatticeSpec {
        cells,
        ..LatticeSpec::default()
    }
}

pub(crate) fn rng(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

pub(crate) fn random_vector(rng: &mut Pcg64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

/// A box from the origin to `size`, its sides divided `counts` times.
pub(crate) fn block(size: [f64; 3], counts: [usize; 3]) -> Surface {
    let mut surface = Surface::default();
    let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut vertex = |at: [usize; 3], surface: &mut Surface| {
        *numbers.entry(at).or_insert_with(|| {
            let place = |k: usize| size[k] * at[k] as f64 / counts[k] as f64;
            surface.positions.push(Vector3::from_fn(|k, _| place(k)));
            surface.positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for end in [0, counts[axis]] {
            for i in 0..counts[u] {
                for j in 0..counts[v] {
                    let mut corner = |du: usize, dv: usize| {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (end, i + du, j + dv);
                        vertex(at, &mut surface)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    if end > 0 {
                        surface.faces.extend([[a, b, c], [a, c, d]]);
                    } else {
                        surface.faces.extend([[a, c, b], [a, d, c]]);
                    }
                }
            }
        }
    }
    surface
}

/// A torus around z.
pub(crate) fn torus(ring: f64, tube: f64, counts: [u32; 2]) -> Surface {
    let [n, m] = counts;
    let mut surface = Surface::default();
    for i in 0..n {
        for j in 0..m {
            let [a, b] = [(i, n), (j, m)].map(|(k, n)| TAU * f64::from(k) / f64::from(n));
            let r = ring + tube * b.cos();
            let point = Vector3::new(r * a.cos(), r * a.sin(), tube * b.sin());
            surface.positions.push(point);
            let at = |i: u32, j: u32| (i % n) * m + j % m;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            surface.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// A sphere around the origin, of `rows` rows of `columns` faces.
pub(crate) fn sphere(radius: f64, columns: u32, rows: u32) -> Surface {
    let mut surface = Surface::default();
    surface.positions.push(Vector3::z() * radius);
    for i in 1..rows {
        for j in 0..columns {
            let polar = PI * f64::from(i) / f64::from(rows);
            let turn = TAU * f64::from(j) / f64::from(columns);
            let ring = Vector3::new(
                polar.sin() * turn.cos(),
                polar.sin() * turn.sin(),
                polar.cos(),
            );
            surface.positions.push(ring * radius);
        }
    }
    let last = surface.positions.len() as u32;
    surface.positions.push(Vector3::z() * -radius);
    let at = |i: u32, j: u32| 1 + (i - 1) * columns + j % columns;
    for j in 0..columns {
        surface.faces.push([0, at(1, j), at(1, j + 1)]);
        surface
            .faces
            .push([last, at(rows - 1, j + 1), at(rows - 1, j)]);
        for i in 1..rows - 1 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            surface.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// Two slabs one above the other, `gap` apart, within the unit cube's width.
pub(crate) fn two_slabs(gap: f64) -> Surface {
    let slab = block([1.0, 1.0, 0.25], [4, 4, 1]);
    slab.clone().and(slab.shifted(0.0, 0.0, 0.25 + gap))
}
