//! Names of poses as engines know them.

use crate::file::PoseNames;

/// Blend shapes of Apple's ARKit.
const ARKIT: [&str; 52] = [
    "browDownLeft",
    "browDownRight",
    "browInnerUp",
    "browOuterUpLeft",
    "browOuterUpRight",
    "cheekPuff",
    "cheekSquintLeft",
    "cheekSquintRight",
    "eyeBlinkLeft",
    "eyeBlinkRight",
    "eyeLookDownLeft",
    "eyeLookDownRight",
    "eyeLookInLeft",
    "eyeLookInRight",
    "eyeLookOutLeft",
    "eyeLookOutRight",
    "eyeLookUpLeft",
    "eyeLookUpRight",
    "eyeSquintLeft",
    "eyeSquintRight",
    "eyeWideLeft",
    "eyeWideRight",
    "jawForward",
    "jawLeft",
    "jawOpen",
    "jawRight",
    "mouthClose",
    "mouthDimpleLeft",
    "mouthDimpleRight",
    "mouthFrownLeft",
    "mouthFrownRight",
    "mouthFunnel",
    "mouthLeft",
    "mouthLowerDownLeft",
    "mouthLowerDownRight",
    "mouthPressLeft",
    "mouthPressRight",
    "mouthPucker",
    "mouthRight",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
    "mouthSmileLeft",
    "mouthSmileRight",
    "mouthStretchLeft",
    "mouthStretchRight",
    "mouthUpperUpLeft",
    "mouthUpperUpRight",
    "noseSneerLeft",
    "noseSneerRight",
    "tongueOut",
];

/// Regions of MetaHuman's wrinkle maps without their side, each with the ARKit shape that it is for, if
/// there is one.
const METAHUMAN: [(&str, &str); 16] = [
    ("blink", "eyeBlink"),
    ("browsRaiseInner", "browInnerUp"),
    ("browsRaiseOuter", "browOuterUp"),
    ("browsLateral", ""),
    ("browsDown", "browDown"),
    ("chinRaise", "mouthShrugLower"),
    ("jawOpen", "jawOpen"),
    ("purse", "mouthPucker"),
    ("squintInner", "eyeSquint"),
    ("mouthStretch", "mouthStretch"),
    ("neckStretch", ""),
    ("noseWrinkler", "noseSneer"),
    ("cheekRaiseInner", "cheekSquint"),
    ("cheekRaiseOuter", ""),
    ("cheekRaiseUpper", ""),
    ("smile", "mouthSmile"),
];

/// Expressions of VRM 1.0, each with its name in VRM 0, if it has another.
const VRM: [(&str, &str); 18] = [
    ("happy", "joy"),
    ("angry", ""),
    ("sad", "sorrow"),
    ("relaxed", "fun"),
    ("surprised", ""),
    ("aa", "a"),
    ("ih", "i"),
    ("ou", "u"),
    ("ee", "e"),
    ("oh", "o"),
    ("blink", ""),
    ("blinkLeft", "blinkL"),
    ("blinkRight", "blinkR"),
    ("lookUp", ""),
    ("lookDown", ""),
    ("lookLeft", ""),
    ("lookRight", ""),
    ("neutral", ""),
];

/// Name of a pose in an engine's convention: letter case, `_` and the way in which sides are written do
/// not count. A pose that the convention does not have keeps its own name.
///
/// Of a shape that the convention does not divide, both sides have its one name. MetaHuman's names have
/// the number of the `map` in them, from 0.
pub fn engine_name(pose: &str, names: Option<PoseNames>, map: usize) -> String {
    let known = match names {
        None => None,
        Some(PoseNames::Arkit) => arkit(pose).map(str::to_owned),
        Some(PoseNames::Metahuman) => metahuman(pose).map(|n| format!("head_wm{}_{n}", map + 1)),
        Some(PoseNames::Vrm) => vrm(pose).map(str::to_owned),
    };
    known.unwrap_or_else(|| pose.to_owned())
}

/// Two poses with one name in an engine's convention, and that name.
pub(crate) fn collision(poses: &[String], names: PoseNames) -> Option<[String; 3]> {
    let engine: Vec<String> = poses
        .iter()
        .map(|pose| engine_name(pose, Some(names), 0))
        .collect();
    (0..poses.len()).find_map(|i| {
        let same = (0..i).find(|&other| engine[other] == engine[i])?;
        Some([poses[same].clone(), poses[i].clone(), engine[i].clone()])
    })
}

/// Letters and digits in lower case, and the side: `L`, `R` or nothing.
fn parts(name: &str) -> (String, &'static str) {
    let stem = |suffixes: [&str; 3]| {
        let mut found = suffixes.iter();
        found.find_map(|suffix| name.strip_suffix(suffix))
    };
    let (stem, side) = match (
        stem(["Left", "_L", "_l"]).or_else(|| name.strip_suffix("_left")),
        stem(["Right", "_R", "_r"]).or_else(|| name.strip_suffix("_right")),
    ) {
        (Some(stem), _) => (stem, "L"),
        (_, Some(stem)) => (stem, "R"),
        _ => (name, ""),
    };
    let plain = stem.chars().filter(char::is_ascii_alphanumeric);
    (plain.collect::<String>().to_lowercase(), side)
}

fn arkit(pose: &str) -> Option<&'static str> {
    let own = parts(pose);
    let find = |wanted: &(String, &str)| ARKIT.into_iter().find(|name| parts(name) == *wanted);
    find(&own).or_else(|| find(&(own.0.clone(), "")))
}

fn metahuman(pose: &str) -> Option<String> {
    let (stem, side) = parts(pose);
    let is_it = |name: &str| !name.is_empty() && name.to_lowercase() == stem;
    let mut regions = METAHUMAN.iter();
    let (region, _) = regions.find(|(region, shape)| is_it(region) || is_it(shape))?;
    Some(match side {
        "" => (*region).to_owned(),
        side => format!("{region}_{side}"),
    })
}

fn vrm(pose: &str) -> Option<&'static str> {
    let own = parts(pose);
    let eye = own.0 == "eyeblink";
    let is_it = |name: &str| {
        let (stem, side) = parts(name);
        !name.is_empty() && side == own.1 && (stem == own.0 || (eye && stem == "blink"))
    };
    let old = |name: &str| {
        !name.is_empty() && name.to_lowercase() == format!("{}{}", own.0, own.1).to_lowercase()
    };
    let mut expressions = VRM.iter();
    let found = expressions.find(|(name, earlier)| is_it(name) || old(earlier));
    found.map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_engine() {
        let cases = [
            (PoseNames::Arkit, "browDown_L", "browDownLeft"),
            (PoseNames::Arkit, "browDownRight", "browDownRight"),
            (PoseNames::Arkit, "browInnerUp_L", "browInnerUp"),
            (PoseNames::Arkit, "jaw_open", "jawOpen"),
            (PoseNames::Arkit, "frown", "frown"),
            (
                PoseNames::Metahuman,
                "browOuterUp_R",
                "head_wm2_browsRaiseOuter_R",
            ),
            (PoseNames::Metahuman, "mouthSmileLeft", "head_wm2_smile_L"),
            (PoseNames::Metahuman, "jawOpen", "head_wm2_jawOpen"),
            (PoseNames::Vrm, "Joy", "happy"),
            (PoseNames::Vrm, "eyeBlink_L", "blinkLeft"),
            (PoseNames::Vrm, "blink_r", "blinkRight"),
            (PoseNames::Vrm, "A", "aa"),
        ];
        for (names, pose, wanted) in cases {
            assert_eq!(engine_name(pose, Some(names), 1), wanted);
        }
        assert_eq!(engine_name("browDown_L", None, 1), "browDown_L");
    }

    #[test]
    fn sides_that_a_convention_does_not_know_collide() {
        let poses = ["smile", "browInnerUp_L", "browInnerUp_R"].map(str::to_owned);
        let found = collision(&poses, PoseNames::Arkit).expect("ARKit has one");
        assert_eq!(found, ["browInnerUp_L", "browInnerUp_R", "browInnerUp"]);
        assert_eq!(collision(&poses, PoseNames::Metahuman), None);
    }
}
