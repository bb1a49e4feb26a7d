//! What a plan says of one pose: its load path, and every layer with its mesh and its cost.

use ruga_material::Wrinkling;
use ruga_mesh::PerFace;

use crate::LayerSpec;
use crate::plan::creased_faces::CreasedFaces;

/// One pose's part of the plan.
#[derive(Clone, Debug)]
pub struct PosePlan {
    /// Name of the pose.
    pub name: String,
    /// Path to its keys.
    pub path: LoadPath,
    /// Layers of the pose, bottom first.
    pub layers: Vec<LayerPlan>,
}

/// Path from rest to a pose's keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadPath {
    /// The weights grow; one sequence passes all keys, each from the shape of the one before.
    #[default]
    Weight,
    /// The driver stands at a key while the strain grows from none to the key's; each key has a
    /// sequence of its own, and begins without wrinkles.
    ///
    /// For poses that on straight lines pass through strains that none of their keys has.
    Strain,
}

/// One layer in one pose.
#[derive(Clone, Debug)]
pub struct LayerPlan {
    /// Name of the layer.
    pub name: String,
    /// Critical wavelength, m.
    pub wavelength: f64,
    /// Critical strain.
    pub critical_strain: f64,
    /// Ranges of painted and naturally uneven properties over the active area; `None` where all of it is
    /// the same, or nothing is simulated.
    pub painted: Option<PaintedRanges>,
    /// Strain that the pose applies to the layer; `None` on a soft body, whose surface goes where the simulation
    /// takes it.
    pub applied: Option<AppliedStrain>,
    /// Area that is simulated, m²; zero where the layer cannot wrinkle.
    pub active_area: f64,
    /// Estimated number of vertices.
    pub vertices: usize,
    /// Times the driver's faces are split in four before long edges are halved.
    pub levels: u32,
    /// Edges per wavelength that this gives (median over the active area).
    pub points_per_wavelength: f64,
    /// Texels of the map per wavelength (median over the active area).
    pub texels_per_wavelength: f64,
    /// Expected time of the pose on one core, s.
    pub seconds: f64,
    /// Expected memory, bytes.
    pub memory: f64,
    /// Edges per wavelength asked for.
    pub(crate) asked_points: f64,
    /// Vertices that would meet what was asked for.
    pub(crate) needed: f64,
    /// The faces that are simulated, numbered as those of the whole driver split
    /// [`Plan::planning_levels`](crate::Plan) times, ascending.
    pub(crate) region: Vec<u64>,
    /// Longest edges that the output mesh may have in these faces, m; none where it is to be uniform.
    pub(crate) output_edges: Vec<f64>,
    /// Which of the layer's creases fold.
    pub(crate) creases: Vec<bool>,
}

/// Strain that the posed driver applies to a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AppliedStrain {
    /// Median over the active area of the largest effective strain over the keys; where nothing is
    /// active, over all skin that the layer may be on and that the pose does not fold. Not a number
    /// where there is no such skin.
    pub median: f64,
    /// 99th percentile of that strain.
    pub p99: f64,
    /// Largest of that strain on any face; negative infinity without faces.
    pub(crate) largest: f64,
    /// Active area compressed beyond 15 %, where the rest metric is capped, m².
    pub capped_area: f64,
    /// Area left on the driver because the pose folds or collapses it, m².
    pub folded_area: f64,
    /// Curvature measure `C / (R² K0)` at the 95th percentile of the rest curvature. By this fraction
    /// a foundation alone would delay the onset; the balance with the support removes the delay, and
    /// what is left near 1 is that the support bends within one wavelength.
    pub chi: f64,
    /// Area where averaging constraints decide on the directions of a labyrinth, m².
    pub(crate) labyrinth_area: f64,
}

/// Range of a layer's properties over the active area of a pose, without the extreme hundredths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintedRanges {
    /// Critical wavelength, m.
    pub wavelength: [f64; 2],
    /// Critical strain.
    pub critical_strain: [f64; 2],
    /// Thickness, m.
    pub thickness: [f64; 2],
}

impl LayerPlan {
    /// A layer that is solved together with this one, on its mesh; the cost stands with this one.
    pub(crate) fn carried_along(&self, name: &str, wrinkling: &Wrinkling) -> Self {
        Self {
            name: name.to_owned(),
            wavelength: wrinkling.wavelength,
            critical_strain: wrinkling.critical_strain,
            seconds: 0.0,
            memory: 0.0,
            // A layer with a region of its own would be simulated once more by itself.
            region: Vec::new(),
            output_edges: Vec::new(),
            creases: Vec::new(),
            ..self.clone()
        }
    }
}

/// A layer with its critical wave, by itself and on every face of the planning surface.
pub(crate) struct PlannedLayer<'a> {
    pub(crate) spec: &'a LayerSpec,
    pub(crate) wrinkling: &'a Wrinkling,
    pub(crate) local: PerFace<Wrinkling>,
    /// The faces under the lines of its creases.
    pub(crate) creased: CreasedFaces,
    /// Edges per wavelength asked for.
    pub(crate) points: f64,
    /// Whether it lies on the driver.
    pub(crate) is_lowest: bool,
}
