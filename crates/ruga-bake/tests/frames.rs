//! Tangent frames: glTF's sign, rotated and mirrored charts, seams.

mod patch;

use nalgebra::{Rotation2, Vector2, Vector3};
use patch::{Driver, Patch, SIDE, baked, degrees, grid_faces};
use ruga_bake::{
    BakeSettings, Coverage, Frame, NormalY, TangentFrame, WrinkleMap, bake, normal_to_png16,
    tangent_frames, vertex_tangents,
};

/// A ridge across the v direction, half way up, with a gentle and a steep side.
fn ridge(_: f64, t: f64) -> f64 {
    let up = t / SIDE;
    1e-3 * (std::f64::consts::PI * up * up).sin()
}

/// Bakes a flat ridge whose UVs, and the artist's, went through `change`.
fn bake_ridge(change: impl Fn(Vector2<f64>) -> Vector2<f64>, frame: Frame) -> WrinkleMap {
    let mut patch = Patch::new(Driver::Flat, [64, 1], 0.0, ridge);
    let corners = [[0.0, 0.0], [SIDE, 0.0], [0.0, SIDE], [SIDE, SIDE]];
    let positions = corners.map(|[s, t]| Vector3::new(s, t, 0.0));
    let uvs = corners.map(|c| change(patch::uv(c)));
    patch.frames = tangent_frames(&positions, &[Vector3::z(); 4], &uvs, &grid_faces(1))
        .expect("a valid square");
    for uv in patch.uvs.iter_mut().flatten() {
        *uv = change(*uv);
    }
    let settings = BakeSettings {
        size: 128,
        frame,
        ..BakeSettings::default()
    };
    bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch")
}

/// The normal of the ridge at a place on the patch.
fn ridge_normal(t: f64) -> Vector3<f64> {
    let up = t / SIDE;
    let slope = 1e-3 * (std::f64::consts::PI * up * up).cos() * std::f64::consts::TAU * up / SIDE;
    Vector3::new(0.0, -slope, 1.0).normalize()
}

/// The largest deviation from the analytic normal in the tangent frame of `change`.
fn largest_error(change: impl Fn(Vector2<f64>) -> Vector2<f64>, map: &WrinkleMap) -> f64 {
    let origin = change(Vector2::zeros());
    // Columns: where U and V of the unchanged chart go. Both changes are isometries.
    let [along_u, along_v] = [Vector2::x(), Vector2::y()].map(|axis| change(axis) - origin);
    let mut largest: f64 = 0.0;
    for texel in 0..map.normals.len() {
        let at = Vector2::new((texel % 128) as f64 + 0.5, (texel / 128) as f64 + 0.5) / 128.0;
        let [u, v] = [along_u.dot(&(at - origin)), along_v.dot(&(at - origin))];
        assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
        let normal = ridge_normal((1.0 - v) * SIDE);
        // A step of world (x, y) is one of (x, -y) in the unchanged chart; V-up turns the last sign.
        let moved = along_u * normal.x - along_v * normal.y;
        let exact = Vector3::new(moved.x, -moved.y, normal.z);
        largest = largest.max(degrees(&baked(map, texel), &exact));
    }
    largest
}

#[test]
fn green_points_up_where_the_surface_faces_up() {
    for frame in [Frame::Driver, Frame::Mesh] {
        let map = bake_ridge(|uv| uv, frame);
        // Near the top of the image the surface falls towards the top: it faces V-up.
        let [x, y, _] = map.normals[10 * 128 + 64];
        assert!(y > 0.05, "{y}");
        assert!(x.abs() < 1e-6);
        let [_, y, _] = map.normals[100 * 128 + 64];
        assert!(y < -0.01, "{y}");
        assert!(largest_error(|uv| uv, &map) < 0.05);
    }
}

#[test]
fn normal_y_down_flips_green_alone() {
    let map = bake_ridge(|uv| uv, Frame::Driver);
    let [up, down] = [NormalY::Up, NormalY::Down].map(|y| normal_to_png16(&map, y));
    for (up, down) in up.chunks(3).zip(down.chunks(3)) {
        assert_eq!([up[0], up[2]], [down[0], down[2]]);
        assert!((i64::from(up[1]) + i64::from(down[1]) - 65535).abs() <= 1);
    }
}

#[test]
fn rotated_charts_bake_rotated_normals() {
    let center = Vector2::repeat(0.5);
    let quarter = Rotation2::new(std::f64::consts::FRAC_PI_2);
    let change = |uv: Vector2<f64>| center + quarter * (uv - center);
    for frame in [Frame::Driver, Frame::Mesh] {
        let map = bake_ridge(change, frame);
        assert!(largest_error(change, &map) < 0.05);
    }
}

#[test]
fn mirrored_charts_have_a_negative_sign_and_the_right_normals() {
    let change = |uv: Vector2<f64>| Vector2::new(1.0 - uv.x, uv.y);
    let positions = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    let uvs = [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]].map(Vector2::from);
    let normals = [Vector3::z(); 3];
    let plain = tangent_frames(&positions, &normals, &uvs, &[[0, 1, 2]]).unwrap();
    let mirrored = tangent_frames(&positions, &normals, &uvs.map(change), &[[0, 1, 2]]).unwrap();
    for (plain, mirrored) in plain[0].iter().zip(&mirrored[0]) {
        assert_eq!((plain.sign, mirrored.sign), (1.0, -1.0));
        assert!((plain.tangent - Vector3::x()).norm() < 1e-6);
        assert!((mirrored.tangent + Vector3::x()).norm() < 1e-6);
    }
    for frame in [Frame::Driver, Frame::Mesh] {
        assert!(largest_error(change, &bake_ridge(change, frame)) < 0.05);
    }
}

/// Where a UV of the unchanged chart goes when the right half is cut off and turned.
fn two_charts(uv: Vector2<f64>, right: bool) -> Vector2<f64> {
    if right {
        Vector2::new(0.5 + 0.5 * uv.y, 1.0 - 0.5 * uv.x)
    } else {
        0.5 * uv
    }
}

/// A wrinkled cylinder of two charts, turned against each other: a client that shades with the
/// artist's frames gets the layer's normal on both sides of the seam, and so no seam.
#[test]
fn the_shaded_normal_is_continuous_over_a_seam() {
    let driver = Driver::Cylinder(0.04);
    let mut patch = Patch::new(driver, [192, 4], 0.0, patch::waves);
    for uvs in &mut patch.uvs {
        let right = uvs.iter().map(|uv| uv.x).sum::<f64>() > 1.5;
        *uvs = uvs.map(|uv| two_charts(uv, right));
    }
    patch.frames = split_artist_frames(driver);
    let settings = BakeSettings {
        size: 1024,
        frame: Frame::Mesh,
        ..BakeSettings::default()
    };
    let map = bake(&patch.relief(), &patch.frames, &settings).unwrap();

    let texel = |uv: Vector2<f64>| {
        let [column, row] = [uv.x, uv.y].map(|c| (c * 1024.0) as usize);
        row * 1024 + column
    };
    let tangents = [0.49, 0.51].map(|u| patch.tangent_at(u * SIDE, 0.5 * SIDE).0);
    assert!(tangents[0].dot(&tangents[1]).abs() < 0.1, "turned charts");
    for step in 1..200 {
        // Half a texel on either side of the seam.
        let v = f64::from(step) / 200.0;
        let shaded = [(0.5 - 0.5 / 512.0, false), (0.5 + 0.5 / 512.0, true)].map(|(u, right)| {
            let [s, t] = [u * SIDE, (1.0 - v) * SIDE];
            let (tangent, sign) = patch.tangent_at(s, t);
            let normal = patch.normal_at(s, t);
            let texel = texel(two_charts(Vector2::new(u, v), right));
            assert_eq!(map.coverage[texel], Coverage::Covered);
            let [x, y, z] = baked(&map, texel).into();
            (tangent * x + normal.cross(&tangent) * (sign * y) + normal * z).normalize()
        });
        // Across one texel, 0.2 mm, the waves themselves turn by up to 3.9 degrees.
        assert!(degrees(&shaded[0], &shaded[1]) < 5.0, "at v = {v}");
    }
}

/// Frames of the 4 x 4 grid below the patch, whose middle column of vertices is doubled.
fn split_artist_frames(driver: Driver) -> Vec<[TangentFrame; 3]> {
    let faces = grid_faces(4);
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (face, corners) in faces.iter().enumerate() {
        let right = face / 2 % 4 >= 2;
        let first = vertices.len() as u32;
        triangles.push([first, first + 1, first + 2]);
        for &corner in corners {
            let parameters = [corner % 5, corner / 5].map(|i| f64::from(i) * SIDE / 4.0);
            let (p, n) = driver.at(parameters[0], parameters[1]);
            vertices.push((p, n, two_charts(patch::uv(parameters), right)));
        }
    }
    let positions: Vec<_> = vertices.iter().map(|v| v.0).collect();
    let normals: Vec<_> = vertices.iter().map(|v| v.1).collect();
    let uvs: Vec<_> = vertices.iter().map(|v| v.2).collect();
    tangent_frames(&positions, &normals, &uvs, &triangles).expect("a valid artist mesh")
}

#[test]
fn vertex_tangents_take_the_majority_sign() {
    let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    let frame = |x: f64, y: f64, sign: f64| TangentFrame {
        normal: Vector3::z(),
        tangent: Vector3::new(x, y, 0.0),
        sign,
    };
    let frames = [
        [frame(1.0, 0.0, 1.0); 3],
        [frame(0.0, 1.0, 1.0); 3],
        [frame(-1.0, 0.0, -1.0); 3],
    ];
    let tangents = vertex_tangents(&frames, &triangles, 6).unwrap();
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    assert_eq!(tangents[0], [diagonal, diagonal, 0.0, 1.0]);
    assert_eq!(tangents[1], [1.0, 0.0, 0.0, 1.0]);
    // A tie: plus wins.
    assert_eq!(tangents[3], [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(tangents[4], [-1.0, 0.0, 0.0, -1.0]);
    // No triangle.
    assert_eq!(tangents[5], [1.0, 0.0, 0.0, 1.0]);
}
