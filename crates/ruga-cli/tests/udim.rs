//! Meshes with UDIM tiles: images for each tile in, maps for each tile out.

mod fixture;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use fixture::{CELLS, Folder, SCENE, assert_alike};
use ruga_io::{PngTexels, read_image, write_png};

/// Left half in tile 1001, right half in tile 1012, with a margin.
fn two_tiles(x: f64, y: f64, column: usize) -> (f64, f64) {
    match column < CELLS / 2 {
        true => (0.05 + 1.8 * x, 0.05 + 0.9 * y),
        false => (1.05 + 1.8 * (x - 0.5), 1.05 + 0.9 * y),
    }
}

/// The scene on a mesh with two tiles, with all kinds of maps that have a scale of their own.
fn scene() -> Folder {
    let folder = Folder::with_cell_uvs(two_tiles);
    let maps = "maps = [\"normal\", \"height\", \"compression\", \"vector_displacement\"]\n";
    folder.write("scene.toml", SCENE.to_owned() + maps);
    folder
}

/// Writes a grey image of one value.
fn grey(folder: &Folder, name: &str, value: u8) {
    write_png(&folder.path(name), 4, 4, PngTexels::Grey8(&[value; 16]))
        .expect("a folder to write to");
}

fn values(folder: &Folder, name: &str) -> Vec<f32> {
    read_image(&folder.path(name)).expect("an image").values
}

/// Whether a normal map has wrinkles: more than two columns of padding beside a seam to a tile with some.
fn wrinkles(folder: &Folder, name: &str) -> bool {
    let texels = values(folder, name);
    let tilted = texels.chunks_exact(3);
    tilted.filter(|texel| (texel[0] - 0.5).abs() > 0.02).count() > 2 * 64
}

#[test]
fn every_map_is_a_file_for_each_tile() {
    let folder = scene();
    folder.write("scene.toml", folder.text("scene.toml") + "[pack]\n");
    folder
        .ruga("bake scene.toml -o out")
        .exits(0)
        .says(&["2 UDIM tiles (1001 and 1012)"]);
    let files = folder.files("out/maps");
    // Two keys of four kinds in two tiles.
    assert_eq!(files.len(), 16, "{files:?}");
    for tile in [1001, 1012] {
        for key in [50, 100] {
            let name = format!("out/maps/squeezed_{key}_normal.{tile}.png");
            assert!(wrinkles(&folder, &name), "{name}");
        }
    }
    let manifest = folder.json("out/wrinkles.json");
    let heights = &manifest["maps"][1];
    assert_eq!(heights["file"], "maps/squeezed_50_height.<UDIM>.png");
    assert_eq!(heights["tiles"], serde_json::json!([1001, 1012]));
    let report = folder.json("out/report.json");
    let listed = &report["poses"][0]["maps"]["100_normal"];
    assert_eq!(listed, "maps/squeezed_100_normal.<UDIM>.png");
    // One scale for both tiles: the higher of them uses all of it.
    let deepest = |tile: u32| {
        let heights = values(&folder, &format!("out/maps/squeezed_50_height.{tile}.png"));
        heights.iter().map(|h| (h - 0.5).abs()).fold(0.0, f32::max)
    };
    let deepest = [1001, 1012].map(deepest);
    assert!(deepest[0].max(deepest[1]) > 0.499, "{deepest:?}");
    assert!(deepest[0].min(deepest[1]) > 0.2, "{deepest:?}");
    let pack = folder.json("out/packed/pack.json");
    assert_eq!(pack["tiles"], serde_json::json!([1001, 1012]));
    assert_eq!(
        pack["maps"][0]["images"][0]["file"],
        "Patch_wm1_normal_gl.<UDIM>.png"
    );
    assert!(wrinkles(&folder, "out/packed/Patch_wm1_normal_gl.1012.png"));
    assert!(folder.path("out/packed/Patch_wm1_mask1.1001.png").exists());
    let page = folder.text("out/preview.html");
    assert!(page.contains("\"tiles\":2"));

    // A run that goes on makes again what lost the file of one tile, and removes what was packed.
    let before = folder.read("out/maps/squeezed_100_height.1012.png");
    std::fs::remove_file(folder.path("out/maps/squeezed_100_height.1012.png")).unwrap();
    let text = folder.text("scene.toml").replace("[pack]\n", "");
    folder.write("scene.toml", text);
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["not whole: it is made again"]);
    assert!(folder.read("out/maps/squeezed_100_height.1012.png") == before);
    assert!(folder.files("out/packed").is_empty());
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["is there from an earlier run"]);
}

#[test]
fn a_task_and_a_merge_make_the_tiles_that_a_bake_makes() {
    let folder = scene();
    folder.write("scene.toml", folder.text("scene.toml") + "[pack]\n");
    let task = "bake scene.toml -o parts --pose squeezed --task";
    folder.ruga(task).exits(0);
    folder.ruga("bake scene.toml -o parts --merge").exits(0);
    folder.ruga("bake scene.toml -o whole").exits(0);
    assert_alike(&folder, "parts", "whole");
    // A pose that lost the file of one tile is named, and the merge leaves the folder as it was.
    std::fs::remove_file(folder.path("parts/maps/squeezed_100_normal.1012.png")).unwrap();
    std::fs::remove_file(folder.path("whole/maps/squeezed_100_normal.1012.png")).unwrap();
    folder
        .ruga("bake scene.toml -o parts --merge")
        .exits(2)
        .says(&["`squeezed` lacks some of its files", "nothing was changed"]);
    assert_alike(&folder, "parts", "whole");
}

#[test]
fn the_page_of_a_plan_shows_all_tiles_in_one_picture() {
    let folder = scene();
    folder.ruga("plan scene.toml --preview plan.html").exits(0);
    let page = folder.text("plan.html");
    let (_, data) = page.split_once("id=\"overlay0\">").expect("a picture");
    let (data, _) = data.split_once("</script>").expect("its end");
    let picture = BASE64_STANDARD.decode(data.trim()).expect("base64");
    folder.write("plan.png", picture);
    let picture = read_image(&folder.path("plan.png")).expect("a PNG");
    // Two tiles beside each other, with room for two below, and eight texels around each.
    let side = 2 * (1024 + 2 * 8);
    assert_eq!([picture.width, picture.height], [side, side]);
    let reds = |tile: usize| {
        let texel = |row: usize, column: usize| &picture.values[3 * (row * side + column)..][..3];
        let from = 8 + tile * 1040;
        let texels = (8..1032).flat_map(|row| (from..from + 1024).map(move |at| texel(row, at)));
        texels.filter(|rgb| rgb[0] > rgb[2] + 0.2).count()
    };
    // Nearly a third of the texels of either tile are of skin that wrinkles.
    let counts = [reds(0), reds(1)];
    assert!(counts.iter().all(|count| *count > 300_000), "{counts:?}");
    assert!(page.contains("\"tiles\":0"));
}

#[test]
fn images_are_read_for_each_tile() {
    let folder = scene();
    folder.change(
        "scene.toml",
        "region = \"all\"",
        "region = \"area.<UDIM>.png\"",
    );
    folder.ruga("check scene.toml").exits(2).says(&[
        "driver.region",
        "area.1001.png",
        "there is no such file",
    ]);
    grey(&folder, "area.1012.png", 255);
    let run = folder.ruga("bake scene.toml -o out").exits(0).says(&[
        "warning: `driver.region`",
        "area.1001.png: there is no such file, though the mesh lies in tile 1001, too",
        "nothing is simulated there",
    ]);
    assert!(!run.stderr.contains("tile 1012,"), "{}", run.stderr);
    assert!(!wrinkles(&folder, "out/maps/squeezed_100_normal.1001.png"));
    assert!(wrinkles(&folder, "out/maps/squeezed_100_normal.1012.png"));
    // An image of another tile is another scene.
    grey(&folder, "area.1001.png", 255);
    std::fs::remove_file(folder.path("area.1012.png")).unwrap();
    folder
        .ruga("bake scene.toml -o out --resume")
        .exits(0)
        .says(&["older version of the scene"]);
    assert!(wrinkles(&folder, "out/maps/squeezed_100_normal.1001.png"));
    assert!(!wrinkles(&folder, "out/maps/squeezed_100_normal.1012.png"));
}

#[test]
fn painted_properties_differ_from_tile_to_tile() {
    let folder = scene();
    let map = "critical_strain = 0.05\nmap = { thickness_image = \"t.<UDIM>.png\", thickness = [0.5, 1.5] }";
    folder.change("scene.toml", "critical_strain = 0.05", map);
    grey(&folder, "t.1001.png", 0);
    grey(&folder, "t.1012.png", 255);
    let plan = |folder: &Folder| {
        let run = folder.ruga("plan scene.toml --json").exits(0);
        let plan: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        plan["poses"][0]["layers"][0]["thickness_range_m"].clone()
    };
    let range = plan(&folder);
    let [low, high] = [0, 1].map(|i| range[i].as_f64().unwrap());
    assert!((high / low - 3.0).abs() < 1e-6, "{low} {high}");
    // A plain image lies on the first tile, and one that repeats on all.
    grey(&folder, "t.png", 0);
    folder.change("scene.toml", "t.<UDIM>.png", "t.png");
    let range = plan(&folder);
    let [low, high] = [0, 1].map(|i| range[i].as_f64().unwrap());
    assert!((high / low - 2.0).abs() < 1e-6, "{low} {high}");
    folder.ruga("check scene.toml").exits(0).says(&[
        "layers[0].map.thickness_image",
        "is one image, and the mesh has UDIM tiles: it lies on tile 1001",
        "in tile 1012 the layer keeps its own values there",
    ]);
    folder.change(
        "scene.toml",
        "[0.5, 1.5] }",
        "[0.5, 1.5], wrap = \"repeat\" }",
    );
    let range = plan(&folder);
    assert_eq!(range[0], range[1]);
    let run = folder.ruga("check scene.toml").exits(0);
    assert!(!run.stderr.contains("UDIM"), "{}", run.stderr);
}

#[test]
fn a_plan_tells_and_draws_the_tiles() {
    let folder = scene();
    let run = folder.ruga("check scene.toml").exits(0);
    assert!(
        run.stdout.contains("2 UDIM tiles (1001 and 1012)"),
        "{}",
        run.stdout
    );
    let memory = |folder: &Folder| {
        let run = folder.ruga("plan scene.toml --json").exits(0);
        let plan: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        plan["poses"][0]["memory_bytes"].as_f64().unwrap()
    };
    folder.change("scene.toml", "size = 64", "size = 4096");
    let two = memory(&folder);
    folder.change(
        "scene.toml",
        "region = \"all\"",
        "region = \"all\"\ntiles = \"one\"",
    );
    let one = memory(&folder);
    assert!(two > one + 4e8, "{two} {one}");
    folder.change("scene.toml", "tiles = \"one\"", "tiles = \"udim\"");
    folder.ruga("plan scene.toml --image tiles.png").exits(0);
    let image = read_image(&folder.path("tiles.png")).expect("an image");
    // The panel begins below its heading; it has a cell of 300 pixels for each tile, in two columns.
    let coloured = |column: usize, row: usize| {
        let (left, top) = (16 + 300 * column, 52 + 300 * row);
        let pixels = (top..top + 300).flat_map(|y| (left..left + 300).map(move |x| [x, y]));
        let is_coloured = |[x, y]: [usize; 2]| {
            let first = 3 * (y * image.width + x);
            image.values[first] > image.values[first + 2] + 0.2
        };
        pixels.filter(|pixel| is_coloured(*pixel)).count()
    };
    for column in [0, 1] {
        let count = coloured(column, 0);
        assert!(count > 300 * 300 / 4, "tile in column {column}: {count}");
        assert_eq!(coloured(column, 1), 0);
    }
}

#[test]
fn a_triangle_across_tiles_is_refused_with_its_place() {
    // The fifth column reaches over the border between two tiles.
    let across = Folder::with_cell_uvs(|x, y, column| match column {
        4 => (0.95 + 0.8 * (x - 0.5), y),
        _ => two_tiles(x, y, column),
    });
    for line in ["plan scene.toml", "bake scene.toml -o out"] {
        across.ruga(line).exits(2).says(&[
            "patch.obj",
            "16 triangles of the skin that pose `squeezed` wrinkles are not in one UDIM tile",
            "the first is triangle 8, which spans tiles 1001 and 1002",
            "(0.950, 0.000), (1.050, 0.000), (1.050, 0.125)",
            "move every island into one tile",
        ]);
    }
    // Where nothing wrinkles it is told and does no harm.
    across.change("scene.toml", "region = \"all\"", "region = \"auto\"");
    across.change("scene.toml", "squeeze = 1.0", "stretch = 1.0");
    across
        .ruga("check scene.toml")
        .exits(0)
        .says(&["warning:", "16 triangles are not in one UDIM tile"]);
}

#[test]
fn what_is_left_of_the_tiles_is_refused_with_its_place() {
    let beside = Folder::with_cell_uvs(|x, y, column| match column {
        0 => (-0.9 + 0.5 * x, y),
        _ => two_tiles(x, y, column),
    });
    beside.ruga("plan scene.toml").exits(2).says(&[
        "the first is triangle 0, which reaches beyond all tiles",
        "(-0.900, 0.000)",
        "U from 0 to 10",
    ]);
}

#[test]
fn one_tile_that_is_not_the_first_has_its_number() {
    let folder = Folder::with_uvs(|x, y| (x + 2.0, y));
    grey(&folder, "area.png", 255);
    folder.change("scene.toml", "region = \"all\"", "region = \"area.png\"");
    let run = folder.ruga("bake scene.toml -o out --maps-only").exits(0);
    assert!(!run.stderr.contains("is one image"), "{}", run.stderr);
    assert!(wrinkles(&folder, "out/maps/squeezed_100_normal.1003.png"));
    assert_eq!(folder.files("out/maps").len(), 4);
}
