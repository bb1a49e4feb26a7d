//! Files that a reader once panicked on, took too much memory for, or took and could not write.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, SQUARE_OBJ, assert_says, read, square};
use ruga_io::{GlbAdditions, write_glb};
use serde_json::json;

/// tobj multiplied these indices by two, unchecked.
#[test]
fn obj_indices_that_are_not_there() {
    let folder = Folder::new();
    for (face, line, words) in [
        (
            "f 1/1/1 2/-9223372036854775807/1 3/3/1",
            "line 12",
            "5 texture coordinates",
        ),
        ("f 1/1/1 2/0/1 3/3/1", "line 12", "index 0"),
        ("f 1/1/1 2/2/-2 3/3/1", "line 12", "1 normals"),
        ("f 1/1/1 2/2/1 5/3/1", "line 12", "4 vertices"),
        ("f -1 -2 -5", "line 12", "index -5"),
    ] {
        let text = SQUARE_OBJ.replace("f 1/1/1 2/2/1 3/3/1", face);
        assert_says(read(&folder.file("a.obj", text)), "a.obj", &[line, words]);
    }
    // Where there are none, such indices mean nothing.
    let bare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1/1 2/2/1 -1/3/1\n";
    assert_eq!(
        read(&folder.file("b.obj", bare))
            .unwrap()
            .mesh
            .triangles
            .len(),
        1
    );
}

/// OBJ has numbers that no GLB holds; they were found out after the simulation.
#[test]
fn coordinates_beyond_32_bits() {
    let folder = Folder::new();
    for (from, to, words) in [
        ("v 1 1 0", "v 1 1e39 0", ["vertex 2 of the mesh", "1e39"]),
        (
            "vt 1 1",
            "vt 1 -1e200",
            ["texture coordinate of vertex 2", "1e200"],
        ),
    ] {
        let text = SQUARE_OBJ.replace(from, to);
        assert_says(read(&folder.file("a.obj", text)), "a.obj", &words);
    }
    let (mut json, bin) = square();
    json["nodes"][0]["scale"] = json!([1e35, 1e35, 1e35]);
    assert_says(
        folder.read_glb(&json, &bin),
        "mesh.glb",
        &["e35", "up to 1e30"],
    );
    let mut file = read(&folder.file("a.obj", SQUARE_OBJ)).unwrap();
    file.mesh.positions[1].x = 1e39;
    let path = folder.path("b.glb");
    let written = write_glb(&path, &file, &GlbAdditions::default());
    assert_says(written, "b.glb", &["vertex 1", "32 bits"]);
    assert!(!path.exists());
}
