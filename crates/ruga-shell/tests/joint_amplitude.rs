//! How high the common wave of two layers grows, against a solution in one dimension.
//!
//! A strip without ends: rows of the lattice repeat across the wave, columns along it. Forces and
//! stiffness of two middle rows, over one wave, are those of the repeating cell.

mod meshes;
mod pairs;

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Vector3};
use pairs::{Pair, soft, thick};
use ruga_shell::LayerEnergy;

/// Vertices along a wave, and to either side of it so that the cell's stencils are whole.
const PERIOD: usize = 24;
const MARGIN: usize = 4;
const COLUMNS: usize = PERIOD + 2 * MARGIN;
/// The cell is the two in the middle.
const ROWS: usize = 8;
/// Two layers, two rows, x and z.
const UNKNOWNS: usize = 2 * 2 * PERIOD * 2;
/// Longer Newton steps than this (m) are cut.
const LONGEST_STEP: f64 = 1e-4;

struct Strip {
    joint: LayerEnergy,
    rest: Vec<Vector3<f64>>,
    displacements: DVector<f64>,
}

/// The first of a vertex's two unknowns.
fn first(vertex: usize) -> usize {
    let (layer, within) = (vertex / (COLUMNS * ROWS), vertex % (COLUMNS * ROWS));
    let (row, column) = (within / COLUMNS, within % COLUMNS);
    // The margin is a part of a period; a whole one is added to stay above zero.
    let place = (column + PERIOD - MARGIN) % PERIOD;
    2 * ((2 * layer + row % 2) * PERIOD + place)
}

fn in_cell(vertex: usize) -> bool {
    let within = vertex % (COLUMNS * ROWS);
    let (row, column) = (within / COLUMNS, within % COLUMNS);
    (row == ROWS / 2 - 1 || row == ROWS / 2) && (MARGIN..MARGIN + PERIOD).contains(&column)
}

/// The unknown of a coordinate; y has none.
fn unknown(dof: usize) -> Option<usize> {
    [Some(0), None, Some(1)][dof % 3].map(|k| first(dof / 3) + k)
}

impl Strip {
    /// Flat but for a wave of 0.1 mm in both layers.
    fn new(pair: &Pair) -> Self {
        let wavelength = pair.stack.1;
        let (joint, rest) = pair.build(COLUMNS, ROWS, wavelength / PERIOD as f64);
        let mut displacements = DVector::zeros(UNKNOWNS);
        for (vertex, x) in rest.iter().enumerate() {
            displacements[first(vertex) + 1] = 1e-4 * (2.0 * PI * x.x / wavelength).cos();
        }
        Self {
            joint,
            rest,
            displacements,
        }
    }

    fn positions(&self, strain: f64) -> Vec<Vector3<f64>> {
        let place = |(vertex, x): (usize, &Vector3<f64>)| {
            let k = first(vertex);
            let [along, up] = [self.displacements[k], self.displacements[k + 1]];
            Vector3::new(x.x * (1.0 - strain) + along, x.y, x.z + up)
        };
        self.rest.iter().enumerate().map(place).collect()
    }

    fn force(&self, positions: &[Vector3<f64>]) -> DVector<f64> {
        let mut gradient = vec![0.0; self.joint.dof_count()];
        self.joint.gradient(positions, &mut gradient);
        let mut force = DVector::zeros(UNKNOWNS);
        for (dof, value) in gradient.into_iter().enumerate() {
            if let Some(k) = unknown(dof).filter(|_| in_cell(dof / 3)) {
                force[k] += value;
            }
        }
        force
    }

    fn reduced(&self, values: &[f64]) -> DMatrix<f64> {
        let (starts, rows) = self.joint.pattern();
        let mut matrix = DMatrix::zeros(UNKNOWNS, UNKNOWNS);
        let mut add = |row: usize, column: usize, value: f64| {
            let pair = unknown(row).zip(unknown(column));
            if let Some(place) = pair.filter(|_| in_cell(row / 3)) {
                matrix[place] += value;
            }
        };
        for column in 0..self.joint.dof_count() {
            for k in starts[column]..starts[column + 1] {
                let row = rows[k] as usize;
                add(row, column, values[k]);
                if row != column {
                    add(column, row, values[k]);
                }
            }
        }
        // The pattern may slide along the strip.
        let hold = 1e-10 * matrix.diagonal().amax();
        matrix + DMatrix::from_diagonal_element(UNKNOWNS, UNKNOWNS, hold)
    }

    /// Newton's method; the relaxed Hessian where the exact one is not positive.
    fn relax(&mut self, strain: f64) {
        const NEGLIGIBLE_FORCE: f64 = 1e-10;
        let size = self.joint.pattern().1.len();
        let (mut exact, mut relaxed) = (vec![0.0; size], vec![0.0; size]);
        for _ in 0..100 {
            let positions = self.positions(strain);
            let force = self.force(&positions);
            if force.amax() < NEGLIGIBLE_FORCE {
                return;
            }
            self.joint
                .hessian(&positions, &mut exact, Some(&mut relaxed));
            let factor = [&exact, &relaxed]
                .into_iter()
                .find_map(|values| self.reduced(values).cholesky())
                .expect("the relaxed Hessian is positive");
            let step = factor.solve(&force);
            self.displacements -= &step * (LONGEST_STEP / step.amax()).min(1.0);
        }
        panic!("no equilibrium at strain {strain}");
    }

    /// First harmonic of the lower layer's height (m).
    fn amplitude(&self) -> f64 {
        let sum = |part: fn(f64) -> f64| -> f64 {
            (0..PERIOD)
                .map(|k| {
                    let phase = 2.0 * PI * k as f64 / PERIOD as f64;
                    self.displacements[2 * k + 1] * part(phase)
                })
                .sum()
        };
        sum(f64::cos).hypot(sum(f64::sin)) * 2.0 / PERIOD as f64
    }
}

/// Strains and first harmonics (mm) of a prototype with large-rotation beams.
///
/// Found: 0.975, 0.977 and 0.997 of them, 0.962 and 0.971 in the soft pair, where onset is later
/// by finite strain; 48 vertices per wave change this by less than 0.6 %.
#[test]
fn common_waves_grow_as_in_one_dimension() {
    let thick_path = [(0.013, 0.127), (0.0175, 0.281), (0.047, 0.674)];
    let soft_path = [(0.084, 1.029), (0.167, 1.723)];
    for (pair, path) in [(thick(), &thick_path[..]), (soft(), &soft_path[..])] {
        let mut strip = Strip::new(&pair);
        for &(strain, expected) in path {
            strip.relax(strain);
            let found = strip.amplitude() * 1e3;
            assert!((found / expected - 1.0).abs() < 0.05, "{strain}: {found}");
        }
    }
}
