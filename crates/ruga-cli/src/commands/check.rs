//! `ruga check`: everything that can be known without simulating.

use std::path::Path;
use std::sync::Arc;

use ruga_blend::Driver;
use ruga_io::{MeshFile, Scene};
use ruga_stepper::{LayerSpec, PoseSpec, Region};

use crate::arguments::CheckArguments;
use crate::error::{CliError, counted};
use crate::project::{self, Project};
use crate::run::Outcome;
use crate::{mesh_size, messages, model, texture_space};

/// Prints what was found and OK, or every problem.
///
/// # Errors
/// [`CliError::Problems`] once all of them have been printed; the scene's own error when it cannot
/// be read at all.
pub(crate) fn run(arguments: &CheckArguments) -> Result<Outcome, CliError> {
    let path = arguments.scene.as_path();
    let scene = Scene::read(path)?;
    let mut findings = Findings::default();
    let parts = findings.parts(&scene, path);
    if let Some(project) = parts.filter(|_| findings.problems.is_empty()) {
        let planned = project.plan();
        if let Some(plan) = findings.keep(planned) {
            findings.warnings.extend(plan.warnings().cloned());
        }
    }
    for line in &findings.lines {
        messages::result(line);
    }
    messages::warnings(&findings.warnings, "`ruga plan --json` lists all");
    let count = findings.problems.len();
    findings.problems.into_iter().for_each(messages::error);
    if count > 0 {
        return Err(CliError::Problems {
            scene: path.to_owned(),
            count,
        });
    }
    messages::result("OK");
    Ok(Outcome::Done)
}

#[derive(Default)]
struct Findings {
    lines: Vec<String>,
    warnings: Vec<String>,
    problems: Vec<CliError>,
}

impl Findings {
    /// The value, or nothing and one more problem.
    fn keep<T>(&mut self, result: Result<T, CliError>) -> Option<T> {
        result.map_err(|error| self.problems.push(error)).ok()
    }

    /// Looks at every part of the scene, whatever is wrong with the others.
    fn parts(&mut self, scene: &Scene, path: &Path) -> Option<Project> {
        let refused = model::bending_without_layer(scene, path);
        self.problems.extend(refused);
        let layers = self.keep(model::layers(scene, path));
        let region = self.keep(project::region(scene));
        let masks = region.as_ref().map(|_| project::mask_warnings(scene, path));
        let masks = masks.and_then(|masks| self.keep(masks));
        self.warnings.extend(masks.into_iter().flatten());
        let mesh = self.keep(project::artist_mesh(scene));
        let driver = mesh
            .as_ref()
            .and_then(|mesh| self.keep(project::driver(mesh)));
        if let Some(warnings) = mesh
            .as_ref()
            .and_then(|m| self.keep(texture_space::check(m)))
        {
            self.warnings.extend(warnings);
        }
        let poses = driver
            .as_ref()
            .and_then(|driver| self.keep(model::poses(scene, driver, &[], path)));
        self.describe(scene, layers.as_deref(), region.as_ref(), poses.as_deref());
        let (mesh, driver) = (mesh?, driver?);
        self.describe_mesh(&mesh, &driver);
        let warnings = project::mesh_warnings(&mesh, &driver);
        self.warnings.extend(warnings);
        let (layers, mut poses) = (layers?, poses?);
        project::set_motions(scene, &mesh, &mut poses);
        let weights = model::weight_warnings(scene, &poses);
        self.warnings.extend(weights);
        let size = self.keep(mesh_size::check(scene, &mesh, &layers));
        self.warnings.extend(size.flatten());
        Some(Project {
            path: path.to_owned(),
            modelling: model::modelling(scene, region?, None),
            body: project::body_of(scene, &mesh, &layers),
            scene: scene.clone(),
            mesh,
            driver: Arc::new(driver),
            layers,
            poses,
            warnings: Vec::new(),
        })
    }

    fn describe(
        &mut self,
        scene: &Scene,
        layers: Option<&[LayerSpec]>,
        region: Option<&Region>,
        poses: Option<&[PoseSpec]>,
    ) {
        if let Some(poses) = poses {
            let keys: usize = poses.iter().map(|pose| pose.keys.len()).sum();
            let maps = counted(keys * scene.bake.maps.len(), "map");
            let poses = counted(poses.len(), "pose");
            self.lines.push(format!("poses: {poses}, {maps}"));
        }
        for layer in layers.into_iter().flatten() {
            let material = &layer.material;
            self.lines.push(format!(
                "layer `{}`: {:.4} MPa, {:.3} mm thick",
                layer.name,
                material.young / 1e6,
                1e3 * material.thickness
            ));
        }
        if let Some(region) = region {
            self.lines
                .push(format!("region: {}", region_words(region, scene)));
        }
    }

    fn describe_mesh(&mut self, mesh: &MeshFile, driver: &Driver) {
        self.lines.push(format!(
            "mesh `{}`: {} vertices ({} after welding), {}, {}",
            driver.name(),
            mesh.mesh.positions.len(),
            driver.rest().len(),
            counted(mesh.mesh.triangles.len(), "triangle"),
            counted(driver.shape_names().len(), "blend shape"),
        ));
    }
}

fn region_words(region: &Region, scene: &Scene) -> String {
    match region {
        Region::Auto if scene.interior.is_none() => {
            "where the poses compress the skin enough".to_owned()
        }
        Region::Auto | Region::All => "everywhere".to_owned(),
        Region::Mask(mask) => {
            let white = mask.values().iter().filter(|value| **value >= 0.5).count();
            let share = 100.0 * white as f64 / mask.values().len().max(1) as f64;
            format!(
                "a mask of {} x {} texels, {share:.0} % white",
                mask.width(),
                mask.height()
            )
        }
    }
}
