//! Line anchors between a layer and places inside its body.

use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
use ruga_mesh::Id;
use ruga_shell::{FoldSense, LineAnchor};

use super::*;
use crate::{CreaseAnchor, CreaseSpec};

/// Depth of the places: in other cells than the skin's, which are 5 mm high.
const DEPTH: f64 = 5.4e-3;

/// The block's skin with an anchored line across the top, 1 mm from the middle.
fn anchored(driver: &Driver) -> LayerSpec {
    let mut spec = skin(Coupling::Hybrid);
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    let line = tracer.trace(&LineInput::Positions {
        points: [0.1, 0.9]
            .map(|y| Vector3::new(0.5 * SIDES[0] + 1e-3, y * SIDES[1], SIDES[2]))
            .to_vec(),
        is_closed: false,
        reach: 1e-4,
        corners: Corners::Keep,
    });
    spec.creases = vec![CreaseSpec {
        name: "line".into(),
        line: line.expect("a line on the top"),
        law: LineLaw {
            width: spec.material.thickness,
            stiffness: 0.1,
            angle: 0.1,
            fade: [0.0; 2],
        },
        is_ridge: false,
        sense: FoldSense::Both,
        drive: Drive::Load,
        anchor: Some(CreaseAnchor {
            depth: DEPTH,
            stiffness: 20.0,
        }),
        slit: None,
        memory: CreaseMemory::default(),
        absorbs: false,
    }];
    spec
}

fn block_with_anchors() -> (Arc<Driver>, Plan) {
    let driver = block();
    let spec = anchored(&driver);
    let body = Body {
        // Cells of 5 mm along z.
        cells: Some(4),
        ..body()
    };
    let plan = planned(&driver, &spec, &body);
    (driver, plan)
}

/// Energy (J), gradient and Hessian.
type Derivatives = (f64, Vec<f64>, Vec<f64>);

/// Those of the anchors alone, with this stiffness (Pa), at some unknowns.
fn of_anchors(layer: &mut Layer, stiffness: f64, x: &[f64]) -> Derivatives {
    let springs = |layer: &Layer, stiffness| {
        let edges = layer.skin.creases.iter().map(|crease| LineAnchor {
            edge: crease.edge,
            stiffness,
            // Another one at every edge.
            depths: [1e-4, 1e-5 * (crease.edge.index() % 7) as f64],
        });
        edges.collect::<Vec<_>>()
    };
    let base = gather(&layer.free, &layer.base);
    let mut both = [stiffness, 0.0].map(|stiffness| {
        let springs = springs(layer, stiffness);
        assert!(!springs.is_empty());
        solid(layer).set_line_anchors(&springs);
        let objective = layer.objective(&base, None);
        let mut gradient = vec![0.0; x.len()];
        let value = objective.gradient(x, &mut gradient);
        assert!((value - objective.value(x)).abs() <= 1e-12 * value.abs());
        let entries = objective.pattern().entries();
        let [mut exact, mut relaxed] = [0, 1].map(|_| vec![0.0; entries]);
        objective.hessian(x, &mut exact, &mut relaxed);
        (value, gradient, exact)
    });
    let (value, gradient, hessian) = std::mem::take(&mut both[0]);
    let without = &both[1];
    let less = |a: Vec<f64>, b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    (
        value - without.0,
        less(gradient, &without.1),
        less(hessian, &without.2),
    )
}

fn vectors(flat: &[f64]) -> Vec<Vector3<f64>> {
    flat.chunks_exact(3)
        .map(Vector3::from_column_slice)
        .collect()
}

/// The energy is quadratic as long as its normals stand still: differences over any way are exact but for rounding.
#[test]
fn anchors_have_their_derivatives_by_skin_and_flesh() {
    let (_driver, plan) = block_with_anchors();
    let mut layer = crumpled(&plan);
    let x = layer.unknowns();
    let stiffness = 1e8;
    let (_, gradient, hessian) = of_anchors(&mut layer, stiffness, &x);
    let of_layer = layer.positions.len();
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for part in [0..of_layer, of_layer..x.len() / 3, 0..x.len() / 3] {
        let mut way = random_vectors(&mut random, x.len() / 3, 1e-4);
        let outside = way
            .iter_mut()
            .enumerate()
            .filter(|(i, _)| !part.contains(i));
        outside.for_each(|(_, way)| *way = Vector3::zeros());
        let beside = |sign: f64| -> Vec<f64> {
            let way = way.iter().flatten();
            x.iter().zip(way).map(|(x, way)| x + sign * way).collect()
        };
        let [up, down] = [1.0, -1.0].map(|sign| of_anchors(&mut layer, stiffness, &beside(sign)));
        let slope: f64 = gradient
            .iter()
            .zip(way.iter().flatten())
            .map(|(g, w)| g * w)
            .sum();
        let found = 0.5 * (up.0 - down.0);
        assert!(
            (found - slope).abs() < 1e-7 * slope.abs(),
            "{part:?}: {found} {slope}"
        );
        let blocks = layer.solid.as_ref().expect("a body").blocks();
        let bend = blocks.product(&hessian, &way);
        let (mut error, mut size) = (0.0, 0.0);
        for ((high, low), bend) in up.1.iter().zip(&down.1).zip(bend.iter().flatten()) {
            error += (0.5 * (high - low) - bend).powi(2);
            size += bend.powi(2);
        }
        assert!(
            size > 0.0 && error < 1e-14 * size,
            "{part:?}: {}",
            error / size
        );
    }
}

/// Forces on skin and flesh cancel in any state. So do their torques wherever the line is straight above its place,
/// also in a body that has turned, whose anchors have the energy that they had before.
#[test]
fn anchors_pull_skin_and_flesh_towards_each_other() {
    let (_driver, plan) = block_with_anchors();
    let totals = |layer: &mut Layer| {
        let x = layer.unknowns();
        let (energy, gradient, _) = of_anchors(layer, 1e8, &x);
        let (places, forces) = (vectors(&x), vectors(&gradient));
        let torques = places.iter().zip(&forces).map(|(x, f)| x.cross(f));
        let size: f64 = forces.iter().map(Vector3::norm).sum();
        let force: Vector3<f64> = forces.iter().sum();
        let torque: Vector3<f64> = torques.sum();
        (
            energy,
            size,
            force.norm() / size,
            torque.norm() / (size * SIDES[0]),
        )
    };
    let mut layer = crumpled(&plan);
    let (_, size, force, torque) = totals(&mut layer);
    assert!(size > 1.0 && force < 1e-10, "{size} {force}");
    // The line has slid over its places.
    assert!(torque > 1e-4, "{torque}");
    let mut layer = at_rest(&plan);
    let raised = layer.base.iter().zip(&layer.held_normals);
    layer.positions = raised.map(|(x, n)| x + n * 3e-4).collect();
    let (before, ..) = totals(&mut layer);
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -1.1, 0.7));
    let moved = |p: &Vector3<f64>| turn * p + Vector3::new(0.1, 0.05, -0.2);
    layer.positions = layer.positions.iter().map(moved).collect();
    let q = &mut solid(&mut layer).state.q;
    *q = q.iter().map(moved).collect();
    follow(&mut layer);
    let (after, size, force, torque) = totals(&mut layer);
    assert!((after / before - 1.0).abs() < 1e-8, "{after} {before}");
    assert!(
        size > 1.0 && force < 1e-10 && torque < 1e-8,
        "{size} {force} {torque}"
    );
}

/// Depths that no spring has, or that lie below the body.
#[test]
fn anchors_deeper_than_the_flesh_are_refused() {
    let driver = block();
    let refused = |depth: f64, stiffness: f64| {
        let mut spec = anchored(&driver);
        spec.creases[0].anchor = Some(CreaseAnchor { depth, stiffness });
        let poses = [still(&driver)];
        let layers = std::slice::from_ref(&spec);
        let plan = plan_body(&driver, layers, &body(), &poses, &modelling(), 1024);
        plan.err().map(|error| error.to_string())
    };
    let names = "layer 'skin', crease 'line': `anchor.";
    let deep = refused(0.012, 20.0).expect("an error");
    assert!(deep.starts_with(names), "{deep}");
    assert!(
        deep.contains("0.012 m; accepted: less than 10.00 mm"),
        "{deep}"
    );
    for (depth, stiffness) in [
        (-1e-3, 20.0),
        (f64::NAN, 20.0),
        (1e-3, -1.0),
        (1e-3, f64::INFINITY),
    ] {
        let text = refused(depth, stiffness).expect("an error");
        assert!(text.starts_with(names) && text.contains("from 0"), "{text}");
    }
    assert_eq!(
        [0.0, 0.0099].map(|depth| refused(depth, 20.0)),
        [None, None]
    );
}
