use super::*;
use crate::permuted_system::{PermutedSystem, analyse};
use crate::{ConstraintRows, EliminationOrder, LowerPattern, SolverError};

/// Square grids of so many vertices along a side that do not touch each other, with diagonals, and vertices alone;
/// three unknowns per vertex.
fn grids(sides: &[usize], alone: usize) -> Result<LowerPattern, SolverError> {
    let mut elements: Vec<Vec<usize>> = Vec::new();
    let mut first = 0;
    for side in sides {
        let unknowns =
            |i: usize, j: usize| 3 * (first + side * j + i)..3 * (first + side * j + i + 1);
        for (i, j) in (0..side * side).map(|v| (v % side, v / side)) {
            for (k, l) in [(i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                if k < *side && l < *side {
                    elements.push(unknowns(i, j).chain(unknowns(k, l)).collect());
                }
            }
        }
        first += side * side;
    }
    elements.extend((first..first + alone).map(|v| (3 * v..3 * v + 3).collect()));
    LowerPattern::from_stencils(3 * (first + alone), elements.iter().map(Vec::as_slice))
}

/// Fronts of a pattern, the places of its entries, and those of the diagonal in the order of elimination.
fn fronts(pattern: &LowerPattern) -> Result<(Fronts, Vec<usize>), SolverError> {
    let none = ConstraintRows::none(pattern.size());
    let order = EliminationOrder::new(pattern, &none, 3)?;
    let assembled = PermutedSystem::assemble(pattern, &none, order.placement());
    let fronts = Fronts::new(analyse(&assembled.lower)?);
    let places = fronts.places(assembled.lower.as_ref());
    let starts = assembled.lower.col_ptr();
    // Rows of a column ascend.
    let diagonal = (0..pattern.size()).map(|column| places[starts[column] as usize] as usize);
    let diagonal = diagonal.collect();
    Ok((fronts, diagonal))
}

#[test]
fn every_supernode_comes_after_its_children_in_one_branch() -> Result<(), SolverError> {
    for (sides, alone) in [(vec![], 1), (vec![1], 0), (vec![90, 70, 5, 60], 40)] {
        let (fronts, _) = fronts(&grids(&sides, alone)?)?;
        let (tree, count) = (&fronts.tree, fronts.symbolic.n_supernodes());
        let branches = tree.branches();
        let mut place = vec![None; count];
        for (number, branch) in branches.iter().enumerate() {
            for (i, &supernode) in branch.supernodes.iter().enumerate() {
                let before = place[supernode as usize].replace((number, i));
                assert_eq!(before, None, "it is in two branches");
                assert_eq!(tree.branch_of(supernode as usize), number);
            }
            let waits = branches.iter().filter(|other| other.parent == Some(number));
            assert_eq!(waits.count(), branch.waits);
        }
        for supernode in 0..count {
            let (number, own) = place[supernode].expect("it is in a branch");
            for &child in tree.children(supernode) {
                let (below, before) = place[child as usize].expect("it is in a branch");
                assert!(below == number && before < own || branches[below].parent == Some(number));
            }
        }
        if sides.len() > 1 {
            assert!(branches.len() > 30, "{} branches", branches.len());
        }
    }
    Ok(())
}

#[test]
fn of_bad_pivots_in_two_branches_the_first_is_told() -> Result<(), SolverError> {
    let pattern = grids(&[60, 60], 0)?;
    let (fronts, diagonal) = fronts(&pattern)?;
    let mut unit = vec![0.0; fronts.symbolic().len_val()];
    diagonal.iter().for_each(|&place| unit[place] = 1.0);
    let half = diagonal.len() / 2;
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut values = unit.clone();
            for (pivot, value) in [
                (half + 7, 0.0),
                (half - 9, f64::NAN),
                (diagonal.len() - 1, 0.0),
            ] {
                values[diagonal[pivot]] = value;
            }
            assert_eq!(fronts.factorize(&mut values), Err(BadPivot(half - 9)));
            let mut values = unit.clone();
            assert_eq!(fronts.factorize(&mut values), Ok(()));
            assert!(values == unit, "it is its own factor");
        });
    }
    Ok(())
}

/// Rows of a child that go on from the columns of its parent to the rows below, with gaps.
#[test]
fn update_matrices_are_added_where_their_rows_are() {
    let (columns, below) = (4..7, [7_u32, 8, 10, 11, 20]);
    let rows = [4_u32, 6, 7, 8, 11, 20];
    let own: Vec<f64> = (0..36).map(f64::from).collect();
    let (mut front, mut update) = (vec![0.5; 3 * 8], vec![0.5; 25]);
    extend_add((&own, &rows), (&mut front, &mut update), (&columns, &below));
    let all: Vec<u32> = (4..7).chain(below).collect();
    for (j, column) in all.iter().enumerate() {
        for (i, row) in all.iter().enumerate().skip(j) {
            let [a, b] = [row, column].map(|row| rows.iter().position(|other| other == row));
            let added = a.zip(b).map_or(0.0, |(a, b)| own[6 * b + a]);
            let found = if j < 3 {
                front[8 * j + i]
            } else {
                update[5 * (j - 3) + i - 3]
            };
            assert_eq!(found, 0.5 + added, "row {row}, column {column}");
        }
    }
}

#[test]
fn fronts_of_all_widths_are_eliminated() -> Result<(), usize> {
    for (columns, below) in [
        (1, 0),
        (3, 4),
        (95, 1),
        (96, 0),
        (97, 1),
        (200, 0),
        (200, 150),
    ] {
        let rows = columns + below;
        let entry = |i: usize, j: usize| {
            let noise = (((i * 37 + j * 101) % 19) as f64 - 9.0) / 19.0;
            // Every third pivot is negative.
            noise
                + if i == j {
                    150.0 * if i.is_multiple_of(3) { -1.0 } else { 1.0 }
                } else {
                    0.0
                }
        };
        let mut front: Vec<f64> = (0..rows * columns)
            .map(|at| entry(at % rows, at / rows))
            .collect();
        let mut update = vec![0.0; below * below];
        let square = MatMut::from_column_major_slice_mut(&mut update, below, below);
        eliminate(
            MatMut::from_column_major_slice_mut(&mut front, rows, columns),
            square,
        )?;
        let lower = |i: usize, j: usize| if i == j { 1.0 } else { front[rows * j + i] };
        let product = |i: usize, j: usize, end: usize| -> f64 {
            (0..end)
                .map(|k| lower(i, k) * front[rows * k + k] * lower(j, k))
                .sum()
        };
        for j in 0..rows {
            for i in j..rows {
                let (found, wanted) = match j < columns {
                    true => (product(i, j, j + 1), entry(i, j)),
                    false => {
                        let (i, j) = (i - columns, j - columns);
                        (
                            -update[below * j + i],
                            product(i + columns, j + columns, columns),
                        )
                    }
                };
                assert!(
                    (found - wanted).abs() < 1e-9,
                    "{columns} columns: {found} {wanted}"
                );
            }
        }
    }
    Ok(())
}
