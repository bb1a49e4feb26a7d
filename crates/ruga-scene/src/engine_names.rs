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

/// A region of MetaHuman's wrinkle maps.
struct Region {
    /// The map that it is in.
    map: u8,
    /// Its name without its side.
    name: &'static str,
    /// The ARKit shape that it is for, without its side, if there is one.
    shape: &'static str,
    /// Whether it is one of two sides.
    is_side: bool,
}

const fn region(map: u8, name: &'static str, shape: &'static str) -> Region {
    Region {
        map,
        name,
        shape,
        is_side: true,
    }
}

/// Regions of MetaHuman's three wrinkle maps; those of lips and of quarters of the mouth are for no shape.
const METAHUMAN: [Region; 15] = [
    region(1, "blink", "eyeBlink"),
    region(1, "browsRaiseInner", "browInnerUp"),
    region(1, "browsRaiseOuter", "browOuterUp"),
    region(1, "chinRaise", "mouthShrugLower"),
    region(1, "squintInner", "eyeSquint"),
    Region {
        is_side: false,
        ..region(1, "jawOpen", "jawOpen")
    },
    region(2, "browsDown", "browDown"),
    region(2, "browsLateral", ""),
    region(2, "mouthStretch", "mouthStretch"),
    region(2, "neckStretch", ""),
    region(2, "noseWrinkler", "noseSneer"),
    region(3, "cheekRaiseInner", "cheekSquint"),
    region(3, "cheekRaiseOuter", ""),
    region(3, "cheekRaiseUpper", ""),
    region(3, "smile", "mouthSmile"),
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
/// Of a shape that the convention does not divide, both sides have its one name. The number in a name of
/// MetaHuman's is that of the map which has the region there.
pub fn engine_name(pose: &str, names: Option<PoseNames>) -> String {
    let known = match names {
        None => None,
        Some(PoseNames::Arkit) => arkit(pose).map(str::to_owned),
        Some(PoseNames::Metahuman) => metahuman(pose),
        Some(PoseNames::Vrm) => vrm(pose).map(str::to_owned),
    };
    known.unwrap_or_else(|| pose.to_owned())
}

/// Two poses with one name in an engine's convention, and that name.
pub(crate) fn collision(poses: &[String], names: PoseNames) -> Option<[String; 3]> {
    let engine: Vec<String> = poses
        .iter()
        .map(|pose| engine_name(pose, Some(names)))
        .collect();
    (0..poses.len()).find_map(|i| {
        let same = (0..i).find(|&other| engine[other] == engine[i])?;
        Some([poses[same].clone(), poses[i].clone(), engine[i].clone()])
    })
}

/// Letters and digits in lower case, and the side: `L`, `R` or nothing.
fn parts(name: &str) -> (String, &'static str) {
    // A capital at the end is a side, too: `browDownL`.
    let mut last = name.chars().rev();
    let ends_low_high = matches!(
        (last.next(), last.next()),
        (Some('L' | 'R'), Some('a'..='z'))
    );
    let lower = name.to_lowercase();
    let stem = |side: &str| {
        let letter = &side[..1];
        let marked = ["_", ".", "-", " "].map(|mark| format!("{mark}{letter}"));
        let mut found = marked.iter().map(String::as_str).chain([side]);
        let found = found.find_map(|suffix| lower.strip_suffix(suffix));
        found.or_else(|| lower.strip_suffix(letter).filter(|_| ends_low_high))
    };
    let (stem, side) = match (stem("left"), stem("right")) {
        (Some(stem), _) => (stem, "L"),
        (_, Some(stem)) => (stem, "R"),
        _ => (lower.as_str(), ""),
    };
    let plain = stem.chars().filter(char::is_ascii_alphanumeric);
    (plain.collect(), side)
}

fn arkit(pose: &str) -> Option<&'static str> {
    let own = parts(pose);
    let find = |wanted: &(String, &str)| ARKIT.into_iter().find(|name| parts(name) == *wanted);
    find(&own).or_else(|| find(&(own.0.clone(), "")))
}

fn metahuman(pose: &str) -> Option<String> {
    let lower = pose.to_lowercase();
    let own = ["head_wm1_", "head_wm2_", "head_wm3_"];
    let own = own.iter().find(|start| lower.starts_with(*start));
    let (stem, side) = parts(&pose[own.map_or(0, |start| start.len())..]);
    let is_it = |name: &str| !name.is_empty() && name.to_lowercase() == stem;
    let found = METAHUMAN.iter();
    let mut found = found.filter(|region| region.is_side != side.is_empty());
    let Region { map, name, .. } = found.find(|r| is_it(r.name) || is_it(r.shape))?;
    let side = if side.is_empty() {
        ""
    } else {
        &format!("_{side}")
    };
    Some(format!("head_wm{map}_{name}{side}"))
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
            (PoseNames::Arkit, "browdownleft", "browDownLeft"),
            (PoseNames::Arkit, "BROW_DOWN_LEFT", "browDownLeft"),
            (PoseNames::Arkit, "browDownL", "browDownLeft"),
            (PoseNames::Arkit, "browDown.L", "browDownLeft"),
            (PoseNames::Arkit, "mouthRollLower", "mouthRollLower"),
            (
                PoseNames::Metahuman,
                "browOuterUp_R",
                "head_wm1_browsRaiseOuter_R",
            ),
            (PoseNames::Metahuman, "browDownLeft", "head_wm2_browsDown_L"),
            (PoseNames::Metahuman, "mouthSmileLeft", "head_wm3_smile_L"),
            (PoseNames::Metahuman, "mouthSmile", "mouthSmile"),
            (PoseNames::Metahuman, "mouthPucker", "mouthPucker"),
            (PoseNames::Metahuman, "jawOpen", "head_wm1_jawOpen"),
            (PoseNames::Metahuman, "head_wm1_blink_L", "head_wm1_blink_L"),
            (PoseNames::Vrm, "Joy", "happy"),
            (PoseNames::Vrm, "eyeBlink_L", "blinkLeft"),
            (PoseNames::Vrm, "blink_r", "blinkRight"),
            (PoseNames::Vrm, "A", "aa"),
        ];
        for (names, pose, wanted) in cases {
            assert_eq!(engine_name(pose, Some(names)), wanted);
        }
        assert_eq!(engine_name("browDown_L", None), "browDown_L");
    }

    #[test]
    fn sides_that_a_convention_does_not_know_collide() {
        let poses = ["smile", "browInnerUp_L", "browInnerUp_R"].map(str::to_owned);
        let found = collision(&poses, PoseNames::Arkit).expect("ARKit has one");
        assert_eq!(found, ["browInnerUp_L", "browInnerUp_R", "browInnerUp"]);
        assert_eq!(collision(&poses, PoseNames::Metahuman), None);
    }
}
