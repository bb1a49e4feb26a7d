//! Welding, checks and blending of the artist's mesh.

mod patch;

use nalgebra::{Vector2, Vector3};
use patch::{patch, shape};
use ruga_blend::{ArtistMesh, BlendError, Driver, Weights};
use ruga_mesh::{MeshError, VertexId};

/// Two triangles that share an edge in space but not in UV.
fn seam() -> ArtistMesh {
    let p = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    ArtistMesh {
        name: "seam".into(),
        positions: vec![
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(1.0, 0.0),
            p(1.0, 1.0),
            p(-0.0, 1.0),
        ],
        uvs: Some(
            (0..6)
                .map(|i| Vector2::new(0.1 * f64::from(i), 0.0))
                .collect(),
        ),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        ..ArtistMesh::default()
    }
}

#[test]
fn seam_is_welded_and_keeps_both_uvs() {
    let driver = Driver::new(&seam()).unwrap();
    assert_eq!(driver.rest().len(), 4);
    assert_eq!(driver.topology().edges().len(), 5);
    assert_eq!(driver.welded()[3], VertexId(1));
    assert_eq!(driver.uvs().as_slice()[1][0].x, 0.1 * 3.0);
}

#[test]
fn lips_that_touch_at_rest_stay_apart() {
    let mut mesh = seam();
    let mut opening = vec![Vector3::zeros(); 6];
    opening[3].z = 0.1;
    opening[5].z = 0.1;
    mesh.shapes.push(shape("open", opening));
    let driver = Driver::new(&mesh).unwrap();
    assert_eq!(driver.rest().len(), 6);
}

#[test]
fn triangles_without_area_are_left_out_and_listed() {
    let mut mesh = seam();
    mesh.positions.push(Vector3::new(0.5, 0.0, 0.0));
    mesh.uvs.as_mut().unwrap().push(Vector2::zeros());
    mesh.triangles.insert(0, [0, 6, 1]);
    mesh.triangles.push([1, 3, 4]);
    let driver = Driver::new(&mesh).unwrap();
    assert_eq!(driver.degenerate_triangles(), [0, 3]);
    assert_eq!(driver.triangles().as_slice(), [1, 2]);
}

#[test]
fn errors_name_the_files_triangles() {
    let mut mesh = seam();
    mesh.triangles.insert(0, [0, 0, 1]);
    mesh.triangles.push([2, 0, 1]);
    let error = Driver::new(&mesh).unwrap_err();
    let BlendError::Topology { source, .. } = &error else {
        panic!("{error}");
    };
    assert!(matches!(
        source,
        MeshError::DuplicateFaces { first, second } if first.0 == 1 && second.0 == 3
    ));
    mesh.triangles[3] = [1, 2, 4];
    let error = Driver::new(&mesh).unwrap_err().to_string();
    assert!(error.contains("mesh 'seam'"), "{error}");
}

#[test]
fn bad_arrays_are_refused() {
    let mut mesh = seam();
    mesh.uvs = None;
    assert!(matches!(
        Driver::new(&mesh),
        Err(BlendError::MissingUvs { .. })
    ));
    let mut mesh = seam();
    mesh.positions[4].y = f64::NAN;
    assert!(matches!(
        Driver::new(&mesh),
        Err(BlendError::NotFinite { vertex: 4, .. })
    ));
    let mut mesh = seam();
    mesh.shapes.push(shape("short", vec![Vector3::zeros(); 5]));
    assert!(matches!(
        Driver::new(&mesh),
        Err(BlendError::Length {
            found: 5,
            expected: 6,
            ..
        })
    ));
    let mut mesh = seam();
    mesh.triangles[1][2] = 6;
    assert!(matches!(
        Driver::new(&mesh),
        Err(BlendError::Topology { .. })
    ));
    let mut mesh = seam();
    mesh.triangles.clear();
    assert!(matches!(
        Driver::new(&mesh),
        Err(BlendError::NoTriangles { .. })
    ));
}

type Break = fn(&mut ArtistMesh, Vector3<f64>);

#[test]
fn numbers_that_are_none_are_refused_where_they_are() {
    let shaped = || {
        let mut mesh = seam();
        mesh.normals = Some(vec![Vector3::z(); 6]);
        mesh.shapes.push(shape("open", vec![Vector3::x(); 6]));
        mesh.shapes[0].normal_deltas = Some(vec![Vector3::zeros(); 6]);
        mesh
    };
    assert!(Driver::new(&shaped()).is_ok());
    let cases: [(&str, Break); 5] = [
        ("position", |mesh, bad| mesh.positions[2] = bad),
        ("normal", |mesh, bad| {
            mesh.normals.as_mut().unwrap()[2] = bad
        }),
        ("open", |mesh, bad| mesh.shapes[0].position_deltas[2] = bad),
        ("normal delta of open", |mesh, bad| {
            mesh.shapes[0].normal_deltas.as_mut().unwrap()[2] = bad;
        }),
        ("texture coordinate", |mesh, bad| {
            mesh.uvs.as_mut().unwrap()[2] = bad.xy();
        }),
    ];
    for (what, set) in cases {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut mesh = shaped();
            set(&mut mesh, Vector3::new(0.5, bad, 0.0));
            let error = Driver::new(&mesh).unwrap_err().to_string();
            let said = format!("mesh 'seam': {what} of vertex 2 is not finite");
            assert_eq!(error, said);
        }
    }
    let mut mesh = shaped();
    mesh.normals = Some(vec![Vector3::z(); 5]);
    let error = Driver::new(&mesh).unwrap_err().to_string();
    assert!(
        error.contains("normal has 5 entries, but there are 6"),
        "{error}"
    );
}

#[test]
fn weights_that_are_no_numbers_are_refused_by_name() {
    let mut mesh = seam();
    mesh.shapes.push(shape("open", vec![Vector3::x(); 6]));
    let driver = Driver::new(&mesh).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = driver.weights([("open", 0.5), ("open", bad)]).unwrap_err();
        assert!(matches!(error, BlendError::WeightNotFinite { .. }));
        let said =
            format!("the weight of blend shape 'open' is {bad}, but must be a finite number");
        assert_eq!(error.to_string(), said);
    }
    let twice = driver.weights([("open", 0.5), ("open", 0.25)]).unwrap();
    assert_eq!(twice.iter().collect::<Vec<_>>(), [(0, 0.5), (0, 0.25)]);
    assert_eq!(
        driver.pose(&twice)[0],
        driver.rest()[0] + Vector3::x() * 0.75
    );
}

#[test]
#[should_panic(expected = "weights times NaN")]
fn a_pose_is_not_scaled_by_what_is_no_number() {
    let _ = Weights::default().scaled(f64::NAN);
}

#[test]
fn unknown_shape_suggests_the_nearest() {
    let mut mesh = seam();
    mesh.shapes
        .push(shape("browInnerUp_L", vec![Vector3::x(); 6]));
    let driver = Driver::new(&mesh).unwrap();
    let error = driver.weights([("browInerUp_L", 1.0)]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "blend shape 'browInerUp_L' is none of the 1 that the mesh has (did you mean `browInnerUp_L`?)"
    );
    let error = driver.weights([("zzz", 1.0)]).unwrap_err().to_string();
    assert!(
        error.ends_with("is none of the 1 that the mesh has"),
        "{error}"
    );
}

#[test]
fn shapes_add_up_linearly() {
    let mut mesh = seam();
    mesh.shapes.push(shape("up", vec![Vector3::z(); 6]));
    mesh.shapes.push(shape("along", vec![Vector3::x(); 6]));
    let driver = Driver::new(&mesh).unwrap();
    let weights = driver.weights([("along", 0.5), ("up", 2.0)]).unwrap();
    let posed = driver.pose(&weights.scaled(0.5));
    assert_eq!(posed[1], Vector3::new(1.25, 0.0, 1.0));
    assert_eq!(driver.pose(&Weights::default()), driver.rest());
}

#[test]
fn only_corners_of_a_patch_are_sharp() {
    let driver = Driver::new(&patch(6, 6)).unwrap();
    let sharp = driver.corners().as_slice().iter().filter(|c| **c).count();
    assert_eq!(sharp, 4);
}
