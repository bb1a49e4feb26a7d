//! Layers on others, from key to key.

mod patch;

use patch::{draft, driver, pose, skin};
use ruga_stepper::{Coupling, LayerSpec, Observer, PoseResult, PoseSpec, Preparation, plan};

/// Three layers that wrinkle by the second of two keys.
fn run(observer: &mut dyn Observer) -> PoseResult {
    let driver = driver();
    let layers = [2.0, 1.6, 1.3].map(|share| {
        let mut layer = skin("forehead-furrow", Coupling::Hybrid);
        layer.name = format!("{share}");
        layer.material.thickness *= share;
        layer
    });
    let layers: &[LayerSpec] = &layers;
    let poses = [PoseSpec {
        keys: vec![0.7, 1.0],
        ..pose(&driver, "press", 1.0)
    }];
    let plan = plan(&driver, layers, &poses, &draft(), 1024).expect("a valid scene");
    plan.simulate(0, observer).expect("a valid scene")
}

/// Wants what layers can only say as long as they have all that solves them.
struct States;

impl Observer for States {
    fn wants_frames(&self) -> bool {
        false
    }

    fn wants_face_states(&self) -> bool {
        true
    }
}

/// Ends the work with one step of the preparation.
struct Stop {
    steps: usize,
    last: usize,
}

impl Observer for Stop {
    fn wants_frames(&self) -> bool {
        false
    }

    fn preparing(&mut self, _: Preparation) -> bool {
        self.steps += 1;
        self.steps < self.last
    }
}

#[test]
fn a_layer_that_gives_up_what_solved_it_shows_the_same() {
    let mut whole = Stop {
        steps: 0,
        last: usize::MAX,
    };
    let (lean, kept) = (run(&mut whole), run(&mut States));
    assert!(lean.converged && kept.converged);
    for (lean, kept) in lean.keys.iter().zip(&kept.keys) {
        assert!(lean.layers.len() == 3 && kept.layers.len() == 3);
        for (lean, kept) in lean.layers.iter().zip(&kept.layers) {
            assert!(lean.positions == kept.positions && lean.relief == kept.relief);
            assert!(lean.faces == kept.faces && lean.artist == kept.artist);
            assert_eq!(lean.computed.positions, kept.computed.positions);
            assert!(lean.face_states.is_none() && kept.face_states.is_some());
        }
    }
    for (lean, kept) in lean.layers.iter().zip(&kept.layers) {
        assert_eq!(format!("{lean:?}"), format!("{kept:?}"));
        assert!(lean.wavelength.is_some(), "{lean:?}");
    }
    // The last thing that is prepared is the output mesh of the topmost layer.
    let mut hasty = Stop {
        steps: 0,
        last: whole.steps,
    };
    let ended = run(&mut hasty);
    assert!(ended.interrupted && !ended.converged);
    assert_eq!(ended.keys.len(), 1);
    assert_eq!(
        ended.keys[0].layers[2].relief,
        lean.keys[0].layers[2].relief
    );
}
