//! Meshes that are fine only where, and in the direction that, a pose compresses the skin.

use nalgebra::Matrix3;
use ruga_blend::{Driver, FaceStrain, rest_frame};
use ruga_material::Wrinkling;
use ruga_mesh::{FaceId, Id, PerFace};
use ruga_remesh::{FaceDriver, Refinement, RemeshSettings, SizeLimits};

use crate::below::BelowSurface;
use crate::layer::offered_strains;
use crate::local_skin::{LocalSkin, SkinProperties};
use crate::skin_mesh::{Adapted, MeshDemand, RegionMesh, SkinMesh};
use crate::{LayerSpec, Modelling, StepperError};

/// Longest edge where nothing wrinkles, in wavelengths: the low-pass rows, which reach further,
/// still see a smooth average.
pub(crate) const COARSEST: f64 = 0.5;

/// The region's mesh fitted to what the surfaces `below` ask of it; `None` where meshes are to stay
/// uniform.
pub(crate) fn adapted(
    driver: &Driver,
    layer: &LayerSpec,
    wrinkling: &Wrinkling,
    region: &RegionMesh,
    below: &[BelowSurface],
    modelling: &Modelling,
) -> Result<Option<Adapted>, StepperError> {
    let Some(limits) = modelling.remesh else {
        return Ok(None);
    };
    let properties = SkinProperties::new(layer, wrinkling, None, driver, &region.skin)?;
    let drivers = face_drivers(layer.material.poisson, &properties, &region.skin, below);
    let refinement = Refinement {
        points_per_wavelength: modelling.points_per_wavelength,
        ..Refinement::default()
    };
    let settings = RemeshSettings {
        limits: SizeLimits {
            min_edge: limits.min_edge,
            max_edge: limits.max_edge,
            aspect: limits.aspect,
            ..SizeLimits::default()
        },
        ..RemeshSettings::default()
    };
    let longest = properties.vertices.iter();
    let longest: Vec<f64> = longest
        .map(|local| COARSEST * local.wrinkling.wavelength)
        .collect();
    let demand = MeshDemand {
        drivers: &drivers,
        longest: &longest,
        refinement,
        budget: modelling.vertex_budget,
    };
    let adapted = region.adapted(driver, &demand, &settings);
    adapted.map(Some).map_err(|source| StepperError::Remesh {
        layer: layer.name.clone(),
        source,
    })
}

/// Every face's compression on the surface that asks most of it.
fn face_drivers(
    poisson: f64,
    properties: &SkinProperties,
    skin: &SkinMesh,
    below: &[BelowSurface],
) -> PerFace<FaceDriver> {
    let unloaded = |local: &LocalSkin| FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: local.wrinkling.wavelength,
        critical_strain: local.wrinkling.critical_strain,
        poisson,
    };
    let faces = properties.faces.as_slice().iter();
    let mut drivers: PerFace<FaceDriver> = faces.map(unloaded).collect();
    let mut largest = PerFace::filled(drivers.len(), f64::NEG_INFINITY);
    for surface in below {
        for (face, strain) in offered_strains(skin, surface).iter() {
            let effective = strain.effective(poisson);
            if effective > largest[face] {
                largest[face] = effective;
                drivers[face].compression = in_space(skin, face, strain);
            }
        }
    }
    drivers
}

/// The compression `I - U` of a face as a tensor in space.
fn in_space(skin: &SkinMesh, face: FaceId, strain: &FaceStrain) -> Matrix3<f64> {
    let corners = skin.mesh.faces()[face].map(|v| skin.rest.positions[v.index()]);
    let [u, v] = rest_frame(corners);
    let first = u * strain.direction.x + v * strain.direction.y;
    let second = v * strain.direction.x - u * strain.direction.y;
    first * first.transpose() * strain.first + second * second.transpose() * strain.second
}
