//! From a scene's `[interior]` or `[sheet]` and motions to what the stepper simulates.

use ruga_io::MeshFile;
use ruga_material::Substrate;
use ruga_stepper::{
    Body, Fire, Handle, Keyframe, LayerSpec, Motion, Obstacle, ObstacleShape, PoseSpec, Sheet,
    SolidMaterial,
};

use crate::file::{self, SceneFile};
use crate::placement::Placement;

/// The body below the layer, where the scene has one.
pub(crate) fn body_of(scene: &SceneFile, mesh: &MeshFile, layers: &[LayerSpec]) -> Option<Body> {
    let (interior, layer) = (scene.interior.as_ref()?, layers.first()?);
    Some(body(interior, &layer.substrate, &Placement::of(mesh)))
}

/// Gives each of `poses` the motions that the scene lists for it.
pub(crate) fn set_motions(scene: &SceneFile, mesh: &MeshFile, poses: &mut [PoseSpec]) {
    let placement = Placement::of(mesh);
    for pose in poses {
        pose.motions = motions(scene, &pose.name, &placement);
    }
}

/// What acts on the layer, where it is a free sheet.
pub(crate) fn sheet_of(scene: &SceneFile, mesh: &MeshFile, fire: Option<Fire>) -> Option<Sheet> {
    let sheet = scene.sheet.as_ref()?;
    let placement = Placement::of(mesh);
    Some(Sheet {
        gravity: placement.way_in_file(sheet.gravity),
        handles: handles(&sheet.handles, &placement),
        obstacles: obstacles(&sheet.obstacles, &placement),
        edge: sheet.edge,
        fire,
    })
}

/// The body that `interior` describes, made of what carries its layer.
fn body(interior: &file::Interior, inside: &Substrate, placement: &Placement) -> Body {
    Body {
        cells: interior.cells,
        shape: interior.shape,
        material: SolidMaterial {
            young: inside.young,
            poisson: inside.poisson,
        },
        density: interior.density,
        gravity: placement.way_in_file(interior.gravity),
        handles: handles(&interior.handles, placement),
        obstacles: obstacles(&interior.obstacles, placement),
        follow: interior.follow,
    }
}

fn handles(handles: &[file::Handle], placement: &Placement) -> Vec<Handle> {
    let handle = |handle: &file::Handle| Handle {
        name: handle.name.clone(),
        min: handle.min.into(),
        max: handle.max.into(),
        turn: placement.turn,
        shift: placement.shift,
    };
    handles.iter().map(handle).collect()
}

fn obstacles(obstacles: &[file::Obstacle], placement: &Placement) -> Vec<Obstacle> {
    let obstacles = obstacles.iter().filter_map(|obstacle| {
        Some(Obstacle {
            name: obstacle.name.clone(),
            shape: obstacle_shape(obstacle, placement)?,
        })
    });
    obstacles.collect()
}

/// The shape that is given; reading a scene has refused obstacles with none or several.
fn obstacle_shape(obstacle: &file::Obstacle, placement: &Placement) -> Option<ObstacleShape> {
    let place = |place| placement.place_in_file(place);
    let plane = obstacle.plane.map(|plane| ObstacleShape::Plane {
        point: place(plane.point),
        normal: placement.way_in_file(plane.normal),
    });
    let sphere = obstacle.sphere.map(|sphere| ObstacleShape::Sphere {
        centre: place(sphere.centre),
        radius: sphere.radius,
    });
    let cylinder = obstacle.cylinder.map(|cylinder| ObstacleShape::Cylinder {
        from: place(cylinder.from),
        to: place(cylinder.to),
        radius: cylinder.radius,
    });
    plane.or(sphere).or(cylinder)
}

/// Motions of handles and obstacles in the pose named `pose`; one that the scene does not list has
/// none.
fn motions(scene: &SceneFile, pose: &str, placement: &Placement) -> Vec<Motion> {
    let mut motions: Vec<Motion> = Vec::new();
    let listed = scene.poses.iter().find(|listed| listed.name == pose);
    for step in listed.iter().flat_map(|listed| &listed.motions) {
        let keyframe = Keyframe {
            at: step.at,
            translation: placement.way_in_file(step.translation),
            turn: placement.turn_in_file(step.turn).map(f64::to_radians),
            about: placement.place_in_file(step.about),
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
