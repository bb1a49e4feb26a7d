//! The files artists gave us read with the counts they are known to have, and write back.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]
#![allow(clippy::print_stdout, reason = "a test that checked nothing says so")]

use std::path::{Path, PathBuf};

use nalgebra::{Vector3, Vector4};
use ruga_io::{GlbAdditions, MeshFile, ObjOptions, WrinkleMap, read_mesh, write_glb};
use ruga_io::{MapFormat, NormalY};

mod carried;

use carried::assert_carried;

fn data() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("no test data beside the repository: nothing was checked");
    None
}

fn read(path: &Path) -> MeshFile {
    read_mesh(path, None, &ObjOptions::default()).unwrap()
}

/// File, vertices, triangles, shapes, whether it has texture coordinates.
const FILES: [(&str, usize, usize, usize, bool); 7] = [
    ("ict-facekit/ict_face_arkit.glb", 9547, 18460, 55, true),
    ("makehuman-hand/mh_hand_forearm.glb", 2070, 3636, 8, true),
    ("gltf-edge-cases/01_morphed_cube.gltf", 24, 12, 2, true),
    ("gltf-edge-cases/01_cs_morph.gltf", 24, 12, 1, false),
    ("gltf-edge-cases/01_morphed_triangle.gltf", 3, 1, 1, true),
    (
        "gltf-edge-cases/01_morphed_cube_no_uv.gltf",
        24,
        12,
        1,
        false,
    ),
    ("gltf-edge-cases/SimpleMorph.gltf", 3, 1, 2, false),
];

#[test]
fn known_counts() {
    let Some(data) = data() else { return };
    for (file, vertices, triangles, shapes, uvs) in FILES {
        let mesh = read(&data.join(file)).mesh;
        assert_eq!(mesh.positions.len(), vertices, "{file}");
        assert_eq!(mesh.triangles.len(), triangles, "{file}");
        assert_eq!(mesh.shapes.len(), shapes, "{file}");
        assert_eq!(mesh.uvs.is_some(), uvs, "{file}");
        for shape in &mesh.shapes {
            assert_eq!(
                shape.position_deltas.len(),
                vertices,
                "{file} {}",
                shape.name
            );
        }
    }
}

#[test]
fn the_face_has_its_size_and_names() {
    let Some(data) = data() else { return };
    let mesh = read(&data.join(FILES[0].0)).mesh;
    assert_eq!(mesh.name, "ICTFace");
    let extent = |axis: usize| {
        let values = mesh.positions.iter().map(|p| p[axis]);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    for (axis, metres) in [0.184, 0.288, 0.163].into_iter().enumerate() {
        assert!((extent(axis) - metres).abs() < 1e-3, "axis {axis}");
    }
    let jaw = mesh.shapes.iter().find(|s| s.name == "jawOpen").unwrap();
    let longest = jaw
        .position_deltas
        .iter()
        .map(|d| d.norm())
        .fold(0.0, f64::max);
    assert!((longest - 0.042).abs() < 1e-3, "jawOpen moves {longest} m");
    assert!(jaw.normal_deltas.is_some());
}

#[test]
fn zero_normal_deltas_ask_for_recomputed_ones() {
    let Some(data) = data() else { return };
    let mesh = read(&data.join("gltf-edge-cases/01_morphed_triangle.gltf")).mesh;
    let shape = &mesh.shapes[0];
    let zero = shape.normal_deltas.is_none();
    let moved = shape.normal_deltas.iter().flatten().any(|d| d.norm() > 0.0);
    assert!(zero || moved);
    let unnamed = read(&data.join("gltf-edge-cases/SimpleMorph.gltf")).mesh;
    let names: Vec<_> = unnamed.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["shape_0", "shape_1"]);
    assert!(unnamed.shapes.iter().all(|s| s.normal_deltas.is_none()));
}

/// Writes each file with tangents and maps. With `RUGA_GLB_DIR` set the results stay there, for
/// the Khronos validator.
#[test]
fn every_file_is_written_back_as_it_came() {
    let Some(data) = data() else { return };
    let temporary = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("RUGA_GLB_DIR").map(PathBuf::from);
    let folder = kept.as_deref().unwrap_or(temporary.path());
    for (file, ..) in FILES {
        let original = read(&data.join(file));
        let stem = Path::new(file).file_stem().unwrap().to_string_lossy();
        let target = folder.join(format!("{stem}.glb"));
        write_with_additions(&target, &original);
        assert_carried(&data.join(file), &target, 0);
        let copy = read(&target);
        assert_eq!(copy.mesh.positions, original.mesh.positions, "{file}");
        assert_eq!(copy.mesh.triangles, original.mesh.triangles, "{file}");
        assert_eq!(copy.mesh.uvs, original.mesh.uvs, "{file}");
        assert_eq!(copy.default_weights, original.default_weights, "{file}");
        assert_eq!(copy.stretch, original.stretch, "{file}");
        let moved = (copy.world_from_node - original.world_from_node).norm();
        assert!(moved < 1e-6, "{file}: node moved by {moved}");
        for (a, b) in copy.mesh.shapes.iter().zip(&original.mesh.shapes) {
            assert_eq!(a.name, b.name, "{file}");
            assert_eq!(a.position_deltas, b.position_deltas, "{file} {}", a.name);
            if original.mesh.normals.is_some() {
                assert_eq!(a.normal_deltas, b.normal_deltas, "{file} {}", a.name);
            }
        }
    }
}

fn write_with_additions(target: &Path, file: &MeshFile) {
    let vertices = file.mesh.positions.len();
    let up = vec![Vector3::z(); vertices];
    // Any tangents do: what is tested is that the file keeps the rules.
    let tangents = vec![Vector4::new(0.3, 0.5, -0.2, -1.0); vertices];
    let maps = [
        WrinkleMap::normal("mouth smile", 0.5, MapFormat::Png16, NormalY::Up),
        WrinkleMap::normal("mouth smile", 1.0, MapFormat::Png16, NormalY::Up),
        WrinkleMap::height("mouth smile", 1.0, MapFormat::Png16, 2e-3),
    ];
    let additions = GlbAdditions {
        tangents: Some(&tangents),
        normals: Some(&up),
        maps: &maps,
        moved: &[],
    };
    write_glb(target, file, &additions).unwrap();
}
