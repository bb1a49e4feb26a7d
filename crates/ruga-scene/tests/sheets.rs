//! Sheets of scenes: what the file says of them, how they move, and in which words mistakes are told.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{assert_says, folder_of_sheet as folder, read_scene as read};
use ruga_scene::{SceneError, SceneFile};
use ruga_stepper::Silent;

const TOP: &str = "version = 1\n[driver]\nmesh = \"paper.obj\"\nsmoothing = \"none\"\n";
const LAYER: &str = "[[layers]]\nname = \"paper\"\nyoung = 3e9\npoisson = 0.3\nthickness = 1e-4\n";
const SHEET: &str = "[sheet]\nedge = 0.01\nhandles = [{ name = \"clip\", min = [-1, -1, -1], max = [0.001, 1, 1] }]\n";
const CURL: &str = "[[growths]]\nname = \"dry\"\ncurl = [0.0, 30.0]\n";

#[test]
fn a_sheet_curls_by_a_growth_and_bakes() {
    let folder = folder();
    let bake = "[bake]\nsize = 64\n";
    let text = format!("{TOP}{LAYER}{CURL}{SHEET}{bake}");
    let scene = read(&folder, &text).unwrap();
    // Without poses, every growth is one.
    assert_eq!(scene.poses.len(), 1);
    let plan = scene.plan().unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let key = result.keys.last().unwrap();
    let places = key.artist_positions.as_ref().unwrap();
    let deepest = places.iter().map(|x| x.z.abs()).fold(0.0, f64::max);
    assert!(deepest > 2e-3, "{deepest}");
    // The artist's mesh has gone all of the way, and the map has what is finer.
    let map = &scene.bake_key(&scene.poses[0], key).unwrap()[0];
    assert!(map.normals.iter().all(|[_, _, z]| *z > 0.9));
}

/// A crease far shorter than the paper would wrinkle on anything, on a mesh with blend shapes that nobody asks for.
#[test]
fn a_short_crease_folds_a_sheet() {
    let folder = folder();
    let crease = "[[creases]]\nname = \"line\"\nuv = [[0.25, 0.5], [0.75, 0.5]]\nangle = 60.0\nstiffness = 0.001\n";
    let targets = TOP.to_owned() + "targets = { lift = \"paper.obj\" }\n";
    let text = format!("{targets}{LAYER}{crease}{}", SHEET.replace("0.01", "0.004"));
    let scene = read(&folder, &text).unwrap();
    assert_eq!(scene.poses.len(), 1);
    let plan = scene.plan().unwrap();
    let result = plan.simulate(0, &mut Silent).unwrap();
    assert!(result.converged, "{:?}", result.warnings);
    let fold = &result.layers[0].creases[0];
    assert!(fold.largest_fold > 0.02 && fold.length > 0.019, "{fold:?}");
    // Both sides of the line have vertices of their own, in the same places.
    let layer = &result.keys[0].layers[0];
    assert!(layer.positions.len() > layer.computed.positions.len());
}

#[test]
fn what_a_sheet_says_is_read_back() {
    let text = format!("{TOP}{LAYER}{CURL}{SHEET}");
    let file = SceneFile::from_toml(&text, "scene.toml".as_ref()).unwrap();
    let sheet = file.sheet.as_ref().unwrap();
    assert_eq!((sheet.edge, sheet.gravity), (Some(0.01), [0.0; 3]));
    assert_eq!(file.growths[0].curl, [0.0, 30.0]);
    let again = SceneFile::from_toml(&file.to_toml(), "scene.toml".as_ref()).unwrap();
    assert_eq!(again, file);
}

#[test]
fn mistakes_are_told_in_the_words_of_the_scene() {
    let folder = folder();
    let with = |parts: &[&str]| format!("{TOP}{}", parts.concat());
    let pose = "[[poses]]\nname = \"p\"\n";
    let moved = format!("{pose}motions = [{{ of = \"clop\", at = 1.0 }}]\n");
    let weighed = format!("{pose}weights = {{ smile = 1.0 }}\n");
    let preset = "[[layers]]\nname = \"skin\"\npreset = \"cheek\"\n";
    let second = LAYER.replace("\"paper\"", "\"other\"");
    let falling = "[sheet]\ngravity = [0, 0, -9.81]\n";
    let far = SHEET.replace("max = [0.001", "max = [-0.001");
    for (text, words) in [
        (with(&[LAYER, SHEET]), ["sheet", "nothing moves the sheet"]),
        (
            with(&[LAYER, SHEET, pose]),
            ["poses[0]", "`gravity` in [sheet]"],
        ),
        (
            with(&[LAYER, SHEET, CURL, &moved]),
            ["poses[0].motions[0].of", "`clip`"],
        ),
        (
            with(&[LAYER, SHEET, &weighed]),
            ["poses[0].weights", "no blend shapes with [sheet]"],
        ),
        (
            with(&[preset, SHEET, CURL]),
            ["layers[0]", "`young` and `thickness` with [sheet]"],
        ),
        (
            with(&[LAYER, &second, SHEET, CURL]),
            ["layers", "one layer with [sheet]"],
        ),
        (
            with(&[LAYER, "[substrate]\n", SHEET, CURL]),
            ["substrate", "lies on nothing"],
        ),
        (
            with(&[LAYER, "[interior]\n", SHEET, CURL]),
            ["sheet", "either [interior]"],
        ),
        (
            with(&[LAYER, "mask = \"m.png\"\n", SHEET, CURL]),
            ["layers[0].mask", "m.png"],
        ),
        (
            with(&[LAYER, "[substrate]\nyoung = 1e5\n", CURL]),
            ["growths[0].curl", "none without [sheet]"],
        ),
        (
            with(&[LAYER, &SHEET.replace("0.01\n", "0\n"), CURL]),
            ["sheet.edge", "a number above 0"],
        ),
        (
            with(&[LAYER, CURL, "preset = \"drying\"\n", SHEET]),
            ["growths[0].layer", "a sheet lies on nothing"],
        ),
        (
            with(&[LAYER, falling, pose]),
            ["holds 0 of 1 parts", "motion in time"],
        ),
        (
            with(&[LAYER, CURL, &far]),
            ["handle 'clip'", "holds no vertex of the sheet"],
        ),
        (
            with(&[LAYER, CURL, &SHEET.replace("edge = 0.01", "edge = 1e-7")]),
            ["`edge`", "vertex budget"],
        ),
    ] {
        let found = read(&folder, &text).and_then(|scene| {
            let plan = scene.plan()?;
            plan.simulate(0, &mut Silent)
                .map_err(|source| SceneError::Model {
                    scene: scene.path.clone(),
                    source: Box::new(source),
                })
        });
        // Not the result itself, which would be printed where it is accepted.
        assert_says(found.map(|_| text), "scene.toml", &words);
    }
}
