//! Faces and a hand with crease lines beside the same without: what lines cost, how they fold, and how that looks.

use std::error::Error;
use std::path::Path;

use ruga_io::{MapFormat, MapKind, PngTexels, map_file, read_image, write_png};
use ruga_scene::SceneFile;
use ruga_validation::asset;

use crate::baking::{Pose, Quality, cpu_seconds};
use crate::rows::{Bench, Lines};
use crate::scenes::{Model, ScenePose, preset_layer};
use crate::table::{Goal, Line};

/// Time with lines over that without, at most.
const COST: (Goal, &str) = (Goal::AtMost(1.3), "times");

/// Keys of every pose, those of a scene that names none.
const KEYS: [f64; 2] = [0.5, 1.0];

/// A line: preset, points in texture coordinates, and blend shapes by which it is drawn.
type Drawn = (&'static str, &'static [[f64; 2]], &'static [&'static str]);

/// Nasolabial folds, frown lines and crow's feet of the shared face.
const ON_FACE: [Drawn; 8] = [
    (
        "nasolabial",
        &[[0.6, 0.443], [0.665, 0.497], [0.68, 0.57], [0.673, 0.63]],
        &["mouthSmile_L"],
    ),
    (
        "nasolabial",
        &[[0.4, 0.443], [0.335, 0.497], [0.32, 0.57], [0.327, 0.63]],
        &["mouthSmile_R"],
    ),
    (
        "frown-line",
        &[[0.518, 0.17], [0.514, 0.21], [0.518, 0.25]],
        &["browDown_L"],
    ),
    (
        "frown-line",
        &[[0.482, 0.17], [0.486, 0.21], [0.482, 0.25]],
        &["browDown_R"],
    ),
    (
        "crows-foot",
        &[[0.73, 0.255], [0.765, 0.24], [0.8, 0.22]],
        &["eyeSquint_L"],
    ),
    (
        "crows-foot",
        &[[0.73, 0.275], [0.77, 0.275], [0.81, 0.27]],
        &["eyeSquint_L"],
    ),
    (
        "crows-foot",
        &[[0.27, 0.255], [0.235, 0.24], [0.2, 0.22]],
        &["eyeSquint_R"],
    ),
    (
        "crows-foot",
        &[[0.27, 0.275], [0.23, 0.275], [0.19, 0.27]],
        &["eyeSquint_R"],
    ),
];

/// Lines of the palm and of fingers of the shared hand: along the middle of where closing it presses the skin most, and
/// one beside it.
const ON_HAND: [Drawn; 5] = [
    (
        "palm-line",
        &[
            [0.463, 0.186],
            [0.457, 0.221],
            [0.438, 0.253],
            [0.415, 0.283],
            [0.394, 0.295],
        ],
        &[],
    ),
    (
        "palm-line",
        &[[0.435, 0.165], [0.405, 0.21], [0.375, 0.26]],
        &[],
    ),
    (
        "finger-flexion",
        &[[0.432, 0.327], [0.436, 0.322], [0.44, 0.316]],
        &[],
    ),
    (
        "finger-flexion",
        &[[0.565, 0.238], [0.566, 0.232], [0.568, 0.225]],
        &[],
    ),
    (
        "finger-flexion",
        &[[0.518, 0.23], [0.521, 0.221], [0.524, 0.213]],
        &[],
    ),
];

/// A scene without lines and with them.
struct Pair {
    name: &'static str,
    scenes: [String; 2],
}

impl Bench {
    /// Bakes our face, the shared face and the shared hand without lines and with them.
    pub(crate) fn creases(&self) -> Lines {
        let mut pairs = vec![our_face()?];
        pairs.extend(shared()?);
        let mut lines = Vec::new();
        for Pair { name, scenes } in pairs {
            let mut baked = Vec::new();
            for (scene, with) in scenes.iter().zip(["without", "with"]) {
                let folder = format!("creases/{name}/{with}");
                let job = self.job(&folder, scene, (Quality::Standard, 1))?;
                baked.push((job.bake_each()?, job.folder));
            }
            let [(plain, plain_folder), (creased, folder)] = &baked[..] else {
                continue;
            };
            let ratio = cpu_seconds(creased) / cpu_seconds(plain);
            lines.push(Line::judged(format!("{name}, all poses"), COST, ratio).with(creased));
            lines.push(Line::note(format!("{name}, without lines")).with(plain));
            lines.extend(Line::failures(creased));
            for (plain, creased) in plain.iter().zip(creased) {
                lines.push(Line::note(told(plain, creased)));
                let pose = &creased.planned.name;
                let maps = [plain_folder, folder].map(|folder| folder.join(pose).join("out"));
                let picture = folder.with_file_name(format!("{pose}.png"));
                draw(&maps.each_ref().map(|maps| maps.as_path()), pose, &picture)?;
            }
        }
        Ok(lines)
    }
}

/// Our face, whose scene has lines.
fn our_face() -> Result<Pair, Box<dyn Error>> {
    let mut scene = SceneFile::read(&std::path::absolute(asset("face/creases.toml"))?)?;
    for pose in &mut scene.poses {
        pose.keys = KEYS.to_vec();
    }
    let with = scene.to_toml();
    scene.creases.clear();
    Ok(Pair {
        name: "our-face",
        scenes: [scene.to_toml(), with],
    })
}

/// The shared models, where they are there.
fn shared() -> Result<Vec<Pair>, Box<dyn Error>> {
    let mut pairs = Vec::new();
    let pose = |name: &str, shapes: &[&str]| ScenePose {
        name: name.to_owned(),
        weights: shapes
            .iter()
            .map(|shape| ((*shape).to_owned(), 1.0))
            .collect(),
    };
    let face = [
        pose("smile", &["mouthSmile_L", "mouthSmile_R"]),
        pose("frown", &["browDown_L", "browDown_R"]),
        pose("squint", &["eyeSquint_L", "eyeSquint_R"]),
    ];
    let models = [
        (
            "shared-face",
            Model::face(),
            "forehead-furrow",
            &face[..],
            &ON_FACE[..],
        ),
        (
            "shared-hand",
            Model::hand(),
            "knuckle",
            &[pose("fingersFlex", &["fingersFlex"])],
            &ON_HAND,
        ),
    ];
    for (name, model, preset, poses, drawn) in models {
        let Some(model) = model else { continue };
        let layers = [preset_layer(preset)];
        let plain = model.scene("", &layers, (poses, &KEYS))?;
        let with = format!("{plain}\n{}", creases(drawn));
        pairs.push(Pair {
            name,
            scenes: [plain, with],
        });
    }
    Ok(pairs)
}

/// Lines as they stand in a scene.
fn creases(drawn: &[Drawn]) -> String {
    let crease = |(number, (preset, uv, shapes)): (usize, &Drawn)| {
        let weights: Vec<String> = shapes
            .iter()
            .map(|shape| format!("{shape} = 1.0"))
            .collect();
        let drive = match shapes.is_empty() {
            true => String::new(),
            false => format!(
                "drive = \"weights\"\nweights = {{ {} }}\n",
                weights.join(", ")
            ),
        };
        // They are where poses press skin together the most.
        format!(
            "[[creases]]\nname = \"{preset}-{number}\"\npreset = \"{preset}\"\nuv = {uv:?}\n{drive}absorb = true\n\n"
        )
    };
    drawn.iter().enumerate().map(crease).collect()
}

/// How the lines of a pose have folded, what they cost, and what is left out of the skin's compression without and with
/// them.
fn told(plain: &Pose, creased: &Pose) -> String {
    let folds = creased.layers().iter().flat_map(|layer| &layer.creases);
    let folds = folds.map(|crease| format!("{} {:.0}", crease.name, crease.fold_deg.mean));
    let folds: Vec<String> = folds.collect();
    let [before, after] = [plain, creased].map(|pose| {
        let left_out = pose.layers().iter().filter_map(|layer| layer.left_out_m2);
        1e4 * left_out.fold(0.0, |sum, area| sum + area)
    });
    format!(
        "{}: {:.2} times as long; mean folds in degrees: {}; left out of the compression {after:.2} cm2 for {before:.2}",
        creased.planned.name,
        creased.cpu_seconds() / plain.cpu_seconds(),
        folds.join(", ")
    )
}

/// Draws the normal maps of a pose side by side, lit from the upper right.
fn draw(maps: &[&Path; 2], pose: &str, file: &Path) -> Result<(), Box<dyn Error>> {
    let light = [0.5, 0.5, 0.7].map(|c: f64| c / 0.99_f64.sqrt());
    let mut sides = Vec::new();
    let mut size = [0, 0];
    for folder in maps {
        let file = folder.join(map_file(pose, 1.0, MapKind::Normal, MapFormat::Png16));
        let map = read_image(&file)?;
        size = [map.width, map.height];
        let lit = map.values.chunks_exact(map.channels).map(|texel| {
            let terms = texel.iter().zip(light);
            let shade: f64 = terms.map(|(c, l)| (2.0 * f64::from(*c) - 1.0) * l).sum();
            (255.0 * shade.clamp(0.0, 1.0)).round() as u8
        });
        sides.push(lit.collect::<Vec<u8>>());
    }
    let rows = (0..size[1]).flat_map(|row| sides.iter().map(move |side| (row, side)));
    let texels = rows.flat_map(|(row, side)| side[row * size[0]..][..size[0]].to_vec());
    let texels: Vec<u8> = texels.collect();
    Ok(write_png(
        file,
        2 * size[0],
        size[1],
        PngTexels::Grey8(&texels),
    )?)
}
