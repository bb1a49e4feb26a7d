//! Crease lines of scenes: where they lie, what they are like, and in which words mistakes are told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::path::Path;

use fixture::creased_skin::{
    CELLS, LAYER, SIDE, Site, crease, even, rows, says, skin, vertex, with_line,
};
use ruga_crease::Drive;
use ruga_scene::file::{Corners, Fold};
use ruga_scene::{Scene, SceneFile};
use ruga_stepper::{CreaseSpec, FoldSense};

fn assert_length(spec: &CreaseSpec, millimetres: f64) {
    let found = 1e3 * spec.line.length();
    let change = found / millimetres - 1.0;
    assert!(change.abs() < 0.02, "{}: {found}", spec.name);
}

#[test]
fn scene_creases_lie_where_the_file_says() {
    let site = Site::new();
    let per_u = 1e3 * f64::from(SIDE) / 0.9;
    assert_length(&site.lines(&crease("plain", ""))[0], 0.25 * per_u);
    let line = "uv = [[0.2, 0.5], [0.45, 0.5], [0.55, 0.5], [0.7, 0.5]]";
    assert_length(&site.lines(&with_line(line))[0], 0.4 * per_u);
    let ring = "closed = true\nuv = [[0.1, 0.2], [0.3, 0.2], [0.3, 0.4], [0.1, 0.4]]";
    let found = site.lines(&with_line(ring));
    assert!(found[0].line.is_closed());
    assert_length(&found[0], 0.8 * per_u);

    // Over the seam with both of its vertices, and with either.
    let cell = 1e3 * f64::from(SIDE) / f64::from(CELLS);
    let [left, right] = [vertex(4, 3), vertex(5, 3) - 1];
    for seam in [vec![left, right], vec![left], vec![right]] {
        let [before, after] = [2, 5].map(|c| vec![vertex(c, 3), vertex(c + 1, 3)]);
        let path = [before, seam, after].concat();
        let found = site.lines(&with_line(&format!("edges = {path:?}")));
        assert_length(&found[0], 4.0 * cell);
    }
    let ring = [(2, 2), (3, 2), (3, 3), (2, 3), (2, 2)].map(|(c, r)| vertex(c, r));
    let found = site.lines(&with_line(&format!("edges = {ring:?}")));
    assert!(found[0].line.is_closed());
    assert_length(&found[0], 4.0 * cell);
}

#[test]
fn scene_creases_of_an_image_are_its_strokes() {
    let site = Site::new();
    site.paint("lines.png", 128, |x, y| {
        (20..40).contains(&x) && (y == 30 || y == 90 || y == 91)
    });
    let found = site.lines(&with_line("image = \"lines.png\"\nangle = 33.0"));
    let names: Vec<_> = found.iter().map(|spec| spec.name.as_str()).collect();
    assert_eq!(names, ["line-1", "line-2"]);
    for spec in &found {
        assert!((13.0..18.0).contains(&(1e3 * spec.line.length())));
        assert!((spec.law.angle.to_degrees() - 33.0).abs() < 1e-9);
    }
    site.paint("lines.png", 128, |x, y| (20..40).contains(&x) && y == 30);
    let line = with_line("image = \"lines.png\"");
    assert_eq!(site.lines(&line)[0].name, "line");
    // The halves of the bar of a T go straight on into each other: they are not too close.
    site.paint("lines.png", 128, |x, y| {
        (y == 40 && (10..50).contains(&x)) || (x == 30 && (40..70).contains(&y))
    });
    assert_eq!(site.lines(&line).len(), 3);
}

/// The islands lie at U below 0.45 and from 0.55 on: 230 and 282 texels of 512.
#[test]
fn scene_creases_of_an_image_cross_seams() {
    let site = Site::new();
    let line = with_line("image = \"lines.png\"");
    let given = with_line("uv = [[0.2, 0.5], [0.45, 0.5], [0.55, 0.5], [0.8, 0.5]]");
    let given = &site.lines(&given)[0];
    for bleed in [0, 2, 8, 26] {
        let islands = |x: u32| x < 230 + bleed || x >= 282 - bleed;
        site.paint("lines.png", 512, |x, y| {
            (102..410).contains(&x) && islands(x) && (253..259).contains(&y)
        });
        let found = site.lines(&line);
        let names: Vec<_> = found.iter().map(|spec| spec.name.as_str()).collect();
        assert_eq!(names, ["line"], "{bleed}");
        // The ends are round.
        assert_length(&found[0], 1e3 * given.line.length() - 1.3);
        assert_eq!(found[0].law.fade, given.law.fade);
    }
    // On one side only it ends there, and fades.
    site.paint("lines.png", 512, |x, y| {
        (102..232).contains(&x) && (253..259).contains(&y)
    });
    let found = site.lines(&line);
    assert_length(&found[0], 27.2);
    assert_eq!(found[0].law.fade, given.law.fade);
}

#[test]
fn scene_creases_of_udim_images_lie_in_their_tiles() {
    let site = Site::with_gap(0.65);
    let line = with_line("image = \"lines.<UDIM>.png\"");
    let paint = |tile, end| {
        let name = format!("lines.{tile}.png");
        site.paint(&name, 128, |x, y| (20..end).contains(&x) && y == 64);
    };
    site.refuses(&line, "creases[0].image | lines.1001.png | no such file");
    paint(1001, 40);
    assert_eq!(site.lines(&line).len(), 1);
    paint(1002, 50);
    let found = site.lines(&line);
    assert_eq!(found.len(), 2);
    assert!(found[1].line.length() > 1.4 * found[0].line.length());
    // A tile may be black, but not all.
    paint(1001, 0);
    assert_eq!(site.lines(&line)[0].name, "line");
    paint(1002, 0);
    site.refuses(&line, "creases[0].image | lines.1001.png | shows no line");
}

#[test]
fn scene_creases_have_properties_and_presets() {
    let site = Site::new();
    let one = |more: &str| site.lines(&crease("line", more)).remove(0);
    let plain = one("");
    assert_eq!(plain.law.width, 1e-3);
    assert_eq!(plain.law.stiffness, 0.1);
    assert!((plain.law.angle.to_degrees() - 15.0).abs() < 1e-9);
    assert_eq!(plain.law.fade, [3.0 * plain.law.width; 2]);
    assert_eq!((plain.sense, plain.is_ridge), (FoldSense::Valley, false));
    assert_eq!((&plain.drive, plain.anchor), (&Drive::Load, None));

    let preset = one("preset = \"palm-line\"");
    assert_eq!((preset.law.width, preset.law.stiffness), (0.7e-3, 0.05));
    assert_eq!(preset.anchor.unwrap().depth, 0.6e-3);
    let own = one(
        "preset = \"palm-line\"\nwidth = 2e-4\nstiffness = 1.0\nangle = 0.0\nfade = [1e-3, 0.0]\n\
         anchor = { depth = 1e-4 }\nfold = \"mountain\"",
    );
    let law = own.law;
    assert_eq!((law.width, law.stiffness, law.angle), (2e-4, 1.0, 0.0));
    assert_eq!(law.fade, [1e-3, 0.0]);
    assert_eq!(own.anchor.unwrap().depth, 1e-4);
    assert_eq!((own.sense, own.is_ridge), (FoldSense::Mountain, true));
    let both = one("one_sided = false\nfold = \"mountain\"\ndrive = \"always\"");
    assert_eq!((both.sense, both.drive), (FoldSense::Both, Drive::Always));
    let driven = one("drive = \"weights\"\nweights = { pull = 0.25, press = 0.5 }");
    assert_eq!(driven.drive, Drive::Weights(vec![(0, 0.5), (1, 0.25)]));
    for preset in ruga_scene::CREASE_PRESETS {
        one(&format!("preset = \"{}\"", preset.name));
    }
}

#[test]
fn scene_creases_survive_writing_and_can_be_planned() {
    let site = Site::new();
    site.paint("lines.png", 64, |x, y| (8..20).contains(&x) && y == 20);
    let all = [
        with_line("layer = \"skin\"\nimage = \"lines.png\"\ndrive = \"weights\"\nweights = { pull = 0.5 }"),
        crease("ring", "closed = false\ncorners = \"keep\"\nfold = \"mountain\"\none_sided = false\nfade = [1e-3, 2e-3]"),
        "[[creases]]\nname = \"way\"\nedges = [37, 38, 39]\npreset = \"frown-line\"\nanchor = { depth = 1e-4, stiffness = 2.0 }\n".to_owned(),
    ];
    let scene = site.read(&all.concat()).unwrap();
    let text = scene.file.to_toml();
    let again = SceneFile::from_toml(&text, Path::new("scene.toml")).unwrap();
    assert_eq!(again, scene.file);
    assert_eq!(again.creases[0].image, Some(site.0.path("lines.png")));
    let ring = &again.creases[1];
    assert_eq!((ring.corners, ring.fold), (Corners::Keep, Fold::Mountain));
    assert!(!site.read("").unwrap().file.to_toml().contains("creases"));
    scene.plan().unwrap();
}

/// Lines that are refused, and in which words.
const LINES: &str = r#"
closed = false => creases[0]` | found none of them | exactly one of uv, edges, line_mesh and image
uv = [[0.1, 0.5], [0.3, 0.5]]; edges = [7, 8] => found uv, edges | exactly one
edges = [7, 8]; closed = true => creases[0].closed | only with `uv`; `edges` close by ending where they began
image = "a.png"; closed = true => creases[0].closed | only with `uv`; strokes of `image` close where they are painted
line_mesh = "a"; closed = true => creases[0].closed | only with `uv`; lines of `line_mesh` close
uv = [[0.1, 0.5], [1e300, 0.5]] => creases[0].uv[1]` | found [1e300, 0.5]; accepted: two finite numbers from -1000000
uv = [[0.1, 0.5]] => creases[0].uv` | found 1 point; accepted: at least 2 points
uv = [[0.1, 0.5], [0.3, 0.5]]; closed = true => creases[0].uv` | found 2 points | at least 3
uv = [[0.1, 0.5], [0.3, 0.5], [0.1, 0.5]]; closed = true => creases[0].uv` | 2 different points | 3 where it is closed
uv = [[0.1, 0.5], [nan, 0.5]] => creases[0].uv[1]` | [NaN, 0.5] | finite
uv = [[0.1, 0.5], [0.1, 0.5]] => creases[0].uv` | no length
uv = [[0.1, 0.5], [0.3, 1.5]] => creases[0].uv[1]` | UV (0.3, 1.5) | no triangle | upper left
uv = [[0.1, 0.3], [0.3, 0.5], [0.7, 0.5]] => creases[0].uv[1]` | crosses a UV seam | same place in the other
uv = [[0.1, 0.5], [0.45, 0.5], [0.55, 0.56], [0.8, 0.5]] => creases[0].uv[1]` | points 1 and 2 of the line | 6.67 mm from each other | same place of the seam
uv = [[0.1, 0.5], [0.103, 0.5]] => creases[0].uv` | crease `line` is 0.33 mm long | two edges | lengthen it
uv = [[0.1, 0.05], [0.4, 0.05]] => creases[0].uv` | along the border | triangle 0,
edges = [10] => creases[0].edges` | found 1 vertex | at least 2
edges = [10, 10] => creases[0].edges` | 1 different point
edges = [11, 12, 52] => creases[0].edges` | vertices 12 and 52 | no edge
edges = [10, 11, 900] => creases[0].edges[2]` | found vertex 900 | 0 to 89
edges = [0, 1, 2, 3] => creases[0].edges` | along the border
edges = [0, -1] => creases[0].edges[1] | found -1
uv = [[0.3, 0.5], [0.1, 0.5, 0.2]] => creases[0].uv[1]` | found a list of 3; accepted: a list of 2 numbers
"#;

#[test]
fn scene_creases_without_a_line_are_refused() {
    let site = Site::new();
    for (line, words) in rows(LINES) {
        site.refuses(&with_line(&line), words);
    }
    // One island over the other.
    let words = "creases[0].uv[0]` | overlap | vertices of the mesh";
    Site::with_gap(-0.4).refuses(&crease("line", ""), words);
    let words = "creases[1].uv` | `one` and crease `two` lie on each other | leave one out";
    site.refuses(&[crease("one", ""), crease("two", "")].concat(), words);
}

/// Two vertices of a row are in one place: the triangles on both have no area, and the texture has a gap there.
#[test]
fn a_line_over_triangles_without_area_is_told_of_them() {
    let site = Site::new();
    let collapsed = |column, row| even(column - u32::from((column, row) == (2, 4)), row);
    site.0.file("skin.bin", skin(0.1, collapsed));
    let line = with_line("uv = [[0.05, 0.53], [0.4, 0.53]]");
    let words = "creases[0].uv[0]` | or another of 2 without area is left out there | lead the line round it";
    site.refuses(&line, words);
    // Beside them nothing is said of them.
    let scene = site
        .read(&with_line("uv = [[0.05, 0.2], [0.4, 0.2]]"))
        .unwrap();
    assert_eq!(scene.layers[0].creases.len(), 1);
}

/// A vertex lies as good as on its neighbour, but too far from it to be welded.
#[test]
fn scene_creases_over_a_triangle_without_area_are_refused() {
    let site = Site::new();
    let place = |column, row| match (column, row) {
        (1, 3) => 2e-11,
        _ => even(column, row),
    };
    site.0.file("skin.bin", skin(0.1, place));
    let line = with_line("uv = [[0.02, 0.3], [0.09, 0.42], [0.2, 0.48]]");
    site.refuses(
        &line,
        "creases[0].uv` | triangle 17, | no area | mend the mesh",
    );
}

const WARNED: &str = "
uv = [[0.1, 0.3], [0.4, 0.3], [0.4, 0.5], [0.2, 0.5], [0.2, 0.15]] => `line` crosses itself | mm from its start
uv = [[0.1, 0.3], [0.35, 0.3], [0.1, 0.3]] => crease `line` lies on itself | mm from its start | each place once
uv = [[0.1, 0.5], [0.35, 0.5]]; width = 0.07; fade = [0, 0] => `line` | 70.00 mm wide | `map` | `width`
uv = [[0.1, 0.5], [0.35, 0.5]]; fade = [1, 1] => `line` | 27.78 mm | 1000.00 mm | shorten `fade`
";

#[test]
fn scene_creases_that_may_not_be_meant_are_warned_of() {
    let site = Site::new();
    for (line, words) in rows(WARNED) {
        site.warns(&with_line(&line), words);
    }
    let near = with_line("uv = [[0.1, 0.502], [0.35, 0.502]]");
    let words = "crease `one` and crease `line` come within 0.2 | apart";
    site.warns(&[crease("one", ""), near].concat(), words);
    // Through a vertex of the mesh, where the two share no triangle.
    let cross = with_line("uv = [[0.225, 0.4], [0.225, 0.6]]");
    site.lines(&[crease("one", ""), cross].concat());
}

/// Properties that are refused, and in which words.
const PROPERTIES: &str = r#"
width = -1e-3 => creases[0].width | found -0.001; accepted: a number above 0
width = 0 => creases[0].width | found 0
width = nan => creases[0].width | found NaN
width = 1e300 => creases[0].width | found 1e300 m; accepted: up to 100.00 mm, the size of the mesh
stiffness = 0.0 => creases[0].stiffness | found 0; accepted: a share from 0.000001 to 1
stiffness = 1.5 => creases[0].stiffness | found 1.5; accepted: a share from 0.000001 to 1
stiffness = -1 => creases[0].stiffness | found -1; accepted: a share
angle = 181 => creases[0].angle | found 181; accepted: degrees from 0 to 150
angle = 151 => creases[0].angle | found 151; accepted: degrees from 0 to 150
angle = -5 => creases[0].angle | found -5
fade = [1e-3, -1e-3] => creases[0].fade[1] | found -0.001 | from 0
fade = 1e-3 => creases[0].fade | found 0.001; accepted: a list of 2 numbers
anchor = { depth = 1.0 } => creases[0].anchor.depth | found 1 m | 1000.00 mm; accepted: less than 5.00 mm | layer `skin`
anchor = { depth = -1e-3 } => creases[0].anchor.depth | found -0.001
slit = 8e-3 => creases[0].slit | found one; accepted: no slit without [interior]
anchor = { depth = 1e-3, stiffness = 0 } => creases[0].anchor.stiffness | found 0; accepted: a number above 0, at most 100
anchor = { depth = 1e-3, stiffness = 200.0 } => creases[0].anchor.stiffness | found 200; accepted: a number above 0, at most 100
anchor = { depth = 1e-3, stiffness = -1e300 } => creases[0].anchor.stiffness | found -1e300; accepted: a number above 0
anchor = { depht = 1e-3 } => creases[0].anchor | did you mean `depth`
drive = "weights"; weights = { pres = 1.0 } => creases[0].weights.pres | no blend shape `pres` | did you mean `press`
weights = { press = 1.0 } => creases[0].drive | "load" | "weights"
drive = "weights" => creases[0].weights | at least one blend shape
drive = "weights"; weights = { press = nan } => creases[0].weights.press | NaN | finite
fold = "valey" => creases[0].fold | did you mean `valley`
layer = "skim" => creases[0].layer | no layer `skim` | did you mean `skin`
preset = "crows-feet" => creases[0].preset | no crease preset `crows-feet` | did you mean `crows-foot`
widht = 1e-3 => creases[0] | widht | did you mean `width`
young = 1e6 => `young` is not a key of `[[creases]]` | `[[layers]]`
"#;

#[test]
fn scene_creases_with_impossible_properties_are_refused() {
    let site = Site::new();
    for (keys, words) in rows(PROPERTIES) {
        site.refuses(&crease("line", &keys), words);
    }
    for bad in ["", "a/b", "nul", " a", "a?"] {
        site.refuses(&crease(bad, ""), "creases[0].name | part of a file name");
    }
    let twice = [crease("line", ""), crease("Line", "")].concat();
    site.refuses(&twice, "creases[1].name | `Line` twice");
    let nameless = "[[creases]]\nuv = [[0.1, 0.5], [0.3, 0.5]]\n";
    site.refuses(nameless, "creases[0] | `name` is missing");
    let thin = LAYER.replacen("5e-3", "5e-4", 1) + &crease("line", "preset = \"palm-line\"");
    let words = "creases[0].preset | `palm-line` | 0.60 mm | less than 0.50 mm";
    says(site.read_all(&thin), words);
}

#[test]
fn scene_creases_belong_to_the_lowest_layer() {
    let site = Site::new();
    let top = "[[layers]]\nname = \"top\"\nyoung = 2e6\nthickness = 1e-4\n";
    let two = |more: &str| format!("{top}{}", crease("line", more));
    let words = "creases[0].layer | `top`, which lies on another layer | `skin`";
    site.refuses(&two("layer = \"top\""), words);
    assert_eq!(site.read(&two("")).unwrap().layers[0].creases.len(), 1);
    let driver = "[driver]\nmesh = \"skin.gltf\"\n[substrate]";
    let layer = LAYER.replacen("[substrate]", driver, 1);
    let joint = format!("version = 1\nstack = \"joint\"\n{layer}{}", two(""));
    let words = "stack | found \"joint\" | \"nominal\" or \"composite\"";
    says(Scene::read(&site.0.file("scene.toml", joint)), words);
    let body = |more: &str| crease("line", more) + "[interior]\ncells = 4\nfollow = 1e6\n";
    let depth_on = |more: &str| {
        let scene = site.read(&body(more)).unwrap();
        scene.layers[0].creases[0].anchor.unwrap().depth
    };
    // Deeper than the substrate is thick: the body is as deep as its mesh.
    assert_eq!(depth_on("anchor = { depth = 8e-3 }"), 8e-3);
    assert!(depth_on("preset = \"palm-line\"\nwidth = 1e-4") > 0.0);
    let cut = site.read(&body("slit = 8e-3")).unwrap();
    assert_eq!(cut.layers[0].creases[0].slit, Some(8e-3));
    // The anchor of a preset is shallower than any slit.
    let preset = "preset = \"palm-line\"\nwidth = 1e-4\nslit = 8e-3";
    let preset = site.read(&body(preset)).unwrap();
    assert!(preset.layers[0].creases[0].anchor.is_none());
    let told = preset.warnings.iter();
    assert_eq!(told.filter(|text| text.contains("is left out")).count(), 1);
    let depths = ["0.0", "-1e-3", "nan", "inf"];
    for (depth, found) in depths.into_iter().zip(["0", "-0.001", "NaN", "inf"]) {
        let words = format!("creases[0].slit | found {found}; accepted: a number above 0");
        site.refuses(&body(&format!("slit = {depth}")), &words);
    }
    let sheet = |more: &str| {
        let (_, layer) = LAYER.split_at(LAYER.find("[[layers]]").unwrap());
        site.read_all(&format!("{layer}{}[sheet]\n", crease("line", more)))
    };
    let words = "creases[0].anchor | no anchor with [sheet]";
    says(sheet("anchor = { depth = 1e-4 }"), words);
    let words = "creases[0].slit | no slit without [interior]";
    says(sheet("slit = 8e-3"), words);
    let words = "creases[0].absorb | no `absorb` with [sheet] or [interior]";
    says(sheet("absorb = true"), words);
    site.refuses(&body("absorb = true"), words);
    let warnings = sheet("preset = \"palm-line\"\nwidth = 1e-4")
        .unwrap()
        .warnings;
    let left_out = "crease `line`: the anchor of its preset is left out";
    assert!(
        warnings.iter().any(|warning| warning.starts_with(left_out)),
        "{warnings:?}"
    );
    let symmetric = format!("symmetry = \"x\"\n{LAYER}{}", crease("line", ""));
    let words = "driver.symmetry | found \"x\" | no `symmetry` with [[creases]]";
    says(site.read_all(&symmetric), words);
}

#[test]
fn scene_creases_of_images_without_lines_are_refused() {
    let site = Site::new();
    let line = with_line("image = \"lines.png\"");
    let refuses = |words: &str| site.refuses(&line, &format!("creases[0].image | {words}"));
    let paint = |size, is_white: fn(u32, u32) -> bool| site.paint("lines.png", size, is_white);
    refuses("lines.png | no such file");
    site.0.file("lines.png", b"no image");
    refuses("lines.png | PNG");
    paint(64, |_, _| false);
    refuses("lines.png | shows no line | no texel is as bright as 50 % | white on black");
    paint(1, |_, _| true);
    refuses(
        "lines.png | no line: only 1 texel is as bright as 50 %, and a line needs several in a row; paint",
    );
    paint(64, |x, y| (x, y) == (20, 20) || (x, y) == (40, 40));
    refuses(
        "lines.png | no line: 2 texels are as bright as 50 %, but too few of them in a row; paint",
    );
    paint(64, |_, _| true);
    refuses("lines.png | 100 % of the image is bright | thin white strokes on black");
    let mut state = 1_u32;
    site.paint("lines.png", 128, |_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 30 == 0
    });
    refuses("lines.png | the image shows  | lines, more than  | it is noise");
    paint(128, |x, y| (20..50).contains(&x) && y == 3);
    refuses(
        "lines.png | near UV (0. | 0.027) a stroke lies outside the islands | paint inside them",
    );
    paint(128, |x, y| (20..50).contains(&x) && (y == 3 || y == 125));
    refuses(
        "lines.png | all 2 strokes, near UV (0. | 0.027), (0. | 0.980), lie outside the islands",
    );
    paint(128, |x, y| {
        (20..50).contains(&x) && (y == 3 || y == 125 || y == 60)
    });
    site.warns(
        &line,
        "crease `line`: 2 of 3 strokes | lines.png | near UV (0. | 0.980), lie outside | are left out",
    );
    paint(128, |x, y| (10..50).contains(&x) && (20..100).contains(&y));
    let words =
        "crease `line`: near UV (0. | lines.png is | texels or 3 | mm wide | an area and no line";
    site.warns(&line, words);
    // Dots and broad strokes are none.
    paint(128, |x, y| (10..45).contains(&x) && (40..47).contains(&y));
    site.lines(&line);
    paint(128, |x, y| x == 30 && y < 60);
    site.lines(&line);
    paint(512, |x, y| (150..275).contains(&x) && y == 300);
    site.warns(
        &line,
        "crease `line`: 1 of 1 strokes | near UV (0.4 | lies in part outside the islands",
    );
    paint(2048, |x, y| (200..206).contains(&x) && y == 300);
    refuses("crease `line` is 0. | two edges of the mesh");
    paint(2048, |x, y| match y {
        300 => (200..206).contains(&x),
        _ => (200..600).contains(&x) && y == 400,
    });
    site.warns(
        &line,
        "crease `line`: 1 of 2 lines of strokes | lines.png | shorter than two edges",
    );
    paint(2048, |x, y| {
        (200..600).contains(&x) && (y == 300 || y == 400)
    });
    let words = "creases[1].name | two lines would be called `LINE-2` | another name";
    site.refuses(&[&line, &*crease("LINE-2", "")].concat(), words);
    let words = "creases[1].name | found `line` | `line-2`";
    site.refuses(&[&*crease("line-2", ""), &line].concat(), words);
}
