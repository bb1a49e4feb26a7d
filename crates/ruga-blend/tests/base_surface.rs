//! The smooth surface between the artist's vertices, and what a pose asks of it.

mod patch;

use nalgebra::{Matrix2, Rotation3, Vector3};
use patch::{patch, shape};
use ruga_blend::{BaseSurface, Driver, FaceStrain, Smoothing, SurfacePoints, face_strains};
use ruga_mesh::{FaceId, MaterialPoint};

/// A patch bent over a saddle.
fn saddle() -> Driver {
    let mut mesh = patch(8, 7);
    for p in &mut mesh.positions {
        p.z = 0.3 * (p.x - 0.5).powi(2) - 0.4 * (p.y - 0.4).powi(2) + 0.1 * p.x * p.y;
    }
    Driver::new(&mesh).expect("a valid mesh")
}

fn all_faces(driver: &Driver) -> Vec<FaceId> {
    driver.topology().faces().ids().collect()
}

#[test]
fn a_part_gets_the_positions_of_the_whole() {
    let driver = saddle();
    let whole = BaseSurface::new(&driver, &all_faces(&driver), 2, Smoothing::Loop);
    let posed = whole.pose(driver.rest());
    let chosen: Vec<FaceId> = (40..55).map(FaceId).collect();
    let part = BaseSurface::new(&driver, &chosen, 2, Smoothing::Loop);
    let part_posed = part.pose(driver.rest());
    assert_eq!(part.mesh().face_count(), 15 * 16);
    for (face, vertices) in part.mesh().faces().iter() {
        let same = FaceId(part.ancestor(face, 2) as u32);
        for (a, b) in vertices.iter().zip(whole.mesh().faces()[same]) {
            let (a, b) = (a.0 as usize, b.0 as usize);
            assert!((part_posed.positions[a] - posed.positions[b]).norm() < 1e-14);
            assert!((part_posed.normals[a] - posed.normals[b]).norm() < 1e-12);
        }
        assert_eq!(part.ancestor(face, 0) as u32, part.origins()[face].face.0);
        assert_eq!(part.uvs()[face], whole.uvs()[same]);
    }
}

#[test]
fn uv_and_material_points_agree() {
    let driver = saddle();
    let base = BaseSurface::new(&driver, &all_faces(&driver), 2, Smoothing::Loop);
    for (face, uvs) in base.uvs().iter() {
        let point = MaterialPoint {
            face,
            barycentric: [0.2, 0.3, 0.5],
        };
        let origin = &base.origins()[face];
        let lifted = origin.lift(point.barycentric);
        let [a, b, c] = driver.uvs()[origin.face];
        let there = a * lifted[0] + b * lifted[1] + c * lifted[2];
        let here = uvs[0] * 0.2 + uvs[1] * 0.3 + uvs[2] * 0.5;
        assert!((there - here).norm() < 1e-15);
    }
}

#[test]
fn a_rigid_motion_turns_everything() {
    let driver = saddle();
    let base = BaseSurface::new(&driver, &all_faces(&driver), 1, Smoothing::Loop);
    let rest = base.pose(driver.rest());
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let moved: Vec<Vector3<f64>> = driver
        .rest()
        .iter()
        .map(|p| turn * p + Vector3::new(5.0, 6.0, 7.0))
        .collect();
    let posed = base.pose(&moved);
    for i in 0..rest.positions.len() {
        assert!((posed.normals[i] - turn * rest.normals[i]).norm() < 1e-12);
        assert!((posed.tangents[i] - turn * rest.tangents[i]).norm() < 1e-12);
        assert!(rest.normals[i].dot(&rest.tangents[i]).abs() < 1e-12);
    }
    for (_, strain) in face_strains(base.mesh(), &rest.positions, &posed.positions).iter() {
        assert!(strain.first.abs() < 1e-12 && strain.second.abs() < 1e-12);
    }
}

#[test]
fn facets_stay_flat_without_smoothing() {
    let driver = saddle();
    let base = BaseSurface::new(&driver, &all_faces(&driver), 2, Smoothing::None);
    let rest = base.pose(driver.rest());
    for (face, vertices) in base.mesh().faces().iter() {
        let corners = driver.topology().faces()[base.origins()[face].face];
        let [a, b, c] = corners.map(|v| driver.rest()[v.0 as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        for v in vertices {
            assert!((rest.positions[v.0 as usize] - a).dot(&normal).abs() < 1e-14);
        }
    }
}

#[test]
fn strain_of_a_known_map() {
    let mut mesh = patch(4, 4);
    let deltas = mesh
        .positions
        .iter()
        .map(|p| Vector3::new(-0.2 * p.x, 0.05 * p.y, 0.0))
        .collect();
    mesh.shapes.push(shape("press", deltas));
    let driver = Driver::new(&mesh).unwrap();
    let posed = driver.pose(&driver.weights([("press", 1.0)]).unwrap());
    for (_, strain) in face_strains(driver.topology(), driver.rest(), &posed).iter() {
        assert!((strain.first - 0.2).abs() < 1e-12);
        assert!((strain.second + 0.05).abs() < 1e-12);
        assert!((strain.effective(0.5) - 0.175).abs() < 1e-12);
    }
}

/// Points chosen by their addresses lie where the base surface has them, and turn with it.
#[test]
fn chosen_points_lie_on_the_base_surface() {
    let driver = saddle();
    for smoothing in [Smoothing::Loop, Smoothing::None] {
        let base = BaseSurface::new(&driver, &all_faces(&driver), 2, smoothing);
        let points = SurfacePoints::new(&driver, base.vertex_points(), smoothing);
        let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.1);
        let turned: Vec<_> = driver.rest().iter().map(|p| turn * p).collect();
        let (there, here) = (base.pose(&turned), points.pose(&turned));
        for (a, b) in there.positions.iter().zip(&here.positions) {
            assert!((a - b).norm() < 1e-12, "{smoothing:?}");
        }
        for (v, (a, b)) in there.normals.iter().zip(&here.normals).enumerate() {
            // Flat facets have one normal each, or those of the vertices interpolated; at corners
            // the limit has none.
            let limit = smoothing == Smoothing::Loop && a.cross(b).norm() < 1e-6;
            let facets = smoothing == Smoothing::None && a.dot(b) > 0.9;
            let (n, t) = (here.normals[v], here.tangents[v]);
            assert!(
                limit || facets || a.dot(b) > 0.99,
                "{smoothing:?}, vertex {v}"
            );
            assert!(n.dot(&t).abs() < 1e-12 && (t.norm() - 1.0).abs() < 1e-12);
        }
        let all = 0..points.points().len();
        let rest = points.some_derivatives(all.clone(), driver.rest());
        for (a, b) in rest.iter().zip(points.some_derivatives(all, &turned)) {
            assert!((turn * a[0] - b[0]).norm() < 1e-12);
            assert!((turn * a[1] - b[1]).norm() < 1e-12);
        }
    }
}

#[test]
#[should_panic(expected = "cannot be subdivided 14 times")]
fn too_many_levels_end_before_memory_is_asked_for() {
    let driver = saddle();
    let _ = BaseSurface::new(&driver, &[FaceId(0)], 14, Smoothing::Loop);
}

#[test]
#[should_panic(expected = "every point lies on one of the driver's")]
fn a_point_on_a_face_of_another_driver() {
    let driver = saddle();
    let stray = MaterialPoint::at_corner(FaceId(112), 0);
    let _ = SurfacePoints::new(&driver, vec![stray], Smoothing::None);
}

#[test]
fn strain_of_what_is_no_number_is_no_number() {
    let lost = FaceStrain::from_cauchy_green(Matrix2::repeat(f64::NAN));
    assert!(lost.first.is_nan() && lost.effective(0.48).is_nan());
    let flat = FaceStrain::from_cauchy_green(Matrix2::new(1.0, 0.0, 0.0, -1e-18));
    assert_eq!((flat.first, flat.second), (1.0, 0.0));
}
