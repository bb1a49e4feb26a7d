//! Masks, strengths and zones of layers: what a scene says and what its maps show.

mod fixture;

use fixture::Folder;
use ruga_io::{PngTexels, read_mask, write_png};

/// Two stacks side by side, the left one with shorter waves; the strip between them is no one's.
const ZONES: &str = r#"[[layers]]
name = "left"
zone = "left"
mask = "left.png"
wavelength = 0.02
critical_strain = 0.05

[[layers]]
name = "right"
zone = "right"
mask = "right.png"
wavelength = 0.03
critical_strain = 0.05

[[poses]]"#;

/// A grey image of eight columns, 0 to 255.
fn paint(folder: &Folder, name: &str, columns: [u8; 8]) {
    let texels: Vec<u16> = (0..64).map(|i| 257 * u16::from(columns[i % 8])).collect();
    write_png(&folder.path(name), 8, 8, PngTexels::Grey16(&texels)).expect("a folder to write to");
}

/// The scene with its one layer replaced by `layers`.
fn scene_with(layers: &str) -> Folder {
    let text = fixture::SCENE;
    let (start, end) = (text.find("[[layers]]"), text.find("[[poses]]"));
    let old = &text[start.expect("a layer")..end.expect("a pose") + "[[poses]]".len()];
    Folder::with(old, layers)
}

/// Mean deviation of some columns of the height map from neutral, as a share of the map's range.
fn relief(folder: &Folder, columns: std::ops::Range<usize>) -> f64 {
    let map = read_mask(&folder.path("out/maps/squeezed_100_height.png")).expect("a map");
    let rows = map.values.chunks(map.width);
    let texels = rows.flat_map(|row| &row[columns.clone()]);
    let deviations: Vec<f64> = texels.map(|&h| (f64::from(h) - 0.5).abs()).collect();
    deviations.iter().sum::<f64>() / deviations.len() as f64
}

#[test]
fn zones_are_solved_side_by_side_into_one_map() {
    let folder = scene_with(ZONES);
    paint(&folder, "left.png", [255, 255, 255, 0, 0, 0, 0, 0]);
    paint(&folder, "right.png", [0, 0, 0, 0, 0, 255, 255, 255]);
    folder.ruga("bake scene.toml -o out").exits(0);
    let report = folder.json("out/report.json");
    let layers = &report["poses"][0]["layers"];
    assert_eq!(layers[0]["name"], "left");
    assert_eq!(layers[1]["name"], "right");
    for layer in [&layers[0], &layers[1]] {
        assert!(layer["vertices"].as_u64().expect("a number") > 0, "{layer}");
    }
    let [left, between, right] = [8..20, 30..34, 44..56].map(|columns| relief(&folder, columns));
    assert!(left > 0.05 && right > 0.05, "{left} {right}");
    assert!(between < 1e-3, "no one's skin is neutral: {between}");
}

#[test]
fn zones_that_claim_the_same_place_are_refused() {
    let folder = scene_with(ZONES);
    paint(&folder, "left.png", [255, 255, 255, 255, 255, 0, 0, 0]);
    paint(&folder, "right.png", [0, 0, 0, 255, 255, 255, 255, 255]);
    let refused = folder.ruga("plan scene.toml").exits(2);
    refused.says(&["`left`", "`right`", "overlap", "200 %"]);
    // Greys that add up to white blend.
    paint(&folder, "left.png", [255, 255, 191, 128, 64, 0, 0, 0]);
    paint(&folder, "right.png", [0, 0, 64, 127, 191, 255, 255, 255]);
    folder.ruga("plan scene.toml").exits(0);
}

/// A grey mask and half of the strength each halve what maps show, and nothing else.
#[test]
fn strength_and_grey_scale_the_relief() {
    let layer = |keys: &str| {
        scene_with(&format!(
            "[[layers]]\nname = \"skin\"\nwavelength = 0.03\ncritical_strain = 0.05\n{keys}\n[[poses]]"
        ))
    };
    let heights = |folder: &Folder| {
        folder.ruga("bake scene.toml -o out").exits(0);
        let report = folder.json("out/report.json");
        let scale = folder.json("out/wrinkles.json");
        let maps = scale["maps"].as_array().expect("maps");
        let map = maps.iter().find(|map| {
            map["file"]
                .as_str()
                .is_some_and(|f| f.ends_with("_100_height.png"))
        });
        let range = map.expect("a height map")["scale"]
            .as_f64()
            .expect("a scale");
        let amplitude = report["poses"][0]["layers"][0]["amplitude_m"].as_f64();
        (range, amplitude.expect("an amplitude"))
    };
    let (whole, amplitude) = heights(&layer(""));
    let (strong, same) = heights(&layer("strength = 2.0"));
    assert_eq!(same, amplitude);
    assert!((strong / whole - 2.0).abs() < 1e-3, "{strong} {whole}");
    let grey = layer("mask = \"grey.png\"");
    paint(&grey, "grey.png", [128; 8]);
    let (half, same) = heights(&grey);
    assert_eq!(same, amplitude);
    assert!(
        (half / whole - 128.0 / 255.0).abs() < 1e-3,
        "{half} {whole}"
    );
}

/// Largest deviation of one column of the height map from neutral.
fn highest(folder: &Folder, column: usize) -> f64 {
    let map = read_mask(&folder.path("out/maps/squeezed_100_height.png")).expect("a map");
    let rows = map.values.chunks(map.width);
    rows.map(|row| (f64::from(row[column]) - 0.5).abs())
        .fold(0.0, f64::max)
}

/// Half a wavelength is 10.7 of the 64 texels; the mask ends at the 32nd.
#[test]
fn relief_fades_to_nothing_inside_the_border_of_a_mask() {
    let folder = scene_with(
        "[[layers]]\nname = \"skin\"\nwavelength = 0.03\ncritical_strain = 0.05\nmask = \"left.png\"\n[[poses]]",
    );
    paint(&folder, "left.png", [255, 255, 255, 255, 0, 0, 0, 0]);
    folder.ruga("bake scene.toml -o out").exits(0);
    let inside = (4..20).map(|column| highest(&folder, column));
    let inside = inside.fold(0.0, f64::max);
    assert!(highest(&folder, 31) < 0.1 * inside, "{inside}");
    assert!(highest(&folder, 33) < 1e-3, "beyond the mask");
    let steps =
        (20..33).map(|column| (highest(&folder, column + 1) - highest(&folder, column)).abs());
    let steepest = steps.fold(0.0, f64::max);
    assert!(steepest < 0.4 * inside, "no cut: {steepest} of {inside}");
}

/// A layer in one place does not take away what lies below another in another place.
#[test]
fn a_third_layer_lies_on_what_is_there() {
    let layers = |feet: &str| {
        format!(
            "[[layers]]\nname = \"furrows\"\nwavelength = 0.03\ncritical_strain = 0.05\n\n{feet}\
             [[layers]]\nname = \"fine\"\nwavelength = 0.015\ncritical_strain = 0.05\nmask = \"right.png\"\n\n[[poses]]"
        )
    };
    let feet = "[[layers]]\nname = \"feet\"\nwavelength = 0.015\ncritical_strain = 0.05\nmask = \"left.png\"\n\n";
    let height = |feet: &str| {
        let folder = scene_with(&layers(feet));
        paint(&folder, "left.png", [255, 255, 0, 0, 0, 0, 0, 0]);
        paint(&folder, "right.png", [0, 0, 0, 0, 255, 255, 255, 255]);
        folder.ruga("bake scene.toml -o out").exits(0);
        let maps = folder.json("out/wrinkles.json");
        let maps = maps["maps"].as_array().expect("maps").clone();
        let is_last = |map: &&serde_json::Value| {
            map["file"]
                .as_str()
                .is_some_and(|f| f.ends_with("_100_height.png"))
        };
        let scale = maps.iter().find(is_last).expect("a map")["scale"].clone();
        let highest = (44..52).map(|column| highest(&folder, column));
        scale.as_f64().expect("a scale") * highest.fold(0.0, f64::max)
    };
    let (without, with) = (height(""), height(feet));
    assert!((with / without - 1.0).abs() < 0.3, "{with} {without}");
}

/// A budget that leaves edges longer than waves: what is longer is far too stiff to form.
#[test]
fn skin_that_stays_smooth_is_told_with_its_place_and_why() {
    let folder = scene_with(
        "[[layers]]\nname = \"skin\"\nwavelength = 0.006\ncritical_strain = 0.05\n\n[[poses]]",
    );
    folder.change(
        "scene.toml",
        "region = \"all\"",
        "region = \"all\"\nvertex_budget = 100",
    );
    let run = folder.ruga("bake scene.toml -o out").exits(0);
    run.says(&[
        "were to wrinkle and stayed smooth, at u",
        "points per wavelength there",
    ]);
}
