//! What a caller can watch while a pose is simulated.

use nalgebra::Vector3;

use crate::LayerSurface;

/// Parts of the work that time is reported for: the columns of Li 2014, table 6-1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Cluster centres and constraint functions.
    Constraints,
    /// Driver positions, normals and rest metric at the layer's vertices.
    Sampling,
    /// Fitting the mesh to what the pose asks for.
    Remeshing,
    /// The solve.
    Integration,
}

/// Progress of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Fraction of the pose, in (0, 1].
    pub load: f64,
    /// Newton iteration within this load step.
    pub iteration: usize,
    /// Vertices that move.
    pub vertices: usize,
}

/// Progress of the preparation of a layer, before its first iteration, between two load steps or before it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preparation {
    /// Number of the layer, from the lowest one.
    pub layer: usize,
    /// Part of the work that is being done.
    pub phase: Phase,
    /// Steps done since the preparation of the layer or of a load step began, from 1. How many there
    /// will be is not known: about thirty.
    pub step: usize,
}

/// One converged load step.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of the frame, from 0.
    pub index: usize,
    /// Fraction of the pose, in (0, 1].
    pub load: f64,
    /// Layers, bottom first.
    pub layers: &'a [LayerSurface],
    /// Positions of the driver's vertices if they moved with a body or a sheet, as in
    /// [`KeyResult::artist_positions`](crate::KeyResult::artist_positions), m.
    pub artist_positions: Option<&'a [Vector3<f64>]>,
}

/// Watches a simulation; the library itself has no clock and prints nothing.
///
/// It is called by one thread at a time, but not always by the same: a large layer is solved by several, which
/// wait while one of them is in a call. A call must not wait for work of the same pool of threads.
pub trait Observer: Send {
    /// The next piece of work on layer number `layer` begins; a caller with a clock can tell how
    /// long the last one took.
    fn phase(&mut self, layer: usize, phase: Phase) {
        let _ = (layer, phase);
    }

    /// A step of the preparation of a layer or of a load step ends, a small part of a second after the last one, or
    /// where it has some hundred thousand triangles up to two seconds; `false` asks to stop as soon
    /// as possible.
    fn preparing(&mut self, preparation: Preparation) -> bool {
        let _ = preparation;
        true
    }

    /// An iteration ends; `false` asks to stop as soon as possible.
    fn progress(&mut self, progress: Progress) -> bool {
        let _ = progress;
        true
    }

    /// Whether results are wanted in every load step, not at the keys alone. Between keys a soft body is
    /// then only passed, less exactly and without the layers on top, and a posed driver not at all.
    fn wants_frames(&self) -> bool {
        true
    }

    /// Whether [`LayerSurface::face_states`] are wanted in frames and results. They are computed for each of
    /// them, in a small part of the time of its solve.
    fn wants_face_states(&self) -> bool {
        false
    }

    /// A load step ends: every one, or those at keys.
    fn frame(&mut self, frame: &Frame<'_>) {
        let _ = frame;
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn wants_frames(&self) -> bool {
        false
    }
}
