//! Fires on squares of paper for tests.

use nalgebra::Vector3;
use ruga_blend::Smoothing;
use ruga_material::{LayerMaterial, ShrinkLaw, Substrate};

use crate::{
    Dynamics, Fire, FireSource, FrontDesign, GrowthDirection, Heats, LayerSpec, Modelling, PoseSpec,
};

pub(super) fn paper() -> LayerSpec {
    let material = LayerMaterial {
        young: 3e9,
        poisson: 0.3,
        thickness: 1e-4,
        density: 800.0,
    };
    let nothing = Substrate {
        young: 1.0,
        poisson: 0.0,
        thickness: 1.0,
    };
    LayerSpec::new("paper", material, nothing)
}

/// A front of 2 mm/s that shrinks and curls what it burns, from a match; its width, and place and radius of the match, m.
pub(super) fn fire(width: f64, centre: Vector3<f64>, radius: f64) -> Fire {
    Fire {
        front: FrontDesign {
            speed: 2e-3,
            width,
            ignition: 573.0,
            burning: 1100.0,
            surroundings: 293.0,
            loss_time: None,
        },
        edges_per_width: 2.0,
        speed: None,
        shrink: ShrinkLaw {
            along: 0.25,
            across: 0.25,
            asymmetry: 0.02,
            char_young: 0.1,
            char_thickness: 0.8,
        },
        grain: GrowthDirection::Angle(0.0),
        shrink_factor: None,
        asymmetry_factor: None,
        char_mass: 0.2,
        ash_share: 0.1,
        ash_paint: None,
        least_piece: 1e-6,
        sources: vec![FireSource {
            name: "match".into(),
            temperature: 1500.0,
            heats: Heats::Ball {
                centre,
                radius,
                coefficient: 50.0,
            },
        }],
    }
}

pub(super) fn modelling(dynamics: Dynamics) -> Modelling {
    Modelling {
        dynamics: Some(dynamics),
        smoothing: Smoothing::None,
        ..Modelling::default()
    }
}

pub(super) fn pose(steps: u32) -> PoseSpec {
    PoseSpec {
        name: "burn".into(),
        weights: Default::default(),
        keys: vec![1.0],
        steps,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }
}
