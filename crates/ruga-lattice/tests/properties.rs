//! Random bodies in random positions, cells and sizes: they are all cut, and nothing is lost.

mod shapes;

use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;
use ruga_lattice::Embedding;
use shapes::{Surface, block, random_vector, rng, spec, sphere, torus, two_slabs};

/// Thick and thin, coarse and fine, in parts that nearly touch; some with facets along the grid.
fn body(seed: u64, rng: &mut Pcg64) -> Surface {
    let body = match seed % 5 {
        0 => {
            let counts = [rng.random_range(3..40), rng.random_range(3..20)];
            torus(1.0, rng.random_range(0.02..0.6), counts)
        }
        1 => sphere(1.0, rng.random_range(3..30), rng.random_range(2..20)),
        2 => {
            let mut side = || rng.random_range(0.01..1.0);
            let size = [1.0, side(), side()];
            block(size, [1, 2, 3].map(|most| rng.random_range(1..=2 * most)))
        }
        3 => two_slabs(10.0_f64.powf(rng.random_range(-6.0..-0.5))),
        _ => {
            let link = torus(1.0, 0.2, [24, 12]);
            let other = |p: &Vector3<f64>| Vector3::new(p.x + 1.0, p.z, -p.y);
            link.clone().and(link.map(other))
        }
    };
    if seed.is_multiple_of(3) {
        return body;
    }
    let axis = random_vector(rng);
    body.rotated(axis.into(), rng.random_range(0.0..3.0))
        .shifted(rng.random_range(-9.0..9.0), 3.0, -20.0)
}

#[test]
fn every_body_is_cut_and_filled() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let surface = body(seed, &mut rng);
        let cells = [1, 2, 3, 5, 8, 13][rng.random_range(0..6)];
        let lattice = surface
            .try_lattice(spec(cells))
            .unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let volume = lattice.volume() / surface.volume();
        assert!((volume - 1.0).abs() < 1e-9, "seed {seed}: {volume}");
        let cell = lattice.cell_size().product();
        for element in lattice.elements() {
            let share = lattice.element_volume(element) / cell;
            assert!(
                (-1e-15..1.0 + 1e-9).contains(&share),
                "seed {seed}: {share}"
            );
        }
        let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
        let found = embedding.positions(lattice.rest_positions());
        for (found, rest) in found.iter().zip(&surface.positions) {
            assert!(
                (found - rest).norm() < 1e-13 * rest.norm().max(1.0),
                "seed {seed}"
            );
        }
    }
}
