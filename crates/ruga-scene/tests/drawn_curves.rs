//! Creases along curves that were drawn beside the mesh in its own file.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fmt::Write as _;

use fixture::{Folder, assert_says};
use ruga_scene::{Scene, SceneError};

/// A square of 100 mm of 8 by 8 cells, and above it an object `Palm` of two curves: an edge of 50 mm along x, 1 mm
/// above, and a chain of 40 mm along y. `press` moves all by a tenth in x.
fn square(press: f64) -> String {
    let mut text = String::from("o Skin\n");
    for (i, j) in (0..81).map(|v| (v % 9, v / 9)) {
        let [x, y] = [i, j].map(|c| f64::from(c) / 8.0);
        let _ = writeln!(
            text,
            "v {} {} 0\nvt {x} {y}",
            100.0 * (1.0 - press) * x,
            100.0 * y
        );
    }
    for (i, j) in (0..64).map(|q| (q % 8, q / 8)) {
        let a = 9 * j + i + 1;
        let [b, c, d] = [a + 1, a + 10, a + 9];
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}");
    }
    text.push_str("o Palm\nv 20 31 1\nv 70 31 1\nv 83 20 0\nv 83 41 0.5\nv 83 60 0\nl 82 83\nl 84 85\nl 85 86\n");
    text
}

fn read(crease: &str) -> Result<Scene, SceneError> {
    let folder = Folder::new();
    folder.file("skin.obj", square(0.0));
    folder.file("press.obj", square(0.1));
    let text = format!(
        "version = 1\nlength_unit = \"mm\"\n[driver]\nmesh = \"skin.obj\"\nmesh_name = \"Skin\"\n\
         targets = {{ press = \"press.obj\" }}\n[[layers]]\nname = \"skin\"\npreset = \"cheek\"\n\
         [[creases]]\nname = \"palm\"\n{crease}\n"
    );
    Scene::read(&folder.file("scene.toml", text))
}

#[test]
fn each_polyline_of_the_named_object_is_a_line_on_the_skin() {
    let scene = read("line_mesh = \"Palm\"").unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    let lines: Vec<(&str, f64)> = scene.layers[0]
        .creases
        .iter()
        .map(|crease| (crease.name.as_str(), 1e3 * crease.line.length()))
        .collect();
    assert_eq!(lines.len(), 2);
    for ((name, length), (wanted, millimetres)) in
        lines.iter().zip([("palm-1", 50.0), ("palm-2", 40.0)])
    {
        assert_eq!(*name, wanted);
        assert!((length - millimetres).abs() < 1e-3, "{length}");
    }
    // Put onto the skin, whose corner is at the origin.
    let place = scene.layers[0].creases[0].line.place(0.0).unwrap();
    let at = place.interpolate(scene.driver.topology(), scene.driver.rest());
    assert!(
        (at - nalgebra::Vector3::new(0.02, 0.031, 0.0)).norm() < 1e-9,
        "{at}"
    );
}

#[test]
fn curves_that_cannot_be_used_are_refused() {
    let rows: [(&str, &[&str]); 5] = [
        (
            "line_mesh = \"Palms\"",
            &["creases[0].line_mesh", "Palms", "did you mean", "Palm"],
        ),
        ("line_mesh = \"Skin\"", &["creases[0].line_mesh", "Skin"]),
        (
            "line_mesh = \"Palm\"\nreach = 0.0005",
            &["creases[0].line_mesh", "`Palm`", "1.00 mm", "0.50 mm"],
        ),
        (
            "uv = [[0.1, 0.2], [0.5, 0.2]]\nreach = 1e-3",
            &["creases[0].reach", "only with"],
        ),
        (
            "edges = [10, 11, 12]",
            &["creases[0].edges", "OBJ", "line_mesh"],
        ),
    ];
    for (crease, words) in rows {
        assert_says(
            read(crease).map(|scene| scene.warnings),
            "scene.toml",
            words,
        );
    }
}
