//! Random mixtures of blend shapes.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::scenes::ScenePose;

/// Shapes of a mixture.
const SHAPES: usize = 3;

/// Seed of all mixtures.
const SEED: u64 = 20;

/// Mixtures of three different shapes each, at weights up to 1; the same in every run.
pub(crate) fn mixtures(shapes: &[ScenePose], count: usize) -> Vec<ScenePose> {
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mixture = |number: usize| {
        let mut weights: Vec<(String, f64)> = Vec::new();
        while weights.len() < SHAPES.min(shapes.len()) {
            let shape = &shapes[random.random_range(0..shapes.len())].name;
            if weights.iter().all(|(own, _)| own != shape) {
                // Hundredths are easily typed again.
                let weight = f64::from(random.random_range(1..=100)) / 100.0;
                weights.push((shape.clone(), weight));
            }
        }
        ScenePose {
            name: format!("mixture-{number:02}"),
            weights,
        }
    };
    (1..=count).map(mixture).collect()
}

/// A pose's name, and the shapes where that is not one of them.
pub(crate) fn described(pose: &ScenePose) -> String {
    match pose.weights.as_slice() {
        [(shape, _)] if *shape == pose.name => pose.name.clone(),
        weights => {
            let weights: Vec<String> = weights
                .iter()
                .map(|(shape, w)| format!("{w} {shape}"))
                .collect();
            format!("{} = {}", pose.name, weights.join(" + "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixtures_are_of_three_shapes_and_the_same_each_time() {
        let shape = |name: &str| ScenePose {
            name: name.to_owned(),
            weights: vec![(name.to_owned(), 1.0)],
        };
        let shapes = ["a", "b", "c", "d"].map(shape);
        let mixed = mixtures(&shapes, 50);
        assert_eq!(mixed, mixtures(&shapes, 50));
        assert_eq!(mixed[..7], mixtures(&shapes, 7));
        for pose in &mixed {
            let mut names: Vec<&str> = pose.weights.iter().map(|w| w.0.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), SHAPES);
            assert!(pose.weights.iter().all(|(_, w)| (0.01..=1.0).contains(w)));
        }
        assert_eq!(described(&shapes[1]), "b");
        let start = format!(
            "mixture-01 = {} {}",
            mixed[0].weights[0].1, mixed[0].weights[0].0
        );
        assert!(described(&mixed[0]).starts_with(&start));
    }
}
