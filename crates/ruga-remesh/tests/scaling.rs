//! Work grows with the mesh and not faster; the benchmark measures the time.

mod shapes;

use ruga_remesh::{RemeshSettings, remesh};
use shapes::{Shape, Sheet, Waves, grid};

/// Operations and faces of one remesh.
fn work(cells: usize, edge: f64) -> (f64, f64) {
    let mesh = grid(Shape::Cylinder, cells, 0.2, 1);
    let sizing = Waves {
        edge,
        range: 3.0,
        aspect: 2.0,
        seed: 2,
    }
    .sizing(&mesh);
    let result = remesh(
        &mesh,
        &sizing,
        &Sheet(Shape::Cylinder),
        &RemeshSettings::default(),
    )
    .expect("valid input");
    let report = result.report;
    let operations = report.splits + report.flips + report.collapses + report.moves;
    (
        operations as f64,
        result.mesh.mesh.face_count().max(mesh.mesh.face_count()) as f64,
    )
}

#[test]
fn four_times_the_faces_take_at_most_five_times_the_operations() {
    for (cells, edge) in [(10, 0.03), (60, 0.03), (80, 0.06)] {
        let (few, small) = work(cells, edge);
        let (many, large) = work(2 * cells, edge / 2.0);
        let ratio = (many / large) / (few / small);
        assert!(
            ratio < 1.25,
            "{cells} cells: operations per face grow by {ratio}"
        );
    }
}
