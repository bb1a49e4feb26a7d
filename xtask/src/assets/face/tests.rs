//! What the head promises to scenes, to the preview and to the book.

use nalgebra::Vector2;
use ruga_blend::{Driver, FaceStrain, face_strains};
use ruga_mesh::{PlanarLookup, face_normals};

use super::*;

/// Shapes that compress skin until it wrinkles; the others open and close.
fn wrinkles(name: &str) -> bool {
    !name.starts_with("eyeBlink") && name != "jawOpen"
}

#[test]
fn shapes_have_the_names_of_arkit() {
    let mut names: Vec<String> = head()
        .unwrap()
        .mesh
        .shapes
        .into_iter()
        .map(|s| s.name)
        .collect();
    names.sort();
    let expected = [
        "browDownLeft",
        "browDownRight",
        "browInnerUp",
        "browOuterUpLeft",
        "browOuterUpRight",
        "eyeBlinkLeft",
        "eyeBlinkRight",
        "eyeSquintLeft",
        "eyeSquintRight",
        "jawOpen",
        "mouthFrownLeft",
        "mouthFrownRight",
        "mouthPucker",
        "mouthSmileLeft",
        "mouthSmileRight",
        "noseSneerLeft",
        "noseSneerRight",
    ];
    assert_eq!(names, expected);
}

#[test]
fn the_skin_is_open_at_eyes_and_mouth_alone() {
    let head = head().unwrap();
    let driver = Driver::new(&head.mesh).unwrap();
    let topology = driver.topology();
    let (vertices, edges) = (topology.vertex_count(), topology.edges().len());
    // A ball with three holes, and two discs.
    assert_eq!(vertices + topology.face_count(), edges + 2 - 3 + 2);
}

/// Every vertex has a mirror image in space and in the texture, and each pair of shapes moves
/// mirror images alike.
#[test]
fn left_and_right_are_mirror_images() {
    let mesh = head().unwrap().mesh;
    let uvs = mesh.uvs.as_ref().unwrap();
    let mirror = |id: usize| {
        let p = mesh.positions[id];
        let uv = Vector2::new(1.0 - uvs[id].x, uvs[id].y);
        let is_image = |other: &usize| {
            let q = mesh.positions[*other];
            q == Point::new(-p.x, p.y, p.z) && (uvs[*other] - uv).norm() < 1e-9
        };
        (0..mesh.positions.len()).find(is_image)
    };
    let images: Vec<usize> = (0..mesh.positions.len())
        .map(|id| mirror(id).unwrap())
        .collect();
    let shape = |name: &str| mesh.shapes.iter().find(|s| s.name == name);
    for left in &mesh.shapes {
        let right = match left.name.strip_suffix("Left") {
            Some(name) => shape(&format!("{name}Right")).unwrap(),
            None if left.name.ends_with("Right") => continue,
            None => left,
        };
        for (id, image) in images.iter().enumerate() {
            let d = left.position_deltas[id];
            let mirrored = Point::new(-d.x, d.y, d.z);
            assert_eq!(right.position_deltas[*image], mirrored, "{}", left.name);
        }
    }
}

#[test]
fn wrinkling_shapes_compress_as_far_as_the_model_goes() {
    let mesh = head().unwrap().mesh;
    let driver = Driver::new(&mesh).unwrap();
    for shape in mesh.shapes.iter().filter(|s| wrinkles(&s.name)) {
        let posed = driver.pose(&driver.weights([(shape.name.as_str(), 1.0)]).unwrap());
        let strains = face_strains(driver.topology(), driver.rest(), &posed);
        let first = |s: &FaceStrain| s.first;
        let peak = strains.iter().map(|(_, s)| first(s)).fold(0.0, f64::max);
        assert!((0.07..0.30).contains(&peak), "{}: {peak}", shape.name);
    }
}

#[test]
fn no_shape_folds_or_collapses_a_triangle() {
    let mesh = head().unwrap().mesh;
    let driver = Driver::new(&mesh).unwrap();
    let rest = face_normals(driver.topology(), driver.rest());
    for shape in &mesh.shapes {
        for weight in [0.5, 1.0] {
            let posed = driver.pose(&driver.weights([(shape.name.as_str(), weight)]).unwrap());
            let normals = face_normals(driver.topology(), &posed);
            for (face, normal) in normals.iter() {
                let before = rest[face];
                let ratio = normal.norm() / before.norm();
                let cosine = normal.dot(&before) / (normal.norm() * before.norm());
                assert!(
                    (0.4..2.5).contains(&ratio),
                    "{} {face:?}: {ratio}",
                    shape.name
                );
                // Edges of lids turn as they slide over the eyeball.
                assert!(cosine > 0.3, "{} {face:?}: {cosine}", shape.name);
            }
        }
    }
}

#[test]
fn charts_lie_in_the_texture_unmirrored_and_apart() {
    let mesh = head().unwrap().mesh;
    let driver = Driver::new(&mesh).unwrap();
    let uvs = driver.uvs();
    let lookup = PlanarLookup::new(uvs.clone());
    for (face, &[a, b, c]) in uvs.iter() {
        // V points down, so what is counter-clockwise on the skin is negative here.
        let area = 0.5 * (b - a).perp(&(c - a));
        assert!(area < -1e-7, "{face:?} has {area}");
        let inside = |corner: &Vector2<f64>| corner.iter().all(|x| (0.01..=0.99).contains(x));
        assert!([a, b, c].iter().all(inside), "{face:?}");
        let found = lookup.locate((a + b + c) / 3.0).map(|point| point.face);
        assert_eq!(found, Some(face));
    }
}

#[test]
fn triangles_of_the_face_are_small_and_none_is_a_needle() {
    let mesh = head().unwrap().mesh;
    let mut edges = Vec::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|id| mesh.positions[id as usize]);
        let [a, b, c] = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).norm());
        let area = 0.5
            * (corners[1] - corners[0])
                .cross(&(corners[2] - corners[0]))
                .norm();
        let round = 4.0 * 3.0_f64.sqrt() * area / (a * a + b * b + c * c);
        assert!(round > 0.1, "{triangle:?}: {round}");
        let middle: Point = corners.iter().sum::<Point>() / 3.0;
        if middle.z > 0.04 && (-0.11..0.08).contains(&middle.y) {
            edges.extend([a, b, c]);
        }
    }
    edges.sort_by(f64::total_cmp);
    let median = edges[edges.len() / 2];
    assert!((3.5e-3..6e-3).contains(&median), "{median}");
}

/// Masks are those of zones: each has white skin, and they share what is between them.
#[test]
fn masks_add_up_to_white_at_most() {
    let painted = paint(&head().unwrap().mesh);
    let masks = &painted.images[..3];
    for (name, texels) in masks {
        assert!(texels.iter().filter(|t| **t > 250).count() > 500, "{name}");
    }
    for texel in 0..TEXELS * TEXELS {
        let sum: u32 = masks.iter().map(|(_, t)| u32::from(t[texel])).sum();
        assert!(sum <= 255);
    }
}

/// An old face wrinkles on forehead, temples and cheeks, and nowhere on eyeballs, lids, lips, nose, ears and neck.
#[test]
fn age_spares_what_does_not_wrinkle() {
    let head = head().unwrap();
    let painted = paint(&head.mesh);
    let (name, texels) = &painted.images[4];
    assert_eq!(*name, "age.png");
    let uvs = head.mesh.uvs.as_ref().unwrap();
    let mut white = [0; 3];
    for (id, p) in head.mesh.positions.iter().enumerate() {
        let texel = uvs[id].map(|c| (c * TEXELS as f64) as usize);
        let grey = texels[texel.y * TEXELS + texel.x];
        let aside = p.x.abs();
        let spared = [
            (p - super::solid::EYE).norm() < 0.0135
                || (p + Point::new(0.0312, 0.0, -0.061)).norm() < 0.0135,
            aside < 0.014 && (-0.06..0.012).contains(&p.y),
            aside < 0.018 && (-0.08..-0.06).contains(&p.y),
            aside > 0.074 || p.y < -0.11 || p.z < 0.02,
        ];
        assert!(
            spared.iter().all(|spared| !spared) || grey < 5,
            "{p:?}: {grey}"
        );
        let places = [
            p.y > 0.03,
            aside > 0.05 && p.y.abs() < 0.01,
            aside > 0.03 && p.y < -0.04,
        ];
        for (count, place) in white.iter_mut().zip(places) {
            *count += usize::from(place && grey > 230);
        }
    }
    assert!(white.iter().all(|count| *count > 3), "{white:?}");
}
