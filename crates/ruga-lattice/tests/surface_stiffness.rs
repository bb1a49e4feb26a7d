//! The pulled back stiffness of a surface against the dense product.

mod shapes;

use nalgebra::DMatrix;
use rand::RngExt;
use ruga_lattice::{
    Embedding, Lattice, LatticeEnergy, LatticeError, LatticeSpec, Shape, SolidMaterial,
    SurfacePattern,
};
use shapes::{Surface, rng, spec, torus};

/// A lower triangle with a random block for every edge and vertex of a surface.
struct Stiffness {
    points: Vec<u32>,
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl Stiffness {
    /// Every fourth point is held.
    fn of(surface: &Surface) -> Self {
        let mut rng = rng(6);
        let points: Vec<u32> = (0..surface.positions.len() as u32)
            .filter(|p| p % 4 != 1)
            .collect();
        let mut pairs: Vec<[usize; 2]> = (0..points.len()).map(|k| [k, k]).collect();
        for edge in surface.mesh().edges().as_slice() {
            let ends = edge.vertices.map(|v| points.binary_search(&v.0));
            if let [Ok(a), Ok(b)] = ends {
                pairs.push([a.min(b), a.max(b)]);
            }
        }
        pairs.sort_unstable();
        let (mut column_starts, mut rows) = (vec![0], Vec::new());
        for column in 0..3 * points.len() {
            let own = pairs.iter().filter(|pair| pair[0] == column / 3);
            let all = own.flat_map(|pair| 3 * pair[1]..3 * pair[1] + 3);
            rows.extend(all.filter(|&row| row >= column));
            column_starts.push(rows.len());
        }
        let values = rows.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
        Self {
            points,
            column_starts,
            rows,
            values,
        }
    }

    fn pattern(&self) -> SurfacePattern<'_> {
        SurfacePattern {
            points: &self.points,
            column_starts: &self.column_starts,
            rows: &self.rows,
        }
    }
}

fn dense((starts, rows): (&[usize], &[usize]), values: &[f64]) -> DMatrix<f64> {
    let size = starts.len() - 1;
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        for k in starts[column]..starts[column + 1] {
            matrix[(rows[k], column)] = values[k];
            matrix[(column, rows[k])] = values[k];
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
    let stiffness = Stiffness::of(&surface);
    for shape in [Shape::Quadratic, Shape::Linear] {
        let lattice = surface.lattice(LatticeSpec { shape, ..spec(4) });
        let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
        let mut energy = energy(&lattice);
        let before = energy.pattern().1.len();
        energy
            .couple_surface(&embedding, &stiffness.pattern())
            .expect("it fits");
        assert!(
            energy.pattern().1.len() > before,
            "stencils reach across borders"
        );

        let mut found = vec![0.0; energy.pattern().1.len()];
        let pattern = stiffness.pattern();
        energy.add_pulled_back(&embedding, &pattern, &stiffness.values, &mut found);
        let mut b = DMatrix::zeros(3 * stiffness.points.len(), energy.dof_count());
        for (k, &point) in stiffness.points.iter().enumerate() {
            for (node, weight) in embedding.rows().row(point as usize) {
                if let Ok(free) = energy.free_nodes().binary_search(&node) {
                    (0..3).for_each(|c| b[(3 * k + c, 3 * free + c)] = weight);
                }
            }
        }
        let k = dense(
            (&stiffness.column_starts, &stiffness.rows),
            &stiffness.values,
        );
        let expected = b.transpose() * k * b;
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
fn arrays_that_do_not_fit_are_refused() {
    let surface = torus(1.0, 0.35, [12, 6]);
    let lattice = surface.lattice(spec(2));
    let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
    let good = Stiffness::of(&surface);
    let refused = |pattern: SurfacePattern| {
        let error = energy(&lattice).couple_surface(&embedding, &pattern);
        assert!(
            matches!(error, Err(LatticeError::Length { .. })),
            "{error:?}"
        );
    };
    refused(SurfacePattern {
        column_starts: &good.column_starts[1..],
        ..good.pattern()
    });
    refused(SurfacePattern {
        rows: &good.rows[1..],
        ..good.pattern()
    });
    // The last start alone fits; one before it points beyond the rows.
    let mut starts = good.column_starts.clone();
    starts[5] = good.rows.len() + 1;
    let unsorted = SurfacePattern {
        column_starts: &starts,
        ..good.pattern()
    };
    assert_eq!(
        energy(&lattice).couple_surface(&embedding, &unsorted),
        Err(LatticeError::ColumnStarts { column: 5 })
    );
    let finer = surface.lattice(spec(3));
    let error = energy(&finer).couple_surface(&embedding, &good.pattern());
    assert!(
        matches!(error, Err(LatticeError::Length { .. })),
        "{error:?}"
    );

    let mut beyond = good.points.clone();
    beyond[3] = 72;
    refused(SurfacePattern {
        points: &beyond,
        ..good.pattern()
    });
}
