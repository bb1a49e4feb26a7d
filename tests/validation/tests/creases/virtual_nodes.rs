//! What the paper's element can do, and where it locks, drifts and rests wrongly; ours beside it.
//!
//! In the differences `a = A - A'`, `b = B - B'` the rows of a cut say `w_A a = w_B b`, per coordinate, and the cut
//! edges join the copied nodes to a chain: one vector is left, however long the cut. Edges on a crease with an
//! internal angle per star have no such limit.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_crease::{Corners, LineInput, LineTracer, TracedLine};
use ruga_mesh::{Id, MaterialPoint, TriMesh};
use ruga_validation::DrawnSheet;
use ruga_validation::cantilever::{Fold, fold_over_theory};
use ruga_validation::crease_cost::{crease_cost, frame_cost};
use ruga_validation::hung_cloth::{HungFold, hang};
use ruga_validation::ridge::{FoldElement, fold_error, line, sewn_ridge, unit_square};
use ruga_validation::virtual_nodes::{
    CutCloth, LineEnds, Stabilisation, VirtualNodes, projected_newton,
};

/// Squares along a side.
const SIDE: usize = 32;

fn trace(drawn: &DrawnSheet, points: Vec<Vector3<f64>>, is_closed: bool) -> TracedLine {
    let input = LineInput::Positions {
        points,
        is_closed,
        reach: 1e-3,
        corners: Corners::Keep,
    };
    let traced = LineTracer::new(&drawn.mesh, &drawn.positions).trace(&input);
    traced.expect("a line on the sheet")
}

fn straight(ends: [[f64; 2]; 2]) -> Vec<Vector3<f64>> {
    ends.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec()
}

fn cut(drawn: &DrawnSheet, line: TracedLine, ends: LineEnds) -> VirtualNodes {
    VirtualNodes::cut(&drawn.mesh, &[line], ends)
}

/// T10 of the notes: one vector on a line from border to border and on one that ends at vertices, none on one that
/// ends at edges or on a ring.
#[test]
fn a_cut_folds_by_one_vector_at_most() {
    let drawn = unit_square(SIDE);
    let through = trace(&drawn, straight([[0.0, 0.413], [1.0, 0.577]]), false);
    let through = cut(&drawn, through, LineEnds::AtVertices);
    assert!(through.rows.len() > 60 && through.copies() == through.rows.len() + 1);
    assert_eq!(through.free_vectors(), 1);

    let inner = trace(&drawn, straight([[0.263, 0.413], [0.747, 0.577]]), false);
    let at_vertices = cut(&drawn, inner.clone(), LineEnds::AtVertices);
    assert_eq!(at_vertices.free_vectors(), 1);
    // Two triangles more, each with a copy at its side.
    let at_edges = cut(&drawn, inner, LineEnds::AtEdges);
    assert!(at_edges.copies() < at_vertices.copies());
    assert_eq!(at_edges.free_vectors(), 0);

    let point = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / 97.0).sin_cos();
        Vector3::new(0.5 + 0.31 * cos, 0.5 + 0.31 * sin, 0.0)
    };
    let ring = trace(&drawn, (0..97).map(point).collect(), true);
    let ring = cut(&drawn, ring, LineEnds::AtVertices);
    assert_eq!(ring.copies(), ring.rows.len());
    assert_eq!(ring.free_vectors(), 0);
}

/// After the paper's figure 8: where two cuts cross, a node has four copies, and three rows attach them.
#[test]
fn crossing_cuts_leave_four_parts_that_are_sewn() {
    let drawn = unit_square(8);
    let lines = [[[0.0, 0.413], [1.0, 0.577]], [[0.433, 0.0], [0.561, 1.0]]]
        .map(|ends| trace(&drawn, straight(ends), false));
    let cut = VirtualNodes::cut(&drawn.mesh, &lines, LineEnds::AtVertices);
    assert_eq!(cut.mesh().connected_parts(|_| true).len(), 4);
    let shares: f64 = cut.faces.iter().map(|face| face.share).sum();
    assert!((shares - drawn.mesh.face_count() as f64).abs() < 1e-9);
    let nodes = |v: u32| cut.vertices.iter().filter(|&&own| own == v).count();
    let most = (0..drawn.positions.len() as u32).map(nodes).max();
    assert_eq!(most, Some(4));
    // Rows of three corners: the crossing's, in one face.
    assert_eq!(cut.rows.iter().filter(|row| row.len() == 6).count(), 3);
    // At rest it is shut.
    assert!(cut.gap(&cut.spread(&drawn.positions)) < 1e-12);
}

/// A ring through the zeros of a function that is linear over every triangle: weights around it agree.
#[test]
fn a_ring_folds_by_one_vector_on_a_level_line_of_the_mesh() {
    let drawn = unit_square(SIDE);
    let positions = drawn.positions.iter();
    let level: Vec<f64> = positions
        .map(|p| (p - Vector3::new(0.5, 0.5, 0.0)).norm() - 0.31)
        .collect();
    let places = level_line(&drawn.mesh, &level);
    let input = LineInput::Places {
        places,
        is_closed: true,
    };
    let traced = LineTracer::new(&drawn.mesh, &drawn.positions).trace(&input);
    let ring = cut(&drawn, traced.expect("a ring"), LineEnds::AtVertices);
    assert_eq!(ring.free_vectors(), 1);
}

/// Where the zeros of a function enter one face after another.
fn level_line(mesh: &TriMesh, level: &[f64]) -> Vec<MaterialPoint> {
    let is_cut = |corners: [usize; 2]| level[corners[0]] * level[corners[1]] < 0.0;
    let side = |face, corner: usize| {
        let face: [ruga_mesh::VertexId; 3] = mesh.faces()[face];
        [face[corner].index(), face[(corner + 1) % 3].index()]
    };
    let cut = |face| (0..3).filter(move |&corner| is_cut(side(face, corner)));
    let mut faces = mesh.faces().ids();
    let first = faces.find(|&face| cut(face).count() == 2);
    let first = first.expect("a face is cut");
    let (mut face, mut corner) = (first, cut(first).next().expect("a side"));
    let mut places = Vec::new();
    loop {
        let [a, b] = side(face, corner).map(|v| level[v]);
        let mut barycentric = [0.0; 3];
        barycentric[corner] = b / (b - a);
        barycentric[(corner + 1) % 3] = a / (a - b);
        places.push(MaterialPoint { face, barycentric });
        let leaves = cut(face).find(|&other| other != corner);
        let leaves = leaves.expect("a line leaves a face that it enters");
        let ends = side(face, leaves);
        face = mesh.neighbour(face, leaves).expect("a ring is inside");
        if face == first {
            return places;
        }
        let back = (0..3).find(|&corner| side(face, corner) == [ends[1], ends[0]]);
        corner = back.expect("neighbours share a side");
    }
}

/// T10: on a ridge whose angle varies along its line the paper's element has the order of a mesh without one.
#[test]
fn a_fold_that_varies_is_followed_with_half_the_order() {
    let order = |element| {
        let [coarse, fine] = [8, 32].map(|edges| {
            let found = fold_error(element, edges);
            assert!(found.converged, "{element:?} {edges}");
            found.error
        });
        ((coarse / fine).log2() / 2.0, fine)
    };
    let (plain, without) = order(FoldElement::Plain);
    let (sewn, papers) = order(FoldElement::VirtualNodes);
    let (creased, ours) = order(FoldElement::CreaseEdges);
    // Measured: 0.59, 0.68 and 1.00; 2.2 % against 6.6 and 13.1 % with 32 edges along a side.
    assert!(plain < 0.7 && sewn < 0.7, "{plain} {sewn}");
    assert!(creased > 0.9, "{creased}");
    assert!(
        ours < 0.5 * papers && papers < without,
        "{ours} {papers} {without}"
    );
}

fn cloth() -> CutCloth {
    let drawn = unit_square(8);
    let cut = VirtualNodes::cut(&drawn.mesh, &[line(&drawn)], LineEnds::AtVertices);
    CutCloth::hanging(&drawn, cut)
}

/// T11: with velocities alone the cut opens by something of the first order in the time step.
#[test]
fn equal_velocities_let_the_cut_drift_and_equal_positions_do_not() {
    let gap = |time_step: f64, stabilisation| {
        let mut cloth = cloth();
        for _ in 0..(0.5 / time_step).round() as usize {
            cloth.step(time_step, stabilisation);
        }
        cloth.gap()
    };
    // Measured: 8.2 and 4.4 mm. Later on a gap as long as edges changes the motion, and halved steps give less.
    let [coarse, fine] = [0.005, 0.0025].map(|step| gap(step, Stabilisation::Post));
    assert!(fine > 1e-3, "{fine}");
    assert!((1.75..2.25).contains(&(coarse / fine)), "{coarse} {fine}");
    for stabilisation in [Stabilisation::Pre, Stabilisation::Both] {
        assert!(gap(0.01, stabilisation) < 1e-12);
    }
}

/// Springs between nodes and copies are as stiff as their nodes are far from the line; a crease is not.
#[test]
fn springs_fold_as_the_mesh_lies_and_creases_do_not() {
    let places = [0.5, 0.53, 0.5625, 0.595];
    let folds = |fold| places.map(|x| fold_over_theory(fold, x + 0.003));
    let [crease, even, by_distance] =
        [Fold::Crease, Fold::EvenSprings, Fold::SpringsByDistance].map(folds);
    // Measured: within 0.05 %; 0.69 to 1.09; within 0.2 %.
    let spread = |all: [f64; 4]| {
        let (low, high) = all
            .iter()
            .fold((f64::MAX, 0.0_f64), |(l, h), &f| (l.min(f), h.max(f)));
        high / low
    };
    assert!(crease.iter().all(|f| (f - 1.0).abs() < 0.002), "{crease:?}");
    assert!(spread(even) > 1.3, "{even:?}");
    assert!(
        by_distance.iter().all(|f| (f - 1.0).abs() < 0.005),
        "{by_distance:?}"
    );
}

/// T11: the paper's quasistatic way closes the cut and comes to rest above the least energy.
#[test]
fn projected_newton_steps_rest_at_a_wrong_place() {
    let (mut sheet, cut, rest) = sewn_ridge(4);
    let masses = cut.masses(&rest, 1.0);
    let mut positions = sheet.positions().to_vec();
    let steps = projected_newton((sheet.layer(), &cut), &masses, &mut positions, 60);
    let last = steps.last().expect("steps were made");
    let report = sheet.solve(&crate::exact());
    assert!(report.converged);
    assert!(last.gap < 1e-12 && report.infeasibility < 1e-9);
    // Measured: 1.16 times the least, and steps as long as the first.
    assert!(
        last.energy > 1.1 * sheet.energy(),
        "{last:?} {}",
        sheet.energy()
    );
    assert!(last.step > 1e-4, "{last:?}");
}

/// T18: ten lines add nothing to the matrix and little to the time of its assembly.
#[test]
fn ten_lines_cost_next_to_nothing() {
    let cost = crease_cost(8, 10);
    assert_eq!(cost.entries[0], cost.entries[1]);
    // Measured: 0.5 to 3 % more; the bound leaves room for a machine that does other things as well.
    let share = cost.share;
    assert!(share < 1.2, "{cost:?}");
    // A load step takes as many Newton steps, to as high wrinkles. The study measures ten lines on a film of eight
    // wavelengths: 2 % less to 2 % more.
    let frame = frame_cost(4, 3);
    let [plain, lined] = frame.amplitudes;
    assert!(
        plain > 0.1 && (lined / plain - 1.0).abs() < 0.05,
        "{frame:?}"
    );
    assert_eq!(frame.iterations[0], frame.iterations[1]);
    let share = frame.share;
    assert!(share < 1.2, "{frame:?}");
}

/// After the paper's figure 9: a coarse cloth hung by opposite corners folds along its crease as a fine one does.
#[test]
fn a_hung_cloth_folds_along_its_crease_on_a_coarse_mesh_as_on_a_fine_one() {
    let [coarse, fine] = [8, 24].map(|edges| hang(HungFold::Crease, edges));
    assert!(coarse.converged && fine.converged);
    // Measured: 68.2 degrees, and 67.0 with 32 edges; energies 0.9 % apart.
    assert!(fine.fold > 60.0, "{}", fine.fold);
    assert!(
        (coarse.fold - fine.fold).abs() < 3.0,
        "{} {}",
        coarse.fold,
        fine.fold
    );
    assert!((coarse.energy / fine.energy - 1.0).abs() < 0.02);
    // The springs' moment grows with the sine of the angle.
    let springs = hang(HungFold::Springs, 8);
    assert!(
        springs.converged && springs.fold > 120.0,
        "{}",
        springs.fold
    );
}
