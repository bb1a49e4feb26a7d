//! Measures what soft bodies under a skin have to show, and writes a line of JSON for each finding as
//! it comes: `cargo xtask bodies` draws them.

#![allow(
    clippy::print_stdout,
    reason = "the findings are what the caller reads"
)]

use std::error::Error;

use ruga_solver::minimise;
use ruga_stepper::{CellShape, Coupling};
use ruga_tests::body::{
    CellLimit, Cushion, Extent, Isocontour, Row, Size, artefact, cell_limit, coupling_name, dense,
    is_compared, isocontours, locality, sizes,
};
use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let extent = match words.iter().any(|word| word == "--quick") {
        true => Extent::Quick,
        false => Extent::Full,
    };
    print_artefact()?;
    print_locality()?;
    cell_limit(extent, &mut print_cells)?;
    let mut samples = Vec::new();
    isocontours(extent, &mut |sample| {
        print_sample(sample);
        samples.push(sample.clone());
    })?;
    print_dense(&samples)?;
    print_thrown(extent)?;
    sizes(extent, &mut print_size)
}

/// Lengths of a step in time, s.
const TIME_STEPS: [f64; 3] = [0.005, 0.02, 0.05];

fn print_thrown(extent: Extent) -> Result<(), Box<dyn Error>> {
    for time_step in TIME_STEPS {
        let cushion = Cushion {
            scale: 1.0,
            thickness: 1.2e-3,
            ratio: 1000.0,
            cells: 3,
            points: 5.0,
            coupling: Coupling::Hybrid,
            time_step,
            steps: match extent {
                Extent::Full => 1000,
                Extent::Quick => 50,
            },
            minimise,
        };
        let own = cushion.throw()?;
        let line = json!({
            "part": "thrown",
            "time_step_s": time_step,
            "steps": cushion.steps,
            "frames": own.frames,
            "outside": own.outside,
            "heights": own.heights,
            "factorizations": own.report.factorizations,
            "converged": own.converged,
            "seconds": own.times.frame_s.iter().sum::<f64>(),
        });
        println!("{line}");
    }
    Ok(())
}

fn print_size(own: &Size) {
    let row = |row: &Row| json!({ "counts": row.counts, "seconds": row.seconds });
    let line = json!({
        "part": "size",
        "body": own.body.kind.name(),
        "thickness_m": own.body.thickness,
        "ratio": own.body.ratio,
        "paper": row(&own.paper),
        "own": row(&own.own),
        "iterations": own.iterations,
        "factorizations": own.factorizations,
        "converged": own.converged,
    });
    println!("{line}");
}

fn print_sample(own: &Isocontour) {
    let line = json!({
        "part": "isocontours",
        "coupling": coupling_name(own.coupling),
        "thickness_m": own.sample.thickness,
        "ratio": own.sample.ratio,
        "predicted_m": own.predicted,
        "measured_m": own.measured,
        "reported_m": own.reported,
        "errors": own.errors(),
        "demand": own.demand,
        "amplitude": own.amplitude,
        "depth_m": own.depth,
        "vertices": own.vertices,
        "converged": own.converged,
        "seconds": own.seconds,
    });
    println!("{line}");
}

fn print_cells(own: &CellLimit) {
    let line = json!({
        "part": "cell limit",
        "cell": own.cell,
        "errors": own.found.errors(),
        "demand": own.found.demand,
        "converged": own.found.converged,
        "seconds": own.found.seconds,
    });
    println!("{line}");
}

fn print_dense(samples: &[Isocontour]) -> Result<(), Box<dyn Error>> {
    let compared = samples
        .iter()
        .filter(|own| own.coupling == Coupling::Hybrid && is_compared(own.sample));
    for own in compared {
        let both = dense(own)?;
        let line = json!({
            "part": "dense",
            "thickness_m": own.sample.thickness,
            "ratio": own.sample.ratio,
            "volume_m": both.volume,
            "volume_onset": both.onset,
            "embedded_m": both.embedded,
            "error": both.error(),
        });
        println!("{line}");
    }
    Ok(())
}

fn print_artefact() -> Result<(), Box<dyn Error>> {
    for own in artefact()? {
        let shape = match own.shape {
            CellShape::Linear => "linear",
            CellShape::Quadratic => "quadratic",
        };
        let line = json!({
            "part": "artefact",
            "shape": shape,
            "energy": own.energy,
            "angle_deg": own.angle_deg,
            "demand": own.demand,
            "profile": own.profile,
        });
        println!("{line}");
    }
    Ok(())
}

fn print_locality() -> Result<(), Box<dyn Error>> {
    for own in locality()? {
        let line = json!({
            "part": "locality",
            "coupling": coupling_name(own.coupling),
            "outside": own.outside,
            "amplitude": own.amplitude,
            "converged": own.converged,
            "bent": own.bent,
            "profile": own.profile,
        });
        println!("{line}");
    }
    Ok(())
}
