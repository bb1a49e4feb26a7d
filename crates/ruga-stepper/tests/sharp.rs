//! Layers whose meshes follow the sharp boundaries of their maps.

mod patch;

use std::sync::Arc;

use patch::{draft, driver, pose, skin};
use ruga_material::{PropertyImage, PropertyMap, Wrap};
use ruga_stepper::{Coupling, LayerSpec, Modelling, PoseResult, Silent, StepperError, plan};

const TEXELS: usize = 256;

/// A layer half as thick where `depth` in texture coordinates is negative.
fn painted(depth: impl Fn(f64, f64) -> f64) -> LayerSpec {
    let texel = |i: usize| (i as f64 + 0.5) / TEXELS as f64;
    let cover = |i: usize| depth(texel(i % TEXELS), texel(i / TEXELS)) * TEXELS as f64 + 0.5;
    let values = (0..TEXELS * TEXELS).map(|i| cover(i).clamp(0.0, 1.0) as f32);
    let thickness = PropertyImage {
        width: TEXELS,
        height: TEXELS,
        values: values.collect(),
        range: [0.5, 1.0],
    };
    let map = PropertyMap::new(None, None, Some(thickness), Wrap::ClampToEdge).expect("a map");
    LayerSpec {
        map: Some(Arc::new(map)),
        sharp: true,
        ..skin("forehead-furrow", Coupling::Hybrid)
    }
}

fn pressed(layer: &LayerSpec, modelling: &Modelling) -> Result<PoseResult, StepperError> {
    let driver = driver();
    let poses = [pose(&driver, "press", 1.0)];
    let layers = std::slice::from_ref(layer);
    let plan = plan(&driver, layers, &poses, modelling, 1024)?;
    plan.simulate(0, &mut Silent)
}

fn slanted() -> LayerSpec {
    painted(|u, v| 0.5 * (u - 0.48) + 0.75f64.sqrt() * (v - 0.51))
}

/// Edges along the boundary cost few vertices and change the wrinkles little.
#[test]
fn a_slanted_step_converges() {
    let sharp = slanted();
    let plain = LayerSpec {
        sharp: false,
        ..sharp.clone()
    };
    let [plain, sharp] = [plain, sharp].map(|layer| {
        let result = pressed(&layer, &draft()).expect("a layer");
        assert!(result.converged, "{:?}", result.warnings);
        assert!(result.warnings.is_empty(), "{:?}", result.warnings);
        result
    });
    let (plain, sharp) = (&plain.layers[0], &sharp.layers[0]);
    let ratio = sharp.amplitude / plain.amplitude;
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    let growth = sharp.vertices as f64 / plain.vertices as f64;
    assert!((0.8..1.25).contains(&growth), "{growth}");
}

/// Said before anything is simulated.
#[test]
fn the_planner_refuses_boundaries_nearly_everywhere() {
    let squares = |c: f64| (64.0 * c).floor() as i64;
    let layer = painted(|u, v| {
        if (squares(u) + squares(v)) % 2 == 0 {
            1.0
        } else {
            -1.0
        }
    });
    let driver = driver();
    let poses = [pose(&driver, "press", 1.0), pose(&driver, "press", 0.1)];
    let planned = |pose| {
        plan(
            &driver,
            std::slice::from_ref(&layer),
            &[pose],
            &draft(),
            1024,
        )
    };
    let [pressed, hardly] = poses.map(planned);
    let error = pressed.expect_err("a mesh cannot follow that");
    assert!(
        matches!(error, StepperError::TooManyBoundaries { .. }),
        "{error}"
    );
    // What is not simulated needs no mesh.
    assert_eq!(
        hardly.expect("nothing to do").poses[0].layers[0].vertices,
        0
    );
}
