//! Files that a reader once panicked on, took too much memory for, or took and could not write.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, SQUARE_OBJ, assert_says, read};

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
