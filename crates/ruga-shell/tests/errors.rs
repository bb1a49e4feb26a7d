//! Bad input is refused by name, with the number that is at fault.

use nalgebra::{Matrix2, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{
    BendingModel, FaceParameters, LayerEnergy, LayerParameters, ResponseQuery, ShellError,
    face_corners, response_modulus,
};

const FACE: FaceParameters = FaceParameters {
    young: 1.0,
    poisson: 0.3,
    thickness: 1.0,
    normal_stiffness: 1.0,
    gradient_stiffness: 0.0,
};
const FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn square() -> Vec<Vector3<f64>> {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|[x, y]| Vector3::new(x, y, 0.0))
        .to_vec()
}

fn mesh(faces: &[[u32; 3]]) -> TriMesh {
    TriMesh::new(4, faces.to_vec()).expect("a valid mesh")
}

fn build(
    positions: &[Vector3<f64>],
    faces: &[[u32; 3]],
    face: FaceParameters,
) -> Result<LayerEnergy, ShellError> {
    let parameters = LayerParameters::uniform(face, faces.len(), 1.0, 4);
    LayerEnergy::new(&mesh(faces), positions, parameters, &[false; 4])
}

#[test]
fn meshes() {
    let error = |positions: &[Vector3<f64>], faces: &[[u32; 3]]| {
        build(positions, faces, FACE).map(|_| ()).unwrap_err()
    };
    assert_eq!(
        error(&square()[1..], &FACES),
        ShellError::LengthMismatch {
            what: "rest positions",
            expected: 4,
            found: 3
        }
    );
    assert_eq!(
        error(&square(), &[[0, 1, 2]]),
        ShellError::IsolatedVertex { vertex: 3 }
    );
    let mut thin = square();
    thin[2] = Vector3::new(2.0, 1e-9, 0.0);
    assert!(matches!(
        error(&thin, &[[0, 1, 2], [0, 2, 3]]),
        ShellError::DegenerateFace { face: 0, .. }
    ));
    let mut lost = square();
    lost[1].y = f64::NAN;
    assert_eq!(
        error(&lost, &FACES),
        ShellError::NotFinite {
            what: "rest position",
            vertex: 1
        }
    );
}

#[test]
fn parameters() {
    let name = |face: FaceParameters| match build(&square(), &FACES, face) {
        Err(ShellError::ParameterOutOfRange { name, .. }) => name,
        other => panic!("expected a refusal, got {:?}", other.map(|_| ())),
    };
    assert_eq!(name(FaceParameters { young: 0.0, ..FACE }), "young");
    assert_eq!(
        name(FaceParameters {
            poisson: 0.6,
            ..FACE
        }),
        "poisson"
    );
    assert_eq!(
        name(FaceParameters {
            thickness: f64::NAN,
            ..FACE
        }),
        "thickness"
    );
    assert_eq!(
        name(FaceParameters {
            normal_stiffness: -1.0,
            ..FACE
        }),
        "normal_stiffness"
    );
    let infinite = FaceParameters {
        gradient_stiffness: f64::INFINITY,
        ..FACE
    };
    assert_eq!(name(infinite), "gradient_stiffness");
}

#[test]
fn a_refused_pose_leaves_the_layer_as_it_was() {
    let mut layer = build(&square(), &FACES, FACE).unwrap();
    let x: Vec<_> = square().iter().map(|p| 1.1 * p + Vector3::z()).collect();
    let before = layer.value(&x);
    let up = vec![Vector3::z(); 4];
    assert_eq!(
        layer.set_base(&square(), &up, &[0.0; 3]).unwrap_err(),
        ShellError::LengthMismatch {
            what: "base offsets",
            expected: 4,
            found: 3
        }
    );
    let long = vec![Vector3::new(0.0, 0.0, 2.0); 4];
    assert_eq!(
        layer.set_base(&square(), &long, &[0.0; 4]).unwrap_err(),
        ShellError::NormalNotUnit {
            vertex: 0,
            length: 2.0
        }
    );
    assert_eq!(
        layer
            .set_base(&square(), &up, &[0.0, f64::NAN, 0.0, 0.0])
            .unwrap_err(),
        ShellError::NotFinite {
            what: "base offset",
            vertex: 1
        }
    );
    let flipped = [Matrix2::identity(), Matrix2::new(-1.0, 0.0, 0.0, 1.0)];
    assert_eq!(
        layer.set_rest_metric(&flipped).unwrap_err(),
        ShellError::InvertedStretch {
            face: 1,
            determinant: -1.0
        }
    );
    assert_eq!(layer.value(&x), before);
}

#[test]
fn response_queries() {
    let corners = face_corners(&mesh(&FACES), &square());
    let directions = [Vector3::x(); 2];
    let query = ResponseQuery {
        mesh: &mesh(&FACES),
        corners: &corners,
        directions: &directions,
        fixed: &[false; 4],
        bending_modulus: 1.0,
        poisson: 0.48,
        bending_model: BendingModel::Hinge,
        hinge_exponent: 0.5,
        normal_stiffness: 1.0,
        gradient_stiffness: 0.0,
    };
    assert!(response_modulus(&query).is_ok());
    let across = [Vector3::x(), Vector3::z()];
    let error = |query: ResponseQuery| response_modulus(&query).unwrap_err();
    assert_eq!(
        error(ResponseQuery {
            directions: &across,
            ..query
        }),
        ShellError::NoDirection { face: 1 }
    );
    for unstable in [
        ResponseQuery {
            gradient_stiffness: -1e3,
            ..query
        },
        ResponseQuery {
            fixed: &[true; 4],
            ..query
        },
    ] {
        assert!(matches!(error(unstable), ShellError::UnstableSheet { .. }));
    }
    for poisson in [-1.0, 1.1, f64::NAN] {
        assert!(matches!(
            error(ResponseQuery { poisson, ..query }),
            ShellError::ParameterOutOfRange {
                name: "poisson",
                ..
            }
        ));
    }
    let negative = ResponseQuery {
        normal_stiffness: -1.0,
        ..query
    };
    assert!(matches!(
        error(negative),
        ShellError::ParameterOutOfRange { .. }
    ));
}

/// Normals computed around a lost point are lost at every vertex near it; the point is to blame.
#[test]
fn a_lost_point_is_blamed_and_not_its_neighbours() {
    let mut layer = build(&square(), &FACES, FACE).unwrap();
    let not_finite = |what, vertex| ShellError::NotFinite { what, vertex };
    let up = vec![Vector3::z(); 4];
    let lost = vec![Vector3::repeat(f64::NAN); 4];
    for bad in [f64::NAN, f64::INFINITY] {
        let mut points = square();
        points[2].y = bad;
        let error = layer.set_base(&points, &lost, &[f64::NAN; 4]).unwrap_err();
        assert_eq!(error, not_finite("base point", 2));
        let said = "the base point of vertex 2 is not finite";
        assert_eq!(error.to_string(), said);
        assert_eq!(
            layer.set_rest_angles(&points).unwrap_err(),
            not_finite("position", 2)
        );

        let mut normals = up.clone();
        normals[3].x = bad;
        let error = layer.set_base(&square(), &normals, &[0.0; 4]).unwrap_err();
        assert_eq!(error, not_finite("base normal", 3));
    }
    let far = [0.0, 0.0, f64::MAX, 0.0];
    let mut points = square();
    points[2].z = f64::MAX;
    let error = layer.set_base(&points, &up, &far).unwrap_err();
    assert_eq!(error, not_finite("base point with offset", 2));

    let mut corners = face_corners(&mesh(&FACES), &square());
    corners[1][1].z = f64::NAN;
    let query = ResponseQuery {
        mesh: &mesh(&FACES),
        corners: &corners,
        directions: &[Vector3::x(); 2],
        fixed: &[false; 4],
        bending_modulus: 1.0,
        poisson: 0.48,
        bending_model: BendingModel::Hinge,
        hinge_exponent: 0.5,
        normal_stiffness: 1.0,
        gradient_stiffness: 0.0,
    };
    let error = response_modulus(&query).unwrap_err();
    assert_eq!(error, not_finite("rest position", 2));
}

#[test]
fn strains_and_stiffnesses_that_are_no_numbers_are_refused() {
    let mut layer = build(&square(), &FACES, FACE).unwrap();
    let x: Vec<_> = square().iter().map(|p| 1.1 * p).collect();
    let before = layer.value(&x);
    let mut strains = [Matrix2::zeros(); 2];
    strains[1].m21 = f64::NAN;
    assert!(matches!(
        layer.set_natural_strains(&strains),
        Err(ShellError::ParameterOutOfRange {
            index: 1,
            name: "natural strain",
            ..
        })
    ));
    assert_eq!(layer.value(&x), before);

    let overflow = FaceParameters {
        young: 1e300,
        thickness: 1e10,
        ..FACE
    };
    let error = build(&square(), &FACES, overflow).map(|_| ()).unwrap_err();
    assert!(
        error.to_string().contains("E h/(1 - nu^2) = inf"),
        "{error}"
    );
    let vanishing = FaceParameters {
        young: 1.0,
        thickness: 1e-150,
        ..FACE
    };
    let error = build(&square(), &FACES, vanishing).map(|_| ()).unwrap_err();
    assert!(
        error.to_string().contains("E h^3/12(1 - nu^2) = 0"),
        "{error}"
    );
}
