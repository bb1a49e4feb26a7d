//! Scenes that are refused, and in which words.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::scenes::{LEAST, parse, refused, with};
use fixture::{Folder, SCENE, assert_says};
use ruga_scene::SceneFile;

#[test]
fn slips_of_the_hand_get_a_suggestion() {
    refused(
        "smoothing =",
        "smothing =",
        &["driver", "smothing", "did you mean `smoothing`", "line 10"],
    );
    refused(
        "young = 4e6",
        "yuong = 4e6",
        &["layers[0]", "yuong", "did you mean `young`"],
    );
    refused("[remesh]", "[remsh]", &["remsh", "did you mean `remesh`"]);
    refused(
        "\"hybrid\"",
        "\"hybird\"",
        &["layers[0].coupling", "hybird", "did you mean `hybrid`"],
    );
    refused(
        "\"png16\"",
        "\"png\"",
        &["bake.format", "did you mean `png"],
    );
    refused(
        "\"normal\", ",
        "\"norm\", ",
        &["bake.maps[0]", "did you mean `normal`"],
    );
    refused(
        "image = \"dermis.png\"",
        "imgae = \"dermis.png\"",
        &["did you mean `image`"],
    );
    refused(
        "normal_y = \"+\"",
        "normal_y = \"up\"",
        &["bake.normal_y", "found \"up\"; accepted: \"+\", \"-\""],
    );
}

#[test]
fn words_that_a_key_does_not_take_are_answered_with_those_it_takes() {
    for (old, new, words) in [
        (
            "\"hybrid\"",
            "\"hybird\"",
            "`layers[0].coupling` (line 23): found \"hybird\"; accepted: \"constraint\", \"elastic\", \"hybrid\" \
             (did you mean `hybrid`?)",
        ),
        (
            "\"static\"",
            "\"still\"",
            "`solver.mode` (line 33): found \"still\"; accepted: \"static\", \"dynamic\"",
        ),
        (
            "\"height\"]",
            "\"\"]",
            "`bake.maps[1]` (line 48): found \"\"; accepted: \"normal\", \"height\", ",
        ),
        (
            "smoothing = \"loop\"",
            "symmetry = \"y\"",
            "`driver.symmetry` (line 10): found \"y\"; accepted: \"x\"",
        ),
        (
            "length_unit = \"m\"",
            "length_unit = \"inch\"",
            "`length_unit` (line 4): found \"inch\"; accepted: \"m\"",
        ),
    ] {
        refused(old, new, &[words]);
    }
}

#[test]
fn lists_of_numbers_have_their_length() {
    let top = LEAST.replace("[substrate]\n", "");
    let handle = "{ name = \"clip\", min = [-1, -1, -1], max = [0.001, 1, 1] }";
    let text = format!("{top}[sheet]\ngravity = [0, 0, -9.81]\nhandles = [{handle}]\n");
    assert!(parse(&text).is_ok());
    for (old, new, words) in [
        (
            "[0, 0, -9.81]",
            "[0, 0, -9.81, 0]",
            "`sheet.gravity` (line 10): found a list of 4; accepted: a list of 3 numbers, such as",
        ),
        (
            "[-1, -1, -1]",
            "[-1, -1, -1, -1, -1]",
            "`sheet.handles[0].min` (line 11): found a list of 5; accepted: a list of 3 numbers",
        ),
        (
            "[-1, -1, -1]",
            "[-1, -1]",
            "`sheet.handles[0].min` (line 11): found a list of 2; accepted: a list of 3 numbers",
        ),
    ] {
        assert!(text.contains(old), "{old}");
        assert_says(parse(&text.replacen(old, new, 1)), "scene.toml", &[words]);
    }
    let map = "map = { image = \"dermis.png\", wavelength = [0.5, 2.0], young = [0.5, 2.0]";
    let longer = map.replace("2.0]", "2.0, 3.0]");
    refused(
        map,
        &longer,
        &["`layers[0].map.wavelength` (line 24): found a list of 3; accepted: a list of 2 numbers"],
    );
    // Other lists are as long as they like.
    assert!(with("keys = [0.5, 1.0]", "keys = [0.2, 0.4, 0.6, 0.8]").is_ok());
}

#[test]
fn unknown_keys_are_sent_to_their_table() {
    refused(
        "region = \"auto\"",
        "young = 1e6",
        &[
            "`young` is not a key of `[driver]`",
            "`[substrate]` or `[[layers]]`",
            "line 9",
        ],
    );
    refused(
        "normal_y = \"+\"",
        "points_per_wavelength = 6",
        &["bake", "it belongs in `[remesh]`"],
    );
    refused(
        "version = 1",
        "version = 1\nmesh = \"a.glb\"",
        &["`mesh` is not a key of the top of the file", "`[driver]`"],
    );
    refused(
        "young = 4e6",
        "zzz = 4e6",
        &["`zzz` is not a key of `[[layers]]`, which has `name`, `preset`"],
    );
    refused(
        "normal_y = \"+\"",
        "tolerence = 0.5",
        &[
            "`tolerence` is not a key of `[bake]`",
            "did you mean `tolerance` in `[solver]`?",
        ],
    );
}

#[test]
fn unknown_keys_of_what_holds_a_sheet_are_told_as_those_of_a_body() {
    let top = LEAST.replace("[substrate]\n", "");
    for (table, header) in [
        ("[sheet]\nhandles", "[[sheet.handles]]"),
        ("[interior]\nhandles", "[[interior.handles]]"),
    ] {
        let handle = "{ name = \"clip\", mim = [-1, -1, -1], max = [0.001, 1, 1] }";
        let words = format!("`mim` is not a key of `{header}`, which has `name`, `min`, `max`");
        let error = parse(&format!("{top}{table} = [{handle}]\n"));
        assert_says(error, "scene.toml", &[&words, "did you mean `min`"]);
    }
    let text = format!(
        "{top}[sheet]\n[[sheet.obstacles]]\nname = \"floor\"\n[sheet.obstacles.plane]\nnorml = [0, 0, 1]\n"
    );
    let words = "`norml` is not a key of `[sheet.obstacles.plane]`, which has";
    assert_says(parse(&text), "scene.toml", &[words]);
    // Advice stays within the sheet, which no scene has beside a body.
    let text = format!("{top}[sheet]\n[[sheet.obstacles]]\nname = \"ball\"\nradius = 0.1\n");
    let words = "is not a key of `[[sheet.obstacles]]`; it belongs in `[sheet.obstacles.sphere]`";
    assert_says(parse(&text), "scene.toml", &[words]);
    let text = format!("{top}\"sheet.handles\" = 1\n");
    let words = "`sheet.handles` is not a key of";
    assert_says(parse(&text), "scene.toml", &[words]);
}

#[test]
fn keys_of_earlier_versions_are_told_apart_from_slips() {
    for value in ["ldlt", "minres"] {
        let line = format!("mode = \"static\"\nlinear = \"{value}\"");
        let error = with("mode = \"static\"", &line).unwrap_err().to_string();
        let words = "`linear` is no longer a key of `[solver]`: linear systems are always solved by \
                     direct LDL^T factorisation; leave the key out";
        assert!(
            error.contains(words) && !error.contains("did you mean"),
            "{error}"
        );
    }
    // Elsewhere it was never one.
    refused(
        "size = 2048",
        "linear = 1",
        &["`linear` is not a key of `[bake]`"],
    );
}

#[test]
fn keys_given_twice_are_named_with_both_lines() {
    refused(
        "young = 4e6",
        "young = 4e6\nyoung = 5e6",
        &["line 20", "`young` is given twice; first in line 19"],
    );
    refused(
        "[remesh]",
        "[driver]\nmesh = \"b.glb\"\n[remesh]",
        &["[driver] is given twice; first in line 6"],
    );
    refused(
        "{ compress = 1.0 }",
        "{ compress = 1.0, compress = 0.5 }",
        &["line 28", "`compress` is given twice; first in line 28"],
    );
}

#[test]
fn files_that_are_no_scene() {
    let folder = Folder::new();
    let words = ["this is a mesh", "ruga new --mesh", "face.glb DIR"];
    let mesh = folder.file("face.glb", b"glTF\x02\0\0\0\xff");
    assert_says(SceneFile::read(&mesh), "face.glb", &words);
    let obj = folder.file("face.obj", "v 0 0 0\n");
    assert_says(SceneFile::read(&obj), "face.obj", &["this is a mesh"]);
    let image = folder.file("mask.png", b"\x89PNG\r\n\x1a\n");
    assert_says(SceneFile::read(&image), "mask.png", &["this is an image"]);
}

#[test]
fn weights_in_per_cent() {
    refused(
        "compress = 1.0",
        "compress = 30",
        &[
            "poses[0].weights.compress",
            "-10 to 10",
            "did you mean `0.3`",
        ],
    );
    for good in ["1.2", "-0.5", "10"] {
        assert!(with("compress = 1.0", &format!("compress = {good}")).is_ok());
    }
}

#[test]
fn wrong_types_and_no_toml() {
    refused(
        "young = 4e6",
        "young = \"4e6\"",
        &[
            "layers[0].young",
            "line 19",
            "found \"4e6\"; accepted: a number without quotes and unit; write 4e6",
        ],
    );
    refused(
        "keys = [0.5, 1.0]",
        "keys = 1.0",
        &[
            "poses[0].keys",
            "found 1.0; accepted: a list in brackets, such as `[0.5, 1.0]`",
        ],
    );
    refused(
        "seed = 1",
        "seed = -1",
        &["solver.seed", "found -1; accepted: a whole number"],
    );
    refused(
        "[bake]",
        "[bake",
        &["line 46", "the closing bracket is missing after `[bake`"],
    );
    refused(
        "mesh = \"forearm.glb\"\n",
        "",
        &[
            "`driver`",
            "the key `mesh` is missing; write `mesh = \"face.glb\"`",
        ],
    );
    for (old, new, words) in [
        (
            "{ compress = 1.0 }",
            "[\"compress\"]",
            "found a list; accepted: a table `{ name = number }`",
        ),
        (
            "size = 2048",
            "size = 20.5",
            "found 20.5; accepted: a whole number, such as 2048",
        ),
        (
            "young = [0.5, 2.0]",
            "young = [0.5]",
            "found a list of 1; accepted: a list of 2 numbers",
        ),
        (
            "[\"normal\", \"height\"]",
            "[1]",
            "accepted: \"normal\", \"height\"",
        ),
        (
            "\"hybrid\"",
            "{ hybrid = 1 }",
            "this is not a word in quotes; accepted: \"constraint\", ",
        ),
        (
            "\"hybrid\"",
            "{}",
            "this is not a word in quotes; accepted: \"constraint\", ",
        ),
        (
            "enabled = true",
            "enabled = 1",
            "found 1; accepted: `true` or `false`",
        ),
        (
            "name = \"dermis\"",
            "name = 3",
            "found 3; accepted: text in quotes",
        ),
    ] {
        refused(old, new, &[words]);
    }
    let folder = Folder::new();
    assert_says(
        SceneFile::read(&folder.path("no.toml")),
        "no.toml",
        &["no such file"],
    );
    let binary = folder.file("binary.toml", [b'a', b'\n', 0xff]);
    assert_says(
        SceneFile::read(&binary),
        "binary.toml",
        &["line 2", "UTF-8"],
    );
}

#[test]
fn numbers_with_commas_and_units_are_answered_with_the_number() {
    for (value, written) in [
        ("0,7e-3", "0.7e-3"),
        ("0.7 mm", "0.7e-3"),
        ("\"0.7 mm\"", "0.7e-3"),
        (".7", "0.7"),
    ] {
        let new = format!("thickness = {value}");
        refused(
            "thickness = 1.3e-3",
            &new,
            &["line 21", value, written, "in metres"],
        );
    }
    refused(
        "young = 4e6",
        "young = 4 MPa",
        &["`4 MPa` is not a number; write `young = 4e6`, which is in pascals"],
    );
    refused(
        "compress = 1.0",
        "compress = 0,5",
        &["line 28", "a comma stands between two digits"],
    );
}

#[test]
fn slips_of_brackets_quotes_and_signs() {
    refused(
        "[[layers]]",
        "[layers]",
        &[
            "line 17",
            "found [layers]; write `[[layers]]`, with two brackets",
        ],
    );
    refused(
        "[driver]",
        "[[driver]]",
        &["line 6", "write `[driver]`, with one bracket"],
    );
    let again = "[poses]\nname = \"b\"\nweights = { a = 1 }\n\n[solver]";
    let error = parse(
        &SCENE
            .replacen("[[poses]]", "[poses]", 1)
            .replacen("[solver]", again, 1),
    );
    assert_says(
        error,
        "scene.toml",
        &["write `[[poses]]`, with two brackets"],
    );
    for (mesh, words) in [
        (
            "\"C:\\Users\\a.glb\"",
            "write `/` instead, or single quotes: `mesh = 'C:\\Users\\a.glb'`",
        ),
        (
            "forearm.glb",
            "in straight quotes, as in `mesh = \"forearm.glb\"`",
        ),
        (
            "“forearm.glb”",
            "in straight quotes, as in `mesh = \"forearm.glb\"`",
        ),
        ("\"forearm.glb", "the closing quote is missing"),
        ("", "`mesh` has no value"),
    ] {
        refused(
            "mesh = \"forearm.glb\"",
            &format!("mesh = {mesh}"),
            &["line 7", words],
        );
    }
    refused(
        "version = 1",
        "version: 1",
        &["line 2", "the `=` is missing; write `version = 1`"],
    );
    refused(
        "version = 1\n",
        "",
        &["the key `version` is missing; write `version = 1` above the first table"],
    );
    let without = parse("version = 1\n[driver]\nmesh = \"a.glb\"\n");
    assert_says(
        without,
        "scene.toml",
        &["there is no layer; write `[[layers]]`"],
    );
}

#[test]
fn names_that_cannot_be_files() {
    for bad in [
        "", "a/b", "a\\\\b", "con", "NUL.txt", " a", "a.", "a:b", "a\\tb",
    ] {
        let new = format!("name = \"{bad}\"");
        refused("name = \"compress\"", &new, &["poses[0].name", "file name"]);
        refused("name = \"dermis\"", &new, &["layers[0].name", "file name"]);
    }
    let again = "[[poses]]\nname = \"Compress\"\nweights = { a = 1 }\n\n[solver]";
    refused("[solver]", again, &["poses[1].name", "letter case"]);
    let names = "näme = 1";
    assert!(parse(&SCENE.replacen("name = \"compress\"", "name = \"Lächeln 3\"", 1)).is_ok());
    assert!(parse(names).is_err());
}

#[test]
fn contradictions() {
    let second = "[[layers]]\nname = \"epidermis\"\nyoung = 6e8\nthickness = 1.2e-4\n\n[[poses]]";
    assert!(parse(&SCENE.replacen("[[poses]]", second, 1)).is_ok());
    refused(
        "mesh_name = \"Forearm\"",
        "targets = { a = \"a.obj\" }",
        &["driver.targets", "OBJ"],
    );
    refused(
        "image = \"dermis.png\", ",
        "",
        &["layers[0].map.wavelength", "no image"],
    );
    refused(
        "image = \"dermis.png\"",
        "image = \"a.png\", young_image = \"b.png\"",
        &["not both"],
    );
    let map = "{ image = \"dermis.png\", wavelength = [0.5, 2.0], young = [0.5, 2.0], thickness = [0.5, 2.0] }";
    refused(map, "{ image = \"a.png\" }", &["layers[0].map", "range"]);
    refused(
        map,
        "{ young_image = \"a.png\" }",
        &["layers[0].map.young_image", "lo, hi"],
    );
    assert!(with(map, "{ young_image = \"a.png\", young = [2.0, 0.5] }").is_ok());
}
