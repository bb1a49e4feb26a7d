//! The figures and tables of Li 2014 and of Rémillard and Kry 2013, drawn from this project's own
//! scenes: `cargo xtask validate figures`.
//!
//! Every scene goes through the command `ruga simulate`, as a user's would. Of each pose's last
//! load step come two pictures of the top layer: shaded skin, and its mesh in material space
//! coloured by strain (blue is stretched, red is compressed, against the mesh at rest); of all of them a
//! table of times.

#![allow(
    clippy::print_stdout,
    reason = "what was found is what the program is for"
)]

mod mesh_picture;
mod run;
mod skin_picture;
mod surface;
mod timing;

#[cfg(test)]
mod tests;

use std::error::Error;
use std::fs;
use std::path::Path;

use clap::Parser;
use ruga_io::{PoseReport, Report};
use ruga_validation::{Drawing, asset};

use self::run::Run;
use self::surface::{Material, Surface};
use self::timing::{Timing, reference};

/// Scenes below `assets/`, in the order of the figures that they stand for.
const SCENES: [&str; 17] = [
    // Figure 3-3.
    "scale/reference.toml",
    "scale/thin.toml",
    "scale/stiff.toml",
    "scale/thin-stiff.toml",
    // Figure 6-1 (and 4-1, whose property map is the thickness).
    "heterogeneous/stiffness.toml",
    "heterogeneous/thickness.toml",
    "heterogeneous/two-layers.toml",
    // Figure 6-3.
    "layers/one.toml",
    "layers/two.toml",
    // Figure 6-4, with one layer and with two.
    "forearm/scene.toml",
    "forearm/two-layers.toml",
    // Beyond the thesis: a curved surface.
    "finger/scene.toml",
    // Rémillard and Kry 2013: figure 8, left and right, 7, the bar of figure 3, and muscles as in 9.
    "slab/biaxial.toml",
    "pillow/scene.toml",
    "slab/isocontour.toml",
    "bar/scene.toml",
    "finger/muscles.toml",
];

/// Simulates, draws, and prints the table.
fn main() -> Result<(), Box<dyn Error>> {
    let wanted = Drawing::parse();
    fs::create_dir_all(&wanted.folder)?;
    let mut timings = Vec::new();
    for scene in SCENES {
        timings.extend(figure(scene, &wanted)?);
    }
    let text = timing::text(&timings);
    fs::write(wanted.folder.join("timing.txt"), &text)?;
    print!("\n{text}");
    println!("\nPictures and table are in {}", wanted.folder.display());
    Ok(())
}

/// Simulates a scene, unless that is done, and draws its poses; gives a row of the table for each.
fn figure(scene: &str, wanted: &Drawing) -> Result<Vec<Timing>, Box<dyn Error>> {
    let name = name_of(scene);
    let results = wanted.folder.join("runs").join(&name);
    let path = asset(scene);
    if !wanted.redraw
        && let Run::Refused(reason) = run::simulate(&path, &results, wanted.quick)?
    {
        println!("{name}: skipped; {reason}");
        return Ok(Vec::new());
    }
    let report: Report = serde_json::from_slice(&fs::read(results.join("report.json"))?)?;
    draw(&name, &path, &report, &wanted.folder)?;
    let row = |pose| Timing::of(&name, pose, reference(&name, &pose.name));
    Ok(report.poses.iter().map(row).collect())
}

/// The scene's folder, and its own name where that says more than `scene`.
fn name_of(scene: &str) -> String {
    scene
        .trim_end_matches(".toml")
        .trim_end_matches("/scene")
        .replace('/', "-")
}

/// Two pictures for every pose of a finished run.
fn draw(name: &str, scene: &Path, report: &Report, folder: &Path) -> Result<(), Box<dyn Error>> {
    let material = Material::read(scene)?;
    for pose in &report.poses {
        let title = format!("{name}-{}", pose.name);
        let results = folder.join("runs").join(name);
        let Some(top) = Top::read(&results, pose)? else {
            println!("{title}: nothing wrinkles, nothing to draw");
            continue;
        };
        skin_picture::draw(&top.skin, &material.rest(&top.skin)?)?
            .write(&folder.join(format!("{title}-skin.png")))?;
        let strains = material.strains(&top.mesh)?;
        let full_colour = mesh_picture::full_colour(&top.mesh, &strains, top.least_full_colour);
        mesh_picture::draw(&top.mesh, &strains, full_colour)?
            .write(&folder.join(format!("{title}-mesh.png")))?;
        println!("{title}: {}", findings(pose, full_colour));
    }
    Ok(())
}

/// What was drawn, in a line: wavelengths measured and predicted, bottom layer first.
fn findings(pose: &PoseReport, full_colour: f64) -> String {
    let mut line = String::new();
    for layer in &pose.layers {
        let length = |metres: Option<f64>| {
            metres.map_or("none".to_owned(), |metres| {
                format!("{:.2} mm", 1e3 * metres)
            })
        };
        let found = length(layer.wavelength_m);
        let predicted = length(layer.wavelength_predicted_m);
        line += &format!("{} every {found} (predicted {predicted}), ", layer.name);
    }
    line += &format!("full red {:.1} % compression", 100.0 * full_colour);
    if !pose.converged {
        line += ", NOT CONVERGED";
    }
    line
}

/// The top layer at the end of a pose.
struct Top {
    /// Its smooth surface.
    skin: Surface,
    /// The mesh that it was computed on.
    mesh: Surface,
    /// No less strain than this is drawn in full colour: half more than that at which the layer
    /// begins to wrinkle, which wrinkled skin keeps on average.
    least_full_colour: f64,
}

impl Top {
    /// Reads the last load step; `None` when there is none.
    fn read(results: &Path, pose: &PoseReport) -> Result<Option<Self>, Box<dyn Error>> {
        let Some(layer) = pose.layers.last() else {
            return Ok(None);
        };
        let Some(file) = run::last_frame(results, &pose.name, &layer.name)? else {
            return Ok(None);
        };
        let computed = format!("meshes/{}/{}.obj", pose.name, layer.name);
        Ok(Some(Self {
            mesh: Surface::read(&results.join(computed))?.without_torn()?,
            skin: Surface::read(&file)?,
            least_full_colour: 1.5 * layer.critical_strain_predicted.unwrap_or(0.05),
        }))
    }
}
