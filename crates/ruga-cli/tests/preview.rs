//! The preview page of a folder: what `bake` and `preview` write, and what keeps them from it.

mod fixture;

use std::fs;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use fixture::Folder;
use ruga_io::read_image;
use serde_json::Value;

/// A folder whose scene is baked into `out`.
fn baked() -> Folder {
    let folder = Folder::new();
    folder.ruga("bake scene.toml -o out").exits(0);
    folder
}

/// What the page says about its data.
fn about(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"about\">").expect("the description");
    let (json, _) = rest.split_once("</script>").expect("its end");
    serde_json::from_str(json).expect("JSON")
}

#[test]
fn bake_and_preview_write_the_same_page() {
    let folder = baked();
    let page = folder.read("out/preview.html");
    let about = about(&String::from_utf8_lossy(&page));
    assert_eq!(about["size"], 64);
    assert_eq!(about["poses"][0]["name"], "squeezed");
    assert_eq!(about["poses"][0]["maps"][0]["key"], 0.5);
    assert_eq!(about["maps"].as_array().expect("a list").len(), 2);

    fs::remove_file(folder.path("out/preview.html")).expect("the page");
    let run = folder.ruga("preview out").exits(0);
    assert!(run.stdout.contains("preview.html"), "{}", run.stdout);
    assert!(folder.read("out/preview.html") == page);
    // A copy for an engine has no records.
    fs::remove_dir_all(folder.path("out/poses")).expect("the records");
    folder.ruga("preview out").exits(0);
    assert!(folder.read("out/preview.html") == page);
    assert!(!folder.path("out/poses").exists());
}

/// Bakes the scene; values of the first map of its page.
fn first_map(folder: &Folder) -> Vec<f32> {
    folder.ruga("bake scene.toml -o out").exits(0);
    let page = String::from_utf8(folder.read("out/preview.html")).expect("text");
    let (_, rest) = page.split_once("id=\"map0\">").expect("a map");
    let (text, _) = rest.split_once("</script>").expect("its end");
    folder.write("map.png", BASE64_STANDARD.decode(text).expect("base64"));
    read_image(&folder.path("map.png")).expect("a PNG").values
}

#[test]
fn formats_and_the_sign_of_green_make_no_difference() {
    let wanted = first_map(&Folder::new());
    assert!(
        wanted
            .iter()
            .any(|value| (value - 128.0 / 255.0).abs() > 0.1)
    );
    let others = [
        ("normal_y = \"-\"", 1),
        ("format = \"exr\"", 1),
        ("format = \"exr\"\nnormal_y = \"-\"", 1),
        // Dithered.
        ("format = \"png8\"", 2),
    ];
    for (line, codes) in others {
        let other = first_map(&Folder::with("size = 64", &format!("size = 64\n{line}")));
        assert_eq!(other.len(), wanted.len(), "{line}");
        let apart = other
            .iter()
            .zip(&wanted)
            .map(|(a, b)| (255.0 * (a - b)).abs());
        let largest = apart.fold(0.0, f32::max).round() as i32;
        assert!(largest <= codes, "{line}: {largest} codes apart");
    }
}

#[test]
fn folders_without_maps_or_mesh_are_refused() {
    let folder = Folder::new();
    folder
        .ruga("preview nowhere")
        .exits(2)
        .says(&["nowhere", "no wrinkles.json", "--output"]);
    folder.ruga("bake scene.toml -o bare --maps-only").exits(0);
    assert!(!folder.path("bare/preview.html").exists());
    folder
        .ruga("preview bare")
        .exits(2)
        .says(&["no GLB", "--maps-only"]);
    folder.change("scene.toml", "size = 64", "size = 64\nmaps = [\"height\"]");
    let run = folder.ruga("bake scene.toml -o heights").exits(0);
    assert!(!run.stderr.contains("preview"), "{}", run.stderr);
    folder
        .ruga("preview heights")
        .exits(2)
        .says(&["no normal map", "[bake]"]);
    for name in ["bare", "heights"] {
        assert!(!folder.path(format!("{name}/preview.html")).exists());
    }
}

#[test]
fn missing_and_foreign_files_are_named_and_the_page_stays() {
    let folder = baked();
    let page = folder.read("out/preview.html");
    let map = "out/maps/squeezed_50_normal.png";
    let refused = |file: &str, spoil: &dyn Fn(), texts: &[&str]| {
        let whole = folder.read(file);
        spoil();
        folder.ruga("preview out").exits(2).says(texts);
        fs::write(folder.path(file), whole).expect("the file");
        assert!(folder.read("out/preview.html") == page);
        assert!(
            folder
                .files("out")
                .iter()
                .all(|name| !name.ends_with(".tmp"))
        );
    };
    let removed = |file: &'static str| {
        let path = folder.path(file);
        move || fs::remove_file(&path).expect("the file")
    };
    let written = |file: &'static str, bytes: Vec<u8>| {
        let path = folder.path(file);
        move || fs::write(&path, &bytes).expect("the file")
    };
    refused(
        map,
        &removed(map),
        &["squeezed_50_normal.png", "no such file", "--resume"],
    );
    refused(
        "out/Patch.glb",
        &removed("out/Patch.glb"),
        &["Patch.glb", "no such file"],
    );
    let height = folder.read("out/maps/squeezed_50_height.png");
    refused(
        map,
        &written(map, height),
        &["squeezed_50_normal.png", "another run", "1 channel"],
    );
    let half = folder.read(map)[..200].to_vec();
    refused(
        map,
        &written(map, half),
        &["squeezed_50_normal.png", "cut short"],
    );
    let manifest = "out/wrinkles.json";
    refused(
        manifest,
        &written(manifest, b"{".to_vec()),
        &["wrinkles.json", "no list of wrinkle maps"],
    );
    let text = String::from_utf8(folder.read(manifest)).expect("text");
    let later = text
        .replacen("\"version\": 1", "\"version\": 9", 1)
        .into_bytes();
    refused(
        manifest,
        &written(manifest, later),
        &["version 9", "accepted: 1"],
    );
    let shape = text.replace("\"squeeze\":", "\"squash\":").into_bytes();
    refused(
        manifest,
        &written(manifest, shape),
        &["Patch.glb", "another run", "`squash`"],
    );
    let keys = text.replace("\"key\": 0.5", "\"key\": 0.4").into_bytes();
    refused(
        manifest,
        &written(manifest, keys),
        &["squeezed.json", "another run", "baked again"],
    );
}

#[test]
fn maps_of_another_size_are_refused() {
    let folder = baked();
    let small = Folder::with("size = 64", "size = 32");
    small.ruga("bake scene.toml -o out").exits(0);
    let map = "out/maps/squeezed_100_normal.png";
    fs::write(folder.path(map), small.read(map)).expect("the map");
    folder
        .ruga("preview out")
        .exits(2)
        .says(&["32 x 32", "not 64 x 64", "--resume"]);
}

#[test]
fn a_file_of_the_users_is_not_replaced() {
    let folder = baked();
    fs::write(folder.path("out/preview.html"), "mine").expect("a file");
    folder
        .ruga("preview out")
        .exits(2)
        .says(&["no preview that ruga has made", "--force"]);
    let run = folder.ruga("bake scene.toml -o out --resume").exits(0);
    assert!(
        run.stderr.contains("preview.html was not made"),
        "{}",
        run.stderr
    );
    assert_eq!(folder.read("out/preview.html"), b"mine");
    folder.ruga("preview out --force").exits(0);
    assert_ne!(folder.read("out/preview.html"), b"mine");
}
