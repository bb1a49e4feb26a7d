//! What depends on the mesh that a film is computed on, and what a hundred remeshes leave of a surface.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use std::f64::consts::SQRT_2;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::vertex_areas;
use ruga_remesh::SurfaceMesh;
use ruga_stepper::Modelling;
use ruga_validation::{FilmState, FlatFilm, Rectangle};

/// Amplitudes and wavelengths of a film at three critical strains on fitted meshes of several seeds and
/// sizes, and on a uniform one that is four times as fine as it has to be along the wrinkles.
#[test]
fn wrinkles_do_not_depend_on_the_mesh() {
    let film = FlatFilm {
        waves: [5.0, 5.0],
        load: 3.0,
        ..FlatFilm::new(150.0)
    };
    let state = |film: &FlatFilm, modelling: Modelling| -> FilmState {
        let points = modelling.points_per_wavelength;
        let (result, states) = film.states(&modelling, &[film.load]);
        let vertices = result.layers[0].vertices;
        println!("{points} points, {vertices} vertices: {:?}", states[0]);
        states[0]
    };
    let uniform = FlatFilm {
        squares: 3.0 * SQRT_2,
        ..film.clone()
    };
    let unfitted = Modelling {
        remesh: None,
        ..Modelling::standard()
    };
    let reference = state(
        &uniform,
        Modelling {
            whole_vertices: usize::MAX,
            ..unfitted.clone()
        },
    );
    // So many vertices are divided into patches, which end in other digits.
    let patched = state(&uniform, unfitted);
    assert_ne!(patched.amplitude, reference.amplitude, "not in patches");
    let amplitude = patched.relative_amplitude / reference.relative_amplitude - 1.0;
    let wavelength = patched.relative_wavelength / reference.relative_wavelength - 1.0;
    assert!(amplitude.abs() < 0.01, "in patches: {amplitude:+.4}");
    assert!(wavelength.abs() < 0.01, "in patches: {wavelength:+.4}");
    for (seed, points) in [(1, 12.0), (2, 12.0), (3, 12.0), (4, 12.5), (4, 15.625)] {
        let film = FlatFilm {
            mesh_seed: Some(seed),
            ..film.clone()
        };
        let fitted = state(
            &film,
            Modelling {
                points_per_wavelength: points,
                ..Modelling::standard()
            },
        );
        // Longer waves of the same slope are higher: amplitudes are compared over their wavelengths.
        let amplitude = fitted.relative_amplitude / reference.relative_amplitude - 1.0;
        let wavelength = fitted.relative_wavelength / reference.relative_wavelength - 1.0;
        assert!(amplitude.abs() < 0.01, "{points} points: {amplitude:+.4}");
        assert!(
            wavelength.abs() < 0.025,
            "{points} points: {wavelength:+.4}"
        );
    }
}

/// A film so large, over what may be solved as a whole, that its first wrinkles are found in wide patches too.
#[test]
fn wide_patches_find_the_waves_of_the_whole() {
    let film = FlatFilm {
        waves: [14.0, 14.0],
        load: 3.0,
        mesh_seed: Some(1),
        ..FlatFilm::new(150.0)
    };
    let [whole, wide] = [usize::MAX, 1100].map(|whole_vertices| {
        let modelling = Modelling {
            whole_vertices,
            ..Modelling::standard()
        };
        let (result, states) = film.states(&modelling, &[film.load]);
        let layer = &result.layers[0];
        println!("{} vertices: {:?}", layer.vertices, states[0]);
        // Six times the limit, above which nothing is factorised as a whole.
        assert!(layer.vertices > 7000);
        (layer.energy, states[0])
    });
    assert_ne!(wide.0, whole.0, "not in patches");
    let energy = wide.0 / whole.0 - 1.0;
    let wavelength = wide.1.relative_wavelength / whole.1.relative_wavelength - 1.0;
    let amplitude = wide.1.relative_amplitude / whole.1.relative_amplitude - 1.0;
    assert!(energy.abs() < 0.005, "{energy:+.4}");
    assert!(wavelength.abs() < 0.02, "{wavelength:+.4}");
    assert!(amplitude.abs() < 0.01, "{amplitude:+.4}");
}

/// The worst of a hundred remeshes of a sheet that nothing loads.
#[derive(Clone, Copy, Debug, Default)]
struct Unloaded {
    /// Distance of a vertex from the surface, in wavelengths.
    height: f64,
    /// Distance on the surface between a vertex and the coordinates that were carried over to it
    /// from mesh to mesh, in wavelengths.
    drift: f64,
    /// Area of the facets missing of the rectangle's.
    missing_area: f64,
}

impl Unloaded {
    /// Remeshes 2 by 1.5 wavelengths a hundred times, by another factor each time.
    fn new(radius: Option<f64>) -> Self {
        let wavelength = FlatFilm::new(150.0).theory().wavelength;
        let sheet = Rectangle {
            length: 2.0 * wavelength,
            width: 1.5 * wavelength,
            radius: radius.map(|waves| waves * wavelength),
        };
        let coordinates = |mesh: &SurfaceMesh| -> Vec<Vector3<f64>> {
            let places = mesh.points.as_slice().iter();
            places.map(|&p| sheet.coordinates(p).push(0.0)).collect()
        };
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut mesh = sheet.meshed(wavelength / 12.0);
        let mut carried = coordinates(&mesh);
        let mut worst = Self::default();
        for step in 0..100 {
            let edge = wavelength / 12.0 * random.random_range(0.8..1.25);
            let made = sheet.remeshed(&mesh, edge, 0.2, step);
            carried = made.transfer.rows.apply(&carried);
            mesh = made.mesh;
            let positions = mesh.positions.as_slice();
            for (p, (there, meant)) in positions
                .iter()
                .zip(coordinates(&mesh).iter().zip(&carried))
            {
                worst.height = worst.height.max(sheet.height(p).abs() / wavelength);
                worst.drift = worst.drift.max((there - meant).norm() / wavelength);
            }
            let area: f64 = vertex_areas(&mesh.mesh, positions).iter().sum();
            let missing = 1.0 - area / (sheet.length * sheet.width);
            worst.missing_area = worst.missing_area.max(missing.abs());
        }
        println!("radius {radius:?}: {worst:?}");
        worst
    }
}

#[test]
fn a_flat_sheet_stays_flat() {
    let worst = Unloaded::new(None);
    assert_eq!(worst.height, 0.0);
    assert!(worst.drift < 1e-12, "{worst:?}");
    assert!(worst.missing_area < 1e-12, "{worst:?}");
}

/// Facets are chords: their area falls short by a twelfth of the square of edge over radius, and
/// what is carried over by them moves a little.
#[test]
fn a_curved_sheet_stays_on_its_base() {
    let worst = Unloaded::new(Some(2.0));
    assert!(worst.height < 1e-13, "{worst:?}");
    assert!(worst.drift < 5e-4, "{worst:?}");
    assert!(worst.missing_area < 3e-4, "{worst:?}");
}
