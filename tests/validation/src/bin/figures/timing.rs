//! The table of times: Li 2014, table 6-1, beside ours.

use std::fmt::Write;
use std::iter::Sum;

use ruga_io::{LayerReport, PoseReport, Seconds};

/// A pose's sizes at the end and mean seconds per frame, both sums over its layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Timing {
    scene: String,
    pose: String,
    numbers: Numbers,
    /// The thesis' own numbers where it shows the same.
    reference: Option<&'static Reference>,
}

/// What is counted and measured; `None` where the source does not say.
#[derive(Clone, Debug, Default, PartialEq)]
struct Numbers {
    vertices: Option<u64>,
    faces: Option<u64>,
    constraints: Option<u64>,
    seconds: Seconds,
}

/// A row of Li 2014, table 6-1 (2.4 GHz Intel Core i7). Its totals leave out the constraints, which
/// are built once; ours are of everything.
#[derive(Debug, PartialEq)]
pub(super) struct Reference {
    figure: &'static str,
    /// Our scene, and its pose, that shows the same.
    scene: &'static str,
    pose: &'static str,
    constraints: u64,
    vertices: u64,
    /// Constraints, integration, remeshing, sampling, total.
    seconds: [f64; 5],
}

const fn row(
    [figure, scene, pose]: [&'static str; 3],
    [constraints, vertices]: [u64; 2],
    seconds: [f64; 5],
) -> Reference {
    Reference {
        figure,
        scene,
        pose,
        constraints,
        vertices,
        seconds,
    }
}

/// In the order of the thesis.
const REFERENCES: [Reference; 6] = [
    row(
        ["6-3", "layers-two", "compress"],
        [436, 7693],
        [1.05, 107.4, 0.242, 1.44, 109.082],
    ),
    row(
        ["6-1 middle", "heterogeneous-thickness", "compress"],
        [189, 3104],
        [0.08, 76.04, 0.051, 0.80, 76.891],
    ),
    row(
        ["6-1 top", "heterogeneous-stiffness", "compress"],
        [139, 2696],
        [0.05, 71.81, 0.056, 0.63, 72.496],
    ),
    row(
        ["6-4 top", "forearm-two-layers", "compress"],
        [421, 11529],
        [1.01, 269.8, 0.651, 3.42, 273.871],
    ),
    row(
        ["6-4 middle", "forearm-two-layers", "twist"],
        [421, 6770],
        [1.01, 85.57, 0.191, 1.06, 86.821],
    ),
    row(
        ["6-4 bottom", "forearm-two-layers", "pinch"],
        [401, 5294],
        [0.98, 81.45, 0.218, 1.21, 82.878],
    ),
];

/// The thesis' row for a pose.
pub(super) fn reference(scene: &str, pose: &str) -> Option<&'static Reference> {
    let mut rows = REFERENCES.iter();
    rows.find(|row| row.scene == scene && row.pose == pose)
}

impl Timing {
    pub(super) fn of(
        scene: &str,
        pose: &PoseReport,
        reference: Option<&'static Reference>,
    ) -> Self {
        let layers = pose.layers.as_slice();
        Self {
            scene: scene.to_owned(),
            pose: pose.name.clone(),
            numbers: Numbers {
                vertices: sum(layers, |layer| layer.vertices),
                faces: sum(layers, |layer| layer.faces),
                constraints: sum(layers, |layer| layer.constraints),
                seconds: Seconds {
                    constraints: sum(layers, |layer| layer.seconds.constraints),
                    integration: sum(layers, |layer| layer.seconds.integration),
                    remeshing: sum(layers, |layer| layer.seconds.remeshing),
                    sampling: sum(layers, |layer| layer.seconds.sampling),
                    total: sum(layers, |layer| layer.seconds.total),
                },
            },
            reference,
        }
    }
}

/// Over all layers; nothing unless every layer says it.
fn sum<T: Sum>(layers: &[LayerReport], value: impl Fn(&LayerReport) -> Option<T>) -> Option<T> {
    layers.iter().map(value).sum()
}

impl Reference {
    fn numbers(&self) -> Numbers {
        let [constraints, integration, remeshing, sampling, total] = self.seconds.map(Some);
        Numbers {
            vertices: Some(self.vertices),
            faces: None,
            constraints: Some(self.constraints),
            seconds: Seconds {
                constraints,
                integration,
                remeshing,
                sampling,
                total,
            },
        }
    }
}

impl Numbers {
    fn seconds(&self) -> [Option<f64>; 5] {
        let s = &self.seconds;
        [
            s.constraints,
            s.integration,
            s.remeshing,
            s.sampling,
            s.total,
        ]
    }
}

/// A table for people: each of ours, and below it the thesis' where it has one.
pub(super) fn text(timings: &[Timing]) -> String {
    let mut text = "\
Mean seconds per frame, on one thread; sizes of the mesh that was computed on. `Li` is Li 2014,
table 6-1, on a 2.4 GHz Intel Core i7; its totals leave out the constraints, built once.

scene                       pose       vertices    faces  constraints \
|  constr.  integr.  remesh.  sampl.     total
"
    .to_owned();
    let mut line = |scene: &str, pose: &str, numbers: &Numbers| {
        let count = |n: Option<u64>| n.map_or("-".to_owned(), |n| n.to_string());
        let time = |t: Option<f64>| t.map_or("-".to_owned(), |t| format!("{t:.3}"));
        let [c, i, r, s, total] = numbers.seconds().map(time);
        // Writing into a string has no way to fail.
        let _ = writeln!(
            text,
            "{scene:<27} {pose:<10} {:>8} {:>8} {:>12} | {c:>8} {i:>8} {r:>8} {s:>7} {total:>9}",
            count(numbers.vertices),
            count(numbers.faces),
            count(numbers.constraints),
        );
    };
    for timing in timings {
        line(&timing.scene, &timing.pose, &timing.numbers);
        if let Some(reference) = timing.reference {
            let figure = format!("  Li, figure {}", reference.figure);
            line(&figure, "", &reference.numbers());
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_layers() -> Timing {
        let layer = |vertices, integration, total| LayerReport {
            vertices: Some(vertices),
            seconds: Seconds {
                integration: Some(integration),
                total: Some(total),
                ..Seconds::default()
            },
            ..LayerReport::default()
        };
        let pose = PoseReport {
            name: "compress".into(),
            layers: vec![layer(100, 0.25, 0.5), layer(1000, 1.5, 2.0)],
            ..PoseReport::default()
        };
        Timing::of("layers-two", &pose, reference("layers-two", "compress"))
    }

    #[test]
    fn sizes_and_times_are_summed_over_layers_and_stand_above_the_thesis() {
        let text = text(&[two_layers()]);
        let lines: Vec<Vec<&str>> = text
            .lines()
            .map(|l| l.split_whitespace().collect())
            .collect();
        let [.., ours, li] = lines.as_slice() else {
            panic!("two rows");
        };
        assert_eq!(ours[..5], ["layers-two", "compress", "1100", "-", "-"]);
        // Constraints were not measured; integration and total were.
        assert_eq!(ours[5..], ["|", "-", "1.750", "-", "-", "2.500"]);
        assert_eq!(li[..4], ["Li,", "figure", "6-3", "7693"]);
        assert_eq!(li.last(), Some(&"109.082"));
    }

    #[test]
    fn the_thesis_leaves_constraints_out_of_its_totals() {
        for row in &REFERENCES {
            let [_, integration, remeshing, sampling, total] = row.seconds;
            let sum = integration + remeshing + sampling;
            // Totals have one digit more than integration.
            assert!((sum - total).abs() < 0.0021, "{}", row.figure);
        }
    }
}
