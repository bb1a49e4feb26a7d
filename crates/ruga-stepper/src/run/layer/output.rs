//! The mesh on which a layer's results are shown.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::Matrix3;
use ruga_blend::Driver;
use ruga_material::Wrinkling;
use ruga_mesh::PerFace;

use super::Layer;
use super::snapshot::{LayerView, Shape};
use crate::error::Halt;
use crate::preparing::Preparing;
use crate::skin::interpolation::Interpolation;
use crate::skin::piece::Piece;
use crate::skin::relief::ReliefWeights;
use crate::skin::skin_mesh::{RegionMesh, ShownFaces, SkinMesh};
use crate::{LayerSpec, StepperError};

/// The output mesh of a layer's region: made, or known well enough to make it. It takes more memory than the layer, and
/// nothing asks for it before the layer is solved.
#[derive(Clone)]
pub(crate) enum OutputMesh {
    Made(Box<RegionMesh>),
    Later(Arc<Unmade>),
}

/// What an output mesh is refined from.
pub(crate) struct Unmade {
    /// The faces to refine, each within one of the driver's.
    pub(crate) whole: Piece,
    /// Measure of edges for every face of the whole, as in [`refined`](crate::skin::refined::refined), 1/m².
    pub(crate) measures: PerFace<Matrix3<f64>>,
}

/// What a layer is shown by.
pub(crate) enum Output {
    Made(Box<Shown>),
    Later(Arc<Unmade>),
}

/// The output mesh, and how the layer comes to be on it.
pub(crate) struct Shown {
    pub(super) region: RegionMesh,
    /// Weights of the relief at its vertices.
    pub(super) weights: ReliefWeights,
    /// Takes results to it; `None` where it is the layer's own mesh.
    pub(super) interpolation: Option<Interpolation>,
    /// Pieces to make it of anew; `None` where it cannot be.
    pub(super) unmade: Option<Arc<Unmade>>,
}

/// The output mesh of a layer, and the weights of the relief at its vertices.
pub(crate) struct OnOutput<'o> {
    pub(crate) mesh: Cow<'o, RegionMesh>,
    pub(super) weights: Cow<'o, ReliefWeights>,
}

impl Output {
    /// Shows a layer on `mesh`, from the fitted mesh that it is solved on, if that is another; the relief has these
    /// `weights` on a mesh.
    pub(super) fn new(
        mesh: OutputMesh,
        fitted: Option<&SkinMesh>,
        weights: impl Fn(&SkinMesh) -> Result<ReliefWeights, StepperError>,
        preparing: &mut Preparing<'_>,
    ) -> Result<Self, Halt> {
        let region = match mesh {
            OutputMesh::Made(region) => *region,
            OutputMesh::Later(unmade) => return Ok(Self::Later(unmade)),
        };
        let interpolation = fitted.map(|skin| interpolation_to(skin, &region, preparing));
        Ok(Self::Made(Box::new(Shown {
            interpolation: interpolation.transpose()?,
            weights: weights(&region.skin)?,
            region,
            unmade: None,
        })))
    }
}

impl OnOutput<'_> {
    /// Triangles as results have them. A mesh that nothing else will be shown on is given up on the way.
    pub(super) fn into_faces(self, driver: &Driver) -> ShownFaces {
        let Self { mesh, weights } = self;
        drop(weights);
        match mesh {
            Cow::Borrowed(mesh) => mesh.shown(driver).clone(),
            Cow::Owned(mesh) => mesh.into_shown(driver),
        }
    }
}

impl Shown {
    /// Shows a layer, whose mesh `skin` is a fitted one, on `region`, which was made of `unmade`. `often` prepares
    /// it for more shapes than the present one.
    pub(super) fn new(
        driver: &Driver,
        (spec, wrinkling, skin): (&LayerSpec, &Wrinkling, &SkinMesh),
        (region, unmade): (RegionMesh, Arc<Unmade>),
        often: bool,
        preparing: &mut Preparing<'_>,
    ) -> Result<Self, Halt> {
        let interpolation = match often {
            true => interpolation_to(skin, &region, preparing)?,
            false => {
                preparing.while_wanted(|goes_on| Interpolation::new(skin, &region.skin, goes_on))?
            }
        };
        Ok(Self {
            weights: ReliefWeights::new(driver, spec, wrinkling, &region.skin)?,
            region,
            interpolation: Some(interpolation),
            unmade: Some(unmade),
        })
    }

    /// The output mesh, and what the `view` shows of the layer at its vertices.
    fn of(&self, view: &LayerView<'_>) -> (OnOutput<'_>, Shape) {
        let on_output = OnOutput {
            mesh: Cow::Borrowed(&self.region),
            weights: Cow::Borrowed(&self.weights),
        };
        (on_output, view.shape.on_output(self.interpolation.as_ref()))
    }

    /// The output mesh, and what the `view` shows of the layer at its vertices, where nothing else will be shown on it.
    pub(crate) fn last_of(self, view: &LayerView<'_>) -> (OnOutput<'static>, Shape) {
        let Self {
            mut region,
            weights,
            interpolation,
            ..
        } = self;
        let shape = view.shape.on_output(interpolation.as_ref());
        // Only a layer that is solved on a mesh turns with these.
        region.skin.rest.tangents = Vec::new();
        let on_output = OnOutput {
            mesh: Cow::Owned(region),
            weights: Cow::Owned(weights),
        };
        (on_output, shape)
    }
}

impl Layer {
    /// The output mesh as it is, for another layer of the same region.
    pub(crate) fn output_mesh(&self) -> OutputMesh {
        match &self.output {
            Output::Made(shown) => OutputMesh::Made(Box::new(shown.region.clone())),
            Output::Later(unmade) => OutputMesh::Later(Arc::clone(unmade)),
        }
    }

    /// What its output mesh is to be made of, where there is none yet.
    pub(crate) fn unmade_output(&self) -> Option<Arc<Unmade>> {
        match &self.output {
            Output::Made(_) => None,
            Output::Later(unmade) => Some(Arc::clone(unmade)),
        }
    }

    /// Shows the layer, whose mesh is a fitted one, on `made` from now on: `often`, or only in its present shape.
    pub(crate) fn show_on(
        &mut self,
        driver: &Driver,
        made: (RegionMesh, Arc<Unmade>),
        often: bool,
        preparing: &mut Preparing<'_>,
    ) -> Result<(), Halt> {
        let layer = (&self.spec, &self.wrinkling, &self.skin);
        let shown = Shown::new(driver, layer, made, often, preparing)?;
        self.output = Output::Made(Box::new(shown));
        Ok(())
    }

    /// Its output mesh, and at its vertices what the `view` shows of the layer.
    ///
    /// # Panics
    /// As [`Self::region`].
    pub(crate) fn on_output(&self, view: &LayerView<'_>) -> (OnOutput<'_>, Shape) {
        self.shown().of(view)
    }

    /// Gives back the output mesh where it can be made again: it takes as much memory as what solves the layer.
    pub(crate) fn forget_output(&mut self) {
        if let Output::Made(shown) = &mut self.output
            && let Some(unmade) = shown.unmade.take()
        {
            self.output = Output::Later(unmade);
        }
    }

    /// Output mesh.
    ///
    /// # Panics
    /// When it has not been made yet.
    pub(crate) fn region(&self) -> &RegionMesh {
        &self.shown().region
    }

    /// Takes results to the output mesh; `None` where that is the layer's own.
    ///
    /// # Panics
    /// As [`Self::region`].
    pub(crate) fn interpolation(&self) -> Option<&Interpolation> {
        self.shown().interpolation.as_ref()
    }

    fn shown(&self) -> &Shown {
        match &self.output {
            Output::Made(shown) => shown,
            Output::Later(_) => unreachable!("an output mesh is made before it is shown"),
        }
    }

    /// Whether the layer's mesh is another than its output mesh.
    pub(crate) fn is_fitted(&self) -> bool {
        match &self.output {
            Output::Made(shown) => shown.interpolation.is_some(),
            Output::Later(_) => true,
        }
    }
}

/// Transfer of values at the vertices of `skin` to those of `region`, for many of them.
fn interpolation_to(
    skin: &SkinMesh,
    region: &RegionMesh,
    preparing: &mut Preparing<'_>,
) -> Result<Interpolation, Halt> {
    preparing
        .while_wanted(|goes_on| Interpolation::new(skin, &region.skin, goes_on)?.prepared(goes_on))
}
