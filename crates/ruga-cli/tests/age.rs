//! `ruga age` and scenes that have aged.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, strip};
use serde_json::{Value, json};

/// Vertices along and across a strip of skin 16 cm long.
const COUNT: [usize; 2] = [17, 5];

/// A strip shortened by a share along its length.
fn shortened(along: f64) -> String {
    strip(COUNT, 0.25, |column, row| {
        [(1.0 - along) * 0.01 * column as f64, 0.01 * row as f64]
    })
}

const POSES: [&str; 2] = [
    "[[poses]]\nname = \"weak\"\nweights = { press = 0.5 }\nkeys = [1.0]\n",
    "[[poses]]\nname = \"strong\"\nweights = { press = 1.0 }\nkeys = [1.0]\n",
];

/// A strip with a crease across it.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("strip.obj", shortened(0.0));
    folder.write("press.obj", shortened(0.13));
    folder.write("scene.toml", scene(POSES, ""));
    folder
}

fn scene(poses: [&str; 2], memory: &str) -> String {
    format!(
        "version = 1\n[driver]\nmesh = \"strip.obj\"\ntargets = {{ press = \"press.obj\" }}\n\
         [[layers]]\nname = \"skin\"\npreset = \"forehead-furrow\"\nvariation = 0.0\n\
         [[creases]]\nname = \"line\"\npreset = \"frown-line\"\nuv = [[0.5, 0.97], [0.5, 0.78]]\n{memory}\n\
         {}{}\
         [bake]\nsize = 64\nmaps = [\"normal\"]\nformat = \"png8\"\npadding = 0\n",
        poses[0], poses[1]
    )
}

const REST: &str = "[[poses]]\nname = \"rest\"\nweights = { press = 0.0 }\nkeys = [1.0]\n";

#[test]
fn poses_leave_lines_and_an_aged_face_has_them_at_rest() {
    let folder = folder();
    let run = "age scene.toml -o aged --quality draft";
    let said = folder.ruga(run).exits(0);
    assert!(said.stdout.contains("left by wrinkles"), "{}", said.stdout);
    let network = folder.json("aged/creases.json");
    let creases = network["creases"].as_array().unwrap();
    assert_eq!(creases[0]["name"], "line");
    assert!(
        creases.len() > 2,
        "wrinkles left {} lines",
        creases.len() - 1
    );
    // Across the strip, as its wrinkles are, and not at its borders.
    for crease in &creases[1..] {
        let points = crease["points_m"].as_array().unwrap();
        let at = |i: usize, axis: usize| points[i][axis].as_f64().unwrap();
        let last = points.len() - 1;
        assert!((at(0, 0) - at(last, 0)).abs() < 0.01, "{}", crease["name"]);
        assert!((at(0, 1) - at(last, 1)).abs() > 0.02, "{}", crease["name"]);
    }

    // The order of poses does not matter, nor whether one was there before.
    folder.write("turned.toml", scene([POSES[1], POSES[0]], ""));
    let turned = "age turned.toml -o turned --quality draft --threads 1";
    folder.ruga(&format!("{turned} --pose strong")).exits(0);
    let resumed = folder.ruga(&format!("{turned} --resume")).exits(0);
    let there = "`strong` is there from an earlier run";
    assert!(resumed.stderr.contains(there), "{}", resumed.stderr);
    let text = |name: &str| folder.read(&format!("{name}/creases.json"));
    assert_eq!(text("aged"), text("turned"));

    let memory = "[memory]\nnetwork = \"aged/creases.json\"";
    folder.write("again.toml", scene(POSES, memory));
    let own = folder
        .ruga("age again.toml -o aged --quality draft")
        .exits(2);
    assert!(
        own.stderr.contains("the file that this run writes"),
        "{}",
        own.stderr
    );
    for (name, memory) in [("old", memory), ("young", "")] {
        let text = scene([REST, ""], memory);
        let text = text.replace("preset = \"frown-line\"", "");
        folder.write(&format!("{name}.toml"), text);
        folder
            .ruga(&format!(
                "bake {name}.toml -o {name} --quality draft --maps-only"
            ))
            .exits(0);
    }
    let folds = |name: &str| {
        folder.json(&format!("{name}/report.json"))["poses"][0]["layers"][0]["creases"].clone()
    };
    // Drawn by the load of its pose.
    assert_eq!(folds("young").as_array().unwrap().len(), 1);
    let old = folds("old");
    let kept = old.as_array().unwrap().iter();
    let kept = kept.filter(|crease| crease["fold_deg"]["mean"].as_f64().unwrap() > 2.0);
    assert!(kept.count() > 2, "{old}");
}

#[test]
fn what_is_wrong_with_a_network_is_told() {
    let folder = folder();
    let memory = "[memory]\nnetwork = \"net.json\"";
    folder.write("old.toml", scene(POSES, memory));
    let says = |network: &Value, words: &[&str]| {
        folder.write("net.json", network.to_string());
        let said = folder.ruga("plan old.toml --quality draft").exits(2).stderr;
        for word in words.iter().chain(&["memory.network", "net.json"]) {
            assert!(said.contains(word), "`{word}` is missing in {said}");
        }
    };
    let sample = json!({"share": 0.5, "angle_deg": 30.0, "softness_m": 0.0});
    let line = json!({"name": "line", "layer": "skin", "length_m": 0.0304, "along": [sample]});
    let with = |key: &str, value: Value| {
        let mut crease = line.clone();
        crease[key] = value;
        json!({"version": 1, "mesh": "Strip", "poses": [], "creases": [crease]})
    };
    let angle = json!([{"share": 0.5, "angle_deg": 200.0, "softness_m": 0.0}]);
    says(&with("along", angle), &["`line`", "200", "-150 to 150"]);
    says(
        &with("layer", json!("sole")),
        &["`line`", "no layer `sole`"],
    );
    says(
        &with("name", json!("gone")),
        &["`gone`", "no crease of this name", "ruga age"],
    );
    says(
        &with("length_m", json!(0.02)),
        &["20.00 mm long", "30.40 mm"],
    );
    let far = json!([[0.0, 0.0, 0.5], [0.1, 0.0, 0.5]]);
    says(
        &with("points_m", far.clone()),
        &["a crease of this name", "rename"],
    );
    let mut new = with("points_m", far);
    new["creases"][0]["name"] = json!("new");
    says(&new, &["`new`", "of another mesh?"]);
    says(
        &with("points_m", json!([[0.0, 0.0, 0.0]])),
        &["1 point", "at least 2"],
    );
    says(
        &json!({"version": 2, "mesh": "", "poses": [], "creases": []}),
        &["version", "found 2"],
    );
    says(&with("along", json!([])), &["`along`", "at least one"]);
    let mut twice = with("length_m", json!(0.0304));
    let again = twice["creases"][0].clone();
    twice["creases"].as_array_mut().unwrap().push(again);
    says(&twice, &["`line` is there twice"]);
    says(&json!([1, 2]), &["no network of creases", "ruga age"]);

    for (memory, words) in [
        ("network = \"none.json\"", "cannot be read"),
        ("yield = 0.0", "memory.yield | from 1 to 150"),
        (
            "wrinkle_yield = 400.0",
            "memory.wrinkle_yield | from 10 to 180",
        ),
        ("weakening = -1.0", "memory.weakening"),
        ("poses = [\"grin\"]", "grin"),
    ] {
        folder.write("old.toml", scene(POSES, &format!("[memory]\n{memory}")));
        let said = folder
            .ruga("age old.toml -o out --quality draft")
            .exits(2)
            .stderr;
        for word in words.split(" | ") {
            assert!(said.contains(word), "`{word}` is missing in {said}");
        }
    }
}

#[test]
fn further_runs_add_no_end_of_angle_to_the_ends_of_a_crease() {
    let folder = folder();
    let strong = [POSES[1], ""];
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for run in 1..=4 {
        let network = match run {
            1 => String::new(),
            _ => format!("network = \"run{}/creases.json\"", run - 1),
        };
        folder.write(
            "scene.toml",
            scene(strong, &format!("[memory]\nweakening = 0.0\n{network}")),
        );
        let said = folder
            .ruga(&format!("age scene.toml -o run{run} --quality draft"))
            .exits(0);
        let network = folder.json(&format!("run{run}/creases.json"));
        let line = &network["creases"][0];
        assert_eq!(line["name"], "line");
        assert!(line["places_m"].as_array().unwrap().len() > 2);
        let along = line["along"].as_array().unwrap().iter();
        let angles: Vec<f64> = along.map(|at| at["angle_deg"].as_f64().unwrap()).collect();
        let most = angles.iter().copied().fold(0.0, f64::max);
        let row = said
            .stdout
            .lines()
            .find(|row| row.starts_with("line "))
            .unwrap();
        assert!(row.contains(&format!("{most:.0} °")), "{row}: {most}");
        kept.push(angles);
    }
    // Each run adds less. Where the line fades its folds cannot be met, and adding what is missing has no end.
    let most = kept
        .iter()
        .map(|angles| angles.iter().copied().fold(0.0, f64::max));
    let most: Vec<f64> = most.collect();
    assert!(
        most[3] < 1.3 * most[0] && most[3] - most[2] < 1.0,
        "{most:?}: {kept:?}"
    );
}
