//! Layers whose modulus, thickness and area change while they are solved.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod differences;
mod meshes;
mod pairs;

use differences::{MODELS, assembled};
use meshes::{Mesh, jittered, random_vector, rng, symmetric};
use nalgebra::{Matrix2, Vector3};
use ruga_shell::{
    BendingModel, FaceParameters, LayerEnergy, LayerParameters, MIN_AREA_LEFT, ShellError,
};

const FACE: FaceParameters = FaceParameters {
    young: 8.0,
    poisson: 0.4,
    thickness: 0.4,
    normal_stiffness: 1.5,
    gradient_stiffness: -0.4,
};

fn mesh() -> Mesh {
    jittered(7, 6, 1.0, 0.25, 41)
}

fn build(mesh: &Mesh, faces: Vec<FaceParameters>, model: BendingModel) -> LayerEnergy {
    let count = mesh.positions.len();
    let parameters = LayerParameters {
        faces,
        tangential_stiffness: vec![0.8; count],
    };
    let (topology, pinned) = (mesh.topology(), vec![false; count]);
    LayerEnergy::with_bending(&topology, &mesh.positions, parameters, &pinned, model).unwrap()
}

fn varied(count: usize) -> Vec<FaceParameters> {
    let mut rng = rng(42);
    let face = |_| FaceParameters {
        young: 8.0 + 4.0 * symmetric(&mut rng),
        poisson: 0.3 + 0.1 * symmetric(&mut rng),
        thickness: 0.4 + 0.1 * symmetric(&mut rng),
        normal_stiffness: 1.5 + symmetric(&mut rng),
        gradient_stiffness: 0.4 * symmetric(&mut rng),
    };
    (0..count).map(face).collect()
}

fn crumpled(mesh: &Mesh) -> Vec<Vector3<f64>> {
    let mut rng = rng(43);
    let positions = mesh.positions.iter();
    positions
        .map(|p| 0.95 * p + 0.1 * random_vector(&mut rng))
        .collect()
}

/// Energy, gradient and Hessian.
fn all(layer: &LayerEnergy, x: &[Vector3<f64>]) -> [Vec<f64>; 3] {
    let mut gradient = vec![0.0; layer.dof_count()];
    let mut hessian = vec![0.0; layer.pattern().1.len()];
    layer.gradient(x, &mut gradient);
    layer.hessian(x, &mut hessian, None);
    [vec![layer.value(x)], gradient, hessian]
}

#[test]
fn a_changed_layer_is_one_built_with_the_new_parameters() {
    let mesh = mesh();
    let x = crumpled(&mesh);
    let faces = varied(mesh.faces.len());
    for model in MODELS {
        let mut changed = build(&mesh, vec![FACE; mesh.faces.len()], model);
        // The foundation's matrix is kept from here on.
        all(&changed, &x);
        changed.set_face_parameters(&faces).unwrap();
        assert_eq!(
            all(&changed, &x),
            all(&build(&mesh, faces.clone(), model), &x)
        );
    }
}

#[test]
fn rest_shape_and_factor_outlive_a_change() {
    for model in MODELS {
        let (mut layer, x) = assembled(model);
        let count = layer.face_energies(&x, &x)[0].len();
        let strain = Matrix2::new(0.05, 0.01, 0.01, -0.03);
        layer.set_natural_strains(&vec![strain; count]).unwrap();
        layer.set_bending_factor(1.7).unwrap();
        layer.set_face_parameters(&vec![FACE; count]).unwrap();
        let before = all(&layer, &x);
        layer.set_face_parameters(&varied(count)).unwrap();
        assert_ne!(all(&layer, &x), before);
        layer.set_face_parameters(&vec![FACE; count]).unwrap();
        assert_eq!(all(&layer, &x), before);
    }
}

/// A share of the area everywhere is that share of the energy.
#[test]
fn what_is_left_of_the_area_scales_the_energy() {
    let mesh = mesh();
    let x = crumpled(&mesh);
    for model in MODELS {
        let mut layer = build(&mesh, vec![FACE; mesh.faces.len()], model);
        let whole = all(&layer, &x);
        let areas = layer.vertex_areas().to_vec();
        layer.set_area_left(&vec![0.25; mesh.faces.len()]).unwrap();
        for (found, whole) in all(&layer, &x).iter().flatten().zip(whole.iter().flatten()) {
            assert!((found - 0.25 * whole).abs() < 1e-12 * (1.0 + whole.abs()));
        }
        for (found, whole) in layer.vertex_areas().iter().zip(areas) {
            assert!((found - 0.25 * whole).abs() < 1e-14);
        }
    }
}

#[test]
fn a_face_that_is_partly_gone_has_a_share_of_its_energy() {
    let mesh = mesh();
    let x = crumpled(&mesh);
    let mut layer = build(&mesh, vec![FACE; mesh.faces.len()], MODELS[0]);
    layer.set_drift_gradient_stiffness(0.6).unwrap();
    let points = mesh.positions.clone();
    let energies = |layer: &LayerEnergy| layer.face_energies(&x, &points).swap_remove(0);
    let before = energies(&layer);
    let mut left = vec![1.0; mesh.faces.len()];
    left[17] = 0.1;
    layer.set_area_left(&left).unwrap();
    let after = energies(&layer);
    for (face, (before, after)) in before.iter().zip(&after).enumerate() {
        let share = left[face];
        for (before, after) in [
            (before.membrane, after.membrane),
            (before.normal, after.normal),
            (before.gradient, after.gradient),
            (before.tangential, after.tangential),
        ] {
            assert!((after - share * before).abs() < 1e-13, "face {face}");
        }
    }
    let sum: f64 = after.iter().map(ruga_shell::EnergyParts::total).sum();
    assert!((sum / layer.value(&x) - 1.0).abs() < 1e-12);
}

/// With all of it left again nothing has changed, and the two kinds of change do not meet.
#[test]
fn area_and_parameters_change_one_by_one() {
    let mesh = mesh();
    let x = crumpled(&mesh);
    let count = mesh.faces.len();
    let left: Vec<_> = (0..count)
        .map(|i| 0.1 + 0.9 * (i % 7) as f64 / 6.0)
        .collect();
    for model in MODELS {
        let [mut first, mut second] = [0, 1].map(|_| build(&mesh, vec![FACE; count], model));
        let before = all(&first, &x);
        first.set_area_left(&left).unwrap();
        first.set_face_parameters(&varied(count)).unwrap();
        second.set_face_parameters(&varied(count)).unwrap();
        second.set_area_left(&left).unwrap();
        assert_eq!(all(&first, &x), all(&second, &x));
        first.set_area_left(&vec![1.0; count]).unwrap();
        first.set_face_parameters(&vec![FACE; count]).unwrap();
        assert_eq!(all(&first, &x), before);
    }
}

#[test]
fn bad_changes_are_named_and_change_nothing() {
    let mesh = mesh();
    let x = crumpled(&mesh);
    let count = mesh.faces.len();
    let mut layer = build(&mesh, vec![FACE; count], MODELS[1]);
    let before = all(&layer, &x);
    let mut faces = vec![FACE; count];
    faces[5].thickness = 0.0;
    assert!(matches!(
        layer.set_face_parameters(&faces),
        Err(ShellError::ParameterOutOfRange {
            index: 5,
            name: "thickness",
            ..
        })
    ));
    assert!(matches!(
        layer.set_face_parameters(&faces[1..]),
        Err(ShellError::LengthMismatch { .. })
    ));
    for value in [0.0, 0.99 * MIN_AREA_LEFT, 1.1, -1.0, f64::NAN] {
        let mut left = vec![1.0; count];
        left[9] = value;
        let error = layer.set_area_left(&left).unwrap_err();
        assert!(matches!(
            error,
            ShellError::ParameterOutOfRange {
                index: 9,
                name: "area left",
                ..
            }
        ));
        assert!(error.to_string().contains("0.02"), "{error}");
    }
    assert_eq!(all(&layer, &x), before);

    let (mut pair, _) = pairs::thick().build(4, 4, 1e-3);
    let faces = pair.face_energies(
        &vec![Vector3::zeros(); pair.vertex_count()],
        &vec![Vector3::zeros(); pair.vertex_count() / 2],
    )[0]
    .len();
    for error in [
        pair.set_face_parameters(&vec![FACE; faces]).unwrap_err(),
        pair.set_area_left(&vec![1.0; faces]).unwrap_err(),
    ] {
        assert!(matches!(error, ShellError::PairOfSheets { .. }), "{error}");
    }
}
