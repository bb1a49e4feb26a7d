//! Meshes that the tests share.
#![allow(dead_code, reason = "every test file uses some of these")]

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_constraint::{ConstraintRow, ConstraintSet, Kernel, Sampling, constraint_rows};
use ruga_mesh::{Id, MaterialPoint, SurfaceLookup, TriMesh, VertexId, vertex_normals};

/// A mesh with positions and unit normals.
#[derive(Clone)]
pub(crate) struct Patch {
    pub(crate) mesh: TriMesh,
    pub(crate) positions: Vec<Vector3<f64>>,
    pub(crate) normals: Vec<Vector3<f64>>,
}

impl Patch {
    pub(crate) fn new(positions: Vec<Vector3<f64>>, faces: Vec<[u32; 3]>) -> Self {
        let mesh = TriMesh::new(positions.len(), faces).expect("the test's mesh is valid");
        let normals = vertex_normals(&mesh, &positions);
        Self {
            mesh,
            positions,
            normals,
        }
    }

    /// The same faces elsewhere.
    pub(crate) fn mapped(&self, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        let positions = self.positions.iter().map(|&p| map(p)).collect();
        Self::new(positions, self.face_list())
    }

    /// Reflected in the plane x = 0, the winding turned so that normals stay outside.
    pub(crate) fn mirrored(&self) -> Self {
        let positions = self.positions.iter().map(|p| Vector3::new(-p.x, p.y, p.z));
        let faces = self.face_list().into_iter().map(|[a, b, c]| [a, c, b]);
        Self::new(positions.collect(), faces.collect())
    }

    pub(crate) fn face_list(&self) -> Vec<[u32; 3]> {
        let faces = self.mesh.faces().as_slice().iter();
        faces.map(|f| f.map(|v| v.0)).collect()
    }

    pub(crate) fn vertex_near(&self, place: Vector3<f64>) -> VertexId {
        let distance = |i: &u32| (self.positions[*i as usize] - place).norm();
        let ids = 0..self.positions.len() as u32;
        VertexId(
            ids.min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .expect("a vertex"),
        )
    }

    /// Rows around vertices.
    pub(crate) fn rows(
        &self,
        centres: &[VertexId],
        kernel: Kernel,
        sampling: Sampling,
    ) -> ConstraintSet {
        let place = |&v: &VertexId| MaterialPoint::of_vertex(&self.mesh, v).expect("it has faces");
        let centres: Vec<_> = centres.iter().map(place).collect();
        self.rows_at(&centres, kernel, sampling)
    }

    /// Rows around any places.
    pub(crate) fn rows_at(
        &self,
        centres: &[MaterialPoint],
        kernel: Kernel,
        sampling: Sampling,
    ) -> ConstraintSet {
        let kernels = vec![kernel; centres.len()];
        constraint_rows(
            &self.mesh,
            &self.positions,
            &self.normals,
            centres,
            &kernels,
            sampling,
        )
        .expect("valid input")
    }

    /// The places of the facets that are closest to `targets`.
    pub(crate) fn places_near(&self, targets: &[Vector3<f64>]) -> Vec<MaterialPoint> {
        let lookup = SurfaceLookup::new(&self.mesh, &self.positions);
        let place = |p: &Vector3<f64>| lookup.closest(p).expect("a surface").point;
        targets.iter().map(place).collect()
    }

    /// What a row makes of a field over space.
    pub(crate) fn average(&self, row: &ConstraintRow, field: impl Fn(&Vector3<f64>) -> f64) -> f64 {
        row.average(|v| field(&self.positions[v.index()]))
    }
}

/// The square [-1, 1]² of `cells`² quads with random diagonals. Vertices are moved at random by up
/// to a fifth of a cell, border vertices along the border; corners stay, and so do vertices that a
/// regular grid has at the points of `fixed`.
pub(crate) fn irregular_square(cells: usize, seed: u64, fixed: &[[f64; 2]]) -> Patch {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let step = 2.0 / cells as f64;
    let mut positions = Vec::new();
    for row in 0..=cells {
        for column in 0..=cells {
            let place = [column, row].map(|i| i as f64 * step - 1.0);
            let is_fixed = fixed
                .iter()
                .any(|f| (f[0] - place[0]).hypot(f[1] - place[1]) < 0.01 * step);
            let moved = [0, 1].map(|axis| {
                let shift = rng.random_range(-0.2..0.2) * step;
                let is_border = place[axis].abs() > 1.0 - 0.5 * step;
                place[axis] + if is_border || is_fixed { 0.0 } else { shift }
            });
            positions.push(Vector3::new(moved[0], moved[1], 0.0));
        }
    }
    let mut faces = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let a = (row * (cells + 1) + column) as u32;
            let [b, c, d] = [a + 1, a + cells as u32 + 2, a + cells as u32 + 1];
            if rng.random_bool(0.5) {
                faces.extend([[a, b, c], [a, c, d]]);
            } else {
                faces.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    Patch::new(positions, faces)
}

/// A wavy surface over an irregular square; nowhere flat, lengths up to 15 % longer.
pub(crate) fn irregular_hills(cells: usize, seed: u64) -> Patch {
    irregular_square(cells, seed, &[])
        .mapped(|p| Vector3::new(p.x, p.y, 0.2 * (1.7 * p.x + 0.3).sin() * (1.3 * p.y).cos()))
}

/// A rectangle of equilateral triangles with the given edge, about `width` by `height`.
pub(crate) fn equilateral_rectangle(width: f64, height: f64, edge: f64) -> Patch {
    let columns = (width / edge).round() as usize;
    let rows = (height / (edge * 0.75_f64.sqrt())).round() as usize;
    let mut positions = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let x = column as f64 + if row % 2 == 1 { 0.5 } else { 0.0 };
            let y = row as f64 * 0.75_f64.sqrt();
            positions.push(Vector3::new(x, y, 0.0) * edge);
        }
    }
    let mut faces = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let a = (row * (columns + 1) + column) as u32;
            let [b, c, d] = [a + 1, a + columns as u32 + 2, a + columns as u32 + 1];
            if row % 2 == 0 {
                faces.extend([[a, b, d], [b, c, d]]);
            } else {
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Patch::new(positions, faces)
}
