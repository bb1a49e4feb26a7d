//! Growths of scenes: what the file says of them, poses that switch them on, and in which words mistakes are told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::f64::consts::FRAC_PI_4;
use std::fmt::Write as _;

use fixture::{Folder, assert_says};
use nalgebra::Vector2;
use ruga_bake::WrinkleMap;
use ruga_io::{PngTexels, write_png};
use ruga_scene::{GROWTH_PRESETS, Scene, SceneError, SceneFile};
use ruga_stepper::{Grows, GrowthDirection, GrowthSpec, Silent};

/// Side of a square of skin, m.
const SIDE: f64 = 0.04;

/// The square; `press` is the share of its width that it loses.
fn square(press: f64) -> String {
    let mut text = String::from("o Skin\n");
    for (i, j) in (0..81).map(|v| (v % 9, v / 9)) {
        let [x, y] = [i, j].map(|c| f64::from(c) / 8.0);
        let across = SIDE * (1.0 - press) * x;
        let _ = writeln!(text, "v {across} {} 0\nvt {x} {y}", SIDE * y);
    }
    for (i, j) in (0..64).map(|q| (q % 8, q / 8)) {
        let a = 9 * j + i + 1;
        let [b, c, d] = [a + 1, a + 10, a + 9];
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}");
    }
    text
}

const DRIVER: &str =
    "version = 1\n[driver]\nmesh = \"skin.obj\"\ntargets = { press = \"press.obj\" }\n";

const LAYER: &str = "[[layers]]\nname = \"skin\"\npreset = \"forehead-furrow\"\n";

const TOP: &str = "[[layers]]\nname = \"top\"\npreset = \"fine-lines\"\n";

/// A folder with the skin, two images and a scene.
struct Site(Folder);

impl Site {
    fn new() -> Self {
        let folder = Folder::new();
        folder.file("skin.obj", square(0.0));
        folder.file("press.obj", square(0.1));
        // Black on the left, white on the right, from the border between the two texels on.
        write_png(&folder.path("grey.png"), 2, 1, PngTexels::Grey8(&[0, 255])).unwrap();
        let up = [[0, 255, 0]; 4];
        write_png(
            &folder.path("up.png"),
            2,
            2,
            PngTexels::Rgb8(up.as_flattened()),
        )
        .unwrap();
        Self(folder)
    }

    fn read_all(&self, text: &str) -> Result<Scene, SceneError> {
        Scene::read(&self.0.file("scene.toml", text))
    }

    /// Reads a scene of one layer with these tables.
    fn read(&self, tables: &str) -> Result<Scene, SceneError> {
        self.read_all(&format!("{DRIVER}{LAYER}{tables}"))
    }

    /// The growth of the first layer in a scene with one growth of these keys.
    fn one(&self, keys: &str) -> GrowthSpec {
        let scene = self.read(&growth("grow", keys)).unwrap();
        assert_eq!(scene.warnings, [""; 0]);
        assert_eq!(scene.layers[0].growths.len(), 1);
        scene.layers[0].growths[0].clone()
    }

    fn refuses(&self, tables: &str, words: &str) {
        says(self.read(tables).map(|scene| scene.warnings), words);
    }

    /// Maps of all poses, each at its last key.
    fn maps(&self, tables: &str) -> Vec<WrinkleMap> {
        let scene = self.read(tables).unwrap();
        let plan = scene.plan().unwrap();
        let map = |pose: usize| {
            let result = plan.simulate(pose, &mut Silent).unwrap();
            let key = result.keys.last().unwrap();
            scene.bake_key(&scene.poses[pose], key).unwrap().remove(0)
        };
        (0..scene.poses.len()).map(map).collect()
    }
}

/// Whether something is refused with all `words`, which ` | ` separates.
fn says<T: std::fmt::Debug>(result: Result<T, SceneError>, words: &str) {
    assert_says(
        result,
        "scene.toml",
        &words.split(" | ").collect::<Vec<_>>(),
    );
}

/// A growth with these keys, which `; ` separates.
fn growth(name: &str, keys: &str) -> String {
    format!(
        "[[growths]]\nname = \"{name}\"\n{}\n",
        keys.replace("; ", "\n")
    )
}

fn pose(name: &str, keys: &str) -> String {
    format!("[[poses]]\nname = \"{name}\"\n{keys}\nkeys = [1.0]\nsteps = 2\n")
}

/// Rows of a table `keys => words`.
fn rows(table: &str) -> impl Iterator<Item = (&str, &str)> {
    table
        .trim()
        .lines()
        .map(|row| row.split_once(" => ").unwrap())
}

#[test]
fn keys_of_growths_are_read() {
    let site = Site::new();
    let plain = site.one("along = 0.05");
    assert_eq!((plain.name.as_str(), plain.grows), ("grow", Grows::Layer));
    assert_eq!([plain.along, plain.across], [0.05; 2]);
    assert!(matches!(plain.direction, GrowthDirection::Angle(0.0)) && plain.paint.is_none());

    let own = site.one("layer = \"skin\"; along = 0.05; across = -0.01; direction = 45.0");
    assert_eq!([own.along, own.across], [0.05, -0.01]);
    let GrowthDirection::Angle(angle) = own.direction else {
        panic!("{own:?}")
    };
    assert!((angle - FRAC_PI_4).abs() < 1e-12);

    let painted = site.one("along = 0.1; image = \"grey.png\"; direction_image = \"up.png\"");
    let paint = painted.paint.unwrap();
    assert_eq!(paint.range, [0.0, 1.0]);
    let left_and_right = [0.1, 0.9].map(|u| paint.image.grey(Vector2::new(u, 0.5)));
    assert_eq!(left_and_right, [0.0, 1.0]);
    let GrowthDirection::Painted { right, up } = painted.direction else {
        panic!()
    };
    assert_eq!(
        [right, up].map(|part| part.grey(Vector2::new(0.5, 0.5))),
        [0.0, 1.0]
    );
    let ranged = site.one("along = 0.1; image = \"grey.png\"; range = [-1.0, 0.5]");
    assert_eq!(ranged.paint.unwrap().range, [-1.0, 0.5]);
}

#[test]
fn presets_fill_in_what_is_left_out() {
    let site = Site::new();
    for preset in GROWTH_PRESETS {
        let found = site.one(&format!("preset = \"{}\"", preset.name));
        let grows = if preset.is_below {
            Grows::Below
        } else {
            Grows::Layer
        };
        assert_eq!(
            (found.grows, found.along, found.across),
            (grows, preset.along, preset.across)
        );
    }
    // The layer that is named goes before the preset's, and so does each length.
    let own = site.one("preset = \"drying\"; layer = \"skin\"; along = -0.1");
    assert_eq!(
        (own.grows, own.along, own.across),
        (Grows::Layer, -0.1, -0.1)
    );
    let across = site.one("preset = \"drying\"; across = 0.0");
    assert_eq!(
        (across.grows, across.along, across.across),
        (Grows::Below, -0.06, 0.0)
    );
}

#[test]
fn growths_lie_on_the_layers_they_name() {
    let site = Site::new();
    let tables = [
        TOP,
        &growth("first", "along = 0.1"),
        &growth("upper", "along = 0.1; layer = \"top\""),
    ];
    let below = growth("below", "along = -0.1; layer = \"substrate\"");
    let scene = site.read(&[&tables.concat(), &*below].concat()).unwrap();
    let found = scene.layers.iter().map(|layer| {
        let growths = layer.growths.iter();
        growths
            .map(|growth| (growth.name.as_str(), growth.grows))
            .collect::<Vec<_>>()
    });
    let below = ("below", Grows::Below);
    let own = |name| vec![(name, Grows::Layer), below];
    assert_eq!(found.collect::<Vec<_>>(), [own("first"), own("upper")]);
}

#[test]
fn poses_switch_growths_on() {
    let site = Site::new();
    let grow = growth("dry", "along = 0.08; across = 0.0");
    // Without poses, one per shape and one per growth.
    let scene = site
        .read(&[&*grow, &growth("press", "along = 0.1")].concat())
        .unwrap();
    let found: Vec<_> = scene
        .poses
        .iter()
        .map(|p| (p.name.as_str(), p.growths.as_slice()))
        .collect();
    let whole = |name: &str| [(name.to_owned(), 1.0)];
    let (dry, press) = (whole("dry"), whole("press"));
    // A growth is called like a shape here: the second of the names gets a number.
    let second = found[2].0;
    assert!(second != "press" && second.starts_with("press"), "{second}");
    assert_eq!(
        found,
        [("press", [].as_slice()), ("dry", &dry), (second, &press)]
    );

    // Without weights, and beside them.
    let poses = [
        pose("old", "growths = { dry = 0.5 }"),
        pose("both", "growths = { dry = 1.0 }\nweights = { press = 1.0 }"),
    ];
    let scene = site.read(&[grow, poses.concat()].concat()).unwrap();
    assert_eq!(scene.poses[0].growths, [("dry".to_owned(), 0.5)]);
    assert_eq!(scene.poses[1].growths, dry);
    let text = scene.file.to_toml();
    assert_eq!(
        SceneFile::from_toml(&text, "scene.toml".as_ref()).unwrap(),
        scene.file
    );
    assert!(!site.read("").unwrap().file.to_toml().contains("growths"));
}

#[test]
fn a_mesh_without_blend_shapes_can_wrinkle() {
    let site = Site::new();
    let plain = "version = 1\n[driver]\nmesh = \"skin.obj\"\n";
    let grow = growth("dry", "along = 0.08; across = 0.0");
    let scene = site.read_all(&[plain, LAYER, &grow].concat()).unwrap();
    assert_eq!(scene.poses.len(), 1);
    let plan = scene.plan().unwrap();
    assert_eq!(plan.active_triangles(0).len(), 128);
}

/// Scenes without growth and with growths that no pose, or no part of one, switches on.
#[test]
fn growths_that_are_not_switched_on_change_no_map() {
    let site = Site::new();
    let quick = "[remesh]\npoints_per_wavelength = 6.0\n[bake]\nsize = 64\n";
    let press = |growths: &str| pose("press", &format!("weights = {{ press = 1.0 }}\n{growths}"));
    let grows = [
        growth("dry", "along = 0.1; image = \"grey.png\""),
        growth("below", "preset = \"drying\""),
    ]
    .concat();
    let without = site.maps(&[quick, &press("")].concat());
    let mean =
        without[0].heights.iter().map(|h| h.abs()).sum::<f32>() / without[0].heights.len() as f32;
    assert!(mean > 5e-5, "{mean}");
    let unused = site.maps(&[quick, &grows, &press("")].concat());
    assert!(unused == without);
    let told = site
        .read(&[quick, &grows, &press("")].concat())
        .unwrap()
        .warnings;
    let told: Vec<_> = told
        .iter()
        .filter(|text| text.contains("no pose switches it on"))
        .collect();
    assert!(
        told.len() == 2 && told[0].starts_with("growth `dry`"),
        "{told:?}"
    );
    let off = site.maps(
        &[
            quick,
            &grows,
            &press("growths = { dry = 0.0, below = 0.0 }"),
        ]
        .concat(),
    );
    assert!(off == without);
}

/// Growths that are refused, and in which words.
const KEYS: &str = r#"
layer = "skin" => growths[0].along | found nothing | `along = 0.05` | `preset`
across = 0.1 => growths[0].along | found nothing
along = -0.61 => growths[0].along | found -0.61; accepted: from -0.6 to 1; 0.05 makes it 5 % longer
along = 1.1 => growths[0].along | found 1.1; accepted: from -0.6 to 1
along = nan => growths[0].along | found NaN
along = inf => growths[0].along | found inf
along = 0.1; across = -0.7 => growths[0].across | found -0.7; accepted: from -0.6 to 1
along = "much" => growths[0].along | found "much"; accepted: a number
along = 0.1; layer = "skim" => growths[0].layer | no layer `skim`; accepted: `skin`, `substrate` | did you mean `skin`
along = 0.1; layer = "substrat" => growths[0].layer | did you mean `substrate`
preset = "aging" => growths[0].preset | found "aging"; accepted: "ageing", "drying" | did you mean `ageing`
along = 0.1; direction = nan => growths[0].direction | found NaN; accepted: degrees | right of the texture
along = 0.1; direction = 9; direction_image = "up.png" => growths[0].direction | found 9 beside `direction_image` | one of the two
along = 0.1; image = "grey.png"; range = [0.0, 1.5] => growths[0].range | found [0.0, 1.5] | from -1 to 1 for black and white
along = 0.1; image = "grey.png"; range = [nan, 1.0] => growths[0].range | found [NaN, 1.0]
along = 0.1; image = "grey.png"; range = [1.0] => growths[0].range | a list of 2 numbers
along = 0.1; range = [0.5, 1.0] => growths[0].range | found [0.5, 1.0] without `image`
along = 0.1; image = "none.png" => growths[0].image | none.png | no such file
along = 0.1; direction_image = "none.png" => growths[0].direction_image | none.png | no such file
along = 0.1; direction_image = "grey.png" => growths[0].direction_image | grey.png | 1 channel | red, the part to the right, and green, the part up
along = 0.1; image = "skin.obj" => growths[0].image | skin.obj
alon = 0.1 => growths[0] | `alon` is not a key of `[[growths]]` | did you mean `along`
young = 1e6 => `young` is not a key of `[[growths]]` | `[[layers]]`
"#;

#[test]
fn impossible_growths_are_refused() {
    let site = Site::new();
    for (keys, words) in rows(KEYS) {
        site.refuses(&growth("grow", keys), words);
    }
    for bad in ["", "a/b", "nul", " a"] {
        site.refuses(
            &growth(bad, "along = 0.1"),
            "growths[0].name | part of a file name",
        );
    }
    let twice = [growth("dry", "along = 0.1"), growth("Dry", "along = 0.2")].concat();
    site.refuses(&twice, "growths[1].name | `Dry` twice");
    site.refuses(
        "[[growths]]\nalong = 0.1\n",
        "growths[0] | `name` is missing",
    );
}

#[test]
fn growths_that_do_not_go_with_the_scene_are_refused() {
    let site = Site::new();
    let grow = growth("grow", "along = 0.1");
    let symmetric = [DRIVER, "symmetry = \"x\"\n", LAYER, &grow].concat();
    says(
        site.read_all(&symmetric),
        "driver.symmetry | found \"x\" | no `symmetry` with [[growths]]",
    );
    let joint = ["stack = \"joint\"\n", DRIVER, LAYER, TOP, &grow].concat();
    says(
        site.read_all(&joint),
        "stack | found \"joint\"; accepted: \"nominal\" or \"composite\" with [[growths]]",
    );
    let body = "[interior]\ncells = 4\nfollow = 1e6\n";
    let on_body =
        |keys: &str, words: &str| site.refuses(&[&growth("grow", keys), body].concat(), words);
    let words = "growths[0].layer | found \"substrate\" | a soft body keeps its size";
    on_body("along = -0.1; layer = \"substrate\"", words);
    let words = "growths[0].layer | found \"substrate\", for which the preset is | a soft body";
    on_body("preset = \"drying\"", words);
    on_body(
        "along = -0.1; layer = \"skim\"",
        "growths[0].layer | no layer `skim`",
    );
    let named_so = LAYER.replacen("skin", "substrate", 1);
    let both = [
        DRIVER,
        &named_so,
        &growth("grow", "along = 0.1; layer = \"substrate\""),
    ]
    .concat();
    let words =
        "growths[0].layer | \"substrate\", which also is the name of a layer | another name";
    says(site.read_all(&both), words);
}

/// Strengths in poses that are refused, and in which words.
const STRENGTHS: &str = "
wet = 1.0 => poses[0].growths.wet | no growth `wet`; accepted: `dry`, `old`
drt = 1.0 => poses[0].growths.drt | did you mean `dry`
dry = nan => poses[0].growths.dry | found NaN; accepted: a number from -10 to 10; 1 is the whole growth
dry = inf => poses[0].growths.dry | found inf
old = -10.5 => poses[0].growths.old | found -10.5
old = 1e300 => poses[0].growths.old | found 1e300; accepted
old = 'x' => poses[0].growths.old | a number
";

#[test]
fn impossible_strengths_are_refused() {
    let site = Site::new();
    let grows = [
        growth("dry", "along = 0.3; across = 0.0"),
        growth("old", "along = -0.3"),
    ]
    .concat();
    let with_pose = |keys: &str| [&grows, &*pose("p", keys)].concat();
    for (strength, words) in rows(STRENGTHS) {
        site.refuses(&with_pose(&format!("growths = {{ {strength} }}")), words);
    }
    site.refuses(&with_pose(""), "poses[0].weights | found {}");
    let words =
        "poses[0].growths.dry | no growth `dry`; accepted: none, as there are no [[growths]]";
    site.refuses(&pose("p", "growths = { dry = 1.0 }"), words);
    // Growths of a pose act together, and what they come to is known when it is planned.
    for (strengths, found) in [
        ("dry = 4.0", "0.000 to 1.200"),
        ("old = 2.5", "-0.750 to 0.000"),
        ("dry = 1.0, old = -2.5", "0.000 to 1.050"),
    ] {
        let scene = site
            .read(&with_pose(&format!("growths = {{ {strengths} }}")))
            .unwrap();
        let words = format!(
            "pose 'p', layer 'skin' | {found} | from -0.6 to 1, of a layer against what lies below"
        );
        says(scene.plan().map(|_| ()), &words);
    }
}
