//! Sheets of bonded plies: what scenes say of them, how they bend, and in which words mistakes are told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::fmt::Write as _;

use fixture::{Folder, assert_says, read_scene as read};
use nalgebra::Vector3;
use ruga_io::{PngTexels, write_png};
use ruga_scene::{Scene, SceneFile};
use ruga_stepper::{Grows, PoseResult, Silent};

const LENGTH: f64 = 0.04;
const WIDTH: f64 = 0.006;
const CELLS: [u32; 2] = [40, 6];

const TOP: &str = "version = 1\n[driver]\nmesh = \"strip.obj\"\nsmoothing = \"none\"\n";
const SHEET: &str = "[sheet]\nedge = 0.002\n";
const DRY: &str = "[[growths]]\nname = \"dry\"\nply = \"upper\"\nalong = 0.003\nacross = 0.0\n";

/// A folder with a strip along x, an image that is white on the right half, and a white one.
fn folder() -> Folder {
    let mut text = String::from("o Strip\n");
    let [columns, rows] = CELLS;
    for (i, j) in (0..(columns + 1) * (rows + 1)).map(|v| (v % (columns + 1), v / (columns + 1))) {
        let [u, v] = [
            f64::from(i) / f64::from(columns),
            f64::from(j) / f64::from(rows),
        ];
        let _ = writeln!(text, "v {} {} 0\nvt {u} {v}", LENGTH * u, WIDTH * v);
    }
    for (i, j) in (0..columns * rows).map(|q| (q % columns, q / columns)) {
        let a = (columns + 1) * j + i + 1;
        let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
        let _ = match (i + j) % 2 {
            0 => writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}"),
            _ => writeln!(text, "f {a}/{a} {b}/{b} {d}/{d}\nf {b}/{b} {c}/{c} {d}/{d}"),
        };
    }
    let folder = Folder::new();
    folder.file("strip.obj", text);
    let (left, right) = ([0; 8], [255; 8]);
    for (name, halves) in [("right.png", [left, right]), ("white.png", [right, right])] {
        let texels = PngTexels::Grey8(halves.as_flattened());
        write_png(&folder.path(name), 16, 1, texels).unwrap();
    }
    folder
}

/// A layer of plies of these names, Young's moduli (Pa) and thicknesses (m).
fn layer(plies: &[(&str, f64, f64)]) -> String {
    let ply = |(name, young, thickness): &(&str, f64, f64)| {
        format!("{{ name = \"{name}\", young = {young}, thickness = {thickness} }}")
    };
    let plies: Vec<String> = plies.iter().map(ply).collect();
    format!(
        "[[layers]]\nname = \"leaf\"\npoisson = 0.3\ndensity = 800.0\nplies = [{}]\n",
        plies.join(", ")
    )
}

fn two(lower: [f64; 2], upper: [f64; 2]) -> String {
    layer(&[("lower", lower[0], lower[1]), ("upper", upper[0], upper[1])])
}

fn scene(tables: &[&str]) -> Scene {
    read(&folder(), &[&[TOP], tables].concat().concat()).unwrap()
}

/// A strip at the end of its pose.
struct Strip {
    rest: Vec<Vector3<f64>>,
    places: Vec<Vector3<f64>>,
    result: PoseResult,
}

fn run(tables: &[&str]) -> Strip {
    let scene = scene(tables);
    let plan = scene.plan().unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let key = result.keys.last().unwrap();
    Strip {
        rest: scene.driver.rest().to_vec(),
        places: key.artist_positions.clone().unwrap(),
        result,
    }
}

impl Strip {
    /// Place of the vertex that is at rest at these shares of length and width.
    fn at(&self, [u, v]: [f64; 2]) -> Vector3<f64> {
        let wanted = Vector3::new(LENGTH * u, WIDTH * v, 0.0);
        let mut pairs = self.rest.iter().zip(&self.places);
        let found = pairs.find(|(rest, _)| (*rest - wanted).norm() < 1e-9);
        *found.unwrap().1
    }

    /// Curvature (1/m) of the middle line between two shares of the length, positive where its middle is highest:
    /// that of the circle through both ends and the middle.
    fn curvature(&self, [from, to]: [f64; 2]) -> f64 {
        let [a, b, c] = [from, 0.5 * (from + to), to].map(|u| self.at([u, 0.5]));
        let (first, second) = (b - a, c - b);
        let turn = first.cross(&second);
        // The sheet may lie turned: up is where its own faces look.
        let across = self.at([from, 1.0]) - a;
        let sign = turn.dot(&across).signum();
        sign * 2.0 * turn.norm() / (first.norm() * second.norm() * (c - a).norm())
    }

    /// The largest height or depth, m.
    fn height(&self) -> f64 {
        self.places.iter().map(|x| x.z.abs()).fold(0.0, f64::max)
    }

    /// The largest distance of a vertex from where it is in another one, m.
    fn distance(&self, other: &Self) -> f64 {
        let pairs = self.places.iter().zip(&other.places);
        pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }
}

/// Shares of the length between which its ends are not felt.
const MIDDLE: [f64; 2] = [0.2, 0.8];

/// Timoshenko 1925, eq. 4: `m` ratio of thickness and `n` of modulus, each lower over upper.
fn timoshenko(m: f64, n: f64, strain: f64, thickness: f64) -> f64 {
    let square = (1.0 + m) * (1.0 + m);
    6.0 * strain * square / (thickness * (3.0 * square + (1.0 + m * n) * (m * m + 1.0 / (m * n))))
}

#[test]
fn a_strip_bends_as_timoshenkos_bimetal() {
    let (upper, modulus) = (4e-5, 2e9);
    for (m, n) in [(1.0, 1.0), (0.5, 4.0), (3.0, 0.2)] {
        let plies = two([n * modulus, m * upper], [modulus, upper]);
        let result = run(&[&plies, DRY, SHEET]);
        let found = result.curvature(MIDDLE);
        let expected = timoshenko(m, n, 0.003, (1.0 + m) * upper);
        let error = found / expected - 1.0;
        assert!(
            error.abs() < 0.02,
            "{m} {n}: {found} of {expected}, {error:.4}"
        );
    }
    // The other ply, or the other way.
    let plies = two([2.0 * modulus, upper], [modulus, upper]);
    let lower = DRY.replace("upper", "lower");
    let shrunk = DRY.replace("0.003", "-0.003");
    let both = [&lower, &shrunk].map(|dry| run(&[&plies, dry, SHEET]).curvature(MIDDLE));
    let expected = -timoshenko(1.0, 2.0, 0.003, 2.0 * upper);
    for found in both {
        assert!(
            (found / expected - 1.0).abs() < 0.02,
            "{found} of {expected}"
        );
    }
}

#[test]
fn plies_that_grow_alike_stay_flat() {
    let plies = two([8e9, 2e-5], [2e9, 4e-5]);
    let of_both = DRY.replace("ply = \"upper\"\n", "");
    let lower = DRY.replace("dry", "wet").replace("upper", "lower");
    let pose = "[[poses]]\nname = \"p\"\ngrowths = { dry = 1.0, wet = 1.0 }\n";
    let alone = run(&[&plies, &of_both, SHEET]);
    let each = run(&[&plies, DRY, &lower, SHEET, pose]);
    for result in [&alone, &each] {
        let height = result.height();
        assert!(height < 1e-9, "{height}");
        let length = (result.at([1.0, 0.5]) - result.at([0.0, 0.5])).norm();
        assert!((length / LENGTH - 1.003).abs() < 1e-8, "{length}");
    }
}

#[test]
fn equal_plies_without_growth_are_a_plain_sheet() {
    let plain = "[[layers]]\nname = \"leaf\"\npoisson = 0.3\ndensity = 800.0\nyoung = 2e9\nthickness = 6e-5\n";
    let sheet = format!(
        "{SHEET}gravity = [0, 0, -9.81]\nhandles = [{{ name = \"clip\", min = [-1, -1, -1], max = [0.0011, 1, 1] }}]\n"
    );
    let pose = "[[poses]]\nname = \"hang\"\nsteps = 4\n";
    let one = run(&[plain, &sheet, pose]);
    let plies = layer(&[("a", 2e9, 1e-5), ("b", 2e9, 3e-5), ("c", 2e9, 2e-5)]);
    let three = run(&[&plies, &sheet, pose]);
    let sag = one.height();
    assert!(sag > 1e-3, "{sag}");
    let distance = one.distance(&three);
    assert!(distance < 1e-9 * LENGTH, "{distance:e}");
    let [one, three] = [one, three].map(|strip| strip.result.layers[0].energy);
    assert!((three / one - 1.0).abs() < 1e-9, "{three} {one}");
}

#[test]
fn a_painted_ply_bends_where_it_grows() {
    let plies = two([2e9, 4e-5], [2e9, 4e-5]);
    let painted = format!("{DRY}image = \"right.png\"\n");
    let strip = run(&[&plies, &painted, SHEET]);
    let expected = timoshenko(1.0, 1.0, 0.003, 8e-5);
    let [left, right] = [[0.05, 0.4], [0.6, 0.95]].map(|part| strip.curvature(part));
    assert!(left.abs() < 0.02 * expected, "{left} of {expected}");
    assert!(
        (right / expected - 1.0).abs() < 0.02,
        "{right} of {expected}"
    );
}

#[test]
fn painted_thickness_scales_all_plies() {
    let map = "map = { image = \"white.png\", thickness = [0.5, 2.0] }\n";
    let plies = two([8e9, 2e-5], [2e9, 4e-5]) + map;
    let grey = plies.replace("image = ", "thickness_image = ");
    let found = run(&[&grey, DRY, SHEET]).curvature(MIDDLE);
    let expected = timoshenko(0.5, 4.0, 0.003, 2.0 * 6e-5);
    assert!(
        (found / expected - 1.0).abs() < 0.02,
        "{found} of {expected}"
    );
}

#[test]
fn curl_of_the_whole_adds_to_that_of_plies() {
    let plies = two([2e9, 4e-5], [2e9, 4e-5]);
    let curl = "[[growths]]\nname = \"roll\"\ncurl = [-30.0, 0.0]\n";
    let pose = "[[poses]]\nname = \"p\"\ngrowths = { dry = 1.0, roll = 1.0 }\n";
    let found = run(&[&plies, DRY, curl, SHEET, pose]).curvature(MIDDLE);
    let expected = timoshenko(1.0, 1.0, 0.003, 8e-5) - 30.0;
    assert!(
        (found / expected - 1.0).abs() < 0.02,
        "{found} of {expected}"
    );
}

#[test]
fn plies_are_read_with_their_masses() {
    let dense = "thickness = 0.00005, density = 1200.0 }";
    let plies = two([1e9, 3e-5], [3e9, 5e-5]).replace("thickness = 0.00005 }", dense);
    let scene = scene(&[&plies, DRY, SHEET]);
    let layer = &scene.layers[0];
    let material = &layer.material;
    let mass = 800.0 * 3e-5 + 1200.0 * 5e-5;
    assert!((material.density * material.thickness / mass - 1.0).abs() < 1e-12);
    let stretching = 1e9 * 3e-5 + 3e9 * 5e-5;
    assert!((material.young * material.thickness / stretching - 1.0).abs() < 1e-12);
    assert_eq!(layer.growths[0].grows, Grows::Ply(1));
    assert_eq!(layer.laminate.as_ref().unwrap().ply_count(), 2);
    let text = scene.file.to_toml();
    let again = SceneFile::from_toml(&text, "scene.toml".as_ref()).unwrap();
    assert_eq!(again, scene.file);
}

/// Fire takes the stiffness of the plies, and curls them by the distance of their own faces.
#[test]
fn plies_burn_as_an_even_sheet_of_other_faces() {
    let burn = |asymmetry: f64| {
        format!(
            "[burn]\nfront_speed = 4e-3\nfront_width = 4e-3\nedges_per_width = 2\nasymmetry = {asymmetry}\nsources = [{{ name = \"match\", sphere = {{ centre = [0.04, 0.003, 0.0], radius = 0.01 }}, temperature = 1500.0 }}]\n"
        )
    };
    let rest = "[solver]\nmode = \"dynamic\"\ntime_step = 0.5\n[[poses]]\nname = \"p\"\nkeys = [1.0]\nsteps = 4\n";
    let clip = format!(
        "{SHEET}handles = [{{ name = \"clip\", min = [-1, -1, -1], max = [0.0011, 1, 1] }}]\n"
    );
    let plies = two([8e9, 2e-5], [1e9, 4e-5]);
    let even = *scene(&[&plies, DRY, SHEET]).layers[0]
        .laminate
        .as_ref()
        .unwrap()
        .material();
    let plain = format!(
        "[[layers]]\nname = \"leaf\"\npoisson = 0.3\ndensity = {}\nyoung = {}\nthickness = {}\n",
        even.density, even.young, even.thickness
    );
    let thinner = even.thickness / 6e-5;
    assert!(thinner < 0.95, "{thinner}");
    let both = run(&[&plies, &clip, &burn(0.01), rest]);
    let one = run(&[&plain, &clip, &burn(0.01 * thinner), rest]);
    let fuel = one.result.layers[0].fire.as_ref().unwrap().fuel_left;
    assert!(fuel < 0.95, "{fuel}");
    let (height, distance) = (one.height(), one.distance(&both));
    // The same sheet in other digits: each solve ends somewhere within its tolerance, and which way char crumples hangs
    // by a hair. Sheets whose stiffness differs by 1e-13 came out up to 2e-3 of the height apart; one with the
    // asymmetry of all of the thickness is 5e-3 from this one.
    assert!(
        height > 1e-4 && distance < 3e-3 * height,
        "{height} {distance:e}"
    );
}

const ELASTIC: &str = "young = 2e9\nthickness = 1e-4\n";

/// Scenes of plies that are refused, as `what is replaced => by what => words of the message`.
const MISTAKES: &str = r#"
plies = [ => young = 2e9; plies = [ => layers[0].plies | found young beside it; accepted: `plies` alone
plies = [ => thickness = 1e-4; young = 1.0; plies = [ => layers[0].plies | found young, thickness beside it
plies = [ => preset = "cheek"; plies = [ => layers[0].plies | found preset beside it
plies = [ => wavelength = 1e-3; plies = [ => layers[0].plies | found wavelength beside it
"lower" => "upper" => layers[0].plies[1].name | found `upper` twice
"lower" => "a/b" => layers[0].plies[0].name | part of a file name
young = 2000000000 => young = 0.0 => layers[0].plies[0].young | found 0; accepted: a number above 0
young = 2000000000 => young = inf => layers[0].plies[0].young | found inf
young = 2000000000 => yung = 1e9 => layers[0].plies[0] | `yung` is not a key of `[[layers.plies]]` | did you mean `young`
young = 2000000000,  =>  => layers[0].plies[0] | `young` is missing
thickness = 0.00004 => thickness = -1e-5 => layers[0].plies[0].thickness | found -0.00001; accepted: a number above 0
thickness = 0.00004 => thickness = nan => layers[0].plies[0].thickness | found NaN
thickness = 0.00004 => thickness = 1e-5, density = 0.0 => layers[0].plies[0].density | found 0; accepted: a number above 0
poisson = 0.3 => poisson = 0.6 => layers[0].poisson | found 0.6
young = 2000000000, thickness = 0.00004 => young = 1e300, thickness = 1e300 => layers[0] | too far apart
ply = "upper" => ply = "uper" => growths[0].ply | there is no ply `uper`; accepted: `lower`, `upper` | did you mean `upper`
ply = "upper" => ply = "upper"; curl = [1.0, 0.0] => growths[0].curl | found [1.0, 0.0] beside `ply`; accepted: one of the two
ply = "upper" => ply = 1 => growths[0].ply | found 1; accepted: text in quotes
along = 0.003 => along = 1.5 => growths[0].along | found 1.5; accepted: from -0.6 to 1
"#;

#[test]
fn mistakes_are_told_in_the_words_of_the_scene() {
    let folder = folder();
    let plies = two([2e9, 4e-5], [1e9, 5e-5]);
    let refuses = |text: &str, words: &str| {
        let words: Vec<&str> = words.split(" | ").collect();
        let found = read(&folder, text).and_then(|scene| scene.plan().map(|_| ()));
        assert_says(found, "scene.toml", &words);
    };
    let good = [TOP, &plies, DRY, SHEET].concat();
    read(&folder, &good).unwrap().plan().unwrap();
    for row in MISTAKES.trim().lines() {
        let [from, to, words] = row.split(" => ").collect::<Vec<_>>().try_into().unwrap();
        assert!(good.contains(from), "{row}");
        refuses(&good.replacen(from, &to.replace("; ", "\n"), 1), words);
    }
    let empty = layer(&[]);
    let words = "layers[0].plies | found an empty list; accepted: at least one";
    refuses(&[TOP, &empty, SHEET].concat(), words);
    let plain = format!("[[layers]]\nname = \"leaf\"\n{ELASTIC}");
    let words =
        "growths[0].ply | there is no ply `upper`; accepted: none, as the layer has no `plies`";
    refuses(&[TOP, &plain, DRY, SHEET].concat(), words);
    // Skin, a layer on skin, and a body.
    let words = "plies | found 2 of them; accepted: none but with [sheet]";
    let on_skin = [TOP, &plies, "[substrate]\nyoung = 1e5\n", DRY].concat();
    refuses(&on_skin, &format!("layers[0].{words}"));
    let skin = "[[layers]]\nname = \"skin\"\npreset = \"cheek\"\n";
    refuses(&[TOP, skin, &plies].concat(), &format!("layers[1].{words}"));
    let body = [
        TOP,
        &plies,
        "[substrate]\nyoung = 1e5\n[interior]\ncells = 4\n",
    ]
    .concat();
    refuses(&body, &format!("layers[0].{words}"));
}

/// What growths of a pose come to is known when it is planned: of each ply for itself.
#[test]
fn growths_of_each_ply_keep_their_range() {
    let folder = folder();
    let plies = two([2e9, 4e-5], [1e9, 5e-5]);
    let large = DRY.replace("0.003", "0.8");
    let lower = large.replace("dry", "wet").replace("upper", "lower");
    let of_both = large.replace("dry", "all").replace("ply = \"upper\"\n", "");
    let planned = |growths: &str| {
        let pose = format!("[[poses]]\nname = \"p\"\ngrowths = {{ {growths} }}\n");
        let text = [TOP, &plies, &large, &lower, &of_both, SHEET, &pose].concat();
        read(&folder, &text).and_then(|scene| scene.plan().map(|_| ()))
    };
    planned("dry = 1.0, wet = 1.0").unwrap();
    let words = ["pose 'p', layer 'leaf'", "0.000 to 1.600", "from -0.6 to 1"];
    assert_says(planned("dry = 1.0, all = 1.0"), "scene.toml", &words);
    assert_says(planned("wet = 2.0"), "scene.toml", &words);
}
