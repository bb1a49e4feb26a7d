//! How long a layer's waves are on a body, here and there.

use ruga_blend::{BaseSurface, Driver, Smoothing};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace, VertexId};

use crate::local_skin::local_skin;
use crate::plan::{uv_density, weighted_quantile};
use crate::{EdgeLimits, LayerSpec, StepperError};

/// Shares of the covered area beyond which neither shorter nor longer waves count.
const SHORT: f64 = 0.05;
const LONG: f64 = 0.95;

/// The waves on the covered part of a body.
pub(super) struct Waves {
    faces: Vec<FaceId>,
    /// m.
    lengths: PerFace<f64>,
    /// m².
    areas: PerFace<f64>,
    /// Share of the texture's side per metre.
    uv_density: PerFace<f64>,
}

impl Waves {
    /// By the layer's map, read on every face of the driver's `faces` split `levels` times.
    pub(super) fn new(
        driver: &Driver,
        faces: &[FaceId],
        (layer, nominal): (&LayerSpec, &Wrinkling),
        (levels, smoothing): (u32, Smoothing),
    ) -> Result<Self, StepperError> {
        let surface = BaseSurface::new(driver, faces, levels, smoothing);
        let rest = surface.pose(driver.rest());
        let area = |corners: &[VertexId; 3]| {
            let [a, b, c] = corners.map(|v| rest.positions[v.index()]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        let length = |corners| -> Result<f64, StepperError> {
            Ok(match &layer.map {
                Some(map) => {
                    local_skin(layer, &map.sample_face(corners))?
                        .wrinkling
                        .wavelength
                }
                None => nominal.wavelength,
            })
        };
        let faces = surface.mesh().faces();
        Ok(Self {
            lengths: (surface.uvs().as_slice().iter())
                .map(length)
                .collect::<Result<_, _>>()?,
            areas: faces.as_slice().iter().map(area).collect(),
            uv_density: uv_density(&surface, &rest),
            faces: faces.ids().collect(),
        })
    }

    /// m.
    pub(super) fn shortest(&self) -> f64 {
        weighted_quantile(&self.faces, &self.lengths, &self.areas, SHORT)
    }

    /// m.
    pub(super) fn longest(&self) -> f64 {
        weighted_quantile(&self.faces, &self.lengths, &self.areas, LONG)
    }

    /// Texels along the shortest waves in a map with `side` of them.
    pub(super) fn texels(&self, side: u32) -> f64 {
        let density = weighted_quantile(&self.faces, &self.uv_density, &self.areas, 0.5);
        density * f64::from(side) * self.shortest()
    }

    /// Vertices of a mesh of equilateral triangles with so many edges to every wave, within limits.
    pub(super) fn vertices(&self, points: f64, limits: &EdgeLimits) -> f64 {
        let of = |face: &FaceId| {
            let edge = (self.lengths[*face] / points).clamp(limits.min_edge, limits.max_edge);
            self.areas[*face] / (0.75f64.sqrt() * edge * edge)
        };
        self.faces.iter().map(of).sum()
    }
}
