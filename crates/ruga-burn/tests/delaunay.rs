//! Field meshes are Delaunay in their own metric, whatever mesh they come from.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::Vector3;
use ruga_burn::{BurnSettings, BurnSolver, BurnState, FieldMesh, FrontCorrection};
use ruga_mesh::{Id, PerVertex, TriMesh, face_areas, subdivide};
use sheets::{Sheet, delaunay, irregular, unit_front};

const HEAT: BurnSettings = BurnSettings {
    advance: None,
    correction: FrontCorrection::Uncorrected,
};

/// Temperatures after heat has flowed for a step from a chequered pattern.
fn conducted(sheet: &Sheet, step: f64) -> PerVertex<f64> {
    let law = unit_front(3.43).law().unwrap();
    let mut solver = BurnSolver::new(sheet.field(), law, HEAT).unwrap();
    let temperature = sheet.per_vertex(|x| 400.0 + 80.0 * (3.0 * x.x).sin() * (4.0 * x.y).cos());
    let fuel = PerVertex::filled(temperature.len(), 1.0);
    let mut state = BurnState::new(solver.mesh(), temperature, fuel).unwrap();
    solver.step(&mut state, &[], step).unwrap();
    state.into_parts().0
}

#[test]
fn a_flat_sheet_becomes_the_planar_delaunay_triangulation() {
    let sheet = irregular([16, 12], 0.2, 0.35, 21);
    let delaunay = delaunay(sheet.positions.clone());
    let [given, wanted] = [&sheet, &delaunay].map(Sheet::field);
    assert!(given.flips() > 20 && wanted.flips() == 0);
    for (v, area) in given.areas().iter() {
        assert!((area - wanted.areas()[v]).abs() < 1e-13);
    }
    let [given, wanted] = [&sheet, &delaunay].map(|sheet| conducted(sheet, 0.1));
    for (v, t) in given.iter() {
        assert!((t - wanted[v]).abs() < 1e-9, "{t} {}", wanted[v]);
    }
}

#[test]
fn area_and_vertices_stay() {
    let mut sheet = irregular([20, 20], 0.1, 0.4, 6);
    for x in &mut sheet.positions {
        // A shear, and a fold that bends it out of the plane.
        *x = Vector3::new(x.x + 4.0 * x.y, x.y, 0.3 * (2.0 * x.x).sin());
    }
    let field = sheet.field();
    assert!(field.flips() > 300);
    assert_eq!(field.vertex_count(), sheet.positions.len());
    assert_eq!(field.face_count(), sheet.mesh.face_count());
    let [flipped, given] = [
        field.areas().as_slice().iter().sum::<f64>(),
        face_areas(&sheet.mesh, &sheet.positions)
            .as_slice()
            .iter()
            .sum(),
    ];
    // Straight in the surface before and after, but its edges are bent where faces meet.
    assert!((flipped / given - 1.0).abs() < 1e-9, "{flipped} {given}");
}

#[test]
fn lengths_are_enough() {
    let sheet = irregular([9, 7], 0.2, 0.35, 3);
    let lengths = sheet.mesh.edges().as_slice().iter().map(|edge| {
        let [a, b] = edge.vertices.map(|v| sheet.positions[v.index()]);
        (b - a).norm()
    });
    let field = FieldMesh::from_lengths(&sheet.mesh, &lengths.collect()).unwrap();
    assert_eq!(field.areas(), sheet.field().areas());
    assert_eq!(field.flips(), sheet.field().flips());
}

#[test]
fn closed_surfaces_with_needles() {
    let octahedron = TriMesh::new(
        6,
        vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ],
    )
    .unwrap();
    let corners = PerVertex::filled(6, false);
    let fine = subdivide(&octahedron, 3, &corners);
    let mut positions = vec![Vector3::zeros(); 6];
    for (v, x) in positions.iter_mut().enumerate() {
        x[v / 2] = if v % 2 == 0 { 1.0 } else { -1.0 };
    }
    for stretch in [1.0, 5.0, 60.0] {
        let mut sheet = Sheet {
            mesh: fine.mesh.clone(),
            positions: fine.fine_from_coarse.apply(&positions),
        };
        sheet.positions.iter_mut().for_each(|x| x.z *= stretch);
        let field = sheet.field();
        println!(
            "stretch {stretch} flips {} clipped {}",
            field.flips(),
            field.clipped()
        );
        // No border: all weights end up positive.
        assert_eq!(field.clipped(), 0);
        assert!(stretch < 4.0 || field.flips() > 0);
        for step in [1e-3, 1.0, 1e5] {
            let temperatures = conducted(&sheet, step);
            let values = temperatures.as_slice();
            assert!(
                values
                    .iter()
                    .all(|t| (320.0 - 1e-9..=480.0 + 1e-9).contains(t))
            );
        }
    }
}

#[test]
fn obtuse_borders_are_clipped_and_counted() {
    // One flat triangle: nothing to flip, and the angle opposite its long edge is obtuse.
    let mesh = TriMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let positions = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.3]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let sheet = Sheet {
        mesh,
        positions: positions.to_vec(),
    };
    assert_eq!((sheet.field().clipped(), sheet.field().flips()), (1, 0));
    let temperatures = conducted(&sheet, 10.0);
    assert!(
        temperatures
            .as_slice()
            .iter()
            .all(|&t| t > 320.0 && t < 480.0)
    );
}
