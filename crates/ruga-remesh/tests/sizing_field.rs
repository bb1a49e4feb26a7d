//! What shape, motion and driver ask for, against closed forms.

mod shapes;

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{Id, PerFace, PerVertex, VertexId};
use ruga_remesh::{
    FaceDriver, Refinement, RemeshSettings, SizeLimits, Sizing, SizingInput, SurfaceMesh, remesh,
    size_tensor, sizing_field,
};
use shapes::{Shape, Sheet, grid, square_from_address};

fn input<'a>(mesh: &'a SurfaceMesh, shape: &'a [Vector3<f64>]) -> SizingInput<'a> {
    SizingInput {
        mesh,
        shape,
        driver: None,
        refinement: Refinement::default(),
    }
}

/// Wanted lengths along x and y at the vertex nearest to the middle of the square.
fn lengths_in_the_middle(mesh: &SurfaceMesh, sizing: &Sizing) -> [f64; 2] {
    let middle = |v: &VertexId| {
        let [x, y] = square_from_address(mesh.points[*v]);
        (x - 0.5).powi(2) + (y - 0.5).powi(2)
    };
    let nearest = mesh
        .points
        .ids()
        .min_by(|l, r| middle(l).total_cmp(&middle(r)));
    let tensor = sizing.tensors[nearest.expect("the mesh is not empty")];
    [Vector3::x(), Vector3::y()].map(|axis| axis.dot(&(tensor * axis)).powf(-0.5))
}

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value / expected - 1.0).abs() < tolerance,
        "{value} instead of {expected}"
    );
}

#[test]
fn a_bent_sheet_asks_for_edges_by_its_radius() {
    let mesh = grid(Shape::Flat, 40, 0.0, 4);
    let bent: Vec<Vector3<f64>> = mesh
        .points
        .as_slice()
        .iter()
        .map(|&p| Shape::Cylinder.point(square_from_address(p)))
        .collect();
    let sizing = sizing_field(&input(&mesh, &bent)).expect("valid input");
    let [across, along] = lengths_in_the_middle(&mesh, &sizing);
    // Radius 2/pi: a turn of 0.3 takes 0.3 radii.
    close(across, 0.3 * 2.0 / std::f64::consts::PI, 0.02);
    assert!(along > 10.0 * across, "{along}");
}

#[test]
fn an_unchanged_flat_sheet_asks_for_nothing() {
    let mesh = grid(Shape::Flat, 10, 0.2, 4);
    let input = input(&mesh, mesh.positions.as_slice());
    let sizing = sizing_field(&input).expect("valid input");
    // What rounding makes of gradients, edges of 10 m and more on a sheet of 1 m.
    assert!(
        sizing
            .tensors
            .as_slice()
            .iter()
            .all(|tensor| tensor.norm() < 1e-2)
    );
}

/// Wanted lengths under a uniform driver with the given principal compressions along x and y.
fn driven(e1: f64, e2: f64, shape_angle: f64) -> [f64; 2] {
    let mesh = grid(Shape::Flat, 12, 0.0, 4);
    let driver = FaceDriver {
        compression: Matrix3::from_diagonal(&Vector3::new(e1, e2, 0.0)),
        wavelength: 0.24,
        critical_strain: 0.1,
        poisson: 0.5,
    };
    let drivers = PerFace::filled(mesh.mesh.face_count(), driver);
    let mut input = input(&mesh, mesh.positions.as_slice());
    let bent: Vec<Vector3<f64>> = mesh
        .points
        .as_slice()
        .iter()
        .map(|&p| Shape::Cylinder.point(square_from_address(p)))
        .collect();
    input.shape = &bent;
    input.driver = Some(&drivers);
    input.refinement.angle = shape_angle;
    lengths_in_the_middle(&mesh, &sizing_field(&input).expect("valid input"))
}

#[test]
fn near_critical_compression_asks_for_a_twelfth_of_a_wavelength_across() {
    let [across, along] = driven(0.1, 0.0, 1e3);
    close(across, 0.02, 1e-6);
    assert!(along > 10.0, "coarse along the wrinkles: {along}");
    // 0.1 - 0.5 * 0.1 = 0.05, half of critical: the second strain counts.
    let [across, _] = driven(0.1, -0.1, 1e3);
    assert!(across > 1.0, "{across}");
    let [across, along] = driven(0.08, 0.08, 1e3);
    close(across, 0.02, 1e-6);
    close(along, 0.02, 1e-6);
    // Halfway up the smooth step.
    let [across, _] = driven(0.07, 0.0, 1e3);
    close(across, 0.02 * 2f64.sqrt(), 1e-6);
}

/// Where the first direction wrinkles it gives way, and Poisson's ratio drives the second no
/// further than half of critical.
#[test]
fn skin_squeezed_one_way_is_fine_one_way() {
    let [across, along] = driven(0.4, 0.0, 1e3);
    close(across, 0.02, 1e-6);
    assert!(along > 1.0, "{along}");
    let [across, along] = driven(0.4, 0.3, 1e3);
    close(across, 0.02, 1e-6);
    close(along, 0.02, 1e-6);
}

#[test]
fn the_wavelength_bounds_what_curvature_asks_for() {
    let [across, along] = driven(0.0, 0.0, 1e-2);
    close(across, 0.02, 1e-6);
    assert!(along > 1.0, "{along}");
}

#[test]
fn directions_that_disagree_do_not_coarsen_each_other() {
    let mesh = grid(Shape::Flat, 12, 0.0, 4);
    let drivers: PerFace<FaceDriver> = (0..mesh.mesh.face_count())
        .map(|f| FaceDriver {
            compression: if f % 2 == 0 {
                Matrix3::from_diagonal(&Vector3::new(0.1, 0.0, 0.0))
            } else {
                Matrix3::from_diagonal(&Vector3::new(0.0, 0.1, 0.0))
            },
            wavelength: 0.24,
            critical_strain: 0.1,
            poisson: 0.5,
        })
        .collect();
    let mut input = input(&mesh, mesh.positions.as_slice());
    input.driver = Some(&drivers);
    let [x, y] = lengths_in_the_middle(&mesh, &sizing_field(&input).expect("valid input"));
    close(x, 0.02, 0.2);
    close(y, 0.02, 0.2);
}

/// Wanted lengths in the two principal directions at every vertex.
fn principal_lengths(sizing: &Sizing) -> Vec<[f64; 2]> {
    let lengths = |tensor: &Matrix3<f64>| {
        let mut values: Vec<f64> = tensor.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        [values[2].powf(-0.5), values[1].powf(-0.5)]
    };
    sizing.tensors.as_slice().iter().map(lengths).collect()
}

#[test]
fn limits_hold_lengths_and_aspect() {
    let mesh = grid(Shape::Sphere, 15, 0.2, 8);
    let limits = SizeLimits {
        min_edge: 0.01,
        max_edge: 0.5,
        aspect: 3.0,
        ..SizeLimits::default()
    };
    for edges in [[0.001, 0.002], [2.0, 30.0], [0.02, 0.3], [0.003, 3.0]] {
        let tensors = mesh
            .points
            .as_slice()
            .iter()
            .map(|&p| {
                let normal = Shape::Sphere.normal(square_from_address(p));
                size_tensor(normal, Vector3::y(), edges[0], edges[1]).expect("a tangent direction")
            })
            .collect();
        let limited = Sizing { tensors }
            .limited(&mesh, &Sheet(Shape::Sphere), &limits)
            .expect("valid input");
        for [short, long] in principal_lengths(&limited) {
            // Up to 2 % beyond a limit is left alone.
            assert!(
                short > 0.0098 && long < 0.511 && long < 3.0 * 1.021 * short,
                "{short} {long}"
            );
        }
    }
}

#[test]
fn grading_limits_the_growth_of_edges_around_a_fine_place() {
    let mesh = grid(Shape::Flat, 100, 0.1, 3);
    let tensors: PerVertex<Matrix3<f64>> = mesh
        .positions
        .iter()
        .map(|(_, p)| {
            let is_fine = (p.x - 0.5).hypot(p.y - 0.5) < 0.02;
            Matrix3::identity() / if is_fine { 1e-4 } else { 1.0 }
        })
        .collect();
    let sizing = Sizing { tensors };
    let limits = |grading| SizeLimits {
        grading,
        ..SizeLimits::default()
    };
    let sheet = Sheet(Shape::Flat);
    let graded = sizing
        .limited(&mesh, &sheet, &limits(0.3))
        .expect("valid input");
    let lengths = principal_lengths(&graded);
    for (v, p) in mesh.positions.iter() {
        let distance = (p.x - 0.5).hypot(p.y - 0.5) - 0.02;
        // Wanted length 0.01 m at the place, growing by 0.3 m per metre away from it; the slack
        // of a quarter of that makes it a little more.
        let most = 0.01 + 0.3 * distance.max(0.0);
        let long = lengths[v.index()][1];
        assert!(
            long < 1.3 * most && (long > 0.7 * most || distance < 0.02),
            "{long} {most}"
        );
    }
    let wild = sizing
        .limited(&mesh, &sheet, &limits(f64::INFINITY))
        .expect("valid input");
    let is_coarse = |lengths: &&[f64; 2]| lengths[1] > 0.9;
    let kept = principal_lengths(&wild).iter().filter(is_coarse).count();
    assert!(kept > 10_000 && lengths.iter().filter(is_coarse).count() == 0);
}

#[test]
fn the_vertex_estimate_is_kept() {
    let mesh = grid(Shape::Cylinder, 10, 0.2, 3);
    for (edge, direction) in [(0.05, Vector3::y()), (0.02, Vector3::new(0.0, 1.0, 0.3))] {
        let tensors = mesh
            .points
            .as_slice()
            .iter()
            .map(|&p| {
                let normal = Shape::Cylinder.normal(square_from_address(p));
                size_tensor(normal, direction, edge, 1.7 * edge).expect("a tangent direction")
            })
            .collect();
        let sizing = Sizing { tensors };
        let sheet = Sheet(Shape::Cylinder);
        let estimate = sizing.vertex_estimate(&mesh).expect("fits") as f64;
        let result = remesh(&mesh, &sizing, &sheet, &RemeshSettings::default());
        let count = result.expect("valid").mesh.mesh.vertex_count() as f64;
        close(count, estimate, 0.2);
    }
}
