//! How much of a layer's relief results show: its strength, its masks' grey, and a fade at borders.

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};
use ruga_material::Wrinkling;

use crate::cover::is_on_border;
use crate::fading::faded_from;
use crate::layer::turn_between;
use crate::local_skin::{uv, wavelengths_at_vertices};
use crate::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// Width of the fade inside a border, in wavelengths: the ring of pinned vertices ends a wrinkle at
/// full slope, and half a wave is the least over which a crest runs out without a corner.
const FADE: f64 = 0.5;

/// Grey at a border up to which the painted mask itself has faded the relief.
const FADED: f64 = 0.25;

/// How much of a layer's relief shows on the meshes it is computed and handed out on.
#[derive(Clone, Debug)]
pub(crate) struct ReliefShares {
    /// At the vertices of the mesh it is computed on.
    pub(crate) computed: Vec<f64>,
    /// At those of the mesh that results are handed out on.
    pub(crate) region: Vec<f64>,
}

impl ReliefShares {
    /// For the two meshes of a layer's region.
    pub(crate) fn new(
        driver: &Driver,
        spec: &LayerSpec,
        nominal: &Wrinkling,
        (computed, region): (&SkinMesh, &SkinMesh),
    ) -> Result<Self, StepperError> {
        Ok(Self {
            computed: relief_shares(driver, spec, nominal, computed)?,
            region: relief_shares(driver, spec, nominal, region)?,
        })
    }
}

/// Factor on the relief at every vertex of `skin`, a mesh of the layer's region.
///
/// Relief fades inside the border of the region, which is held on the surface below, unless that is
/// the border of the artist's mesh: there is no skin beyond it to be cut from.
pub(crate) fn relief_shares(
    driver: &Driver,
    spec: &LayerSpec,
    nominal: &Wrinkling,
    skin: &SkinMesh,
) -> Result<Vec<f64>, StepperError> {
    let points = skin.points.points();
    let outline = driver.topology().border_vertices();
    let border = skin.mesh.border_vertices();
    let is_cut: Vec<bool> = points
        .iter()
        .zip(border.as_slice())
        .map(|(place, on_border)| {
            *on_border
                && !is_on_border(driver.topology(), &outline, place)
                && spec.presence.grey(uv(driver, place)) > FADED
        })
        .collect();
    let mut shares = vec![spec.presence.strength; points.len()];
    if is_cut.contains(&true) {
        let wavelengths = wavelengths_at_vertices(spec, nominal, driver, skin)?;
        let reach = |i: usize| FADE * wavelengths[i];
        let faded = faded_from(&skin.mesh, &skin.rest.positions, &is_cut, reach);
        for (share, faded) in shares.iter_mut().zip(faded) {
            *share *= faded;
        }
    }
    for (share, place) in shares.iter_mut().zip(points) {
        *share *= spec.presence.grey(uv(driver, place));
    }
    Ok(shares)
}

/// Where the vertices are on a surface `shown` below them, their `shares` of how they deviate from the
/// real one kept.
pub(crate) fn shown_positions(
    positions: &[Vector3<f64>],
    real: &PosedSurface,
    shown: &PosedSurface,
    shares: &[f64],
) -> Vec<Vector3<f64>> {
    (0..positions.len())
        .map(|i| {
            let deviation = positions[i] - real.positions[i];
            // The surface shown is turned where the layer below it is shown flatter than it is.
            let turned = turn_between(real, shown, i) * deviation;
            shown.positions[i] + shares[i] * turned
        })
        .collect()
}
