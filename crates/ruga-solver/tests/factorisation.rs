//! The KKT factor against dense linear algebra on small systems.

#![allow(clippy::unwrap_used, reason = "a failing unwrap fails the test")]

use ruga_solver::{ConstraintRows, EliminationOrder, Inertia, Kkt, LowerPattern, SolverError};

/// Dense symmetric matrix by rows.
type Dense = Vec<Vec<f64>>;

const BLOCK: usize = 3;

/// Reproducible numbers in [-1, 1].
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, size: usize) -> Vec<f64> {
        (0..size).map(|_| self.next()).collect()
    }
}

/// A chain of 3-vectors, random springs, diagonal `shift`.
fn chain(vertices: usize, shift: f64, noise: &mut Noise) -> (LowerPattern, Vec<f64>) {
    let size = BLOCK * vertices;
    let stencils: Vec<Vec<usize>> = (0..vertices - 1)
        .map(|v| (BLOCK * v..BLOCK * (v + 2)).collect())
        .collect();
    let pattern = LowerPattern::from_stencils(size, stencils.iter().map(Vec::as_slice)).unwrap();
    let mut values = vec![0.0; pattern.entries()];
    for stencil in &stencils {
        for _ in 0..4 {
            let vector = noise.vector(stencil.len());
            for (a, &row) in vector.iter().zip(stencil) {
                for (b, &column) in vector.iter().zip(stencil).filter(|(_, c)| **c <= row) {
                    values[pattern.position(row, column).unwrap()] += a * b;
                }
            }
        }
    }
    for column in 0..size {
        values[pattern.position(column, column).unwrap()] += shift;
    }
    (pattern, values)
}

fn random_rows(unknowns: usize, count: usize, repeat: usize, noise: &mut Noise) -> ConstraintRows {
    let (mut starts, mut columns, mut weights) = (vec![0], Vec::new(), Vec::new());
    for _ in 0..count {
        columns.extend((0..unknowns).step_by(2));
        weights.extend(noise.vector(unknowns.div_ceil(2)));
        starts.push(columns.len());
    }
    let width = unknowns.div_ceil(2);
    for row in 0..repeat {
        columns.extend((0..unknowns).step_by(2));
        weights.extend_from_within(row * width..(row + 1) * width);
        starts.push(columns.len());
    }
    ConstraintRows::new(starts, columns, weights, unknowns).unwrap()
}

fn dense(pattern: &LowerPattern, values: &[f64], rows: &ConstraintRows) -> Dense {
    let size = pattern.size();
    let total = size + rows.count();
    let mut matrix = vec![vec![0.0; total]; total];
    for (row, line) in matrix.iter_mut().enumerate().take(size) {
        for (column, entry) in line.iter_mut().enumerate().take(size) {
            *entry = pattern.position(row, column).map_or(0.0, |at| values[at]);
        }
    }
    for row in 0..rows.count() {
        let (columns, weights) = rows.row(row);
        for (&column, &weight) in columns.iter().zip(weights) {
            matrix[size + row][column] = weight;
            matrix[column][size + row] = weight;
        }
    }
    matrix
}

/// Eigenvalues by cyclic Jacobi rotations: slow, independent of what is tested.
fn eigenvalues(mut a: Dense) -> Vec<f64> {
    let size = a.len();
    for _ in 0..60 {
        for p in 0..size {
            for q in p + 1..size {
                if a[p][q] == 0.0 {
                    continue;
                }
                let angle = 0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p]);
                let (s, c) = angle.sin_cos();
                for line in &mut a {
                    (line[p], line[q]) = (c * line[p] - s * line[q], s * line[p] + c * line[q]);
                }
                let (above, below) = a.split_at_mut(q);
                for (x, y) in above[p].iter_mut().zip(&mut below[0]) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
            }
        }
    }
    (0..size).map(|k| a[k][k]).collect()
}

fn product(matrix: &Dense, vector: &[f64]) -> Vec<f64> {
    matrix
        .iter()
        .map(|line| line.iter().zip(vector).map(|(a, b)| a * b).sum())
        .collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn inertia_counts_the_negative_eigenvalues() {
    let mut noise = Noise(3);
    let mut indefinite = 0;
    for (rows, shift) in [
        (0, 0.1),
        (4, 0.1),
        (4, -0.5),
        (9, -1.5),
        (0, -1.0),
        (5, 1.0),
    ] {
        let (pattern, values) = chain(12, shift, &mut noise);
        let rows = random_rows(pattern.size(), rows, 0, &mut noise);
        let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
        let inertia = kkt.factorize(&values, &vec![0.0; pattern.size()]).unwrap();
        let expected = eigenvalues(dense(&pattern, &values, &rows))
            .iter()
            .filter(|&&value| value < 0.0)
            .count();
        let rows = rows.count();
        assert_eq!(
            inertia,
            Inertia {
                negative: expected,
                rows
            }
        );
        assert_eq!(inertia.is_minimum(), expected == rows);
        indefinite += usize::from(expected > rows);
    }
    assert!(indefinite >= 2);
}

#[test]
fn refined_solutions_solve_the_unregularised_system() {
    let mut noise = Noise(5);
    for (rows, shift) in [(0, 0.1), (6, 0.1), (6, -0.7)] {
        let (pattern, values) = chain(20, shift, &mut noise);
        let size = pattern.size();
        let rows = random_rows(size, rows, 0, &mut noise);
        let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
        kkt.factorize(&values, &vec![0.0; size]).unwrap();
        let exact = noise.vector(size + rows.count());
        let rhs = product(&dense(&pattern, &values, &rows), &exact);
        let mut step = vec![0.0; size];
        let mut multipliers = vec![0.0; rows.count()];
        let residual = kkt
            .solve(&rhs[..size], &rhs[size..], &mut step, &mut multipliers)
            .unwrap();
        assert!(residual < 1e-12, "residual {residual}");
        assert!(largest_difference(&step, &exact[..size]) < 1e-9);
        assert!(largest_difference(&multipliers, &exact[size..]) < 1e-9);
    }
}

#[test]
fn repeated_rows_keep_solution_and_inertia() {
    let mut noise = Noise(7);
    let (pattern, values) = chain(20, 0.1, &mut noise);
    let size = pattern.size();
    let rows = random_rows(size, 5, 3, &mut noise);
    let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
    let inertia = kkt.factorize(&values, &vec![0.0; size]).unwrap();
    assert_eq!(
        inertia,
        Inertia {
            negative: 8,
            rows: 8
        }
    );

    let exact = noise.vector(size + 8);
    let rhs = product(&dense(&pattern, &values, &rows), &exact);
    let (mut step, mut multipliers) = (vec![0.0; size], vec![0.0; 8]);
    let residual = kkt
        .solve(&rhs[..size], &rhs[size..], &mut step, &mut multipliers)
        .unwrap();
    assert!(residual < 1e-12, "residual {residual}");
    assert!(largest_difference(&step, &exact[..size]) < 1e-9);
    // Only the sum of the multipliers of equal rows is determined.
    let sum = multipliers[0] + multipliers[5] - exact[size] - exact[size + 5];
    assert!(sum.abs() < 1e-8);
}

#[test]
fn contradicting_rows_are_told_by_the_residual() {
    let mut noise = Noise(9);
    let (pattern, values) = chain(5, 0.1, &mut noise);
    let rows = random_rows(pattern.size(), 1, 1, &mut noise);
    let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
    kkt.factorize(&values, &[0.0; 15]).unwrap();
    let (mut step, mut multipliers) = (vec![0.0; 15], vec![0.0; 2]);
    let residual = kkt
        .solve(&[0.0; 15], &[1.0, 2.0], &mut step, &mut multipliers)
        .unwrap();
    assert!(residual > 0.1);
    assert!(
        step.iter()
            .chain(&multipliers)
            .all(|entry| entry.is_finite())
    );
}

#[test]
fn floor_is_part_of_the_matrix() {
    let mut noise = Noise(11);
    let (pattern, values) = chain(6, -1.0, &mut noise);
    let mut kkt = Kkt::new(&pattern, &ConstraintRows::none(18), BLOCK).unwrap();
    assert!(!kkt.factorize(&values, &[0.0; 18]).unwrap().is_minimum());
    assert!(kkt.factorize(&values, &[2.0; 18]).unwrap().is_minimum());
    let (mut step, force) = (vec![0.0; 18], noise.vector(18));
    kkt.solve(&force, &[], &mut step, &mut []).unwrap();
    let mut matrix = dense(&pattern, &values, &ConstraintRows::none(18));
    for (k, line) in matrix.iter_mut().enumerate() {
        line[k] += 2.0;
    }
    assert!(largest_difference(&product(&matrix, &step), &force) < 1e-11);
}

#[test]
fn refactorising_forgets_the_matrix_before() {
    let mut noise = Noise(13);
    let (pattern, values) = chain(10, 0.1, &mut noise);
    let other: Vec<f64> = values.iter().map(|value| 3.0 * value).collect();
    let rows = random_rows(30, 3, 0, &mut noise);
    let damping = [0.0; 30];
    let force = noise.vector(30);
    let solve = |kkt: &mut Kkt| {
        let (mut step, mut multipliers) = (vec![0.0; 30], vec![0.0; 3]);
        kkt.solve(&force, &[0.1, 0.2, 0.3], &mut step, &mut multipliers)
            .unwrap();
        step
    };
    let mut fresh = Kkt::new(&pattern, &rows, BLOCK).unwrap();
    fresh.factorize(&values, &damping).unwrap();
    let expected = solve(&mut fresh);
    let mut reused = Kkt::new(&pattern, &rows, BLOCK).unwrap();
    reused.factorize(&other, &damping).unwrap();
    reused.factorize(&values, &damping).unwrap();
    assert_eq!(solve(&mut reused), expected);
}

#[test]
fn a_factor_that_was_released_comes_back_the_same() {
    let mut noise = Noise(11);
    let (pattern, values) = chain(12, 0.5, &mut noise);
    let rows = random_rows(pattern.size(), 3, 0, &mut noise);
    let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
    let cost = kkt.cost();
    assert!(cost.factor_entries >= pattern.size());
    let (force, offset) = (noise.vector(pattern.size()), noise.vector(rows.count()));
    let solve = |kkt: &mut Kkt| {
        let (mut step, mut multipliers) = (vec![0.0; force.len()], vec![0.0; offset.len()]);
        kkt.solve(&force, &offset, &mut step, &mut multipliers)
            .map(|_| step)
    };
    kkt.factorize(&values, &[]).unwrap();
    let before = solve(&mut kkt).unwrap();
    kkt.release();
    assert!(matches!(solve(&mut kkt), Err(SolverError::NotFactorized)));
    assert_eq!(kkt.cost(), cost);
    kkt.factorize(&values, &[]).unwrap();
    assert_eq!(solve(&mut kkt).unwrap(), before);
    assert_eq!(kkt.cost(), cost);
    // Another matrix leaves nothing of the one before, whether that was given back or not.
    let damping = vec![0.3; pattern.size()];
    kkt.factorize(&values, &damping).unwrap();
    let damped = solve(&mut kkt).unwrap();
    assert_ne!(damped, before);
    kkt.release();
    kkt.factorize(&values, &damping).unwrap();
    assert_eq!(solve(&mut kkt).unwrap(), damped);
}

/// A body that only inertia holds, a million million times softer than its springs, falls by one.
#[test]
fn a_body_that_falls_freely_is_no_harder_without_rows() {
    let stencils = [[0, 1], [1, 2], [2, 3]];
    let pattern = LowerPattern::from_stencils(4, stencils.iter().map(<[usize; 2]>::as_slice));
    let pattern = pattern.unwrap();
    let inertia = 1e-12;
    let mut values = vec![0.0; pattern.entries()];
    for [a, b] in stencils {
        values[pattern.position(a, a).unwrap()] += 1.0;
        values[pattern.position(b, b).unwrap()] += 1.0;
        values[pattern.position(b, a).unwrap()] -= 1.0;
    }
    for column in 0..4 {
        values[pattern.position(column, column).unwrap()] += inertia;
    }
    let mut kkt = Kkt::new(&pattern, &ConstraintRows::none(4), 1).unwrap();
    assert!(kkt.factorize(&values, &[]).unwrap().is_minimum());
    let mut step = [0.0; 4];
    kkt.solve_step(&[inertia; 4], &[], &mut step, &mut [])
        .unwrap();
    // The sum of inertia and springs is rounded to 1e-4 of inertia.
    assert!(step.iter().all(|x| (x - 1.0).abs() < 1e-2), "{step:?}");
}

/// Springs of a grid, large enough that its factor is made in many branches, and its largest fronts in pieces; the
/// vertices along one side are pushed apart.
fn grid(side: usize) -> (LowerPattern, Vec<f64>) {
    let size = BLOCK * side * side;
    let unknowns = |i: usize, j: usize| BLOCK * (side * j + i)..BLOCK * (side * j + i + 1);
    let mut springs: Vec<Vec<usize>> = Vec::new();
    for (i, j) in (0..side * side).map(|v| (v % side, v / side)) {
        for (k, l) in [(i + 1, j), (i, j + 1), (i + 1, j + 1)] {
            if k < side && l < side {
                springs.push(unknowns(i, j).chain(unknowns(k, l)).collect());
            }
        }
    }
    let pattern = LowerPattern::from_stencils(size, springs.iter().map(Vec::as_slice)).unwrap();
    let mut values = vec![0.0; pattern.entries()];
    let mut noise = Noise(7);
    for spring in &springs {
        let weights = noise.vector(spring.len());
        for (a, &row) in weights.iter().zip(spring) {
            for (b, &column) in weights.iter().zip(spring).filter(|(_, c)| **c <= row) {
                values[pattern.position(row, column).unwrap()] += a * b;
            }
        }
    }
    for unknown in 0..size {
        let shift = if unknown < BLOCK * side { -40.0 } else { 0.1 };
        values[pattern.position(unknown, unknown).unwrap()] += shift;
    }
    (pattern, values)
}

/// Sums over stretches of vertices, in triples.
fn averages(unknowns: usize) -> ConstraintRows {
    let (mut starts, mut columns) = (vec![0], Vec::new());
    for row in 0..60 {
        let first = unknowns / 20 * (row / BLOCK) + row % BLOCK;
        columns.extend((first..(first + 900).min(unknowns)).step_by(BLOCK));
        starts.push(columns.len());
    }
    let weights = vec![1.0; columns.len()];
    ConstraintRows::new(starts, columns, weights, unknowns).unwrap()
}

/// An order that was kept is as good as one found anew, and one of another system of this size right, too.
#[test]
fn systems_are_factorised_in_orders_that_were_kept() {
    let (pattern, values) = chain(20, 0.1, &mut Noise(11));
    let rows = random_rows(pattern.size(), 3, 0, &mut Noise(12));
    let force = Noise(13).vector(pattern.size());
    let solved = |mut kkt: Kkt| {
        kkt.factorize(&values, &[]).unwrap();
        let (mut step, mut multipliers) = (vec![0.0; pattern.size()], vec![0.0; 3]);
        kkt.solve(&force, &[0.0; 3], &mut step, &mut multipliers)
            .unwrap();
        (step, kkt.into_order())
    };
    let (first, order) = solved(Kkt::new(&pattern, &rows, BLOCK).unwrap());
    let again = Kkt::with_order(&pattern, &rows, BLOCK, order.clone()).unwrap();
    assert_eq!(solved(again), (first.clone(), order.clone()));
    let unconnected = (0..pattern.size())
        .map(|unknown| [unknown])
        .collect::<Vec<_>>();
    let unconnected = unconnected.iter().map(<[usize; 1]>::as_slice);
    let unconnected = LowerPattern::from_stencils(pattern.size(), unconnected).unwrap();
    let other = EliminationOrder::new(&unconnected, &rows, BLOCK).unwrap();
    assert!(other != order);
    let other = Kkt::with_order(&pattern, &rows, BLOCK, other).unwrap();
    assert!(largest_difference(&solved(other).0, &first) < 1e-9);
    let short = EliminationOrder::new(&pattern, &ConstraintRows::none(pattern.size()), BLOCK);
    let short = Kkt::with_order(&pattern, &rows, BLOCK, short.unwrap());
    assert!(matches!(short, Err(SolverError::SizeMismatch { .. })));
}

#[test]
fn a_large_factor_has_the_same_bits_on_any_number_of_threads() {
    let side = 100;
    let (pattern, values) = grid(side);
    let force = Noise(3).vector(pattern.size());
    // Without the corners that rows bring the factor has the inertia of the matrix.
    for rows in [
        ConstraintRows::none(pattern.size()),
        averages(pattern.size()),
    ] {
        let solved_on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let mut kkt = Kkt::new(&pattern, &rows, BLOCK).unwrap();
                assert!(kkt.cost().flops > 3e8, "too small to be cut");
                let inertia = kkt.factorize(&values, &[]).unwrap();
                if rows.count() == 0 {
                    // What is pushed apart is negative definite, and what is left without it still positive.
                    assert_eq!(inertia.negative, BLOCK * side);
                }
                let (mut step, mut once) = (vec![0.0; pattern.size()], vec![0.0; pattern.size()]);
                let mut multipliers = vec![0.0; rows.count()];
                let offset = vec![0.0; rows.count()];
                let residual = kkt
                    .solve(&force, &offset, &mut step, &mut multipliers)
                    .unwrap();
                assert!(residual < 1e-11, "{residual}");
                kkt.solve_once(&force, &mut once).unwrap();
                [step, multipliers, once].concat()
            })
        };
        let one = solved_on(1);
        for threads in [2, 5] {
            let bits = |all: &[f64]| all.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert!(bits(&solved_on(threads)) == bits(&one), "{threads} threads");
        }
    }
}
