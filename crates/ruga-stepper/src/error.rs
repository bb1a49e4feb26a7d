//! What can be wrong with a scene once its files are read.

use std::fmt::Display;

use nalgebra::Vector3;
use ruga_blend::BlendError;
use ruga_burn::BurnError;
use ruga_constraint::ConstraintError;
use ruga_lattice::LatticeError;
use ruga_material::MaterialError;
use ruga_remesh::RemeshError;
use ruga_shell::ShellError;
use ruga_solver::SolverError;

use crate::ObstacleShape;

/// Why a pose cannot be planned or simulated.
#[derive(Debug, thiserror::Error)]
pub enum StepperError {
    /// There is no layer to simulate.
    #[error("the scene has no layer; at least one [[layers]] is needed")]
    NoLayer,
    /// A setting has a value that nothing can be planned or simulated with.
    #[error("{of}: `{field}` is {found}; accepted: {accepted}")]
    Setting {
        /// Owner of the setting, such as `pose 'frown'`.
        of: String,
        /// The field, with its place in a list.
        field: String,
        /// Value that was found.
        found: String,
        /// Accepted values.
        accepted: String,
    },
    /// A pose is asked for that the plan does not have.
    #[error(
        "pose number {pose} is not in the plan; accepted: a number below {poses}, its number of poses"
    )]
    NoSuchPose {
        /// The number asked for, from 0.
        pose: usize,
        /// Poses of the plan.
        poses: usize,
    },
    /// The masks of a layer and of the region leave nothing of it.
    #[error(
        "layer '{layer}': its mask and the region mask leave no face of the mesh: a face counts where they are lighter than a sixteenth in its middle; paint whole faces white"
    )]
    BlackMask {
        /// Name of the layer.
        layer: String,
    },
    /// A material is out of range.
    #[error("layer '{layer}': {source}")]
    Material {
        /// Name of the layer.
        layer: String,
        /// Description of the mistake.
        source: MaterialError,
    },
    /// A painted map jumps nearly everywhere.
    #[error(
        "layer '{layer}': the sharp boundaries in its map cross {percent:.0} % of the mesh's edges, far more than wrinkles can follow; blur the noise or fine pattern in the paint, or leave `sharp` out"
    )]
    TooManyBoundaries {
        /// Name of the layer.
        layer: String,
        /// Edges that a boundary crosses, of hundred.
        percent: f64,
    },
    /// The layers of a stack are to act together and one of them is painted.
    #[error(
        "layer '{layer}' has a {what}, and stack = \"{stack}\" knows uniform layers only; leave it out, or take stack = \"nominal\""
    )]
    PaintedStack {
        /// Name of the layer.
        layer: String,
        /// Source of the unevenness.
        what: &'static str,
        /// Meaning asked of the stack.
        stack: &'static str,
    },
    /// A stack is to be solved at once and is no pair.
    #[error(
        "stack = \"joint\" solves two layers at once, the scene has {found}; take \"nominal\" or \"composite\""
    )]
    NoPair {
        /// Number of layers.
        found: usize,
    },
    /// The active region is so narrow that nothing in it can move.
    #[error(
        "layer '{layer}': every vertex of its mesh is on the border of its region, which is held; enlarge the region, or lower `min_edge` or the wavelength"
    )]
    NoRoom {
        /// Name of the layer.
        layer: String,
    },
    /// The lattice inside a body cannot be built.
    #[error("interior: {0}")]
    Lattice(#[from] LatticeError),
    /// A handle holds nothing.
    #[error(
        "handle '{handle}' from {} m holds no cell of the lattice, or only what handles before it hold: a cell is held when its part of the body has its centre in the box, and these centres reach from {} m; enlarge the box or take more cells",
        corners(asked),
        corners(found)
    )]
    EmptyHandle {
        /// Name of the handle.
        handle: String,
        /// Lowest and highest corner of its box, m.
        asked: [Vector3<f64>; 2],
        /// Lowest and highest corner of the box around the centres of all cells, m.
        found: [Vector3<f64>; 2],
    },
    /// A handle of a sheet holds nothing.
    #[error(
        "handle '{handle}' from {} m holds no vertex of the sheet, or only what handles before it hold: at rest these reach from {} m; enlarge the box",
        corners(&boxes[0]),
        corners(&boxes[1])
    )]
    EmptySheetHandle {
        /// Name of the handle.
        handle: String,
        /// Lowest and highest corner of its box, and of the box around the sheet's vertices at rest, m.
        boxes: Box<[[Vector3<f64>; 2]; 2]>,
    },
    /// A sheet cannot burn as it is asked to.
    #[error("burn: {source}")]
    Burn {
        /// Description of the mistake.
        source: Box<BurnError>,
    },
    /// What has burnt out cannot be like that.
    #[error("burn: {source}")]
    Char {
        /// Description of the mistake.
        source: MaterialError,
    },
    /// Handles hold all of a body.
    #[error("the handles hold every node of the lattice; make them smaller or take more cells")]
    HeldBody,
    /// An obstacle has no surface.
    #[error(
        "obstacle '{obstacle}' has no shape: radius, length and normal must be positive and finite, found {shape:?}"
    )]
    ShapelessObstacle {
        /// Name of the obstacle.
        obstacle: String,
        /// Kind of thing that was expected.
        shape: ObstacleShape,
    },
    /// A motion is of something that is not there.
    #[error("pose '{pose}' moves '{name}', which is neither a handle nor an obstacle")]
    UnknownMover {
        /// Name of the pose.
        pose: String,
        /// Name that it gives.
        name: String,
    },
    /// The keyframes of a motion are out of order.
    #[error(
        "pose '{pose}': the keyframes of '{name}' must be finite and ascend, over 0 and up to 1"
    )]
    Keyframes {
        /// Name of the pose.
        pose: String,
        /// Name of the handle or obstacle.
        name: String,
    },
    /// The driver cannot be posed.
    #[error(transparent)]
    Blend(#[from] BlendError),
    /// The layer's mesh has no energy.
    #[error("layer '{layer}': {source}")]
    Shell {
        /// Name of the layer.
        layer: String,
        /// Description of the mistake.
        source: ShellError,
    },
    /// The layer's mesh cannot be fitted to the pose.
    #[error("layer '{layer}': {source}")]
    Remesh {
        /// Name of the layer.
        layer: String,
        /// Description of the mistake.
        source: RemeshError,
    },
    /// The constraints cannot be sampled.
    #[error("layer '{layer}': {source}")]
    Constraint {
        /// Name of the layer.
        layer: String,
        /// Description of the mistake.
        source: ConstraintError,
    },
    /// The solver refused its input or broke down.
    #[error("layer '{layer}': {source}")]
    Solver {
        /// Name of the layer.
        layer: String,
        /// Description of the mistake.
        source: SolverError,
    },
}

/// Why work on a layer ended before it was done.
#[derive(Debug)]
pub(crate) enum Halt {
    /// The observer asked for it.
    Interrupted,
    /// It cannot be done.
    Failed(StepperError),
}

impl Halt {
    /// Result; `None` where the observer ended the work.
    pub(crate) fn unless_interrupted<T>(made: Result<T, Self>) -> Result<Option<T>, StepperError> {
        match made {
            Ok(made) => Ok(Some(made)),
            Err(Self::Interrupted) => Ok(None),
            Err(Self::Failed(error)) => Err(error),
        }
    }
}

impl StepperError {
    /// What is wrong with a fire.
    pub(crate) fn burn(source: BurnError) -> Self {
        let source = Box::new(source);
        Self::Burn { source }
    }
}

impl<E: Into<StepperError>> From<E> for Halt {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

fn corners(of: &[Vector3<f64>; 2]) -> String {
    let [low, high] = of.map(|c| format!("[{:.4}, {:.4}, {:.4}]", c.x, c.y, c.z));
    format!("{low} to {high}")
}

/// Result of a check of the input.
pub(crate) type Checked = Result<(), StepperError>;

/// Refuses a setting with [`setting`].
pub(crate) fn refuse(
    of: impl Display,
    field: impl Display,
    found: impl Display,
    accepted: impl Display,
) -> Checked {
    Err(setting(of, field, found, accepted))
}

/// [`StepperError::Setting`]: `field` of `of` is `found`, but has to be `accepted`.
pub(crate) fn setting(
    of: impl Display,
    field: impl Display,
    found: impl Display,
    accepted: impl Display,
) -> StepperError {
    StepperError::Setting {
        of: of.to_string(),
        field: field.to_string(),
        found: found.to_string(),
        accepted: accepted.to_string(),
    }
}
