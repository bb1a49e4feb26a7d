//! What every asset promises to scenes and tests.

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, Driver, face_strains};
use ruga_mesh::{PlanarLookup, face_normals};

use super::*;

fn meshes() -> [ArtistMesh; 6] {
    super::meshes().unwrap()
}

/// The soft bodies, centred at the origin, with the lengths of their sides and the area of their
/// smooth surface.
fn bodies() -> [(ArtistMesh, [f64; 3], f64); 3] {
    let [_, _, pillow, slab, bar, _] = meshes();
    [
        (pillow, [0.12, 0.12, 0.04], 0.03387),
        (slab, [0.12, 0.12, 0.03], 0.04085),
        (bar, [0.2, 0.04, 0.04], 0.03277),
    ]
}

#[test]
fn committed_files_are_what_the_code_makes() {
    let folder = tempfile::tempdir().unwrap();
    for name in written(folder.path()).unwrap() {
        let made = fs::read(folder.path().join(&name)).unwrap();
        let committed = fs::read(root().join("assets").join(&name)).unwrap();
        assert!(committed == made, "{name}: run `cargo xtask assets`");
    }
}

#[test]
fn files_hold_the_meshes_without_loss() {
    let folder = tempfile::tempdir().unwrap();
    let names = write_meshes(folder.path()).unwrap();
    for (name, made) in names.into_iter().zip(meshes()) {
        let path = folder.path().join(name);
        let read = ruga_io::read_mesh(&path, Some(&made.name), &Default::default()).unwrap();
        assert_eq!(read.warnings, [] as [String; 0]);
        assert_eq!(read.mesh.positions, made.positions);
        assert_eq!(read.mesh.triangles, made.triangles);
        for (read, made) in read.mesh.shapes.iter().zip(&made.shapes) {
            assert_eq!(read.name, made.name);
            assert_eq!(read.position_deltas, made.position_deltas);
        }
    }
}

#[test]
fn bodies_and_the_finger_are_closed() {
    for mesh in &meshes()[1..5] {
        let driver = Driver::new(mesh).unwrap();
        let topology = driver.topology();
        assert!(topology.edges().iter().all(|(_, edge)| !edge.is_border()));
        let (vertices, edges) = (topology.vertex_count(), topology.edges().len());
        assert_eq!(vertices + topology.face_count() - edges, 2);
    }
}

#[test]
fn bodies_are_as_large_as_they_should_be() {
    for (mesh, sides, area) in bodies() {
        let driver = Driver::new(&mesh).unwrap();
        for (axis, side) in sides.into_iter().enumerate() {
            let along = driver.rest().iter().map(|p| p[axis]);
            let (low, high) = along.fold((0.0, 0.0), |(l, h): (f64, f64), x| (l.min(x), h.max(x)));
            assert!((high - 0.5 * side).abs() < 1e-8, "{}: {high}", mesh.name);
            assert!((low + 0.5 * side).abs() < 1e-8, "{}: {low}", mesh.name);
        }
        let normals = face_normals(driver.topology(), driver.rest());
        let found: f64 = normals.iter().map(|(_, n)| 0.5 * n.norm()).sum();
        assert!((found / area - 1.0).abs() < 0.01, "{}: {found}", mesh.name);
        assert!((2000..4000).contains(&driver.topology().face_count()));
    }
}

/// Seen from the origin every face shows its inner side, and together they cover the view once: no
/// two faces can cross.
#[test]
fn bodies_do_not_cross_themselves() {
    for (mesh, ..) in bodies() {
        let driver = Driver::new(&mesh).unwrap();
        let mut whole = 0.0;
        for (face, vertices) in driver.topology().faces().iter() {
            let [a, b, c] = vertices.map(|v| driver.rest()[v.0 as usize].normalize());
            let solid_angle = 2.0
                * a.dot(&b.cross(&c))
                    .atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a));
            assert!(solid_angle > 1e-5, "{} {face:?}: {solid_angle}", mesh.name);
            whole += solid_angle;
        }
        assert!((whole / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn bodies_are_round_everywhere() {
    for (mesh, ..) in bodies() {
        let driver = Driver::new(&mesh).unwrap();
        let topology = driver.topology();
        let normals = face_normals(topology, driver.rest());
        for face in topology.faces().ids() {
            for corner in 0..3 {
                let other = topology.neighbour(face, corner).unwrap();
                let angle = normals[face].angle(&normals[other]).to_degrees();
                assert!(angle < 46.0, "{} at {face:?}: {angle}", mesh.name);
            }
        }
    }
}

#[test]
fn peak_compression_is_what_skin_bears() {
    for mesh in meshes() {
        let driver = Driver::new(&mesh).unwrap();
        for shape in &mesh.shapes {
            let posed = driver.pose(&driver.weights([(shape.name.as_str(), 1.0)]).unwrap());
            let strains = face_strains(driver.topology(), driver.rest(), &posed);
            let peak = |value: &dyn Fn(&ruga_blend::FaceStrain) -> f64| {
                strains
                    .iter()
                    .map(|(_, s)| value(s))
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            let (e1, effective) = (peak(&|s| s.first), peak(&|s| s.effective(0.48)));
            assert!((0.08..=0.14).contains(&e1), "{}: {e1}", shape.name);
            assert!(effective > 0.06, "{}: {effective}", shape.name);
        }
    }
}

#[test]
fn no_shape_folds_a_triangle() {
    for mesh in meshes() {
        let driver = Driver::new(&mesh).unwrap();
        let topology = driver.topology();
        for shape in &mesh.shapes {
            for weight in [0.0, 0.5, 1.0] {
                let posed = driver.pose(&driver.weights([(shape.name.as_str(), weight)]).unwrap());
                let normals = face_normals(topology, &posed);
                for face in topology.faces().ids() {
                    for corner in 0..3 {
                        let Some(other) = topology.neighbour(face, corner) else {
                            continue;
                        };
                        let (a, b) = (normals[face], normals[other]);
                        let cosine = a.dot(&b) / (a.norm() * b.norm());
                        assert!(cosine > 0.5, "{} at {face:?}: {cosine}", mesh.name);
                    }
                }
            }
        }
    }
}

#[test]
fn charts_lie_in_the_texture_unmirrored_and_apart() {
    for mesh in meshes() {
        let driver = Driver::new(&mesh).unwrap();
        let uvs = driver.uvs();
        let lookup = PlanarLookup::new(uvs.clone());
        for (face, &[a, b, c]) in uvs.iter() {
            // V points down, so what is counter-clockwise on the skin is negative here.
            let area = 0.5 * (b - a).perp(&(c - a));
            assert!(area < -1e-4, "{}: {face:?} has {area}", mesh.name);
            for corner in [a, b, c] {
                assert!(
                    corner.iter().all(|x| (0.019..=0.981).contains(x)),
                    "{corner}"
                );
            }
            for share in [[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]] {
                let inside: Vector2<f64> = a * share[0] + b * share[1] + c * share[2];
                let found = lookup.locate(inside).map(|point| point.face);
                assert_eq!(found, Some(face), "{}", mesh.name);
            }
        }
    }
}

#[test]
fn triangles_are_nearly_equilateral() {
    for (mesh, edge) in meshes()
        .into_iter()
        .zip([6.7e-3, 3.5e-3, 4.4e-3, 5.0e-3, 5.0e-3])
    {
        let driver = Driver::new(&mesh).unwrap();
        let mut lengths: Vec<f64> = driver
            .topology()
            .edges()
            .iter()
            .map(|(_, e)| {
                let [a, b]: [Vector3<f64>; 2] = e.vertices.map(|v| driver.rest()[v.0 as usize]);
                (b - a).norm()
            })
            .collect();
        lengths.sort_by(f64::total_cmp);
        let median = lengths[lengths.len() / 2];
        assert!((median / edge - 1.0).abs() < 0.1, "{}: {median}", mesh.name);
        // Half cells at straight borders.
        assert!(lengths[0] > 0.45 * edge, "{}: {}", mesh.name, lengths[0]);
        assert!(lengths[lengths.len() - 1] < 1.7 * edge, "{}", mesh.name);
    }
}

/// Every scene below `assets/`.
fn scenes() -> Vec<(PathBuf, ruga_scene::SceneFile)> {
    let folders = fs::read_dir(root().join("assets")).unwrap();
    let mut paths: Vec<PathBuf> = folders
        .flat_map(|folder| fs::read_dir(folder.unwrap().path()).unwrap())
        .map(|file| file.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    paths.sort();
    assert_eq!(paths.len(), 30);
    let read = |path: PathBuf| (path.clone(), ruga_scene::SceneFile::read(&path).unwrap());
    paths.into_iter().map(read).collect()
}

#[test]
fn scenes_are_read_and_name_the_shapes_there_are() {
    for (path, scene) in scenes() {
        let name = scene.driver.mesh_name.as_deref().unwrap();
        let mesh = ruga_io::read_mesh(&scene.driver.mesh, Some(name), &Default::default());
        let shapes: Vec<String> = mesh
            .unwrap()
            .mesh
            .shapes
            .into_iter()
            .map(|s| s.name)
            .collect();
        assert!(!scene.poses_or_shapes(&shapes, &path).unwrap().is_empty());
        for map in scene.layers.iter().filter_map(|layer| layer.map.as_ref()) {
            ruga_scene::read_property_images(map, &path, "map").unwrap();
        }
    }
}

/// Handles hold something but not everything, and the button is clear of the pillow until it
/// presses it to half its height.
#[test]
fn scenes_of_bodies_fit_their_meshes() {
    let mut bodies = 0;
    for (_, scene) in scenes() {
        let Some(interior) = &scene.interior else {
            continue;
        };
        bodies += 1;
        let name = scene.driver.mesh_name.as_deref();
        let mesh = ruga_io::read_mesh(&scene.driver.mesh, name, &Default::default()).unwrap();
        let positions = &mesh.mesh.positions;
        for handle in &interior.handles {
            let is_inside =
                |p: &&Vector3<f64>| (0..3).all(|i| (handle.min[i]..handle.max[i]).contains(&p[i]));
            let held = positions.iter().filter(is_inside).count();
            assert!(
                (20..positions.len() / 4).contains(&held),
                "{}: {held}",
                handle.name
            );
        }
        for obstacle in &interior.obstacles {
            let Some(button) = obstacle.cylinder else {
                continue;
            };
            let top = positions.iter().map(|p| p.z).fold(0.0, f64::max);
            assert!((0.0..1e-3).contains(&(button.from[2] - top)));
            let way = scene.poses[0].motions[0].translation[2];
            assert!((button.from[2] + way).abs() < 1e-9);
        }
    }
    assert_eq!(bodies, 5);
}

#[test]
fn scenes_of_scale_differ_as_their_figure_says() {
    let layer = |name: &str| {
        let path = root().join("assets/scale").join(name);
        let layer = ruga_scene::SceneFile::read(&path).unwrap().layers.remove(0);
        [layer.young.unwrap(), layer.thickness.unwrap()]
    };
    let [young, thickness] = layer("reference.toml");
    let is_close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    for (name, stiffer, thinner) in [
        ("thin.toml", 1.0, 4.0),
        ("stiff.toml", 64.0, 1.0),
        ("thin-stiff.toml", 64.0, 4.0),
    ] {
        let own = layer(name);
        assert!(is_close(own[0], young * stiffer), "{name}");
        assert!(is_close(own[1] * thinner, thickness), "{name}");
    }
}

#[test]
fn paint_is_what_the_scenes_say() {
    let at = |texels: &[u8], channels: usize, y: f64| {
        let row = (0..paint::TEXELS)
            .find(|&row| forearm::place_along((row as f64 + 0.5) / paint::TEXELS as f64) < y);
        texels[channels * paint::TEXELS * row.unwrap() + channels / 2]
    };
    let (stiffness, thickness) = (paint::stiffness(), paint::thickness());
    // Soft below, stiff above; in the middle 1.5 times the wavelength, the cube root.
    assert_eq!([-0.045, 0.045].map(|y| at(&stiffness, 3, y)), [0, 255]);
    let middle = 0.35 + 2.45 * f64::from(at(&stiffness, 3, 0.0)) / 255.0;
    assert!(((middle / 0.35).cbrt() - 1.5).abs() < 0.02);
    assert_eq!(
        [-0.02, 0.0, 0.045].map(|y| at(&thickness, 1, y)),
        [0, 255, 0]
    );
    let jump = [-0.0135, -0.0105].map(|y| at(&thickness, 1, y));
    assert_eq!(jump, [0, 255]);
}
