//! What a plan says of meshes, and what is made.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_stepper::{Modelling, Observer, Progress};
use ruga_validation::{Skin, asset};

/// Ends the work with the first iteration: by then the mesh is there.
struct Hasty;

impl Observer for Hasty {
    fn progress(&mut self, _: Progress) -> bool {
        false
    }
}

/// Most of the skin that is simulated around a mouth or a brow is smooth, with edges that grow with the distance
/// from the wrinkles.
#[test]
fn vertices_of_poses_that_wrinkle_here_and_there_are_foretold() {
    let skin = Skin::new(&asset("face/face.glb"), "cheek");
    for (shapes, points) in [
        (["mouthSmileLeft", "mouthSmileRight"], 6.0),
        (["noseSneerLeft", "noseSneerRight"], 12.0),
    ] {
        let pose = skin.pose(&shapes.map(|shape| (shape, 1.0)), 1);
        let modelling = Modelling {
            points_per_wavelength: points,
            ..Modelling::default()
        };
        let plan = skin.plan(&pose, &modelling);
        let made = plan.simulate(0, &mut Hasty).expect("a valid scene");
        let (planned, made) = (plan.poses[0].layers[0].vertices, made.layers[0].vertices);
        let ratio = planned as f64 / made as f64;
        println!(
            "{} at {points} points: {made} vertices, {planned} planned",
            shapes[0]
        );
        assert!((0.85..1.2).contains(&ratio), "{}: {ratio}", shapes[0]);
    }
}
