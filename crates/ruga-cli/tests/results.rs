//! What `bake`, `simulate`, `plan` and `check` write and print for a scene that runs.

mod fixture;

use fixture::Folder;
use ruga_io::{read_image, read_mesh};
use serde_json::Value;

/// A report without what a clock put in it.
fn without_seconds(mut report: Value) -> Value {
    for pose in report["poses"].as_array_mut().expect("a list") {
        for layer in pose["layers"].as_array_mut().expect("a list") {
            layer["seconds"] = Value::Null;
        }
    }
    report
}

#[test]
fn bake_writes_maps_mesh_manifest_and_report() {
    let folder = Folder::new();
    let run = folder.ruga("bake scene.toml -o out --threads 1").exits(0);
    assert_eq!(
        folder.files("out"),
        [
            "Patch.glb",
            "maps/squeezed_100_height.png",
            "maps/squeezed_100_normal.png",
            "maps/squeezed_50_height.png",
            "maps/squeezed_50_normal.png",
            "poses/squeezed.json",
            "preview.html",
            "report.json",
            "wrinkles.json",
        ]
    );
    assert!(
        run.stdout.contains("squeezed") && run.stdout.contains("skin"),
        "{}",
        run.stdout
    );
    assert!(run.stderr.contains("started"), "{}", run.stderr);

    let report = folder.json("out/report.json");
    let layer = &report["poses"][0]["layers"][0];
    assert_eq!(report["poses"][0]["converged"], true);
    assert_eq!(
        report["poses"][0]["maps"]["50_normal"],
        "maps/squeezed_50_normal.png"
    );
    let predicted = layer["wavelength_predicted_m"].as_f64().unwrap();
    assert!((predicted / 0.03 - 1.0).abs() < 1e-6, "{predicted}");
    // At three times the critical strain the slope is large: 3 % of the wavelength is little.
    assert!(layer["amplitude_m"].as_f64().unwrap() > 9e-4, "{layer}");
    let seconds = &layer["seconds"];
    assert!(
        seconds["total"].as_f64() >= seconds["integration"].as_f64(),
        "{seconds}"
    );

    let manifest = folder.json("out/wrinkles.json");
    assert_eq!(manifest["maps"].as_array().unwrap().len(), 4);
    assert_eq!(manifest["poses"]["squeezed"]["squeeze"], 1.0);
    let height = &manifest["maps"][3];
    let image = read_image(&folder.path("out").join(height["file"].as_str().unwrap())).unwrap();
    let [mid, scale] = ["mid", "scale"].map(|key| height[key].as_f64().unwrap());
    let metres = image.values.iter().map(|v| (f64::from(*v) - mid) * scale);
    let highest = metres.fold(0.0, f64::max);
    assert!((5e-4..5e-3).contains(&highest), "{highest} m");

    let mesh = read_mesh(&folder.path("out/Patch.glb"), None, &Default::default()).unwrap();
    assert_eq!((mesh.mesh.positions.len(), mesh.mesh.shapes.len()), (81, 3));
}

#[test]
fn threads_do_not_change_a_byte() {
    let folder = Folder::new();
    let again = |name: &str| {
        format!("[[poses]]\nname = \"{name}\"\nweights = {{ squeeze = 0.8 }}\nsteps = 2\n")
    };
    let poses = format!("{}{}[remesh]", again("some"), again("more"));
    folder.change("scene.toml", "[remesh]", &poses);
    folder.ruga("bake scene.toml -o one --threads 1").exits(0);
    folder.ruga("bake scene.toml -o two --threads 2").exits(0);
    let files = folder.files("one");
    assert_eq!(files, folder.files("two"));
    assert_eq!(
        files.iter().filter(|file| file.ends_with(".png")).count(),
        12
    );
    for file in files.iter().filter(|file| !file.starts_with("poses/")) {
        if file != "report.json" {
            let [one, two] = ["one", "two"].map(|out| folder.read(&format!("{out}/{file}")));
            assert!(one == two, "{file} differs");
        }
    }
    let [one, two] = ["one", "two"].map(|out| folder.json(&format!("{out}/report.json")));
    assert_eq!(without_seconds(one), without_seconds(two));
}

#[test]
fn a_pose_in_which_nothing_wrinkles_is_neutral() {
    let folder = Folder::with("squeeze = 1.0", "stretch = 1.0");
    folder.change("scene.toml", "region = \"all\"", "region = \"auto\"");
    folder.ruga("bake scene.toml -o out").exits(0);
    let normal = read_image(&folder.path("out/maps/squeezed_100_normal.png")).unwrap();
    let neutral = [32768.0 / 65535.0, 32768.0 / 65535.0, 1.0];
    for texel in normal.values.chunks_exact(3) {
        assert_eq!(texel, neutral);
    }
    let height = read_image(&folder.path("out/maps/squeezed_100_height.png")).unwrap();
    assert!(height.values.iter().all(|v| *v == neutral[0]));
}

#[test]
fn json_on_stdout_is_the_report() {
    let folder = Folder::with("keys = [0.5, 1.0]", "keys = [1.0]");
    let run = folder
        .ruga("bake scene.toml -o out --json --quality draft")
        .exits(0);
    assert_eq!(run.stdout.as_bytes(), folder.read("out/report.json"));
    assert_eq!(folder.json("out/report.json")["version"], 1);
}

#[test]
fn simulate_writes_a_mesh_per_load_step() {
    let folder = Folder::new();
    folder
        .ruga("simulate scene.toml -o out --format obj,vtu,usda")
        .exits(0);
    let report = folder.json("out/report.json");
    let frames = report["poses"][0]["frames"].as_u64().unwrap() as usize;
    let mut files = folder.files("out/frames/squeezed");
    assert!(frames >= 2);
    files.retain(|file| file.ends_with(".obj"));
    assert_eq!(files.len(), frames);
    assert_eq!(files[0], "skin.0000.obj");
    let last =
        String::from_utf8(folder.read(&format!("out/frames/squeezed/{}", files[frames - 1])))
            .unwrap();
    let points: Vec<Vec<f64>> = last
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
        .collect();
    // Every frame is handed out on the same uniform mesh, not on the fitted one.
    let first = String::from_utf8(folder.read("out/frames/squeezed/skin.0000.obj")).unwrap();
    let count = first.lines().filter(|line| line.starts_with("v ")).count();
    assert_eq!(points.len(), count);
    let right = points.iter().map(|p| p[0]).fold(0.0, f64::max);
    assert!(
        (right / (0.85 * 0.09) - 1.0).abs() < 0.01,
        "squeezed to {right} m"
    );
    assert!(!folder.path("out/maps").exists());

    let read = |name: &str| {
        String::from_utf8(folder.read(&format!("out/frames/squeezed/{name}"))).unwrap()
    };
    let list = read("skin.pvd");
    let entries: Vec<&str> = list
        .lines()
        .filter(|line| line.starts_with("<DataSet"))
        .collect();
    assert_eq!(entries.len(), frames);
    for (number, entry) in entries.iter().enumerate() {
        let file = format!("skin.{number:04}.vtu");
        assert!(entry.contains(&file), "{entry}");
        let grid = read(&file);
        assert!(grid.contains(&format!("<Piece NumberOfPoints=\"{count}\"")));
        for field in ["displacement", "height", "strain_ratio", "bending_energy"] {
            assert!(grid.contains(&format!(" Name=\"{field}\"")), "no {field}");
        }
    }
    // Loads are times.
    assert!(entries[frames - 1].contains("timestep=\"1\""), "{list}");
    let scene = read("skin.usda");
    assert!(scene.contains(&format!("    endTimeCode = {}\n", frames - 1)));
    let samples = |attribute: &str| {
        let (_, rest) = scene
            .split_once(&format!("    {attribute}.timeSamples = {{\n"))
            .unwrap();
        rest.split_once("    }").unwrap().0.lines().count()
    };
    assert_eq!(samples("point3f[] points"), frames);
    assert_eq!(samples("float[] primvars:strain_ratio"), frames);
    // One mesh serves all.
    assert_eq!(samples("int[] faceVertexIndices"), 1);

    let kept = |format: &str| {
        let run = folder
            .ruga(&format!(
                "simulate scene.toml -o out --resume --format {format}"
            ))
            .exits(0);
        run.stderr.contains("is there from an earlier run")
    };
    assert!(kept("vtu") && kept("obj"));
}

#[test]
fn a_shorter_run_leaves_no_frames_of_a_longer_one() {
    let folder = Folder::with("steps = 2", "steps = 6");
    folder.change("scene.toml", "squeeze = 1.0", "squeeze = 0.2");
    folder.ruga("simulate scene.toml -o out").exits(0);
    let longer = folder.files("out/frames/squeezed").len();
    folder.change("scene.toml", "steps = 6", "steps = 2");
    folder.ruga("simulate scene.toml -o out").exits(0);
    let shorter = folder.files("out/frames/squeezed").len();
    assert_eq!(
        folder.json("out/report.json")["poses"][0]["frames"],
        shorter
    );
    assert!(shorter < longer, "{shorter} and {longer} frames");
    let other = folder.ruga("simulate scene.toml -o out --resume --format vtu");
    other.exits(0).says(&["without all of the formats"]);
    let files = folder.files("out/frames/squeezed");
    assert!(
        files.iter().all(|file| !file.ends_with(".obj")) && files.len() == shorter + 1,
        "{files:?}"
    );
}

#[test]
fn plan_prints_a_table_or_json() {
    let folder = Folder::new();
    let table = folder.ruga("plan scene.toml").exits(0).stdout;
    for text in [
        "30.00 mm",
        "5.00 %",
        "squeezed",
        "81.0 cm2",
        "total: 1 of 1 poses",
    ] {
        assert!(table.contains(text), "no `{text}` in:\n{table}");
    }
    let json = folder.ruga("plan scene.toml --json").exits(0).stdout;
    let plan: Value = serde_json::from_str(&json).unwrap();
    let layer = &plan["poses"][0]["layers"][0];
    let strain = layer["strain_median"].as_f64().unwrap();
    assert!((strain / 0.15 - 1.0).abs() < 0.01, "{strain}");
    assert_eq!(layer["vertices"], plan["total"]["vertices"]);
    let draft = folder
        .ruga("plan scene.toml --json --quality draft")
        .exits(0);
    let draft: Value = serde_json::from_str(&draft.stdout).unwrap();
    let finer = &draft["poses"][0]["layers"][0];
    assert!(
        finer["vertices"].as_u64() > layer["vertices"].as_u64(),
        "{finer}"
    );
    assert_eq!(folder.files("").len(), 5, "a plan writes nothing");
}

#[test]
fn quality_overrules_the_scene() {
    let folder = Folder::with("steps = 2", "steps = 1");
    let vertices = |line: &str| {
        folder.ruga(line).exits(0);
        let report = folder.json("out/report.json");
        report["poses"][0]["layers"][0]["vertices"]
            .as_u64()
            .unwrap()
    };
    let own = vertices("simulate scene.toml -o out");
    let draft = vertices("simulate scene.toml -o out --quality draft");
    assert!(5 * draft > 6 * own, "{own} and {draft} vertices");
}

#[test]
fn check_counts_what_it_found() {
    let found = Folder::new().ruga("check scene.toml").exits(0).stdout;
    for text in [
        "1 pose, 4 maps",
        "128 triangles",
        "3 blend shapes",
        "everywhere",
        "\nOK\n",
    ] {
        assert!(found.contains(text), "no `{text}` in:\n{found}");
    }
}

#[test]
fn further_maps_are_written_with_what_is_needed_to_read_them() {
    let folder = Folder::with("keys = [0.5, 1.0]", "keys = [1.0]");
    let kinds = [
        "ambient_occlusion",
        "curvature",
        "compression",
        "object_normal",
        "vector_displacement",
    ];
    folder.change("scene.toml", "[bake]", &format!("[bake]\nmaps = {kinds:?}"));
    folder
        .ruga("bake scene.toml -o out --quality draft")
        .exits(0);
    let manifest = folder.json("out/wrinkles.json");
    let maps = manifest["maps"].as_array().unwrap();
    assert_eq!(maps.len(), kinds.len());
    for (map, kind) in maps.iter().zip(kinds) {
        assert_eq!(map["kind"], kind);
        let [mid, scale] = ["mid", "scale"].map(|key| map[key].as_f64().unwrap());
        let file = folder.path("out").join(map["file"].as_str().unwrap());
        let image = read_image(&file).unwrap();
        let numbers = image.values.iter().map(|v| (f64::from(*v) - mid) * scale);
        let [low, high] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], n| {
            [low.min(n), high.max(n)]
        });
        let channels = map["neutral"].as_array().unwrap().len();
        let expected = match kind {
            // Wrinkles of a millimetre, 30 mm apart, of skin pressed to three times its critical strain.
            "ambient_occlusion" => channels == 1 && (0.7..0.95).contains(&low) && high > 0.99,
            "curvature" => channels == 1 && low < -5.0 && high > 5.0,
            "compression" => channels == 1 && low >= 0.0 && high == 1.0,
            "object_normal" => channels == 0 && high > 0.99,
            _ => channels == 3 && low < -5e-4 && high > 5e-4,
        };
        assert!(expected, "{kind}: {low} to {high}, {map}");
    }
}
