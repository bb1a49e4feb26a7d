//! How long a layer's waves are on a body, here and there.

use ruga_blend::{BaseSurface, Driver, Smoothing};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace, face_areas};

use crate::plan::surface_measures::{uv_density, weighted_quantile};
use crate::skin::local_skin::wrinkling_on_face;
use crate::{EdgeLimits, LayerSpec, StepperError};

/// Fraction of the covered area whose waves are too short to count.
const SHORT: f64 = 0.05;
/// Fraction of the covered area above which waves are too long to count.
const LONG: f64 = 0.95;

/// The waves on the covered part of a body.
pub(super) struct Waves {
    /// Shortest wavelength that counts, m.
    pub(super) shortest: f64,
    /// Longest wavelength that counts, m.
    pub(super) longest: f64,
    /// Area, m², and wavelength, m, of every face.
    patches: Vec<[f64; 2]>,
    /// Median of the texture's sides per metre, 1/m.
    uv_density: f64,
}

impl Waves {
    /// Measures the waves by the layer's map and variation, read on every face of the driver's `faces` split `levels` times.
    pub(super) fn new(
        driver: &Driver,
        faces: &[FaceId],
        (layer, nominal): (&LayerSpec, &Wrinkling),
        (levels, smoothing): (u32, Smoothing),
    ) -> Result<Self, StepperError> {
        let surface = BaseSurface::new(driver, faces, levels, smoothing);
        let rest = surface.pose(driver.rest());
        let corners = surface.mesh().faces().as_slice().iter();
        let lengths = surface.uvs().as_slice().iter().zip(corners);
        let lengths = lengths.map(|(uvs, corners)| {
            let corners = corners.map(|v| rest.positions[v.index()]);
            Ok(wrinkling_on_face(layer, nominal, (uvs, corners))?.wavelength)
        });
        let lengths: PerFace<f64> = lengths.collect::<Result<_, StepperError>>()?;
        let areas = face_areas(surface.mesh(), &rest.positions);
        let faces: Vec<FaceId> = surface.mesh().faces().ids().collect();
        let quantile = |field, fraction| weighted_quantile(&faces, field, &areas, fraction);
        Ok(Self {
            shortest: quantile(&lengths, SHORT),
            longest: quantile(&lengths, LONG),
            uv_density: quantile(&uv_density(&surface, &rest), 0.5),
            patches: faces.iter().map(|f| [areas[*f], lengths[*f]]).collect(),
        })
    }

    /// Area of the covered part, m².
    pub(super) fn area(&self) -> f64 {
        self.patches.iter().map(|[area, _]| area).sum()
    }

    /// Texels along the shortest waves in a map with `side` of them.
    pub(super) fn texels(&self, side: u32) -> f64 {
        self.uv_density * f64::from(side) * self.shortest
    }

    /// Vertices of a mesh of equilateral triangles with so many edges to every wave, within limits.
    pub(super) fn vertices(&self, points: f64, limits: &EdgeLimits) -> f64 {
        let of = |[area, wavelength]: &[f64; 2]| {
            let edge = (wavelength / points).clamp(limits.min_edge, limits.max_edge);
            // A vertex of a mesh of equilateral triangles has the area of two of them.
            area / (0.75f64.sqrt() * edge * edge)
        };
        self.patches.iter().map(of).sum()
    }
}
