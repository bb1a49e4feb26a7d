//! Block patterns against dense matrices: slots, products, and two patterns side by side.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::BlockPattern;

const POINTS: usize = 9;

fn stencils(random: &mut Pcg64Mcg) -> Vec<[u32; 3]> {
    let corner = |random: &mut Pcg64Mcg| random.random_range(0..POINTS as u32);
    let mut stencils: Vec<[u32; 3]> = (0..12)
        .map(|_| [(); 3].map(|()| corner(random)))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    // No point is without a stencil.
    stencils.extend((0..POINTS as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]));
    stencils
}

/// The symmetric matrix over free points that entries in the pattern's order stand for.
fn dense(pattern: &BlockPattern, values: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(pattern.size(), pattern.size());
    for (column, range) in pattern.column_starts().windows(2).enumerate() {
        let entries = range[0]..range[1];
        for (&row, &value) in pattern.rows()[entries.clone()].iter().zip(&values[entries]) {
            let row = row as usize;
            matrix[(row, column)] = value;
            matrix[(column, row)] = value;
        }
    }
    matrix
}

#[test]
fn blocks_land_where_a_dense_matrix_has_them() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..20 {
        let pinned: Vec<bool> = (0..POINTS).map(|_| random.random_bool(0.3)).collect();
        let stencils = stencils(&mut random);
        let pattern = BlockPattern::new(&pinned, stencils.iter().map(|s| s.as_slice()));
        let mut values = vec![0.0; pattern.rows().len()];
        let mut expected = DMatrix::zeros(pattern.size(), pattern.size());
        for stencil in &stencils {
            let pairs = (0..3).flat_map(|i| (0..=i).map(move |j| [i, j]));
            for ([i, j], slot) in pairs.zip(pattern.stencil_slots(stencil)) {
                let mut block = Matrix3::from_fn(|_, _| random.random_range(-1.0..1.0));
                if i == j {
                    block += block.transpose();
                }
                slot.add(&mut values, &block);
                let [row, column] = [i, j].map(|k| pattern.free(stencil[k]));
                let (Some(row), Some(column)) = (row, column) else {
                    continue;
                };
                for (r, c) in (0..3).flat_map(|r| (0..3).map(move |c| (r, c))) {
                    expected[(3 * row + r, 3 * column + c)] += block[(r, c)];
                    if i != j {
                        expected[(3 * column + c, 3 * row + r)] += block[(r, c)];
                    }
                }
            }
        }
        let found = dense(&pattern, &values);
        assert!((&found - &expected).amax() < 1e-12);

        let v: Vec<Vector3<f64>> = (0..pattern.free_points().len())
            .map(|_| Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)))
            .collect();
        let flat = DVector::from_iterator(pattern.size(), v.iter().flatten().copied());
        let product = pattern.product(&values, &v);
        let product = DVector::from_iterator(pattern.size(), product.iter().flatten().copied());
        assert!((product - expected * flat).amax() < 1e-12);
    }
}

/// Free points of both, each coupled with what it is said to be, and nothing else.
#[test]
fn patterns_beside_each_other_couple_what_is_named() {
    let upper = BlockPattern::new(&[false; 3], std::iter::once([0, 1, 2].as_slice()));
    let lower = BlockPattern::new(&[false, true, false], std::iter::once([0, 1, 2].as_slice()));
    let coupled = vec![vec![0], vec![], vec![0, 1]];
    let both = upper.beside(&lower, &coupled);
    assert_eq!(both.size(), upper.size() + lower.size());
    let ones = vec![1.0; both.rows().len()];
    let matrix = dense(&both, &ones);
    for (vertex, nodes) in coupled.iter().enumerate() {
        for node in 0..2 {
            let expected = if nodes.contains(&(node as u32)) {
                1.0
            } else {
                0.0
            };
            assert_eq!(
                matrix[(9 + 3 * node, 3 * vertex)],
                expected,
                "{vertex} {node}"
            );
        }
    }
}
