//! Sheets through the command: a leaf that burns, its maps, its mesh as it moves, and its report.

mod fixture;

use fixture::Folder;
use nalgebra::Vector3;
use ruga_io::{ObjOptions, read_mesh, read_obj_positions};

const SCENE: &str = r#"version = 1

[driver]
mesh = "patch.obj"
smoothing = "none"

[[layers]]
name = "leaf"
young = 3e9
poisson = 0.3
thickness = 2e-4

[sheet]
edge = 0.02
handles = [{ name = "clip", min = [-1.0, -1.0, -1.0], max = [0.001, 1.0, 1.0] }]

[burn]
front_speed = 4e-3
front_width = 2e-2
edges_per_width = 2
asymmetry = 0.01
sources = [{ name = "match", sphere = { centre = [0.09, 0.09, 0.0], radius = 0.03 }, temperature = 1500.0 }]

[[poses]]
name = "burn"
keys = [0.5, 1.0]
steps = 4

[solver]
mode = "dynamic"
time_step = 2.0

[bake]
size = 64
padding = 2
maps = ["normal", "mask", "char", "temperature"]
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder
}

/// The name of the GLB in a folder of results.
fn glb_of(folder: &Folder, run: &str) -> String {
    let files = folder.files(run);
    let glb = files.into_iter().find(|file| file.ends_with(".glb"));
    format!("{run}/{}", glb.expect("a GLB"))
}

#[test]
fn a_fire_bakes_the_same_on_one_thread_and_two() {
    let folder = folder();
    folder.ruga("bake scene.toml -o one --threads 1").exits(0);
    folder.ruga("bake scene.toml -o two --threads 2").exits(0);
    let files = folder.files("one");
    assert_eq!(files, folder.files("two"));
    // The report and the records have times in them.
    let is_timed = |file: &&String| file.ends_with("report.json") || file.starts_with("poses/");
    let (timed, same): (Vec<&String>, Vec<&String>) = files.iter().partition(is_timed);
    assert!(timed.len() == 2 && same.len() > 10, "{files:?}");
    for file in same {
        let of = |run: &str| folder.read(&format!("{run}/{file}"));
        assert!(of("one") == of("two"), "{file} on two threads");
    }
    let fire = |run: &str| {
        folder.json(&format!("{run}/report.json"))["poses"][0]["layers"][0]["fire"].clone()
    };
    assert_eq!(fire("one"), fire("two"));
    assert!(fire("one")["fuel_left"].as_f64().unwrap() < 0.95);
}

#[test]
fn the_glb_shows_how_a_sheet_moves() {
    let folder = folder();
    folder.ruga("bake scene.toml -o out --threads 1").exits(0);
    let layer = &folder.json("out/report.json")["poses"][0]["layers"][0];
    assert!(layer["intersections"].is_u64(), "{layer}");
    let path = glb_of(&folder, "out");
    let mesh = read_mesh(&folder.path(&path), None, &ObjOptions::default()).unwrap();
    let names: Vec<&str> = mesh.mesh.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["burn_50", "burn_100"]);
    let mut farthest = 0.0_f64;
    for shape in &mesh.mesh.shapes {
        let file = folder.path(format!("out/bodies/{}.obj", shape.name));
        let places = read_obj_positions(&file).unwrap();
        let deltas = mesh.mesh.positions.iter().zip(&shape.position_deltas);
        let moved: Vec<Vector3<f64>> = deltas.map(|(x, way)| x + way).collect();
        assert_eq!(places.len(), moved.len());
        for (found, wanted) in moved.iter().zip(&places) {
            assert!((found - wanted).norm() < 1e-7, "{}", shape.name);
        }
        let ways = shape.position_deltas.iter().map(Vector3::norm);
        farthest = ways.fold(farthest, f64::max);
    }
    assert!(farthest > 1e-3, "{farthest}");
    // A run that makes nothing anew has the shapes from the files of the earlier one.
    let before = folder.read(&path);
    folder
        .ruga("bake scene.toml -o out --threads 1 --resume")
        .exits(0);
    assert!(folder.read(&path) == before, "another GLB after --resume");
    // What somebody has changed is no shape of the mesh any more.
    for (text, told) in [
        ("v 0 0 0\n", "bodies/burn_50.obj has 1 vertices"),
        ("v 0 0 nothing\n", "burn_50.obj: line 1"),
    ] {
        std::fs::write(folder.path("out/bodies/burn_50.obj"), text).unwrap();
        folder
            .ruga("bake scene.toml -o out --resume")
            .exits(0)
            .says(&[told]);
        let mesh = read_mesh(&folder.path(&path), None, &ObjOptions::default()).unwrap();
        let names: Vec<String> = mesh.mesh.shapes.into_iter().map(|s| s.name).collect();
        assert_eq!(names, ["burn_100"]);
    }
}

#[test]
fn a_simulated_sheet_plays_in_a_glb() {
    let folder = folder();
    folder
        .ruga("simulate scene.toml -o out --format obj,glb --threads 1")
        .exits(0);
    let path = glb_of(&folder, "out");
    assert!(path.starts_with("out/frames/burn/"), "{path}");
    let mesh = read_mesh(&folder.path(&path), None, &ObjOptions::default()).unwrap();
    let names: Vec<&str> = mesh.mesh.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["burn_25", "burn_50", "burn_75", "burn_100"]);
    let end = read_obj_positions(&folder.path("out/meshes/burn/body_100.obj")).unwrap();
    let last = mesh.mesh.shapes[3].position_deltas.iter();
    for ((way, rest), end) in last.zip(&mesh.mesh.positions).zip(&end) {
        assert!((rest + way - end).norm() < 1e-7);
    }
    // Skin that wrinkles is no mesh of the artist's that moves.
    Folder::new()
        .ruga("simulate scene.toml -o out --format glb")
        .exits(2)
        .says(&["--format glb", "no `[sheet]`"]);
}

#[test]
fn plies_are_told_with_what_they_are_as_stiff_as() {
    let folder = folder();
    let plies = "plies = [{ name = \"lower\", young = 1e9, thickness = 8e-5 }, { name = \"upper\", young = 4e9, thickness = 4e-5 }]";
    folder.write(
        "plies.toml",
        SCENE
            .replace("young = 3e9", plies)
            .replace("thickness = 2e-4\n", ""),
    );
    let told = |command: &str| folder.ruga(command).exits(0).stdout;
    let planned = told("plan plies.toml");
    let words = "2 plies, 0.120 mm in all, as stiff as 0.113 mm of 2121.320 MPa";
    assert!(planned.contains(words), "{planned}");
    let checked = told("check plies.toml");
    let words = "layer `leaf`: 2 plies, as stiff as 2121.3203 MPa, 0.113 mm thick";
    assert!(checked.contains(words), "{checked}");
}
