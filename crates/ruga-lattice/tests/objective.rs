//! A lattice under its own weight, solved by the product's Newton method, against a closed formula.

mod shapes;

use nalgebra::Vector3;
use ruga_lattice::{Embedding, LatticeEnergy, LatticeObjective, SolidMaterial};
use ruga_solver::{ConstraintRows, Kkt, NewtonSettings, Objective, minimise};
use shapes::{block, spec};

/// Cells along the bar.
const CELLS: u32 = 16;

/// A bar that hangs by its top grows longer by `rho g L^2 / (2 E)`; without Poisson's ratio it stays as
/// thick as it is, and the clamp at its top changes nothing.
#[test]
fn a_hanging_bar_elongates_as_it_should() {
    let (length, young, density, gravity) = (0.4, 1e5, 1000.0, 9.81);
    let lattice = block([0.1, 0.1, length], [2, 2, 8]).lattice(spec(CELLS));
    // Quadratic splines have their nodes in the cells' middles: two rows hold the face between them.
    let top = |node: &Vector3<f64>| node.z > length * (1.0 - 0.6 / f64::from(CELLS));
    let pinned: Vec<bool> = lattice.rest_positions().iter().map(top).collect();
    let foam = SolidMaterial {
        young,
        poisson: 0.0,
    };
    let energy = LatticeEnergy::new(&lattice, &foam, &pinned).expect("a material");
    let load = lattice.gravity_load(density, &Vector3::new(0.0, 0.0, -gravity));
    let load = load.expect("a density");
    let rest = lattice.rest_positions();
    let objective = LatticeObjective::new(&energy, rest, &load, length).expect("a load per node");

    let none = ConstraintRows::none(energy.dof_count());
    let mut kkt = Kkt::new(objective.pattern(), &none, 3).expect("a system");
    let mut x = energy.unknowns(rest);
    let settings = NewtonSettings::default();
    let report = minimise(&objective, &[], &mut x, &mut kkt, &settings, &mut |_| true);
    assert!(report.expect("a valid system").converged);

    let surface = Embedding::of_vertices(&lattice).expect("the block's vertices");
    let lowest = |q: &[Vector3<f64>]| {
        let heights = surface.positions(q).into_iter().map(|p| p.z);
        heights.fold(f64::INFINITY, f64::min)
    };
    let found = lowest(rest) - lowest(&objective.nodes(&x));
    let expected = density * gravity * length * length / (2.0 * young);
    // The lower row takes part of the uppermost cell with it.
    assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");

    assert!(LatticeObjective::new(&energy, rest, &load[1..], length).is_err());
}
