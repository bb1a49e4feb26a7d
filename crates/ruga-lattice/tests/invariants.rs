//! What must hold for any lattice: patch test, rigid motion, mass, determinism.

mod shapes;

use nalgebra::{Matrix3, Rotation3, Vector3};
use ruga_lattice::{
    Filling, Lattice, LatticeEnergy, LatticeSpec, RotatedLinear, Shape, SolidMaterial,
    VOID_STIFFNESS,
};
use shapes::{block, random_vector, rng, spec, torus, two_slabs};

const STIFF: SolidMaterial = SolidMaterial {
    young: 3e5,
    poisson: 0.4,
};

fn specs(cells: u32) -> impl Iterator<Item = LatticeSpec> {
    [Shape::Quadratic, Shape::Linear]
        .into_iter()
        .flat_map(move |shape| {
            [Filling::Piece, Filling::Whole].map(|filling| LatticeSpec {
                cells,
                shape,
                filling,
            })
        })
}

fn free(lattice: &Lattice) -> LatticeEnergy {
    let pinned = vec![false; lattice.node_count()];
    LatticeEnergy::new(lattice, &STIFF, &pinned).expect("valid input")
}

fn moved(lattice: &Lattice, f: &Matrix3<f64>, shift: Vector3<f64>) -> Vec<Vector3<f64>> {
    lattice
        .rest_positions()
        .iter()
        .map(|x| f * x + shift)
        .collect()
}

#[test]
fn patch_test() {
    // Any affine motion of a full bar: the stress is the same everywhere, so forces on nodes cancel
    // whose elements are all there and full; and the energy is the density times the volume.
    let f = Matrix3::new(1.1, 0.2, 0.0, -0.1, 0.8, 0.05, 0.3, 0.0, 0.95);
    for spec in specs(9) {
        let surface = block([1.5, 1.0, 1.0], [1, 1, 1]);
        let lattice = surface.lattice(spec);
        let energy = free(&lattice);
        let q = moved(&lattice, &f, Vector3::new(0.3, 0.2, -5.0));
        let mut gradient = vec![0.0; energy.dof_count()];
        energy.gradient(&q, &mut gradient);
        let scale = gradient.iter().fold(0.0_f64, |a, g| a.max(g.abs()));
        let mut full_elements = vec![0; lattice.node_count()];
        for element in lattice.elements() {
            // The grid is a little longer than the bar, so that its outer cells are not quite full.
            let share = lattice.element_volume(element) / lattice.cell_size().product();
            for node in lattice.element_nodes(element) {
                full_elements[node.0 as usize] += usize::from(share > 1.0 - 1e-9);
            }
        }
        let inner = |&node: &usize| full_elements[node] == spec.shape.nodes_per_element();
        let inner: Vec<usize> = (0..lattice.node_count()).filter(inner).collect();
        assert!(inner.len() >= 5 * 2 * 2, "{} inner nodes", inner.len());
        for node in inner {
            let forces = &gradient[3 * node..3 * node + 3];
            assert!(forces.iter().all(|g| g.abs() < 1e-12 * scale), "{forces:?}");
        }
        let density = RotatedLinear::new(STIFF.young, STIFF.poisson).energy(&f);
        let grid = lattice.cell_size().product() * lattice.element_count() as f64;
        let volume = match spec.filling {
            Filling::Piece => surface.volume() + VOID_STIFFNESS * (grid - surface.volume()),
            Filling::Whole => grid,
        };
        assert!((energy.value(&q) / (density * volume) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn rigid_motion_costs_nothing() {
    let turn = Rotation3::new(Vector3::new(1.0, -2.0, 0.4)).into_inner();
    let small = Matrix3::identity() * (1.0 + 1e-3);
    for spec in specs(5) {
        let lattice = torus(1.0, 0.35, [20, 10]).lattice(spec);
        let energy = free(&lattice);
        let unit = energy.value(&moved(&lattice, &small, Vector3::zeros()));
        let q = moved(&lattice, &turn, Vector3::new(100.0, 3.0, 0.0));
        assert!(energy.value(&q) < 1e-20 * unit);
        let mut gradient = vec![0.0; energy.dof_count()];
        energy.gradient(&q, &mut gradient);
        // Against the force of the unit strain over one metre.
        assert!(gradient.iter().all(|g| g.abs() < 1e-9 * unit / 1e-3));
    }
}

#[test]
fn forces_balance() {
    let lattice = torus(1.0, 0.35, [20, 10]).lattice(spec(4));
    let energy = free(&lattice);
    let mut rng = rng(8);
    let q: Vec<_> = (lattice.rest_positions().iter())
        .map(|x| x + random_vector(&mut rng) * 0.1)
        .collect();
    let mut gradient = vec![0.0; energy.dof_count()];
    energy.gradient(&q, &mut gradient);
    let forces = || gradient.chunks(3).map(Vector3::from_column_slice);
    let size: f64 = forces().map(|f| f.norm()).sum();
    let force: Vector3<f64> = forces().sum();
    let torque: Vector3<f64> = forces().zip(&q).map(|(f, x)| x.cross(&f)).sum();
    assert!(force.norm() < 1e-14 * size && torque.norm() < 1e-14 * size);
}

#[test]
fn lattice_weighs_what_the_body_weighs() {
    let density = 1100.0;
    for spec in specs(5) {
        for surface in [
            torus(1.0, 0.35, [20, 10]),
            two_slabs(0.02),
            block([2.0, 1.0, 1.0], [1; 3]),
        ] {
            let lattice = surface.lattice(spec);
            let cells = lattice.cell_size().product() * lattice.element_count() as f64;
            let volume = match spec.filling {
                Filling::Piece => surface.volume(),
                Filling::Whole => cells,
            };
            let masses = lattice.node_masses(density).expect("positive");
            let total: f64 = masses.iter().sum();
            assert!((total / (density * volume) - 1.0).abs() < 1e-12);
            assert!(masses.iter().all(|&m| m > 0.0));
            let g = Vector3::new(0.0, 0.0, -9.81);
            let weights = lattice.gravity_load(density, &g).expect("positive");
            let weight: Vector3<f64> = weights.iter().sum();
            assert!((weight - g * total).norm() < 1e-12 * total);
            check_consistent_mass(&lattice, density, &masses);
        }
    }
}

#[test]
fn centres_of_elements_add_up_to_that_of_the_body() {
    let surface = torus(1.0, 0.35, [20, 10]).shifted(3.0, -1.0, 0.5);
    let lattice = surface.lattice(spec(5));
    let masses = lattice.node_masses(1.0).expect("positive");
    let nodes = lattice.rest_positions().iter().zip(&masses);
    let by_nodes: Vector3<f64> = nodes.map(|(x, m)| x * *m).sum();
    let mut by_elements = Vector3::zeros();
    for element in lattice.elements() {
        let centre = lattice.element_centre(element);
        let local = (centre - lattice.element_corner(element)).component_div(&lattice.cell_size());
        assert!(local.iter().all(|c| (0.0..=1.0).contains(c)), "{local}");
        by_elements += centre * lattice.element_volume(element);
    }
    assert!((by_elements - by_nodes).norm() < 1e-12 * by_nodes.norm());
}

/// Row sums are the lumped masses.
fn check_consistent_mass(lattice: &Lattice, density: f64, masses: &[f64]) {
    let energy = free(lattice);
    let mass = energy.mass(lattice, density).expect("positive");
    let (starts, rows) = energy.pattern();
    let mut sums = vec![0.0; energy.dof_count()];
    for column in 0..energy.dof_count() {
        for k in starts[column]..starts[column + 1] {
            sums[column] += mass[k];
            let row = rows[k] as usize;
            if row != column {
                sums[row] += mass[k];
            }
        }
    }
    let largest = masses.iter().fold(0.0_f64, |a, &m| a.max(m));
    for (dof, sum) in sums.iter().enumerate() {
        assert!((sum - masses[dof / 3]).abs() < 1e-12 * largest);
    }
}

#[test]
fn inertia_of_the_body_does_not_depend_on_the_lattice() {
    // Kinetic energy of a rigid rotation, on a lattice of one cell and of many.
    let surface = torus(1.0, 0.35, [20, 10]).rotated([1.0, 2.0, -0.5], 0.8);
    let kinetic = |spec: LatticeSpec| {
        let lattice = surface.lattice(spec);
        let mass = free(&lattice).mass(&lattice, 7.0).expect("positive");
        let energy = free(&lattice);
        let spin = Vector3::new(0.3, -1.0, 0.7);
        let rest = lattice.rest_positions().iter();
        let v: Vec<f64> = rest.flat_map(|x| <[f64; 3]>::from(spin.cross(x))).collect();
        let (starts, rows) = energy.pattern();
        let entries =
            (0..energy.dof_count()).flat_map(|c| (starts[c]..starts[c + 1]).map(move |k| (c, k)));
        let terms = entries.map(|(c, k)| {
            let row = rows[k] as usize;
            let both = if row == c { 1.0 } else { 2.0 };
            0.5 * both * mass[k] * v[c] * v[row]
        });
        terms.sum::<f64>()
    };
    let expected = kinetic(spec(1));
    for cells in [2, 5, 9] {
        for shape in [Shape::Quadratic, Shape::Linear] {
            let found = kinetic(LatticeSpec {
                shape,
                ..spec(cells)
            });
            assert!(
                (found / expected - 1.0).abs() < 1e-11,
                "{cells} cells: {found}"
            );
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a thread pool").install(|| {
            let lattice = torus(1.0, 0.35, [20, 10]).lattice(spec(7));
            let energy = free(&lattice);
            let mut rng = rng(2);
            let q: Vec<_> = (lattice.rest_positions().iter())
                .map(|x| x + random_vector(&mut rng) * 0.1)
                .collect();
            let mut gradient = vec![0.0; energy.dof_count()];
            energy.gradient(&q, &mut gradient);
            let mut exact = vec![0.0; energy.pattern().1.len()];
            let mut relaxed = exact.clone();
            energy.hessian(&q, &mut exact, Some(&mut relaxed));
            let all = gradient.into_iter().chain(exact).chain(relaxed);
            let bits: Vec<u64> = all.map(f64::to_bits).collect();
            (energy.value(&q).to_bits(), bits)
        })
    };
    let serial = run(1);
    assert_eq!(serial, run(2));
    assert_eq!(serial, run(5));
}
