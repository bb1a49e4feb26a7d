//! The simulator's shell on a flat base that repeats: the same patch as a [`Plate`](super::Plate),
//! by the public parts of the simulator.

use ruga_constraint::{Kernel, Sampling, constraint_rows};
use ruga_material::{LayerMaterial, Wrinkling};
use ruga_mesh::{MaterialPoint, TriMesh, VertexId, vertex_normals};
use ruga_solver::{Kkt, NewtonSettings, Objective, SolveReport, minimise};

use super::fourier::Grid;
use super::height_field::HeightField;
use super::periodic_mesh::PeriodicMesh;
use super::periodic_shell::PeriodicShell;
use crate::sheet::{Row, to_constraint_rows};

/// Low-pass rows that hold a patch beside its springs, 1.5 wavelengths apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchRows {
    /// None: the elastic coupling.
    None,
    /// On the heights alone.
    Heights,
    /// On all three coordinates: the hybrid coupling.
    All,
}

impl PatchRows {
    fn axes(self) -> &'static [usize] {
        match self {
            Self::None => &[],
            Self::Heights => &[2],
            Self::All => &[0, 1, 2],
        }
    }
}

/// A periodic patch of film on a flat base.
pub struct ShellPatch {
    shell: PeriodicShell,
    kkt: Kkt,
    /// Coordinates of the rectangle's vertices, m.
    x: Vec<f64>,
}

impl ShellPatch {
    /// Lays a film flat and unstrained, with `size` edges along x and (an even number of) rows of
    /// triangles along y, of edges `edge` m long. The springs are those of `film`.
    ///
    /// # Panics
    /// For an odd number of rows of triangles, or an invalid material.
    pub fn new(
        material: &LayerMaterial,
        film: Wrinkling,
        rows: PatchRows,
        size: [usize; 2],
        edge: f64,
    ) -> Self {
        let mesh = PeriodicMesh::new(size[0], size[1], edge, 1);
        let rows = averages(&mesh, &film, rows.axes());
        let shell = PeriodicShell::new(mesh, material, film);
        let rows = to_constraint_rows(&rows, shell.damping().len());
        Self {
            kkt: Kkt::new(shell.pattern(), &rows, 3).expect("a valid system"),
            x: shell.base(),
            shell,
        }
    }

    /// Number of averages that hold the film, one per coordinate.
    pub fn average_count(&self) -> usize {
        self.kkt.rows().count()
    }

    /// Raises the vertices by heights (m), row after row.
    pub fn raise(&mut self, heights: &[f64]) {
        for (x, height) in self.x.chunks_exact_mut(3).zip(heights) {
            x[2] += height;
        }
    }

    /// Moves the film by slides along x and y and heights (m), fields on the grid of
    /// [`heights`](Self::heights).
    pub fn displace(&mut self, fields: &[Vec<f64>; 3]) {
        let grid = self.heights().grid;
        for (axis, field) in fields.iter().enumerate() {
            let mut values = field.clone();
            // Odd rows of vertices stand half an edge further than the grid.
            grid.shift_rows(&mut values, |row| -0.5 * (row % 2) as f64);
            for (x, value) in self.x.chunks_exact_mut(3).zip(&values) {
                x[axis] += value;
            }
        }
    }

    /// Solves under mean compressive strains along x and y, from the present shape carried along
    /// with the base.
    pub fn solve(&mut self, strain: [f64; 2], settings: &NewtonSettings) -> SolveReport {
        let old = self.shell.base();
        self.shell.set_strain(strain);
        let new = self.shell.base();
        for (x, (old, new)) in self.x.iter_mut().zip(old.iter().zip(&new)) {
            *x += new - old;
        }
        let rows = self.kkt.rows();
        let mut targets = vec![0.0; rows.count()];
        rows.mul(&new, &mut targets).expect("sizes match");
        let (x, kkt) = (&mut self.x, &mut self.kkt);
        minimise(&self.shell, &targets, x, kkt, settings, &mut |_| true).expect("valid input")
    }

    /// Energy per rest area less that of the flat film, J/m^2.
    pub fn energy_gap(&self) -> f64 {
        let flat = self.shell.value(&self.shell.base());
        (self.shell.value(&self.x) - flat) / self.shell.area()
    }

    /// Heights on a grid with a point per vertex, in rest coordinates.
    pub fn heights(&self) -> HeightField {
        let mesh = &self.shell.mesh;
        let grid = Grid::new([mesh.columns, mesh.rows], mesh.extent());
        let mut heights: Vec<f64> = self.x.chunks_exact(3).map(|x| x[2]).collect();
        grid.shift_rows(&mut heights, |row| 0.5 * (row % 2) as f64);
        HeightField { grid, heights }
    }
}

/// Rows of averages of some coordinates around the points of a hexagonal lattice, 1.5 wavelengths
/// apart.
fn averages(mesh: &PeriodicMesh, film: &Wrinkling, axes: &[usize]) -> Vec<Row> {
    let spacing = 1.5 * film.wavelength;
    let kernel = Kernel::beside_foundation(spacing);
    // The supports of centres at the border reach beyond it.
    let margin = (kernel.radius() / (mesh.edge * 0.75_f64.sqrt())).ceil() as usize + 2;
    let wide = PeriodicMesh::new(mesh.columns, mesh.rows, mesh.edge, margin);
    let surface = TriMesh::new(wide.points.len(), wide.faces.clone()).expect("a valid mesh");
    let originals = wide.originals();
    let place = |vertex: usize| {
        let vertex = VertexId(originals[vertex] as u32);
        MaterialPoint::of_vertex(&surface, vertex).expect("a vertex with triangles")
    };
    let centres: Vec<_> = lattice(mesh, spacing).into_iter().map(place).collect();
    let kernels = vec![kernel; centres.len()];
    let normals = vertex_normals(&surface, &wide.points);
    let sampling = Sampling::Quadrature;
    let set = constraint_rows(
        &surface,
        &wide.points,
        &normals,
        &centres,
        &kernels,
        sampling,
    )
    .expect("valid rows");
    let mut rows = Vec::new();
    for row in &set.rows {
        let mut weights = vec![0.0; mesh.count()];
        for (vertex, weight) in &row.weights {
            weights[wide.origins[vertex.0 as usize].0] += weight;
        }
        for axis in axes {
            let entries = weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
            rows.push(entries.map(|(vertex, w)| (3 * vertex + axis, *w)).collect());
        }
    }
    rows
}

/// Vertices near the points of a hexagonal lattice that fits the periods.
fn lattice(mesh: &PeriodicMesh, spacing: f64) -> Vec<usize> {
    let [length, width] = mesh.extent();
    let across = (length / spacing).round().max(1.0);
    let pairs = (width / (2.0 * spacing * 0.75_f64.sqrt())).round().max(1.0);
    let mut vertices = Vec::new();
    for line in 0..2 * pairs as usize {
        for point in 0..across as usize {
            let x = (point as f64 + 0.5 * (line % 2) as f64) / across;
            let y = line as f64 / (2.0 * pairs);
            let column = (x * mesh.columns as f64).round() as usize % mesh.columns;
            let row = (y * mesh.rows as f64).round() as usize % mesh.rows;
            vertices.push(row * mesh.columns + column);
        }
    }
    vertices
}
