//! Scenes: what a file means, and which layers, zones and units fit together.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use std::path::Path;

use fixture::scenes::{LEAST, parse, refused, with};
use fixture::{Folder, SCENE, assert_says};
use ruga_io::{LengthUnit, MapKind, NormalY};
use ruga_scene::file::{
    Coupling, Layer, LayerDefinition, Region, Sampling, SolverMode, Stack, SubstrateDefinition,
    WavelengthModel,
};
use ruga_scene::{SceneError, SceneFile};

#[test]
fn defaults_are_those_of_the_sample() {
    let full = with("mesh_name = \"Forearm\"\n", "").unwrap();
    let mut least = parse(LEAST).unwrap();
    assert_eq!(least.solver, full.solver);
    assert_eq!(least.remesh, full.remesh);
    assert_eq!(least.bake, full.bake);
    assert_eq!(least.stack, full.stack);
    assert_eq!(least.length_unit, LengthUnit::Metre);
    assert_eq!(least.driver.vertex_budget, 300_000);
    least.driver.mesh = full.driver.mesh.clone();
    assert_eq!(least.driver, full.driver);
    assert_eq!(
        least.substrate.unwrap().definition(),
        full.substrate.unwrap().definition()
    );
    let (layer, sample) = (&least.layers[0], &full.layers[0]);
    assert_eq!(layer.poisson, sample.poisson);
    assert_eq!(layer.density, sample.density);
    assert_eq!(layer.coupling, Coupling::Hybrid);
    assert_eq!(layer.sampling, Sampling::Quadrature);
    assert_eq!(layer.model, WavelengthModel::Layer);
    let interior = ruga_scene::file::Interior {
        cells: Some(6),
        ..Default::default()
    };
    assert_eq!(full.interior.unwrap(), interior);
    assert_eq!(full.bake.maps, [MapKind::Normal, MapKind::Height]);
    assert_eq!(full.bake.normal_y, NormalY::Up);
}

#[test]
fn text_and_back() {
    let changed = [
        ("region = \"auto\"", "region = \"mask.png\""),
        (
            "young = 4e6",
            "wavelength = 0.01\ncritical_strain = 0.1\nmodel = \"cerda-mahadevan\"",
        ),
        ("[interior]\ncells = 6\nshape = \"quadratic\"\n", ""),
        ("normal_y = \"+\"", "normal_y = \"-\""),
    ];
    for (old, new) in changed {
        let text = SCENE.replacen(old, new, 1);
        let text = if new.starts_with("wavelength") {
            text.replacen("thickness = 1.3e-3\n", "", 1)
        } else {
            text
        };
        let scene = parse(&text).unwrap();
        let again = parse(&scene.to_toml()).unwrap();
        assert_eq!(again, scene);
    }
}

#[test]
fn paths_are_relative_to_the_scene() {
    let folder = Folder::new();
    let text = SCENE.replacen("\"auto\"", "\"masks/face.png\"", 1);
    let path = folder.file("scene.toml", text);
    let scene = SceneFile::read(&path).unwrap();
    assert_eq!(scene.driver.mesh, folder.path("forearm.glb"));
    assert_eq!(
        scene.driver.region,
        Region::Mask(folder.path("masks/face.png"))
    );
    let map = scene.layers[0].map.as_ref().unwrap();
    assert_eq!(map.image, Some(folder.path("dermis.png")));
}

#[test]
fn ways_to_describe_a_layer() {
    let layer = |text: &str| {
        let scene = with("young = 4e6\npoisson = 0.48\nthickness = 1.3e-3", text)?;
        Ok::<_, SceneError>(scene.layers[0].clone())
    };
    let preset = layer("preset = \"knuckle\"").unwrap();
    assert_eq!(
        preset.definition(),
        Some(LayerDefinition::Preset("knuckle"))
    );
    let wanted = layer("wavelength = 5e-3\ncritical_strain = 0.05").unwrap();
    assert_eq!(
        wanted.definition(),
        Some(LayerDefinition::Wanted {
            wavelength: 5e-3,
            critical_strain: 0.05
        })
    );
    for (bad, words) in [
        ("young = 4e6", ["layers[0]", "young", "thickness"]),
        ("", ["layers[0]", "none of them", "preset"]),
        (
            "preset = \"a\"\nyoung = 1.0",
            ["layers[0]", "preset, young", "either"],
        ),
        (
            "wavelength = 5e-3",
            ["layers[0]", "wavelength", "critical_strain"],
        ),
        (
            "young = 1e6\nthickness = 1e-3\nwavelength = 5e-3",
            ["layers[0]", "young, thickness, wavelength", "either"],
        ),
    ] {
        assert_says(layer(bad), "scene.toml", &words);
    }
}

#[test]
fn a_preset_brings_its_substrate() {
    let without = SCENE.replacen(
        "[substrate]\nyoung = 0.5e6\npoisson = 0.48\nthickness = 15e-3\n",
        "",
        1,
    );
    assert_says(parse(&without), "scene.toml", &["`substrate`", "preset"]);
    let preset = without.replacen(
        "young = 4e6\npoisson = 0.48\nthickness = 1.3e-3",
        "preset = \"knuckle\"",
        1,
    );
    assert_eq!(parse(&preset).unwrap().substrate, None);
    let named = with(
        "young = 0.5e6\npoisson = 0.48\nthickness = 15e-3",
        "preset = \"palm\"",
    )
    .unwrap();
    assert_eq!(
        named.substrate.unwrap().definition(),
        SubstrateDefinition::Preset("palm")
    );
    refused(
        "young = 0.5e6\n",
        "young = 0.5e6\npreset = \"palm\"\n",
        &["substrate", "not both"],
    );
}

/// The pair of the two-layer face, and every meaning of a stack.
#[test]
fn a_stack_of_presets() {
    let two = "
version = 1
stack = \"composite\"
driver = { mesh = \"face.glb\" }
solver = { mode = \"dynamic\", time_step = 0.01, damping = 0.0 }
[[layers]]
name = \"dermis\"
preset = \"face2-dermis\"
[[layers]]
name = \"epidermis\"
preset = \"face2-epidermis\"
bending_transfer = 1.0
";
    let scene = parse(two).unwrap();
    let presets: Vec<_> = scene.layers.iter().map(Layer::definition).collect();
    let wanted =
        ["face2-dermis", "face2-epidermis"].map(|name| Some(LayerDefinition::Preset(name)));
    assert_eq!(presets, wanted);
    assert_eq!(scene.substrate, None);
    assert_eq!(scene.stack, Stack::Composite);
    assert_eq!(scene.solver.mode, SolverMode::Dynamic);
    assert_eq!((scene.solver.time_step, scene.solver.damping), (0.01, 0.0));
    assert_eq!(scene.layers[1].bending_transfer, Some(1.0));
    assert_eq!(scene.layers[0].bending_transfer, None);
    assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
    let joint = parse(&two.replacen("composite", "joint", 1)).unwrap();
    assert_eq!(joint.stack, Stack::Joint);
    let slip = parse(&two.replacen("composite", "nominel", 1));
    assert_says(slip, "scene.toml", &["stack", "did you mean `nominal`"]);
    let slip = parse(&two.replacen("dynamic", "dinamic", 1));
    assert_says(
        slip,
        "scene.toml",
        &["solver.mode", "did you mean `dynamic`"],
    );
    let twice = parse(&two.replacen("\"epidermis\"", "\"Dermis\"", 1));
    assert_says(
        twice,
        "scene.toml",
        &["layers[1].name", "`Dermis` twice", "letter case"],
    );
}

/// Two zones: two layers on the forehead, one beside the eyes.
const ZONES: &str = "
version = 1
driver = { mesh = \"face.glb\", scale = 0.01 }
[[layers]]
name = \"furrows\"
preset = \"forehead-furrow\"
zone = \"forehead\"
mask = \"forehead.png\"
variation = 0.2
variation_scale = 0.5
[[layers]]
name = \"feet\"
preset = \"crows-feet\"
zone = \"eyes\"
mask = \"eyes.png\"
strength = 0.6
[[layers]]
name = \"lines\"
preset = \"fine-lines\"
zone = \"forehead\"
";

#[test]
fn layers_have_masks_strengths_and_zones() {
    let scene = parse(ZONES).unwrap();
    assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
    let [furrows, feet, lines] = scene.layers.as_slice() else {
        panic!("{:?}", scene.layers);
    };
    assert_eq!(furrows.mask.as_deref(), Some(Path::new("forehead.png")));
    assert_eq!((furrows.strength, feet.strength), (1.0, 0.6));
    assert_eq!((furrows.variation, feet.variation), (Some(0.2), None));
    assert_eq!((furrows.variation_scale, lines.variation_scale), (0.5, 1.0));
    assert_eq!(scene.driver.scale, Some(0.01));
    let zones = scene.zones();
    let found: Vec<_> = zones.iter().map(|z| (z.name, &z.layers[..])).collect();
    assert_eq!(
        found,
        [(Some("forehead"), &[0, 2][..]), (Some("eyes"), &[1][..])]
    );
    let folder = Folder::new();
    let read = SceneFile::read(&folder.file("scene.toml", ZONES)).unwrap();
    assert_eq!(read.layers[1].mask, Some(folder.path("eyes.png")));
}

#[test]
fn a_scene_without_zones_is_one_zone_and_writes_none_of_the_new_keys() {
    let scene = parse(LEAST).unwrap();
    assert_eq!(scene.zones().len(), 1);
    assert_eq!(scene.zones()[0].layers, [0]);
    let text = scene.to_toml();
    for key in ["mask", "zone", "variation =", "\nscale"] {
        assert!(!text.contains(key), "{text}");
    }
}

#[test]
fn zones_that_contradict_themselves() {
    let refused = |old: &str, new: &str, words: &[&str]| {
        assert!(ZONES.contains(old), "{old}");
        assert_says(parse(&ZONES.replacen(old, new, 1)), "scene.toml", words);
    };
    for bad in ["0.0", "-1.0", "4.5", "nan", "inf"] {
        let words = ["layers[1].strength", "above 0, up to 4", "left out"];
        refused("strength = 0.6", &format!("strength = {bad}"), &words);
    }
    for bad in ["-0.1", "0.6", "nan"] {
        let words = ["layers[0].variation", "from 0 to 0.5"];
        refused("variation = 0.2", &format!("variation = {bad}"), &words);
    }
    for bad in ["0.0", "11.0", "nan"] {
        let new = format!("variation_scale = {bad}");
        let words = ["layers[0].variation_scale", "0.1 to 10"];
        refused("variation_scale = 0.5", &new, &words);
    }
    refused(
        "zone = \"eyes\"\n",
        "",
        &[
            "layers[1].zone",
            "for every layer or for none",
            "`forehead`",
        ],
    );
    refused(
        "zone = \"eyes\"",
        "zone = \"Forehead\"",
        &["layers[0].zone", "`Forehead` and `forehead`"],
    );
    refused("\"eyes\"", "\" \"", &["layers[1].zone", "a name"]);
    refused(
        "mask = \"eyes.png\"\n",
        "",
        &["layers[1].mask", "of zone `eyes`", "2 zones"],
    );
    refused(
        "preset = \"crows-feet\"",
        "young = 1e6\nthickness = 1e-3",
        &["substrate", "of zone `eyes`", "preset"],
    );
    let alone = ZONES.replace("zone = \"eyes\"", "zone = \"forehead\"");
    let alone = alone.replace("mask = \"forehead.png\"\n", "");
    assert!(parse(&alone).is_ok());
    let bad = parse(&format!("{ZONES}[interior]\ngravity = [0.0, -9.8, 0.0]\n"));
    assert_says(bad, "scene.toml", &["interior", "2 zones", "one zone"]);
}

#[test]
fn units_of_the_mesh_file() {
    let scaled = |mesh: &str, rest: &str| {
        let driver = format!("[driver]\n{rest}");
        let text = LEAST.replacen("[driver]\n", &driver, 1);
        parse(&text.replacen("a.glb", mesh, 1))
    };
    assert_eq!(
        scaled("a.obj", "scale = 0.0254\n").unwrap().driver.scale,
        Some(0.0254)
    );
    for bad in ["0.0", "-1.0", "nan", "inf"] {
        let words = ["driver.scale", "above 0"];
        assert_says(
            scaled("a.glb", &format!("scale = {bad}\n")),
            "scene.toml",
            &words,
        );
    }
    let with_unit = |mesh: &str, scale: &str| {
        let text = scaled(mesh, scale).unwrap().to_toml();
        parse(&text.replacen("length_unit = \"m\"", "length_unit = \"cm\"", 1))
    };
    assert_says(
        with_unit("a.obj", "scale = 0.01\n"),
        "scene.toml",
        &[
            "driver.scale",
            "0.01",
            "length_unit = \"cm\"",
            "one of the two",
        ],
    );
    // Left without effect until now.
    assert_says(
        with_unit("a.glb", ""),
        "scene.toml",
        &["length_unit", "OBJ", "scale = 0.01"],
    );
    assert!(with_unit("a.obj", "").is_ok());
}

#[test]
fn poses_from_shapes() {
    let path = Path::new("scene.toml");
    let shapes = ["jaw:open", "jaw/open", "smile"].map(str::to_owned);
    let poses = parse(LEAST)
        .unwrap()
        .poses_or_shapes(&shapes, path)
        .unwrap();
    let names: Vec<_> = poses.iter().map(|pose| pose.name.as_str()).collect();
    assert_eq!(names, ["jaw_open", "jaw_open_2", "smile"]);
    assert_eq!(poses[0].weights["jaw:open"], 1.0);
    assert_eq!(poses[0].keys, [0.5, 1.0]);
    let follow = "shape = \"quadratic\"\nfollow = 1e6";
    let scene = with("shape = \"quadratic\"", follow).unwrap();
    let unknown = scene.poses_or_shapes(&["compres".to_owned()], path);
    assert_says(
        unknown,
        "scene.toml",
        &[
            "poses[0].weights.compress",
            "pose `compress`",
            "it has `compres`",
            "did you mean `compres`",
        ],
    );
    let many: Vec<String> = (0..14).map(|i| format!("s{i}")).collect();
    assert_says(
        scene.poses_or_shapes(&many, path),
        "scene.toml",
        &["it has `s0`, `s1`, ", "`s11` and 2 more"],
    );
    assert_eq!(
        scene
            .poses_or_shapes(&["compress".to_owned()], path)
            .unwrap(),
        scene.poses
    );
    assert_says(
        parse(LEAST).unwrap().poses_or_shapes(&[], path),
        "scene.toml",
        &["no blend shapes"],
    );
}

#[test]
fn materials_and_words_of_the_domain_go_through_json() {
    let skin = ruga_material::PRESETS[2].layer;
    let text = serde_json::to_string(&skin).unwrap();
    let back: ruga_material::LayerMaterial = serde_json::from_str(&text).unwrap();
    assert_eq!(back, skin);
    for model in WavelengthModel::ALL {
        assert_eq!(serde_json::to_value(model).unwrap(), model.name());
    }
    // Methods for comparison are no words of a scene.
    assert!(serde_json::from_str::<Coupling>("\"spectral\"").is_err());
    assert!(serde_json::from_str::<Sampling>("\"adjustedasprinted\"").is_err());
}
