//! Elements that are inside out or collapsed turn back.

mod shapes;
mod solve;

use nalgebra::{Rotation3, Vector3};
use ruga_lattice::{Lattice, LatticeEnergy, LatticeSpec, Shape, SolidMaterial};
use shapes::{block, random_vector, rng, spec};
use solve::Problem;

/// Energy after minimisation, as a share of that before; whether it took 300 steps or fewer.
fn recover(lattice: &Lattice, mut q: Vec<Vector3<f64>>) -> (f64, bool) {
    let material = SolidMaterial {
        young: 1.0,
        poisson: 0.4,
    };
    let pinned = vec![false; lattice.node_count()];
    let problem = Problem {
        energy: LatticeEnergy::new(lattice, &material, &pinned).expect("valid input"),
        springs: Vec::new(),
        forces: vec![Vector3::zeros(); lattice.node_count()],
        // Holds the six rigid motions, which have no stiffness.
        floor: 1e-6,
    };
    let before = problem.value(&q);
    let converged = problem.minimise(&mut q, 1e-9, 300).is_some();
    (problem.value(&q) / before, converged)
}

/// Runs that end at rest, out of 30: mirrored, mirrored and shaken, flat, a heap, crumpled.
fn recovered(shape: Shape) -> usize {
    let lattice = block([2.0, 1.0, 1.0], [2, 1, 1]).lattice(LatticeSpec { shape, ..spec(2) });
    let states = [
        ([1.0, 1.0, -1.0], 0.0),
        ([1.0, 1.0, -1.0], 0.1),
        ([1.0, 1.0, 0.0], 0.1),
        ([0.0, 0.0, 0.0], 0.3),
        ([1.0, 1.0, 1.0], 0.8),
    ];
    let mut count = 0;
    for seed in 0..6 {
        let mut rng = rng(seed);
        let turn = Rotation3::new(random_vector(&mut rng) * 3.0);
        for (scale, noise) in states {
            let rest = lattice.rest_positions().iter();
            let q: Vec<_> = rest
                .map(|x| {
                    let flattened = x.component_mul(&Vector3::from(scale));
                    turn * flattened + random_vector(&mut rng) * noise
                })
                .collect();
            let (energy, converged) = recover(&lattice, q);
            assert!(converged, "seed {seed}, {scale:?}");
            count += usize::from(energy < 1e-12);
        }
    }
    count
}

#[test]
fn inverted_quadratic_elements_recover_from_any_state() {
    assert_eq!(recovered(Shape::Quadratic), 30);
}

#[test]
fn inverted_linear_elements_can_stay_turned_inside_out() {
    // A known limit: two trilinear elements can rest in each other's way, bent inside out, with a
    // few percent of the mirrored state's energy. Measured: 27 of 30 recover.
    let count = recovered(Shape::Linear);
    assert!((20..30).contains(&count), "{count}");
}
