//! A pose's entry in the report.

use std::collections::BTreeMap;

use ruga_io::{
    CreaseReport, FireReport, LayerReport, MeanAndMost, PoseReport, Seconds, WrinkleMap,
    key_percent,
};
use ruga_stepper::{PoseResult, StopRule};

use crate::table::duration;

/// Report of a pose; `seconds` are those of its layers, `points` the vertices per wavelength that
/// were asked for.
pub(crate) fn pose_report(
    name: &str,
    result: &PoseResult,
    seconds: &[Seconds],
    points: f64,
    maps: &[WrinkleMap],
) -> PoseReport {
    let file = |map: &WrinkleMap| {
        let name = format!("{}_{}", key_percent(map.key), map.kind.word());
        (name, map.file.clone())
    };
    let layers = result.layers.iter().zip(seconds);
    PoseReport {
        name: name.to_owned(),
        converged: result.converged && !result.interrupted,
        interrupted: result.interrupted,
        points_per_wavelength: Some(points),
        frames: u32::try_from(result.frames).unwrap_or(u32::MAX),
        maps: maps.iter().map(file).collect::<BTreeMap<_, _>>(),
        layers: layers.map(|(layer, s)| layer_report(layer, s)).collect(),
    }
}

/// End of a pose in words, for people.
pub(crate) fn ending(report: &PoseReport) -> String {
    if report.frames == 0 && report.converged {
        return "nothing to wrinkle".to_owned();
    }
    let layers = report.layers.iter();
    let seconds: f64 = layers.filter_map(|layer| layer.seconds.total).sum();
    let time = duration(seconds * f64::from(report.frames.max(1)));
    match (report.interrupted, report.converged) {
        (true, _) => "interrupted; the keys that were finished are kept".to_owned(),
        (false, true) => format!("done in {time}"),
        (false, false) => format!("done in {time}, but it did not converge"),
    }
}

fn layer_report(layer: &ruga_stepper::LayerReport, seconds: &Seconds) -> LayerReport {
    let count = |n: usize| u64::try_from(n).ok();
    LayerReport {
        name: layer.name.clone(),
        vertices: count(layer.vertices),
        faces: count(layer.faces),
        constraints: count(layer.constraints),
        wavelength_predicted_m: Some(layer.wavelength_predicted),
        critical_strain_predicted: Some(layer.critical_strain_predicted),
        wavelength_range_m: layer.painted.map(|painted| painted.wavelength),
        thickness_range_m: layer.painted.map(|painted| painted.thickness),
        wavelength_m: layer.wavelength,
        amplitude_m: Some(layer.amplitude),
        energy_j: Some(layer.energy),
        newton_iterations: count(layer.newton_iterations),
        factorizations: count(layer.factorizations),
        residual: Some(layer.residual),
        stop_rule: layer.stop.map(stop_rule),
        bending_ratio: layer.bending_ratio,
        left_out_m2: (layer.left_out > 0.0).then_some(layer.left_out),
        creases: layer
            .creases
            .iter()
            .map(|crease| crease_report(crease, layer.energy))
            .collect(),
        intersections: layer.intersections.and_then(count),
        fire: layer.fire.as_ref().map(fire_report),
        seconds: seconds.clone(),
    }
}

fn fire_report(fire: &ruga_stepper::FireReport) -> FireReport {
    FireReport {
        field_vertices: fire.field_vertices as u64,
        fuel_left: fire.fuel_left,
        mass_kg: fire.mass,
        front_speed_m_s: fire.front_speed,
        pieces: fire.pieces as u64,
        dropped_pieces: fire.vanished as u64,
        dropped_area_m2: fire.vanished_area,
        capped_faces: fire.capped as u64,
        remeshings: fire.remeshed as u64,
    }
}

/// Report of a crease in a layer of an energy (J).
fn crease_report(crease: &ruga_stepper::CreaseReport, energy: f64) -> CreaseReport {
    CreaseReport {
        name: crease.name.clone(),
        length_m: crease.length,
        fold_deg: MeanAndMost {
            mean: crease.fold.to_degrees(),
            most: crease.largest_fold.to_degrees(),
        },
        depth_m: MeanAndMost {
            mean: crease.depth,
            most: crease.largest_depth,
        },
        energy_share: if energy > 0.0 {
            crease.energy / energy
        } else {
            0.0
        },
        folded_share: crease.folded_share,
    }
}

fn stop_rule(rule: StopRule) -> String {
    match rule {
        StopRule::Decrement => "decrement",
        StopRule::Residual => "residual",
        StopRule::Saddle => "saddle",
        StopRule::IterationLimit => "iteration limit",
        StopRule::LineSearch => "line search",
        StopRule::Infeasible => "infeasible",
        StopRule::Breakdown => "breakdown",
        StopRule::OutsideDomain => "outside domain",
        StopRule::Interrupted => "interrupted",
    }
    .to_owned()
}
