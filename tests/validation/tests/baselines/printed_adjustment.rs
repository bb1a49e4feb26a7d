//! What the printed adjustment does at a border: it loses the unit sum, and an average changes more
//! from mesh to mesh than without any adjustment.

use nalgebra::Vector3;
use ruga_constraint::{Kernel, SampleConstraints, Sampling, constraint_rows};
use ruga_mesh::{MaterialPoint, SurfaceLookup, vertex_normals};
use ruga_validation::baselines::adjusted_as_printed;
use ruga_validation::{Rectangle, Strip};

const KERNEL: Kernel = Kernel {
    sigma: 0.3,
    cut: 2.0,
};

/// Mean and standard deviation, over meshes of ten seeds, of what a row at the middle of a side of the
/// square makes of a smooth field, and the mean of the row's sum.
fn at_the_side(sample: SampleConstraints, sampling: Sampling) -> [f64; 2] {
    let square = Rectangle {
        length: 2.0,
        width: 2.0,
        radius: None,
    };
    let (mut values, mut sums) = (Vec::new(), Vec::new());
    for seed in 1..=10 {
        let strip = Strip::of(&square.fitted([0.1, 0.1], 0.2, seed), &square);
        let mesh = strip.topology();
        let positions: Vec<_> = strip.points.iter().map(|p| p.push(0.0)).collect();
        let normals = vertex_normals(&mesh, &positions);
        let lookup = SurfaceLookup::new(&mesh, &positions);
        let side = lookup.closest(&Vector3::new(1.0, 0.0, 0.0));
        let place: MaterialPoint = side.expect("a surface").point;
        let set = sample(&mesh, &positions, &normals, &[place], &[KERNEL], sampling);
        let set = set.expect("a row");
        let field: Vec<f64> = positions
            .iter()
            .map(|p| 1.0 + (1.5 * p.x + 0.4).sin() + 0.7 * (1.2 * p.y - 0.3).cos())
            .collect();
        values.push(set.averages(&field)[0]);
        sums.push(set.averages(&vec![1.0; field.len()])[0]);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of_values = mean(&values);
    let squares: Vec<f64> = values.iter().map(|v| (v - of_values).powi(2)).collect();
    [mean(&squares).sqrt(), mean(&sums)]
}

#[test]
fn at_a_border_it_is_noisier_than_no_adjustment_and_loses_the_unit_sum() {
    let [printed, sum] = at_the_side(adjusted_as_printed, Sampling::Area);
    let [area, unit] = at_the_side(constraint_rows, Sampling::Area);
    let [adjusted, _] = at_the_side(constraint_rows, Sampling::Adjusted);
    assert!((unit - 1.0).abs() < 1e-12, "{unit}");
    assert!(sum > 0.3 && sum < 0.8, "{sum}");
    assert!(
        printed > area && adjusted < area,
        "{printed} {area} {adjusted}"
    );
}
