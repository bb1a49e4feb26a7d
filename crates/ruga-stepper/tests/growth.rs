//! Layers that grow against what carries them.

mod patch;

use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

use patch::{draft, driver, skin};
use ruga_stepper::{
    Coupling, Grows, GrowthDirection, GrowthSpec, LayerSpec, Mask, Modelling, PaintedNumber, Plan,
    PlannedFace, PoseSpec, Silent, Stack, plan,
};

fn growth(along: f64, across: f64) -> GrowthSpec {
    GrowthSpec {
        name: "grow".into(),
        grows: Grows::Layer,
        along,
        across,
        curl: [0.0; 2],
        direction: GrowthDirection::Angle(0.0),
        paint: None,
    }
}

fn grown(growths: Vec<GrowthSpec>) -> LayerSpec {
    LayerSpec {
        growths,
        ..skin("forehead-furrow", Coupling::Hybrid)
    }
}

/// A pose without blend shapes.
fn pose(strength: f64) -> PoseSpec {
    PoseSpec {
        name: "grown".into(),
        weights: Default::default(),
        keys: vec![1.0],
        steps: 2,
        motions: Vec::new(),
        growths: vec![("grow".into(), strength)],
        half: false,
    }
}

fn planned(layer: LayerSpec, strength: f64) -> Plan {
    plan(&driver(), &[layer], &[pose(strength)], &draft(), 512).expect("a valid scene")
}

/// What the first layer is asked for on every face of the plan's picture.
fn faces(plan: &Plan) -> Vec<PlannedFace> {
    let surface = plan.surface().expect("a surface").expect("no body");
    surface.faces(0, 0)
}

/// Mean over the faces of the strain in critical strains, and of the direction across wrinkles in the texture.
fn mean(plan: &Plan) -> (f64, [f64; 2]) {
    let faces = faces(plan);
    let count = faces.len() as f64;
    let ratio = faces.iter().map(|face| face.strain_ratio).sum::<f64>();
    let across = faces.iter().map(|face| {
        let turned = face.across.normalize();
        turned * turned.x.signum()
    });
    let across = across.sum::<nalgebra::Vector2<f64>>() / count;
    (ratio / count, across.into())
}

#[test]
fn a_growth_that_is_not_switched_on_changes_nothing() {
    let pressed = |growths: Vec<GrowthSpec>, strength: f64| {
        let driver = driver();
        let pose = PoseSpec {
            growths: vec![("grow".into(), strength), ("another".into(), 1.0)],
            ..patch::pose(&driver, "press", 1.0)
        };
        let plan = plan(&driver, &[grown(growths)], &[pose], &draft(), 512);
        let faces = faces(&plan.expect("a valid scene")).into_iter();
        faces.map(|face| face.strain_ratio).collect::<Vec<_>>()
    };
    let without = pressed(Vec::new(), 1.0);
    assert!(without.iter().any(|ratio| *ratio > 1.0));
    assert_eq!(without, pressed(vec![growth(0.1, 0.1)], 0.0));
}

#[test]
fn growth_is_compression_of_the_layer() {
    let layer = grown(vec![growth(0.08, 0.0)]);
    let critical = 0.045;
    let (ratio, across) = mean(&planned(layer.clone(), 1.0));
    let expected = (1.0 - 1.0 / 1.08) / critical;
    assert!(
        (ratio / expected - 1.0).abs() < 0.02,
        "{ratio} for {expected}"
    );
    assert!((across[0] - 1.0).abs() < 1e-6, "{across:?}");
    // Half of it.
    let (half, _) = mean(&planned(layer.clone(), 0.5));
    let expected = (1.0 - 1.0 / 1.04) / critical;
    assert!(
        (half / expected - 1.0).abs() < 0.02,
        "{half} for {expected}"
    );
    // A layer that shrinks is stretched along, and would contract across.
    let expected = 0.48 * (1.0 - 1.0 / 0.92) / critical;
    let (shrunk, _) = mean(&planned(layer.clone(), -1.0));
    assert!(
        (shrunk / expected - 1.0).abs() < 0.02,
        "{shrunk} for {expected}"
    );
    let result = planned(layer, 1.0).simulate(0, &mut Silent).expect("a run");
    let layer = &result.layers[0];
    assert!(result.converged && layer.amplitude > 0.3e-3, "{layer:?}");
    let wavelength = layer.wavelength.expect("waves") / layer.wavelength_predicted;
    assert!((0.85..1.15).contains(&wavelength), "{wavelength}");
}

#[test]
fn what_shrinks_below_compresses_like_growth() {
    let below = GrowthSpec {
        grows: Grows::Below,
        ..growth(-0.08, -0.02)
    };
    let own = growth(1.0 / 0.92 - 1.0, 1.0 / 0.98 - 1.0);
    let [below, own] = [below, own].map(|spec| mean(&planned(grown(vec![spec]), 1.0)).0);
    assert!((below / own - 1.0).abs() < 1e-12, "{below} for {own}");
}

#[test]
fn its_direction_is_that_of_the_texture() {
    let turned = |direction| {
        let spec = GrowthSpec {
            direction,
            ..growth(0.1, 0.0)
        };
        mean(&planned(grown(vec![spec]), 1.0))
    };
    let (ratio, [x, y]) = turned(GrowthDirection::Angle(FRAC_PI_4));
    // V points down, and the angle is counter-clockwise on the image.
    assert!((x - FRAC_PI_4.cos()).abs() < 1e-6 && (y + FRAC_PI_4.sin()).abs() < 1e-6);
    let plane = |value: f32| Mask::new(1, 1, vec![value]).expect("a mask");
    let painted = turned(GrowthDirection::Painted {
        right: plane(0.8),
        up: plane(0.8),
    });
    assert!((painted.0 / ratio - 1.0).abs() < 1e-6);
    assert!((painted.1[1] - y).abs() < 1e-6);
    // Middle grey of 8 bits has no direction.
    let grey = 128.0 / 255.0;
    let without = turned(GrowthDirection::Painted {
        right: plane(grey),
        up: plane(grey),
    });
    let even = mean(&planned(grown(vec![growth(0.05, 0.05)]), 1.0));
    assert!((without.0 / even.0 - 1.0).abs() < 1e-9);
}

#[test]
fn it_is_where_it_is_painted() {
    let image = Mask::new(4, 1, vec![0.0, 0.0, 1.0, 1.0]).expect("a mask");
    let spec = GrowthSpec {
        paint: Some(PaintedNumber {
            image,
            range: [-0.5, 1.0],
        }),
        ..growth(0.1, 0.1)
    };
    for face in faces(&planned(grown(vec![spec]), 1.0)) {
        let u = face.uvs.iter().map(|uv| uv.x).sum::<f64>() / 3.0;
        match u {
            u if u < 0.3 => assert!(face.strain_ratio < 0.0),
            u if u > 0.7 => assert!(face.strain_ratio > 2.0),
            _ => {}
        }
    }
}

/// Of two layers that stand for each other, both give way by the share that their stiffness enforces.
#[test]
fn layers_of_a_composite_share_their_growth() {
    let upper = LayerSpec {
        name: "upper".into(),
        ..skin("cheek", Coupling::Hybrid)
    };
    let ratio_of = |growths: [Vec<GrowthSpec>; 2]| {
        let [lower, above] = growths;
        let layers = [
            grown(lower),
            LayerSpec {
                growths: above,
                ..upper.clone()
            },
        ];
        let modelling = Modelling {
            stack: Stack::Composite,
            ..draft()
        };
        let plan = plan(&driver(), &layers, &[pose(1.0)], &modelling, 512).expect("a scene");
        mean(&plan).0
    };
    let one = || vec![growth(0.01, 0.01)];
    let [lower, above, both] = [
        ratio_of([one(), Vec::new()]),
        ratio_of([Vec::new(), one()]),
        ratio_of([one(), one()]),
    ];
    assert!(lower > 0.0 && above > 0.0);
    assert!(
        ((lower + above) / both - 1.0).abs() < 0.02,
        "{lower} and {above} make {both}"
    );
}

#[test]
fn impossible_growth_is_refused() {
    let refusal = |spec: GrowthSpec, strength: f64, stack: Stack| {
        let modelling = Modelling { stack, ..draft() };
        let driver = Arc::clone(&driver());
        let layers = [grown(vec![spec]), skin("fine-lines", Coupling::Hybrid)];
        let layers = if stack == Stack::Joint {
            &layers[..]
        } else {
            &layers[..1]
        };
        let refused = plan(&driver, layers, &[pose(strength)], &modelling, 512);
        // Not `expect_err`, which would print the whole plan.
        match refused {
            Ok(_) => panic!("{layers:?} was accepted"),
            Err(error) => error.to_string(),
        }
    };
    let below = || GrowthSpec {
        grows: Grows::Below,
        ..growth(-0.5, -0.5)
    };
    for (spec, strength, found) in [
        (growth(-0.5, 0.0), 2.0, "-1.000 to 0.000"),
        (growth(0.5, 0.0), 3.0, "0.000 to 1.500"),
        (growth(f64::NAN, 0.0), 1.0, "NaN"),
        (growth(0.1, 0.0), f64::INFINITY, "NaN"),
        (below(), 2.0, "inf"),
    ] {
        let refused = refusal(spec, strength, Stack::Nominal);
        assert!(
            refused.contains("pose 'grown', layer 'skin'") && refused.contains(found),
            "{refused}"
        );
        assert!(refused.contains("-0.6 to 1"), "{refused}");
    }
    let refused = refusal(growth(0.05, 0.0), 1.0, Stack::Joint);
    assert!(refused.contains("none in a joint pair"), "{refused}");
}
