//! Strips that hang, buckle and tip over, and a plate under pressure, against beam and plate theory.

mod meshes;
mod sheets;

use std::f64::consts::PI;

use meshes::Mesh;
use nalgebra::{DMatrix, Vector3};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};
use sheets::{Sheet, equilibrium, factor, free_forces, moved, solve};

const MODELS: [BendingModel; 2] = [BendingModel::Hinge, BendingModel::VertexCurvature];

/// A layer of unit bending modulus.
fn layer(
    mesh: &Mesh,
    model: BendingModel,
    poisson: f64,
    thickness: f64,
    pinned: impl Fn(&Vector3<f64>) -> bool,
) -> LayerEnergy {
    let face = FaceParameters {
        young: 12.0 * (1.0 - poisson * poisson) / thickness.powi(3),
        poisson,
        thickness,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let parameters = LayerParameters::uniform(face, mesh.faces.len(), 0.0, mesh.positions.len());
    let pinned: Vec<_> = mesh.positions.iter().map(pinned).collect();
    LayerEnergy::with_bending(
        &mesh.topology(),
        &mesh.positions,
        parameters,
        &pinned,
        model,
    )
    .expect("a valid sheet")
}

/// A strip of irregular triangles from x = 0 to 1, `aspect` times as long across the strip as along
/// it, and clamped half way between its first two columns.
fn clamped_strip(columns: usize, aspect: f64, rows: usize) -> Sheet {
    let dx = 1.0 / (columns as f64 - 0.5);
    Sheet {
        columns,
        rows,
        dx,
        dy: aspect * dx / 0.75_f64.sqrt(),
        start: -0.5 * dx,
        jitter: 0.25,
    }
}

fn tip(x: &[Vector3<f64>], rest: &[Vector3<f64>]) -> Vector3<f64> {
    let end: Vec<_> = (0..x.len()).filter(|&v| rest[v].x > 1.0 - 1e-9).collect();
    end.iter().map(|&v| x[v]).sum::<Vector3<f64>>() / end.len() as f64
}

/// Sag over reach of a cantilever, and weight `rho h g L^3/D`: the heavy elastica.
const ELASTICA: [(f64, f64); 6] = [
    (0.1, 0.0125),
    (1.0, 0.1246),
    (5.0, 0.5857),
    (20.0, 1.864),
    (50.0, 3.706),
    (100.0, 5.888),
];

/// Ratio of the sag over reach to that of the elastica, for each weight.
fn cantilever(model: BendingModel, aspect: f64, rows: usize) -> Vec<f64> {
    let sheet = clamped_strip(48, aspect, rows);
    let mesh = sheet.mesh(1);
    let layer = layer(&mesh, model, 0.0, 5e-3, |p| p.x < 0.75 * sheet.dx);
    let mut x = mesh.positions.clone();
    ELASTICA
        .iter()
        .map(|&(weight, expected)| {
            let areas = layer.vertex_areas().iter();
            let force: Vec<_> = areas.map(|area| -Vector3::z() * (weight * area)).collect();
            x = equilibrium(&layer, std::mem::take(&mut x), &force);
            let tip = tip(&x, &mesh.positions);
            -tip.z / tip.x / expected
        })
        .collect()
}

#[test]
fn a_cantilever_of_stars_hangs_as_the_elastica_on_any_triangles() {
    for (aspect, rows) in [(1.0, 6), (0.5, 10), (2.0, 4)] {
        let found = cantilever(BendingModel::VertexCurvature, aspect, rows);
        assert!(
            found.iter().all(|ratio| (ratio - 1.0).abs() < 0.02),
            "{aspect}: {found:?}"
        );
    }
}

/// The two borders lack a third of their area: 7 % of six rows.
#[test]
fn a_cantilever_of_hinges_needs_equilateral_triangles() {
    let found = cantilever(BendingModel::Hinge, 1.0, 6);
    assert!(found.iter().all(|r| (r - 1.0).abs() < 0.08), "{found:?}");
    for (aspect, rows, first) in [(0.5, 10, 0.71), (2.0, 4, 1.42)] {
        let found = cantilever(BendingModel::Hinge, aspect, rows);
        assert!((found[0] - first).abs() < 0.04, "{aspect}: {found:?}");
    }
}

/// Largest load at which `stable` holds, to a ten-thousandth.
fn threshold(mut low: f64, mut high: f64, stable: impl Fn(f64) -> bool) -> f64 {
    assert!(stable(low) && !stable(high));
    while high - low > 1e-4 * high {
        let middle = 0.5 * (low + high);
        if stable(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Buckling load of a strip hinged at both ends, over `pi^2 D/L^2`.
fn euler(model: BendingModel, aspect: f64, rows: usize) -> f64 {
    let columns = 30;
    let dx = 1.0 / columns as f64;
    let sheet = Sheet {
        columns,
        rows,
        dx,
        dy: aspect * dx / 0.75_f64.sqrt(),
        start: 0.0,
        jitter: 0.25,
    };
    let mesh = sheet.mesh(2);
    let thickness = 1e-3;
    let ends = |p: &Vector3<f64>| p.x < 1e-9 || p.x > 1.0 - 1e-9;
    let layer = layer(&mesh, model, 0.0, thickness, ends);
    let modulus = 12.0 / (thickness * thickness);
    let load = threshold(1.0, 50.0, |load| {
        let squeezed = |p: &Vector3<f64>| Vector3::new(p.x * (1.0 - load / modulus), p.y, 0.0);
        let x: Vec<_> = mesh.positions.iter().map(squeezed).collect();
        factor(&layer, &x).is_some()
    });
    load / (PI * PI)
}

#[test]
fn a_strip_buckles_at_the_load_of_euler() {
    for (aspect, rows) in [(1.0, 6), (0.5, 10), (2.0, 4)] {
        let found = euler(BendingModel::VertexCurvature, aspect, rows);
        assert!((found - 1.0).abs() < 0.02, "{aspect}: {found}");
    }
    for (aspect, rows, expected) in [(1.0, 6, 0.95), (0.5, 10, 1.6), (2.0, 4, 0.68)] {
        let found = euler(BendingModel::Hinge, aspect, rows);
        assert!((found - expected).abs() < 0.06, "{aspect}: {found}");
    }
}

/// Weight `q L^3/B` at which a narrow strip clamped on edge tips over; `B` is that of a beam.
fn lateral(model: BendingModel, poisson: f64, aspect: f64, rows: usize) -> f64 {
    let sheet = clamped_strip(200, aspect, rows);
    let mesh = sheet.mesh(3);
    // So thin that the sag before tipping is out of the question.
    let layer = layer(&mesh, model, poisson, 2e-5, |p| p.x < 0.75 * sheet.dx);
    let areas = layer.vertex_areas().iter();
    let pull: Vec<_> = areas.map(|&area| -Vector3::y() * area).collect();
    let at_rest = factor(&layer, &mesh.positions).expect("clamped");
    let sag = solve(&at_rest, free_forces(&layer, &pull));
    let load = threshold(1.0, 60.0, |load| {
        factor(&layer, &moved(&layer, &mesh.positions, &sag, load)).is_some()
    });
    load / (1.0 - poisson * poisson)
}

/// `12.853 sqrt(C/B)` with `C/B = 2/(1 + nu)`; a width of 0.03 adds 1 %, the borders of six rows 2.
#[test]
fn a_strip_on_edge_tips_over_by_its_poisson_ratio() {
    for (poisson, aspect, rows) in [(0.0, 2.0, 4), (0.3, 1.0, 6), (0.3, 0.5, 12), (0.48, 1.0, 6)] {
        let expected = 12.853 * (2.0 / (1.0_f64 + poisson)).sqrt();
        let found = lateral(BendingModel::VertexCurvature, poisson, aspect, rows) / expected;
        assert!((found - 1.0).abs() < 0.05, "{poisson} {aspect}: {found}");
    }
    // Hinges resist torsion as if the ratio were -1/3, whatever it is.
    for (poisson, excess) in [(0.0, 1.15), (0.3, 1.45)] {
        let expected = 12.853 * (2.0 / (1.0_f64 + poisson)).sqrt();
        let found = lateral(BendingModel::Hinge, poisson, 1.0, 6) / expected;
        assert!((found - excess).abs() < 0.05, "{poisson}: {found}");
    }
}

/// Deflection of a simply supported square plate with unit modulus, side and pressure.
fn navier(p: &Vector3<f64>) -> f64 {
    let odd = || (0..20).map(|k| f64::from(2 * k + 1));
    let wave = |m: f64, n: f64| {
        (m * PI * p.x).sin() * (n * PI * p.y).sin() / (m * n * (m * m + n * n).powi(2))
    };
    let sum: f64 = odd().map(|m| odd().map(|n| wave(m, n)).sum::<f64>()).sum();
    16.0 / PI.powi(6) * sum
}

/// Error of the deflection in the mean square, over the deflection.
fn plate(model: BendingModel, aspect: f64, jitter: f64, count: usize) -> f64 {
    let columns = (count as f64 * aspect.sqrt()).round() as usize;
    let rows = (columns as f64 * 0.75_f64.sqrt() / aspect).round() as usize;
    let sheet = Sheet {
        columns,
        rows,
        dx: 1.0 / columns as f64,
        dy: 1.0 / rows as f64,
        start: 0.0,
        jitter,
    };
    let mesh = sheet.mesh(5);
    let edge = |v: f64| !(1e-9..=1.0 - 1e-9).contains(&v);
    let layer = layer(&mesh, model, 0.3, 1e-2, |p| edge(p.x) || edge(p.y));
    let areas = layer.vertex_areas();
    let push: Vec<_> = areas.iter().map(|&area| Vector3::z() * area).collect();
    let held = factor(&layer, &mesh.positions).expect("held at its border");
    let sag = solve(&held, free_forces(&layer, &push));
    let x = moved(&layer, &mesh.positions, &sag, 1.0);
    let (mut error, mut norm) = (0.0, 0.0);
    for (x, area) in x.iter().zip(areas) {
        let exact = navier(x);
        error += area * (x.z - exact).powi(2);
        norm += area * exact * exact;
    }
    (error / norm).sqrt()
}

#[test]
fn a_plate_of_stars_converges_with_the_square_of_the_edge() {
    // Equilateral and 2:1 triangles: 1.6, 0.36, 0.08 % and 0.9, 0.18, 0.04 %.
    for aspect in [1.0, 2.0] {
        let error = |count| plate(BendingModel::VertexCurvature, aspect, 0.0, count);
        let errors = [10, 20, 40].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(order > 1.8, "{aspect}: {errors:?}");
        }
        assert!(errors[2] < 2e-3, "{aspect}: {errors:?}");
    }
    // Irregular ones have no limit to converge to, only a small error.
    for aspect in [0.5, 1.0, 2.0] {
        let error = plate(BendingModel::VertexCurvature, aspect, 0.25, 40);
        assert!(error < 0.01, "{aspect}: {error}");
    }
    // Hinges do not converge on triangles that are not equilateral.
    for (aspect, expected) in [(1.0, 0.02), (0.5, 0.5), (2.0, 0.2)] {
        let error = plate(BendingModel::Hinge, aspect, 0.0, 40);
        assert!((error - expected).abs() < 0.05, "{aspect}: {error}");
    }
}

/// Squares of the frequencies out of the plane of a free sheet of unit density, ascending.
fn frequencies(layer: &LayerEnergy, x: &[Vector3<f64>]) -> Vec<f64> {
    let (starts, rows) = layer.pattern();
    let mut values = vec![0.0; rows.len()];
    layer.hessian(x, &mut values, None);
    let mut matrix = DMatrix::zeros(x.len(), x.len());
    for column in (2..layer.dof_count()).step_by(3) {
        for k in starts[column]..starts[column + 1] {
            let row = rows[k] as usize;
            let (i, j) = (row / 3, column / 3);
            if row % 3 == 2 {
                let mass = (layer.vertex_areas()[i] * layer.vertex_areas()[j]).sqrt();
                matrix[(i, j)] = values[k] / mass;
                matrix[(j, i)] = values[k] / mass;
            }
        }
    }
    let mut squares: Vec<_> = matrix.symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    squares
}

/// From two triangles on: three rigid motions, and nothing else that is easy.
#[test]
fn free_sheets_have_no_soft_modes_but_rigid_motion() {
    for (columns, rows, aspect) in [
        (1, 1, 1.0),
        (8, 1, 1.0),
        (8, 2, 1.0),
        (7, 6, 2.0),
        (7, 6, 0.5),
    ] {
        let sheet = Sheet {
            columns,
            rows,
            dx: 0.75_f64.sqrt(),
            dy: aspect,
            start: 0.0,
            jitter: 0.25,
        };
        let mesh = sheet.mesh(9);
        let [hinges, stars] = MODELS.map(|model| {
            let layer = layer(&mesh, model, 0.3, 0.1, |_| false);
            frequencies(&layer, &mesh.positions)
        });
        let top = stars[stars.len() - 1];
        assert!(
            stars[..3].iter().all(|f| f.abs() < 1e-12 * top),
            "{stars:?}"
        );
        // Torsion comes first: 2 (1 - nu) of a plate against 8/3 of the hinges, and these are up to
        // 1.6 times too stiff on stretched triangles.
        for (star, hinge) in stars.iter().zip(&hinges).skip(3) {
            assert!(
                *star > 0.2 * hinge,
                "{columns} {rows} {aspect}: {stars:?}, {hinges:?}"
            );
        }
    }
}
