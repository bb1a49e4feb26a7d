//! The meshes of a layer on a body.

use nalgebra::Matrix3;
use ruga_remesh::{FaceDriver, Refinement, RemeshSettings, SizeLimits};

use crate::error::Halt;
use crate::local_skin::{LocalSkin, SkinProperties};
use crate::preparing::Preparing;
use crate::skin_mesh::{MeshDemand, RegionMesh, SkinMesh};
use crate::{LayerPlan, Plan, StepperError};

/// The mesh that results are handed out on, and the uniform one to compute on where it is another.
pub(super) fn meshes(
    plan: &Plan,
    layer: &LayerPlan,
    preparing: &mut Preparing<'_>,
) -> Result<(RegionMesh, Option<SkinMesh>), Halt> {
    let (driver, modelling) = (&plan.driver, &plan.modelling);
    let (spec, wrinkling) = (&plan.stacking.specs[0], &plan.stacking.simulated[0]);
    let base = preparing.while_wanted(|goes_on| plan.layer_surface(layer, goes_on))?;
    let on = (&base, modelling.smoothing, 0.0);
    let region = RegionMesh::new(driver, spec, on, &mut || preparing.goes_on())?;
    let Some(limits) = modelling.remesh else {
        return Ok((region, None));
    };
    let properties = SkinProperties::new(spec, wrinkling, None, driver, &region.skin)?;
    let unloaded = |local: &LocalSkin| FaceDriver {
        compression: Matrix3::zeros(),
        wavelength: local.wrinkling.wavelength,
        critical_strain: local.wrinkling.critical_strain,
        poisson: spec.material.poisson,
    };
    let edge = |local: &LocalSkin| {
        let edge = local.wrinkling.wavelength / modelling.points_per_wavelength;
        edge.clamp(limits.min_edge, limits.max_edge)
    };
    let longest: Vec<f64> = properties.vertices.iter().map(edge).collect();
    let demand = MeshDemand {
        drivers: &properties.faces.as_slice().iter().map(unloaded).collect(),
        longest: &longest,
        aspects: &vec![f64::INFINITY; longest.len()],
        refinement: Refinement {
            angle: f64::INFINITY,
            points_per_wavelength: modelling.points_per_wavelength,
            ..Refinement::default()
        },
        budget: modelling.vertex_budget,
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
    preparing.step()?;
    let adapted = region.adapted(driver, &demand, &settings, &mut || preparing.goes_on());
    let adapted = adapted.map_err(|source| StepperError::Remesh {
        layer: spec.name.clone(),
        source,
    })?;
    let adapted = adapted.ok_or(Halt::Interrupted)?;
    Ok((region, Some(adapted.skin)))
}
