//! Numbers of a scene that are out of range.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::scenes::{parse, refused, with};
use fixture::{SCENE, assert_says};

#[test]
fn numbers_out_of_range() {
    refused(
        "version = 1",
        "version = 2",
        &["version", "found 2", "version 1"],
    );
    for bad in ["-1e-3", "0.0", "nan", "inf"] {
        let new = format!("thickness = {bad}");
        refused(
            "thickness = 1.3e-3",
            &new,
            &["layers[0].thickness", "above 0"],
        );
        refused(
            "thickness = 15e-3",
            &new,
            &["substrate.thickness", "above 0"],
        );
    }
    for bad in ["0.5", "-1.0", "nan", "0.7"] {
        let new = format!("young = 4e6\npoisson = {bad}");
        refused(
            "young = 4e6\npoisson = 0.48",
            &new,
            &["layers[0].poisson", "-1", "0.5"],
        );
        let new = format!("young = 0.5e6\npoisson = {bad}");
        refused(
            "young = 0.5e6\npoisson = 0.48",
            &new,
            &["substrate.poisson"],
        );
    }
    for bad in ["0.0", "1.5", "-0.5", "nan"] {
        let new = format!("keys = [{bad}]");
        refused(
            "keys = [0.5, 1.0]",
            &new,
            &[
                "poses[0].keys[0]",
                "a fraction above 0, up to 1; 0.5 is half way",
            ],
        );
    }
    refused(
        "keys = [0.5, 1.0]",
        "keys = [50, 100]",
        &["poses[0].keys[0]", "did you mean `0.5`"],
    );
    let design = "wavelength = 5e-3\ncritical_strain = 5.0";
    let text = SCENE
        .replacen("thickness = 1.3e-3\n", "", 1)
        .replacen("young = 4e6", design, 1);
    let words = [
        "layers[0].critical_strain",
        "above 0 and below 1",
        "did you mean `0.05`",
    ];
    assert_says(parse(&text), "scene.toml", &words);
    refused(
        "keys = [0.5, 1.0]",
        "keys = [1.0, 1.0]",
        &["poses[0].keys[1]"],
    );
    refused("keys = [0.5, 1.0]", "keys = []", &["poses[0].keys"]);
    refused("steps = 20", "steps = 0", &["poses[0].steps", "from 1"]);
    refused(
        "compress = 1.0",
        "compress = inf",
        &["poses[0].weights.compress", "finite"],
    );
    refused("size = 2048", "size = 15", &["bake.size", "16 to 16384"]);
    refused("size = 2048", "size = 20000", &["bake.size"]);
    refused(
        "supersample = 1",
        "supersample = 3",
        &["bake.supersample", "1, 2 or 4"],
    );
    refused(
        "maps = [\"normal\", \"height\"]",
        "maps = []",
        &["bake.maps"],
    );
    refused("\"height\"]", "\"normal\"]", &["bake.maps[1]", "once"]);
    refused("tolerance = 1e-6", "tolerance = 1.0", &["solver.tolerance"]);
    refused("time_step = 0.02", "time_step = 0", &["solver.time_step"]);
    refused("damping = 0.5", "damping = -0.5", &["solver.damping"]);
    refused(
        "min_edge = 0.0",
        "min_edge = 2.0",
        &["remesh.min_edge", "max_edge = 1"],
    );
    for bad in ["1.0", "nan"] {
        let new = format!("min_edge = {bad}");
        refused("min_edge = 0.0", &new, &["remesh.min_edge", "found"]);
    }
    refused(
        "max_edge = 1.0",
        "max_edge = 0.0",
        &["remesh.max_edge", "found 0", "above 0"],
    );
    for bad in ["0.5", "4.5", "nan", "inf"] {
        let new = format!("aspect = {bad}");
        refused("aspect = 4.0", &new, &["remesh.aspect", "from 1 to 4"]);
    }
    assert!(with("aspect = 4.0", "aspect = 2.0").is_ok());
    for bad in ["2.9", "-12", "nan", "inf"] {
        let new = format!("points_per_wavelength = {bad}");
        refused(
            "points_per_wavelength = 12",
            &new,
            &["remesh.points_per_wavelength", "a number from 3"],
        );
    }
    assert!(with("points_per_wavelength = 12", "points_per_wavelength = 3").is_ok());
    for bad in ["nan", "inf"] {
        let new = format!("damping = {bad}");
        refused("damping = 0.5", &new, &["solver.damping", "from 0"]);
        let new = format!("time_step = {bad}");
        refused("time_step = 0.02", &new, &["solver.time_step", "above 0"]);
    }
    refused("cells = 6", "cells = 0", &["interior.cells"]);
    refused(
        "density = 1100.0",
        "bending_transfer = 1.5",
        &["layers[0].bending_transfer"],
    );
    for bad in ["-0.1", "nan"] {
        let new = format!("bending_transfer = {bad}");
        refused(
            "density = 1100.0",
            &new,
            &["layers[0].bending_transfer", "from 0 to 1"],
        );
    }
    // Ranges that would make a property zero or negative, or infinite.
    for property in ["wavelength", "young", "thickness"] {
        let old = format!("{property} = [0.5, 2.0]");
        for (range, end) in [("[0, 2.0]", 0), ("[0.5, -1.0]", 1), ("[0.5, inf]", 1)] {
            let key = format!("layers[0].map.{property}[{end}]");
            refused(
                &old,
                &format!("{property} = {range}"),
                &[&key, "found", "above 0"],
            );
        }
    }
    refused(
        "smoothing = \"loop\"",
        "vertex_budget = 0",
        &["driver.vertex_budget"],
    );
}
