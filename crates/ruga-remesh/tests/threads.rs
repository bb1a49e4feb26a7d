//! Large meshes are the same on any number of threads.

mod shapes;

use nalgebra::Matrix3;
use rayon::ThreadPoolBuilder;
use ruga_remesh::{
    FaceDriver, Refinement, RemeshSettings, Remeshed, Sizing, SizingInput, remesh, sizing_field,
};
use shapes::{Shape, Sheet, Waves, grid};

/// What is made on so many threads.
fn on_threads<T: Send>(threads: usize, made: impl Fn() -> T + Sync) -> T {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a few threads").install(&made)
}

/// A coarse grid made fine.
fn refined() -> Remeshed {
    let mesh = grid(Shape::Cylinder, 20, 0.2, 1);
    let sizing = Waves {
        edge: 0.006,
        range: 3.0,
        aspect: 2.0,
        seed: 2,
    }
    .sizing(&mesh);
    let surface = Sheet(Shape::Cylinder);
    remesh(&mesh, &sizing, &surface, &RemeshSettings::default()).expect("valid input")
}

#[test]
fn threads_do_not_change_a_large_mesh() {
    let (one, three) = (on_threads(1, refined), on_threads(3, refined));
    assert!(one.mesh.mesh.vertex_count() > 1 << 14);
    assert!(one.report.converged, "{:?}", one.report);
    assert_eq!(one.report, three.report);
    let faces = |made: &Remeshed| made.mesh.mesh.faces().as_slice().to_vec();
    assert!(faces(&one) == faces(&three));
    assert!(one.mesh.positions.as_slice() == three.mesh.positions.as_slice());
    assert!(one.mesh.features.as_slice() == three.mesh.features.as_slice());
    assert!(one.transfer.origins.as_slice() == three.transfer.origins.as_slice());
    assert!(one.sizing == three.sizing);
}

/// The sizing that waves across a grid ask for.
fn sized() -> Sizing {
    let mesh = grid(Shape::Sphere, 130, 0.2, 1);
    let face = |number: usize| FaceDriver {
        compression: Matrix3::identity() * (0.1 + 1e-6 * number as f64),
        wavelength: 0.02,
        critical_strain: 0.1,
        poisson: 0.4,
    };
    let drivers = (0..mesh.mesh.face_count()).map(face).collect();
    let sizing = sizing_field(&SizingInput {
        mesh: &mesh,
        shape: mesh.positions.as_slice(),
        driver: Some(&drivers),
        refinement: Refinement::default(),
    });
    sizing.expect("valid input")
}

#[test]
fn threads_do_not_change_a_large_sizing() {
    assert!(on_threads(1, sized) == on_threads(3, sized));
}
