//! Whether what a caller gives can be planned and simulated at all.
//!
//! Everything is looked at before any work begins, so that nonsense is refused at once and no NaN
//! reaches a solver, which would take it for a state at rest.

use std::ops::RangeInclusive;

use ruga_blend::Driver;
use ruga_material::LaminatedSheet;
use ruga_shell::BendingModel;

use crate::error::{Checked, refuse};
use crate::growth::PoseGrowth;
use crate::skin::mirror::SymmetryPlane;
use crate::{
    CreaseAnchor, CreaseSpec, EdgeLimits, GROWTH_RANGE, Grows, GrowthSpec, LayerSpec, Modelling,
    PoseSpec, StepperError,
};

/// Load steps of a pose: every one is kept in a list and solved, and ten are usual.
const STEPS: RangeInclusive<u32> = 1..=100_000;

/// Largest weight of a blend shape: the squares of squares of lengths stay far within `f64`.
const LARGEST_WEIGHT: f64 = 1e6;

/// Edges per wavelength of skin. Two are the Nyquist limit of a wave; with two hundred a single
/// wave has more vertices than a face needs.
const POINTS: RangeInclusive<f64> = 2.0..=200.0;

/// Edges per wavelength of a layer on a body, which may bend without its wrinkles being resolved: the
/// coarsest cushions of Rémillard and Kry 2013 have a third of an edge to a wave.
const BODY_POINTS: RangeInclusive<f64> = 0.1..=200.0;

/// Keys closer than this are one load step.
const LEAST_KEY_DISTANCE: f64 = 1e-9;

fn is_positive(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// Checks what a layer's material does not check itself.
pub(crate) fn check_layer(layer: &LayerSpec) -> Checked {
    let strength = layer.presence.strength;
    // Asked like this, what is no number is refused too.
    if !(strength > 0.0 && strength.is_finite()) {
        let of = format!("layer '{}'", layer.name);
        return refuse(of, "presence.strength", strength, "a number above 0");
    }
    let transfer = layer.bending_transfer;
    match transfer.filter(|fraction| !(0.0..=1.0).contains(fraction)) {
        None => Ok(()),
        Some(fraction) => {
            let of = format!("layer '{}'", layer.name);
            refuse(of, "bending_transfer", fraction, "a fraction in [0, 1]")
        }
    }
}

/// Refuses anchors of creases of a free sheet, below which there is nothing.
fn check_unanchored(layer: &LayerSpec) -> Checked {
    match layer.creases.iter().find(|crease| crease.anchor.is_some()) {
        None => Ok(()),
        Some(crease) => refuse(
            of_crease(layer, crease),
            "anchor",
            "one",
            "none on a free sheet",
        ),
    }
}

/// Refuses anchors with numbers that no spring has.
pub(crate) fn check_anchors(layer: &LayerSpec) -> Checked {
    for crease in &layer.creases {
        let Some(anchor) = crease.anchor else {
            continue;
        };
        let values = [
            (
                "anchor.depth",
                anchor.depth,
                f64::MAX,
                "a finite depth from 0, in metres",
            ),
            (
                "anchor.stiffness",
                anchor.stiffness,
                CreaseAnchor::MOST_STIFFNESS,
                "a number from 0 to 100",
            ),
        ];
        // Asked like this, what is no number is refused too.
        let wrong = values
            .iter()
            .find(|(_, value, most, _)| !(0.0..=*most).contains(value));
        if let Some((field, value, _, accepted)) = wrong {
            return refuse(of_crease(layer, crease), field, value, accepted);
        }
    }
    Ok(())
}

/// Refuses slits of a depth that is none.
pub(crate) fn check_slits(layer: &LayerSpec) -> Checked {
    let wrong = |depth: &f64| !is_positive(*depth);
    let wrong = |crease: &&CreaseSpec| crease.slit.as_ref().is_some_and(wrong);
    match layer.creases.iter().find(wrong) {
        None => Ok(()),
        Some(crease) => {
            let accepted = "a depth above 0, in metres";
            let found = crease.slit.unwrap_or_default();
            refuse(of_crease(layer, crease), "slit", found, accepted)
        }
    }
}

/// Refuses slits of a layer that lies on no soft body.
pub(crate) fn check_unslit(layer: &LayerSpec) -> Checked {
    match layer.creases.iter().find(|crease| crease.slit.is_some()) {
        None => Ok(()),
        Some(crease) => {
            let accepted = "none but on a soft body, whose flesh it cuts";
            refuse(of_crease(layer, crease), "slit", "one", accepted)
        }
    }
}

/// Refuses creases that are to take up compression where no driver says beforehand how much there is.
pub(crate) fn check_unabsorbing(layer: &LayerSpec) -> Checked {
    match layer.creases.iter().find(|crease| crease.absorbs) {
        None => Ok(()),
        Some(crease) => {
            let accepted =
                "false but on a driver, whose blend shapes say how far skin is compressed";
            refuse(of_crease(layer, crease), "absorbs", "true", accepted)
        }
    }
}

/// Refuses anchors that are as deep as the `flesh` below each crease (m), or deeper.
pub(crate) fn check_anchor_depths(layer: &LayerSpec, flesh: &[f64]) -> Checked {
    for (crease, flesh) in layer.creases.iter().zip(flesh) {
        if let Some(anchor) = crease.anchor.filter(|anchor| anchor.depth >= *flesh) {
            let accepted = less_than_flesh(*flesh);
            let found = format!("{} m", anchor.depth);
            return refuse(of_crease(layer, crease), "anchor.depth", found, accepted);
        }
    }
    Ok(())
}

/// What is accepted of something that goes down from a line with so much `flesh` (m) below it.
pub(crate) fn less_than_flesh(flesh: f64) -> String {
    // Rounded down, so that what is told is accepted.
    let mm = (1e5 * flesh).floor() * 1e-2;
    format!("less than {mm:.2} mm, the depth of the body below the line")
}

pub(crate) fn of_crease(layer: &LayerSpec, crease: &CreaseSpec) -> String {
    format!("layer '{}', crease '{}'", layer.name, crease.name)
}

/// Refuses growths of what lies below a layer on a body, which has a size of its own.
pub(crate) fn check_grows(layer: &LayerSpec) -> Checked {
    let below = |growth: &&GrowthSpec| growth.grows == Grows::Below;
    match layer.growths.iter().find(below) {
        None => Ok(()),
        Some(growth) => {
            let accepted = "the layer on a soft body";
            refuse(
                of_growth(layer, growth),
                "grows",
                "what lies below",
                accepted,
            )
        }
    }
}

/// Refuses curl and plies of a layer that is carried.
pub(crate) fn check_carried(layer: &LayerSpec) -> Checked {
    if let Some(laminate) = &layer.laminate {
        let of = format!("layer '{}'", layer.name);
        let found = format!("{} plies", laminate.ply_count());
        return refuse(of, "laminate", found, "none but in a free sheet");
    }
    check_plies(layer)?;
    let curled = |growth: &&GrowthSpec| growth.curl != [0.0; 2];
    match layer.growths.iter().find(curled) {
        None => Ok(()),
        Some(growth) => {
            let accepted = "none but in a free sheet: what carries a layer holds it";
            let found = format!("{:?}", growth.curl);
            refuse(of_growth(layer, growth), "curl", found, accepted)
        }
    }
}

/// Refuses what a free sheet cannot have.
pub(crate) fn check_sheet_layer(layer: &LayerSpec) -> Checked {
    check_unanchored(layer)?;
    check_unslit(layer)?;
    check_unabsorbing(layer)?;
    check_grows(layer)?;
    check_plies(layer)?;
    let strange = |growth: &&GrowthSpec| growth.curl.iter().any(|curl| !curl.is_finite());
    match layer.growths.iter().find(strange) {
        None => Ok(()),
        Some(growth) => {
            let found = format!("{:?}", growth.curl);
            let accepted = "finite numbers, in 1/m";
            refuse(of_growth(layer, growth), "curl", found, accepted)
        }
    }
}

/// Refuses a material that is not that of the plies, and growths of plies that are not there.
fn check_plies(layer: &LayerSpec) -> Checked {
    let laminate = layer.laminate.as_ref();
    if let Some(laminate) = laminate.filter(|laminate| *laminate.material() != layer.material) {
        let of = format!("layer '{}'", layer.name);
        let accepted = format!("that of its laminate, {:?}", laminate.material());
        return refuse(of, "material", format!("{:?}", layer.material), accepted);
    }
    let plies = laminate.map_or(0, LaminatedSheet::ply_count);
    let missing = |growth: &&GrowthSpec| matches!(growth.grows, Grows::Ply(ply) if ply >= plies);
    match layer.growths.iter().find(missing) {
        None => Ok(()),
        Some(growth) => {
            let accepted = match plies {
                0 => "the layer, which is no laminate".to_owned(),
                _ => format!("a number below {plies}, the plies of the layer"),
            };
            let found = format!("{:?}", growth.grows);
            refuse(of_growth(layer, growth), "grows", found, accepted)
        }
    }
}

/// Refuses growths of a pose with a bending energy that has no natural curvature.
pub(crate) fn check_bends(layer: &LayerSpec, pose: &PoseSpec, bending: BendingModel) -> Checked {
    if bending != BendingModel::Hinge || PoseGrowth::new(layer, pose).is_none() {
        return Ok(());
    }
    let of = format!("pose '{}', layer '{}'", pose.name, layer.name);
    let accepted =
        "no growth of a sheet with hinges, which cannot curl: take `BendingModel::VertexCurvature`";
    refuse(of, "growths", "some", accepted)
}

fn of_growth(layer: &LayerSpec, growth: &GrowthSpec) -> String {
    format!("layer '{}', growth '{}'", layer.name, growth.name)
}

/// Refuses blend shapes of a pose of a sheet, which nothing draws to them.
pub(crate) fn check_sheet_pose(pose: &PoseSpec) -> Checked {
    if pose.weights.iter().all(|(_, weight)| weight == 0.0) {
        return Ok(());
    }
    let of = format!("pose '{}'", pose.name);
    let accepted = "none on a free sheet: handles, obstacles, gravity and growth move it";
    refuse(of, "weights", "a blend shape", accepted)
}

/// Checks the side of the maps in texels.
pub(crate) fn check_map_size(map_size: u32) -> Checked {
    match map_size {
        0 => refuse("maps", "map_size", map_size, "a number of texels from 1"),
        _ => Ok(()),
    }
}

/// Checks a pose of `driver`.
pub(crate) fn check_pose(driver: &Driver, pose: &PoseSpec) -> Checked {
    let of = format!("pose '{}'", pose.name);
    let shapes = driver.shape_names().len();
    for (i, (shape, weight)) in pose.weights.iter().enumerate() {
        if shape >= shapes {
            let accepted = format!("a number below {shapes}, the driver's blend shapes");
            return refuse(
                of,
                format!("weights[{i}]"),
                format!("of shape {shape}"),
                accepted,
            );
        }
        // A comparison with what is no number is false, so that it has to be asked for.
        if weight.is_nan() || weight.abs() > LARGEST_WEIGHT {
            let accepted = format!("a number in [-{LARGEST_WEIGHT}, {LARGEST_WEIGHT}]");
            return refuse(of, format!("weights[{i}]"), weight, accepted);
        }
    }
    if !STEPS.contains(&pose.steps) {
        let accepted = format!("{} to {}", STEPS.start(), STEPS.end());
        return refuse(of, "steps", pose.steps, accepted);
    }
    check_keys(&of, &pose.keys)
}

/// Refuses one half of a pose that has to be simulated whole: where `is_plain` does not hold, or the pose moves
/// what lies between the halves.
pub(crate) fn check_half(driver: &Driver, poses: &[PoseSpec], is_plain: bool) -> Checked {
    let halves: Vec<&PoseSpec> = poses.iter().filter(|pose| pose.half).collect();
    if halves.is_empty() {
        return Ok(());
    }
    let plane = SymmetryPlane::new(driver);
    let is_kept = |pose: &&&PoseSpec| is_plain && plane.keeps(driver, &pose.weights);
    let Some(pose) = halves.iter().find(|pose| !is_kept(pose)) else {
        return Ok(());
    };
    let accepted = match is_plain {
        true => "false, because not all that lies on the plane x = 0 at rest does so in the pose",
        false => {
            "false; `true` takes layers on a driver, solved one on the other, without creases and growths"
        }
    };
    refuse(format!("pose '{}'", pose.name), "half", "true", accepted)
}

/// Refuses growths of a layer that together leave no length, or more than film theory is good for, in a pose.
pub(crate) fn check_growth(layer: &LayerSpec, pose: &PoseSpec) -> Checked {
    let of = format!("pose '{}', layer '{}'", pose.name, layer.name);
    let [least, most] = GROWTH_RANGE;
    let [low, high] = PoseGrowth::new(layer, pose).changes();
    // Asked like this, what is no number is refused too.
    if low >= least && high <= most {
        return Ok(());
    }
    let accepted = format!(
        "changes of length from {least} to {most}, of a layer against what lies below, of a ply of a sheet by itself"
    );
    refuse(of, "growths", format!("{low:.3} to {high:.3}"), accepted)
}

/// Refuses motions of a pose that has no body to move.
pub(crate) fn check_motionless(pose: &PoseSpec) -> Checked {
    match pose.motions.first() {
        None => Ok(()),
        Some(motion) => Err(StepperError::UnknownMover {
            pose: pose.name.clone(),
            name: motion.of.clone(),
        }),
    }
}

fn check_keys(of: &str, keys: &[f64]) -> Checked {
    if keys.is_empty() {
        return refuse(of, "keys", "an empty list", "at least one load in (0, 1]");
    }
    for (i, key) in keys.iter().enumerate() {
        if !(*key > 0.0 && *key <= 1.0) {
            return refuse(of, format!("keys[{i}]"), key, "a load in (0, 1]");
        }
    }
    let last = |(i, pair): (usize, &[f64])| (pair[1] - pair[0] < LEAST_KEY_DISTANCE).then_some(i);
    match keys.windows(2).enumerate().find_map(last) {
        None => Ok(()),
        Some(i) => {
            let accepted = format!("a load above keys[{i}] = {}", keys[i]);
            refuse(of, format!("keys[{}]", i + 1), keys[i + 1], accepted)
        }
    }
}

/// Checks the modelling of skin on a driver.
pub(crate) fn check_modelling(modelling: &Modelling) -> Checked {
    check_choices(modelling, &POINTS)
}

/// Checks the modelling of a layer on a body.
pub(crate) fn check_body_modelling(modelling: &Modelling) -> Checked {
    check_choices(modelling, &BODY_POINTS)
}

fn check_choices(modelling: &Modelling, points: &RangeInclusive<f64>) -> Checked {
    let of = "modelling";
    if !points.contains(&modelling.points_per_wavelength) {
        let accepted = format!("{} to {}", points.start(), points.end());
        let found = modelling.points_per_wavelength;
        return refuse(of, "points_per_wavelength", found, accepted);
    }
    if modelling.vertex_budget == 0 {
        return refuse(of, "vertex_budget", 0, "a number from 1");
    }
    if modelling.whole_vertices == 0 {
        return refuse(of, "whole_vertices", 0, "a number from 1");
    }
    let tolerance = modelling.tolerance;
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return refuse(of, "tolerance", tolerance, "a number in (0, 1)");
    }
    modelling.remesh.as_ref().map_or(Ok(()), check_edges)?;
    let Some(dynamics) = modelling.dynamics else {
        return Ok(());
    };
    if !is_positive(dynamics.time_step) {
        let accepted = "a positive number of seconds";
        return refuse(of, "dynamics.time_step", dynamics.time_step, accepted);
    }
    if !(dynamics.damping >= 0.0 && dynamics.damping.is_finite()) {
        let accepted = "a finite number from 0";
        return refuse(of, "dynamics.damping", dynamics.damping, accepted);
    }
    Ok(())
}

fn check_edges(limits: &EdgeLimits) -> Checked {
    let of = "modelling";
    let EdgeLimits {
        min_edge,
        max_edge,
        aspect,
    } = *limits;
    if !(min_edge >= 0.0 && min_edge.is_finite()) {
        let accepted = "a finite length from 0, in metres";
        return refuse(of, "remesh.min_edge", min_edge, accepted);
    }
    // An infinite one is no limit.
    if max_edge.is_nan() || max_edge <= min_edge {
        let accepted = format!("a length above min_edge = {min_edge}, in metres");
        return refuse(of, "remesh.max_edge", max_edge, accepted);
    }
    if !(aspect >= 1.0 && aspect.is_finite()) {
        return refuse(of, "remesh.aspect", aspect, "a finite number from 1");
    }
    Ok(())
}
