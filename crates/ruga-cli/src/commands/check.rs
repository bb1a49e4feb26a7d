//! `ruga check`: everything that can be known without simulating.

use ruga_scene::{Inspection, SceneFile, SceneOptions, are_tiled, counted};
use ruga_stepper::Region;

use super::plan::plies;
use crate::arguments::CheckArguments;
use crate::error::CliError;
use crate::messages;
use crate::outcome::Outcome;
use crate::tile_numbers::tile_numbers;

/// Prints what was found and OK, or every problem.
///
/// # Errors
/// [`CliError::Problems`] once all of them have been printed; the scene's own error when it cannot
/// be read at all.
pub(crate) fn run(arguments: &CheckArguments) -> Result<Outcome, CliError> {
    let path = arguments.scene.as_path();
    let mut inspection = Inspection::new(path, &SceneOptions::default())?;
    let lines = description(&inspection);
    let mut warnings = std::mem::take(&mut inspection.warnings);
    let mut problems = std::mem::take(&mut inspection.problems);
    if problems.is_empty() {
        match inspection.into_scene().and_then(|scene| scene.plan()) {
            Ok(plan) => warnings.extend(plan.warnings().cloned()),
            Err(problem) => problems.push(problem),
        }
    }
    for line in &lines {
        messages::result(line);
    }
    messages::warnings(&warnings, "`ruga plan --json` lists all");
    let count = problems.len();
    for problem in problems {
        messages::error(problem.into());
    }
    if count > 0 {
        return Err(CliError::Problems {
            scene: path.to_owned(),
            count,
        });
    }
    messages::result("OK");
    Ok(Outcome::Done)
}

/// A line for each part that could be read.
fn description(found: &Inspection) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(poses) = &found.poses {
        let keys: usize = poses.iter().map(|pose| pose.keys.len()).sum();
        let maps = counted(keys * found.file.bake.maps.len(), "map");
        lines.push(format!("poses: {}, {maps}", counted(poses.len(), "pose")));
    }
    for layer in found.layers.iter().flatten() {
        let material = &layer.material;
        let as_stiff = match &layer.laminate {
            None => String::new(),
            Some(laminate) => format!("{}, as stiff as ", plies(laminate)),
        };
        lines.push(format!(
            "layer `{}`: {as_stiff}{:.4} MPa, {:.3} mm thick",
            layer.name,
            material.young / 1e6,
            1e3 * material.thickness
        ));
    }
    let creases = found.layers.iter().flatten().map(|layer| &layer.creases);
    let creases: Vec<f64> = creases
        .flatten()
        .map(|crease| crease.line.length())
        .collect();
    if !creases.is_empty() {
        lines.push(format!(
            "creases: {}, {:.0} mm in all",
            counted(creases.len(), "line"),
            1e3 * creases.iter().sum::<f64>()
        ));
    }
    if let Some(region) = &found.region {
        lines.push(format!("region: {}", region_words(region, &found.file)));
    }
    if let Some((mesh, driver)) = &found.mesh {
        lines.push(format!(
            "mesh `{}`: {} vertices ({} after welding), {}, {}",
            driver.name(),
            mesh.mesh.positions.len(),
            driver.rest().len(),
            counted(mesh.mesh.triangles.len(), "triangle"),
            counted(driver.shape_names().len(), "blend shape"),
        ));
        if are_tiled(&found.tiles) {
            lines.push(format!(
                "texture: {} ({})",
                counted(found.tiles.len(), "UDIM tile"),
                tile_numbers(&found.tiles)
            ));
        }
    }
    lines
}

fn region_words(region: &Region, scene: &SceneFile) -> String {
    match region {
        Region::Auto if scene.interior.is_none() && scene.sheet.is_none() => {
            "where the poses compress the skin enough".to_owned()
        }
        Region::Auto | Region::All => "everywhere".to_owned(),
        Region::Mask(mask) => {
            let described = mask.images().map(|([width, height], values)| {
                let white = values.iter().filter(|value| **value >= 0.5).count();
                let share = 100.0 * white as f64 / values.len().max(1) as f64;
                format!("a mask of {width} x {height} texels, {share:.0} % white")
            });
            described.collect::<Vec<_>>().join("; ")
        }
    }
}
