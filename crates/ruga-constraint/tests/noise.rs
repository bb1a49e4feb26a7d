//! How much a row's value of a smooth field changes when the surface is triangulated anew.
//!
//! The more moments a sampling reproduces, the quieter it is, inside and at borders.

mod meshes;

use meshes::{Patch, irregular_square};
use nalgebra::Vector3;
use ruga_constraint::{Kernel, Sampling};
use ruga_mesh::VertexId;

const REMESHES: u64 = 40;
const SAMPLINGS: [Sampling; 3] = [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature];
const KERNEL: Kernel = Kernel {
    sigma: 0.3,
    cut: 2.0,
};

fn field(p: &Vector3<f64>) -> f64 {
    1.0 + (1.5 * p.x + 0.4).sin() + 0.7 * (1.2 * p.y - 0.3).cos()
}

fn value(patch: &Patch, centre: VertexId, sampling: Sampling) -> f64 {
    let set = patch.rows(&[centre], KERNEL, sampling);
    patch.average(&set.rows[0], field)
}

/// Standard deviation over remeshes of the row at `place`, per sampling.
fn noise(cells: usize, place: [f64; 2]) -> [f64; 3] {
    let patches: Vec<Patch> = (0..REMESHES)
        .map(|seed| irregular_square(cells, seed, &[place]))
        .collect();
    SAMPLINGS.map(|sampling| {
        let values: Vec<f64> = patches
            .iter()
            .map(|patch| {
                let centre = patch.vertex_near([place[0], place[1], 0.0].into());
                value(patch, centre, sampling)
            })
            .collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = |v: &f64| (v - mean).powi(2);
        (values.iter().map(square).sum::<f64>() / values.len() as f64).sqrt()
    })
}

#[test]
fn the_more_a_sampling_reproduces_the_quieter_it_is() {
    println!("inside:    vertices      area  adjusted  quadrature");
    for cells in [10, 20, 44] {
        let [area, adjusted, quadrature] = noise(cells, [0.0, 0.0]);
        let vertices = (cells + 1).pow(2);
        println!("{vertices:>19}  {area:10.1e}{adjusted:10.1e}{quadrature:12.1e}");
        assert!(adjusted < 0.3 * area, "{cells}");
        assert!(quadrature < adjusted, "{cells}");
    }
}

#[test]
fn at_a_border_both_adjustments_are_quieter_than_areas_alone() {
    println!("at border: vertices      area  adjusted  quadrature");
    for cells in [10, 20, 44] {
        let [area, adjusted, quadrature] = noise(cells, [-1.0, 0.0]);
        let vertices = (cells + 1).pow(2);
        println!("{vertices:>19}  {area:10.1e}{adjusted:10.1e}{quadrature:12.1e}");
        assert!(adjusted < area && quadrature < area, "{cells}");
    }
}
