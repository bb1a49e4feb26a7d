//! Cost of the KKT factorisation against faer's plain Cholesky of the Hessian alone.
//!
//! A synthetic plate of 97 x 97 vertices with the sparsity of triangles and hinges, with 700
//! constraint triples of 190 vertices (the papers' spacing) and with 36 triples of 1800
//! (low-pass rows).

#![allow(clippy::print_stdout, reason = "a benchmark reports")]
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark is not a library"
)]

use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use faer::Par;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use ruga_solver::{ConstraintRows, Kkt, LowerPattern};

const SIDE: usize = 97;
const UNKNOWNS: usize = 3 * SIDE * SIDE;

fn vertex(column: usize, row: usize) -> usize {
    row * SIDE + column
}

/// Vertices of every hinge: edge tail, edge head, left apex, right apex.
fn hinges() -> Vec<[usize; 4]> {
    let mut hinges = Vec::new();
    for j in 1..SIDE - 1 {
        for i in 1..SIDE - 1 {
            let here = vertex(i, j);
            let (right, up) = (vertex(i + 1, j), vertex(i, j + 1));
            hinges.push([here, right, up, vertex(i + 1, j - 1)]);
            hinges.push([here, up, vertex(i - 1, j + 1), right]);
            hinges.push([right, up, here, vertex(i + 1, j + 1)]);
        }
    }
    hinges
}

struct Plate {
    pattern: LowerPattern,
    values: Vec<f64>,
}

impl Plate {
    /// Springs along edges and second differences across hinges, tilted a little so that no
    /// entry of a block vanishes.
    fn new() -> Self {
        let hinges = hinges();
        let stencils: Vec<Vec<usize>> = hinges
            .iter()
            .map(|hinge| {
                hinge
                    .iter()
                    .flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2])
                    .collect()
            })
            .collect();
        let lists = stencils.iter().map(Vec::as_slice);
        let pattern = LowerPattern::from_stencils(UNKNOWNS, lists).unwrap();
        let mut values = vec![0.0; pattern.entries()];
        for (count, (stencil, hinge)) in stencils.iter().zip(&hinges).enumerate() {
            let tilt = 0.1 * (count as f64).sin();
            let bend: Vec<f64> = [-1.0, -1.0, 1.0, 1.0]
                .iter()
                .flat_map(|weight| [weight * tilt, weight * tilt, weight * 1.0])
                .collect();
            add_square(&pattern, &mut values, stencil, &bend, 0.1);
            let (tail, head) = (hinge[0], hinge[1]);
            let along = (head % SIDE) as f64 - (tail % SIDE) as f64;
            let across = (head / SIDE) as f64 - (tail / SIDE) as f64;
            let stretch = [-along, -across, -tilt, along, across, tilt];
            add_square(&pattern, &mut values, &stencil[..6], &stretch, 1.0);
        }
        for column in 0..UNKNOWNS {
            values[pattern.position(column, column).unwrap()] += 1e-2;
        }
        Self { pattern, values }
    }
}

fn add_square(
    pattern: &LowerPattern,
    values: &mut [f64],
    stencil: &[usize],
    vector: &[f64],
    stiffness: f64,
) {
    for (a, row) in vector.iter().zip(stencil) {
        for (b, column) in vector
            .iter()
            .zip(stencil)
            .filter(|(_, column)| *column <= row)
        {
            values[pattern.position(*row, *column).unwrap()] += stiffness * a * b;
        }
    }
}

/// Three Gaussian rows (x, y, z) per centre of a square lattice, cut at `radius` edges.
fn rows(per_side: usize, radius: f64) -> ConstraintRows {
    let (mut starts, mut columns, mut weights) = (vec![0], Vec::new(), Vec::new());
    let spacing = SIDE as f64 / per_side as f64;
    for centre in 0..per_side * per_side {
        let x = ((centre % per_side) as f64 + 0.5) * spacing;
        let y = ((centre / per_side) as f64 + 0.5) * spacing;
        let square = |v: usize| ((v % SIDE) as f64 - x).powi(2) + ((v / SIDE) as f64 - y).powi(2);
        let support: Vec<usize> = (0..SIDE * SIDE)
            .filter(|&v| square(v) < radius * radius)
            .collect();
        let gauss = |v: usize| (-3.0 * square(v) / (radius * radius)).exp();
        let sum: f64 = support.iter().map(|&v| gauss(v)).sum();
        for coordinate in 0..3 {
            columns.extend(support.iter().map(|v| 3 * v + coordinate));
            weights.extend(support.iter().map(|&v| gauss(v) / sum));
            starts.push(columns.len());
        }
    }
    ConstraintRows::new(starts, columns, weights, UNKNOWNS).unwrap()
}

/// faer's Cholesky of the Hessian alone, its own ordering.
struct PlainCholesky {
    matrix: SparseColMat<usize, f64>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl PlainCholesky {
    fn new(plate: &Plate) -> Self {
        let pattern = SymbolicSparseColMat::new_checked(
            UNKNOWNS,
            UNKNOWNS,
            plate.pattern.column_starts().to_vec(),
            None,
            plate
                .pattern
                .rows()
                .iter()
                .map(|&row| row as usize)
                .collect(),
        );
        let order = SymmetricOrdering::Amd;
        let symbolic =
            factorize_symbolic_cholesky(pattern.as_ref(), Side::Lower, order, Default::default())
                .unwrap();
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        Self {
            matrix: SparseColMat::new(pattern, plate.values.clone()),
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            memory: MemBuffer::new(scratch),
        }
    }

    fn factorize(&mut self) {
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                self.matrix.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .unwrap();
    }
}

/// Shortest of five runs (s).
fn best_of_five(mut run: impl FnMut()) -> f64 {
    (0..5)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

fn compare(criterion: &mut Criterion) {
    let plate = Plate::new();
    let damping = vec![0.0; UNKNOWNS];
    let mut plain = PlainCholesky::new(&plate);
    let reference = best_of_five(|| plain.factorize());
    println!(
        "faer LLT(K), AMD: {} factor entries, {reference:.3} s",
        plain.factor.len()
    );
    criterion.bench_function("faer LLT(K)", |bench| bench.iter(|| plain.factorize()));
    let systems = [
        ("no rows", ConstraintRows::none(UNKNOWNS)),
        ("700 narrow triples", rows(26, 8.0)),
        ("36 wide triples", rows(6, 24.0)),
    ];
    for (name, rows) in systems {
        let start = Instant::now();
        let mut kkt = Kkt::new(&plate.pattern, &rows, 3).unwrap();
        let analysis = start.elapsed().as_secs_f64();
        let factor = best_of_five(|| {
            kkt.factorize(&plate.values, &damping).unwrap();
        });
        let force = vec![1.0; UNKNOWNS];
        let offset = vec![0.0; rows.count()];
        let (mut step, mut multipliers) = (force.clone(), offset.clone());
        let mut residual = 0.0;
        let solve = best_of_five(|| {
            residual = kkt
                .solve(&force, &offset, &mut step, &mut multipliers)
                .unwrap();
        });
        let cost = kkt.cost();
        println!(
            "{name}: {} rows, {} weights; analysis {analysis:.3} s; factor {factor:.3} s, \
             refined solve {solve:.3} s to {residual:.1e}; ratio to LLT(K) {:.2}, with solve \
             {:.2}; {} factor entries, {:.0} MB, {:.2} Gflop",
            rows.count(),
            rows.entries(),
            factor / reference,
            (factor + solve) / reference,
            cost.factor_entries,
            cost.bytes as f64 / 1e6,
            cost.flops / 1e9,
        );
        criterion.bench_function(&format!("KKT, {name}"), |bench| {
            bench.iter(|| kkt.factorize(&plate.values, &damping).unwrap());
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = compare
}
criterion_main!(benches);
