//! A free thin sheet: a layer that lies on nothing, held by handles and pushed by obstacles.

mod apart;
mod balance;
mod burning;
mod burnt;
mod burnt_faces;
mod carried;
mod covering;
mod cut_surface;
mod field_grid;
mod fire;
mod fitting;
mod meshed;
mod objective;
mod pieces;
mod plan;
mod refit;
mod rest_shape;
mod run;
mod standing;
mod state;
mod zones;

use nalgebra::Vector3;

use crate::support::Moves;
use crate::{Handle, Obstacle, PoseSpec, StepperError};

pub use burnt::BurntSurface;
pub use fire::{Fire, FireSource, Heats};
pub use plan::{SHEET_EDGES, plan_sheet};

/// A free sheet's surroundings and the resolution of its mesh.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Acceleration of its mass, m/s2. It acts in full from the first load step on.
    pub gravity: Vector3<f64>,
    /// Parts of the sheet that are held and moved: vertices at rest in a box.
    pub handles: Vec<Handle>,
    /// Obstacles that the sheet cannot enter.
    pub obstacles: Vec<Obstacle>,
    /// Longest edge of its mesh, m; `None` for a sixtieth of its longest side, and where
    /// it burns at most half the width of the front: see [`Sheet::edges`].
    pub edge: Option<f64>,
    /// Fire on it.
    pub fire: Option<Fire>,
}

impl Sheet {
    /// The motions of a pose, checked.
    fn moves<'a>(&'a self, pose: &'a PoseSpec) -> Result<Moves<'a>, StepperError> {
        let balls: Vec<&str> = self.fire.iter().flat_map(Fire::movers).collect();
        Moves::new((&self.handles, &self.obstacles), &balls, pose)
    }
}
