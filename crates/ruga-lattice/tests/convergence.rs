//! A cantilever against beam theory, with quadratic and with linear elements.

mod shapes;
mod solve;

use nalgebra::{Rotation3, Vector3};
use ruga_lattice::{Embedding, Filling, Lattice, LatticeEnergy, LatticeSpec, Shape, SolidMaterial};
use shapes::{Surface, block, spec};
use solve::{Problem, Springs};

const LENGTH: f64 = 8.0;
const WEIGHT: f64 = 1e-6;

/// Without lateral contraction, beam theory and the clamp agree.
const MATERIAL: SolidMaterial = SolidMaterial {
    young: 1.0,
    poisson: 0.0,
};

/// Timoshenko's beam of a square section of side 1 under its own weight, clamped at one end.
fn beam_deflection() -> f64 {
    let (inertia, shear_area) = (1.0 / 12.0, 5.0 / 6.0);
    WEIGHT * (LENGTH.powi(4) / (8.0 * inertia) + LENGTH.powi(2) / (2.0 * 0.5 * shear_area))
}

fn held(lattice: &Lattice, points: &[Vector3<f64>]) -> Springs {
    let located = lattice.locate_near(points).expect("finite");
    let normals = vec![Vector3::x(); points.len()];
    Springs {
        points: Embedding::of_lattice_points(lattice, &located, &normals).expect("good normals"),
        targets: points.to_vec(),
        stiffness: 1e4,
    }
}

/// Deflection of the end's middle over beam theory's; `place` puts the beam's places in the grid.
fn deflection(
    surface: &Surface,
    spec: LatticeSpec,
    place: impl Fn(Vector3<f64>) -> Vector3<f64>,
) -> f64 {
    deflection_of(surface, &MATERIAL, spec, place)
}

fn deflection_of(
    surface: &Surface,
    material: &SolidMaterial,
    spec: LatticeSpec,
    place: impl Fn(Vector3<f64>) -> Vector3<f64>,
) -> f64 {
    let lattice = surface.lattice(spec);
    let at = |x: f64, y: f64, z: f64| place(Vector3::new(x, y, z));
    let down = at(0.0, 0.0, -1.0) - at(0.0, 0.0, 0.0);
    let pinned = vec![false; lattice.node_count()];
    let mut root = Vec::new();
    for i in 0..=8 {
        for j in 0..=8 {
            root.push(at(0.0, f64::from(i) / 8.0, f64::from(j) / 8.0));
        }
    }
    let problem = Problem {
        energy: LatticeEnergy::new(&lattice, material, &pinned).expect("valid input"),
        springs: vec![held(&lattice, &root)],
        forces: lattice.gravity_load(WEIGHT, &down).expect("positive"),
        floor: 0.0,
    };
    let rest = lattice.rest_positions();
    let step = problem.step(rest, &problem.gradient(rest));
    let moved: Vec<Vector3<f64>> = step.chunks(3).map(Vector3::from_column_slice).collect();
    let end = held(&lattice, &[at(LENGTH, 0.5, 0.5)]);
    end.points.positions(&moved)[0].dot(&down) / beam_deflection()
}

#[test]
fn quadratic_elements_bend_as_a_beam_and_linear_ones_are_stiff() {
    let bar = block([LENGTH, 1.0, 1.0], [8, 1, 1]);
    let error = |shape: Shape, cells: u32| {
        let spec = LatticeSpec {
            shape,
            ..spec(cells)
        };
        deflection(&bar, spec, |p| p) - 1.0
    };
    // One quadratic element across the bar is enough; measured -0.9, 0.07 and -0.02 %.
    for (cells, tolerance) in [(4, 0.015), (8, 2e-3), (16, 5e-4)] {
        let quadratic = error(Shape::Quadratic, cells);
        assert!(quadratic.abs() < tolerance, "{cells} cells: {quadratic}");
    }
    // Trilinear elements shear when they should bend: measured -66, -33 and -11 %, -3 % with 32.
    let linear = [4, 8, 16].map(|cells| error(Shape::Linear, cells));
    assert!(linear[1] < -0.25 && linear[2] > -0.12, "{linear:?}");
    assert!(linear[2] / linear[1] < 0.35, "{linear:?}");
}

#[test]
fn a_bar_askew_in_the_grid_bends_as_one_along_it() {
    let turn = Rotation3::new(Vector3::new(0.2, 0.3, 0.1));
    let bar = block([LENGTH, 1.0, 1.0], [8, 1, 1]).map(|p| turn * p);
    let error = |filling: Filling, cells: u32| {
        let spec = LatticeSpec {
            filling,
            ..spec(cells)
        };
        deflection(&bar, spec, |p| turn * p) - 1.0
    };
    // Cells of twice the bar's thickness to a half: measured -8, -2.0 and -0.5 %, -0.16 % with 32.
    for (cells, tolerance) in [(4, 0.1), (8, 0.03), (16, 0.01)] {
        let found = error(Filling::Piece, cells);
        assert!(found.abs() < tolerance, "{cells} cells: {found}");
    }
    // Whole cells make the bar thicker: it bends half as much even with two cells across.
    let whole = [8, 16].map(|cells| error(Filling::Whole, cells));
    assert!(
        whole[0] < -0.6 && (-0.55..-0.45).contains(&whole[1]),
        "{whole:?}"
    );
}

#[test]
fn nearly_incompressible_elements_lock_and_quadratic_ones_less() {
    // A known limit, which the material's documentation names.
    let bar = block([LENGTH, 1.0, 1.0], [8, 1, 1]);
    let stiff = SolidMaterial {
        poisson: 0.48,
        ..MATERIAL
    };
    let [quadratic, linear] = [Shape::Quadratic, Shape::Linear].map(|shape| {
        let spec = LatticeSpec { shape, ..spec(8) };
        deflection_of(&bar, &stiff, spec, |p| p)
    });
    assert!((0.85..0.93).contains(&quadratic), "{quadratic}");
    assert!((0.38..0.46).contains(&linear), "{linear}");
}
