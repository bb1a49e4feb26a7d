//! Skin under loads that no artist should ask for: what comes out is sound, or the planner says why
//! not. Beside the papers' methods, and for all other cases: `cargo xtask validate stability`.

use ruga_stepper::{Dynamics, Modelling, PoseResult};
use ruga_validation::small_patch::{draft, followed, patch, planned, simulated, skin};

fn energy(result: &PoseResult) -> f64 {
    assert!(result.converged, "{:?}", result.warnings);
    result.layers[0].energy
}

/// Whether the planner of a patch that is compressed by so much says something.
fn is_told(compression: f64, what: &str) -> bool {
    let warnings = planned(&patch(compression), &skin(), &draft()).warnings;
    warnings.iter().any(|warning| warning.contains(what))
}

#[test]
fn a_key_ends_where_load_steps_and_steps_in_time_do() {
    let of = |modelling: &Modelling| energy(&simulated(&patch(0.12), &skin(), modelling, 4));
    let slow = energy(&followed(&patch(0.12), &skin(), 12));
    let jump = of(&draft()) / slow - 1.0;
    assert!(jump.abs() < 0.03, "{jump}");
    let dynamics = Some(Dynamics {
        time_step: 1.0,
        damping: 0.5,
    });
    let moved = Modelling {
        dynamics,
        ..draft()
    };
    let moved = of(&moved) / slow - 1.0;
    assert!(moved.abs() < 0.03, "{moved}");
}

/// A surface over a plane whose triangles all look up, and whose border is fixed, does not meet
/// itself.
#[test]
fn forty_per_cent_turn_no_triangle_over() {
    let result = simulated(&patch(0.4), &skin(), &draft(), 6);
    assert!(result.converged, "{:?}", result.warnings);
    let surface = &result.keys[0].layers[0];
    let upright = surface.faces.iter().map(|face| {
        let [a, b, c] = face.map(|v| surface.positions[v as usize]);
        (b - a).cross(&(c - a)).normalize().z
    });
    let least = upright.fold(1.0, f64::min);
    assert!(least > 0.3, "{least}");
}

#[test]
fn the_planner_warns_of_deep_folds_and_inverted_poses() {
    let deep = "where real skin folds or doubles its wrinkles";
    assert!(!is_told(0.145, deep) && is_told(0.155, deep));
    assert!(is_told(0.4, "compressed by more than 15 %"));
    assert!(is_told(1.5, "fold over"));
    let inverted = planned(&patch(1.5), &skin(), &draft());
    assert_eq!(inverted.poses[0].layers[0].active_area, 0.0);
}
