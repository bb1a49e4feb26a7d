//! What marching triangles leave of a sheet of springs.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::Vector3;
use ruga_validation::spring_sheet::{Remains, Remnant, SpringColour, SpringLattice};

/// A square of `n` cells of side 1 around the origin, cut where `level` is negative at its particles.
fn cut(n: usize, level: impl Fn(&Vector3<f64>) -> f64) -> (SpringLattice, Remnant) {
    let (lattice, positions) = SpringLattice::rectangle([n, n], 1.0, 0.25).unwrap();
    let levels: Vec<f64> = positions.iter().map(level).collect();
    let remnant = Remnant::new(&lattice, &positions, &levels);
    (lattice, remnant)
}

fn count(remnant: &Remnant, kind: Remains) -> usize {
    remnant.remains.iter().filter(|own| **own == kind).count()
}

/// Every side of a face is met by one face, or by two that go along it in opposite ways.
fn assert_manifold(remnant: &Remnant) {
    let mut sides: Vec<[u32; 2]> = Vec::new();
    for face in &remnant.faces {
        sides.extend((0..3).map(|k| [face[k], face[(k + 1) % 3]]));
    }
    let count = sides.len();
    sides.sort_unstable();
    sides.dedup();
    assert_eq!(sides.len(), count);
}

#[test]
fn the_four_cases() {
    // One cell, its corners in a circle: 0 (-,-), 1 (+,-), 2 (+,+), 3 (-,+); the centre is their mean.
    let (lattice, positions) = SpringLattice::rectangle([1, 1], 1.0, 0.25).unwrap();
    assert_eq!(lattice.cells(), [[0, 2, 3, 1]]);
    let of = |levels: [f64; 4]| {
        let [a, b, c, d] = levels;
        Remnant::new(&lattice, &positions, &[a, d, b, c])
    };
    let remains = |levels| of(levels).remains;
    use Remains::{Dropped, Quadrilateral, Triangle, Whole};
    assert_eq!(remains([1.0; 4]), [Whole; 4]);
    assert_eq!(remains([-1.0; 4]), [Dropped; 4]);
    // Centre at 1/2: the first corner is cut off of both triangles at it.
    assert_eq!(
        remains([-1.0, 1.0, 1.0, 1.0]),
        [Quadrilateral, Whole, Whole, Quadrilateral]
    );
    // Centre at -1/2: one corner is left.
    assert_eq!(
        remains([1.0, -1.0, -1.0, -1.0]),
        [Triangle, Dropped, Dropped, Triangle]
    );
    let left = of([1.0, -1.0, -1.0, -1.0]);
    // Half of each side, and two thirds of the way to the centre.
    assert!((left.area() - 2.0 * 0.25 * 0.5 * 2.0 / 3.0).abs() < 1e-15);
    assert_eq!(left.points.len(), 4);
}

#[test]
fn exact_zeros_make_no_lines_and_no_points() {
    use Remains::{Dropped, Triangle, Whole};
    let (lattice, positions) = SpringLattice::rectangle([1, 1], 1.0, 0.25).unwrap();
    let of = |[a, b, c, d]: [f64; 4]| Remnant::new(&lattice, &positions, &[a, d, b, c]);
    // A sheet that is just burnt out has nothing left.
    assert_eq!(of([0.0; 4]).remains, [Dropped; 4]);
    assert!(of([0.0; 4]).faces.is_empty());
    // The level goes through two corners and the centre: half of the cell is whole, without slivers.
    let half = of([1.0, 0.0, -1.0, 0.0]);
    assert_eq!(half.remains, [Whole, Dropped, Dropped, Whole]);
    assert_eq!((half.points.len(), half.faces.len()), (4, 2));
    assert!((half.area() - 0.5).abs() < 1e-15);
    // Through a corner and a side.
    let own = of([0.0, 1.0, -1.0, -4.0]);
    assert_eq!(own.remains[0], Triangle);
    assert_manifold(&own);
    // Negative zero is zero; what is no number is burnt.
    assert_eq!(of([-0.0, 1.0, 1.0, 1.0]).remains, [Whole; 4]);
    assert_eq!(of([f64::NAN; 4]).remains, [Dropped; 4]);
    assert_eq!(
        Remnant::new(&lattice, &positions, &[]).remains,
        [Dropped; 4]
    );
    // Levels whose product underflows are still on two sides.
    let tiny = of([1e-200, -1e-200, -1e-200, -1e-200]);
    assert!((tiny.area() - 1.0 / 6.0).abs() < 1e-12, "{}", tiny.area());
}

/// A level that is linear is cut exactly.
#[test]
fn the_area_left_is_that_of_the_level() {
    let (_, remnant) = cut(6, |p| p.x + 0.3 * p.y - 0.37);
    // The line meets all rows: mean width right of it is 3 - 0.37.
    assert!((remnant.area() - 6.0 * (3.0 - 0.37)).abs() < 1e-12);
    assert_manifold(&remnant);
    assert_eq!(
        count(&remnant, Remains::Whole)
            + count(&remnant, Remains::Dropped)
            + count(&remnant, Remains::Triangle)
            + count(&remnant, Remains::Quadrilateral),
        144
    );
}

#[test]
fn springs_go_when_no_triangle_is_beside_them() {
    let (lattice, all) = cut(6, |_| 1.0);
    let kept = all.springs(&lattice).unwrap();
    assert_eq!(kept.spring_count(), lattice.spring_count());
    let (lattice, none) = cut(6, |_| -1.0);
    assert_eq!(none.springs(&lattice).unwrap().spring_count(), 0);
    // The right half, through corners: columns of cells 3 to 5 stay, with the blue springs on the cut and the
    // green ones across it, of which one triangle is left and one end is burnt.
    let (lattice, half) = cut(6, |p| p.x);
    let kept = half.springs(&lattice).unwrap();
    let counts = SpringColour::ALL.map(|colour| kept.set(colour).ends().len());
    assert_eq!(counts, [4 * 18, 2 * 6 + 3 * 5 + 6, 3 * 7 + 4 * 6, 2 * 18]);
    // A hole in the middle.
    let (lattice, ring) = cut(6, |p| p.norm() - 1.5);
    assert_manifold(&ring);
    let kept = ring.springs(&lattice).unwrap();
    let corner =
        lattice.set(SpringColour::Blue).ends().len() - kept.set(SpringColour::Blue).ends().len();
    assert!((1..=12).contains(&corner), "{corner}");
    // Lengths stay with their springs.
    let blue = kept.set(SpringColour::Blue);
    assert!(
        blue.target_lengths()
            .iter()
            .all(|l| (l - 1.0).abs() < 1e-15)
    );
}
