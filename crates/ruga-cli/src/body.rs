//! From a scene's `[interior]` and motions to what the stepper simulates.

use nalgebra::Vector3;
use ruga_io::{Scene, scene};
use ruga_material::Substrate;
use ruga_stepper::{
    Body, CellShape, Handle, Keyframe, Motion, Obstacle, ObstacleShape, SolidMaterial,
};

/// The body that `interior` describes, made of what carries its layer.
pub(crate) fn body(interior: &scene::Interior, inside: &Substrate) -> Body {
    // Reading a scene has refused obstacles without exactly one shape.
    let obstacles = interior.obstacles.iter();
    let obstacles = obstacles.filter_map(|obstacle| {
        Some(Obstacle {
            name: obstacle.name.clone(),
            shape: obstacle_shape(obstacle.shape()?),
        })
    });
    let handle = |handle: &scene::Handle| Handle {
        name: handle.name.clone(),
        min: handle.min.into(),
        max: handle.max.into(),
    };
    Body {
        cells: interior.cells,
        shape: match interior.shape {
            scene::CellShape::Quadratic => CellShape::Quadratic,
            scene::CellShape::Linear => CellShape::Linear,
        },
        material: SolidMaterial {
            young: inside.young,
            poisson: inside.poisson,
        },
        density: interior.density,
        gravity: interior.gravity.into(),
        handles: interior.handles.iter().map(handle).collect(),
        obstacles: obstacles.collect(),
        follow: interior.follow,
    }
}

fn obstacle_shape(shape: scene::ObstacleShape) -> ObstacleShape {
    match shape {
        scene::ObstacleShape::Plane(plane) => ObstacleShape::Plane {
            point: plane.point.into(),
            normal: plane.normal.into(),
        },
        scene::ObstacleShape::Sphere(sphere) => ObstacleShape::Sphere {
            centre: sphere.centre.into(),
            radius: sphere.radius,
        },
        scene::ObstacleShape::Cylinder(cylinder) => ObstacleShape::Cylinder {
            from: cylinder.from.into(),
            to: cylinder.to.into(),
            radius: cylinder.radius,
        },
    }
}

/// How handles and obstacles move in the pose named `pose`; one that the scene does not list has no
/// motions.
pub(crate) fn motions(scene: &Scene, pose: &str) -> Vec<Motion> {
    let mut motions: Vec<Motion> = Vec::new();
    let listed = scene.poses.iter().find(|listed| listed.name == pose);
    for step in listed.iter().flat_map(|listed| &listed.motions) {
        let keyframe = Keyframe {
            at: step.at,
            translation: step.translation.into(),
            turn: Vector3::from(step.turn).map(f64::to_radians),
            about: step.about.into(),
        };
        match motions.iter_mut().find(|motion| motion.of == step.of) {
            Some(motion) => motion.keyframes.push(keyframe),
            None => motions.push(Motion {
                of: step.of.clone(),
                keyframes: vec![keyframe],
            }),
        }
    }
    motions
}
