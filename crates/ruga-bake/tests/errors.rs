//! Wrong input is refused by name; nothing panics, nothing turns into NaN.

mod patch;

use nalgebra::{Vector2, Vector3};
use patch::{Driver, Patch, waves};
use ruga_bake::{
    BakeError, BakeSettings, HEIGHT_MID, WrinkleMap, bake, height_to_u16, tangent_frames,
    vertex_tangents,
};

const SETTINGS: BakeSettings = BakeSettings {
    size: 32,
    supersample: 1,
    frame: ruga_bake::Frame::Driver,
};

fn small() -> Patch {
    Patch::new(Driver::Flat, [4, 2], 0.0, waves)
}

fn result(patch: &Patch) -> Result<WrinkleMap, BakeError> {
    bake(&patch.relief(), &patch.frames, &SETTINGS)
}

#[test]
fn settings_out_of_range() {
    let patch = small();
    for size in [0, 16385] {
        let settings = BakeSettings { size, ..SETTINGS };
        let error = bake(&patch.relief(), &patch.frames, &settings).unwrap_err();
        assert_eq!(error, BakeError::Size(size));
    }
    for supersample in [0, 3, 8] {
        let settings = BakeSettings {
            supersample,
            ..SETTINGS
        };
        let error = bake(&patch.relief(), &patch.frames, &settings).unwrap_err();
        assert_eq!(error, BakeError::Supersample(supersample));
    }
}

#[test]
fn nan_is_named_with_its_element() {
    let break_at = |change: &dyn Fn(&mut Patch)| {
        let mut patch = small();
        change(&mut patch);
        result(&patch).unwrap_err()
    };
    let not_finite = |array, index| BakeError::NotFinite { array, index };
    assert_eq!(
        break_at(&|p| p.positions[7].y = f64::NAN),
        not_finite("positions", 7)
    );
    assert_eq!(
        break_at(&|p| p.driver_positions[3].x = f64::INFINITY),
        not_finite("driver_positions", 3)
    );
    assert_eq!(
        break_at(&|p| p.driver_normals[5].z = f64::NAN),
        not_finite("driver_normals", 5)
    );
    assert_eq!(
        break_at(&|p| p.uvs[4][2].y = f64::NAN),
        not_finite("uvs", 4)
    );
    assert_eq!(
        break_at(&|p| p.artist[9].1[1][2] = f64::NAN),
        not_finite("artist", 9)
    );
    assert_eq!(
        break_at(&|p| p.frames[1][0].tangent.x = f64::NAN),
        not_finite("frames", 1)
    );
    assert_eq!(break_at(&|p| p.offset = f64::NAN), not_finite("offset", 0));
}

#[test]
fn indices_lengths_and_normals() {
    let mut patch = small();
    patch.faces[3][1] = 25;
    let error = result(&patch).unwrap_err();
    assert_eq!(
        error.to_string(),
        "faces[3] refers to 25, but there are only 25"
    );
    let mut patch = small();
    patch.artist[6].0 = 8;
    let error = result(&patch).unwrap_err();
    assert_eq!(
        error.to_string(),
        "artist[6] refers to 8, but there are only 8"
    );
    let mut patch = small();
    patch.driver_normals.pop();
    let error = result(&patch).unwrap_err();
    assert_eq!(
        error.to_string(),
        "driver_normals has 24 elements, expected 25"
    );
    let mut patch = small();
    patch.driver_normals[2] *= 0.5;
    assert!(matches!(
        result(&patch),
        Err(BakeError::NotUnit { index: 2, .. })
    ));
}

#[test]
fn frames_of_a_broken_mesh() {
    let positions = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let normals = [Vector3::z(); 3];
    let uvs = [Vector2::zeros(); 3];
    let frames = |p: &[Vector3<f64>], t: &[[u32; 3]]| tangent_frames(p, &normals, &uvs, t);
    assert!(matches!(
        frames(&positions, &[[0, 1, 3]]),
        Err(BakeError::IndexOutOfRange { value: 3, .. })
    ));
    assert!(matches!(
        frames(&positions[..2], &[]),
        Err(BakeError::LengthMismatch { .. })
    ));
    assert!(matches!(
        vertex_tangents(&[], &[[0, 1, 2]], 3),
        Err(BakeError::LengthMismatch { .. })
    ));
    // All UVs equal: no direction to follow, but unit frames all the same.
    let frames = frames(&positions, &[[0, 1, 2]]).unwrap();
    for frame in frames[0] {
        assert!((frame.tangent.norm() - 1.0).abs() < 1e-6);
        assert!(frame.tangent.dot(&frame.normal).abs() < 1e-6);
    }
}

#[test]
fn crushed_folded_and_lonely_faces_give_finite_unit_normals() {
    let crushed = |p: Vector3<f64>| Vector3::new(p.x, 0.0, 0.0);
    let folded =
        |p: Vector3<f64>| Vector3::new(0.02 * (400.0 * p.x).sin(), p.y, 0.02 * (400.0 * p.x).cos());
    let one_point = |_: Vector3<f64>| Vector3::zeros();
    let shapes: [&dyn Fn(Vector3<f64>) -> Vector3<f64>; 3] = [&crushed, &folded, &one_point];
    for (index, shape) in shapes.iter().enumerate() {
        for driver_too in [false, true] {
            let mut patch = Patch::new(Driver::Cylinder(0.04), [24, 2], 0.0, waves);
            patch.positions.iter_mut().for_each(|p| *p = shape(*p));
            if driver_too {
                patch
                    .driver_positions
                    .iter_mut()
                    .for_each(|p| *p = shape(*p));
            }
            let map = result(&patch).unwrap();
            for [x, y, z] in &map.normals {
                assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5, "shape {index}");
                assert!(*z > 0.0);
            }
            assert!(map.heights.iter().all(|h| h.is_finite()));
        }
    }
    let mut lonely = small();
    lonely.faces.truncate(1);
    lonely.uvs.truncate(1);
    lonely.artist.truncate(1);
    assert!(result(&lonely).is_ok());
    let mut empty = small();
    empty.faces.clear();
    empty.uvs.clear();
    empty.artist.clear();
    assert!(
        result(&empty)
            .unwrap()
            .normals
            .iter()
            .all(|n| *n == [0.0, 0.0, 1.0])
    );
}

#[test]
fn height_range_must_be_positive() {
    let map = result(&small()).unwrap();
    for range in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            height_to_u16(&map, range),
            Err(BakeError::HeightRange(range))
        );
    }
    assert!(matches!(
        height_to_u16(&map, f64::NAN),
        Err(BakeError::HeightRange(_))
    ));
    assert!((HEIGHT_MID - 0.5).abs() < 1e-5);
}
