//! Meshes that are fine only where, and in the direction that, a pose compresses the skin.

use nalgebra::Matrix3;
use ruga_blend::{Driver, face_strains};
use ruga_material::Wrinkling;
use ruga_mesh::{Id, PerFace};
use ruga_remesh::{FaceDriver, Refinement, RemeshSettings, SizeLimits, face_compression};

use crate::local_skin::{LocalSkin, SkinProperties};
use crate::skin_mesh::{RegionMesh, SkinMesh};
use crate::{LayerSpec, Modelling, PoseSpec, StepperError};

/// Longest edge where nothing wrinkles, in wavelengths: the low-pass rows, which reach further,
/// still see a smooth average.
pub(crate) const COARSEST: f64 = 0.5;

/// The region's mesh fitted to the keys of a pose; `None` where meshes are to stay uniform.
pub(crate) fn adapted(
    driver: &Driver,
    layer: &LayerSpec,
    wrinkling: &Wrinkling,
    region: &RegionMesh,
    pose: &PoseSpec,
    modelling: &Modelling,
) -> Result<Option<SkinMesh>, StepperError> {
    let Some(limits) = modelling.remesh else {
        return Ok(None);
    };
    let properties = SkinProperties::new(layer, wrinkling, driver, &region.skin)?;
    let drivers = face_drivers(driver, layer, &properties, &region.skin, pose);
    let refinement = Refinement {
        points_per_wavelength: modelling.points_per_wavelength,
        ..Refinement::default()
    };
    let settings = RemeshSettings {
        limits: SizeLimits {
            min_edge: limits.min_edge,
            max_edge: limits.max_edge.min(COARSEST * wrinkling.wavelength),
            aspect: limits.aspect,
            ..SizeLimits::default()
        },
        max_vertices: modelling.vertex_budget,
        ..RemeshSettings::default()
    };
    let adapted = region.adapted(driver, &drivers, refinement, &settings);
    adapted.map(Some).map_err(|source| StepperError::Remesh {
        layer: layer.name.clone(),
        source,
    })
}

/// Every face's compression at the key that asks most of it.
fn face_drivers(
    driver: &Driver,
    layer: &LayerSpec,
    properties: &SkinProperties,
    skin: &SkinMesh,
    pose: &PoseSpec,
) -> PerFace<FaceDriver> {
    let poisson = layer.material.poisson;
    let count = skin.mesh.face_count();
    let mut largest = PerFace::filled(count, f64::NEG_INFINITY);
    let unloaded = |local: &LocalSkin| FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: local.wrinkling.wavelength,
        critical_strain: local.wrinkling.critical_strain,
        poisson,
    };
    let faces = properties.faces.as_slice().iter();
    let mut drivers: PerFace<FaceDriver> = faces.map(unloaded).collect();
    for &key in &pose.keys {
        let posed = skin.points.pose(&driver.pose(&pose.weights.scaled(key)));
        let strains = face_strains(&skin.mesh, &skin.rest.positions, &posed.positions);
        for (face, strain) in strains.iter() {
            let effective = strain.effective(poisson);
            if effective > largest[face] {
                largest[face] = effective;
                let corners = skin.mesh.faces()[face];
                drivers[face].compression = face_compression(
                    corners.map(|v| skin.rest.positions[v.index()]),
                    corners.map(|v| posed.positions[v.index()]),
                );
            }
        }
    }
    drivers
}
