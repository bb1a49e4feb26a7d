//! The pulled back stiffness of a surface against the dense product.

mod shapes;

use nalgebra::{DMatrix, Matrix3};
use rand::RngExt;
use ruga_lattice::{
    Embedding, Lattice, LatticeEnergy, LatticeError, LatticeSpec, Shape, SolidMaterial,
};
use shapes::{Surface, rng, spec, torus};

/// A lower triangle with a random block for every edge and vertex of a surface; every fourth vertex
/// has none.
fn stiffness(surface: &Surface) -> Vec<Vec<(u32, Matrix3<f64>)>> {
    let mut rng = rng(6);
    let mut block = || Matrix3::from_fn(|_, _| rng.random_range(-1.0..1.0));
    let is_held = |point: u32| point % 4 == 1;
    let mut columns = vec![Vec::new(); surface.positions.len()];
    for (point, column) in (0..)
        .zip(&mut columns)
        .filter(|(point, _)| !is_held(*point))
    {
        let own = block();
        column.push((point, own + own.transpose()));
    }
    for edge in surface.mesh().edges().as_slice() {
        let [a, b] = edge.vertices.map(|v| v.0);
        if !is_held(a) && !is_held(b) {
            columns[a.min(b) as usize].push((a.max(b), block()));
        }
    }
    columns
}

fn stencils(stiffness: &[Vec<(u32, Matrix3<f64>)>]) -> impl Iterator<Item = Vec<u32>> {
    let columns = stiffness.iter();
    columns.map(|column| column.iter().map(|(point, _)| *point).collect())
}

fn dense((starts, rows): (&[usize], &[u32]), values: &[f64]) -> DMatrix<f64> {
    let size = starts.len() - 1;
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        for k in starts[column]..starts[column + 1] {
            let row = rows[k] as usize;
            matrix[(row, column)] = values[k];
            matrix[(column, row)] = values[k];
        }
    }
    matrix
}

fn energy(lattice: &Lattice) -> LatticeEnergy {
    let material = SolidMaterial {
        young: 1.0,
        poisson: 0.3,
    };
    let pinned: Vec<bool> = (0..lattice.node_count()).map(|n| n % 5 == 2).collect();
    LatticeEnergy::new(lattice, &material, &pinned).expect("valid input")
}

#[test]
fn pulled_back_stiffness_is_the_product() {
    let surface = torus(1.0, 0.35, [12, 6]);
    let stiffness = stiffness(&surface);
    let unknowns = 3 * surface.positions.len();
    let mut k = DMatrix::zeros(unknowns, unknowns);
    for (j, column) in stiffness.iter().enumerate() {
        for (i, block) in column {
            let at = [3 * *i as usize, 3 * j];
            k.fixed_view_mut::<3, 3>(at[0], at[1]).copy_from(block);
            k.fixed_view_mut::<3, 3>(at[1], at[0])
                .copy_from(&block.transpose());
        }
    }
    for shape in [Shape::Quadratic, Shape::Linear] {
        let lattice = surface.lattice(LatticeSpec { shape, ..spec(4) });
        let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
        let mut energy = energy(&lattice);
        let before = energy.pattern().1.len();
        energy
            .couple_surface(&embedding, stencils(&stiffness))
            .expect("it fits");
        assert!(
            energy.pattern().1.len() > before,
            "stencils reach across borders"
        );

        let mut found = vec![0.0; energy.pattern().1.len()];
        energy.add_pulled_back(&embedding, &stiffness, &mut found);
        let mut b = DMatrix::zeros(unknowns, energy.dof_count());
        for point in 0..surface.positions.len() {
            for (node, weight) in embedding.rows().row(point) {
                if let Ok(free) = energy.free_nodes().binary_search(&node) {
                    (0..3).for_each(|c| b[(3 * point + c, 3 * free + c)] = weight);
                }
            }
        }
        let expected = b.transpose() * &k * b;
        let error = (dense(energy.pattern(), &found) - &expected).amax();
        assert!(error < 1e-13 * expected.amax(), "{error:e}");
        check_own_hessian(&lattice, &energy);
    }
}

/// The wider pattern holds the elastic Hessian as well.
fn check_own_hessian(lattice: &Lattice, wide: &LatticeEnergy) {
    let narrow = energy(lattice);
    let full = |energy: &LatticeEnergy| {
        let mut values = vec![0.0; energy.pattern().1.len()];
        energy.hessian(lattice.rest_positions(), &mut values, None);
        dense(energy.pattern(), &values)
    };
    assert_eq!(full(&narrow), full(wide));
}

#[test]
fn points_and_lattices_that_do_not_fit_are_refused() {
    let surface = torus(1.0, 0.35, [12, 6]);
    let lattice = surface.lattice(spec(2));
    let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
    let good = stiffness(&surface);
    let refused = |lattice: &Lattice, stencils: Vec<Vec<u32>>| {
        let error = energy(lattice).couple_surface(&embedding, stencils.into_iter());
        assert!(
            matches!(error, Err(LatticeError::Length { .. })),
            "{error:?}"
        );
    };
    refused(&surface.lattice(spec(3)), stencils(&good).collect());
    refused(&lattice, vec![vec![3, 72]]);
}
