//! The stability suite: where methods for wrinkling skin fail, what the papers' method does there
//! and what ruga does. `cargo xtask validate stability` prints the findings as a table.
//!
//! The papers' method is what stands in the papers: low-pass rows alone, sampled by area or
//! adjusted as printed, Newton on the norm of the forces or with MINRES, one load step. Numbers of
//! tests are those of the project's list of failures. Of T12 the wavelength of sheets that are
//! stretched on their own is not tested: that takes a mesh of many thousand vertices.

mod bodies;
mod extremes;
mod heterogeneous;
mod invariance;
mod loads;
mod meshes;
mod range;
mod rows;
mod starts;

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_shell::BendingModel;
use ruga_solver::NewtonSettings;
use ruga_validation::small_patch::{
    draft, followed, patch, planned, simulated, simulated_on, skin,
};
use ruga_validation::{FilmCoupling, FilmSpec, Sheet, SheetSpec, Strip, equilateral};

/// Energies to a ten-thousandth of the gap.
fn exact() -> NewtonSettings {
    NewtonSettings {
        energy_tolerance: 1e-9,
        ..NewtonSettings::default()
    }
}

/// The papers' coupling: a hex lattice of averages that lets the critical wavelength through.
fn rows_alone() -> FilmSpec {
    FilmSpec {
        coupling: FilmCoupling::Constraint(1.0 / 3.0_f64.sqrt()),
        bending: BendingModel::Hinge,
        ..FilmSpec::flat(150.0)
    }
}

/// Moves the base under a flat film to `load` critical strains.
fn compress(sheet: &mut Sheet, spec: &FilmSpec, strip: &Strip, load: f64) {
    let strain = load * spec.theory().critical_strain;
    sheet.lay_on(
        strip.compressed(strain),
        &vec![Vector3::z(); strip.points.len()],
    );
}

/// Takes a film that lies on its base from noise of so many thicknesses, just past the onset, to twice the
/// critical strain, and gives its energy gap there over theory's, `C/2 (eps - eps_c)^2` per area.
fn landed(spec: &FilmSpec, strip: &Strip, (noise, seed): (f64, u64)) -> (Sheet, f64) {
    let mut sheet = compressed(spec, strip, 1.08, noise, seed);
    for load in [1.08, 1.5, 2.0] {
        compress(&mut sheet, spec, strip, load);
        assert!(sheet.solve(&exact()).converged);
    }
    assert!(sheet.inertia().is_minimum());
    let gap = relative_gap(&sheet, spec);
    (sheet, gap)
}

/// Energy gap of a sheet at twice the critical strain over theory's.
fn relative_gap(sheet: &Sheet, spec: &FilmSpec) -> f64 {
    let theory = spec.theory();
    let area: f64 = sheet.areas().iter().sum();
    let excess = theory.critical_strain;
    sheet.gap() / (0.5 * theory.membrane_stiffness * excess.powi(2) * area)
}

/// A flat film laid on a base at `load` critical strains, with noise of so many thicknesses.
fn compressed(spec: &FilmSpec, strip: &Strip, load: f64, noise: f64, seed: u64) -> Sheet {
    let mut sheet = Sheet::new(SheetSpec::film(spec, strip));
    compress(&mut sheet, spec, strip, load);
    sheet.lie_down(Vector3::z(), noise, seed);
    sheet
}

/// Vertices and triangles of a patch, about the origin of the plane, m.
fn patch_mesh() -> (Vec<Vector2<f64>>, Vec<[u32; 3]>) {
    let grid = equilateral(patch(0.0).length, 12, 7);
    let middle = Vector2::new(0.5 * grid.length, 0.5 * grid.width);
    let points = grid.points.iter().map(|p| p - middle).collect();
    (points, grid.faces)
}

/// A patch compressed by 12 % along x that an artist has put somewhere.
fn placed_patch(
    points: &[Vector2<f64>],
    triangles: &[[u32; 3]],
    place: impl Fn(&Vector3<f64>) -> Vector3<f64>,
) -> Arc<Driver> {
    let positions: Vec<_> = points.iter().map(|p| place(&p.push(0.0))).collect();
    let posed = points
        .iter()
        .map(|p| place(&Vector3::new(0.88 * p.x, p.y, 0.0)));
    let moved = posed.zip(&positions).map(|(posed, rest)| posed - rest);
    let artist = ArtistMesh {
        name: "patch".to_owned(),
        shapes: vec![BlendShape {
            name: "compress".to_owned(),
            position_deltas: moved.collect(),
            normal_deltas: None,
        }],
        positions,
        normals: None,
        uvs: Some(points.iter().map(|p| p / patch(0.0).length).collect()),
        triangles: triangles.to_vec(),
    };
    Arc::new(Driver::new(&artist).expect("a rectangle"))
}
