//! Scenes of soft bodies: what `[interior]` and motions mean, what is refused, in which words.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::path::Path;

use fixture::assert_says;
use ruga_scene::file::{CellShape, Cylinder, Handle, Motion, Obstacle, Plane, Pose, Sphere};
use ruga_scene::{SceneError, SceneFile};

const BODY: &str = r#"
version = 1
[driver]
mesh = "pillow.glb"
[substrate]
young = 2e4
[[layers]]
name = "skin"
young = 2e6
thickness = 5e-4

[interior]
cells = 8
shape = "linear"
density = 950.0
gravity = [0.0, 0, -9.81]
follow = 1e6

[[interior.handles]]
name = "left"
min = [-0.01, -1, -1]
max = [0.01, 1, 1]

[[interior.obstacles]]
name = "button"
cylinder = { from = [0, 0, 0.05], to = [0, 0, 0.1], radius = 0.01 }

[[interior.obstacles]]
name = "ball"
sphere = { centre = [0.1, 0, 0], radius = 0.02 }

[[interior.obstacles]]
name = "floor"
plane = { point = [0, 0, -0.02], normal = [0, 0, 2] }

[[poses]]
name = "press"
motions = [
    { of = "button", at = 0.5, move = [0, 0, -0.03] },
    { of = "left", at = 0.25, turn = [0, 90, 0], about = [0.01, 0, 0] },
    { of = "button", at = 1 },
]
"#;

fn parse(text: &str) -> Result<SceneFile, SceneError> {
    SceneFile::from_toml(text, Path::new("scene.toml"))
}

/// `BODY` with one piece of text replaced.
fn with(old: &str, new: &str) -> Result<SceneFile, SceneError> {
    assert!(BODY.contains(old), "{old}");
    parse(&BODY.replacen(old, new, 1))
}

fn refused(old: &str, new: &str, words: &[&str]) {
    assert_says(with(old, new), "scene.toml", words);
}

#[test]
fn a_body_is_what_the_file_says() {
    let scene = parse(BODY).unwrap();
    let interior = scene.interior.as_ref().unwrap();
    assert_eq!(
        (interior.cells, interior.shape),
        (Some(8), CellShape::Linear)
    );
    assert_eq!((interior.density, interior.follow), (950.0, Some(1e6)));
    assert_eq!(interior.gravity, [0.0, 0.0, -9.81]);
    let left = Handle {
        name: "left".to_owned(),
        min: [-0.01, -1.0, -1.0],
        max: [0.01, 1.0, 1.0],
    };
    assert_eq!(interior.handles, [left]);
    let button = Cylinder {
        from: [0.0, 0.0, 0.05],
        to: [0.0, 0.0, 0.1],
        radius: 0.01,
    };
    let ball = Sphere {
        centre: [0.1, 0.0, 0.0],
        radius: 0.02,
    };
    let floor = Plane {
        point: [0.0, 0.0, -0.02],
        normal: [0.0, 0.0, 2.0],
    };
    let shapes = |obstacle: &Obstacle| (obstacle.cylinder, obstacle.sphere, obstacle.plane);
    let shapes: Vec<_> = interior.obstacles.iter().map(shapes).collect();
    let wanted = [
        (Some(button), None, None),
        (None, Some(ball), None),
        (None, None, Some(floor)),
    ];
    assert_eq!(shapes, wanted);
    let movable: Vec<_> = interior.movers().names().collect();
    assert_eq!(movable, ["left", "button", "ball", "floor"]);
}

#[test]
fn motions_are_what_the_file_says() {
    let scene = parse(BODY).unwrap();
    let motion = |of: &str, at: f64| Motion {
        of: of.to_owned(),
        at,
        translation: [0.0; 3],
        turn: [0.0; 3],
        about: [0.0; 3],
    };
    let wanted = [
        Motion {
            translation: [0.0, 0.0, -0.03],
            ..motion("button", 0.5)
        },
        Motion {
            turn: [0.0, 90.0, 0.0],
            about: [0.01, 0.0, 0.0],
            ..motion("left", 0.25)
        },
        motion("button", 1.0),
    ];
    assert_eq!(scene.poses[0].motions, wanted);
    assert!(scene.poses[0].weights.is_empty());
}

#[test]
fn what_is_left_out_has_a_default() {
    let from = BODY.find("[interior]").unwrap();
    let scene = parse(&format!("{}[interior]\n", &BODY[..from])).unwrap();
    let interior = scene.interior.unwrap();
    assert_eq!(
        (interior.cells, interior.shape),
        (None, CellShape::Quadratic)
    );
    assert_eq!(interior.density, 1100.0);
    assert_eq!(interior.gravity, [0.0; 3]);
    assert_eq!(interior.follow, None);
    assert!(interior.handles.is_empty() && interior.obstacles.is_empty());
}

#[test]
fn text_and_back() {
    let scene = parse(BODY).unwrap();
    assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
    for mode in ["static", "dynamic"] {
        let text = format!("{BODY}\n[solver]\nmode = \"{mode}\"\n[remesh]\nenabled = false\n");
        let scene = parse(&text).unwrap();
        assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
    }
}

#[test]
fn slips_of_the_hand_get_a_suggestion() {
    for (old, slip, key) in [
        ("gravity", "gravty", "interior"),
        ("follow", "folow", "interior"),
        ("handles", "handels", "interior"),
        ("obstacles", "obstacle", "interior"),
        ("min", "mim", "interior.handles[0]"),
        ("cylinder", "cilinder", "interior.obstacles[0]"),
        ("radius", "radus", "interior.obstacles[0].cylinder"),
        ("centre", "center", "interior.obstacles[1].sphere"),
        ("normal", "normel", "interior.obstacles[2].plane"),
        ("motions", "motion", "poses[0]"),
        ("move", "mov", "poses[0].motions[0]"),
        ("about", "abaut", "poses[0].motions[1]"),
    ] {
        let remedy = format!("did you mean `{old}`");
        refused(old, slip, &[key, slip, &remedy, "line"]);
    }
    refused("\"linear\"", "\"linar\"", &["did you mean `linear`"]);
    refused(
        "name = \"left\"\n",
        "",
        &["handles[0]", "the key `name` is missing"],
    );
    refused(
        "at = 0.25, ",
        "",
        &["motions[1]", "the key `at` is missing; write `at = 0.5`"],
    );
    refused(", radius = 0.01", "", &["the key `radius` is missing"]);
    refused(
        "gravity = [0.0, 0, -9.81]",
        "gravity = [0.0, -9.81]",
        &["interior.gravity", "3"],
    );
    refused("max = [0.01, 1, 1]", "max = 0.01", &["handles[0].max"]);
}

#[test]
fn numbers_of_the_body_out_of_range() {
    refused("cells = 8", "cells = 65", &["interior.cells", "1 to 64"]);
    for bad in ["0.0", "-1.0", "nan", "inf"] {
        for (old, key) in [("density = 950.0", "density"), ("follow = 1e6", "follow")] {
            let key = format!("interior.{key}");
            let new = format!("{} = {bad}", &key[9..]);
            refused(old, &new, &[&key, "found", "above 0"]);
        }
        for (old, key) in [
            ("radius = 0.01", "obstacles[0].cylinder.radius"),
            ("radius = 0.02", "obstacles[1].sphere.radius"),
        ] {
            refused(old, &format!("radius = {bad}"), &[key, "found", "above 0"]);
        }
    }
}

#[test]
fn coordinates_that_are_no_numbers() {
    for bad in ["nan", "inf", "-inf"] {
        for (old, new, key) in [
            ("gravity = [0.0", "gravity = [X", "interior.gravity[0]"),
            ("min = [-0.01", "min = [X", "interior.handles[0].min[0]"),
            ("max = [0.01, 1", "max = [0.01, X", "handles[0].max[1]"),
            ("from = [0", "from = [X", "obstacles[0].cylinder.from[0]"),
            ("to = [0, 0", "to = [0, X", "obstacles[0].cylinder.to[1]"),
            (
                "centre = [0.1",
                "centre = [X",
                "obstacles[1].sphere.centre[0]",
            ),
            ("point = [0", "point = [X", "obstacles[2].plane.point[0]"),
            ("normal = [0", "normal = [X", "obstacles[2].plane.normal[0]"),
            ("move = [0", "move = [X", "poses[0].motions[0].move[0]"),
            (
                "turn = [0, 90",
                "turn = [0, X",
                "poses[0].motions[1].turn[1]",
            ),
            (
                "about = [0.01",
                "about = [X",
                "poses[0].motions[1].about[0]",
            ),
        ] {
            refused(
                old,
                &new.replace('X', bad),
                &[key, "found", "a finite number"],
            );
        }
    }
}

#[test]
fn boxes_cylinders_and_planes_that_are_flat() {
    for bad in ["1", "2"] {
        refused(
            "min = [-0.01, -1, -1]",
            &format!("min = [-0.01, {bad}, -1]"),
            &[
                "handles[0].min[1]",
                &format!("found {bad}"),
                "below max[1] = 1",
            ],
        );
    }
    refused(
        "to = [0, 0, 0.1]",
        "to = [0, 0, 0.05]",
        &["obstacles[0].cylinder.to", "[0.0, 0.0, 0.05]", "`from`"],
    );
    for bad in ["[0, 0, 0]", "[1e-200, 0, 0]", "[0, 1e200, 0]"] {
        refused(
            "normal = [0, 0, 2]",
            &format!("normal = {bad}"),
            &["obstacles[2].plane.normal", "found [", "not zero"],
        );
    }
}

#[test]
fn an_obstacle_has_one_shape() {
    let ball = "sphere = { centre = [0.1, 0, 0], radius = 0.02 }\n";
    let one = "exactly one of plane, sphere, cylinder";
    refused(ball, "", &["interior.obstacles[1]", "none of them", one]);
    let plane = "plane = { point = [0, 0, 0], normal = [0, 0, 1] }\n";
    refused(
        ball,
        &format!("{ball}{plane}"),
        &["interior.obstacles[1]", "plane, sphere", one],
    );
}

#[test]
fn things_have_names_of_their_own() {
    for name in ["left", "button"] {
        refused(
            "name = \"ball\"",
            &format!("name = \"{name}\""),
            &["obstacles[1].name", &format!("`{name}` twice"), "different"],
        );
    }
    let again = "[[interior.handles]]\nname = \"left\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n";
    refused(
        "[[interior.obstacles]]",
        &format!("{again}[[interior.obstacles]]"),
        &["handles[1].name", "`left` twice"],
    );
    for empty in ["", " "] {
        let new = format!("name = \"{empty}\"");
        refused("name = \"left\"", &new, &["handles[0].name", "motions"]);
    }
}

#[test]
fn motions_of_what_there_is() {
    refused(
        "of = \"left\"",
        "of = \"letf\"",
        &[
            "poses[0].motions[1].of",
            "`letf`",
            "did you mean `left`",
            "`ball`",
        ],
    );
    let from = BODY.find("[[interior.handles]]").unwrap();
    let to = BODY.find("[[poses]]").unwrap();
    let nothing = format!("{}{}", &BODY[..from], &BODY[to..]);
    assert_says(
        parse(&nothing),
        "scene.toml",
        &["poses[0].motions[0].of", "`button`", "has none"],
    );
}

#[test]
fn keyframes_ascend() {
    for bad in ["0", "-0.5", "1.5", "nan"] {
        let new = format!("at = {bad}");
        refused(
            "at = 0.25",
            &new,
            &["poses[0].motions[1].at", "above 0, up to 1"],
        );
    }
    for bad in ["0.5", "0.4"] {
        refused(
            "at = 1 }",
            &format!("at = {bad} }}"),
            &[
                "poses[0].motions[2].at",
                &format!("found {bad}"),
                "above 0.5",
                "`button`",
            ],
        );
    }
    // Each thing has its own order.
    assert!(with("at = 0.25", "at = 0.5").is_ok());
}

#[test]
fn a_scene_without_an_interior_is_as_before() {
    let from = BODY.find("[interior]").unwrap();
    let to = BODY.find("[[poses]]").unwrap();
    let skin = format!("{}{}", &BODY[..from], &BODY[to..]);
    let weighed = skin.replacen("motions", "weights = { a = 1.0 }\nmotions", 1);
    assert_says(
        parse(&weighed),
        "scene.toml",
        &["poses[0].motions", "3 of them", "[interior]"],
    );
    for text in ["", "weights = {}\n"] {
        let none = format!("{}[[poses]]\nname = \"a\"\n{text}", &BODY[..from]);
        let words = ["poses[0].weights", "at least one blend shape"];
        assert_says(parse(&none), "scene.toml", &words);
    }
}

#[test]
fn poses_of_bodies() {
    let path = Path::new("scene.toml");
    let smile = ["smile".to_owned()];
    let poses = |text: &str, shapes: &[String]| parse(text)?.poses_or_shapes(shapes, path);
    let own = parse(BODY).unwrap().poses;
    assert_eq!(poses(BODY, &[]).unwrap(), own);
    let stiff = BODY.replacen("follow = 1e6\n", "", 1);
    // Shapes that no pose weighs are no contradiction.
    assert_eq!(poses(&stiff, &smile).unwrap(), own);
    let weighed = stiff.replacen("motions", "weights = { smile = 1.0 }\nmotions", 1);
    let remedy = [
        "poses[0].weights",
        "do not move a body",
        "`follow` in [interior]",
    ];
    assert_says(poses(&weighed, &smile), "scene.toml", &remedy);
    let unknown = ["poses[0].weights.smile", "no blend shape"];
    assert_says(poses(&weighed, &[]), "scene.toml", &unknown);

    let none = &BODY[..BODY.find("[[poses]]").unwrap()];
    assert_eq!(
        poses(none, &smile).unwrap(),
        [Pose::of_shape("smile", "smile")]
    );
    assert_eq!(poses(none, &[]).unwrap(), [Pose::at_rest("rest")]);
    let stiff = none.replacen("follow = 1e6\n", "", 1);
    let remedy = ["`poses`", "`follow` in [interior]", "motions"];
    assert_says(poses(&stiff, &smile), "scene.toml", &remedy);
    assert_eq!(poses(&stiff, &[]).unwrap(), [Pose::at_rest("rest")]);
    let floating = none.replacen("-9.81", "0", 1);
    let nothing = ["`interior`", "nothing moves the body", "gravity"];
    assert_says(poses(&floating, &[]), "scene.toml", &nothing);
}
