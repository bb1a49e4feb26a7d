//! A patch of skin with a crease across its middle, for the tests.

use nalgebra::Vector2;
use ruga_blend::Driver;
use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
use ruga_stepper::{
    Coupling, CreaseSpec, FoldSense, Frame, LayerSpec, Modelling, Observer, PoseResult, PoseSpec,
    Silent, plan,
};

use crate::patch::{SIDE, driver, pose, skin};

/// Thickness of the forehead preset's layer over its bending length, roughly: widths are of this order.
pub(crate) const WIDTH: f64 = 5e-4;

/// A straight crease across the middle of the patch, from below to above.
pub(crate) fn crease(driver: &Driver, slant: f64) -> CreaseSpec {
    let ends = [
        Vector2::new(0.5 - slant, 0.9),
        Vector2::new(0.5 + slant, 0.1),
    ];
    crease_through(driver, ends.to_vec(), false)
}

/// A crease through texture coordinates.
pub(crate) fn crease_through(
    driver: &Driver,
    points: Vec<Vector2<f64>>,
    is_closed: bool,
) -> CreaseSpec {
    let tracer = LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs());
    let line = tracer.trace(&LineInput::Uv {
        points,
        is_closed,
        corners: Corners::Round,
    });
    CreaseSpec {
        name: "line".into(),
        line: line.expect("a line on the patch"),
        law: LineLaw {
            width: WIDTH,
            stiffness: 0.1,
            angle: 5_f64.to_radians(),
            fade: [2e-3; 2],
        },
        is_ridge: false,
        sense: FoldSense::Valley,
        drive: Drive::Load,
        anchor: None,
        slit: None,
        memory: CreaseMemory::default(),
        absorbs: false,
    }
}

/// The forehead preset's layer with a crease.
pub(crate) fn creased(crease: CreaseSpec, coupling: Coupling) -> LayerSpec {
    LayerSpec {
        creases: vec![crease],
        ..skin("forehead-furrow", coupling)
    }
}

/// The layer shortened evenly by a strain across the line, from rest in one key.
pub(crate) fn shortened(layer: &LayerSpec, strain: f64, modelling: &Modelling) -> PoseResult {
    let driver = driver();
    let poses = [PoseSpec {
        keys: vec![1.0],
        ..pose(&driver, "fold", strain / 1.5)
    }];
    let layers = std::slice::from_ref(layer);
    let plan = plan(&driver, layers, &poses, modelling, 1024).expect("a plan");
    let result = plan.simulate(0, &mut Silent).expect("a layer");
    assert!(result.converged, "{:?}", result.warnings);
    result
}

/// Depth of the furrow in the middle of the patch, m.
pub(crate) fn depth(result: &PoseResult) -> f64 {
    let layer = &result.keys[0].layers[0];
    let places = layer.driver_positions.iter().zip(&layer.positions);
    let in_middle = places.filter(|(p, _)| (p.y - 0.5 * SIDE).abs() < 0.1 * SIDE);
    // It is the deepest place there is.
    in_middle.map(|(p, x)| p.z - x.z).fold(f64::MIN, f64::max)
}

/// Wants every load step.
pub(crate) struct Frames(pub(crate) usize);

impl Observer for Frames {
    fn wants_frames(&self) -> bool {
        true
    }

    fn frame(&mut self, _: &Frame<'_>) {
        self.0 += 1;
    }
}
