//! T7 and T8: meshes too coarse, and triangles that hardly are any.

use std::f64::consts::SQRT_2;
use std::sync::Arc;

use nalgebra::Vector2;
use ruga_blend::{Driver, Smoothing};
use ruga_shell::ShellError;
use ruga_stepper::{BendingModel, Coupling, Modelling, PoseResult, StepperError};
use ruga_validation::{FilmSpec, Finding, FlatFilm, Strip, table_line};

use crate::{
    compressed, draft, exact, patch, patch_mesh, placed_patch, planned, simulated_on, skin,
};

/// Wavelength and amplitude over theory's at 2 critical strains with so many points per wavelength.
fn on_coarse_mesh(coupling: Coupling, bending: BendingModel, points: u32) -> [f64; 2] {
    let mut film = FlatFilm {
        waves: [6.0, 6.0],
        load: 2.0,
        // Two halvings make a uniform mesh of these.
        squares: 0.25 * SQRT_2 * f64::from(points),
        ..FlatFilm::new(150.0)
    };
    film.layer.coupling = coupling;
    let modelling = Modelling {
        points_per_wavelength: f64::from(points),
        remesh: None,
        bending,
        ..Modelling::default()
    };
    let (_, states) = film.states(&modelling, &[2.0]);
    [states[0].relative_wavelength, states[0].relative_amplitude]
}

#[test]
fn t7_coarse_meshes() {
    let test = "T7 3 to 8 points per lam";
    let points = [3, 4, 6, 8];
    let told = |found: &[[f64; 2]; 4]| {
        let words = points.iter().zip(found);
        let words = words.map(|(points, [lam, a])| format!("{points}: lam {lam:.2} A {a:.2}"));
        words.collect::<Vec<_>>().join("; ")
    };
    let found =
        points.map(|points| on_coarse_mesh(Coupling::Constraint, BendingModel::Hinge, points));
    // Too high, and waves too short, on all of them.
    for coarse in &found {
        assert!(coarse[1] > 1.1 && coarse[0] < 0.92, "{found:?}");
    }
    table_line(test, "papers: rows alone", Finding::Fails, &told(&found));

    let found = points
        .map(|points| on_coarse_mesh(Coupling::Hybrid, BendingModel::VertexCurvature, points));
    // Three is the smallest number of points a scene may ask for.
    let bounds = [(0.15, 1.3), (0.1, 1.15), (0.05, 1.06), (0.03, 1.06)];
    for ([wavelength, amplitude], (off, most)) in found.iter().zip(bounds) {
        assert!((wavelength - 1.0).abs() < off, "{found:?}");
        assert!((0.93..most).contains(amplitude), "{found:?}");
    }
    table_line(test, "ruga", Finding::Bounded, &told(&found));

    let few = Modelling {
        vertex_budget: 100,
        ..draft()
    };
    let warnings = planned(&patch(0.12), &skin(), &few).warnings;
    assert!(warnings.iter().any(|w| w.contains("stops refinement at")));
    let asked = Modelling {
        points_per_wavelength: 3.0,
        ..draft()
    };
    let warnings = planned(&patch(0.12), &skin(), &asked).warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("points_per_wavelength asks for"))
    );
    let numbers = "warns of fewer than 5 points asked for, and of a budget that leaves fewer";
    table_line(test, "ruga: planner", Finding::Warns, numbers);
}

/// Puts a vertex beside the middle of one edge of every twelfth face, `height` edges off it.
fn add_slivers(points: &mut Vec<Vector2<f64>>, faces: &mut Vec<[u32; 3]>, height: f64) {
    for (number, [a, b, c]) in std::mem::take(faces).into_iter().enumerate() {
        if number % 12 != 6 {
            faces.push([a, b, c]);
            continue;
        }
        let [p, q] = [a, b].map(|v| points[v as usize]);
        let new = points.len() as u32;
        let aside = Vector2::new(p.y - q.y, q.x - p.x);
        points.push(0.5 * (p + q) + height * aside);
        faces.extend([[a, b, new], [b, c, new], [c, a, new]]);
    }
}

/// A patch whose artist left slivers of this height in edges, or none.
fn sliver_driver(height: Option<f64>) -> Arc<Driver> {
    let (mut points, mut triangles) = patch_mesh();
    if let Some(height) = height {
        add_slivers(&mut points, &mut triangles, height);
    }
    placed_patch(&points, &triangles, |p| *p)
}

fn with_slivers(height: Option<f64>, modelling: &Modelling) -> Result<PoseResult, StepperError> {
    simulated_on(&sliver_driver(height), &skin(), modelling, 4)
}

/// Heights of slivers in edges: aspect 50; an angle of 170 degrees; area of a millionth.
const HEIGHTS: [f64; 3] = [0.02, 0.0437, 2e-6];

#[test]
fn t8_slivers_of_the_artist() {
    let test = "T8 aspect 50, 170 degrees, area 1e-6";
    let facets = Modelling {
        smoothing: Smoothing::None,
        ..draft()
    };
    // On facets, at draft quality, a sliver may decide for half a wave more.
    for (name, modelling, tolerance, finding) in [
        ("ruga", &draft(), 0.05, Finding::Holds),
        ("ruga: facets", &facets, 0.2, Finding::Bounded),
    ] {
        let plain = with_slivers(None, modelling).expect("a patch");
        let errors = HEIGHTS.map(|height| {
            let made = with_slivers(Some(height), modelling).expect("a patch");
            assert!(made.converged, "{:?}", made.warnings);
            made.layers[0].energy / plain.layers[0].energy - 1.0
        });
        assert!(
            errors.iter().all(|error| error.abs() < tolerance),
            "{errors:?}"
        );
        let [a, b, c] = errors.map(|error| 100.0 * error);
        let numbers = format!("in the artist's mesh, remeshed: energy {a:+.1}, {b:+.1}, {c:+.1} %");
        table_line(test, name, finding, &numbers);
    }
    let as_drawn = Modelling {
        remesh: None,
        ..facets
    };
    let refusal = with_slivers(Some(1e-7), &as_drawn);
    assert!(matches!(
        refusal,
        Err(StepperError::Shell {
            source: ShellError::DegenerateFace { .. },
            ..
        })
    ));
    let numbers = "area under 1e-6 of an edge squared: refused, by face";
    table_line(test, "ruga: no remesh, facets", Finding::Warns, numbers);
}

/// The hinges of a sliver are as stiff as the inverse square of its height. From 3e-4 of an edge
/// down, the regularisation of the KKT matrix, a share of its *mean* diagonal, exceeds the negative
/// stiffness by which a saddle is known.
#[test]
fn t8_slivers_in_the_computed_mesh() {
    let test = "T8 slivers in the computed mesh";
    let spec = FilmSpec::flat(150.0);
    let strip = spec.strip(4.0, 8);
    let run = |strip: &Strip| {
        let mut sheet = compressed(&spec, strip, 2.0, 0.0, 1);
        let solve = sheet.solve(&exact());
        (sheet.gap(), solve)
    };
    let gap = run(&strip).0;
    let with = |height: f64| {
        let mut made = strip.clone();
        add_slivers(&mut made.points, &mut made.faces, height);
        let (with, solve) = run(&made);
        (with / gap - 1.0, solve)
    };
    let errors = [(0.0437, 0.05), (0.02, 0.05), (1e-3, 0.1)].map(|(height, tolerance)| {
        let (error, solve) = with(height);
        assert!(
            solve.converged && error.abs() < tolerance,
            "{height}: {error}"
        );
        100.0 * error
    });
    let [a, b, c] = errors;
    let numbers =
        format!("height 0.04, 0.02, 0.001 of an edge: energy gap {a:+.1}, {b:+.1}, {c:+.1} %");
    table_line(test, "ruga", Finding::Bounded, &numbers);
    let (error, solve) = with(2.1e-6);
    assert!(solve.converged && error.abs() < 0.1, "{error}");
    let numbers = format!("energy gap {:+.1} %", 100.0 * error);
    table_line(test, "ruga: area 1e-6", Finding::Bounded, &numbers);
    table_line(
        test,
        "papers",
        Finding::NotApplicable,
        "the same hinge on slivers",
    );
}
