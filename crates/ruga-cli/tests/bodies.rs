//! Soft bodies through the command: a block that handles press together.

mod fixture;

use fixture::Folder;
use nalgebra::{Matrix4, Vector3};
use ruga_io::{GlbAdditions, ObjOptions, read_mesh, write_glb};

const SCENE: &str = r#"version = 1

[driver]
mesh = "block.obj"
smoothing = "none"

[substrate]
young = 20e3
poisson = 0.4
thickness = 0.02

[[layers]]
name = "skin"
wavelength = 0.04
critical_strain = 0.02

[interior]
cells = 6

[[interior.handles]]
name = "left"
min = [-0.01, -1.0, -1.0]
max = [0.04, 1.0, 1.0]

[[interior.handles]]
name = "right"
min = [0.20, -1.0, -1.0]
max = [0.25, 1.0, 1.0]

[[poses]]
name = "press"
keys = [0.5, 1.0]
steps = 2
motions = [{ of = "right", at = 1.0, move = [-0.012, 0.0, 0.0] }]

[remesh]
points_per_wavelength = 4

[bake]
size = 64
padding = 2
"#;

/// Corners by bits: x, y, z.
const SIDES: [[usize; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

/// A closed block of 24 x 8 x 8 cm, every side of it a chart of its own.
fn block() -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from((corner >> axis) & 1));
        text += &format!("v {} {} {}\n", 0.24 * x, 0.08 * y, 0.08 * z);
    }
    for side in 0..6 {
        let [left, right] = [0.02, 0.98].map(|share| (f64::from(side) + share) / 6.0);
        for [u, v] in [[left, 0.02], [right, 0.02], [right, 0.98], [left, 0.98]] {
            text += &format!("vt {u} {v}\n");
        }
    }
    for (side, corners) in SIDES.iter().enumerate() {
        for triangle in [[0, 1, 2], [0, 2, 3]] {
            let corner = |k: usize| format!("{}/{}", corners[k] + 1, 4 * side + k + 1);
            text += &format!("f {}\n", triangle.map(corner).join(" "));
        }
    }
    text
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("block.obj", block());
    folder.write("body.toml", SCENE);
    folder
}

/// A lattice without a number of cells gets one that nothing speaks against.
#[test]
fn the_plan_chooses_the_cells() {
    let folder = folder();
    let cells = SCENE.lines().find(|line| line.starts_with("cells"));
    folder.change("body.toml", cells.expect("a number of cells"), "");
    folder.change("body.toml", "wavelength = 0.04", "wavelength = 0.02");
    let json = folder.ruga("plan body.toml --json").exits(0);
    let plan: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    let along = plan["interior"]["cells_along"].as_u64().unwrap();
    assert_eq!(along, 6, "{plan}");
    assert!(!plan["warnings"].to_string().contains("lattice"), "{plan}");
    let text = folder.ruga("plan body.toml").exits(0).stdout;
    let told = format!("{along} along the longest side");
    assert!(text.contains(&told), "{text}");
    folder
        .ruga("plan body.toml --image plan.png")
        .exits(2)
        .says(&["plan.png", "known only when it is simulated"]);
}

#[test]
fn a_body_is_planned_checked_simulated_and_baked() {
    let folder = folder();
    let planned = folder.ruga("plan body.toml").exits(0);
    for word in ["interior:", "lattice cells", "press", "points/wave"] {
        assert!(planned.stdout.contains(word), "{}", planned.stdout);
    }
    let json = folder.ruga("plan body.toml --json").exits(0);
    let plan: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert!(plan["interior"]["nodes"].as_u64().unwrap() > 50, "{plan}");
    assert!(
        plan["poses"][0]["seconds"].as_f64().unwrap() > 0.0,
        "{plan}"
    );
    folder.ruga("check body.toml").exits(0);

    folder
        .ruga("simulate body.toml -o frames --threads 1")
        .exits(0);
    let report = folder.json("frames/report.json");
    let layer = &report["poses"][0]["layers"][0];
    let measured = layer["wavelength_m"].as_f64().expect("it wrinkles");
    assert!((measured / 0.04 - 1.0).abs() < 0.25, "{layer}");
    assert!(layer["amplitude_m"].as_f64().unwrap() > 2e-4, "{layer}");

    folder
        .ruga("bake body.toml -o out --quality draft --threads 1")
        .exits(0);
    folder
        .ruga("bake body.toml -o two --quality draft --threads 2")
        .exits(0);
    for file in [
        "press_50_normal.png",
        "press_100_normal.png",
        "press_100_height.png",
    ] {
        let of = |run: &str| folder.read(&format!("{run}/maps/{file}"));
        assert_eq!(of("out"), of("two"), "{file} on two threads");
    }
    // The mesh that the body has moved, divided at the seams: four vertices to a side.
    for file in ["frames/meshes/press/body_", "out/bodies/press_"] {
        for (key, way) in [(50, 0.006), (100, 0.012)] {
            let moved = vertices(&folder, &format!("{file}{key}.obj"));
            assert_eq!(moved.len(), 24);
            let farthest = moved.iter().map(|p| p.x).fold(0.0, f64::max);
            assert!((farthest - 0.24 + way).abs() < 1e-6, "{farthest}");
        }
    }
    folder.change("body.toml", "padding = 2", "padding = 2\nframe = \"mesh\"");
    folder.change(
        "body.toml",
        "keys = [0.5, 1.0]\nsteps = 2",
        "keys = [0.5]\nsteps = 2",
    );
    folder
        .ruga("bake body.toml -o mesh --quality draft --threads 1")
        .exits(0);
    let of = |run: &str| folder.read(&format!("{run}/maps/press_50_normal.png"));
    assert_ne!(of("out"), of("mesh"), "the block's own facets");
}

/// Corners of a written mesh.
fn vertices(folder: &Folder, file: &str) -> Vec<Vector3<f64>> {
    let text = String::from_utf8(folder.read(file)).expect("a text");
    let numbers = |line: &str| {
        let numbers = line
            .split_whitespace()
            .map(|n| n.parse().expect("a number"));
        Vector3::from_iterator(numbers)
    };
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    lines.map(numbers).collect()
}

const GRAVITY: &str = "gravity = [-3.0, 0.0, 0.0]";
const TABLE: &str = "plane = { point = [0.0, 0.0, -2e-4], normal = [0.0, 0.0, 1.0] }";
const MOTION: &str =
    "move = [-0.012, 0.0, 0.0], turn = [0.0, 5.0, 0.0], about = [0.22, 0.04, 0.04]";

/// What holds a body, pulls it and presses it is where the world has it, wherever the file's node has
/// put the mesh. On meshes as they are: one that is fitted to strains is another after a turn, by rounding.
#[test]
fn a_node_moves_the_mesh_alone() {
    let folder = folder();
    let scene = SCENE
        .replace("block.obj", "body.glb")
        .replace("wavelength = 0.04", "wavelength = 0.06")
        .replace("cells = 6", &format!("cells = 6\n{GRAVITY}"))
        .replace(
            "[[poses]]",
            &format!("[[interior.obstacles]]\nname = \"table\"\n{TABLE}\n\n[[poses]]"),
        )
        .replace("move = [-0.012, 0.0, 0.0]", MOTION)
        .replace("keys = [0.5, 1.0]\nsteps = 2", "steps = 1")
        .replace(
            "[remesh]\npoints_per_wavelength = 4",
            "[remesh]\nenabled = false\npoints_per_wavelength = 3",
        );
    let mut mesh = read_mesh(&folder.path("block.obj"), None, &ObjOptions::default()).unwrap();
    let mut end = |name: &str, world_from_node: Matrix4<f64>, changes: &[(&str, &str)]| {
        mesh.world_from_node = world_from_node;
        let file = folder.path(format!("{name}.glb"));
        write_glb(&file, &mesh, &GlbAdditions::default()).unwrap();
        folder.write(&format!("{name}.toml"), &scene);
        for (from, to) in changes {
            folder.change(&format!("{name}.toml"), from, to);
        }
        folder
            .ruga(&format!("simulate {name}.toml -o {name}"))
            .exits(0);
        let skin = vertices(&folder, &format!("{name}/frames/press/skin.0000.obj"));
        let moved = folder.path(format!("{name}/meshes/press/body_100.obj"));
        let moved = read_mesh(&moved, None, &ObjOptions::default())
            .unwrap()
            .mesh;
        let corner = |v: u32| moved.positions[v as usize];
        let six_volumes = moved.triangles.iter().map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(corner);
            a.dot(&b.cross(&c))
        });
        (skin, six_volumes.sum::<f64>() / 6.0)
    };
    let (still, volume) = end("body", Matrix4::identity(), &[]);
    let lowest = still.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    assert!((-3e-4..-5e-5).contains(&lowest), "on the table: {lowest}");

    // A quarter turn about z, and a mirror across y, each with a shift.
    let mut turned = Matrix4::new_rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
    turned.append_translation_mut(&Vector3::new(1.0, 2.0, 3.0));
    let mut mirrored = Matrix4::new_nonuniform_scaling(&Vector3::new(1.0, -1.0, 1.0));
    mirrored.append_translation_mut(&Vector3::z());
    let changes_turned = [
        ("body.glb", "turned.glb"),
        ("[-0.01, -1.0, -1.0]", "[-1.0, 1.99, 2.0]"),
        ("[0.04, 1.0, 1.0]", "[2.0, 2.04, 4.0]"),
        ("[0.20, -1.0, -1.0]", "[-1.0, 2.20, 2.0]"),
        ("[0.25, 1.0, 1.0]", "[2.0, 2.25, 4.0]"),
        (GRAVITY, "gravity = [0.0, -3.0, 0.0]"),
        (
            TABLE,
            "plane = { point = [9.0, 9.0, 2.9998], normal = [0.0, 0.0, 1.0] }",
        ),
        (
            MOTION,
            "move = [0.0, -0.012, 0.0], turn = [-5.0, 0.0, 0.0], about = [0.96, 2.22, 3.04]",
        ),
    ];
    let changes_mirrored = [
        ("body.glb", "mirrored.glb"),
        ("[-0.01, -1.0, -1.0]", "[-0.01, -1.0, 0.0]"),
        ("[0.04, 1.0, 1.0]", "[0.04, 1.0, 2.0]"),
        ("[0.20, -1.0, -1.0]", "[0.20, -1.0, 0.0]"),
        ("[0.25, 1.0, 1.0]", "[0.25, 1.0, 2.0]"),
        (
            TABLE,
            "plane = { point = [0.0, 0.0, 0.9998], normal = [0.0, 0.0, 1.0] }",
        ),
        ("about = [0.22, 0.04, 0.04]", "about = [0.22, -0.04, 1.04]"),
    ];
    for (name, world_from_node, changes) in [
        ("turned", turned, changes_turned.as_slice()),
        ("mirrored", mirrored, &changes_mirrored),
    ] {
        let (skin, outward) = end(name, world_from_node, changes);
        assert_eq!(skin.len(), still.len());
        let pairs = skin.iter().zip(&still);
        let farthest = pairs
            .map(|(found, still)| {
                (found - world_from_node.transform_point(&(*still).into()).coords).norm()
            })
            .fold(0.0, f64::max);
        assert!(farthest < 1e-6, "{name}: {farthest}");
        assert!(
            (outward / volume - 1.0).abs() < 1e-6,
            "{name}: {outward} {volume}"
        );
    }
}

#[test]
fn a_body_moves_in_time() {
    let folder = folder();
    let dynamic = "[solver]\nmode = \"dynamic\"\ntime_step = 0.01\n\n[remesh]";
    folder.change("body.toml", "[remesh]", dynamic);
    folder.change(
        "body.toml",
        "cells = 6",
        "cells = 6\ngravity = [0.0, 0.0, -9.81]",
    );
    folder
        .ruga("simulate body.toml -o out --threads 1")
        .exits(0);
    let report = folder.json("out/report.json");
    assert_eq!(report["poses"][0]["converged"], true, "{report}");
    folder.change("body.toml", "dynamic", "static");
    folder
        .ruga("simulate body.toml -o still --threads 1")
        .exits(0);
    let end = |run: &str| folder.read(&format!("{run}/frames/press/skin.0001.obj"));
    assert_ne!(end("out"), end("still"), "two steps in time lag behind");
}

#[test]
fn handles_that_hold_nothing_or_everything_are_refused() {
    let with = |from: &str, to: &str| {
        let folder = folder();
        folder.change("body.toml", from, to);
        folder.ruga("simulate body.toml -o out").exits(2)
    };
    let nothing = with("max = [0.04, 1.0, 1.0]", "max = [-0.005, 1.0, 1.0]");
    nothing.says(&[
        "left",
        "[-0.0050, 1.0000, 1.0000]",
        "[0.0200, 0.0200, 0.0200]",
    ]);
    with("min = [0.20, -1.0, -1.0]", "min = [0.04, -1.0, -1.0]").says(&["hold"]);
}
